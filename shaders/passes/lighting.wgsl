// Tables and shadow maps as the resolve reads them.
@group(0) @binding(11) var<storage, read> shadow_depths: array<u32>;

// One of a material's tables over |theta|.
fn material_table(material: Material, table: u32, sin_theta: f32) -> f32 {
    let place = asin(min(abs(sin_theta), 1.0)) / (0.5 * PI) * f32(material.table_size - 1u);
    let index = min(u32(place), material.table_size - 2u);
    let first = material.table + table * material.table_size + index;
    return mix(table_value(first), table_value(first + 1u), place - f32(index));
}

fn normalizers_at(material: Material, sin_theta_i: f32) -> Normalizers {
    let roots = vec2f(material_table(material, 0u, sin_theta_i), material_table(material, 1u, sin_theta_i));
    let integrals = max(roots * roots, vec2f(1e-12));
    return Normalizers(integrals.x, integrals.y);
}

fn ambient_factors(material: Material, sin_theta_o: f32) -> vec3f {
    return vec3f(
        material_table(material, 2u, sin_theta_o),
        material_table(material, 3u, sin_theta_o),
        material_table(material, 4u, sin_theta_o),
    );
}

// Bilinear value of a square table whose texel centres cover [-extent, extent]; 0 outside.
fn square_table(first: u32, size: u32, extent: f32, at: vec2f) -> f32 {
    let place = (at / extent * 0.5 + 0.5) * f32(size) - 0.5;
    let corner = floor(place);
    let share = place - corner;
    var sum = 0.0;
    for (var y = 0; y < 2; y++) {
        for (var x = 0; x < 2; x++) {
            let texel = vec2i(corner) + vec2i(x, y);
            if all(texel >= vec2i(0)) && all(texel < vec2i(i32(size))) {
                let weight = select(1.0 - share.x, share.x, x == 1) * select(1.0 - share.y, share.y, y == 1);
                sum += weight * table_value(first + u32(texel.y) * size + u32(texel.x));
            }
        }
    }
    return sum;
}

// A direction in a yarn's section, and how much of it lies there.
struct SectionDirection {
    unit: vec2f,
    size: f32,
}

fn section_direction(section: SectionPoint, direction: vec3f) -> SectionDirection {
    let in_section = vec2f(dot(direction, section.x), dot(direction, section.y));
    let size = length(in_section);
    return SectionDirection(in_section / max(size, 1e-6), size);
}

// What of a direction lies across threads that move across the section by `slope` per length along the yarn: in a section that moves along with them, a ray goes there.
fn direction_across(section: SectionPoint, slope: vec2f, direction: vec3f) -> SectionDirection {
    let across = vec2f(dot(direction, section.x), dot(direction, section.y)) - slope * dot(direction, section.yarn_axis);
    let size = length(across);
    return SectionDirection(across / max(size, 1e-6), size);
}

// Direction of a ray's way out of the yarn in a section that turns with the plies. There the way is bent; what lies near decides, so that it goes as a quarter of the way
// to the yarn's border: beside the reference, light from the front and along the yarn was 5 to 9 % off with none of this, 2 to 6 % with the direction at the point, 1 to 4 % so, and 3 to 9 %
// half way. Light from behind comes through all of the yarn, where that is no help: 10 to 12 % off with none of it, 11 to 14 % so.
fn direction_out(section: SectionPoint, direction: vec3f) -> vec2f {
    let l = section_direction(section, direction).unit;
    let q = section.position;
    let before = dot(q, l);
    let quarter_way = 0.25 * (sqrt(max(before * before + 1.0 - dot(q, q), 0.0)) - before);
    let at = q + l * max(quarter_way, 0.0);
    return direction_across(section, section.winding * vec2f(-at.y, at.x), direction).unit;
}

// Most slope of a fiber: a hair may go straight away from its yarn.
const MOST_SLOPE: f32 = 4.0;

fn fiber_slope(section: SectionPoint, tangent: vec3f) -> vec2f {
    let along = max(abs(dot(tangent, section.yarn_axis)), 1e-3);
    let slope = vec2f(dot(tangent, section.x), dot(tangent, section.y)) / along;
    return slope * min(1.0, MOST_SLOPE / max(length(slope), 1e-6));
}

// Optical depth of the yarn's own fibers from a point towards a direction [WuYuksel2018 §4.1].
fn self_depth(yarn: Yarn, q: vec2f, l: vec2f) -> f32 {
    // The table's light shines along its x axis.
    let turned = vec2f(dot(q, l), l.x * q.y - l.y * q.x);
    // Fibers all around a point that lies beyond the table towards the dark side still shade it.
    let at = vec2f(max(turned.x, -yarn.shadow_extent * 0.98), turned.y);
    let place = fract(atan2(l.y, l.x) / TAU * f32(yarn.plies)) * f32(yarn.shadow_slices);
    let slice = u32(place) % yarn.shadow_slices;
    let next = (slice + 1u) % yarn.shadow_slices;
    let texels = yarn.shadow_size * yarn.shadow_size;
    return mix(
        square_table(yarn.shadow_table + slice * texels, yarn.shadow_size, yarn.shadow_extent, at),
        square_table(yarn.shadow_table + next * texels, yarn.shadow_size, yarn.shadow_extent, at),
        place - floor(place),
    );
}

