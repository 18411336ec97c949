//! Light from all sides, as a picture of the sky.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3, Vec3};

use crate::Error;

/// A picture of everything around, in equal steps of longitude and latitude as Blender and most renderers have it.
///
/// The direction (x, y, z) lies at ½ − atan2(y, x) / 2π of the width from the left, and asin z / π + ½ of the height from the bottom. Between
/// the middles of texels it is interpolated.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Width and height.
    pub size: [u32; 2],
    /// Scene-linear radiance, row 0 at the top.
    pub radiance: Vec<[f32; 3]>,
    /// A rotation.
    pub world_from_environment: DMat3,
}

impl Environment {
    /// Checks it.
    ///
    /// # Errors
    /// [`Error::Input`] for a size that does not fit, radiances that are negative or not finite, and what is no rotation.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let invalid = |reason: String| Err(Error::Input { what: "environment", reason });
        let [width, height] = self.size;
        if width == 0 || height == 0 || self.radiance.len() as u64 != u64::from(width) * u64::from(height) {
            return invalid(format!("{} texels are not {width}×{height}", self.radiance.len()));
        }
        let is_radiance = |texel: &[f32; 3]| texel.iter().all(|value| value.is_finite() && *value >= 0.0);
        if let Some(place) = self.radiance.iter().position(|texel| !is_radiance(texel)) {
            let (x, y) = (place as u32 % width, place as u32 / width);
            return invalid(format!(
                "texel ({x}, {y}) is {:?}: expected radiances of at least 0",
                self.radiance[place]
            ));
        }
        let product = self.world_from_environment * self.world_from_environment.transpose();
        if !product.abs_diff_eq(DMat3::IDENTITY, 1e-6) {
            return invalid("its matrix is no rotation".into());
        }
        Ok(())
    }
}

/// An environment whose bright parts are found by chance.
pub(crate) struct Sky {
    width: usize,
    height: usize,
    radiance: Vec<Vec3>,
    world_from_environment: DMat3,
    /// Cumulative share of each row, then of each texel within its row.
    rows: Vec<f64>,
    columns: Vec<f64>,
    /// Solid angle of a texel of each row.
    solid_angles: Vec<f64>,
}

impl Sky {
    /// `None` for an environment without light.
    pub fn new(environment: &Environment) -> Option<Self> {
        let [width, height] = environment.size.map(|s| s as usize);
        let radiance: Vec<Vec3> = environment.radiance.iter().map(|texel| Vec3::from(*texel)).collect();
        // Cosines of the polar angle at the upper and the lower edge of a row.
        let edge = |row: usize| (PI * row as f64 / height as f64).cos();
        let solid_angles: Vec<f64> = (0..height).map(|row| (edge(row) - edge(row + 1)) * TAU / width as f64).collect();
        // Mean of the interpolated light over each texel: three quarters are its own, an eighth each neighbour's, in both directions. Where
        // there is light at all, there is a density.
        let brightness = |i: usize, j: usize| f64::from(radiance[j * width + i].element_sum());
        let along_row = |i: usize, j: usize| {
            let (left, right) = ((i + width - 1) % width, (i + 1) % width);
            0.75 * brightness(i, j) + 0.125 * (brightness(left, j) + brightness(right, j))
        };
        let mean = |i: usize, j: usize| {
            let (above, below) = (j.saturating_sub(1), (j + 1).min(height - 1));
            0.75 * along_row(i, j) + 0.125 * (along_row(i, above) + along_row(i, below))
        };
        let mut columns = Vec::with_capacity(width * height);
        let mut rows = Vec::with_capacity(height);
        let mut total = 0.0;
        for (j, solid_angle) in solid_angles.iter().enumerate() {
            let mut sum = 0.0;
            columns.extend((0..width).map(|i| {
                sum += mean(i, j);
                sum
            }));
            total += sum * solid_angle;
            rows.push(total);
            let start = columns.len() - width;
            if sum > 0.0 {
                columns[start..].iter_mut().for_each(|c| *c /= sum);
            }
        }
        rows.iter_mut().for_each(|r| *r /= total);
        let world_from_environment = environment.world_from_environment;
        (total > 0.0).then_some(Self { width, height, radiance, world_from_environment, rows, columns, solid_angles })
    }

    /// Place on the picture, texels from the left and from the top.
    fn place(&self, direction: DVec3) -> [f64; 2] {
        let d = self.world_from_environment.transpose() * direction;
        let u = 0.5 - d.y.atan2(d.x) / TAU;
        let v = d.z.clamp(-1.0, 1.0).acos() / PI;
        [u * self.width as f64, v * self.height as f64]
    }

