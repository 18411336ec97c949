// The stretch of a yarn between two knots; twin of native/core/src/yarn/curve.rs.

// Coefficients of t^0 … t^3.
struct Cubic3 {
    a: vec3f,
    b: vec3f,
    c: vec3f,
    d: vec3f,
}

struct Segment {
    position: Cubic3,
    heading: Cubic3,
    normal: Cubic3,
    // Share of the curve's length since the segment's start, and radius.
    length: vec4f,
    radius: vec4f,
    // Where the segment ends: position and radius of its second knot.
    end: vec4f,
    // Turns of plies and fibers at the segment's start, modulo TURNS_KEPT.
    ply_turns: f32,
    fiber_turns: f32,
    // Migration period and phase at the segment's start.
    period: u32,
    phase: f32,
    // Turns of plies, fibers and migration over the whole curve.
    turns: vec3f,
    periods_per_turn: f32,
    closed_periods: u32,
    seed: u32,
    handedness: f32,
}

struct Knot {
    position: vec3f,
    normal: vec3f,
    length: u32,
    radius: f32,
}

// Centre and frame at one parameter; rates are per t.
struct YarnPoint {
    position: vec3f,
    velocity: vec3f,
    acceleration: vec3f,
    tangent: vec3f,
    normal: vec3f,
    binormal: vec3f,
    normal_rate: vec3f,
    binormal_rate: vec3f,
    length: f32,
    length_rate: f32,
    radius: f32,
    radius_rate: f32,
}

fn limited_slope(before: f32, after: f32) -> f32 {
    let bound = 3.0 * min(abs(before), abs(after));
    return select(clamp(0.5 * (before + after), -bound, bound), 0.0, before * after <= 0.0);
}

fn hermite_vector(p: vec3f, q: vec3f, dp: vec3f, dq: vec3f) -> Cubic3 {
    return Cubic3(p, dp, 3.0 * (q - p) - 2.0 * dp - dq, 2.0 * (p - q) + dp + dq);
}

fn hermite_scalar(p: f32, q: f32, dp: f32, dq: f32) -> vec4f {
    return vec4f(p, dp, 3.0 * (q - p) - 2.0 * dp - dq, 2.0 * (p - q) + dp + dq);
}

fn cubic_value(k: Cubic3, t: f32) -> vec3f {
    return k.a + (k.b + (k.c + k.d * t) * t) * t;
}

fn cubic_slope(k: Cubic3, t: f32) -> vec3f {
    return k.b + (2.0 * k.c + 3.0 * t * k.d) * t;
}

fn scalar_value(k: vec4f, t: f32) -> f32 {
    return k.x + (k.y + (k.z + k.w * t) * t) * t;
}

fn scalar_slope(k: vec4f, t: f32) -> f32 {
    return k.y + (2.0 * k.z + 3.0 * t * k.w) * t;
}

// Whole turns and the fraction at a length coordinate.
struct Turns {
    whole: u32,
    part: f32,
}

fn turns_at(length: u32, whole: u32, rest: f32) -> Turns {
    // length / 2^32 × (whole + rest); the integer product keeps the fraction exact for any number of turns.
    let sum = f32(length * whole) * 0x1p-32 + f32(length) * 0x1p-32 * rest;
    let carry = floor(sum);
    return Turns(multiply_high(length, whole) + u32(carry), sum - carry);
}

// Whole turns matter to textures of several turns alone; few, so that the fraction stays exact: TURNS of native/precompute/src/arrangement.rs.
const TURNS_KEPT: u32 = 4u;

fn turns_kept(turns: Turns) -> f32 {
    return f32(turns.whole % TURNS_KEPT) + turns.part;
}

fn length_share(difference: u32) -> f32 {
    return f32(difference) * 0x1p-32;
}

fn segment_between(k0: Knot, k1: Knot, k2: Knot, k3: Knot, curve: Curve, handedness: f32) -> Segment {
    var s: Segment;
    let start_velocity = 0.5 * (k2.position - k0.position);
    let end_velocity = 0.5 * (k3.position - k1.position);
    s.position = hermite_vector(k1.position, k2.position, start_velocity, end_velocity);
    s.heading = hermite_vector(
        start_velocity,
        end_velocity,
        k0.position - 2.0 * k1.position + k2.position,
        k1.position - 2.0 * k2.position + k3.position,
    );
    s.normal = hermite_vector(k1.normal, k2.normal, 0.5 * (k2.normal - k0.normal), 0.5 * (k3.normal - k1.normal));
    let before = length_share(k1.length - k0.length);
    let here = length_share(k2.length - k1.length);
    let after = length_share(k3.length - k2.length);
    s.length = hermite_scalar(0.0, here, limited_slope(before, here), limited_slope(here, after));
    s.radius = hermite_scalar(
        k1.radius,
        k2.radius,
        limited_slope(k1.radius - k0.radius, k2.radius - k1.radius),
        limited_slope(k2.radius - k1.radius, k3.radius - k2.radius),
    );
    s.end = vec4f(k2.position, k2.radius);
    s.ply_turns = turns_kept(turns_at(k1.length, curve.ply_whole, curve.ply_rest));
    s.fiber_turns = turns_kept(turns_at(k1.length, curve.fiber_whole, curve.fiber_rest));
    let migration = turns_at(k1.length, curve.migration_whole, curve.migration_rest);
    s.period = migration.whole;
    s.phase = migration.part;
    s.turns = vec3f(
        f32(curve.ply_whole) + curve.ply_rest,
        f32(curve.fiber_whole) + curve.fiber_rest,
        f32(curve.migration_whole) + curve.migration_rest,
    );
    s.periods_per_turn = s.turns.z / s.turns.y;
    s.closed_periods = curve.closed_periods;
    s.seed = curve.seed;
    s.handedness = handedness;
    return s;
}

fn yarn_point(s: Segment, t: f32) -> YarnPoint {
    var p: YarnPoint;
    let heading = cubic_value(s.heading, t);
    let speed = max(length(heading), 1e-30);
    p.tangent = heading / speed;
    let turning = cubic_slope(s.heading, t);
    let tangent_rate = (turning - p.tangent * dot(turning, p.tangent)) / speed;
    let m = cubic_value(s.normal, t);
    let along = dot(m, p.tangent);
    let projected = m - p.tangent * along;
    let projected_length = max(length(projected), 1e-30);
    p.normal = projected / projected_length;
    p.binormal = cross(p.tangent, p.normal) * s.handedness;
    let twist = (dot(cubic_slope(s.normal, t), p.binormal) - along * dot(tangent_rate, p.binormal)) / projected_length;
    p.normal_rate = p.binormal * twist - p.tangent * dot(p.normal, tangent_rate);
    p.binormal_rate = -p.normal * twist - p.tangent * dot(p.binormal, tangent_rate);
    p.position = cubic_value(s.position, t);
    p.velocity = cubic_slope(s.position, t);
    p.acceleration = 2.0 * s.position.c + 6.0 * t * s.position.d;
    p.length = scalar_value(s.length, t);
    p.length_rate = scalar_slope(s.length, t);
    p.radius = scalar_value(s.radius, t);
    p.radius_rate = scalar_slope(s.radius, t);
    return p;
}