// What a point's lights share: it is seen, so that no fiber lies between it and the viewer.
struct SeenPoint {
    section: SectionPoint,
    // Slope of its fiber.
    slope: vec2f,
    // Of the direction to the viewer: in the section, and across the fiber.
    view: vec2f,
    view_across: vec2f,
    depth_to_viewer: f32,
    // sigma r / 2.
    common_depth: f32,
}

fn seen_point(yarn: Yarn, section: SectionPoint, tangent: vec3f, view: vec3f) -> SeenPoint {
    let slope = fiber_slope(section, tangent);
    let extinction = square_table(yarn.extinction_table, yarn.shadow_size, yarn.shadow_extent, section.position);
    return SeenPoint(
        section,
        slope,
        section_direction(section, view).unit,
        direction_across(section, slope, view).unit,
        self_depth(yarn, section.position, direction_out(section, view)),
        0.5 * extinction * yarn.fiber_radius,
    );
}

// Depth that parallel rays to two places on a fiber's width have in common: shared_over_width of native/precompute/src/self_shadow.rs.
fn shared_over_width(depth: f32) -> f32 {
    // To first order where the difference has too few digits left.
    let d = max(depth, 0.05);
    return select(depth + log(2.0 * (d - 1.0 + exp(-d)) / (d * d)), depth * (2.0 / 3.0), depth < 0.05);
}

// Share of a light in the section's direction `l` that the yarn's own fibers let through to a place with that depth towards the light.
// `l`: across the fiber.
fn share_let_through(seen: SeenPoint, l: vec2f, depth: f32, shared_depth: f32) -> f32 {
    // Not acos of their product, which is coarse where they nearly agree.
    let half = asin(min(0.5 * length(l - seen.view_across), 1.0));
    let in_common = seen.common_depth * (1.0 / max(tan(half), 1e-6) - 0.5 * PI + half);
    let most = max(shared_depth, 1e-9);
    return exp(most * (1.0 - exp(-in_common / most)) - depth);
}

// What the yarn's own fibers let through of a light; derived and tested in native/precompute/src/self_shadow.rs.
struct SelfShadow {
    // To the point that is seen, where Lambert's term takes it in: toward_light_of_seen.
    point: f32,
    // Over its fiber's width, as lobes take it in: over_width_of_seen.
    width: f32,
}

fn self_shadows(yarn: Yarn, seen: SeenPoint, direction: vec3f) -> SelfShadow {
    let l = direction_across(seen.section, seen.slope, direction);
    if l.size < 1e-4 {
        return SelfShadow(1.0, 1.0);
    }
    let q = seen.section.position;
    let entry = q + 0.25 * PI * yarn.fiber_radius * (l.unit - seen.view_across);
    let way = direction_out(seen.section, direction);
    let to_point = self_depth(yarn, q, way);
    let to_width = self_depth(yarn, entry, way);
    return SelfShadow(
        share_let_through(seen, l.unit, to_point, min(to_point, seen.depth_to_viewer)),
        share_let_through(seen, l.unit, to_width, shared_over_width(min(to_width, seen.depth_to_viewer))),
    );
}

// Over the fiber's width alone.
fn self_shadow(yarn: Yarn, seen: SeenPoint, direction: vec3f) -> f32 {
    return self_shadows(yarn, seen, direction).width;
}

// HALF_WAY of native/precompute/src/self_shadow.rs.
const HALF_WAY: f32 = 0.2;

// What a point that is seen has of the sky beyond the mean over points there; sky_of_seen in native/precompute/src/self_shadow.rs.
fn sky_of_seen(yarn: Yarn, seen: SeenPoint) -> f32 {
    let share = vec2f(seen.depth_to_viewer, seen.common_depth) / vec2f(1.0 + seen.depth_to_viewer, seen.common_depth + HALF_WAY);
    let border = 1.0 - 1.0 / f32(yarn.seen_sky_size);
    let place = clamp(2.0 * vec2f(share.x, sqrt(share.y)) - 1.0, vec2f(-border), vec2f(border));
    return square_table(yarn.seen_sky_table, yarn.seen_sky_size, 1.0, place);
}

// Share of the sky that the yarn's own fibers leave open at a point that is seen.
fn self_sky(yarn: Yarn, seen: SeenPoint) -> f32 {
    return min(self_occlusion(yarn, seen.section) + sky_of_seen(yarn, seen), 1.0);
}

