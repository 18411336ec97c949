//! The renderer beside the reference.

use crate::failure::Failure;
use crate::shell::{self, root, say};
use crate::{test, wheel};

/// Draws a fixed set with both and writes `out/fidelity/`, with arguments of its own.
pub fn run(arguments: &[String]) -> Result<(), Failure> {
    let environment = test::environment(&wheel::native()?)?;
    say("Comparing");
    shell::run("the comparison", environment.python().arg(root().join("tests/fidelity")).args(arguments))
}
