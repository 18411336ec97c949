//! Pictures of presets, drawn by the renderer itself.

use std::path::Path;

use crate::failure::Failure;
use crate::shell::{root, run, say};
use crate::{test, wheel};

/// Draws those of these names, or all.
pub fn draw(names: &[String]) -> Result<(), Failure> {
    let environment = test::environment(&wheel::native()?)?;
    say("Drawing");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/thumbnails.py");
    let folder = root().join("addon/presets/thumbnails");
    run("the pictures of presets", environment.python().arg(script).arg(folder).args(names))
}
