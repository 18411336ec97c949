//! The benchmark: every yarn file at hand and a garment of 2 M control points, close, worst and full view, all shading models; ten million
//! fiber segments; the tables of multiple scattering; one frame of an animation. It prints Markdown, with the targets beside the figures, and never fails on timing.

mod animation;
mod cases;
mod measure;
mod models;
mod multiple;
mod options;
mod raster;
mod scene;
mod table;
mod targets;
mod views;

use std::error::Error;
use std::process::ExitCode;

use lisle_gpu::Renderer;
use options::{Options, Request};

fn main() -> ExitCode {
    let request = match options::parse(lexopt::Parser::from_env()) {
        Ok(request) => request,
        Err(error) => {
            eprintln!("lisle-bench: {error}\n\n{}", options::USAGE);
            return ExitCode::from(2);
        }
    };
    match request {
        Request::Help => println!("{}", options::USAGE),
        Request::Run(options) => {
            if let Err(error) = run(&options) {
                eprintln!("lisle-bench: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}

fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    let renderer = Renderer::new(options.adapter.as_deref())?;
    print_machine(&renderer, options);
    let mut findings = Vec::new();
    let mut animated = None;
    let mut rows = Vec::new();
    let models = models::list(options.quick)?;
    for model in models.iter().filter(|model| options.wants(model.name())) {
        eprintln!("{}", model.name());
        let yarns = model.load()?;
        rows.extend(cases::measure_views(&renderer, options, model.name(), &yarns, &mut findings)?);
        if model.is_garment() {
            animated = Some(yarns);
        }
    }
    if !rows.is_empty() {
        println!("## Views\n\n{}", cases::table(&rows));
    }
    if options.wants(raster::NAME) {
        eprintln!("{}", raster::NAME);
        println!("## {}\n\n{}", raster::TITLE, raster::measure(&renderer, options, &mut findings)?);
    }
    if options.wants(multiple::NAME) {
        eprintln!("{}", multiple::NAME);
        println!("## {}\n\n{}", multiple::TITLE, multiple::measure(options, &mut findings));
    }
    if let Some(yarns) = &animated {
        eprintln!("{}", animation::NAME);
        println!("## {}\n\n{}", animation::TITLE, animation::measure(&renderer, options, yarns)?);
    }
    println!("## Targets\n\n{}", targets::table(&findings));
    Ok(())
}

fn print_machine(renderer: &Renderer, options: &Options) {
    let adapter = renderer.adapter();
    let cores = std::thread::available_parallelism().map_or_else(|_| "unknown".into(), |n| n.to_string());
    println!("- Adapter: {} ({}; {}, {})", adapter.name, adapter.driver, adapter.backend, adapter.device_type);
    println!(
        "- Visibility: {}",
        if adapter.wide_atomics { "one pass of 64-bit atomics" } else { "two passes of 32 bits" }
    );
    println!("- CPU cores: {cores}; load average over a minute at the start: {}", table::tenths(measure::load()));
    println!("- Samples per figure, after a picture to warm up: {}\n", options.samples);
}
