//! A knitted animation, through Blender, from nothing.

use std::time::Instant;

use crate::blender::Blender;
use crate::failure::Failure;
use crate::python::{Environment, any};
use crate::shell::{digest, folder, root, say, target, tee};
use crate::{extension, vulkan, wheel};

const SCRIPT: &str = "examples/05_blender_knit_animation.py";
const FRAMES: usize = 24;

/// Sets everything up, then renders to `out/demo/`.
pub fn run() -> Result<(), Failure> {
    let start = Instant::now();
    let wheel = wheel::native()?;
    let plain = Environment::new("lisle", &any()?, &["numpy>=1.26"])?;
    plain.install(&wheel)?;
    let adapters = vulkan::ensure(&plain)?;

    let blender = Blender::found()?;
    let content = digest(&wheel)?;
    let archive = extension::build(std::slice::from_ref(&wheel), || blender.extension_tool())?.remove(0);
    let host = blender.host(target().join("demo/blender"));
    host.install(&archive, &format!("{content} {}", digest(&archive)?))?;

    let out = root().join("out/demo");
    folder(&out)?;
    say(&format!("Rendering {SCRIPT} with {} on {adapters}", host.name));
    let rendering = Instant::now();
    let script = root().join(SCRIPT);
    let (succeeded, lines) = tee("rendering", host.script(&script).arg(&out).args(["--frames", &FRAMES.to_string()]))?;
    check(succeeded, &lines)?;
    let seconds = rendering.elapsed().as_secs_f64() / FRAMES as f64;
    println!("\n{FRAMES} frames, {seconds:.2} s each, on {adapters}: {}", out.display());
    println!("in {:.0} s, set-up included", start.elapsed().as_secs_f64());
    Ok(())
}

/// Whether Blender ended well, and said of every frame that it is on disk.
fn check(succeeded: bool, lines: &[String]) -> Result<(), Failure> {
    let frames = lines.iter().filter(|line| line.contains("Saved: '")).count();
    if succeeded && frames == FRAMES {
        return Ok(());
    }
    let last = lines.last().map_or("it said nothing", String::as_str);
    Err(Failure::new("rendering", format!("{frames} of {FRAMES} frames were saved; the last line was: {last}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_demo_of_fewer_frames_has_failed() {
        let lines = |frames| vec!["Saved: 'out/demo/knit_0001.png'".to_owned(); frames];
        assert!(check(true, &lines(FRAMES)).is_ok());
        assert!(check(false, &lines(FRAMES)).is_err());
        for frames in [0, 1, FRAMES - 1, FRAMES + 1] {
            let failure = check(true, &lines(frames)).expect_err("too few or too many");
            assert!(failure.to_string().contains(&format!("{frames} of 24 frames")), "{failure}");
        }
    }
}
