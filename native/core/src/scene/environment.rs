//! Light from all sides, as a picture of the sky.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DMat3, DVec3, Vec3};

use super::SceneError;

/// A picture of everything around, in equal steps of longitude and latitude as Blender and most renderers have it; bright parts of it
/// can be found by chance.
///
/// The direction (x, y, z) lies at ½ − atan2(y, x) / 2π of the width from the left, and asin z / π + ½ of the height from the bottom. Between
/// the middles of texels it is interpolated.
#[derive(Debug, PartialEq)]
pub struct EnvironmentImage {
    size: [u32; 2],
    radiance: Vec<[f32; 3]>,
    /// Cumulative share of each row, then of each texel within its row; none in the dark.
    rows: Vec<f64>,
    columns: Vec<f64>,
}

/// Light from all sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// What is around.
    pub image: Arc<EnvironmentImage>,
    /// A rotation.
    pub world_from_environment: DMat3,
    /// Factor of the picture's radiance, at least 0.
    pub strength: f32,
}

fn invalid(reason: impl Into<String>) -> SceneError {
    SceneError::input("environment", reason)
}

impl EnvironmentImage {
    /// A picture of scene-linear radiance, width and height, row 0 at the top.
    ///
    /// # Errors
    /// [`SceneError`] for a size that does not fit, and radiances that are negative or not finite.
    pub fn new(size: [u32; 2], radiance: Vec<[f32; 3]>) -> Result<Self, SceneError> {
        let [width, height] = size;
        if width == 0 || height == 0 || radiance.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(invalid(format!("{} texels are not {width}×{height}", radiance.len())));
        }
        let is_radiance = |texel: &[f32; 3]| texel.iter().all(|value| value.is_finite() && *value >= 0.0);
        if let Some(place) = radiance.iter().position(|texel| !is_radiance(texel)) {
            let (x, y) = (place as u32 % width, place as u32 / width);
            return Err(invalid(format!(
                "texel ({x}, {y}) is {:?}: expected radiances of at least 0",
                radiance[place]
            )));
        }
        let mut image = Self { size, radiance, rows: Vec::new(), columns: Vec::new() };
        image.distribute();
        Ok(image)
    }

    /// Width and height.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// All texels, row 0 at the top.
    pub fn radiance(&self) -> &[[f32; 3]] {
        &self.radiance
    }

    /// Makes the tables of bright parts.
    fn distribute(&mut self) {
        let [width, height] = self.size.map(|side| side as usize);
        let mut columns = Vec::with_capacity(width * height);
        let mut rows = Vec::with_capacity(height);
        let mut total = 0.0;
        for j in 0..height {
            let mut sum = 0.0;
            columns.extend((0..width).map(|i| {
                sum += self.mean(i, j).element_sum();
                sum
            }));
            total += sum * self.solid_angle(j);
            rows.push(total);
            let start = columns.len() - width;
            if sum > 0.0 {
                columns[start..].iter_mut().for_each(|c| *c /= sum);
            }
        }
        if total > 0.0 {
            rows.iter_mut().for_each(|r| *r /= total);
            (self.rows, self.columns) = (rows, columns);
        }
    }

    /// Mean of the interpolated light over a texel: three quarters are its own, an eighth each neighbour's, in both directions. Where there
    /// is light at all, there is a density.
    fn mean(&self, i: usize, j: usize) -> DVec3 {
        let [width, height] = self.size.map(|side| side as usize);
        let texel = |i: usize, j: usize| Vec3::from(self.radiance[j * width + i]).as_dvec3();
        let along_row = |j: usize| {
            let (left, right) = ((i + width - 1) % width, (i + 1) % width);
            0.75 * texel(i, j) + 0.125 * (texel(left, j) + texel(right, j))
        };
        0.75 * along_row(j) + 0.125 * (along_row(j.saturating_sub(1)) + along_row((j + 1).min(height - 1)))
    }

    /// Cosine of the polar angle at the upper edge of a row.
    fn edge(&self, row: usize) -> f64 {
        (PI * row as f64 / f64::from(self.size[1])).cos()
    }

    /// Of a texel of a row.
    fn solid_angle(&self, row: usize) -> f64 {
        (self.edge(row) - self.edge(row + 1)) * TAU / f64::from(self.size[0])
    }

    /// Place on the picture, texels from the left and from the top.
    fn place(&self, d: DVec3) -> [f64; 2] {
        let u = 0.5 - d.y.atan2(d.x) / TAU;
        let v = d.z.clamp(-1.0, 1.0).acos() / PI;
        [u * f64::from(self.size[0]), v * f64::from(self.size[1])]
    }

    fn at(&self, direction: DVec3) -> DVec3 {
        let [width, height] = self.size.map(i64::from);
        let [x, y] = self.place(direction).map(|c| c - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (right, down) = ((x - column) as f32, (y - row) as f32);
        // Around the back columns go on at the other side; beyond the poles rows end.
        let texel = |dx: i64, dy: i64| {
            let i = (column as i64 + dx).rem_euclid(width);
            let j = (row as i64 + dy).clamp(0, height - 1);
            Vec3::from(self.radiance[(j * width + i) as usize])
        };
        let (top, bottom) = (texel(0, 0).lerp(texel(1, 0), right), texel(0, 1).lerp(texel(1, 1), right));
        top.lerp(bottom, down).as_dvec3()
    }
}

