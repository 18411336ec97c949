// Answers queries about one fiber model: see native/gpu/tests/scattering.rs.

struct Parameters {
    material: Material,
    thread: Thread,
    model: u32,
    table_size: u32,
}

struct Query {
    viewer: vec4f,
    light: vec4f,
    random: vec4f,
}

struct Answer {
    value: vec4f,
    albedo: vec4f,
    drawn: vec4f,
    drawn_value: vec4f,
}

@group(0) @binding(0) var<uniform> parameters: Parameters;
@group(0) @binding(1) var<storage, read> tables: array<f32>;
@group(0) @binding(2) var<storage, read> queries: array<Query>;
@group(0) @binding(3) var<storage, read_write> answers: array<Answer>;

fn thread_table(table: u32, theta: f32) -> f32 {
    let place = thread_table_place(theta, parameters.table_size);
    let k = min(u32(place), parameters.table_size - 2u);
    let first = table * parameters.table_size + k;
    return mix(tables[first], tables[first + 1u], place - f32(k));
}

fn thread_terms_at(theta: f32) -> vec2f {
    return vec2f(thread_table(1u, theta), thread_table(2u, theta));
}

fn all_lobes(reflected: Reflected) -> vec3f {
    return reflected.specular + reflected.transmission + reflected.diffuse;
}

fn evaluate(viewer: vec3f, light: vec3f) -> vec3f {
    let frame = fiber_frame(vec3f(0.0, 0.0, 1.0), vec3f(1.0, 0.0, 0.3));
    let local_light = transpose(frame) * light;
    let angles = fiber_angles(frame[2], light, viewer);
    switch parameters.model {
        case 0u: { return all_lobes(simple_lobes(parameters.material, angles, local_light.x)); }
        case 1u: {
            let normalizers = exact_normalizers(parameters.material, longitude(local_light));
            return all_lobes(physical_lobes(parameters.material, normalizers, angles, local_light.x));
        }
        default: {
            let limits = vec2f(thread_table(0u, longitude(light)), thread_table(0u, longitude(viewer)));
            return thread_reflected(parameters.thread, limits, angles);
        }
    }
}

fn albedo(light: vec3f) -> vec3f {
    switch parameters.model {
        case 0u: { return simple_albedo(parameters.material, longitude(light)); }
        case 1u: { return physical_albedo(parameters.material, length(light.xy)); }
        default: { return thread_albedo(parameters.thread, thread_terms_at(longitude(light))); }
    }
}

fn mixture_of(viewer: vec3f) -> Mixture {
    switch parameters.model {
        case 0u: { return simple_mixture(parameters.material); }
        case 1u: { return physical_mixture(parameters.material, viewer); }
        default: { return thread_mixture(parameters.thread, thread_terms_at(longitude(viewer))); }
    }
}

@compute @workgroup_size(64)
fn answer_queries(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let query = queries[id.x];
    let viewer = query.viewer.xyz;
    let light = query.light.xyz;
    let mixture = mixture_of(viewer);
    let drawn = mixture_sample(mixture, viewer, query.random.xyz);
    answers[id.x] = Answer(
        vec4f(evaluate(viewer, light), mixture_density(mixture, viewer, light)),
        vec4f(albedo(light), 0.0),
        vec4f(drawn, mixture_density(mixture, viewer, drawn)),
        vec4f(evaluate(viewer, drawn), 0.0),
    );
}
