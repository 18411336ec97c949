// A thread as a whole [Sadeghi2012 Eq. 2-4], made to conserve energy; twin of native/core/src/scattering/thread.rs, where the
// factor and the limit are derived.

struct Thread {
    // A.
    color: vec3f,
    refraction: f32,
    // k_d.
    isotropic: f32,
    // γ_s and γ_v in θ_h.
    surface_width: f32,
    volume_width: f32,
}

const THREAD_SCALE: f32 = 0.125;

fn dielectric_reflectance(refraction: f32, cos_i: f32) -> f32 {
    let cos_t = sqrt(1.0 - max(1.0 - cos_i * cos_i, 0.0) / (refraction * refraction));
    let s = (cos_i - refraction * cos_t) / (cos_i + refraction * cos_t);
    let p = (refraction * cos_i - cos_t) / (refraction * cos_i + cos_t);
    return 0.5 * (s * s + p * p);
}

// 1 - reflectance, without the difference of near numbers at grazing angles.
fn dielectric_transmittance(refraction: f32, cos_i: f32) -> f32 {
    let cos_t = sqrt(1.0 - max(1.0 - cos_i * cos_i, 0.0) / (refraction * refraction));
    let s = cos_i + refraction * cos_t;
    let p = refraction * cos_i + cos_t;
    // 1 - ((a - b)/(a + b))^2 = 4 a b / (a + b)^2.
    return 2.0 * refraction * cos_i * cos_t * (1.0 / (s * s) + 1.0 / (p * p));
}

// cos^2 θ_d.
fn cos_squared_difference(a: FiberAngles) -> f32 {
    let sines = a.sin_theta_i * a.sin_theta_o;
    let cosines = a.cos_theta_i * a.cos_theta_o;
    if sines > 0.0 {
        return 0.5 * (1.0 + cosines + sines);
    }
    let squares = a.cos_theta_i * a.cos_theta_i + a.cos_theta_o * a.cos_theta_o - cosines * cosines;
    return 0.5 * (cosines + squares / (1.0 - sines));
}

fn unit_gaussian(theta_h: f32, width: f32) -> f32 {
    return gaussian(theta_h, width) / (sqrt(2.0 * PI) * width);
}

// f_s as printed.
fn thread_printed(thread: Thread, angles: FiberAngles) -> vec3f {
    let spread = cos_squared_difference(angles);
    let theta_h = 0.5 * angles.cone_offset;
    let reflected = dielectric_reflectance(thread.refraction, sqrt(spread) * angles.cos_half_phi);
    let surface = reflected * angles.cos_half_phi * unit_gaussian(theta_h, thread.surface_width);
    let inside = mix(unit_gaussian(theta_h, thread.volume_width), 1.0, thread.isotropic);
    let through = dielectric_transmittance(thread.refraction, angles.cos_theta_i)
        * dielectric_transmittance(thread.refraction, angles.cos_theta_o);
    let volume = through * inside / (angles.cos_theta_i + angles.cos_theta_o);
    return (surface + thread.color * volume) / spread;
}

// Place in the tables of a thread, in entries.
fn thread_table_place(theta: f32, size: u32) -> f32 {
    return (1.0 - sqrt(max(1.0 - abs(theta) / (0.5 * PI), 0.0))) * f32(size - 1u);
}

// S cos θ_i. `limits`: the table of limits at θ_i and at θ_o.
fn thread_reflected(thread: Thread, limits: vec2f, angles: FiberAngles) -> vec3f {
    if angles.cos_theta_i <= 0.0 {
        return vec3f(0.0);
    }
    return thread_printed(thread, angles) * (THREAD_SCALE * angles.cos_theta_i / max(limits.x, limits.y));
}

// Share of the light from an angle that is scattered. `terms`: the tables of surface and volume at that angle.
fn thread_albedo(thread: Thread, terms: vec2f) -> vec3f {
    return terms.x + thread.color * terms.y;
}