// The same, of all points there [WuYuksel2018 §4.2].
fn self_occlusion(yarn: Yarn, section: SectionPoint) -> f32 {
    if frame.occlusion_table == 1u {
        if any(abs(section.position) >= vec2f(yarn.occlusion_extent)) {
            return 1.0;
        }
        return square_table(yarn.occlusion_table, yarn.occlusion_size, yarn.occlusion_extent, section.position);
    }
    let r = min(length(section.position), yarn.occlusion_extent);
    let k = yarn.occlusion_cubic;
    return clamp(k.x + (k.y + (k.z + k.w * r) * r) * r, 0.0, 1.0);
}

// Side of the shadow filter, texels: its outermost taps are weighted by the share of the texel that it covers.
const FILTER: i32 = 3;

// What other yarns do to a light.
struct Shadow {
    // Share that they let through, filtered over the shadow map's texels.
    open: f32,
    // Share that meshes take, which let nothing through.
    solid: f32,
    // Way of the light that they do not, through yarns and gaps, render space.
    way: f32,
}

fn shadow_map(view_index: u32, position: vec3f, bias: f32) -> Shadow {
    let view = shadow_views[view_index];
    let texel = to_pixel(view.texel_from_render, position);
    // A texel without anything holds 0.
    let nearness = max(1.0 - (texel.w - bias - view.depth_min) * view.depth_scale, 0.0);
    let corner = floor(texel.xy - 0.5 * f32(FILTER - 1));
    let share = texel.xy - 0.5 * f32(FILTER - 1) - corner;
    let first = vec2i(corner);
    let base = view_index * frame.shadow_resolution * frame.shadow_resolution;
    var blocked = 0.0;
    var solid = 0.0;
    var above = 0.0;
    for (var y = 0; y < FILTER; y++) {
        for (var x = 0; x < FILTER; x++) {
            let at = first + vec2i(x, y);
            var word = 0u;
            if all(at >= vec2i(0)) && all(at < vec2i(i32(frame.shadow_resolution))) {
                word = shadow_depths[base + u32(at.y) * frame.shadow_resolution + u32(at.x)];
            }
            let over = max(bitcast<f32>(word) - nearness, 0.0);
            let weight_x = select(select(1.0, share.x, x == FILTER - 1), 1.0 - share.x, x == 0);
            let weight_y = select(select(1.0, share.y, y == FILTER - 1), 1.0 - share.y, y == 0);
            let weight = select(0.0, weight_x * weight_y, over > 0.0);
            blocked += weight;
            solid += select(0.0, weight, (word & 1u) == 1u);
            above += weight_x * weight_y * over;
        }
    }
    let taps = f32((FILTER - 1) * (FILTER - 1));
    return Shadow(1.0 - blocked / taps, solid / taps, (above / (max(blocked, 1e-6) * view.depth_scale) + bias) / axis_cosine(view, texel.xy));
}

// Which face of a cube map looks along a direction: +x, -x, +y, -y, +z, -z.
fn cube_face(direction: vec3f) -> u32 {
    let a = abs(direction);
    if a.x >= a.y && a.x >= a.z {
        return select(1u, 0u, direction.x > 0.0);
    }
    if a.y >= a.z {
        return select(3u, 2u, direction.y > 0.0);
    }
    return select(5u, 4u, direction.z > 0.0);
}

// A yarn's own tube must not shade it: its fibers do that in self_shadow. The point is moved out of the tube first, and a bent one is not
// straight by about this much of its radius.
const SHADOW_BIAS: f32 = 0.5;

// What other yarns do to light that comes to a tube's point from a direction.
fn tube_shadow(view_index: u32, tube: Tube, position: vec3f, direction: vec3f) -> Shadow {
    let view = shadow_views[view_index];
    let texel = to_pixel(view.texel_from_render, position).z / view.texels_per_unit;
    let way_out = distance_clear_of_tube(tube, position, direction, 0.5 * f32(FILTER) * texel);
    return shadow_map(view_index, position + direction * way_out, SHADOW_BIAS * tube.radius);
}

fn light_shadow(light: Light, incident: Incident, tube: Tube, position: vec3f) -> Shadow {
    if light.shadow_view_count == 0u {
        return Shadow(1.0, 0.0, 0.0);
    }
    var view = light.shadow_view;
    if light.shadow_view_count == 6u {
        view += cube_face(position - light.position);
    }
    return tube_shadow(view, tube, position, incident.direction);
}

// Towards the sky that a view of this sample shows.
fn sky_direction(view_index: u32) -> vec3f {
    let m = shadow_views[view_index].texel_from_render;
    return -vec3f(m[0].w, m[1].w, m[2].w);
}