impl Environment {
    /// Checks what its image has not checked.
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        if !(self.strength.is_finite() && self.strength >= 0.0) {
            return Err(invalid(format!("a strength of {} is negative or not finite", self.strength)));
        }
        let product = self.world_from_environment * self.world_from_environment.transpose();
        if !product.abs_diff_eq(DMat3::IDENTITY, 1e-6) {
            return Err(invalid("its matrix is no rotation"));
        }
        Ok(())
    }

    /// Whether any light comes from it. The three functions below are for one that shines.
    pub fn shines(&self) -> bool {
        self.strength > 0.0 && !self.image.rows.is_empty()
    }

    /// Radiance from a unit direction.
    pub fn radiance(&self, direction: DVec3) -> DVec3 {
        self.image.at(self.world_from_environment.transpose() * direction) * f64::from(self.strength)
    }

    /// A direction for two numbers in [0, 1): bright texels more often.
    pub fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        // What is left of a number within its step is even again.
        let pick = |cumulative: &[f64], u: f64| {
            let place = cumulative.partition_point(|c| *c <= u).min(cumulative.len() - 1);
            let before = if place == 0 { 0.0 } else { cumulative[place - 1] };
            (place, ((u - before) / (cumulative[place] - before)).clamp(0.0, 1.0))
        };
        let image = &self.image;
        let width = image.size[0] as usize;
        let (row, down) = pick(&image.rows, u);
        let (column, right) = pick(&image.columns[row * width..][..width], v);
        let z = image.edge(row) + (image.edge(row + 1) - image.edge(row)) * down;
        let longitude = (0.5 - (column as f64 + right) / width as f64) * TAU;
        let across = (1.0 - z * z).max(0.0).sqrt();
        self.world_from_environment * DVec3::new(across * longitude.cos(), across * longitude.sin(), z)
    }

    /// The texel that a direction lies in: column and row.
    fn texel(&self, direction: DVec3) -> (usize, usize) {
        let [width, height] = self.image.size.map(|side| side as usize);
        let [x, y] = self.image.place(self.world_from_environment.transpose() * direction);
        ((x as usize).min(width - 1), (y as usize).min(height - 1))
    }

    /// Mean radiance over the texel that a direction lies in, divided by [`Self::pdf`]: the sum of its channels is the same for all
    /// directions, so that they differ in colour alone.
    pub fn mean_radiance_over_pdf(&self, direction: DVec3) -> DVec3 {
        let (column, row) = self.texel(direction);
        self.image.mean(column, row) * (f64::from(self.strength) / self.pdf(direction).max(1e-300))
    }

    /// Density of [`Self::sample`] over the solid angle.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        let image = &self.image;
        let width = image.size[0] as usize;
        let (column, row) = self.texel(direction);
        let share = |cumulative: &[f64], i: usize| cumulative[i] - if i == 0 { 0.0 } else { cumulative[i - 1] };
        share(&image.rows, row) * share(&image.columns[row * width..][..width], column) / image.solid_angle(row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{hash_combine, sphere, unit_from_hash};

    fn unit(i: u32, key: u32) -> f64 {
        unit_from_hash(hash_combine(i, key))
    }

    fn environment(size: [u32; 2], radiance: Vec<[f32; 3]>, world_from_environment: DMat3) -> Environment {
        let image = Arc::new(EnvironmentImage::new(size, radiance).expect("radiances"));
        Environment { image, world_from_environment, strength: 1.0 }
    }

    fn sky() -> Environment {
        let radiance = (0..16 * 8).map(|i| [unit(i, 0).powi(6) as f32 * 9.0, unit(i, 1) as f32, 0.1]).collect();
        environment([16, 8], radiance, DMat3::from_rotation_z(0.4) * DMat3::from_rotation_x(0.7))
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
        let even_share = mean(&|i| {
            let weight = sky.mean_radiance_over_pdf(drawn(i));
            (weight.element_sum() / sky.mean_radiance_over_pdf(drawn(0)).element_sum() - 1.0).abs()
        });
        assert!(even_share < 1e-6, "{even_share}");
        let light = mean(&|i| sky.mean_radiance_over_pdf(drawn(i)).x);
        let expected = mean(&|i| sky.radiance(even(i)).x) * 4.0 * PI;
        assert!((light / expected - 1.0).abs() < 0.02, "{light} for {expected}");
        // The same with the density of another sky fails.
        let turned = Environment { world_from_environment: DMat3::IDENTITY, ..self::sky() };
        let wrong = mean(&|i| smooth(drawn(i)) / turned.pdf(drawn(i)));
        assert!((wrong / exact - 1.0).abs() > 0.05, "{wrong}");
    }

    #[test]
    fn directions_lie_where_the_convention_says() {
        let mut radiance = vec![[0.0; 3]; 8];
        assert!(!environment([4, 2], radiance.clone(), DMat3::IDENTITY).shines());
        // The second texel from the left of the upper row: longitude 0 to 90°, its middle at 45°.
        radiance[1] = [1.0; 3];
        let sky = environment([4, 2], radiance, DMat3::IDENTITY);
        assert!(sky.shines());
        assert!((sky.radiance(DVec3::new(0.5, 0.5, 0.5_f64.sqrt())).x - 1.0).abs() < 1e-6);
        assert!(sky.radiance(DVec3::new(-0.5, -0.5, 0.5_f64.sqrt())).x < 1e-6);
        let lit = |i: &u32| sky.radiance(sky.sample([unit(*i, 0), unit(*i, 1)])).x > 0.0;
        // The far halves of the neighbours are drawn as well, a sixth of all.
        assert!((0..1000).filter(lit).count() > 750);
    }

    #[test]
    fn strength_is_a_factor_of_the_radiance_alone() {
        let (one, three) = (sky(), Environment { strength: 3.0, ..sky() });
        let direction = one.sample([0.3, 0.6]);
        assert_eq!(three.sample([0.3, 0.6]), direction);
        assert!((three.radiance(direction) / one.radiance(direction) - 3.0).abs().max_element() < 1e-12);
        assert_eq!(three.pdf(direction), one.pdf(direction));
        assert!(!Environment { strength: 0.0, ..sky() }.shines());
    }

    #[test]
    fn what_is_no_environment_is_refused() {
        let refused = |result: Result<(), SceneError>| match result {
            Err(SceneError::Input { what, .. }) => assert_eq!(what, "environment"),
            other => panic!("{other:?}"),
        };
        let image = |size, radiance| EnvironmentImage::new(size, radiance).map(|_| ());
        refused(image([2, 2], vec![[1.0; 3]; 3]));
        refused(image([2, 1], vec![[1.0; 3], [f32::NAN, 0.0, 0.0]]));
        refused(image([2, 1], vec![[1.0; 3], [-1.0, 0.0, 0.0]]));
        sky().validate().expect("valid");
        refused(Environment { world_from_environment: DMat3::IDENTITY * 2.0, ..sky() }.validate());
        refused(Environment { strength: f32::NAN, ..sky() }.validate());
    }
}
