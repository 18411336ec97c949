//! Lights and the views their shadows are drawn from, one sample at a time.

use glam::{DMat4, DVec3, DVec4};

use crate::layout::{self, LIGHT_AREA, LIGHT_POINT, LIGHT_SUN};
use crate::sampling::{basis, disc, r2, sphere};
use crate::view::Bounds;
use crate::{Cone, Light};

/// What one sample of the lights looks like on the GPU.
#[derive(Default)]
pub(crate) struct LightSample {
    pub lights: Vec<layout::Light>,
    pub views: Vec<layout::ShadowView>,
}

/// Margin around a view, texels, so that the shadow filter never leaves a cube's face.
const MARGIN: f64 = 4.0;

/// The cube faces in the order of `cube_face` in `shaders/passes/lighting.wgsl`.
const CUBE: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

/// A shadow view whose rows map render space to texels.
fn shadow_view(rows: [DVec4; 4], scale: f64, near: f64, depth: (f64, f64)) -> layout::ShadowView {
    let [x, y, w, z] = rows;
    layout::ShadowView {
        texel_from_render: DMat4::from_cols(x, y, w, z).transpose().as_mat4(),
        depth_min: depth.0 as f32,
        depth_scale: (1.0 / (depth.1 - depth.0).max(1e-12)) as f32,
        texels_per_unit: scale as f32,
        near: near as f32,
    }
}

/// Parallel light from `toward`.
fn parallel_view(toward: DVec3, bounds: &Bounds, resolution: f64) -> layout::ShadowView {
    let (x, y) = basis(toward);
    let extent = |axis: DVec3| {
        bounds
            .corners()
            .into_iter()
            .map(|c| c.dot(axis))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
    };
    let ((x0, x1), (y0, y1), depth) = (extent(x), extent(y), extent(-toward));
    let scale = (resolution - 2.0 * MARGIN) / (x1 - x0).max(y1 - y0).max(1e-12);
    let row = |axis: DVec3, from: f64, to: f64| (axis * scale).extend(0.5 * resolution - 0.5 * (from + to) * scale);
    let rows = [row(x, x0, x1), row(y, y0, y1), DVec4::W, (-toward).extend(0.0)];
    shadow_view(rows, scale, depth.0 - 1.0, depth)
}

/// From a point along an axis, `tangent` being that of half the field of view.
fn point_view(position: DVec3, axis: DVec3, tangent: f64, bounds: &Bounds, resolution: f64) -> layout::ShadowView {
    let (x, y) = basis(axis);
    let scale = (0.5 * resolution - MARGIN) / tangent;
    let w = axis.extend(-axis.dot(position));
    let row = |a: DVec3| (a * scale).extend(-a.dot(position) * scale) + w * (0.5 * resolution);
    let far = bounds.corners().into_iter().map(|c| c.distance(position)).fold(0.0, f64::max);
    // Nothing is nearer than the box of all yarns.
    let inside = position.clamp(bounds.min, bounds.max);
    let near = (0.99 * inside.distance(position)).max(1e-4 * far);
    shadow_view([row(x), row(y), w, w], scale, near, (near, far))
}

impl LightSample {
    /// Sample `index` of every light. `bounds` holds all yarns, render space; `resolution` is a shadow map's side.
    pub fn new(lights: &[Light], origin: DVec3, bounds: &Bounds, resolution: u32, index: u32, seed: u32) -> Self {
        let mut sample = Self::default();
        for (number, light) in lights.iter().enumerate() {
            sample.add(light, origin, bounds, f64::from(resolution), r2(index, seed, 16 + number as u32));
        }
        sample
    }

    /// A further view from the sky, on a quarter of its map: one of many directions needs no sharp shadow.
    pub fn add_sky(&mut self, toward: DVec3, bounds: &Bounds, resolution: u32) {
        self.views.push(parallel_view(toward, bounds, f64::from(resolution / 2)));
    }

    fn add(&mut self, light: &Light, origin: DVec3, bounds: &Bounds, resolution: f64, uniform: [f64; 2]) {
        let first_view = self.views.len() as u32;
        let mut item = layout::Light { shadow_view: first_view, cone: [-2.0, -2.0], ..Default::default() };
        match *light {
            Light::Sun { direction, irradiance, angle_rad } => {
                let center = -direction.normalize();
                let (x, y) = basis(center);
                let [u, v] = disc(uniform).map(|c| c * (0.5 * angle_rad.min(3.1)).tan());
                let toward = (center + x * u + y * v).normalize();
                item.kind = LIGHT_SUN;
                item.position = toward.as_vec3();
                item.color = irradiance;
                self.views.push(parallel_view(toward, bounds, resolution));
            }
            Light::Point { position, power, radius, cone } => {
                let position = position - origin + sphere(uniform) * radius;
                item.kind = LIGHT_POINT;
                item.position = position.as_vec3();
                item.color = power / (4.0 * std::f32::consts::PI);
                if let Some(cone) = cone {
                    item.axis = cone.direction.normalize().as_vec3();
                    item.cone = cone_cosines(&cone);
                }
                self.add_point_views(position, bounds, resolution);
            }
            Light::Area { world_from_light, size, ellipse, power } => {
                let [u, v] = if ellipse { disc(uniform).map(|c| 0.5 * c) } else { uniform.map(|c| c - 0.5) };
                let local = DVec3::new(u * size[0], v * size[1], 0.0);
                let position = world_from_light.transform_point3(local) - origin;
                item.kind = LIGHT_AREA;
                item.position = position.as_vec3();
                item.axis = -world_from_light.transform_vector3(DVec3::Z).normalize().as_vec3();
                item.color = power / std::f32::consts::PI;
                self.add_point_views(position, bounds, resolution);
            }
        }
        item.shadow_view_count = self.views.len() as u32 - first_view;
        self.lights.push(item);
    }

    /// One view that holds everything if the point is well outside of it, else the six faces of a cube.
    fn add_point_views(&mut self, position: DVec3, bounds: &Bounds, resolution: f64) {
        let center = 0.5 * (bounds.min + bounds.max);
        let radius = 0.5 * bounds.min.distance(bounds.max);
        let distance = position.distance(center);
        if distance > 1.3 * radius {
            let tangent = radius / (distance * distance - radius * radius).sqrt();
            self.views.push(point_view(position, (center - position) / distance, tangent, bounds, resolution));
        } else {
            self.views.extend(CUBE.map(|axis| point_view(position, axis, 1.0, bounds, resolution)));
        }
    }
}

/// Cosines between which a spot's edge fades: full inside the first, dark outside the second.
fn cone_cosines(cone: &Cone) -> [f32; 2] {
    let edge = (0.5 * cone.angle_rad).cos();
    let soft = (1.0 - edge) * cone.blend.clamp(0.0, 1.0);
    [(edge + soft.max(1e-6)) as f32, edge as f32]
}

/// Most shadow views that one sample of these lights and so many of the sky needs.
pub(crate) fn most_views(lights: &[Light], sky_views: u32) -> u32 {
    let of = |light: &Light| if matches!(light, Light::Sun { .. }) { 1 } else { 6 };
    lights.iter().map(of).sum::<u32>() + sky_views
}

/// Whether samples of the light differ.
pub(crate) fn is_soft(light: &Light) -> bool {
    match *light {
        Light::Sun { angle_rad, .. } => angle_rad > 0.0,
        Light::Point { radius, .. } => radius > 0.0,
        Light::Area { .. } => true,
    }
}
