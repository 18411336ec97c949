//! The visibility of fibers on the CPU, in f64: every fiber as a chain of short chords from `lisle_core::yarn`, and for every
//! pixel centre the nearest of the round tubes about them that its ray meets. No culling, no levels of detail, no tables.

use std::collections::HashSet;

use glam::{DVec2, DVec3, DVec4, Vec4Swizzles};
use lisle_core::sampling::{hash_combine, normal_from_hash, unit_from_hash};
use lisle_core::yarn::{
    Fiber, FiberTable, FiberType, HAIR_WIDTH, Knot, Segment, Twist, Yarn, YarnPoint, breaks, fiber_point,
};
use lisle_gpu::{Camera, Object};
use rayon::prelude::*;

/// What the ray through a pixel's centre meets first.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the view axis.
    pub depth: f64,
    pub normal: DVec3,
    pub tangent: DVec3,
    /// Radius of the fiber, units of length.
    pub radius: f64,
    /// Distance from the fiber's centre line over its radius.
    pub offset: f64,
    /// Which fiber of the scene.
    fiber: u64,
}

/// A pixel of the twin.
#[derive(Clone, Copy, Debug)]
pub struct Pixel {
    pub hit: Option<Hit>,
    /// Depth of the nearest other fiber.
    second: f64,
    /// Least depth of a fiber whose silhouette passes within [`EDGE`] pixels.
    edge: f64,
    /// Distance to the nearest silhouette of all fibers together, pixels: negative inside.
    pub signed_distance: f64,
}

const EMPTY: Pixel = Pixel { hit: None, second: f64::INFINITY, edge: f64::INFINITY, signed_distance: f64::INFINITY };

/// Pixels from a silhouette within which rounding decides.
const EDGE: f64 = 0.05;

/// Fiber radii that a chord reaches past its ends.
const GAP: f64 = 0.1;

/// Fiber radii of depth within which rounding decides between two fibers.
const TIE: f64 = 0.1;

impl Pixel {
    /// Whether rounding may change what this pixel shows: at a silhouette that nothing hides, or between two fibers at one depth.
    pub fn is_ambiguous(&self) -> bool {
        let Some(hit) = self.hit else { return self.edge.is_finite() };
        self.edge <= hit.depth + TIE * hit.radius || self.second <= hit.depth + TIE * hit.radius
    }
}

/// From the world to pixels, as the cameras define it: (x, y) · w, w and the distance along the view axis.
struct View {
    rows: [DVec4; 4],
    eye: DVec3,
    orthographic: bool,
    toward_viewer: DVec3,
    pixels_per_unit: f64,
}

impl View {
    fn new(camera: &Camera, size: [u32; 2]) -> Self {
        let [width, height] = size.map(f64::from);
        let camera_from_world = camera.world_from_camera.inverse();
        let clip_from_world = camera.clip_from_camera * camera_from_world;
        let [x, y, w] = [clip_from_world.row(0), clip_from_world.row(1), clip_from_world.row(3)];
        let clip = camera.clip_from_camera;
        Self {
            rows: [(x + w) * (0.5 * width), (w - y) * (0.5 * height), w, -camera_from_world.row(2)],
            eye: camera.world_from_camera.w_axis.xyz(),
            orthographic: clip.row(3) == DVec4::W,
            toward_viewer: camera.world_from_camera.z_axis.xyz().normalize(),
            pixels_per_unit: (clip.x_axis.x * width * clip.y_axis.y * height / 4.0).sqrt(),
        }
    }

    fn w(&self, p: DVec3) -> f64 {
        self.rows[2].dot(p.extend(1.0))
    }

    fn depth(&self, p: DVec3) -> f64 {
        self.rows[3].dot(p.extend(1.0))
    }

    fn pixel(&self, p: DVec3) -> DVec2 {
        DVec2::new(self.rows[0].dot(p.extend(1.0)), self.rows[1].dot(p.extend(1.0))) / self.w(p)
    }

    fn to_viewer(&self, p: DVec3) -> DVec3 {
        if self.orthographic { self.toward_viewer } else { (self.eye - p).normalize() }
    }
}

