//! The fibers of a ply, as one row of a core texture sees them.

use std::f64::consts::TAU;

use glam::DVec2;
use lisle_core::yarn::{FiberTable, FiberType, Yarn};

use crate::arrangement::Arrangement;

/// Height that marks a texel where no fiber is seen.
pub const HOLE: f32 = -2.0;

/// Rank of no fiber.
pub const NO_RANK: u16 = u16::MAX;

/// Slants, views, texels across the ply.
pub(crate) const SLANTS: usize = 5;
pub(crate) const VIEWS: usize = 7;
pub(crate) const WIDTH: usize = 64;

/// Relative distance from the ply's centre, across and towards the viewer, beyond which loops and hairs are cut: little of them is there.
pub(crate) const REACH: f64 = 1.9;

/// What the tangent of the slant grows by from one texture to the next.
pub(crate) const SLANT_STEP: f64 = 0.85;

/// A texel as it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Texel {
    /// As [`crate::CoreFiber::texels`].
    pub values: [f32; 4],
    pub rank: u16,
    /// Of the surface along the ray, which is nearest to the viewer.
    nearness: f32,
}

pub(crate) const NOTHING: Texel = Texel { values: [HOLE, 0.0, 0.0, 0.0], rank: NO_RANK, nearness: f32::NEG_INFINITY };

/// A point of a fiber in the section that it lies in, and its rate along the yarn; from the yarn's axis, the first coordinate towards the
/// viewer. Lengths as those of the yarn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub position: DVec2,
    pub rate: DVec2,
    /// Factor on the fiber's width.
    pub width: f64,
    pub kind: FiberType,
}

/// A ply as one slant and view show it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View<'a> {
    pub yarn: &'a Yarn,
    pub table: &'a FiberTable,
    pub arrangement: &'a Arrangement<'a>,
    /// ψ, radians.
    pub psi: f64,
    /// Tangent between the direction to the viewer and the section.
    pub slant: f64,
    /// T, W, and how much nearer to the viewer v = 1 lies than the ply's centre.
    pub depth: f64,
    pub half_width: f64,
    pub skew: f64,
    /// Angle of the ply's short axis from the direction to the viewer, radians; what it and a fiber in the ply turn per length.
    pub short_axis: f64,
    pub ply_rate: f64,
    pub fiber_rate: f64,
}

/// Where the rays of a row meet a fiber's centre line, and what they see of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    rank: u16,
    pub kind: FiberType,
    /// How far it is towards the viewer from the ply's centre, and across; half of what it covers across. Lengths.
    toward: f64,
    pub across: f64,
    pub half_span: f64,
    /// What `toward` grows by over `half_span`, and by its bulge, of which the height knows `bulge` alone.
    leaning: f64,
    bulge_nearer: f64,
    bulge: f64,
    /// Its rate along the yarn where the ray meets its centre line, and how much that changes to where it is beside the surface in the middle of its width.
    rate: DVec2,
    rate_change: DVec2,
}

/// A fiber that leans towards the viewer bulges along the ray at most this much more; MOST_LEAN of `shaders/math/view.wgsl`.
pub(crate) const MOST_LEAN: f64 = 4.0;

/// Of a row's length, what is left of it at least where a fiber leans towards the viewer; its slope across the screen at most.
const LEAST_FORESHORTENING: f64 = 0.1;
const MOST_SLOPE: f64 = 10.0;

impl<'a> View<'a> {
    pub fn new(arrangement: &'a Arrangement, slant: usize, view: usize) -> Self {
        let (yarn, table) = (arrangement.yarn, arrangement.table);
        let signed_square = 2.0 * view as f64 / (VIEWS - 1) as f64 - 1.0;
        let psi = signed_square.abs().sqrt().asin().copysign(signed_square);
        let toward = DVec2::from_angle(psi) * Self::axes(yarn);
        let across = DVec2::from_angle(psi).perp() * Self::axes(yarn);
        let depth = toward.length();
        Self {
            yarn,
            table,
            arrangement,
            psi,
            slant: SLANT_STEP * (slant as f64 - 0.5 * (SLANTS - 1) as f64),
            depth,
            half_width: toward.perp_dot(across) / depth,
            skew: toward.dot(across) / depth,
            short_axis: -toward.to_angle(),
            ply_rate: if yarn.plies > 1 { TAU / yarn.ply_twist } else { 0.0 },
            fiber_rate: TAU / yarn.fiber_twist,
        }
    }

    pub fn axes(yarn: &Yarn) -> DVec2 {
        DVec2::new(yarn.ellipse_short, yarn.ellipse_long)
    }

    /// Centre of the ply in a row's own section.
    pub fn center(&self) -> DVec2 {
        DVec2::from_angle(self.short_axis) * self.yarn.ply_distance()
    }

