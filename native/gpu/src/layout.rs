//! Host-shared structs: the Rust side of `shaders/layout/scene.wgsl`, compared with it member by member in the tests.
#![allow(missing_docs)] // Documented in the WGSL file, once.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};

/// Set on a knot where a segment begins, beside its 16-bit radius.
pub const KNOT_BEGINS_SEGMENT: u32 = 0x10000;
pub const LIGHT_SUN: u32 = 0;
pub const LIGHT_POINT: u32 = 1;
pub const LIGHT_AREA: u32 = 2;
pub const NONE: u32 = u32::MAX;
pub const MESH_SHADED: u32 = 0;
pub const MESH_SHADOW_CATCHER: u32 = 1;
pub const MESH_HOLDOUT: u32 = 2;

/// Declares `repr(C)` structs together with a table of their members for the comparison with WGSL.
macro_rules! shared {
    ($($name:ident { $($member:ident: $type:ty,)* })*) => {
        $(
            #[repr(C)]
            #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
            pub struct $name { $(pub $member: $type,)* }
        )*
        /// Name, size, and (member, offset) of every shared struct.
        #[cfg(test)]
        pub fn shared_structs() -> Vec<(&'static str, usize, Vec<(&'static str, usize)>)> {
            vec![$((
                stringify!($name),
                size_of::<$name>(),
                vec![$((stringify!($member), std::mem::offset_of!($name, $member)),)*],
            ),)*]
        }
    };
}

shared! {
    Frame {
        pixel_from_render: Mat4,
        viewer: Vec4,
        pixels_per_unit: f32,
        depth_min: f32,
        depth_scale: f32,
        near: f32,
        size: [u32; 2],
        segment_count: u32,
        draw_count: u32,
        slot_bits: u32,
        place_bits: u32,
        depth_bits: u32,
        sample_index: u32,
        first: u32,
        cull_margin: f32,
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
        frame_word: u32,
        frame_word_end: u32,
        lod_pixels: f32,
        light_count: u32,
        occlusion_table: u32,
        origin: [u32; 2],
        ambient: Vec3,
        shadow_resolution: u32,
        background: Vec3,
        opaque_background: u32,
        least_w: f32,
        sky_view: u32,
        sky_view_count: u32,
        core_parts: u32,
    }
    Draw {
        render_from_object_x: Vec4,
        render_from_object_y: Vec4,
        render_from_object_z: Vec4,
        first_segment: u32,
        first_knot: u32,
        knot_count: u32,
        yarn: u32,
        material: u32,
        seed: u32,
        radius_max: f32,
        handedness: f32,
        transport: u32,
        holdout: u32,
        padding_0: u32,
        padding_1: u32,
    }
    Curve {
        ply_whole: u32,
        ply_rest: f32,
        fiber_whole: u32,
        fiber_rest: f32,
        migration_whole: u32,
        migration_rest: f32,
        closed_periods: u32,
        seed: u32,
        rest_length: f32,
    }
    Yarn {
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
        fiber_table: u32,
        core_table: u32,
        core_length: u32,
        core_width: u32,
        core_half_width: f32,
        shadow_table: u32,
        shadow_slices: u32,
        shadow_size: u32,
        shadow_extent: f32,
        occlusion_cubic: Vec4,
        occlusion_table: u32,
        occlusion_size: u32,
        occlusion_extent: f32,
        bound: f32,
        core_views: u32,
        core_turns: u32,
        core_slope: f32,
        extinction_table: u32,
        seen_sky_table: u32,
        seen_sky_size: u32,
        tube_radius: f32,
        core_heights: u32,
        core_slants: u32,
        core_slant_step: f32,
        core_widening: f32,
        padding: u32,
    }
    Material {
        color_r: Vec3,
        beta_r: f32,
        color_tt: Vec3,
        beta_tt: f32,
        diffuse: Vec3,
        diffuse_weight: f32,
        specular: Vec3,
        specular_beta: f32,
        gamma_tt: f32,
        azimuthal_tt: f32,
        highlight_scale: f32,
        table: u32,
        table_size: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }
    Light {
        position: Vec3,
        kind: u32,
        color: Vec3,
        shadow_view: u32,
        axis: Vec3,
        shadow_view_count: u32,
        cone: [f32; 2],
        wide_view: u32,
        wide_view_count: u32,
    }
    ShadowView {
        texel_from_render: Mat4,
        depth_min: f32,
        depth_scale: f32,
        texels_per_unit: f32,
        near: f32,
        side: f32,
        parallel: u32,
        padding_0: u32,
        padding_1: u32,
    }
    Meshes {
        clip_depth: [f32; 2],
        draw_count: u32,
        wide_sky_view: u32,
    }
    MeshDraw {
        render_from_object_x: Vec4,
        render_from_object_y: Vec4,
        render_from_object_z: Vec4,
        color: Vec3,
        kind: u32,
        first_triangle: u32,
        first_corner: u32,
        first_position: u32,
        first_normal: u32,
        texture_size: [u32; 2],
        first_texel: u32,
        first_uv: u32,
    }
    Sky {
        environment_from_render_x: Vec4,
        environment_from_render_y: Vec4,
        environment_from_render_z: Vec4,
        size: [u32; 2],
        strength: f32,
        padding: f32,
    }
}
