// One step of a core fiber on the screen: a flat ribbon with a texture; shared by visibility and resolve.

struct CoreEnd {
    position: vec2f,
    depth: f32,
    // Of the depth along the segment.
    depth_rate: f32,
    // Half width, pixels; along +v on the screen: its direction.
    half_width: f32,
    side: vec2f,
    turns: f32,
    aspect: CoreAspect,
    // Distance towards the viewer for h = 1 and v = 1.
    depth_h: f32,
    depth_v: f32,
}

fn core_end(c: CorePoint) -> CoreEnd {
    let pixel = to_pixel(frame.pixel_from_render, c.center);
    let view = direction_to_viewer(frame.viewer, c.center);
    let moved = (frame.pixel_from_render * vec4f(c.side, 0.0)).xyz;
    let side = moved.xy - pixel.xy * moved.z;
    return CoreEnd(
        pixel.xy,
        pixel.w,
        (frame.pixel_from_render * vec4f(c.velocity, 0.0)).w,
        radius_in_pixels(c.half_width, pixel.z),
        side / max(length(side), 1e-20),
        c.turns,
        c.aspect,
        core_nearness(c, c.toward, view),
        core_nearness(c, c.across, view),
    );
}

struct CoreHit {
    covered: bool,
    t: f32,
    v: f32,
    turns: f32,
    aspect: CoreAspect,
}

// Twice the area that a pixel's offset from an end spans with the end's side: its sign tells before from past the end.
fn past_end(end: CoreEnd, pixel: vec2f) -> f32 {
    let offset = pixel - end.position;
    return end.side.x * offset.y - end.side.y * offset.x;
}

// A step is the quadrilateral between the sides at its ends, which it shares with its neighbours: each point of the ply is
// drawn once, since the nearer of two texels would be nearer than the ply.
fn core_hit(a: CoreEnd, b: CoreEnd, pixel: vec2f) -> CoreHit {
    let direction = b.position - a.position;
    let forward = select(-1.0, 1.0, a.side.x * direction.y - a.side.y * direction.x >= 0.0);
    let past_a = forward * past_end(a, pixel);
    let past_b = forward * past_end(b, pixel);
    let t = clamp(past_a / max(past_a - past_b, 1e-20), 0.0, 1.0);
    let half_width = max(mix(a.half_width, b.half_width, t), 1e-20);
    let v = dot(pixel - a.position - t * direction, mix(a.side, b.side, t)) / half_width;
    // psi jumps by a whole turn once around the ply.
    let difference = b.turns - a.turns;
    let turns = a.turns + t * (difference - round(difference));
    return CoreHit(past_a >= 0.0 && past_b < 0.0, t, v, turns, mix_aspect(a.aspect, b.aspect, t));
}

fn core_chance(pixel: vec2u) -> CoreChance {
    let hash = hash_combine(hash_combine(pixel.x + 1u, pixel.y), frame.sample_index);
    return CoreChance(unit_from_hash(hash_combine(hash, 2u)), unit_from_hash(hash_combine(hash, 1u)), unit_from_hash(hash));
}

// HOLE of native/precompute/src/ply_view.rs: the height where there is no fiber.
const CORE_HOLE: f32 = -2.0;

// What visibility wants of a texel: the height, and where its fiber is in the layer's order, packed by native/gpu/src/tables.rs.
struct CoreHeight {
    height: f32,
    // Share of the layer's own fibers before this one; 1 for those of the next layer.
    place: f32,
}

// Bits of a place.
const CORE_PLACE_BITS: u32 = 5u;

fn core_height(half: u32) -> CoreHeight {
    let last_height = f32((1u << (16u - CORE_PLACE_BITS)) - 1u);
    let last_place = f32((1u << CORE_PLACE_BITS) - 1u);
    let place = half & ((1u << CORE_PLACE_BITS) - 1u);
    return CoreHeight(4.0 * f32(half >> CORE_PLACE_BITS) / last_height + CORE_HOLE, f32(place) / last_place);
}

// A texel and its height.
struct CoreShown {
    texel: u32,
    height: f32,
}

// A fiber that is drawn one by one is not shown again: the next layer has what lies behind it. The one that is fading is there or not, by chance.
fn core_shown(yarn: Yarn, hit: CoreHit, fibers: f32, chance: CoreChance) -> CoreShown {
    let chosen = core_texture(yarn, hit.aspect, fibers, chance);
    let texel = core_texel(yarn, chosen, hit.turns, hit.v);
    let word = table_word(yarn.core_heights + texel);
    let first = core_height(word & 0xffffu);
    if (chosen.drawn_share - first.place) * chosen.own_fibers > chance.fiber {
        return CoreShown(texel + yarn.core_length * yarn.core_width, core_height(word >> 16u).height);
    }
    return CoreShown(texel, first.height);
}

// The visible fiber of a texel: its height, and the offset across it.
struct CoreSurface {
    height: f32,
    offset: f32,
}

fn core_surface_at(yarn: Yarn, texel: u32) -> CoreSurface {
    let values = unpack2x16snorm(table_word(yarn.core_table + 2u * texel));
    return CoreSurface(2.0 * values.x, values.y);
}

// d(h, v) / d theta of the visible fiber, which turns on with the bundle from the row's middle: a row is wider than a narrow highlight.
fn core_slopes_at(yarn: Yarn, texel: u32, turns: f32) -> vec2f {
    let slopes = yarn.core_slope * unpack2x16snorm(table_word(yarn.core_table + 2u * texel + 1u));
    let rows_per_turn = f32(yarn.core_length) / f32(yarn.core_turns);
    let turned = circle((fract(turns * rows_per_turn) - 0.5) / rows_per_turn);
    return vec2f(slopes.x * turned.x - slopes.y * turned.y, slopes.x * turned.y + slopes.y * turned.x);
}
