// Level of detail [WuYuksel2018 §3.3].

// What a knot's distance to the viewer leaves of a yarn. Interpolated along a segment, so that neighbours agree at knots.
struct Detail {
    // λ² of Eq. 4: the share of the fibers drawn one by one.
    fibers: f32,
    // The share of the flyaways drawn, each as much wider: their area stays.
    flyaways: f32,
}

// Flyaways of a ply that remain: fewer would be wider than the ply. Where it is thinner than a pixel itself, they may be as wide as that.
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
    let fewest = min(max(LEAST_FLYAWAYS * min(ply, 1.0), 1.0) / f32(max(yarn.flyaway_fibers, 1u)), 1.0);
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
