//! The scene's yarns on the GPU: what is static stays there from frame to frame.

use std::collections::HashMap;
use std::sync::Arc;

use bytemuck::Pod;
use glam::{DMat4, DVec3, Vec4};
use lisle_core::sampling::hash_combine;
use lisle_core::strands::Yarns;
use lisle_core::yarn::Yarn;

use crate::device::Gpu;
use crate::knots::{MovingKnots, RestKnots};
use crate::layout;
use crate::scene_tables::{Kinds, SceneTables};
use crate::tables::{SceneTransport, TableCache, bound};
use crate::view::Bounds;
use crate::word_texture::WordTexture;
use crate::{Error, Object, Scene};

/// A set of curves with one kind of yarn, as uploaded; instances share it.
struct Upload {
    yarns: Arc<Yarns>,
    yarn: Arc<Yarn>,
    knots: RestKnots,
    first_knot: u32,
    segment_count: u64,
}

/// Where a set of curves is.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    /// What positions are relative to, object space.
    center: DVec3,
    /// Relative to that.
    bounds: Bounds,
    slenderness: f64,
}

impl Place {
    fn of(moving: &MovingKnots) -> Self {
        Self { center: moving.center, bounds: moving.bounds, slenderness: moving.slenderness }
    }

    /// On the way to another: a box that holds all, and no less slender.
    pub fn between(&self, other: &Self, share: f64) -> Self {
        let (a, b) = (&self.bounds, &other.bounds);
        Self {
            center: self.center.lerp(other.center, share),
            bounds: Bounds { min: a.min.lerp(b.min, share), max: a.max.lerp(b.max, share) },
            slenderness: self.slenderness.max(other.slenderness),
        }
    }
}

/// Positions and normals of all curves at one time.
pub(crate) struct Shape {
    pub knots: WordTexture<[u32; 4]>,
    /// Of each set of curves.
    pub places: Vec<Place>,
}

/// Whether two shapes are frames of the same rest shape.
pub(crate) fn same_rest(a: &Yarns, b: &Yarns) -> bool {
    std::ptr::eq(a.strands().lengths(), b.strands().lengths()) && std::ptr::eq(a.strands().radii(), b.strands().radii())
}

/// Buffers of the yarns, and what they hold.
pub(crate) struct SceneBuffers {
    uploads: Vec<Upload>,
    pub tables: SceneTables,
    pub shape: Shape,
    /// Whether the shape is none that was uploaded, but one between two.
    pub displaced: bool,
    pub rest_knots: WordTexture<[u32; 2]>,
    pub knot_curves: WordTexture<u32>,
    pub curves: wgpu::Buffer,
    pub uploaded_bytes: u64,
    /// How often knots of these buffers have moved.
    pub revision: u64,
}

/// The instances to draw.
pub(crate) struct Draws {
    pub items: Vec<layout::Draw>,
    /// Padded knots, each of which may begin a segment; the shaders number segments by them.
    pub segment_count: u32,
    /// Segments that there are.
    pub real_segments: u64,
    /// Render space, with the yarns' thickness and flyaways.
    pub bounds: Bounds,
    /// Most slots (fibers and cores) of any yarn.
    pub most_slots: u32,
    /// Largest yarn radius, render space, and longest segment in radii.
    pub radius_max: f64,
    pub slenderness: f64,
}

/// A storage buffer that holds `data`, or a little if that is empty.
pub(crate) fn storage<T: Pod>(gpu: &Gpu, label: &str, data: &[T]) -> Result<wgpu::Buffer, Error> {
    let buffer = empty_storage(gpu, label, size_of_val(data) as u64)?;
    gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(data));
    Ok(buffer)
}

/// A storage buffer of at least that size.
pub(crate) fn empty_storage(gpu: &Gpu, label: &str, bytes: u64) -> Result<wgpu::Buffer, Error> {
    check_storage(gpu, label, bytes)?;
    Ok(gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes.max(256).next_multiple_of(16),
        usage: wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::COPY_SRC
            | wgpu::BufferUsages::INDIRECT,
        mapped_at_creation: false,
    }))
}

/// Fails if a buffer cannot hold so much.
pub(crate) fn check_storage(gpu: &Gpu, label: &str, bytes: u64) -> Result<(), Error> {
    let limit = gpu.limits.max_storage_buffer_binding_size.min(gpu.limits.max_buffer_size);
    if bytes > limit {
        return Err(gpu.error(format!("{label} need {} MiB; a buffer holds at most {} MiB", bytes >> 20, limit >> 20)));
    }
    Ok(())
}

/// Index of an equal item, added if there is none.
fn intern<T: PartialEq>(list: &mut Vec<Arc<T>>, item: &Arc<T>) -> usize {
    list.iter().position(|known| Arc::ptr_eq(known, item) || **known == **item).unwrap_or_else(|| {
        list.push(Arc::clone(item));
        list.len() - 1
    })
}

