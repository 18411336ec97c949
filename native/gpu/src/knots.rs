//! Strands as the shaders read them: padded, packed, recentred.

use glam::{DVec3, Vec3};
use lisle_core::sampling::hash_combine;
use lisle_core::strands::Strands;
use lisle_core::yarn::{Twist, Yarn};

use crate::layout::{self, KNOT_BEGINS_SEGMENT};
use crate::view::Bounds;

/// What does not change from frame to frame: radii, length coordinates, twists.
///
/// Every curve has one knot more at its start and one (open) or two (closed) more at its end than its strand, so that the
/// window of four knots about a segment never leaves the curve.
pub(crate) struct RestKnots {
    /// Length coordinate, as a 32-bit fraction of the curve's length; radius as a 16-bit fraction of `radius_max`, with flags.
    pub rest: Vec<[u32; 2]>,
    /// The curve of every knot.
    pub curve: Vec<u32>,
    pub curves: Vec<layout::Curve>,
    pub radius_max: f64,
    /// The second words of `rest`, which stay when those have gone to the GPU.
    radii_codes: Vec<u32>,
    /// For every padded knot, the strand's knot that it copies.
    source: Vec<u32>,
    /// Padded knots that continue an open curve by reflection, with the neighbours they are made from (inner, next).
    reflected: Vec<(u32, u32, u32)>,
}

/// What changes: positions and normals.
pub(crate) struct MovingKnots {
    /// Position relative to `center`, three floats, and octahedral normal.
    pub knots: Vec<[u32; 4]>,
    pub center: DVec3,
    /// Of the centre lines, relative to `center`.
    pub bounds: Bounds,
    /// Longest distance between neighbouring knots, in yarn radii there.
    pub slenderness: f64,
}

/// Turns over a whole curve: whole part and rest.
fn split(turns: f64) -> (u32, f32) {
    (turns.floor() as u32, turns.fract() as f32)
}

