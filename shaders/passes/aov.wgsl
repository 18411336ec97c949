// Further passes: planes of one word a pixel in one buffer, cleared when a tile begins. A plane that is not asked for has no number.
@group(0) @binding(40) var<storage, read_write> aov_planes: array<u32>;

const NO_PLANE: u32 = 0xffffffffu;

// Objects whose coverage is counted, two words each: draw + 1 and samples.
const MATTE_SLOTS: u32 = 10u;

fn aov_word(plane: u32, index: u32) -> u32 {
    return plane * frame.size.x * frame.size.y + index;
}

fn set_aov(plane: u32, index: u32, value: f32) {
    aov_planes[aov_word(plane, index)] = bitcast<u32>(value);
}

fn add_aov(plane: u32, index: u32, value: vec3f) {
    for (var i = 0u; i < 3u; i++) {
        let word = aov_word(plane + i, index);
        aov_planes[word] = bitcast<u32>(bitcast<f32>(aov_planes[word]) + value[i]);
    }
}

fn add_matte(index: u32, draw: u32) {
    for (var slot = 0u; slot < MATTE_SLOTS; slot++) {
        let word = aov_word(frame.plane_matte + 2u * slot, index);
        let known = aov_planes[word];
        if known == 0u || known == draw + 1u {
            aov_planes[word] = draw + 1u;
            aov_planes[aov_word(frame.plane_matte + 2u * slot + 1u, index)] += 1u;
            return;
        }
    }
}

// A point of a yarn, by its place along a segment and the offset from the centre line there, in the frame that goes with the yarn: the same
// numbers tell where it is in another frame.
struct YarnPlace {
    // Share of the curve's length, and angle from the yarn's normal, turns from 0 to 1.
    length: f32,
    turns: f32,
    // In yarn radii.
    offset: vec3f,
}

fn yarn_place(draw: u32, surface: Surface) -> YarnPlace {
    let p = yarn_point(segment_at(draw, surface.segment), surface.t);
    let knot = draws[draw].first_knot + surface.segment - draws[draw].first_segment;
    let off = (surface.position - p.position) / p.radius;
    let offset = vec3f(dot(off, p.normal), dot(off, p.binormal), dot(off, p.tangent));
    let turns = fract(atan2(offset.y, offset.x) / TAU);
    return YarnPlace(length_share(knot_length(knot)) + p.length, turns, offset);
}

fn material_albedo(draw: u32, surface: Surface) -> vec3f {
    let material = materials[draws[draw].material];
    let sin_theta_o = dot(surface.tangent, direction_to_viewer(frame.viewer, surface.position));
    let even = even_light(material, sin_theta_o);
    return clamp(even.around + even.through, vec3f(0.0), vec3f(1.0));
}

fn add_light(index: u32, shaded: Shaded) {
    if frame.plane_diffuse != NO_PLANE {
        add_aov(frame.plane_diffuse, index, shaded.once.diffuse);
    }
    if frame.plane_specular != NO_PLANE {
        add_aov(frame.plane_specular, index, shaded.once.specular);
    }
    if frame.plane_transmission != NO_PLANE {
        add_aov(frame.plane_transmission, index, shaded.once.transmission);
    }
    if frame.plane_scattered != NO_PLANE {
        add_aov(frame.plane_scattered, index, shaded.scattered);
    }
    if frame.plane_ambient != NO_PLANE {
        add_aov(frame.plane_ambient, index, shaded.ambient);
    }
    if frame.plane_shadow != NO_PLANE {
        let word = aov_word(frame.plane_shadow, index);
        let open = shaded.arriving / max(shaded.shining, 1e-30);
        aov_planes[word] = bitcast<u32>(bitcast<f32>(aov_planes[word]) + open);
    }
}

fn add_aovs(index: u32, draw: u32, surface: Surface, shaded: Shaded) {
    add_light(index, shaded);
    if frame.plane_matte != NO_PLANE {
        add_matte(index, draw);
    }
    if frame.plane_albedo != NO_PLANE {
        add_aov(frame.plane_albedo, index, material_albedo(draw, surface));
    }
    if frame.first == 0u {
        return;
    }
    if frame.plane_position != NO_PLANE {
        add_aov(frame.plane_position, index, surface.position);
    }
    if frame.plane_uv == NO_PLANE && frame.plane_vector == NO_PLANE {
        return;
    }
    let place = yarn_place(draw, surface);
    if frame.plane_uv != NO_PLANE {
        let knot = draws[draw].first_knot + surface.segment - draws[draw].first_segment;
        set_aov(frame.plane_uv, index, place.length * curves[knot_curve(knot)].rest_length);
        set_aov(frame.plane_uv + 1u, index, place.turns);
    }
    if frame.plane_vector != NO_PLANE {
        aov_planes[aov_word(frame.plane_vector, index)] = surface.segment + 1u;
        set_aov(frame.plane_vector + VECTOR_PARAMETER, index, surface.t);
        for (var i = 0u; i < 3u; i++) {
            set_aov(frame.plane_vector + VECTOR_PLACE + i, index, place.offset[i]);
        }
    }
}

// Of a point of a mesh's triangle: what a yarn's coordinates would say stays 0.
fn add_mesh_aovs(index: u32, draw: u32, triangle: u32, position: vec3f, color: vec3f, shaded: Shaded) {
    add_light(index, shaded);
    if frame.plane_matte != NO_PLANE {
        add_matte(index, draw);
    }
    if frame.plane_albedo != NO_PLANE {
        add_aov(frame.plane_albedo, index, color);
    }
    if frame.first == 0u {
        return;
    }
    if frame.plane_position != NO_PLANE {
        add_aov(frame.plane_position, index, position);
    }
    if frame.plane_vector != NO_PLANE {
        aov_planes[aov_word(frame.plane_vector + VECTOR_PARAMETER, index)] = triangle;
        add_aov(frame.plane_vector + VECTOR_PLACE, index, position);
    }
}
