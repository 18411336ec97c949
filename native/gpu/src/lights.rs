//! Lights and the views their shadows are drawn from, one sample at a time.

use glam::{DMat4, DVec3, DVec4};
use lisle_core::scene::Lobe;

use crate::layout::{self, LIGHT_AREA, LIGHT_POINT, LIGHT_SUN};
use crate::sampling::{Use, basis, disc, pair, sphere};
use crate::view::Bounds;
use crate::{Cone, Environment, Light};

/// What shadow maps are about, render space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// All yarns, or all meshes where there are none. A map about them holds all that throws shadows on them, and all that they throw
    /// shadows on.
    pub focus: Bounds,
    /// All meshes besides, for which each light has a second map, of meshes alone; empty where there are none.
    pub wide: Bounds,
}

impl Extent {
    pub fn new(yarns: Bounds, meshes: Bounds) -> Self {
        if yarns.is_empty() { Self { focus: meshes, wide: Bounds::EMPTY } } else { Self { focus: yarns, wide: meshes } }
    }

    pub fn is_empty(&self) -> bool {
        self.focus.is_empty()
    }

    fn all(&self) -> Bounds {
        let mut all = self.focus;
        all.merge(&self.wide);
        all
    }
}

/// What one sample of the lights looks like on the GPU.
pub(crate) struct LightSample {
    pub lights: Vec<layout::Light>,
    pub views: Vec<layout::ShadowView>,
    extent: Extent,
    /// Of a shadow map, texels.
    resolution: u32,
}

/// Margin around a view, texels, so that the shadow filter never leaves a cube's face.
const MARGIN: f64 = 4.0;

/// The cube faces in the order of `cube_face` in `shaders/passes/lighting.wgsl`.
const CUBE: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

/// A shadow view whose rows map render space to texels.
fn shadow_view(rows: [DVec4; 4], scale: f64, near: f64, depth: (f64, f64), side: f64) -> layout::ShadowView {
    let [x, y, w, z] = rows;
    layout::ShadowView {
        texel_from_render: DMat4::from_cols(x, y, w, z).transpose().as_mat4(),
        depth_min: depth.0 as f32,
        depth_scale: (1.0 / (depth.1 - depth.0).max(1e-12)) as f32,
        texels_per_unit: scale as f32,
        near: near as f32,
        side: side as f32,
        parallel: u32::from(w == DVec4::W),
        ..Default::default()
    }
}

/// Parallel light from `toward` on `bounds`, with depths of all between `all`.
fn parallel_view(toward: DVec3, bounds: &Bounds, all: &Bounds, resolution: f64) -> layout::ShadowView {
    let (x, y) = basis(toward);
    let extent = |bounds: &Bounds, axis: DVec3| {
        bounds
            .corners()
            .into_iter()
            .map(|c| c.dot(axis))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
    };
    let ((x0, x1), (y0, y1), depth) = (extent(bounds, x), extent(bounds, y), extent(all, -toward));
    let scale = (resolution - 2.0 * MARGIN) / (x1 - x0).max(y1 - y0).max(1e-12);
    let row = |axis: DVec3, from: f64, to: f64| (axis * scale).extend(0.5 * resolution - 0.5 * (from + to) * scale);
    let rows = [row(x, x0, x1), row(y, y0, y1), DVec4::W, (-toward).extend(0.0)];
    shadow_view(rows, scale, depth.0 - 1.0, depth, resolution)
}

/// From a point along an axis, `tangent` being that of half the field of view.
fn point_view(
    position: DVec3,
    axis: DVec3,
    tangent: f64,
    bounds: &Bounds,
    all: &Bounds,
    resolution: f64,
) -> layout::ShadowView {
    let (x, y) = basis(axis);
    let scale = (0.5 * resolution - MARGIN) / tangent;
    let w = axis.extend(-axis.dot(position));
    let row = |a: DVec3| (a * scale).extend(-a.dot(position) * scale) + w * (0.5 * resolution);
    let far = all.corners().into_iter().map(|c| c.distance(position)).fold(0.0, f64::max);
    // No yarn is nearer than their box.
    let inside = position.clamp(bounds.min, bounds.max);
    let near = (0.99 * inside.distance(position)).max(1e-4 * far);
    let nearest = position.clamp(all.min, all.max).distance(position).min(near);
    shadow_view([row(x), row(y), w, w], scale, near, (nearest, far), resolution)
}

impl LightSample {
    /// Sample `index` of every light; `resolution` is a shadow map's side.
    pub fn new(lights: &[Light], origin: DVec3, extent: Extent, resolution: u32, index: u32, seed: u32) -> Self {
        let mut sample = Self { lights: Vec::new(), views: Vec::new(), extent, resolution };
        for (number, light) in lights.iter().enumerate() {
            sample.add(light, origin, pair(index, seed, Use::Light(number as u32)));
        }
        sample
    }

    /// A further view from the sky, on a quarter of its map: one of many directions needs no sharp shadow.
    pub fn add_sky(&mut self, toward: DVec3) {
        self.views.push(parallel_view(toward, &self.extent.focus, &self.extent.all(), f64::from(self.resolution / 2)));
    }

    /// The same of all meshes.
    pub fn add_wide_sky(&mut self, toward: DVec3) {
        self.views.push(parallel_view(toward, &self.extent.wide, &self.extent.wide, f64::from(self.resolution / 2)));
    }