/// A unit vector as the octahedral map in two 16-bit signed fractions.
pub fn pack_unit_vector(v: [f32; 3]) -> u32 {
    let v = Vec3::from(v);
    let v = v / (v.x.abs() + v.y.abs() + v.z.abs());
    let wrap = |a: f32, b: f32| (1.0 - b.abs()).copysign(a);
    let (x, y) = if v.z < 0.0 { (wrap(v.x, v.y), wrap(v.y, v.x)) } else { (v.x, v.y) };
    let code = |c: f32| u32::from((c.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    code(x) | (code(y) << 16)
}

impl RestKnots {
    pub fn new(strands: &Strands, yarn: &Yarn) -> Self {
        let radius_max = f64::from(strands.radii().iter().copied().fold(0.0, f32::max));
        let padded = strands.positions().len() + 3 * strands.closed().len();
        let mut rest = Self {
            rest: Vec::with_capacity(padded),
            curve: Vec::with_capacity(padded),
            curves: Vec::with_capacity(strands.closed().len()),
            radius_max,
            radii_codes: Vec::new(),
            source: Vec::with_capacity(padded),
            reflected: Vec::new(),
        };
        for curve in 0..strands.closed().len() {
            rest.add_curve(strands, yarn, curve);
        }
        rest.radii_codes = rest.rest.iter().map(|[_, code]| *code).collect();
        rest
    }

    fn add_curve(&mut self, strands: &Strands, yarn: &Yarn, curve: usize) {
        let (first, end) = (strands.offsets()[curve] as usize, strands.offsets()[curve + 1] as usize);
        let closed = strands.closed()[curve];
        let total = strands.total_lengths()[curve];
        // A closed curve's end is its start: 2³² is 0. An open one's is the largest code.
        let unit = if closed { 4_294_967_296.0 } else { 4_294_967_295.0 };
        let code = |knot: usize| (strands.lengths()[knot] / total * unit).round() as u64 as u32;

        let turns = Twist::turns(yarn, total, strands.reference_radii()[curve], closed);
        let [(ply_whole, ply_rest), (fiber_whole, fiber_rest), (migration_whole, migration_rest)] = turns.map(split);
        self.curves.push(layout::Curve {
            ply_whole,
            ply_rest,
            fiber_whole,
            fiber_rest,
            migration_whole,
            migration_rest,
            closed_periods: if closed { migration_whole.max(1) } else { 0 },
            seed: hash_combine(0x11c5_1e00, curve as u32),
            rest_length: total as f32,
        });

        let start = self.source.len() as u32;
        let mut push = |knot: usize, length: u32, begins: bool| {
            self.source.push(knot as u32);
            let radius = (f64::from(strands.radii()[knot]) / self.radius_max * 65535.0).round() as u32;
            self.rest.push([length, radius | if begins { KNOT_BEGINS_SEGMENT } else { 0 }]);
            self.curve.push(curve as u32);
        };
        if closed {
            push(end - 1, code(end - 1), false);
            (first..end).for_each(|knot| push(knot, code(knot), true));
            push(first, code(first), false);
            push(first + 1, code(first + 1), false);
        } else {
            push(first, code(first).wrapping_mul(2).wrapping_sub(code(first + 1)), false);
            (first..end).for_each(|knot| push(knot, code(knot), knot + 1 < end));
            push(end - 1, code(end - 1).wrapping_mul(2).wrapping_sub(code(end - 2)), false);
            let last = start + (end - first) as u32 + 1;
            self.reflected.push((start, start + 1, start + 2));
            self.reflected.push((last, last - 1, last - 2));
        }
    }

    /// Segments that are drawn.
    pub fn segment_count(&self) -> usize {
        self.radii_codes.iter().filter(|code| **code & KNOT_BEGINS_SEGMENT != 0).count()
    }

    pub fn len(&self) -> usize {
        self.source.len()
    }

    fn slenderness(&self, positions: &[Vec3]) -> f64 {
        let ratio = |knot: usize| {
            if self.radii_codes[knot] & KNOT_BEGINS_SEGMENT == 0 {
                return 0.0;
            }
            let radius = |k: usize| (self.radii_codes[k] & 0xffff).max(1) as f32 / 65535.0 * self.radius_max as f32;
            positions[knot].distance(positions[knot + 1]) / radius(knot).max(radius(knot + 1))
        };
        f64::from((0..self.len()).map(ratio).fold(0.0, f32::max))
    }

    pub fn moving(&self, strands: &Strands) -> MovingKnots {
        let mut bounds = Bounds::EMPTY;
        strands.positions().iter().for_each(|p| bounds.include(Vec3::from(*p).as_dvec3()));
        let center = 0.5 * (bounds.min + bounds.max);
        let relative = |knot: u32| (Vec3::from(strands.positions()[knot as usize]).as_dvec3() - center).as_vec3();
        let mut positions: Vec<Vec3> = self.source.iter().map(|knot| relative(*knot)).collect();
        for (end, inner, next) in &self.reflected {
            positions[*end as usize] = 2.0 * positions[*inner as usize] - positions[*next as usize];
        }
        let slenderness = self.slenderness(&positions);
        let normals = strands.normals();
        let packed = |(position, knot): (&Vec3, &u32)| {
            let [x, y, z] = position.to_array().map(f32::to_bits);
            [x, y, z, pack_unit_vector(normals[*knot as usize])]
        };
        MovingKnots {
            knots: positions.iter().zip(&self.source).map(packed).collect(),
            center,
            bounds: Bounds { min: bounds.min - center, max: bounds.max - center },
            slenderness,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_vectors_survive_packing() {
        let unpack = |code: u32| {
            let e = [code as u16 as i16, (code >> 16) as u16 as i16].map(|c| f32::from(c) / 32767.0);
            let mut v = Vec3::new(e[0], e[1], 1.0 - e[0].abs() - e[1].abs());
            let fold = (-v.z).max(0.0);
            v.x -= fold.copysign(v.x);
            v.y -= fold.copysign(v.y);
            v.normalize()
        };
        for i in 0..2000 {
            let z = f32::from(i as i16) / 1000.0 - 0.9995;
            let v = Vec3::new((1.0 - z * z).sqrt() * (i as f32).cos(), (1.0 - z * z).sqrt() * (i as f32).sin(), z);
            assert!(unpack(pack_unit_vector(v.to_array())).distance(v) < 1e-4, "{v}");
        }
    }
}
