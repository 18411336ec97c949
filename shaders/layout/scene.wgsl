// Host-shared structs; their Rust side is native/gpu/src/layout.rs, compared member by member in its tests.
//
// Spaces: "object" is the curve object's own space, recentred; "render" has the world's axes and its origin at the
// camera; "pixel" is the whole frame, x to the right, y down, pixel centres at integers + 0.5.

struct Frame {
    // (x, y, w, z) of pixel space: pixel = (x / w, y / w), z = distance along the view axis.
    pixel_from_render: mat4x4f,
    // Perspective: the viewer's position (the origin) and 0. Orthographic: the direction towards the viewer and 1.
    viewer: vec4f,
    // Pixels per unit of length at w = 1.
    pixels_per_unit: f32,
    depth_min: f32,
    depth_scale: f32,
    near: f32,
    // Of the tile that is drawn.
    size: vec2u,
    segment_count: u32,
    draw_count: u32,
    // Bits of a visibility key below the depth, and of its parts.
    slot_bits: u32,
    place_bits: u32,
    depth_bits: u32,
    sample_index: u32,
    // Whether this is the picture's first sample, that the film begins with.
    first: u32,
    // Pixels around the tile within which samples may see what the culled one does not.
    cull_margin: f32,
    // First planes of further passes.
    plane_position: u32,
    plane_uv: u32,
    plane_vector: u32,
    plane_matte: u32,
    plane_albedo: u32,
    plane_diffuse: u32,
    plane_specular: u32,
    plane_transmission: u32,
    plane_scattered: u32,
    plane_ambient: u32,
    plane_shadow: u32,
    // Where among the vector's words a frame writes: two, or the same again up to the end.
    frame_word: u32,
    frame_word_end: u32,
    lod_pixels: f32,
    light_count: u32,
    occlusion_table: u32,
    // First pixel of the tile.
    origin: vec2u,
    ambient: vec3f,
    shadow_resolution: u32,
    background: vec3f,
    opaque_background: u32,
    // Least w at which sizes on the screen are measured: the near plane, or 1 for an orthographic view.
    least_w: f32,
    // Shadow views from this sample's directions of the sky: the first, and how many.
    sky_view: u32,
    sky_view_count: u32,
    // Threads that share a segment's cores; a power of two.
    core_parts: u32,
}

// One yarn object, or one instance of it.
struct Draw {
    render_from_object_x: vec4f,
    render_from_object_y: vec4f,
    render_from_object_z: vec4f,
    first_segment: u32,
    first_knot: u32,
    knot_count: u32,
    yarn: u32,
    material: u32,
    seed: u32,
    // Render-space radius of a knot's stored value 65535.
    radius_max: f32,
    // -1 if the transform mirrors, else 1.
    handedness: f32,
    // Offset of its table of multiple scattering.
    transport: u32,
    // 1 for a hole in the picture.
    holdout: u32,
    padding_0: u32,
    padding_1: u32,
}

// Turns over a whole curve: whole part and rest, since the length coordinate is a 32-bit fraction of the curve's length.
struct Curve {
    ply_whole: u32,
    ply_rest: f32,
    fiber_whole: u32,
    fiber_rest: f32,
    migration_whole: u32,
    migration_rest: f32,
    // Periods after which a closed curve repeats; 0 for an open one.
    closed_periods: u32,
    seed: u32,
    // Object space.
    rest_length: f32,
}

// A procedural yarn. Lengths are in units of its outer radius unless they are relative to the ply's half axes.
struct Yarn {
    plies: u32,
    fibers: u32,
    flyaway_fibers: u32,
    core_layers: u32,
    ply_distance: f32,
    ellipse_short: f32,
    ellipse_long: f32,
    fiber_radius: f32,
    ply_sign: f32,
    fiber_sign: f32,
    r_min: f32,
    loop_chance: f32,
    hair_chance: f32,
    loop_radius_mean: f32,
    loop_radius_deviation: f32,
    tip_min_mean: f32,
    tip_min_deviation: f32,
    tip_span_mean: f32,
    tip_span_deviation: f32,
    width_mean: f32,
    width_deviation: f32,
    turns_mean: f32,
    turns_deviation: f32,
    // Offsets into the table buffer.
    fiber_table: u32,
    core_table: u32,
    core_length: u32,
    core_width: u32,
    core_half_width: f32,
    shadow_table: u32,
    shadow_slices: u32,
    shadow_size: u32,
    shadow_extent: f32,
    occlusion_cubic: vec4f,
    occlusion_table: u32,
    occlusion_size: u32,
    occlusion_extent: f32,
    // Distance from the yarn centre that no fiber leaves, flyaways included.
    bound: f32,
    core_views: u32,
    core_turns: u32,
    core_slope: f32,
    extinction_table: u32,
    seen_sky_table: u32,
    seen_sky_size: u32,
    // Of the opaque tube that takes as much light as the fibers.
    tube_radius: f32,
    // The core texture's heights once more, with their fibers' places in the order of drawing, two to a word: visibility wants nothing else, and waits for memory.
    core_heights: u32,
    core_slants: u32,
    // Of the slant's tangent, from one texture to the next; what that adds to half of what v covers.
    core_slant_step: f32,
    core_widening: f32,
    padding: u32,
}