/// Curves and the kind of yarn they are made of.
#[derive(Clone, Copy)]
struct Set<'a> {
    yarns: &'a Arc<Yarns>,
    yarn: &'a Arc<Yarn>,
}

/// What an object is made of, by number: its set of curves, kind of yarn and material; and the offset of its table of multiple scattering.
#[derive(Clone, Copy)]
pub(crate) struct ObjectParts {
    set: usize,
    yarn: u32,
    material: u32,
    transport: u32,
}

/// The distinct sets of a scene, and what each object is made of, yet without tables; `kinds` takes those that there are.
fn distinct<'a>(scene: &'a Scene, kinds: &mut Kinds) -> (Vec<Set<'a>>, Vec<ObjectParts>) {
    let mut sets = Vec::new();
    let mut known = HashMap::<(*const Yarns, usize), usize>::new();
    let parts = scene
        .objects
        .iter()
        .map(|Object { yarns, yarn, material, .. }| {
            let (kind, material) = (intern(&mut kinds.yarns, yarn), intern(&mut kinds.materials, material));
            let set = *known.entry((Arc::as_ptr(yarns), kind)).or_insert_with(|| {
                sets.push(Set { yarns, yarn });
                sets.len() - 1
            });
            ObjectParts { set, yarn: kind as u32, material: material as u32, transport: 0 }
        })
        .collect();
    (sets, parts)
}

impl SceneBuffers {
    /// Brings the GPU up to date with the scene, reusing what `previous` already holds.
    pub fn update(
        gpu: &Gpu,
        previous: Option<Self>,
        scene: &Scene,
        transports: &[SceneTransport],
        table_resolution: u32,
        cache: &mut TableCache,
    ) -> Result<(Self, Vec<ObjectParts>), Error> {
        let mut kinds = Kinds { yarns: Vec::new(), materials: Vec::new(), table_resolution };
        let (sets, mut parts) = distinct(scene, &mut kinds);
        let is_known = |p: &Self| {
            p.uploads.len() == sets.len()
                && p.uploads.iter().zip(&sets).all(|(u, set)| same_rest(&u.yarns, set.yarns) && u.yarn == *set.yarn)
        };
        let (yarns, materials) = (kinds.yarns.len(), kinds.materials.len());
        let mut tables = |kept| SceneTables::update(gpu, kept, kinds.clone(), transports, cache);
        let buffers = match previous {
            Some(mut buffers) if is_known(&buffers) => {
                buffers.uploaded_bytes = 0;
                buffers.move_knots(gpu, &sets);
                Self { tables: tables(Some(buffers.tables))?, ..buffers }
            }
            other => Self::upload(gpu, &sets, tables(other.map(|buffers| buffers.tables))?)?,
        };
        cache.forget(yarns, materials, transports.len());
        for part in &mut parts {
            part.transport = buffers.tables.transport(part.yarn, part.material);
        }
        Ok((buffers, parts))
    }

    fn upload(gpu: &Gpu, sets: &[Set], tables: SceneTables) -> Result<Self, Error> {
        let mut first_knot = 0_u32;
        let (mut rest_knots, mut knot_curves, mut curves) = (Vec::new(), Vec::new(), Vec::new());
        let (mut moving_knots, mut places) = (Vec::new(), Vec::new());
        let mut uploads = Vec::with_capacity(sets.len());
        for Set { yarns, yarn } in sets {
            let mut knots = RestKnots::new(yarns.strands(), yarn);
            let first_curve = curves.len() as u32;
            curves.append(&mut knots.curves);
            rest_knots.append(&mut knots.rest);
            knot_curves.extend(knots.curve.drain(..).map(|curve| curve + first_curve));
            let mut moving = knots.moving(yarns.strands());
            places.push(Place::of(&moving));
            moving_knots.append(&mut moving.knots);
            let length = knots.len() as u32;
            let segment_count = knots.segment_count() as u64;
            uploads.push(Upload { yarns: Arc::clone(yarns), yarn: Arc::clone(yarn), knots, first_knot, segment_count });
            first_knot += length;
        }
        Ok(Self {
            uploads,
            tables,
            shape: Shape { knots: WordTexture::writable(gpu, "control points", &moving_knots)?, places },
            displaced: false,
            rest_knots: WordTexture::new(gpu, "control points (lengths and radii)", &rest_knots)?,
            knot_curves: WordTexture::new(gpu, "control points (curves)", &knot_curves)?,
            curves: storage(gpu, "curves", &curves)?,
            uploaded_bytes: (size_of_val(&moving_knots[..])
                + size_of_val(&rest_knots[..])
                + size_of_val(&knot_curves[..])
                + size_of_val(&curves[..])) as u64,
            revision: 0,
        })
    }