/// A point of a fiber in world space.
#[derive(Clone, Copy)]
struct Point {
    position: DVec3,
    tangent: DVec3,
    radius: f64,
    /// Which part of which migration period: lines join only within one, or across a period's end.
    piece: (Piece, u32),
}

#[derive(Clone, Copy, PartialEq)]
enum Piece {
    Ply,
    Hair,
    BeyondHair,
}

struct Chord {
    a: Point,
    b: Point,
    fiber: u64,
    /// Whether it is of a fiber that may fly away.
    flyaway: bool,
}

/// How wide a hair is drawn: it thins out towards its tip, as the ply's fiber does where the hair has left. This is the renderer's own
/// choice, which the yarn model does not know; restated from the model's hashes.
fn taper(yarn: &Yarn, twist: &Twist, table: &FiberTable, length: f64, fiber: Fiber) -> (f64, Piece, u32) {
    let ply_hash = hash_combine(fiber.seed, fiber.ply);
    let turns = table.migration_turns[fiber.index as usize] + unit_from_hash(hash_combine(ply_hash, 0x0fff_fff1));
    let phase = length * twist.migration + turns;
    let mut period = phase.floor() as u32;
    if let Some(count) = twist.closed_periods {
        period %= count.max(1);
    }
    let hash = hash_combine(hash_combine(ply_hash, fiber.index), period);
    let (loops, hairs) = yarn.flyaway_chances();
    let choice = unit_from_hash(hash);
    if fiber.index >= yarn.flyaway_fibers() || choice < loops || choice >= loops + hairs {
        return (1.0, Piece::Ply, period);
    }
    let span = yarn.flyaways.hair_z_span;
    let span = span.mean + span.deviation * normal_from_hash(hash_combine(hash, 2));
    let width = (span.abs() / yarn.migration_period()).clamp(HAIR_WIDTH.0, HAIR_WIDTH.1);
    let along = (phase.fract() - 0.5) * 1.0_f64.copysign(span) / width;
    if along < 0.0 {
        (1.0, Piece::Ply, period)
    } else if along <= 1.0 {
        (1.0 - along.powi(4), Piece::Hair, period)
    } else {
        let x = ((along - 1.0) * width / (0.5 - width).min(0.15)).clamp(0.0, 1.0);
        (x * x * (3.0 - 2.0 * x), Piece::BeyondHair, period)
    }
}

/// The knots about every segment of a curve, those beyond an open end by reflection.
fn segments(object: &Object, curve: usize) -> Vec<Segment> {
    let strands = object.yarns.strands();
    let (first, end) = (strands.offsets()[curve] as usize, strands.offsets()[curve + 1] as usize);
    let (count, closed, total) = ((end - first) as isize, strands.closed()[curve], strands.total_lengths()[curve]);
    let inside = |i: usize| Knot {
        position: glam::Vec3::from(strands.positions()[i]).as_dvec3(),
        normal: glam::Vec3::from(strands.normals()[i]).as_dvec3(),
        length: strands.lengths()[i],
        radius: strands.radii()[i].into(),
    };
    let knot = |i: isize| {
        if closed {
            let k = inside(first + i.rem_euclid(count) as usize);
            return Knot { length: k.length + total * i.div_euclid(count) as f64, ..k };
        }
        let at = inside(first + i.clamp(0, count - 1) as usize);
        if i >= 0 && i < count {
            return at;
        }
        let next = inside(if i < 0 { first + 1 } else { end - 2 });
        Knot { position: at.position * 2.0 - next.position, length: at.length * 2.0 - next.length, ..at }
    };
    (0..if closed { count } else { count - 1 })
        .map(|i| Segment::new([knot(i - 1), knot(i), knot(i + 1), knot(i + 2)]))
        .collect()
}

/// How a fiber is divided into chords, and what a chord covers.
#[derive(Clone, Copy)]
struct Chain {
    /// Even steps a segment.
    steps: u32,
    /// Whether chords end where the fiber's curve breaks: at tips of hairs, and where it changes its kind.
    at_breaks: bool,
    /// Whether chords have round ends: together they have the outline of the tube, also of one that points at the viewer, but past their ends no surface of it.
    round_ends: bool,
}

