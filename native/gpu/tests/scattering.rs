//! Every fiber model in WGSL (`shaders/scattering`) against its twin in f64: evaluation, density, albedo and samples, query by query.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3, Vec4};
use lisle_core::sampling::{hash_combine, unit_from_hash};
use lisle_core::scattering::{
    FiberScattering, MATERIAL_NAMES, Material, Thread, ThreadTables, fabric_threads, highlight_scale, von_mises_scale,
};

/// The files under test, a pass that answers queries, and π.
const SHADER: &str = concat!(
    include_str!("../../../shaders/layout/scene.wgsl"),
    include_str!("../../../shaders/math/pack.wgsl"),
    include_str!("../../../shaders/scattering/frame.wgsl"),
    include_str!("../../../shaders/scattering/angles.wgsl"),
    include_str!("../../../shaders/scattering/longitudinal.wgsl"),
    include_str!("../../../shaders/scattering/longitudinal_integral.wgsl"),
    include_str!("../../../shaders/scattering/azimuthal.wgsl"),
    include_str!("../../../shaders/scattering/simple.wgsl"),
    include_str!("../../../shaders/scattering/physical.wgsl"),
    include_str!("../../../shaders/scattering/thread.wgsl"),
    include_str!("../../../shaders/scattering/lobe.wgsl"),
    include_str!("../../../shaders/scattering/simple_sampling.wgsl"),
    include_str!("../../../shaders/scattering/physical_sampling.wgsl"),
    include_str!("../../../shaders/scattering/thread_sampling.wgsl"),
    include_str!("support/scattering.wgsl"),
);

/// `Material` of shaders/layout/scene.wgsl, `Thread` of shaders/scattering/thread.wgsl, and the model.
#[repr(C)]
#[derive(Clone, Copy, Default, Pod, Zeroable)]
struct Parameters {
    color_r: [f32; 3],
    beta_r: f32,
    color_tt: [f32; 3],
    beta_tt: f32,
    diffuse: [f32; 3],
    diffuse_weight: f32,
    specular: [f32; 3],
    specular_beta: f32,
    gamma_tt: f32,
    azimuthal_tt: f32,
    highlight_scale: f32,
    padding: [u32; 5],
    thread_color: [f32; 3],
    refraction: f32,
    isotropic: f32,
    surface_width: f32,
    volume_width: f32,
    padding_2: u32,
    model: u32,
    table_size: u32,
    padding_3: [u32; 2],
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Query {
    wo: Vec4,
    wi: Vec4,
    u: Vec4,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Answer {
    /// f, and the density of `wi`.
    value: Vec4,
    albedo: Vec4,
    /// Direction and its density.
    sample: Vec4,
    /// f at the sample.
    sample_value: Vec4,
}

struct Case {
    name: String,
    fiber: FiberScattering,
    parameters: Parameters,
    /// Limit, surface and volume of a thread, one after the other.
    tables: Vec<f32>,
}

fn round(x: f64) -> f64 {
    f64::from(x as f32)
}

fn round_color(color: DVec3) -> DVec3 {
    color.as_vec3().as_dvec3()
}

fn material_cases(name: &str, material: Material) -> [Case; 2] {
    // Both sides get the same numbers.
    let m = Material {
        color_r: round_color(material.color_r),
        color_tt: round_color(material.color_tt),
        beta_r_rad: round(material.beta_r_rad),
        beta_tt_rad: round(material.beta_tt_rad),
        gamma_tt_rad: round(material.gamma_tt_rad),
        diffuse: round_color(material.diffuse),
        diffuse_weight: round(material.diffuse_weight),
        specular: round_color(material.specular),
        specular_beta_rad: round(material.specular_beta_rad),
    };
    let parameters = |model| Parameters {
        color_r: m.color_r.as_vec3().into(),
        beta_r: m.beta_r_rad as f32,
        color_tt: m.color_tt.as_vec3().into(),
        beta_tt: m.beta_tt_rad as f32,
        diffuse: m.diffuse.as_vec3().into(),
        diffuse_weight: m.diffuse_weight as f32,
        specular: m.specular.as_vec3().into(),
        specular_beta: m.specular_beta_rad as f32,
        gamma_tt: m.gamma_tt_rad as f32,
        azimuthal_tt: von_mises_scale(m.gamma_tt_rad) as f32,
        highlight_scale: highlight_scale(m.specular_beta_rad) as f32,
        model,
        ..Parameters::default()
    };
    let case = |model: u32, label: &str, fiber| Case {
        name: format!("{label} {name}"),
        fiber,
        parameters: parameters(model),
        tables: vec![0.0; 3],
    };
    [case(0, "simple", FiberScattering::simple(m)), case(1, "physical", FiberScattering::physical(m))]
}

fn thread_case(name: &str, thread: Thread) -> Case {
    let t = Thread {
        refraction: round(thread.refraction),
        color: round_color(thread.color),
        isotropic: round(thread.isotropic),
        surface_width_rad: round(thread.surface_width_rad),
        volume_width_rad: round(thread.volume_width_rad),
    };
    let tables = ThreadTables::new(&t);
    let parameters = Parameters {
        thread_color: t.color.as_vec3().into(),
        refraction: t.refraction as f32,
        isotropic: t.isotropic as f32,
        surface_width: t.surface_width_rad as f32,
        volume_width: t.volume_width_rad as f32,
        model: 2,
        table_size: tables.limit.len() as u32,
        ..Parameters::default()
    };
    let values = tables.limit.iter().chain(&tables.surface).chain(&tables.volume);
    Case {
        name: format!("thread {name}"),
        fiber: FiberScattering::thread(t),
        parameters,
        tables: values.map(|v| *v as f32).collect(),
    }
}

fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> =
        MATERIAL_NAMES.iter().flat_map(|name| material_cases(name, Material::preset(name).expect("preset"))).collect();
    cases.extend(fabric_threads().into_iter().map(|(name, thread)| thread_case(&name, thread)));
    cases
}

const QUERIES: u32 = 4096;

/// Directions from all sides, a quarter of the viewers grazing along the fiber; light half by the sampler, half from anywhere.
fn queries(fiber: &FiberScattering) -> Vec<Query> {
    let unit = |k: u32, j: u32| unit_from_hash(hash_combine(hash_combine(3, k), j));
    let anywhere = |z: f64, phi: f64| {
        let phi = std::f64::consts::TAU * phi;
        DVec3::new((1.0 - z * z).sqrt() * phi.cos(), (1.0 - z * z).sqrt() * phi.sin(), z)
    };
    let query = |k: u32| {
        let mut z = 2.0 * unit(k, 0) - 1.0;
        if k % 4 == 1 {
            z = (0.25 * z + 0.7499).clamp(0.5, 0.9998);
        }
        let wo = anywhere(z, unit(k, 1));
        let drawn = fiber.sample(wo, [unit(k, 2), unit(k, 3), unit(k, 4)]).map(|sample| sample.wi);
        let wi = drawn.filter(|_| k.is_multiple_of(2)).unwrap_or_else(|| anywhere(2.0 * unit(k, 2) - 1.0, unit(k, 3)));
        let u = Vec3::new(unit(k, 5) as f32, unit(k, 6) as f32, unit(k, 7) as f32);
        Query { wo: wo.as_vec3().extend(0.0), wi: wi.as_vec3().extend(0.0), u: u.extend(0.0) }
    };
    (0..QUERIES).map(query).collect()
}

/// A device of the best adapter, software if need be, and the compiled shader.
struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipeline: wgpu::ComputePipeline,
}