    /// The next frame of known yarns: positions and normals, and only of those that moved.
    fn move_knots(&mut self, gpu: &Gpu, sets: &[Set]) {
        let displaced = std::mem::take(&mut self.displaced);
        for ((upload, place), Set { yarns, .. }) in self.uploads.iter_mut().zip(&mut self.shape.places).zip(sets) {
            let moved =
                displaced || !Arc::ptr_eq(&upload.yarns, yarns) && !std::ptr::eq(upload.yarns.points(), yarns.points());
            upload.yarns = Arc::clone(yarns);
            if moved {
                self.revision += 1;
                let moving = upload.knots.moving(yarns.strands());
                self.shape.knots.write(gpu, upload.first_knot, &moving.knots);
                self.uploaded_bytes += size_of_val(&moving.knots[..]) as u64;
                *place = Place::of(&moving);
            }
        }
    }

    /// The same curves at another time, by a scene whose objects are those of the one that `parts` belong to.
    pub fn shape_of(&self, gpu: &Gpu, scene: &Scene, parts: &[ObjectParts]) -> Result<Shape, Error> {
        let (mut knots, mut places) = (Vec::new(), Vec::new());
        for (set, upload) in self.uploads.iter().enumerate() {
            let of_set =
                || parts.iter().zip(&scene.objects).filter(|(part, _)| part.set == set).map(|(_, object)| object);
            let first = of_set().next().expect("every set is an object's");
            if let Some(other) = of_set().find(|other| !std::ptr::eq(other.yarns.points(), first.yarns.points())) {
                let reason = format!("it shares its yarns with \"{}\" at one time and not at another", first.name);
                return Err(Error::input(format!("object \"{}\"", other.name), reason));
            }
            let mut moving = upload.knots.moving(first.yarns.strands());
            places.push(Place::of(&moving));
            knots.append(&mut moving.knots);
        }
        Ok(Shape { knots: WordTexture::new(gpu, "control points at another time", &knots)?, places })
    }

    /// Padded knots of all sets.
    pub fn knot_count(&self) -> u32 {
        self.uploads.iter().map(|upload| upload.knots.len() as u32).sum()
    }

    pub fn knot_bytes(&self) -> u64 {
        self.shape.knots.bytes() + self.rest_knots.bytes() + self.knot_curves.bytes() + self.curves.size()
    }

    /// The scene's objects as draws of these buffers, with such transforms to the world and places of the sets; `parts` are what
    /// [`Self::update`] gave.
    pub fn draws(
        &self,
        scene: &Scene,
        parts: &[ObjectParts],
        origin: DVec3,
        transforms: &[DMat4],
        places: &[Place],
    ) -> Result<Draws, Error> {
        let mut draws = Draws {
            items: Vec::new(),
            segment_count: 0,
            real_segments: 0,
            bounds: Bounds::EMPTY,
            most_slots: 1,
            radius_max: 0.0,
            slenderness: 0.0,
        };
        for ((object, transform), part) in scene.objects.iter().zip(transforms).zip(parts) {
            let (upload, place) = (&self.uploads[part.set], &places[part.set]);
            let render_from_object =
                DMat4::from_translation(-origin) * *transform * DMat4::from_translation(place.center);
            let determinant = render_from_object.determinant();
            let scale = determinant.abs().cbrt();
            let row = |i: usize| -> Vec4 { render_from_object.row(i).as_vec4() };
            let count = upload.knots.len() as u32;
            let radius_max = upload.knots.radius_max * scale;
            draws.items.push(layout::Draw {
                render_from_object_x: row(0),
                render_from_object_y: row(1),
                render_from_object_z: row(2),
                first_segment: draws.segment_count,
                first_knot: upload.first_knot,
                knot_count: count,
                yarn: part.yarn,
                material: part.material,
                transport: part.transport,
                holdout: u32::from(object.is_holdout),
                seed: hash_combine(0x00b1_ec70, object.id),
                radius_max: radius_max as f32,
                handedness: determinant.signum() as f32,
                ..Default::default()
            });
            draws.segment_count = draws.segment_count.checked_add(count).ok_or_else(|| {
                Error::input("scene", "more than 4.29 billion control points, instances counted each")
            })?;
            draws.real_segments += upload.segment_count;
            draws.radius_max = draws.radius_max.max(radius_max);
            draws.slenderness = draws.slenderness.max(place.slenderness);
            let reach = radius_max * bound(&object.yarn);
            draws.bounds.merge(&place.bounds.transformed(&render_from_object).grown(reach));
            draws.most_slots = draws.most_slots.max(object.yarn.plies * (object.yarn.fibers_per_ply + 1));
        }
        Ok(draws)
    }
}
