// Level of detail [WuYuksel2018 §3.3].

// λ² of Eq. 4: the share of the fibers drawn one by one. Interpolated along a segment, so that neighbours agree at knots.
fn fiber_share(yarn: Yarn, radius_pixels: f32, lod_pixels: f32) -> f32 {
    let fiber = 2.0 * yarn.fiber_radius * radius_pixels;
    let ply = (yarn.ellipse_short + yarn.ellipse_long) * radius_pixels;
    var lambda = 1.0;
    if ply <= lod_pixels {
        lambda = 0.0;
    } else if fiber < lod_pixels {
        lambda = fiber / lod_pixels * (ply - lod_pixels) / (ply - fiber);
    }
    return lambda * lambda;
}

// Of one ply, to draw for that share; the last of them fades.
fn fiber_count(yarn: Yarn, share: f32) -> u32 {
    return u32(ceil(share * f32(yarn.fibers)));
}

// Factor on a fiber's width.
fn width_factor(yarn: Yarn, share: f32, rank: u32, taper: f32) -> f32 {
    return taper * clamp(share * f32(yarn.fibers) - f32(rank), 0.0, 1.0);
}