struct Material {
    color_r: vec3f,
    beta_r: f32,
    color_tt: vec3f,
    beta_tt: f32,
    diffuse: vec3f,
    diffuse_weight: f32,
    specular: vec3f,
    specular_beta: f32,
    gamma_tt: f32,
    // Factor of the von Mises density of TT, and of the simple highlight.
    azimuthal_tt: f32,
    highlight_scale: f32,
    // Offset of its five 1D tables and the length of each.
    table: u32,
    table_size: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

const LIGHT_SUN: u32 = 0u;
const LIGHT_POINT: u32 = 1u;
const LIGHT_AREA: u32 = 2u;

// A light as one sample sees it: a soft light is a point on its surface, another one each time.
struct Light {
    // Sun: direction towards it. Otherwise: position, render space.
    position: vec3f,
    kind: u32,
    // Sun: irradiance. Point: intensity (W/sr). Area: intensity along its axis.
    color: vec3f,
    // First of its shadow views, and how many: 1, or 6 faces of a cube.
    shadow_view: u32,
    // Spot and area: axis in which it shines.
    axis: vec3f,
    shadow_view_count: u32,
    // Spot: cosines at which its cone begins and ends to fade; (-2, -2) for none.
    cone: vec2f,
    // First of its maps about all meshes, and how many: 0, 1 or 6.
    wide_view: u32,
    wide_view_count: u32,
}

struct ShadowView {
    // As Frame.pixel_from_render, in texels.
    texel_from_render: mat4x4f,
    depth_min: f32,
    depth_scale: f32,
    // Texels per unit at w = 1.
    texels_per_unit: f32,
    near: f32,
    // Texels along one side, from the corner of its map.
    side: f32,
    // 1 if all its rays are, else 0.
    parallel: u32,
    padding_0: u32,
    padding_1: u32,
}

// A picture of the sky.
struct Sky {
    // A rotation.
    environment_from_render_x: vec4f,
    environment_from_render_y: vec4f,
    environment_from_render_z: vec4f,
    // Width and height; 0 without one.
    size: vec2u,
    strength: f32,
    padding: f32,
}

// What the vector pass keeps of a point before its places in frames, words: segment + 1, or 0; the parameter along it; and the offset on a yarn
// or, for a mesh, the render-space position.
const VECTOR_PARAMETER: u32 = 1u;
const VECTOR_PLACE: u32 = 2u;

const NONE: u32 = 0xffffffffu;
const MESH_SHADED: u32 = 0u;
const MESH_SHADOW_CATCHER: u32 = 1u;
const MESH_HOLDOUT: u32 = 2u;

// All meshes, as one sample sees them.
struct Meshes {
    // Clip depth × w is clip_depth.x × distance along the view axis + clip_depth.y.
    clip_depth: vec2f,
    draw_count: u32,
    // First of the maps about all meshes for the sample's directions of the sky, or NONE.
    wide_sky_view: u32,
}

// One mesh, or one instance of it.
struct MeshDraw {
    render_from_object_x: vec4f,
    render_from_object_y: vec4f,
    render_from_object_z: vec4f,
    color: vec3f,
    kind: u32,
    // Triangles of all instances count on.
    first_triangle: u32,
    // Of its geometry; first_normal is NONE if it is flat.
    first_corner: u32,
    first_position: u32,
    first_normal: u32,
    // Of its colours; first_texel is NONE if it has one colour.
    texture_size: vec2u,
    first_texel: u32,
    first_uv: u32,
}