    /// A direction of the sky's picture as a sun, with such a share of all light from there; its maps as for the sky.
    pub fn add_environment(&mut self, environment: &Environment, uniform: [f64; 2], share: f64) {
        let toward = environment.sample(uniform);
        let color = environment.mean_radiance_over_pdf(toward) * share;
        let mut item = layout::Light {
            kind: LIGHT_SUN,
            position: toward.as_vec3(),
            color: color.as_vec3(),
            shadow_view: self.views.len() as u32,
            shadow_view_count: 1,
            cone: [-2.0, -2.0],
            ..Default::default()
        };
        self.add_sky(toward);
        if !self.extent.wide.is_empty() {
            (item.wide_view, item.wide_view_count) = (self.views.len() as u32, 1);
            self.add_wide_sky(toward);
        }
        self.lights.push(item);
    }

    fn add(&mut self, light: &Light, origin: DVec3, uniform: [f64; 2]) {
        let mut item = layout::Light { cone: [-2.0, -2.0], ..Default::default() };
        let views: [Vec<layout::ShadowView>; 2] = match *light {
            Light::Sun { direction, irradiance, angle_rad } => {
                let center = -direction.normalize();
                let (x, y) = basis(center);
                let [u, v] = disc(uniform).map(|c| c * (0.5 * angle_rad.min(3.1)).tan());
                let toward = (center + x * u + y * v).normalize();
                (item.kind, item.position, item.color) = (LIGHT_SUN, toward.as_vec3(), irradiance);
                self.parallel_views(toward)
            }
            // Directions have the density of the radiance, so that each stands for all light.
            Light::Gaussian { direction, fluence, sharpness } => {
                let toward = Lobe::new(-direction, sharpness).sample(uniform);
                (item.kind, item.position, item.color) = (LIGHT_SUN, toward.as_vec3(), fluence);
                self.parallel_views(toward)
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
                self.point_views(position)
            }
            Light::Area { world_from_light, size, ellipse, power } => {
                let [u, v] = if ellipse { disc(uniform).map(|c| 0.5 * c) } else { uniform.map(|c| c - 0.5) };
                let local = DVec3::new(u * size[0], v * size[1], 0.0);
                let position = world_from_light.transform_point3(local) - origin;
                item.kind = LIGHT_AREA;
                item.position = position.as_vec3();
                item.axis = -world_from_light.transform_vector3(DVec3::Z).normalize().as_vec3();
                item.color = power / std::f32::consts::PI;
                self.point_views(position)
            }
        };
        let [near, wide] = views;
        (item.shadow_view, item.shadow_view_count) = (self.views.len() as u32, near.len() as u32);
        self.views.extend(near);
        (item.wide_view, item.wide_view_count) = (self.views.len() as u32, wide.len() as u32);
        self.views.extend(wide);
        self.lights.push(item);
    }

    /// A view about the yarns, and one about all meshes.
    fn parallel_views(&self, toward: DVec3) -> [Vec<layout::ShadowView>; 2] {
        let resolution = f64::from(self.resolution);
        let Extent { focus, wide } = &self.extent;
        let wide = (!wide.is_empty()).then(|| parallel_view(toward, wide, wide, resolution));
        [vec![parallel_view(toward, focus, &self.extent.all(), resolution)], wide.into_iter().collect()]
    }

    /// Views about the yarns, and about all meshes: a cube of six is about both.
    fn point_views(&self, position: DVec3) -> [Vec<layout::ShadowView>; 2] {
        let Extent { focus, wide } = &self.extent;
        let all = self.extent.all();
        let near = self.views_on(position, focus, &all);
        let wide = if near.len() == 6 || wide.is_empty() { Vec::new() } else { self.views_on(position, wide, wide) };
        [near, wide]
    }

    /// One view that holds everything if the point is well outside of it, else the six faces of a cube.
    fn views_on(&self, position: DVec3, bounds: &Bounds, all: &Bounds) -> Vec<layout::ShadowView> {
        let resolution = f64::from(self.resolution);
        let center = 0.5 * (bounds.min + bounds.max);
        let radius = 0.5 * bounds.min.distance(bounds.max);
        let distance = position.distance(center);
        if distance > 1.3 * radius {
            let tangent = radius / (distance * distance - radius * radius).sqrt();
            vec![point_view(position, (center - position) / distance, tangent, bounds, all, resolution)]
        } else {
            CUBE.map(|axis| point_view(position, axis, 1.0, bounds, all, resolution)).to_vec()
        }
    }
}

/// Cosines between which a spot's edge fades: full inside the first, dark outside the second.
fn cone_cosines(cone: &Cone) -> [f32; 2] {
    let edge = (0.5 * cone.angle_rad).cos();
    let soft = (1.0 - edge) * cone.blend.clamp(0.0, 1.0);
    [(edge + soft.max(1e-6)) as f32, edge as f32]
}

/// Most shadow views that one sample of these lights and so many of the sky needs; with meshes, beside yarns or not.
pub(crate) fn most_views(lights: &[Light], sky_views: u32, meshes: bool) -> u32 {
    let of = |light: &Light| if matches!(light, Light::Sun { .. } | Light::Gaussian { .. }) { 1 } else { 6 };
    (lights.iter().map(of).sum::<u32>() + sky_views) * if meshes { 2 } else { 1 }
}
