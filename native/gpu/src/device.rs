//! Adapters and the device.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use crate::Error;

/// A graphics adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterInfo {
    /// Name, as the driver gives it.
    pub name: String,
    /// Driver and its version.
    pub driver: String,
    /// Vulkan, Metal or Direct3D 12.
    pub backend: String,
    /// Discrete or integrated GPU, software, …
    pub device_type: String,
    /// Whether the one-pass visibility buffer runs on it.
    pub wide_atomics: bool,
}

pub(crate) struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub info: AdapterInfo,
    pub limits: wgpu::Limits,
    pub timestamps: bool,
    /// First error that the driver or the validation reported outside of a call.
    pub failure: Arc<Mutex<Option<String>>>,
    /// How often work was handed to the adapter.
    pub submissions: Arc<AtomicU64>,
}

const WIDE_ATOMICS: wgpu::Features = wgpu::Features::SHADER_INT64.union(wgpu::Features::SHADER_INT64_ATOMIC_MIN_MAX);

fn describe(adapter: &wgpu::Adapter) -> AdapterInfo {
    let info = adapter.get_info();
    AdapterInfo {
        name: info.name,
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        backend: format!("{:?}", info.backend),
        device_type: format!("{:?}", info.device_type),
        wide_atomics: adapter.features().contains(WIDE_ATOMICS),
    }
}

fn enumerate() -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    // GPUs before software, stable within a kind.
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

/// All adapters that answer, best first.
pub fn adapters() -> Vec<AdapterInfo> {
    enumerate().iter().map(describe).collect()
}

impl Gpu {
    /// Opens the first adapter whose name contains `wanted` (in any case), or the best one.
    pub fn new(wanted: Option<&str>) -> Result<Self, Error> {
        let found = enumerate();
        let names: Vec<String> = found.iter().map(|adapter| adapter.get_info().name).collect();
        let matches = |name: &String| wanted.is_none_or(|w| name.to_lowercase().contains(&w.to_lowercase()));
        let Some(index) = names.iter().position(matches) else {
            return Err(Error::NoAdapter {
                wanted: wanted.map(|w| format!(" named \"{w}\"")).unwrap_or_default(),
                found: if names.is_empty() { "none".into() } else { names.join(", ") },
            });
        };
        let adapter = &found[index];
        let info = describe(adapter);
        let optional = WIDE_ATOMICS | wgpu::Features::TIMESTAMP_QUERY;
        let limits = adapter.limits();
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("lisle"),
            required_features: adapter.features() & optional,
            required_limits: limits.clone(),
            ..Default::default()
        }))
        .map_err(|error| Error::Device { adapter: info.name.clone(), reason: error.to_string() })?;
        let failure = Arc::new(Mutex::new(None));
        let sink = Arc::clone(&failure);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut first) = sink.lock() {
                first.get_or_insert_with(|| error.to_string());
            }
        }));
        Ok(Self {
            timestamps: device.features().contains(wgpu::Features::TIMESTAMP_QUERY),
            device,
            queue,
            info,
            limits,
            failure,
            submissions: Arc::default(),
        })
    }

    pub fn error(&self, reason: impl Into<String>) -> Error {
        Error::Device { adapter: self.info.name.clone(), reason: reason.into() }
    }

    /// Hands work to the adapter.
    pub fn submit(&self, encoder: wgpu::CommandEncoder) {
        self.submissions.fetch_add(1, Ordering::Relaxed);
        self.queue.submit([encoder.finish()]);
    }

    /// Waits for all work, then reports what went wrong in it.
    pub fn finish(&self) -> Result<(), Error> {
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| self.error(error.to_string()))?;
        match self.failure.lock().map(|mut first| first.take()) {
            Ok(None) => Ok(()),
            Ok(Some(reason)) => Err(self.error(reason)),
            Err(_) => Err(self.error("a thread panicked while reporting an error")),
        }
    }
}
