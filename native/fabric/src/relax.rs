//! Relaxation: from the first guess to the shape that a springy yarn of finite thickness takes.
//!
//! How it works. The cloth is endless: one [`Cell`] repeats in x and y. Its yarn is a rod with resistance to bending
//! and a fixed length per stitch; yarns push each other apart when their centre lines come closer than two radii;
//! and a light pressure in the plane of the cloth pulls loose loops together. The energy
//!
//!   E = ½ `STRETCH` Σ (l − l₀)²/l₀ + ½ `BEND` Σ |p₋ − 2p + p₊|²/l₀³ + ½ `CONTACT` Σ (2r − d)² h²
//!       + `PRESSURE` · area + ½ `FLATTEN` Σ l₀ z²
//!
//! (l: distance of neighbouring control points, d: distance of two samples of the Catmull-Rom curve, h: their
//! spacing; `FOLD` stiffens sharp bends) is minimised over the control points AND the width and height of the cell,
//! with FIRE: damped dynamics that stop whenever they run uphill (Bitzek et al. 2006). Everything runs in one fixed
//! order: the result is the same in every process. Lengths are in yarn radii.

use crate::cell::Cell;
use glam::{DVec2, DVec3};

// The weights below were tuned by eye and by measure on stockinette, garter and ribs: the softest cloth whose loops
// stay symmetric, whose ribs do not fold their purl wales out of sight, and whose yarn bends no tighter than its
// own radius.

/// Stiffness against a change of length, per radius of yarn.
const STRETCH: f64 = 100.0;
/// Stiffness against bending.
const BEND: f64 = 3.0;
/// More of it where the yarn bends tighter than [`TIGHT_BEND`]: a yarn cannot fold tighter than its own thickness.
const FOLD: f64 = 30.0;
/// Radius of curvature where [`FOLD`] sets in.
const TIGHT_BEND: f64 = 1.5;
/// Stiffness of a contact, per radius of yarn on either side.
const CONTACT: f64 = 300.0;
/// Pressure in the plane of the cloth.
const PRESSURE: f64 = 0.05;
/// Pull towards the middle plane of the cloth, per radius of yarn and of height: cloth that was pressed after
/// knitting. Without it ribs and garter contract to a cushion, as they do on the needle.
const FLATTEN: f64 = 0.1;

/// Samples of the curve per segment, for contacts.
const SAMPLES: usize = 3;
/// Samples of one yarn nearer than this along the yarn never push each other: bending keeps them apart.
const NEIGHBOURHOOD: f64 = std::f64::consts::PI;
/// Pairs are listed up to this much beyond contact, and listed anew when anything may have come that far.
const SKIN: f64 = 0.6;
/// No point moves farther in one step, so that no yarn passes through another.
const LARGEST_STEP: f64 = 0.05;
/// The yarn grows from this part of its radius to all of it, in this many steps.
const FIRST_THICKNESS: f64 = 0.4;
const GROWTH_STEPS: usize = 2000;
/// The solver rests when the root mean square of the forces is below this, or after this many steps: large repeats
/// then still drift slowly in size, which does no harm, since the clearance is measured afterwards.
const TOLERANCE: f64 = 1e-3;
const STEPS: usize = 20_000;

