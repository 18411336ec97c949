//! What a file holds, and the turn to the renderer's coordinates.

use lisle_core::curve::Curves;

/// The axis that points up in a file's coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpAxis {
    /// Y up, as in glTF.
    Y,
    /// Z up, as in Blender and in this project.
    Z,
}

/// Yarn curves of a file, in the file's units and axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The curves; radii where the file has them.
    pub curves: Curves,
    /// The axis that points up.
    pub up: UpAxis,
    /// Length coordinate of every point in the file's unit, where the file has them (glTF's `_LENGTH`): arc
    /// length of the rest yarn up to the point.
    pub length_coordinates: Option<Vec<f32>>,
    /// What the file says about itself; often empty.
    pub info: String,
}

impl Loaded {
    /// The same curves with Z up: a quarter turn about the X axis, (x, y, z) → (x, −z, y), if Y was up.
    #[must_use]
    pub fn into_z_up(mut self) -> Self {
        if self.up == UpAxis::Y {
            for point in &mut self.curves.points {
                *point = [point[0], -point[2], point[1]];
            }
            self.up = UpAxis::Z;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn y_up_becomes_z_up_by_a_rotation_and_z_up_stays() {
        let axes = vec![vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]];
        let file = Loaded {
            curves: Curves::catmull_rom(axes, false),
            up: UpAxis::Y,
            length_coordinates: None,
            info: String::new(),
        };
        let turned = file.into_z_up();
        assert_eq!(turned.curves.points, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]);
        assert_eq!(turned.up, UpAxis::Z);
        assert_eq!(turned.clone().into_z_up(), turned);
    }
}
