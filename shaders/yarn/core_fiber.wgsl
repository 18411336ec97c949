// The core fiber: one ribbon that stands for all fibers of a ply that are not drawn one by one [WuYuksel2018 §3.2].
//
// Its texture is a side view of the ply in normalised section coordinates, where the elliptic ply is a disc and its fibers
// turn rigidly: v runs across, h towards the viewer. Seen from section angle psi the bundle looks as it does from angle 0
// after a turn by -psi, so that u = theta - psi in turns. (Eq. 3 as printed has inconsistent units.) The texture is several
// turns long; psi is counted from the yarn's normal, past which the view seldom goes, rather than from the ply's.

struct CorePoint {
    center: vec3f,
    velocity: vec3f,
    // Render-space offsets for h = 1 and v = 1.
    toward: vec3f,
    across: vec3f,
    // Unit direction of +v on the screen, render space.
    side: vec3f,
    half_width: f32,
    // Squared cosine between the view and the section plane.
    facing_squared: f32,
    // u, continuous along a segment but for jumps by whole turns.
    turns: f32,
    // Squared sine of psi: how deep the ply is in this view, from 0 (its short half axis) to 1 (its long one).
    depth_share: f32,
    ply: PlyPoint,
    fiber_rate: f32,
}

// Seen from farther along the yarn than this, a point's place along it is no longer found.
const LEAST_FACING_SQUARED: f32 = 0.05;

// How much nearer to the viewer than the centre line a view ray meets the surface whose section holds `offset`: seen at a slant, that
// section is not the one that the ray meets the centre line in.
fn core_nearness(c: CorePoint, offset: vec3f, view: vec3f) -> f32 {
    return dot(offset, view) / c.facing_squared;
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
    c.facing_squared = max(section_length * section_length, LEAST_FACING_SQUARED);
    // Where the bundle turns with the view, a short yarn shows little more than the turn that it begins in: that is the ply's own.
    let seed = ply_seed(s.seed, ply);
    let start = seed.angle_turns + floor(seed.migration_turns * f32(yarn.core_turns));
    let psi = atan2(seen_from.y, seen_from.x) / TAU;
    var ply_turns = 0.0;
    if yarn.plies > 1u {
        ply_turns = yarn.ply_sign * (s.ply_turns + p.length * s.turns.x) + f32(ply) / f32(yarn.plies);
    }
    let from_normal = atan2(dot(view, p.binormal), dot(view, p.normal)) / TAU - ply_turns;
    let whole = round(from_normal - psi);
    c.turns = yarn.fiber_sign * (s.fiber_turns + p.length * s.turns.y) + start - psi - whole;
    c.depth_share = min(seen_from.y * seen_from.y, 1.0);
    c.fiber_rate = TAU * yarn.fiber_sign * p.length_rate * s.turns.y;
    return c;
}

// Which of the textures to look into, and what to leave out there.
struct CoreTexture {
    // One of the two nearest, by chance.
    view: u32,
    // The last one that holds all fibers that are not drawn one by one.
    layer: u32,
    // Fibers of the layer that are not in the next one, and the share of them that is drawn one by one.
    own_fibers: f32,
    drawn_share: f32,
}

// Two numbers in [0, 1).
struct CoreChance {
    view: f32,
    fiber: f32,
}

fn core_texture(yarn: Yarn, depth_share: f32, fibers: f32, chance: CoreChance) -> CoreTexture {
    let last_view = f32(yarn.core_views - 1u);
    // Layer l holds the fibers from the share (l / layers)^2 on.
    let layers = f32(yarn.core_layers);
    let layer = min(floor(sqrt(fibers) * layers), layers - 1.0);
    let begin = layer * layer;
    let end = (layer + 1.0) * (layer + 1.0);
    let all = layers * layers;
    return CoreTexture(
        u32(clamp(floor(depth_share * last_view + chance.view), 0.0, last_view)),
        u32(layer),
        (end - begin) / all * f32(yarn.fibers),
        (fibers * all - begin) / (end - begin),
    );
}

// A texel's number in the texture.
fn core_texel(yarn: Yarn, texture: CoreTexture, turns: f32, v: f32) -> u32 {
    let u_texel = min(u32(fract(turns / f32(yarn.core_turns)) * f32(yarn.core_length)), yarn.core_length - 1u);
    let v_share = 0.5 + 0.5 * v / yarn.core_half_width;
    let v_texel = u32(clamp(v_share * f32(yarn.core_width), 0.0, f32(yarn.core_width - 1u)));
    let row = (texture.view * yarn.core_layers + texture.layer) * yarn.core_length + u_texel;
    return row * yarn.core_width + v_texel;
}