/// Share of a segment that keeps a point on its own side of a tip.
const ASIDE: f64 = 1e-9;

/// Where a segment has a length coordinate.
fn parameter(segment: &Segment, length: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if segment.at(middle).length < length { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The points of even steps, with those on both sides of each break in their order.
fn with_breaks(segment: &Segment, even: &[YarnPoint], breaks: impl Iterator<Item = f64>) -> Vec<YarnPoint> {
    let mut parameters: Vec<f64> = (0..even.len()).map(|k| k as f64 / (even.len() - 1) as f64).collect();
    for length in breaks {
        let t = parameter(segment, length);
        parameters.extend([t - ASIDE, t + ASIDE].map(|t| t.clamp(0.0, 1.0)));
    }
    parameters.sort_by(f64::total_cmp);
    parameters.into_iter().map(|t| segment.at(t)).collect()
}

/// Chords of all fibers of an object.
fn chords(object: &Object, number: u64, Chain { steps, at_breaks, .. }: Chain) -> Vec<Chord> {
    let (strands, yarn) = (object.yarns.strands(), &*object.yarn);
    let table = FiberTable::new(yarn);
    let scale = object.world_from_object.determinant().abs().cbrt();
    let object_seed = hash_combine(0x00b1_ec70, object.id);
    let mut all = Vec::new();
    for curve in 0..strands.closed().len() {
        let (total, reference) = (strands.total_lengths()[curve], strands.reference_radii()[curve]);
        let twist = Twist::new(yarn, total, reference, strands.closed()[curve]);
        let seed = hash_combine(object_seed, hash_combine(0x11c5_1e00, curve as u32));
        let fiber_radius = yarn.fiber_radius / yarn.outer_radius();
        all.par_extend(segments(object, curve).into_par_iter().flat_map_iter(|segment| {
            let points: Vec<_> = (0..=steps).map(|k| segment.at(f64::from(k) / f64::from(steps))).collect();
            let mut own = Vec::with_capacity(points.len() * (yarn.plies * yarn.fibers_per_ply) as usize);
            for (ply, index) in (0..yarn.plies).flat_map(|p| (0..yarn.fibers_per_ply).map(move |i| (p, i))) {
                let fiber = Fiber { seed, ply, index };
                let id = ((number * 4096 + curve as u64) * 4096 + u64::from(ply)) * 4096 + u64::from(index);
                let mut previous: Option<Point> = None;
                let broken = (at_breaks && index < yarn.flyaway_fibers()).then(|| {
                    let found = breaks(yarn, &twist, &table, fiber, (points[0].length, points[steps as usize].length));
                    with_breaks(&segment, &points, found.into_iter().map(|b| b.length))
                });
                for at in broken.as_ref().unwrap_or(&points) {
                    let f = fiber_point(yarn, &twist, &table, at, fiber);
                    let (taper, piece, period) = taper(yarn, &twist, &table, at.length, fiber);
                    assert_eq!(piece == Piece::Hair, f.kind == FiberType::Hair, "the twin's own hairs are the model's");
                    let point = Point {
                        position: object.world_from_object.transform_point3(f.position),
                        tangent: object.world_from_object.transform_vector3(f.velocity).normalize(),
                        radius: at.radius * scale * fiber_radius * taper,
                        piece: (piece, period),
                    };
                    if let Some(a) = previous.filter(|a| joined(a.piece, point.piece)) {
                        own.push(Chord { a, b: point, fiber: id, flyaway: index < yarn.flyaway_fibers() });
                    }
                    previous = Some(point);
                }
            }
            own
        }));
    }
    all
}

/// A hair's tip is not joined to what lies beyond it.
fn joined(a: (Piece, u32), b: (Piece, u32)) -> bool {
    (a.0 == Piece::BeyondHair) == (b.0 == Piece::BeyondHair) || a.1 != b.1
}

/// The picture of some objects, `steps` chords a segment, and more where a fiber's curve breaks.
pub fn picture(objects: &[Object], camera: &Camera, size: [u32; 2], steps: u32) -> Vec<Pixel> {
    picture_of(objects, camera, size, Chain { steps, at_breaks: true, round_ends: false })
}

/// The same for outlines alone.
pub fn outline(objects: &[Object], camera: &Camera, size: [u32; 2], steps: u32) -> Vec<Pixel> {
    picture_of(objects, camera, size, Chain { steps, at_breaks: true, round_ends: true })
}

/// Outlines of chords in even steps, whatever happens in between: a hair ends with its last whole step.
pub fn outline_of_even_steps(objects: &[Object], camera: &Camera, size: [u32; 2], steps: u32) -> Vec<Pixel> {
    picture_of(objects, camera, size, Chain { steps, at_breaks: false, round_ends: true })
}

fn picture_of(objects: &[Object], camera: &Camera, size: [u32; 2], chain: Chain) -> Vec<Pixel> {
    let view = View::new(camera, size);
    let chords: Vec<Chord> = objects.iter().zip(0..).flat_map(|(o, number)| chords(o, number, chain)).collect();
    const BAND: usize = 8;
    let [width, height] = size.map(|s| s as usize);
    let mut pixels = vec![EMPTY; width * height];
    pixels.par_chunks_mut(width * BAND).enumerate().for_each(|(band, pixels)| {
        let rows = band * BAND..(band * BAND + pixels.len() / width);
        for chord in &chords {
            draw(&view, chord, chain.round_ends, width, rows.clone(), pixels);
        }
    });
    pixels
}

fn draw(
    view: &View,
    chord: &Chord,
    round_ends: bool,
    width: usize,
    rows: std::ops::Range<usize>,
    pixels: &mut [Pixel],
) {
    let (wa, wb) = (view.w(chord.a.position), view.w(chord.b.position));
    if wa <= 1e-3 || wb <= 1e-3 {
        return;
    }
    let (a, b) = (view.pixel(chord.a.position), view.pixel(chord.b.position));
    let (ra, rb) = (chord.a.radius * view.pixels_per_unit / wa, chord.b.radius * view.pixels_per_unit / wb);
    // Far enough to know the distance to a silhouette from outside.
    let reach = ra.max(rb) + 4.0;
    let range = |low: f64, high: f64, from: usize, to: usize| {
        let first = (low - reach - 0.5).ceil().clamp(from as f64, to as f64) as usize;
        first..(((high + reach - 0.5).floor() + 1.0).clamp(first as f64, to as f64) as usize)
    };
    let along = b - a;
    for y in range(a.y.min(b.y), a.y.max(b.y), rows.start, rows.end) {
        for x in range(a.x.min(b.x), a.x.max(b.x), 0, width) {
            let center = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let on_screen = (center - a).dot(along) / along.length_squared().max(1e-20);
            let t = on_screen.clamp(0.0, 1.0);
            let radius = ra + (rb - ra) * t;
            let away = center - (a + along * t);
            // Past its ends a chord only closes the gap that its bend to the next one opens.
            let past = if round_ends { 0.0 } else { (on_screen - t).abs() * along.length() };
            if past > EDGE + GAP * radius {
                continue;
            }
            let distance = (away.length_squared() - past * past).max(0.0).sqrt();
            let pixel = &mut pixels[(y - rows.start) * width + x];
            // A tube of no width is not drawn.
            if radius <= 0.0 {
                continue;
            }
            pixel.signed_distance = pixel.signed_distance.min(distance - radius);
            if distance > radius + EDGE {
                continue;
            }
            // Equal steps on the screen are not equal steps in space.
            let share = t * wa / (wb + t * (wa - wb));
            let position = chord.a.position.lerp(chord.b.position, share);
            let tangent = chord.a.tangent.lerp(chord.b.tangent, share).normalize();
            let to_viewer = view.to_viewer(position);
            let sin_view = tangent.cross(to_viewer).length().max(1e-6);
            let across = tangent.cross(to_viewer) / sin_view;
            // The side on which the pixel lies, by moving the point a little.
            let moved = view.pixel(position + across * (1e-4 * chord.a.radius.max(1e-9))) - view.pixel(position);
            let x = (distance / radius).min(1.0) * away.dot(moved).signum();
            let up = (1.0 - x * x).sqrt();
            let surface = chord.a.radius + (chord.b.radius - chord.a.radius) * share;
            // A ray meets a tube that leans towards it earlier.
            let depth = view.depth(position) - up * surface / sin_view.max(0.2);
            // What it meets there lies beside a place of the fiber farther along: each direction is that of its own place.
            let farther = up * surface * (tangent.dot(to_viewer) / sin_view).clamp(-1.0, 1.0);
            let beyond = farther / chord.a.position.distance(chord.b.position).max(1e-20);
            let beyond = if chord.flyaway { 0.0 } else { beyond };
            let tangent = chord.a.tangent.lerp(chord.b.tangent, share + beyond).normalize();
            let across = tangent.cross(to_viewer).normalize_or(across);
            let forward = across.cross(tangent);
            if (distance - radius).abs() < EDGE {
                pixel.edge = pixel.edge.min(depth);
            }
            if distance > radius {
                continue;
            }
            let hit = Hit {
                depth,
                normal: across * x + forward * up,
                tangent,
                radius: surface,
                offset: x.abs(),
                fiber: chord.fiber,
            };
            match pixel.hit {
                Some(best) if best.fiber == hit.fiber => {
                    if hit.depth < best.depth {
                        pixel.hit = Some(hit);
                    }
                }
                Some(best) if hit.depth < best.depth => {
                    pixel.second = best.depth;
                    pixel.hit = Some(hit);
                }
                Some(_) => pixel.second = pixel.second.min(hit.depth),
                None => pixel.hit = Some(hit),
            }
        }
    }
}

/// World position of the first fiber of the first curve, at a segment's parameter.
pub fn fiber_position(object: &Object, segment: usize, t: f64) -> DVec3 {
    let (strands, yarn) = (object.yarns.strands(), &*object.yarn);
    let twist = Twist::new(yarn, strands.total_lengths()[0], strands.reference_radii()[0], strands.closed()[0]);
    let seed = hash_combine(hash_combine(0x00b1_ec70, object.id), hash_combine(0x11c5_1e00, 0));
    let at = segments(object, 0)[segment].at(t);
    let fiber = Fiber { seed, ply: 0, index: 0 };
    object.world_from_object.transform_point3(fiber_point(yarn, &twist, &FiberTable::new(yarn), &at, fiber).position)
}

/// World positions on the first fiber of the first curve, in a range of segments: the tip of its first hair, and the outermost point of its first loop.
pub fn flyaways(object: &Object, range: std::ops::Range<usize>) -> [Option<DVec3>; 2] {
    let (strands, yarn) = (object.yarns.strands(), &*object.yarn);
    let twist = Twist::new(yarn, strands.total_lengths()[0], strands.reference_radii()[0], strands.closed()[0]);
    let seed = hash_combine(hash_combine(0x00b1_ec70, object.id), hash_combine(0x11c5_1e00, 0));
    let (table, fiber) = (FiberTable::new(yarn), Fiber { seed, ply: 0, index: 0 });
    let segments = segments(object, 0);
    let length = |segment: usize, t: f64| segments[segment].at(t).length;
    let found = |length: f64| {
        let at = range.clone().find(|segment| segments[*segment].at(1.0).length >= length)?;
        let at = segments[at].at(parameter(&segments[at], length));
        Some((fiber_point(yarn, &twist, &table, &at, fiber), object.world_from_object))
    };
    let breaks = breaks(yarn, &twist, &table, fiber, (length(range.start, 0.0), length(range.end - 1, 1.0)));
    let tip = breaks.iter().find(|b| b.tip).and_then(|b| found(b.length - 1e-6 / twist.migration));
    // A period without a break inside is a loop if it is none of the ply's own.
    let apex = breaks
        .windows(2)
        .find_map(|pair| found(0.5 * (pair[0].length + pair[1].length)).filter(|(f, _)| f.kind == FiberType::Loop));
    [tip, apex].map(|found| found.map(|(f, world)| world.transform_point3(f.position)))
}

/// Number of distinct fibers that a picture shows.
pub fn fibers_seen(pixels: &[Pixel]) -> usize {
    pixels.iter().filter_map(|p| p.hit).map(|hit| hit.fiber).collect::<HashSet<_>>().len()
}
