// How it works: one thread a pixel. Where a mesh is the nearest, it is lit: shaded by its colour, or as much of a shadow catcher as the
// light on it is less than without shadows.

// At the corners of each triangle: octahedral. Then places on the texture, two floats each.
@group(0) @binding(36) var<storage, read> mesh_normals: array<u32>;
// sRGB codes, red in the lowest byte.
@group(0) @binding(38) var<storage, read> mesh_texels: array<u32>;

struct MeshPoint {
    position: vec3f,
    // Of the triangle, and as it is shaded; towards the viewer.
    facing: vec3f,
    normal: vec3f,
    color: vec3f,
    draw: u32,
}

// Of the corners' normals, and by the cofactors of the transform, so that it is right under any scale; `facing` where next to nothing is left.
fn mesh_normal(draw: u32, first: u32, shares: vec3f, facing: vec3f) -> vec3f {
    let place = mesh_draws[draw].first_normal + first - mesh_draws[draw].first_corner;
    var n = vec3f(0.0);
    for (var i = 0u; i < 3u; i++) {
        n += unpack_unit_vector(mesh_normals[place + i]) * shares[i];
    }
    var x = mesh_draws[draw].render_from_object_x.xyz;
    var y = mesh_draws[draw].render_from_object_y.xyz;
    var z = mesh_draws[draw].render_from_object_z.xyz;
    let scale = 1.0 / max(max(length(x), length(y)), max(length(z), 1e-30));
    x *= scale;
    y *= scale;
    z *= scale;
    let turned = vec3f(dot(cross(y, z), n), dot(cross(z, x), n), dot(cross(x, y), n));
    let size = length(turned);
    if size < 1e-6 {
        return facing;
    }
    return turned * (select(-1.0, 1.0, dot(turned, facing) >= 0.0) / size);
}

// Scene-linear.
fn texel_color(draw: u32, place: vec2i) -> vec3f {
    let size = vec2i(mesh_draws[draw].texture_size);
    let at = vec2u((place + size) % size);
    let code = unpack4x8unorm(mesh_texels[mesh_draws[draw].first_texel + at.y * u32(size.x) + at.x]).xyz;
    return select(pow((code + 0.055) / 1.055, vec3f(2.4)), code / 12.92, code <= vec3f(0.04045));
}

// By the shares of the corners in a point.
fn mesh_color(draw: u32, first: u32, shares: vec3f) -> vec3f {
    if mesh_draws[draw].first_texel == NONE {
        return mesh_draws[draw].color;
    }
    let place = mesh_draws[draw].first_uv + 2u * (first - mesh_draws[draw].first_corner);
    var uv = vec2f(0.0);
    for (var i = 0u; i < 3u; i++) {
        uv += bitcast<vec2f>(vec2u(mesh_normals[place + 2u * i], mesh_normals[place + 2u * i + 1u])) * shares[i];
    }
    let texel = fract(uv) * vec2f(mesh_draws[draw].texture_size) - 0.5;
    let low = vec2i(floor(texel));
    let share = texel - vec2f(low);
    let below = mix(texel_color(draw, low), texel_color(draw, low + vec2i(1, 0)), share.x);
    let above = mix(texel_color(draw, low + vec2i(0, 1)), texel_color(draw, low + vec2i(1, 1)), share.x);
    return mix(below, above, share.y);
}

// Where the ray through a place of the frame meets a triangle.
fn mesh_point(triangle: u32, pixel: vec2f) -> MeshPoint {
    let draw = find_mesh(triangle);
    let first = mesh_corner(draw, triangle, 0u);
    var corners: array<vec3f, 3>;
    // x - w pixel.x and y - w pixel.y: the origin is the ray.
    var about: array<vec2f, 3>;
    for (var i = 0u; i < 3u; i++) {
        corners[i] = mesh_position(draw, first + i);
        let p = frame.pixel_from_render * vec4f(corners[i], 1.0);
        about[i] = p.xy - pixel * p.z;
    }
    var shares = vec3f(
        about[1].x * about[2].y - about[1].y * about[2].x,
        about[2].x * about[0].y - about[2].y * about[0].x,
        about[0].x * about[1].y - about[0].y * about[1].x,
    );
    let sum = shares.x + shares.y + shares.z;
    shares = select(shares / sum, vec3f(1.0 / 3.0), abs(sum) < 1e-30);
    let position = corners[0] * shares.x + corners[1] * shares.y + corners[2] * shares.z;
    let view = direction_to_viewer(frame.viewer, position);
    var facing = cross(corners[1] - corners[0], corners[2] - corners[0]);
    facing *= select(-1.0, 1.0, dot(facing, view) >= 0.0) / max(length(facing), 1e-30);
    var normal = facing;
    if mesh_draws[draw].first_normal != NONE {
        normal = mesh_normal(draw, first, shares, facing);
    }
    return MeshPoint(position, facing, normal, mesh_color(draw, first, shares), draw);
}

// Whether a view's map holds a place.
fn in_view(view_index: u32, position: vec3f) -> bool {
    let view = shadow_views[view_index];
    let texel = to_pixel(view.texel_from_render, position);
    return texel.z > 0.0 && all(texel.xy >= vec2f(2.0)) && all(texel.xy <= vec2f(view.side - 2.0));
}

