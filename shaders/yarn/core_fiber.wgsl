// The core fiber: one ribbon that stands for all fibers of a ply that are not drawn one by one [WuYuksel2018 §3.2].
//
// Its texture is a side view of the ply in normalised section coordinates, where the elliptic ply is a disc and its fibers
// turn rigidly: v runs across, h towards the viewer. Seen from section angle psi the bundle looks as it does from angle 0
// after a turn by -psi, so that u = theta - psi in turns. (Eq. 3 as printed has inconsistent units.) The texture is several
// turns long; psi is counted from the yarn's normal, past which the view seldom goes, rather than from the ply's. Seen at a slant, a ray
// leaves the section of its row: there are textures for several slants, whose heights and directions are those that the ray meets.

// What a ply is seen from.
struct CoreAspect {
    // Tangent between the direction to the viewer and the section, in steps of the textures'.
    slant: f32,
    // sin psi |sin psi|: 0 in front of the yarn, where the ply shows its short half axis as its depth, -1 and 1 at its edges, where it shows its long one.
    side: f32,
}

fn mix_aspect(a: CoreAspect, b: CoreAspect, share: f32) -> CoreAspect {
    return CoreAspect(mix(a.slant, b.slant, share), mix(a.side, b.side, share));
}

// Half of what v covers.
fn core_half_width(yarn: Yarn, aspect: CoreAspect) -> f32 {
    return yarn.core_half_width + yarn.core_widening * abs(aspect.slant);
}

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
    // Which of the textures shows it.
    aspect: CoreAspect,
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
    let last_slant = 0.5 * f32(yarn.core_slants - 1u);
    c.aspect.slant = clamp(dot(view, p.tangent) / (section_length * yarn.core_slant_step), -last_slant, last_slant);
    c.aspect.side = select(sign(seen_from.y), clamp(seen_from.y * abs(seen_from.y), -1.0, 1.0), seen_from.x > 0.0);
    c.fiber_rate = TAU * yarn.fiber_sign * p.length_rate * s.turns.y;
    return c;
}

// Which of the textures to look into, and what to leave out there.
struct CoreTexture {
    // Of the nearest ones, by chance.
    slant: u32,
    view: u32,
    // The last one that holds all fibers that are not drawn one by one.
    layer: u32,
    // Fibers of the layer that are not in the next one, and the share of them that is drawn one by one.
    own_fibers: f32,
    drawn_share: f32,
}

// Numbers in [0, 1).
struct CoreChance {
    slant: f32,
    view: f32,
    fiber: f32,
}

// One of the two numbers nearest to a place from -1 to 1 among as many, by chance.
fn core_choice(place: f32, count: u32, chance: f32) -> u32 {
    let last = f32(count - 1u);
    return u32(clamp(floor(0.5 * last * (place + 1.0) + chance), 0.0, last));
}

fn core_texture(yarn: Yarn, aspect: CoreAspect, fibers: f32, chance: CoreChance) -> CoreTexture {
    let slant = core_choice(2.0 * aspect.slant / f32(max(yarn.core_slants, 2u) - 1u), yarn.core_slants, chance.slant);
    let view = core_choice(aspect.side, yarn.core_views, chance.view);
    // Layer l holds the fibers from the share (l / layers)^2 on.
    let layers = f32(yarn.core_layers);
    let layer = min(floor(sqrt(fibers) * layers), layers - 1.0);
    let begin = layer * layer;
    let end = (layer + 1.0) * (layer + 1.0);
    let all = layers * layers;
    return CoreTexture(
        slant,
        view,
        u32(layer),
        (end - begin) / all * f32(yarn.fibers),
        (fibers * all - begin) / (end - begin),
    );
}

// A texel's number in the texture.
fn core_texel(yarn: Yarn, texture: CoreTexture, turns: f32, v: f32) -> u32 {
    let u_texel = min(u32(fract(turns / f32(yarn.core_turns)) * f32(yarn.core_length)), yarn.core_length - 1u);
    let slant = f32(texture.slant) - 0.5 * f32(yarn.core_slants - 1u);
    let half_width = core_half_width(yarn, CoreAspect(slant, 0.0));
    let v_share = 0.5 + 0.5 * v / half_width;
    let v_texel = u32(clamp(v_share * f32(yarn.core_width), 0.0, f32(yarn.core_width - 1u)));
    let row = ((texture.slant * yarn.core_views + texture.view) * yarn.core_layers + texture.layer) * yarn.core_length + u_texel;
    return row * yarn.core_width + v_texel;
}
