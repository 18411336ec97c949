//! Time, of the wall and of the processor: on a busy machine, the wall's alone lies.

use std::ops::ControlFlow;
use std::time::Instant;

use lisle_gpu::{Error, Progress, Renderer, Scene, Settings, Statistics};

/// A picture's cost. Times are per sample.
pub struct Measurement {
    /// The whole call over its samples, seconds.
    pub wall_s: f64,
    /// The sample that took least, seconds: what a busy machine spoils least.
    pub fastest_s: f64,
    /// Processor time of this process, seconds; `None` where the system does not tell.
    pub cpu_s: Option<f64>,
    /// GPU time by pass, milliseconds; empty if the adapter has no timestamps.
    pub passes_ms: Vec<(String, f64)>,
    /// How busy the machine was otherwise.
    pub noise: Noise,
    pub statistics: Statistics,
}

/// What else kept the machine busy; `None` where the system does not tell.
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    /// Load average over a minute before the picture, this process included.
    pub load: Option<f64>,
    /// Cores taken by others during the picture.
    pub others: Option<f64>,
}

/// A clock for the wall and for the processor, of this process and of the machine.
pub struct Stopwatch {
    wall: Instant,
    cpu_s: Option<f64>,
    machine_s: Option<f64>,
    load: Option<f64>,
}

impl Stopwatch {
    pub fn start() -> Self {
        let (load, machine_s, cpu_s) = (load(), machine_seconds(), cpu_seconds());
        Self { wall: Instant::now(), cpu_s, machine_s, load }
    }

    /// Seconds of the wall and of this process since the start, and what else there was.
    pub fn stop(&self) -> (f64, Option<f64>, Noise) {
        let wall_s = self.wall.elapsed().as_secs_f64();
        let since = |now: Option<f64>, then: Option<f64>| now.zip(then).map(|(now, then)| now - then);
        let cpu_s = since(cpu_seconds(), self.cpu_s);
        let others_s = since(since(machine_seconds(), self.machine_s), cpu_s);
        // The machine's clock ticks in hundredths: less than nothing is nothing.
        (wall_s, cpu_s, Noise { load: self.load, others: others_s.map(|s| (s / wall_s).max(0.0)) })
    }
}

/// Draws one sample to warm up, then a picture, and measures that.
pub fn picture(renderer: &Renderer, scene: &Scene, settings: &Settings) -> Result<Measurement, Error> {
    draw_once(renderer, scene, settings)?;
    let mut stamps = Vec::with_capacity(settings.samples as usize + 1);
    let watch = Stopwatch::start();
    stamps.push(Instant::now());
    let image = renderer.render(scene, settings, &mut |progress| {
        // It is asked meanwhile, too.
        if matches!(progress, Progress::Samples { done, .. } if done as usize == stamps.len()) {
            stamps.push(Instant::now());
        }
        ControlFlow::Continue(())
    })?;
    let (wall_s, cpu_s, noise) = watch.stop();
    let samples = f64::from(settings.samples);
    let fastest_s = stamps.windows(2).map(|pair| (pair[1] - pair[0]).as_secs_f64()).fold(f64::INFINITY, f64::min);
    Ok(Measurement {
        wall_s: wall_s / samples,
        fastest_s,
        cpu_s: cpu_s.map(|cpu| cpu / samples),
        passes_ms: image.statistics.passes.iter().map(|(name, ms)| (name.clone(), ms / samples)).collect(),
        noise,
        statistics: image.statistics,
    })
}

/// A picture of one sample, for what it leaves behind or tells.
pub fn draw_once(renderer: &Renderer, scene: &Scene, settings: &Settings) -> Result<Statistics, Error> {
    let settings = Settings { samples: 1, ..settings.clone() };
    Ok(renderer.render(scene, &settings, &mut |_| ControlFlow::Continue(()))?.statistics)
}

/// Processor time of all threads of this process so far, seconds.
#[cfg(unix)]
fn cpu_seconds() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

/// Not told by this system.
#[cfg(not(unix))]
fn cpu_seconds() -> Option<f64> {
    None
}

/// Processor time of the whole machine so far, stolen time included, seconds.
#[cfg(target_os = "linux")]
fn machine_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/stat").ok()?;
    busy_ticks(text.lines().next()?).map(|ticks| ticks as f64 / rustix::param::clock_ticks_per_second() as f64)
}

/// Not told by this system.
#[cfg(not(target_os = "linux"))]
fn machine_seconds() -> Option<f64> {
    None
}

/// Ticks that are not idle, of a line `cpu user nice system idle iowait irq softirq steal …`.
#[cfg(target_os = "linux")]
fn busy_ticks(line: &str) -> Option<u64> {
    let ticks: Vec<u64> = line.strip_prefix("cpu")?.split_whitespace().map_while(|word| word.parse().ok()).collect();
    (ticks.len() >= 8).then(|| ticks[..3].iter().chain(&ticks[5..8]).sum())
}

/// Load average over the last minute, where the system tells it.
pub fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn busy_time_leaves_out_idling_and_waiting() {
        assert_eq!(busy_ticks("cpu  1 20 300 4000 50000 6 70 800 9 9"), Some(1 + 20 + 300 + 6 + 70 + 800));
        assert_eq!(busy_ticks("intr 1 2 3 4 5 6 7 8 9"), None);
        assert_eq!(busy_ticks("cpu  1 2 3"), None);
    }

    #[test]
    fn processor_time_runs_on_with_work_and_not_faster_than_all_cores_together() {
        let (start, begin) = (Instant::now(), cpu_seconds());
        // Until the processor has worked for a while, however little of it this process gets.
        while cpu_seconds().zip(begin).is_some_and(|(now, begin)| now - begin < 0.05) {}
        let cores = std::thread::available_parallelism().expect("a number of cores").get() as f64;
        let spent = cpu_seconds().zip(begin).map_or(f64::NAN, |(now, begin)| now - begin);
        let wall = start.elapsed().as_secs_f64();
        assert!((0.05..cores * wall + 0.01).contains(&spent), "{spent} s in {wall} s");
    }
}
