// Level of detail [WuYuksel2018 §3.3] and subdivision by screen-space error.

// What a knot's distance to the viewer leaves of a yarn. Interpolated along a segment, so that neighbours agree at knots.
struct Detail {
    // λ² of Eq. 4: the share of the fibers drawn one by one.
    fibers: f32,
    // The share of the flyaways drawn, each as much wider: their area stays.
    flyaways: f32,
}

// Flyaways of a ply that remain from however far: fewer would be wider than the ply.
const LEAST_FLYAWAYS: f32 = 3.0;

fn detail_at(yarn: Yarn, radius_pixels: f32, lod_pixels: f32) -> Detail {
    let fiber = 2.0 * yarn.fiber_radius * radius_pixels;
    let ply = (yarn.ellipse_short + yarn.ellipse_long) * radius_pixels;
    var lambda = 1.0;
    if ply <= lod_pixels {
        lambda = 0.0;
    } else if fiber < lod_pixels {
        lambda = fiber / lod_pixels * (ply - lod_pixels) / (ply - fiber);
    }
    let fewest = min(LEAST_FLYAWAYS / f32(max(yarn.flyaway_fibers, 1u)), 1.0);
    let flyaways = clamp(fiber / max(lod_pixels, 1e-20), fewest, 1.0);
    return Detail(lambda * lambda, flyaways);
}

// Fibers of one ply to draw at that detail; the last of them fades.
fn fiber_count(yarn: Yarn, detail: Detail) -> u32 {
    return u32(ceil(max(detail.fibers * f32(yarn.fibers), detail.flyaways * f32(yarn.flyaway_fibers))));
}

// Factor on a fiber's width. Flyaways keep their area: the core leaves out as many fibers as are astray.
fn width_factor(yarn: Yarn, detail: Detail, rank: u32, flyaway: f32, taper: f32) -> f32 {
    let inside = clamp(detail.fibers * f32(yarn.fibers) - f32(rank), 0.0, 1.0);
    let outside = clamp(detail.flyaways * f32(yarn.flyaway_fibers) - f32(rank), 0.0, 1.0) / detail.flyaways;
    return taper * mix(inside, outside, flyaway);
}

// Chord error bound, pixels.
const CHORD_ERROR: f32 = 0.25;

// Most steps along one segment.
const MOST_STEPS: u32 = 128u;

// Second derivatives along a segment bound how far a chord is off: c'' / 8 for one step, and a fourth for twice as many.
// These are bounds on c'', in pixels, of the yarn's centre line (and its parallels, which bend as much more as they lie
// farther out) and of the windings around it.
fn bend_pixels(s: Segment, radius_pixels: f32) -> f32 {
    let bend = max(length(2.0 * s.position.c), length(2.0 * s.position.c + 6.0 * s.position.d));
    let speed_squared = max(min(dot(s.heading.a, s.heading.a), dot(s.heading.a + s.heading.b + s.heading.c + s.heading.d,
        s.heading.a + s.heading.b + s.heading.c + s.heading.d)), 1e-30);
    return bend * (1.0 + s.radius.x * bend / speed_squared) * radius_pixels / max(s.radius.x, 1e-30);
}

// `amplitude`: of the radial wander, relative to the ply's half axis.
fn winding_pixels(yarn: Yarn, s: Segment, amplitude: f32, radius_pixels: f32) -> f32 {
    let radians = TAU * dot(s.length, vec4f(0.0, 1.0, 1.0, 1.0)) * s.turns;
    let ply = select(0.0, yarn.ply_sign * radians.x, yarn.plies > 1u);
    let around_ply = ply + yarn.fiber_sign * radians.y;
    return radius_pixels * (yarn.ply_distance * ply * ply
        + yarn.ellipse_long * (around_ply * around_ply + amplitude * radians.z * radians.z));
}

// However small the yarn on the screen, a step turns by no more than this (radians): its depth is a cubic.
const MOST_TURNING: f32 = 2.0;

// Turning of a fiber about the yarn's axis along the segment, as seen from there: about its ply and with it.
fn turning(yarn: Yarn, s: Segment) -> f32 {
    let radians = TAU * dot(s.length, vec4f(0.0, 1.0, 1.0, 1.0)) * abs(s.turns);
    return max(radians.y, select(0.0, radians.x, yarn.plies > 1u));
}

fn steps_for(yarn: Yarn, s: Segment, second_derivative_pixels: f32) -> u32 {
    let steps = max(sqrt(second_derivative_pixels / (8.0 * CHORD_ERROR)), turning(yarn, s) / MOST_TURNING);
    return clamp(u32(ceil(steps)), 1u, MOST_STEPS);
}

// Yarn radius in pixels up to which the steps of a typical hair keep all of them within the chord error (smooth.rs measures 0.07 radii).
const TYPICAL_HAIR_PIXELS: f32 = 3.5;

// Steps of a chunk of fibers that begins at rank `first`. Among flyaways a hair bends most: a typical one, or close up a short and
// far one, which few exceed.
fn fiber_steps(yarn: Yarn, s: Segment, first: u32, radius_pixels: f32) -> u32 {
    var amplitude = 0.5 * (1.0 - yarn.r_min);
    if first < yarn.flyaway_fibers {
        let close = radius_pixels > TYPICAL_HAIR_PIXELS;
        let loops = 0.5 * (yarn.loop_radius_mean + 2.0 * yarn.loop_radius_deviation - yarn.r_min);
        let rise = max(yarn.tip_min_mean + yarn.tip_span_mean + select(0.0, yarn.tip_span_deviation, close) - 1.0, 0.0);
        let width = clamp(max(abs(yarn.width_mean), select(0.8, 0.5, close) * yarn.width_deviation), 0.04, 0.45);
        amplitude = max(amplitude, max(loops, 2.0 * rise / (TAU * TAU * width * width)));
    }
    return steps_for(yarn, s, bend_pixels(s, radius_pixels) + winding_pixels(yarn, s, amplitude, radius_pixels));
}

fn core_steps(yarn: Yarn, s: Segment, radius_pixels: f32) -> u32 {
    return steps_for(yarn, s, bend_pixels(s, radius_pixels) + winding_pixels(yarn, s, 0.0, radius_pixels));
}
