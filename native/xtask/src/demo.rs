//! A knitted animation, through Blender, from nothing.

use std::time::Instant;

use crate::blender::{Host, Modules, on_path};
use crate::failure::Failure;
use crate::python::{Environment, any};
use crate::shell::{digest, folder, root, say, target, tee};
use crate::{extension, vulkan, wheel};

const SCRIPT: &str = "examples/05_blender_knit_animation.py";

/// Sets everything up, then renders to `out/demo/`.
pub fn run() -> Result<(), Failure> {
    let start = Instant::now();
    let wheel = wheel::native()?;
    let plain = Environment::new("lisle", &any()?, &["numpy>=1.26"])?;
    plain.install(&wheel)?;
    let adapters = vulkan::ensure(&plain)?;

    // Its tool packs the extension, whichever Blender then runs it.
    let modules = Modules::newest()?;
    let content = digest(&wheel)?;
    let archive = extension::build(&wheel, &modules)?;
    let settings = target().join("demo/blender");
    let host = match on_path() {
        Some(version) => Host::program(&version, settings),
        None => Host::module(modules, settings),
    };
    host.install(&archive, &format!("{content} {}", digest(&archive)?))?;

    let out = root().join("out/demo");
    folder(&out)?;
    say(&format!("Rendering {SCRIPT} with {} on {adapters}", host.name));
    let rendering = Instant::now();
    let (succeeded, lines) = tee("rendering", host.script(&root().join(SCRIPT)).arg(&out))?;
    // Blender's own line for every picture on disk.
    let frames = lines.iter().filter(|line| line.contains("Saved: '")).count();
    if !succeeded || frames == 0 {
        return Err(Failure::new("rendering", lines.last().map_or("it said nothing", String::as_str)));
    }
    let seconds = rendering.elapsed().as_secs_f64() / frames as f64;
    println!("\n{frames} frames, {seconds:.2} s each, on {adapters}: {}", out.display());
    println!("in {:.0} s, set-up included", start.elapsed().as_secs_f64());
    Ok(())
}
