use thiserror::Error;

/// Mean and standard deviation of a random length or angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variate {
    /// Mean.
    pub mean: f64,
    /// Standard deviation, ≥ 0.
    pub deviation: f64,
}

/// Flyaway fibers of a ply [Zhao2016, Table 2]. Lengths in the yarn's table unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flyaways {
    /// Loop fibers per unit of ply length.
    pub loop_density: f64,
    /// Hair fibers per unit of ply length.
    pub hair_density: f64,
    /// Largest distance of a loop from the ply centre, R_max^loop.
    pub loop_r_max: Variate,
    /// Distance at which a hair leaves the ply, R_min^hair.
    pub hair_r_min: Variate,
    /// How much farther out its tip is, R_span.
    pub hair_r_span: Variate,
    /// Its extent along the ply, z_span; the sign is the direction.
    pub hair_z_span: Variate,
    /// The angle it turns around the ply on the way, theta_span, in radians.
    pub hair_theta_span: Variate,
}

/// Parameters of one kind of yarn [Zhao2016, Table 2; WuYuksel2018 §3.1].
///
/// Lengths are in the table's unit; only their ratios matter, since a yarn is scaled so that
/// [`Yarn::outer_radius`] equals the radius of its curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Yarn {
    /// Plies per yarn, K ≥ 1.
    pub plies: u32,
    /// Fibers per ply, m ≥ 1.
    pub fibers_per_ply: u32,
    /// Exponent β of the radial fiber density, ≥ 0.
    pub density_beta: f64,
    /// Floor ε of the radial fiber density, in [0, 0.5].
    pub density_epsilon: f64,
    /// Ply length per full turn of its fibers, alpha; the sign is the handedness.
    pub fiber_twist: f64,
    /// Yarn length per full turn of its plies, alpha_ply; the sign is the handedness.
    pub ply_twist: f64,
    /// Least relative radius of a migrating fiber, R_min in [0, 1].
    pub r_min: f64,
    /// Migration periods per turn of the fibers, s > 0.
    pub migration_rate: f64,
    /// Long half axis of a ply's section, e_B (tangential).
    pub ellipse_long: f64,
    /// Short half axis of a ply's section, e_N (towards the yarn centre).
    pub ellipse_short: f64,
    /// Diameter parameter of the ply helix, R_ply: ply centres sit at half of it.
    pub ply_radius: f64,
    /// Radius of one fiber.
    pub fiber_radius: f64,
    /// Loops and hairs.
    pub flyaways: Flyaways,
}

/// A yarn parameter outside its range.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("yarn parameter `{parameter}` is {value}: expected {expected}")]
pub struct YarnError {
    /// Name of the field.
    pub parameter: &'static str,
    /// What it was set to.
    pub value: f64,
    /// What would be right.
    pub expected: &'static str,
}

/// Fibers a yarn may have in all: so many that their numbers and those of a million control points fit into a visibility key of 64 bits.
const MAX_FIBERS: u32 = 60_000;
/// Tables of a yarn's section take a time that grows with its plies: for so many, seconds.
const MAX_PLIES: u32 = 4000;

impl Yarn {
    /// Distance from the yarn centre to the farthest point of a ply, table units: ½ R_ply + e_B (e_B alone for one ply).
    pub fn outer_radius(&self) -> f64 {
        self.ply_distance() + self.ellipse_long
    }

    /// Distance of the ply centres from the yarn centre, table units; zero for one ply.
    pub fn ply_distance(&self) -> f64 {
        if self.plies > 1 { 0.5 * self.ply_radius } else { 0.0 }
    }

    /// Geometric mean of the ply's half axes, by which absolute radii become relative ones, table units.
    pub fn mean_axis(&self) -> f64 {
        (self.ellipse_long * self.ellipse_short).sqrt()
    }

    /// Ply length of one migration period, table units.
    pub fn migration_period(&self) -> f64 {
        self.fiber_twist.abs() / self.migration_rate
    }