/// Relaxes a cell whose yarn shall have `loop_length` radii of yarn per stitch.
pub(crate) fn relax(mut cell: Cell, loop_length: f64) -> Cell {
    let rest = loop_length / crate::cell::POINTS_PER_STITCH as f64;
    let n = cell.points.len();
    let mut velocity = vec![DVec3::ZERO; n];
    let mut size_velocity = DVec2::ZERO;
    // The strains of the cell are two more unknowns, in units that let them move about as fast as the points.
    let strain_unit = 1.0 / (cell.size * n as f64).powf(0.5);
    let mut step = 0.02;
    let mut mixing = 0.1;
    let mut downhill = 0;
    let mut contacts = Contacts::default();
    for iteration in 0..STEPS {
        let growth = (iteration as f64 / GROWTH_STEPS as f64).min(1.0);
        let diameter = 2.0 * (FIRST_THICKNESS + (1.0 - FIRST_THICKNESS) * growth);
        let (force, strain_force) = forces(&cell, rest, diameter, &mut contacts);
        let size_force = strain_force * strain_unit;

        let power: f64 =
            force.iter().zip(&velocity).map(|(f, v)| f.dot(*v)).sum::<f64>() + size_force.dot(size_velocity);
        let force_norm = (force.iter().map(|f| f.length_squared()).sum::<f64>() + size_force.length_squared()).sqrt();
        if iteration > GROWTH_STEPS && force_norm < TOLERANCE * (n as f64).sqrt() {
            break;
        }
        let speed = (velocity.iter().map(|v| v.length_squared()).sum::<f64>() + size_velocity.length_squared()).sqrt();
        if power > 0.0 {
            downhill += 1;
            let towards = mixing * speed / force_norm.max(1e-12);
            for (v, f) in velocity.iter_mut().zip(&force) {
                *v = *v * (1.0 - mixing) + *f * towards;
            }
            size_velocity = size_velocity * (1.0 - mixing) + size_force * towards;
            if downhill > 5 {
                step = f64::min(step * 1.1, 0.15);
                mixing *= 0.99;
            }
        } else {
            downhill = 0;
            step *= 0.5;
            mixing = 0.1;
            velocity.fill(DVec3::ZERO);
            size_velocity = DVec2::ZERO;
        }
        step = step.max(1e-3);

        let mut largest = 0.0_f64;
        for (v, f) in velocity.iter_mut().zip(&force) {
            *v += *f * step;
            largest = largest.max(v.length());
        }
        size_velocity += size_force * step;
        let brake = (LARGEST_STEP / (largest * step).max(1e-12)).min(1.0);
        for (point, v) in cell.points.iter_mut().zip(&mut velocity) {
            *v *= brake;
            *point += *v * step;
        }
        let strain = (size_velocity * step * strain_unit).clamp(DVec2::splat(-2e-3), DVec2::splat(2e-3));
        let scale = DVec3::new(1.0 + strain.x, 1.0 + strain.y, 1.0);
        cell.size *= scale.truncate();
        for point in &mut cell.points {
            *point *= scale;
        }
    }
    let mean_height = cell.points.iter().map(|point| point.z).sum::<f64>() / n as f64;
    for point in &mut cell.points {
        point.z -= mean_height;
    }
    cell
}

/// Minus the gradient of the energy: for the points, and for the two strains of the cell.
fn forces(cell: &Cell, rest: f64, diameter: f64, contacts: &mut Contacts) -> (Vec<DVec3>, DVec2) {
    let n = cell.row_points;
    let sharpest = rest * rest / TIGHT_BEND;
    let mut force = vec![DVec3::ZERO; cell.points.len()];
    let mut strain_force = -PRESSURE * DVec2::splat(cell.size.x * cell.size.y);
    for row in 0..cell.rows {
        let base = row * n;
        for i in 0..n {
            let [before, here, after] = [-1, 0, 1].map(|offset| cell.point(row, i as isize + offset));
            let next = base + (i + 1) % n;
            let previous = base + (i + n - 1) % n;

            let edge = after - here;
            let length = edge.length();
            let pull = edge * (STRETCH * (length - rest) / (rest * length));
            force[base + i] += pull;
            force[next] -= pull;
            strain_force -= (pull * edge).truncate();

            let second_difference = before - 2.0 * here + after;
            let bend = second_difference.length();
            let excess = (bend - sharpest).max(0.0) / bend.max(1e-12);
            let moment = second_difference * ((BEND + FOLD * excess) / rest.powi(3));
            force[previous] -= moment;
            force[base + i] += 2.0 * moment;
            force[next] -= moment;
            strain_force -= (moment * second_difference).truncate();
        }
    }
    for (f, point) in force.iter_mut().zip(&cell.points) {
        f.z -= FLATTEN * rest * point.z;
    }
    contacts.update(cell, rest, diameter);
    let spacing = rest / SAMPLES as f64;
    let stiffness = CONTACT * spacing * spacing;
    for pair in &contacts.pairs {
        let (a, b) = (pair.a as usize, pair.b as usize);
        let difference = contacts.samples[b] + (pair.repeats * cell.size).extend(0.0) - contacts.samples[a];
        let distance = difference.length();
        if distance < diameter {
            // Every pair is listed from both of its sides: this is what `a` feels.
            let push = difference * (stiffness * (diameter - distance) / distance.max(1e-9));
            contacts.spread(&mut force, n, a, -push);
            strain_force += 0.5 * (push * difference).truncate();
        }
    }
    (force, strain_force)
}

struct Pair {
    a: u32,
    b: u32,
    /// In which repeat of the cell `b` lies.
    repeats: DVec2,
}