impl Gpu {
    fn new(source: &str) -> Self {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        let rank = |adapter: &wgpu::Adapter| adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let adapter = adapters.into_iter().min_by_key(rank).expect("an adapter");
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).expect("a device");
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("scattering"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("scattering"),
            layout: None,
            module: &module,
            entry_point: Some("answer_queries"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Self { device, queue, pipeline }
    }

    fn buffer(&self, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes.len() as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    fn answer(&self, parameters: &Parameters, tables: &[f32], queries: &[Query]) -> Vec<Answer> {
        use wgpu::BufferUsages as Usage;
        let size = (queries.len() * size_of::<Answer>()) as u64;
        let buffers = [
            self.buffer(bytemuck::bytes_of(parameters), Usage::UNIFORM),
            self.buffer(bytemuck::cast_slice(tables), Usage::STORAGE),
            self.buffer(bytemuck::cast_slice(queries), Usage::STORAGE),
            self.buffer(&vec![0; size as usize], Usage::STORAGE | Usage::COPY_SRC),
        ];
        let entries: Vec<_> = buffers
            .iter()
            .zip(0..)
            .map(|(buffer, binding)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        let download = self.buffer(&vec![0; size as usize], Usage::MAP_READ);
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(QUERIES.div_ceil(64), 1, 1);
        }
        encoder.copy_buffer_to_buffer(&buffers[3], 0, &download, 0, size);
        self.queue.submit([encoder.finish()]);
        download.slice(..).map_async(wgpu::MapMode::Read, |result| result.expect("mapped"));
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
        let mapped = download.slice(..).get_mapped_range().expect("mapped");
        bytemuck::cast_slice(&mapped).to_vec()
    }
}

/// Differences between the answers and f64: each the greatest over all queries.
#[derive(Debug, Default)]
struct Errors {
    /// Of f, of densities: relative to a value plus 1e-4 of the greatest.
    value: f64,
    density: f64,
    /// Absolute.
    albedo: f64,
    /// Of f and the density at the GPU's own samples.
    sample_value: f64,
    sample_density: f64,
    /// Share of samples that the same numbers take elsewhere: rounding may choose another lobe.
    samples_elsewhere: f64,
}

impl Errors {
    fn worst(&self, other: &Self) -> Self {
        Self {
            value: self.value.max(other.value),
            density: self.density.max(other.density),
            albedo: self.albedo.max(other.albedo),
            sample_value: self.sample_value.max(other.sample_value),
            sample_density: self.sample_density.max(other.sample_density),
            samples_elsewhere: self.samples_elsewhere.max(other.samples_elsewhere),
        }
    }

    fn hold(&self) -> bool {
        self.value < 2e-3
            && self.density < 2e-3
            && self.albedo < 2e-4
            && self.sample_value < 2e-3
            && self.sample_density < 2e-3
            && self.samples_elsewhere < 2e-3
    }
}

fn compare(fiber: &FiberScattering, queries: &[Query], answers: &[Answer]) -> Errors {
    let direction = |v: Vec4| v.truncate().as_dvec3();
    let mut errors = Errors::default();
    let exact: Vec<_> = queries
        .iter()
        .zip(answers)
        .map(|(q, a)| {
            let (wo, wi, drawn) = (direction(q.wo), direction(q.wi), direction(a.sample));
            let at = |wi: DVec3| (fiber.evaluate(wo, wi), fiber.pdf(wo, wi));
            (at(wi), at(drawn))
        })
        .collect();
    let value_floor = 1e-4 * exact.iter().map(|((value, _), _)| value.max_element()).fold(0.0_f64, f64::max);
    let density_floor = 1e-4 * exact.iter().map(|((_, pdf), _)| *pdf).fold(0.0_f64, f64::max);
    // Not a number, which compares with nothing, counts as infinite.
    let relative = |a: f64, b: f64, floor: f64| {
        let error = (a - b).abs() / (b.abs() + floor);
        if error.is_finite() { error } else { f64::INFINITY }
    };
    let color =
        |a: Vec4, b: DVec3| (0..3).map(|c| relative(f64::from(a[c]), b[c], value_floor)).fold(0.0_f64, f64::max);
    let mut elsewhere = 0;
    for ((q, a), ((value, pdf), (drawn_value, drawn_pdf))) in queries.iter().zip(answers).zip(&exact) {
        let (wo, wi) = (direction(q.wo), direction(q.wi));
        errors.value = errors.value.max(color(a.value, *value));
        errors.density = errors.density.max(relative(f64::from(a.value.w), *pdf, density_floor));
        let albedo = (direction(a.albedo) - fiber.albedo(wi)).abs().max_element();
        errors.albedo = errors.albedo.max(if albedo.is_finite() { albedo } else { f64::INFINITY });
        errors.sample_value = errors.sample_value.max(color(a.sample_value, *drawn_value));
        errors.sample_density = errors.sample_density.max(relative(f64::from(a.sample.w), *drawn_pdf, density_floor));
        let drawn = fiber.sample(wo, direction(q.u).to_array()).expect("a fiber that scatters");
        elsewhere += usize::from(drawn.wi.distance(direction(a.sample)) >= 2e-3);
    }
    errors.samples_elsewhere = elsewhere as f64 / queries.len() as f64;
    errors
}

#[test]
fn every_model_is_the_same_on_the_gpu() {
    let gpu = Gpu::new(SHADER);
    let mut worst = Errors::default();
    let mut wrong = Vec::new();
    for case in cases() {
        let queries = queries(&case.fiber);
        let answers = gpu.answer(&case.parameters, &case.tables, &queries);
        let errors = compare(&case.fiber, &queries, &answers);
        if !errors.hold() {
            wrong.push(format!("{}: {errors:.5?}", case.name));
        }
        worst = worst.worst(&errors);
    }
    println!("{worst:.5?}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_wrong_shader_is_noticed() {
    let changes = [
        ("4.0 * shape", "3.9 * shape"),
        ("let x = cone_offset / beta;", "let x = 1.01 * cone_offset / beta;"),
        ("const LOGISTIC_SCALE: f32 = 0.65;", "const LOGISTIC_SCALE: f32 = 0.66;"),
        ("2.0 * refraction * cos_i * cos_t", "1.98 * refraction * cos_i * cos_t"),
        ("theta - material.beta_tt", "theta + material.beta_tt"),
        ("-across.y, across.x", "across.y, across.x"),
    ];
    let [silk, physical] = material_cases("silk-1", Material::preset("silk-1").expect("preset"));
    let thread = thread_case("linen", fabric_threads()[0].1);
    for (right, wrong) in changes {
        assert!(SHADER.contains(right), "{right}");
        let gpu = Gpu::new(&SHADER.replace(right, wrong));
        let noticed = [&silk, &physical, &thread].into_iter().any(|case| {
            let queries = queries(&case.fiber);
            !compare(&case.fiber, &queries, &gpu.answer(&case.parameters, &case.tables, &queries)).hold()
        });
        assert!(noticed, "{wrong}");
    }
}
