//! The benchmark.

use crate::failure::Failure;
use crate::shell::{self, cargo};

/// Runs it in release, with arguments of its own.
pub fn run(arguments: &[String]) -> Result<(), Failure> {
    shell::run("the benchmark", cargo().args(["run", "--release", "--package", "lisle-bench", "--"]).args(arguments))
}