    /// Radiance from a unit direction.
    pub fn radiance(&self, direction: DVec3) -> DVec3 {
        let [x, y] = self.place(direction).map(|c| c - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (right, down) = ((x - column) as f32, (y - row) as f32);
        // Around the back columns go on at the other side; beyond the poles rows end.
        let texel = |dx: i64, dy: i64| {
            let i = (column as i64 + dx).rem_euclid(self.width as i64) as usize;
            let j = (row as i64 + dy).clamp(0, self.height as i64 - 1) as usize;
            self.radiance[j * self.width + i]
        };
        let (top, bottom) = (texel(0, 0).lerp(texel(1, 0), right), texel(0, 1).lerp(texel(1, 1), right));
        top.lerp(bottom, down).as_dvec3()
    }

    /// A direction for two numbers in [0, 1): bright texels more often.
    pub fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        // What is left of a number within its step is even again.
        let pick = |cumulative: &[f64], u: f64| {
            let place = cumulative.partition_point(|c| *c <= u).min(cumulative.len() - 1);
            let before = if place == 0 { 0.0 } else { cumulative[place - 1] };
            (place, ((u - before) / (cumulative[place] - before)).clamp(0.0, 1.0))
        };
        let (row, down) = pick(&self.rows, u);
        let (column, right) = pick(&self.columns[row * self.width..][..self.width], v);
        let edge = |row: usize| (PI * row as f64 / self.height as f64).cos();
        let z = edge(row) + (edge(row + 1) - edge(row)) * down;
        let longitude = (0.5 - (column as f64 + right) / self.width as f64) * TAU;
        let across = (1.0 - z * z).max(0.0).sqrt();
        self.world_from_environment * DVec3::new(across * longitude.cos(), across * longitude.sin(), z)
    }

    /// Density of [`Self::sample`] over the solid angle.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        let [x, y] = self.place(direction);
        let (column, row) = ((x as usize).min(self.width - 1), (y as usize).min(self.height - 1));
        let share = |cumulative: &[f64], i: usize| cumulative[i] - if i == 0 { 0.0 } else { cumulative[i - 1] };
        share(&self.rows, row) * share(&self.columns[row * self.width..][..self.width], column) / self.solid_angles[row]
    }
}

#[cfg(test)]
mod tests {
    use lisle_core::sampling::{hash_combine, sphere, unit_from_hash};

    use super::*;

    fn unit(i: u32, key: u32) -> f64 {
        unit_from_hash(hash_combine(i, key))
    }

    fn sky() -> Sky {
        let radiance = (0..16 * 8).map(|i| [unit(i, 0).powi(6) as f32 * 9.0, unit(i, 1) as f32, 0.1]).collect();
        let world_from_environment = DMat3::from_rotation_z(0.4) * DMat3::from_rotation_x(0.7);
        let environment = Environment { size: [16, 8], radiance, world_from_environment };
        environment.check().expect("valid");
        Sky::new(&environment).expect("light")
    }

    #[test]
    fn the_density_is_that_of_the_samples() {
        let sky = sky();
        let n = 200_000;
        // ∫ pdf = 1 over even directions, and E[g / pdf] = ∫ g over drawn ones.
        let even = |i: u32| sphere([unit(i, 2), unit(i, 3)]);
        let drawn = |i: u32| sky.sample([unit(i, 4), unit(i, 5)]);
        let mean = |f: &dyn Fn(u32) -> f64| (0..n).map(f).sum::<f64>() / f64::from(n);
        let total = mean(&|i| sky.pdf(even(i))) * 4.0 * PI;
        assert!((total - 1.0).abs() < 0.02, "{total}");
        let smooth = |d: DVec3| 1.0 + d.x + 2.0 * d.y * d.z + d.z * d.z;
        let integral = mean(&|i| smooth(drawn(i)) / sky.pdf(drawn(i)));
        let exact = 4.0 * PI * (1.0 + 1.0 / 3.0);
        assert!((integral / exact - 1.0).abs() < 0.02, "{integral} for {exact}");
        // The same with the density of another sky fails.
        let turned = Sky { world_from_environment: DMat3::IDENTITY, ..self::sky() };
        let wrong = mean(&|i| smooth(drawn(i)) / turned.pdf(drawn(i)));
        assert!((wrong / exact - 1.0).abs() > 0.05, "{wrong}");
    }

    #[test]
    fn directions_lie_where_the_convention_says() {
        let mut environment =
            Environment { size: [4, 2], radiance: vec![[0.0; 3]; 8], world_from_environment: DMat3::IDENTITY };
        assert!(Sky::new(&environment).is_none());
        // The second texel from the left of the upper row: longitude 0 to 90°, its middle at 45°.
        environment.radiance[1] = [1.0; 3];
        let sky = Sky::new(&environment).expect("light");
        assert!((sky.radiance(DVec3::new(0.5, 0.5, 0.5_f64.sqrt())).x - 1.0).abs() < 1e-6);
        assert!(sky.radiance(DVec3::new(-0.5, -0.5, 0.5_f64.sqrt())).x < 1e-6);
        let lit = |i: &u32| sky.radiance(sky.sample([unit(*i, 0), unit(*i, 1)])).x > 0.0;
        // The far halves of the neighbours are drawn as well, a sixth of all.
        assert!((0..1000).filter(lit).count() > 750);
    }

    #[test]
    fn what_is_no_environment_is_refused() {
        let good = Environment { size: [2, 1], radiance: vec![[1.0; 3]; 2], world_from_environment: DMat3::IDENTITY };
        good.check().expect("valid");
        for wrong in [
            Environment { size: [2, 2], ..good.clone() },
            Environment { radiance: vec![[1.0; 3], [f32::NAN, 0.0, 0.0]], ..good.clone() },
            Environment { radiance: vec![[1.0; 3], [-1.0, 0.0, 0.0]], ..good.clone() },
            Environment { world_from_environment: DMat3::IDENTITY * 2.0, ..good.clone() },
        ] {
            assert!(matches!(wrong.check(), Err(Error::Input { what: "environment", .. })));
        }
    }
}
