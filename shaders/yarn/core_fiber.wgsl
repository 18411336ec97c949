// The core fiber: one ribbon that stands for all fibers of a ply that are not drawn one by one [WuYuksel2018 §3.2].
//
// Its texture is a side view of the ply in normalised section coordinates, where the elliptic ply is a disc and its fibers
// turn rigidly: v runs across, h towards the viewer. Seen from section angle psi the bundle looks as it does from angle 0
// after a turn by -psi, so that u = theta - psi in turns. (Eq. 3 as printed has inconsistent units.)

struct CorePoint {
    center: vec3f,
    velocity: vec3f,
    // Render-space offsets for h = 1 and v = 1.
    toward: vec3f,
    across: vec3f,
    // Unit direction of +v on the screen, render space.
    side: vec3f,
    half_width: f32,
    // u without wrap-around: continuous along a segment but for jumps of psi by one turn.
    turns: f32,
    ply: PlyPoint,
    fiber_rate: f32,
}

fn core_point(yarn: Yarn, s: Segment, p: YarnPoint, ply: u32, viewer: vec4f) -> CorePoint {
    var c: CorePoint;
    c.ply = ply_point(yarn, s, p, ply);
    c.center = c.ply.position;
    c.velocity = c.ply.velocity;
    let view = direction_to_viewer(viewer, c.center);
    let in_section = vec2f(dot(view, c.ply.radial), dot(view, c.ply.tangential));
    let section_length = max(length(in_section), 1e-6);
    let axes = vec2f(yarn.ellipse_short, yarn.ellipse_long);
    let seen_from = normalize(in_section / axes + vec2f(1e-12, 0.0));
    let along = seen_from * axes * p.radius;
    let sideways = vec2f(-seen_from.y, seen_from.x) * axes * p.radius;
    c.toward = c.ply.radial * along.x + c.ply.tangential * along.y;
    c.across = c.ply.radial * sideways.x + c.ply.tangential * sideways.y;
    c.side = (c.ply.tangential * in_section.x - c.ply.radial * in_section.y) / section_length;
    c.half_width = dot(c.across, c.side);
    let start = ply_seed(s.seed, ply).angle_turns;
    let psi = atan2(seen_from.y, seen_from.x) / TAU;
    c.turns = yarn.fiber_sign * (s.fiber_turns + p.length * s.turns.y) + start - psi;
    c.fiber_rate = TAU * yarn.fiber_sign * p.length_rate * s.turns.y;
    return c;
}

// The layer for a level of detail: it holds at least the fibers that are not drawn, one layer or the next by chance.
fn core_layer(yarn: Yarn, fibers: f32, chance: f32) -> u32 {
    return u32(clamp(floor(fibers * f32(yarn.core_layers) - chance), 0.0, f32(yarn.core_layers - 1u)));
}

// Where a texel's four values begin in the table buffer: height, offset across the fiber, d(h, v) / d theta.
fn core_texel(yarn: Yarn, layer: u32, turns: f32, v: f32) -> u32 {
    let u_texel = min(u32(fract(turns) * f32(yarn.core_length)), yarn.core_length - 1u);
    let v_share = 0.5 + 0.5 * v / yarn.core_half_width;
    let v_texel = u32(clamp(v_share * f32(yarn.core_width), 0.0, f32(yarn.core_width - 1u)));
    return yarn.core_table + 4u * ((layer * yarn.core_length + u_texel) * yarn.core_width + v_texel);
}