    /// A fiber `along` the yarn from row u.
    pub fn point(&self, fiber: usize, u: f64, along: f64) -> Point {
        let yarn = self.yarn;
        let turns = u + along / yarn.fiber_twist;
        let shape = self.arrangement.profile(fiber, turns);
        // Slopes are those of the yarn itself.
        let phase_rate = yarn.migration_rate / yarn.fiber_twist.abs();
        let radius_rate = shape.radius_rate * phase_rate;
        let astray = yarn.fiber_twist.signum() * TAU;
        let angle_rate = self.fiber_rate + astray * shape.angle_rate * phase_rate;
        let angle = TAU * (turns + self.table.angle_turns[fiber]) + astray * shape.angle_turns;
        let unit = DVec2::from_angle(angle + self.psi);
        let in_ply = Self::axes(yarn) * unit * shape.radius;
        let in_ply_rate = Self::axes(yarn) * (unit * radius_rate + unit.perp() * (shape.radius * angle_rate));
        let turned = DVec2::from_angle(self.short_axis + self.ply_rate * along);
        let position = turned.rotate(DVec2::new(yarn.ply_distance(), 0.0) + in_ply);
        let rate = turned.rotate(in_ply_rate) + position.perp() * self.ply_rate;
        Point { position, rate, width: shape.taper, kind: shape.kind }
    }

    pub fn footprint(&self, fiber: usize, u: f64) -> Footprint {
        const NEWTON_STEPS: usize = 4;
        // Of a fiber's radius: nearer, a step changes nothing that is seen.
        const CLOSE: f64 = 1e-3;
        let center = self.center();
        let mut at = self.point(fiber, u, 0.0);
        let mut toward = 0.0;
        for _ in 0..if self.slant == 0.0 { 0 } else { NEWTON_STEPS } {
            let step = (at.position - center).x - toward;
            if step.abs() < CLOSE * self.yarn.fiber_radius {
                break;
            }
            toward += step / (1.0 - self.slant * at.rate.x).max(LEAST_FORESHORTENING);
            at = self.point(fiber, u, toward * self.slant);
        }
        let missed = (at.position - center).x - toward;
        toward += missed;
        let shortened = (1.0 - self.slant * at.rate.x).max(LEAST_FORESHORTENING);
        // Cosine and sine between the direction to the viewer and the section.
        let cos = 1.0 / self.slant.hypot(1.0);
        let sin = cos * self.slant;
        // On the screen, across per length along the yarn.
        let slope = (at.rate.y / (shortened * cos)).clamp(-MOST_SLOPE, MOST_SLOPE);
        let radius = self.yarn.fiber_radius;
        // A ray beside the centre line is nearest to it at another place of it, which is nearer to the viewer or farther.
        let along_per_across = slope / (slope * slope + 1.0) / (shortened * cos);
        let leaning = along_per_across * cos * (at.rate.x * cos + sin);
        let direction = at.rate.extend(1.0).normalize();
        let leaning_cos = direction.x * cos + direction.z * sin;
        let lean = (1.0 / (1.0 - leaning_cos.powi(2)).max(1e-12).sqrt()).min(MOST_LEAN);
        // A surface point that is nearer to the viewer than the centre line lies beside a place of it farther along.
        let farther = radius * lean * leaning_cos * direction.z;
        let rate_change = self.point(fiber, u, toward * self.slant + farther).rate - at.rate;
        // A hair that ends or bends away may not be met at all.
        let met = self.slant == 0.0 || missed.abs() < radius;
        let half_span = if met { radius * at.width * slope.hypot(1.0) } else { 0.0 };
        Footprint {
            rank: fiber as u16,
            kind: at.kind,
            toward,
            across: (at.position - center).y,
            half_span,
            leaning: leaning * half_span,
            bulge_nearer: cos * radius * lean,
            bulge: radius,
            rate: at.rate,
            rate_change,
        }
    }

    /// dh/dθ and dv/dθ that make the fiber go where it does, when to them the turning of the ply is added at the fiber's place.
    fn slopes(&self, at: &Footprint, height: f64, v: f64, offset: f64) -> DVec2 {
        // As `shaders/passes/resolve_cores.wgsl` has it.
        let rise = (1.0 - offset * offset).max(0.0).sqrt();
        let skewed = |h: f64, v: f64| DVec2::new(h * self.depth + v * self.skew, v * self.half_width);
        let axis = skewed(height - at.bulge * rise / self.depth, v - offset * at.bulge / self.half_width);
        let wound = (at.rate + at.rate_change * rise - (self.center() + axis).perp() * self.ply_rate) / self.fiber_rate;
        let across = wound.y / self.half_width;
        DVec2::new((wound.x - across * self.skew) / self.depth, across)
    }

    /// Draws one fiber into a row, nearest to the viewer wins.
    pub fn draw(&self, at: &Footprint, half_width: f64, row: &mut [Texel; WIDTH]) {
        let (middle, span) = (at.across / self.half_width, at.half_span / self.half_width);
        let texel_width = 2.0 * half_width / WIDTH as f64;
        let column = |v: f64| ((v + half_width) / texel_width - 0.5).clamp(0.0, WIDTH as f64);
        let columns = column(middle - span).ceil() as usize..(column(middle + span).floor() as usize + 1).min(WIDTH);
        for (k, texel) in columns.clone().zip(&mut row[columns]) {
            let v = (k as f64 + 0.5) * texel_width - half_width;
            let offset = (v - middle) / span;
            let rise = (1.0 - offset * offset).max(0.0).sqrt();
            let axis = at.toward + at.leaning * offset;
            let nearness = (axis + at.bulge_nearer * rise) as f32;
            let height = (axis + at.bulge * rise - v * self.skew) / self.depth;
            if offset.abs() <= 1.0 && nearness > texel.nearness && height.abs() < REACH {
                let slopes = self.slopes(at, height, v, offset);
                let values = [height, offset, slopes.x, slopes.y].map(|value| value as f32);
                *texel = Texel { values, rank: at.rank, nearness };
            }
        }
    }
}
