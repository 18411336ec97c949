// What a scene has few of, where each fits into the 64 KiB of a uniform: native/gpu/src/arrays.rs.
//
// Mesa's software driver compiles a shader anew for every value of a uniform that decides a branch, if the uniform's place is known when it
// compiles: places in these arrays must not be (unknown_zero in scene.wgsl).
@group(0) @binding(1) var<uniform> draws: array<Draw, 682>;
@group(0) @binding(6) var<uniform> yarns: array<Yarn, 315>;
@group(0) @binding(7) var<uniform> materials: array<Material, 682>;
@group(0) @binding(9) var<uniform> lights: array<Light, 1024>;
@group(0) @binding(10) var<uniform> shadow_views: array<ShadowView, 682>;