// Share of the light from `toward` that a map leaves to a surface facing `facing`.
fn surface_open(view_index: u32, position: vec3f, facing: vec3f, toward: vec3f) -> f32 {
    let view = shadow_views[view_index];
    let texel = to_pixel(view.texel_from_render, position).z / view.texels_per_unit;
    // Texels that the filter reaches must not lie before a slanting surface: so far off it, none does.
    let cosine = dot(facing, toward);
    let off = facing * (2.2 * texel * sqrt(max(1.0 - cosine * cosine, 0.0)));
    return shadow_map(view_index, position + off, texel).open;
}

// Share of a light that is left beside yarns and meshes, as if neither let any through: by the map about the yarns, or beyond it by that
// about all meshes.
fn surface_shadow(light: Light, point: MeshPoint, toward: vec3f) -> f32 {
    if light.shadow_view_count == 6u {
        return surface_open(light.shadow_view + cube_face(point.position - light.position), point.position, point.facing, toward);
    }
    if light.shadow_view_count == 1u && in_view(light.shadow_view, point.position) {
        return surface_open(light.shadow_view, point.position, point.facing, toward);
    }
    if light.wide_view_count == 0u {
        return 1.0;
    }
    let face = select(0u, cube_face(point.position - light.position), light.wide_view_count == 6u);
    return surface_open(light.wide_view + face, point.position, point.facing, toward);
}

// Irradiance with shadows and without, of lamps and of an even sky.
struct MeshLight {
    lamps: vec3f,
    open_lamps: vec3f,
    sky: vec3f,
    open_sky: vec3f,
}

fn mesh_light(point: MeshPoint) -> MeshLight {
    var sum: MeshLight;
    for (var i = 0u; i < frame.light_count; i++) {
        let light = lights[i + unknown_zero()];
        let incident = incident_light(light, point.position);
        let cosine = dot(point.normal, incident.direction);
        if cosine <= 0.0 || dot(point.facing, incident.direction) <= 0.0 || all(incident.irradiance <= vec3f(0.0)) {
            continue;
        }
        sum.open_lamps += incident.irradiance * cosine;
        sum.lamps += incident.irradiance * (cosine * surface_shadow(light, point, incident.direction));
    }
    // What is hidden of an even sky, by this sample's directions: where nothing is, the sky is exact.
    var hidden = 0.0;
    for (var i = 0u; i < frame.sky_view_count; i++) {
        let toward = sky_direction(frame.sky_view + i);
        let cosine = dot(point.normal, toward);
        if cosine <= 0.0 || dot(point.facing, toward) <= 0.0 {
            continue;
        }
        var view = frame.sky_view + i;
        if !in_view(view, point.position) {
            if meshes.wide_sky_view == NONE {
                continue;
            }
            view = meshes.wide_sky_view + i;
        }
        hidden += 4.0 * cosine * (1.0 - surface_open(view, point.position, point.facing, toward));
    }
    sum.open_sky = PI * frame.ambient;
    sum.sky = sum.open_sky * (1.0 - hidden / f32(max(frame.sky_view_count, 1u)));
    return sum;
}

@compute @workgroup_size(64)
fn resolve_meshes(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    frame = read_frame();
    let index = folded_index(workgroup, local, LANES);
    if index >= frame.size.x * frame.size.y {
        return;
    }
    let triangle = seen_triangle(index);
    if triangle == 0u {
        return;
    }
    let pixel = vec2f(frame.origin + vec2u(index % frame.size.x, index / frame.size.x)) + 0.5;
    let point = mesh_point(triangle - 1u, pixel);
    let draw = mesh_draws[point.draw];
    if draw.kind == MESH_HOLDOUT {
        add_sample(index, vec4f(0.0), vec3f(0.0), vec3f(0.0), 1e10, 0.0);
        return;
    }
    let light = mesh_light(point);
    var shaded: Shaded;
    var color = vec4f(0.0);
    if draw.kind == MESH_SHADOW_CATCHER {
        let most = luminance(light.open_lamps + light.open_sky);
        let open = select(luminance(light.lamps + light.sky) / max(most, 1e-30), 1.0, most <= 0.0);
        color = vec4f(0.0, 0.0, 0.0, 1.0 - open);
        if frame.opaque_background == 1u {
            color = vec4f(background_at(pixel) * open, 1.0);
        }
    } else {
        shaded.once.diffuse = point.color / PI * light.lamps;
        shaded.ambient = point.color / PI * light.sky;
        shaded.arriving = luminance(light.lamps);
        shaded.shining = luminance(light.open_lamps);
        color = vec4f(shaded.once.diffuse + shaded.ambient, 1.0);
    }
    let depth = to_pixel(frame.pixel_from_render, point.position).w;
    let number = frame.draw_count + point.draw;
    add_sample(index, color, point.normal, vec3f(0.0), depth, f32(number + 1u));
    let own = triangle - 1u - draw.first_triangle;
    add_mesh_aovs(index, number, own, point.position, select(vec3f(0.0), point.color, draw.kind == MESH_SHADED), shaded);
}
