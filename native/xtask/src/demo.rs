//! A knitted animation, through Blender, from nothing.

use std::time::Instant;

use crate::blender::{Host, Modules, on_path};
use crate::failure::Failure;
use crate::python::{Environment, any};
use crate::shell::{digest, folder, root, run as run_command, say, target};
use crate::{extension, vulkan, wheel};

const SCRIPT: &str = "examples/blender_knit_animation.py";

/// Sets everything up, then renders to `out/demo/`.
pub fn run() -> Result<(), Failure> {
    let start = Instant::now();
    let wheel = wheel::native()?;
    let plain = Environment::new("lisle", &any()?, &["numpy>=1.26"])?;
    plain.install(&wheel)?;
    vulkan::ensure(&plain)?;

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
    say(&format!("Rendering {SCRIPT} with {}", host.name));
    run_command("rendering", host.script(&root().join(SCRIPT)).arg("--output").arg(&out))?;
    println!("\nin {:.0} s: {}", start.elapsed().as_secs_f64(), out.display());
    Ok(())
}
