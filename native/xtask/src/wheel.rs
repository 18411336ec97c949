//! The abi3 wheel.

use std::path::PathBuf;

use crate::failure::Failure;
use crate::python::{Environment, any};
use crate::shell::{command, folder, run, say, target};

const MATURIN: &str = "maturin>=1.9,<2";

/// The oldest glibc that the extension supports: Blender's own.
const MANYLINUX: &str = "manylinux_2_28";

/// A wheel for this machine.
pub fn native() -> Result<PathBuf, Failure> {
    build("wheels", &[MATURIN], &[])
}

/// A wheel for any machine with this operating system. On Linux, zig links against the old glibc.
pub fn portable() -> Result<PathBuf, Failure> {
    if cfg!(target_os = "linux") {
        build("portable-wheels", &[MATURIN, "ziglang"], &["--zig", "--compatibility", MANYLINUX])
    } else {
        native()
    }
}

fn build(name: &str, tools: &[&str], options: &[&str]) -> Result<PathBuf, Failure> {
    let python = any()?;
    let environment = Environment::new(&format!("tools-{name}"), &python, tools)?;
    let out = target().join(name);
    if out.is_dir() {
        std::fs::remove_dir_all(&out).map_err(|error| Failure::new(format!("clearing {}", out.display()), error))?;
    }
    folder(&out)?;
    say("Building the wheel");
    let mut maturin = environment.python();
    maturin.args(["-m", "maturin", "build", "--release", "--quiet", "--out"]).arg(&out).args(options);
    maturin.arg("--interpreter").arg(environment.executable("python"));
    // Cargo's own settings for this program must not leak into that build.
    for (name, _) in std::env::vars_os() {
        if name.to_string_lossy().starts_with("CARGO_PKG_") || name == "CARGO_MANIFEST_DIR" {
            maturin.env_remove(name);
        }
    }
    run("building the wheel", &mut maturin)?;
    let wheel = std::fs::read_dir(&out).into_iter().flatten().flatten().map(|entry| entry.path()).next();
    wheel.ok_or_else(|| Failure::new("building the wheel", format!("{} is empty", out.display())))
}

/// Checks formatting and lints of all Python in the tree.
pub fn lint() -> Result<(), Failure> {
    let environment = Environment::new("ruff", &any()?, &["ruff==0.17.*"])?;
    let ruff = environment.executable("ruff");
    run("ruff check", command(&ruff).args(["check", "."]))?;
    run("ruff format --check", command(&ruff).args(["format", "--check", "."]))
}
