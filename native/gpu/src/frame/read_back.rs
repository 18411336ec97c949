//! From the film to an image.

use glam::Vec3;

use super::{Recorder, Work};
use crate::aov::NO_PLANE;
use crate::{Aov, Error, Image, Labels, Scene, aov, cryptomatte};

impl Recorder<'_> {
    /// Object id and labels of a draw: meshes count on from the yarns.
    fn labels(&self, draw: usize) -> (u32, &Labels) {
        let Scene { objects, meshes, .. } = self.input.scene;
        match objects.get(draw) {
            Some(object) => (object.id, &object.labels),
            None => (meshes[draw - objects.len()].id, &meshes[draw - objects.len()].labels),
        }
    }

    /// Bytes of a buffer, copied through the staging buffer.
    pub(super) fn read(&self, copies: &[(&wgpu::Buffer, u64)]) -> Result<Vec<u8>, Error> {
        let mut encoder = self.encoder();
        let mut at = 0;
        for (buffer, bytes) in copies {
            encoder.copy_buffer_to_buffer(buffer, 0, &self.frame.staging, at, *bytes);
            at += bytes;
        }
        self.gpu.submit(encoder);
        let slice = self.frame.staging.slice(..at);
        slice.map_async(wgpu::MapMode::Read, |_| {});
        self.gpu.finish()?;
        let data = slice.get_mapped_range().map_err(|error| self.gpu.error(error.to_string()))?.to_vec();
        self.frame.staging.unmap();
        Ok(data)
    }

    /// What the last cull has found to draw.
    pub(super) fn check_work(&self) -> Result<Work, Error> {
        if self.uniform.segment_count == 0 {
            return Ok(Work::default());
        }
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&self.read(&[(&self.frame.dispatch, 32)])?);
        if words[4] != 0 {
            return Err(Error::input("scene", "more than 4.29 billion fiber segments are visible in one picture"));
        }
        Ok(Work { fiber_segments: words[5].into(), fiber_lines: u64::from(words[6]) | u64::from(words[7]) << 32 })
    }

    /// Ids of all draws in the mattes: by object, by material.
    fn matte_ids(&self) -> [Vec<f32>; 2] {
        let Scene { objects, meshes, .. } = self.input.scene;
        let id = |name: &str| cryptomatte::id(cryptomatte::hash(name));
        let objects = objects.iter().map(|o| (&o.name, &o.labels.material));
        objects
            .chain(meshes.iter().map(|m| (&m.name, &m.labels.material)))
            .map(|(name, material)| (id(name), id(material)))
            .unzip::<_, _, Vec<_>, Vec<_>>()
            .into()
    }

    /// How a pixel's point moves on the picture: a yarn's as the shaders have followed it, a mesh's with its triangle.
    fn vector(&self, planes: &aov::Tile, pixel: usize, draw: Option<usize>) -> [f32; 4] {
        let mesh = draw.and_then(|draw| draw.checked_sub(self.input.scene.objects.len()));
        let (Some(mesh), Some([before, after])) = (mesh, self.input.neighbours) else {
            return aov::vector(planes.yarn_pixels(pixel));
        };
        let place = Vec3::from(planes.values::<3>(planes.planes.vector + aov::VECTOR_PLACE, pixel));
        let triangle = planes.word(planes.planes.vector + aov::VECTOR_PARAMETER, pixel) as usize;
        let world = self.first_view.origin + place.as_dvec3();
        self.first_view.pixel(world).map_or([0.0; 4], |here| {
            aov::vector([
                here,
                before.mesh_pixel(mesh, triangle, world).unwrap_or(here),
                after.mesh_pixel(mesh, triangle, world).unwrap_or(here),
            ])
        })
    }

    pub(super) fn read_tile(
        &self,
        tile: [u32; 4],
        origin: [u32; 2],
        samples: u32,
        image: &mut Image,
    ) -> Result<(), Error> {
        let [left, top, width, height] = tile;
        let pixels = width as usize * height as usize;
        let bytes = 16 * pixels as u64;
        let film = &self.frame.film;
        let data = self.read(&[(&film[0], bytes), (&film[1], bytes), (&film[2], bytes)])?;
        let values: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&data);
        let (color, rest) = values.split_at(pixels);
        let (normal, tangent) = rest.split_at(pixels);
        let words: Vec<u32> = match self.input.planes.count {
            0 => Vec::new(),
            count => {
                bytemuck::pod_collect_to_vec(&self.read(&[(&self.frame.aovs, 4 * u64::from(count) * pixels as u64)])?)
            }
        };
        let planes = aov::Tile { planes: self.input.planes, words: &words, pixels };
        let ids = if self.input.planes.matte == NO_PLANE { [const { Vec::new() }; 2] } else { self.matte_ids() };
        let scale = 1.0 / samples as f32;
        let direction = |v: [f32; 4]| {
            // Background samples pull the mean towards zero; its direction is that of the surface.
            Vec3::new(v[0], v[1], v[2]).normalize_or_zero().to_array()
        };
        for y in 0..height as usize {
            let row = (top as usize - origin[1] as usize + y) * image.size[0] as usize + (left - origin[0]) as usize;
            for x in 0..width as usize {
                let (from, to) = (y * width as usize + x, row + x);
                image.combined[to] = color[from].map(|c| c * scale);
                image.depth[to] = normal[from][3];
                image.normal[to] = direction(normal[from]);
                image.tangent[to] = direction(tangent[from]);
                let draw = (tangent[from][3] as usize).checked_sub(1);
                let object = draw.map(|draw| self.labels(draw));
                image.object_id[to] = object.map_or(0, |(id, _)| id);
                for (aov, values) in &mut image.aovs {
                    let matte = |ids: &[f32]| {
                        let found = planes.matte(from).map(|(draw, count)| (ids[draw as usize - 1], count));
                        cryptomatte::ranks(found, samples)
                    };
                    let mean = |plane: u32| planes.values::<3>(plane, from).map(|sum| sum * scale);
                    let value = &mut values[aov.channels() * to..][..aov.channels()];
                    match aov {
                        Aov::Position if object.is_some() => {
                            let render = planes.values::<3>(planes.planes.position, from);
                            let world = self.first_view.origin + Vec3::from(render).as_dvec3();
                            value.copy_from_slice(&world.as_vec3().to_array());
                        }
                        Aov::Position => {}
                        Aov::Uv => value.copy_from_slice(&planes.values::<2>(planes.planes.uv, from)),
                        Aov::Vector => value.copy_from_slice(&self.vector(&planes, from, draw)),
                        Aov::ObjectIndex => value[0] = object.map_or(0.0, |(_, labels)| labels.index as f32),
                        Aov::MaterialIndex => value[0] = object.map_or(0.0, |(_, labels)| labels.material_index as f32),
                        Aov::CryptoObject => value.copy_from_slice(&matte(&ids[0])),
                        Aov::CryptoMaterial => value.copy_from_slice(&matte(&ids[1])),
                        Aov::Shadow => value[0] = planes.values::<1>(planes.planes.shadow, from)[0] * scale,
                        Aov::Diffuse => value.copy_from_slice(&mean(planes.planes.diffuse)),
                        Aov::Specular => value.copy_from_slice(&mean(planes.planes.specular)),
                        Aov::Transmission => value.copy_from_slice(&mean(planes.planes.transmission)),
                        Aov::Scattered => value.copy_from_slice(&mean(planes.planes.scattered)),
                        Aov::Ambient => value.copy_from_slice(&mean(planes.planes.ambient)),
                        Aov::Albedo => value.copy_from_slice(&mean(planes.planes.albedo)),
                        Aov::DenoisingNormal => {
                            let [x, y, z, _] = normal[from];
                            value.copy_from_slice(&[x, y, z].map(|c| c * scale));
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
