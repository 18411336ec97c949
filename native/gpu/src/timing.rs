//! GPU time per pass, where the adapter has timestamps.

use crate::Error;
use crate::device::Gpu;

/// Most passes between two collections.
const MOST_PASSES: u32 = 32;

pub(crate) struct Timer {
    queries: Option<Queries>,
    /// Labels of the passes since the last collection, and how many of them are resolved.
    pending: Vec<&'static str>,
    resolved: u32,
    totals: Vec<(String, f64)>,
}

struct Queries {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
    milliseconds_per_tick: f64,
}

impl Timer {
    pub fn new(gpu: &Gpu) -> Self {
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: u64::from(MOST_PASSES) * 16,
                usage,
                mapped_at_creation: false,
            })
        };
        let queries = gpu.timestamps.then(|| Queries {
            set: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * MOST_PASSES,
            }),
            resolved: buffer("timestamps", wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            staging: buffer("timestamps read-back", wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
            milliseconds_per_tick: f64::from(gpu.queue.get_timestamp_period()) * 1e-6,
        });
        Self { queries, pending: Vec::new(), resolved: 0, totals: Vec::new() }
    }

    /// Timestamps for the next pass.
    pub fn begin(&mut self, label: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let queries = self.queries.as_ref()?;
        let index = self.pending.len() as u32;
        if index == MOST_PASSES {
            return None;
        }
        self.pending.push(label);
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &queries.set,
            beginning_of_pass_write_index: Some(2 * index),
            end_of_pass_write_index: Some(2 * index + 1),
        })
    }

    /// Copies what was measured in this encoder.
    pub fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let Some(queries) = &self.queries else { return };
        let range = 2 * self.resolved..2 * self.pending.len() as u32;
        if range.is_empty() {
            return;
        }
        // Resolved from the start of the buffer: offsets into it must be multiples of 256 bytes.
        encoder.resolve_query_set(&queries.set, range.clone(), &queries.resolved, 0);
        let (at, bytes) = (8 * u64::from(range.start), 8 * u64::from(range.end - range.start));
        encoder.copy_buffer_to_buffer(&queries.resolved, 0, &queries.staging, at, bytes);
        self.resolved = range.end / 2;
    }

    /// Adds up what was measured since the last time. All work must be done.
    pub fn collect(&mut self, gpu: &Gpu) -> Result<(), Error> {
        let Some(queries) = &self.queries else { return Ok(()) };
        if self.resolved == 0 {
            return Ok(());
        }
        let slice = queries.staging.slice(..16 * u64::from(self.resolved));
        slice.map_async(wgpu::MapMode::Read, |_| {});
        gpu.finish()?;
        let ticks: Vec<u64> = {
            let data = slice.get_mapped_range().map_err(|error| gpu.error(error.to_string()))?;
            bytemuck::pod_collect_to_vec(&data)
        };
        queries.staging.unmap();
        for (label, span) in self.pending.drain(..).zip(ticks.chunks_exact(2)) {
            let milliseconds = span[1].saturating_sub(span[0]) as f64 * queries.milliseconds_per_tick;
            match self.totals.iter_mut().find(|(known, _)| known == label) {
                Some((_, total)) => *total += milliseconds,
                None => self.totals.push((label.to_owned(), milliseconds)),
            }
        }
        self.resolved = 0;
        Ok(())
    }

    pub fn totals(&self) -> Vec<(String, f64)> {
        self.totals.clone()
    }
}
