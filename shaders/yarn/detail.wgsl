// Level of detail [WuYuksel2018 §3.3] and subdivision by screen-space error.

// What a knot's distance to the viewer leaves of a yarn. Interpolated along a segment, so that neighbours agree at knots.
struct Detail {
    // λ² of Eq. 4: the share of the fibers drawn one by one.
    fibers: f32,
    // The share of the flyaways drawn, each as much wider: their area stays.
    flyaways: f32,
}

fn detail_at(yarn: Yarn, radius_pixels: f32, lod_pixels: f32) -> Detail {
    let fiber = 2.0 * yarn.fiber_radius * radius_pixels;
    let ply = (yarn.ellipse_short + yarn.ellipse_long) * radius_pixels;
    var lambda = 1.0;
    if ply <= lod_pixels {
        lambda = 0.0;
    } else if fiber < lod_pixels {
        lambda = fiber / lod_pixels * (ply - lod_pixels) / (ply - fiber);
    }
    let flyaways = clamp(fiber / max(lod_pixels, 1e-20), 1.0 / f32(max(yarn.flyaway_fibers, 1u)), 1.0);
    return Detail(lambda * lambda, flyaways);
}

// Fibers of one ply to draw at that detail; the last of them fades.
fn fiber_count(yarn: Yarn, detail: Detail) -> u32 {
    return u32(ceil(max(detail.fibers * f32(yarn.fibers), detail.flyaways * f32(yarn.flyaway_fibers))));
}

// Factor on a fiber's width. Flyaways keep their area while they are outside of the ply.
fn width_factor(yarn: Yarn, detail: Detail, index: u32, f: FiberPoint) -> f32 {
    let inside = clamp(detail.fibers * f32(yarn.fibers) - f32(index), 0.0, 1.0);
    let outside = clamp(detail.flyaways * f32(yarn.flyaway_fibers) - f32(index), 0.0, 1.0) / detail.flyaways;
    return f.taper * mix(inside, outside, f.flyaway * smoothstep(0.95, 1.1, f.relative_radius));
}

// Chord error bound, pixels.
const CHORD_ERROR: f32 = 0.25;

// Steps per segment for a curve that winds at `distance` (yarn radii) around the yarn centre by `turning` radians:
// a chord of an arc of angle a and radius r is off by r a² / 8.
fn step_count(bend_pixels: f32, turning: f32, distance: f32, radius_pixels: f32, most: u32) -> u32 {
    let sagitta = bend_pixels + distance * radius_pixels * turning * turning;
    return clamp(u32(ceil(sqrt(sagitta / (8.0 * CHORD_ERROR)))), 1u, most);
}
