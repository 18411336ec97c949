// Answers queries about the tables of one yarn and one material: see lighting_tests.rs. Follows the files of a resolve pass.

struct LightingQuery {
    // Along the section's first two axes; the yarn's is the third.
    viewer: vec4f,
    light: vec4f,
    // Place in the section, sin θ on a fiber, and the turn of the plies per radius along the yarn.
    place: vec4f,
    // Direction of the fiber.
    tangent: vec4f,
}

struct LightingAnswer {
    depth: f32,
    point: f32,
    width: f32,
    sky_of_seen: f32,
    occlusion_table: f32,
    occlusion_distance: f32,
    sky: f32,
    integral_r: f32,
    integral_tt: f32,
    ambient: array<f32, 3>,
}

@group(1) @binding(0) var<storage, read> queries: array<LightingQuery>;
@group(1) @binding(1) var<storage, read_write> answers: array<LightingAnswer>;

@compute @workgroup_size(64)
fn answer_queries(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let query = queries[id.x];
    let yarn = yarns[0];
    let section = SectionPoint(query.place.xy, vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), vec3f(0.0, 0.0, 1.0), query.place.w);
    let seen = seen_point(yarn, section, query.tangent.xyz, query.viewer.xyz);
    let shadows = self_shadows(yarn, seen, query.light.xyz);
    frame.occlusion_table = 0u;
    let distance = self_occlusion(yarn, section);
    frame.occlusion_table = 1u;
    let normalizers = normalizers_at(materials[0], query.place.z);
    let ambient = ambient_factors(materials[0], query.place.z);
    answers[id.x] = LightingAnswer(
        self_depth(yarn, query.place.xy, direction_out(section, query.light.xyz)),
        shadows.point,
        shadows.width,
        sky_of_seen(yarn, seen),
        self_occlusion(yarn, section),
        distance,
        self_sky(yarn, seen),
        normalizers.integral_r,
        normalizers.integral_tt,
        array<f32, 3>(ambient.x, ambient.y, ambient.z),
    );
}
