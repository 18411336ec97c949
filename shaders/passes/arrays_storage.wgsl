// What a scene has few of, where there is more than a uniform holds: native/gpu/src/arrays.rs.
@group(0) @binding(1) var<storage, read> draws: array<Draw>;
@group(0) @binding(6) var<storage, read> yarns: array<Yarn>;
@group(0) @binding(7) var<storage, read> materials: array<Material>;
@group(0) @binding(9) var<storage, read> lights: array<Light>;
@group(0) @binding(10) var<storage, read> shadow_views: array<ShadowView>;
