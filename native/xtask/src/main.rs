//! `cargo xtask demo | test | bench | fidelity | thumbnails | package`: everything that one command has to do on a fresh machine.
//!
//! Set-up is done once and remembered with stamps under `target/`; a second run goes straight to the work.

mod bench;
mod blender;
mod debian;
mod demo;
mod extension;
mod failure;
mod fidelity;
mod python;
mod shell;
mod test;
mod thumbnails;
mod vulkan;
mod wheel;

use std::process::ExitCode;

use failure::Failure;

const USAGE: &str = "\
cargo xtask COMMAND

  demo     render the knitted animation of examples/ through Blender to out/demo/
  test     every test: Rust, Python, inside Blender; formatting and lints; the extension's manifest
  bench    the benchmark; further arguments go to it
  fidelity the renderer beside the path tracer: out/fidelity/; further arguments go to it
  thumbnails  the pictures of presets in addon/presets/thumbnails/; names of presets limit it to those
  package  build the Blender extension with its wheel: target/extension/; wheels that other systems built, if
           any are named, get an archive each
";

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let command = arguments.next();
    let rest: Vec<String> = arguments.collect();
    let result = match (command.as_deref(), rest.as_slice()) {
        (Some("demo"), []) => demo::run(),
        (Some("test"), []) => test::run(),
        (Some("bench"), rest) => bench::run(rest),
        (Some("fidelity"), rest) => fidelity::run(rest),
        (Some("thumbnails"), rest) => thumbnails::draw(rest),
        (Some("package"), wheels) => package(wheels),
        (Some("help" | "--help" | "-h"), _) => {
            print!("{USAGE}");
            Ok(())
        }
        _ => {
            eprint!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("\nxtask: {failure}");
            ExitCode::FAILURE
        }
    }
}

/// The extension for other machines: the wheel made here runs on any with this operating system that Blender runs on.
fn package(others: &[String]) -> Result<(), Failure> {
    let blender = blender::Blender::found()?;
    let mut wheels = vec![wheel::portable()?];
    wheels.extend(others.iter().map(std::path::PathBuf::from));
    for archive in extension::build(&wheels, || blender.extension_tool())? {
        println!("{}", archive.display());
    }
    Ok(())
}