    /// How many fibers of a ply become loops and hairs: the outermost, in four of five of their periods.
    ///
    /// [Zhao2016] adds flyaways to the regular fibers, [WuYuksel2018 §3.1] turns periods of them into flyaways. Keeping those
    /// to few fibers leaves the densities as they are, and a renderer need not look for them in all the others.
    pub fn flyaway_fibers(&self) -> u32 {
        const BUSY: f64 = 0.8;
        let per_period = (self.flyaways.loop_density + self.flyaways.hair_density) * self.migration_period();
        ((per_period / BUSY).ceil() as u32).min(self.fibers_per_ply)
    }

    /// Chances that one period of one of the [`Self::flyaway_fibers`] is a loop, or a hair: density × period ÷ fibers.
    pub fn flyaway_chances(&self) -> (f64, f64) {
        let per_density = self.migration_period() / f64::from(self.flyaway_fibers().max(1));
        let (a, b) = (self.flyaways.loop_density * per_density, self.flyaways.hair_density * per_density);
        // A fiber cannot be more than one thing: densities beyond one flyaway per period saturate.
        let scale = (a + b).max(1.0);
        (a / scale, b / scale)
    }

    /// Checks every parameter against its range.
    pub fn validate(&self) -> Result<(), YarnError> {
        let check = |ok: bool, parameter, value, expected| {
            if ok { Ok(()) } else { Err(YarnError { parameter, value, expected }) }
        };
        let positive = |parameter, value: f64| {
            check(value.is_finite() && value > 0.0, parameter, value, "a finite number above 0")
        };
        let turn = |parameter, value: f64| {
            check(
                value.is_finite() && value.abs() >= 1e-3 * self.outer_radius(),
                parameter,
                value,
                "a finite length per turn, not 0 (the sign is the handedness)",
            )
        };
        check((1..=MAX_PLIES).contains(&self.plies), "plies", f64::from(self.plies), "1 to 4000")?;
        check(self.fibers_per_ply >= 1, "fibers_per_ply", f64::from(self.fibers_per_ply), "at least 1")?;
        let fibers = u64::from(self.plies) * u64::from(self.fibers_per_ply);
        check(
            fibers <= u64::from(MAX_FIBERS),
            "plies × fibers_per_ply",
            fibers as f64,
            "at most 60000, whose numbers leave a visibility key room for a million control points",
        )?;
        positive("ellipse_long", self.ellipse_long)?;
        positive("ellipse_short", self.ellipse_short)?;
        positive("fiber_radius", self.fiber_radius)?;
        positive("migration_rate", self.migration_rate)?;
        check(
            self.ply_radius.is_finite() && self.ply_radius >= 0.0,
            "ply_radius",
            self.ply_radius,
            "a finite number of at least 0",
        )?;
        turn("fiber_twist", self.fiber_twist)?;
        turn("ply_twist", self.ply_twist)?;
        check((0.0..=1.0).contains(&self.r_min), "r_min", self.r_min, "a number from 0 to 1")?;
        check(
            self.density_beta.is_finite() && self.density_beta >= 0.0,
            "density_beta",
            self.density_beta,
            "a finite number of at least 0",
        )?;
        check(
            (0.0..=0.5).contains(&self.density_epsilon),
            "density_epsilon",
            self.density_epsilon,
            "a number from 0 to 0.5",
        )?;
        let f = &self.flyaways;
        for (parameter, value) in [("loop_density", f.loop_density), ("hair_density", f.hair_density)] {
            check(value.is_finite() && value >= 0.0, parameter, value, "a finite number of at least 0")?;
        }
        for (parameter, v) in [
            ("loop_r_max", f.loop_r_max),
            ("hair_r_min", f.hair_r_min),
            ("hair_r_span", f.hair_r_span),
            ("hair_z_span", f.hair_z_span),
            ("hair_theta_span", f.hair_theta_span),
        ] {
            check(v.mean.is_finite(), parameter, v.mean, "a finite mean")?;
            check(v.deviation.is_finite() && v.deviation >= 0.0, parameter, v.deviation, "a deviation of at least 0")?;
        }
        Ok(())
    }
}