/// Samples of the curves and the pairs of them that may touch.
#[derive(Default)]
struct Contacts {
    samples: Vec<DVec3>,
    pairs: Vec<Pair>,
    /// The samples, the cell's size and the diameter when the pairs were listed.
    listed: Option<(Vec<DVec3>, DVec2, f64)>,
}

/// Weights of four control points at `k / SAMPLES` of a uniform Catmull-Rom segment.
fn weights(k: usize) -> [f64; 4] {
    let t = k as f64 / SAMPLES as f64;
    crate::distance::catmull_rom_weights(t)
}

impl Contacts {
    fn update(&mut self, cell: &Cell, rest: f64, diameter: f64) {
        self.samples.clear();
        for row in 0..cell.rows {
            for i in 0..cell.row_points {
                let window = [-1, 0, 1, 2].map(|offset| cell.point(row, i as isize + offset));
                for k in 0..SAMPLES {
                    self.samples.push(window.iter().zip(weights(k)).map(|(point, weight)| *point * weight).sum());
                }
            }
        }
        let stale = self.listed.as_ref().is_none_or(|(samples, size, listed_diameter)| {
            let strain = ((cell.size - *size) / *size).abs().max_element();
            let moved = samples.iter().zip(&self.samples).map(|(a, b)| a.distance_squared(*b)).fold(0.0, f64::max);
            // Images lie at most a repeat or two away: a strain moves them by that much of the cell.
            2.0 * (moved.sqrt() + strain * (cell.size.max_element() + 20.0)) + diameter - listed_diameter > SKIN
        });
        if stale {
            self.list_pairs(cell, rest, diameter + SKIN);
            self.listed = Some((self.samples.clone(), cell.size, diameter));
        }
    }

    fn list_pairs(&mut self, cell: &Cell, rest: f64, reach: f64) {
        self.pairs.clear();
        let row_samples = cell.row_points * SAMPLES;
        let neighbours = (NEIGHBOURHOOD / rest * SAMPLES as f64).ceil() as i64;
        let (mut low, mut high) = (DVec2::MAX, DVec2::MIN);
        for sample in &self.samples {
            low = low.min(sample.truncate());
            high = high.max(sample.truncate());
        }
        low -= reach;
        high += reach;
        // A grid over the cell and the repeats of it that reach into its surroundings.
        let grid = ((high - low) / reach).ceil();
        let (width, height) = (grid.x as usize, grid.y as usize);
        let bin = |point: DVec2| {
            let place = (point - low) / reach;
            (place.cmpge(DVec2::ZERO).all() && place.cmplt(grid).all()).then_some((place.x as usize, place.y as usize))
        };
        let mut bins: Vec<Vec<(u32, DVec2)>> = vec![Vec::new(); width * height];
        let repeats = ((high - low) / cell.size).ceil();
        for y in -(repeats.y as i64)..=repeats.y as i64 {
            for x in -(repeats.x as i64)..=repeats.x as i64 {
                let shift = DVec2::new(x as f64, y as f64);
                for (index, sample) in self.samples.iter().enumerate() {
                    if let Some((column, row)) = bin(sample.truncate() + shift * cell.size) {
                        bins[row * width + column].push((index as u32, shift));
                    }
                }
            }
        }
        for (a, sample) in self.samples.iter().enumerate() {
            let Some((column, row)) = bin(sample.truncate()) else { continue };
            for y in row.saturating_sub(1)..=(row + 1).min(height - 1) {
                for x in column.saturating_sub(1)..=(column + 1).min(width - 1) {
                    for &(b, repeats) in &bins[y * width + x] {
                        let other = self.samples[b as usize] + (repeats * cell.size).extend(0.0);
                        if sample.distance_squared(other) > reach * reach {
                            continue;
                        }
                        let same_yarn = a / row_samples == b as usize / row_samples && repeats.y == 0.0;
                        let along = b as i64 - a as i64 + repeats.x as i64 * row_samples as i64;
                        if !(same_yarn && along.abs() <= neighbours) {
                            self.pairs.push(Pair { a: a as u32, b, repeats });
                        }
                    }
                }
            }
        }
    }

    /// Hands a force on a sample to the four control points that place it.
    fn spread(&self, force: &mut [DVec3], row_points: usize, sample: usize, push: DVec3) {
        let (control, k) = (sample / SAMPLES, sample % SAMPLES);
        let (row, i) = (control / row_points, control % row_points);
        for (offset, weight) in weights(k).iter().enumerate() {
            force[row * row_points + (i + row_points + offset - 1) % row_points] += push * *weight;
        }
    }
}
