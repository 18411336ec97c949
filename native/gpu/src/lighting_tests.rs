//! The tables of yarns and materials as a resolve pass reads them (`shaders/passes/lighting.wgsl`), against their twins in f64, query by query.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, Vec4};
use lisle_core::sampling::{hash_combine, unit_from_hash};
use lisle_core::scattering::{Material, ScatteringTables};
use lisle_core::yarn::{PRESET_NAMES, Yarn};
use lisle_precompute::{SeenFrom, Tables};

use crate::arrays::Arrays;
use crate::device::Gpu;
use crate::layout;
use crate::shader::{Film, Model, Pass, Resolve};
use crate::tables::{TableBuffer, YarnTables};
use crate::word_texture::WordTexture;

/// A pass as it is drawn with, and an entry point that answers queries.
fn source() -> String {
    let resolve = Pass::ResolveFibers(Resolve { film: Film::Plain, model: Model::Physical });
    format!("{}\n{}", resolve.source(Arrays::Storage), include_str!("lighting_tests.wgsl"))
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Query {
    viewer: Vec4,
    light: Vec4,
    place: Vec4,
    tangent: Vec4,
}

/// What is compared, in the order of the shader's answers.
const VALUES: [&str; 12] = [
    "optical depth towards the light",
    "light at the point that is seen",
    "light over the width of the fiber that is seen",
    "sky of the point that is seen, beyond the mean",
    "sky by the table",
    "sky by distance",
    "sky in all",
    "integral for R",
    "integral for TT",
    "ambient R",
    "ambient R, grazing",
    "ambient TT",
];
type Answer = [f32; VALUES.len()];

/// Farthest place: both sides cover it with texels on all sides, so that neither reads beyond its table.
const REACH: f64 = 1.15;
const COUNT: u32 = 4096;
/// Relative, of values by place. Vulkan leaves an arc sine 4096 units in the last place, which finds the place in a material's tables.
const BOUNDS: [f64; 2] = [5e-4, 4e-3];
const BY_PLACE: usize = 7;

/// Places all over the section and outside of it; light from anywhere, a quarter of it near the viewer's direction, where the two rays share their way.
fn queries() -> Vec<Query> {
    let query = |k: u32| {
        let unit = |j: u32| unit_from_hash(hash_combine(hash_combine(7, k), j));
        let turn = |turns: f64| DVec2::from_angle(std::f64::consts::TAU * turns);
        let slanted = |across: DVec2, z: f64| {
            (across * (1.0 - z * z).sqrt()).extend(z).extend(0.0).as_vec4() // Along the yarn by z.
        };
        let viewer_turns = unit(0);
        let light_turns = if k.is_multiple_of(4) { viewer_turns + 0.05 * (unit(1) - 0.5) } else { unit(1) };
        let place = turn(unit(2)) * (REACH * unit(3).sqrt());
        let sin_theta = 1.9998 * (unit(4) - 0.5);
        // A third is not wound.
        let wound = if k.is_multiple_of(3) { 0.0 } else { 1.0 };
        let fiber = turn(unit(7)) * (wound * 0.8 * unit(8));
        Query {
            viewer: slanted(turn(viewer_turns), 1.8 * (unit(5) - 0.5)),
            light: slanted(turn(light_turns), 1.8 * (unit(6) - 0.5)),
            place: place.extend(sin_theta).extend(wound * 2.4 * (unit(9) - 0.5)).as_vec4(),
            tangent: fiber.extend((1.0 - fiber.length_squared()).sqrt()).extend(0.0).as_vec4(),
        }
    };
    (0..COUNT).map(query).collect()
}

fn expected(yarn: &Tables, material: &ScatteringTables, query: &Query) -> [f64; VALUES.len()] {
    let angle = |v: DVec2| v.y.atan2(v.x);
    let q = DVec2::new(f64::from(query.place.x), f64::from(query.place.y));
    let theta = f64::from(query.place.z).asin();
    let across = |v: Vec4, slope: DVec2| v.as_dvec4().truncate().truncate() - slope * f64::from(v.z);
    let tangent = query.tangent.as_dvec4();
    let fiber_slope = DVec2::new(tangent.x, tangent.y) / tangent.z;
    let way = |v: Vec4| {
        let l = across(v, DVec2::ZERO).normalize();
        let to_border = (q.dot(l).powi(2) + 1.0 - q.length_squared()).max(0.0).sqrt() - q.dot(l);
        let at = q + l * (0.25 * to_border).max(0.0);
        angle(across(v, at.perp() * f64::from(query.place.w)))
    };
    let directions = [query.light, query.viewer];
    let from = SeenFrom { ways: directions.map(way), across: directions.map(|v| angle(across(v, fiber_slope))) };
    let [light, view] = from.ways;
    let (table, sky) = (&yarn.self_shadow, &yarn.occlusion);
    let (seen, integrals, ambient) = (table.sky_of_seen(view, q), material.normalizers(theta), material.ambient(theta));
    [
        table.at(light, q),
        (-table.toward_light_of_seen(from, q)).exp(),
        (-table.over_width_of_seen(from, q)).exp(),
        seen,
        sky.at(q),
        sky.at_distance(q),
        (sky.at(q) + seen).min(1.0),
        integrals.integral_r,
        integrals.integral_tt,
        ambient.reflect,
        ambient.reflect_grazing,
        ambient.transmit,
    ]
}

/// An adapter and the shader on it.
struct Bench {
    gpu: Gpu,
    pipeline: wgpu::ComputePipeline,
}

impl Bench {
    fn new(source: &str) -> Self {
        let gpu = Gpu::new(None).expect("an adapter");
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("lighting queries"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("lighting queries"),
            layout: None,
            module: &module,
            entry_point: Some("answer_queries"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        gpu.finish().expect("a valid shader");
        Self { gpu, pipeline }
    }

    fn buffer(&self, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let buffer = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes.len() as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.gpu.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    fn answer(&self, tables: &TableBuffer, queries: &[Query]) -> Vec<Answer> {
        use wgpu::BufferUsages as Usage;
        let size = queries.len() * size_of::<Answer>();
        let storage = |bytes: &[u8]| self.buffer(bytes, Usage::STORAGE);
        let scene = [
            (6, storage(bytemuck::cast_slice::<layout::Yarn, u8>(&tables.yarns))),
            (7, storage(bytemuck::cast_slice(&tables.materials))),
        ];
        let words = WordTexture::new(&self.gpu, "tables", &tables.words.rest).expect("a texture");
        let answers = self.buffer(&vec![0; size], Usage::STORAGE | Usage::COPY_SRC);
        let own = [(0, storage(bytemuck::cast_slice(queries))), (1, answers.clone())];
        let group = |index: u32, buffers: &[(u32, wgpu::Buffer)], texture: Option<wgpu::BindGroupEntry>| {
            let mut entries = Vec::from_iter(texture);
            for (binding, buffer) in buffers {
                entries.push(wgpu::BindGroupEntry { binding: *binding, resource: buffer.as_entire_binding() });
            }
            self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &self.pipeline.get_bind_group_layout(index),
                entries: &entries,
            })
        };
        let table = wgpu::BindGroupEntry { binding: 8, resource: words.binding() };
        let groups = [group(0, &scene, Some(table)), group(1, &own, None)];
        let download = self.buffer(&vec![0; size], Usage::MAP_READ);
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            for (group, index) in groups.iter().zip(0..) {
                pass.set_bind_group(index, group, &[]);
            }
            pass.dispatch_workgroups(COUNT.div_ceil(64), 1, 1);
        }
        encoder.copy_buffer_to_buffer(&answers, 0, &download, 0, size as u64);
        self.gpu.submit(encoder);
        download.slice(..).map_async(wgpu::MapMode::Read, |result| result.expect("mapped"));
        self.gpu.finish().expect("answers");
        let mapped = download.slice(..).get_mapped_range().expect("mapped");
        bytemuck::cast_slice(&mapped).to_vec()
    }
}

struct Case {
    name: String,
    yarn: Tables,
    material: ScatteringTables,
    buffer: TableBuffer,
}

impl Case {
    fn new(yarn_name: &str, material_name: &str) -> Self {
        let yarn = Yarn::preset(yarn_name).expect(yarn_name);
        let material = Material::preset(material_name).expect(material_name);
        let tables = Tables::new(&yarn, 1);
        let mut buffer = TableBuffer::default();
        // Something before it, so that the offsets count.
        buffer.words.rest.resize(37, f32::NAN.to_bits());
        buffer.add_yarn(&YarnTables::new(&yarn, &tables));
        let scattering = ScatteringTables::new(&material);
        buffer.add_material(&material, &scattering);
        let name = format!("{yarn_name}, {material_name}");
        Self { name, yarn: tables, material: scattering, buffer }
    }

    /// Greatest difference of each value, relative to that value plus the hundredth part of one; not a number counts as infinite.
    fn errors(&self, bench: &Bench) -> [f64; VALUES.len()] {
        let queries = queries();
        let mut errors = [0.0_f64; VALUES.len()];
        for (query, answer) in queries.iter().zip(bench.answer(&self.buffer, &queries)) {
            for ((error, e), a) in errors.iter_mut().zip(expected(&self.yarn, &self.material, query)).zip(answer) {
                let found = (f64::from(a) - e).abs() / (e.abs() + 0.01);
                *error = error.max(if found.is_finite() { found } else { f64::INFINITY });
            }
        }
        errors
    }

    /// Values that are not the same within rounding.
    fn apart(&self, bench: &Bench) -> Vec<String> {
        let errors = self.errors(bench);
        println!("{}: {:?}", self.name, errors.map(|error| format!("{error:.1e}")));
        let wrong = VALUES.iter().zip(errors).zip(0..);
        let wrong = wrong.filter(|((_, error), k)| *error > BOUNDS[usize::from(*k >= BY_PLACE)]).map(|(pair, _)| pair);
        wrong.map(|(value, error)| format!("{}: {value}: {error:.2e}", self.name)).collect()
    }
}

#[test]
fn lookups_are_the_same_on_the_gpu() {
    let bench = Bench::new(&source());
    let materials = ["cotton", "silk-1", "polyester-1"];
    let cases = PRESET_NAMES.iter().zip(materials.iter().cycle()).map(|(yarn, material)| Case::new(yarn, material));
    let wrong: Vec<String> = cases.flat_map(|case| case.apart(&bench)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_wrong_lookup_is_noticed() {
    let changes = [
        // One for each value, or for a factor of several.
        ("l.x * q.y - l.y * q.x", "l.x * q.y + l.y * q.x"),
        ("fract(atan2(l.y, l.x) / TAU * f32(yarn.plies))", "fract(-atan2(l.y, l.x) / TAU * f32(yarn.plies))"),
        ("(slice + 1u) % yarn.shadow_slices", "slice"),
        ("0.5 * extinction * yarn.fiber_radius", "0.6 * extinction * yarn.fiber_radius"),
        ("shared_over_width(min(to_width, seen.depth_to_viewer))", "0.67 * min(to_width, seen.depth_to_viewer)"),
        ("to_point, min(to_point, seen.depth_to_viewer)", "to_point, 0.9 * min(to_point, seen.depth_to_viewer)"),
        ("section.winding * vec2f(-at.y, at.x)", "section.winding * vec2f(at.y, -at.x)"),
        ("let quarter_way = 0.25 *", "let quarter_way = 0.3 *"),
        (
            "direction_across(seen.section, seen.slope, direction)",
            "direction_across(seen.section, -seen.slope, direction)",
        ),
        ("0.25 * PI * yarn.fiber_radius * (l.unit - seen.view_across)", "0.25 * PI * yarn.fiber_radius * l.unit"),
        ("sqrt(share.y)", "share.y"),
        ("min(length(section.position), yarn.occlusion_extent)", "min(length(section.position), 1.0)"),
        ("material_table(material, 1u, sin_theta_i)", "material_table(material, 0u, sin_theta_i)"),
        ("material_table(material, 4u, sin_theta_o)", "material_table(material, 3u, sin_theta_o)"),
    ];
    let case = Case::new("cotton-1", "silk-1");
    let right = source();
    for (from, to) in changes {
        assert!(right.contains(from), "{from}");
        assert!(!case.apart(&Bench::new(&right.replace(from, to))).is_empty(), "{to}");
    }
}
