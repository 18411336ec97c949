//! Every test there is.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::blender::Modules;
use crate::failure::Failure;
use crate::python::{Environment, any};
use crate::shell::{cargo, root, say, target, tee};
use crate::{extension, vulkan, wheel};

/// What the tests of the package need besides it: readers of its files, the type checker, another path tracer, and a
/// measure of how different pictures look.
const PYTHON_TESTS: [&str; 8] = [
    "numpy>=1.26",
    "pytest>=8",
    "usd-core>=24.11",
    "mypy>=1.18",
    "pillow",
    "OpenEXR>=3.3",
    "mitsuba>=3.6",
    "flip-evaluator>=1.7",
];

/// Lines by which the runners close.
const CLOSING: [&str; 4] = ["test result: ", "===", "Success: ", "All checks passed"];

/// Steps that ran, and how each ended.
#[derive(Default)]
struct Report {
    lines: Vec<String>,
    failed: Vec<String>,
}

impl Report {
    /// Does a step; a failure is noted, and the rest goes on.
    fn step(&mut self, name: &str, step: impl FnOnce() -> Result<Vec<String>, Failure>) {
        say(name);
        let start = Instant::now();
        match step() {
            Ok(closing) => {
                let seconds = start.elapsed().as_secs_f64();
                self.lines.push(format!("ok      {name} ({seconds:.0} s)"));
                self.lines.extend(closing.into_iter().map(|line| format!("          {line}")));
            }
            Err(failure) => {
                eprintln!("{failure}");
                self.lines.push(format!("FAILED  {name}"));
                self.lines.extend(failure.to_string().lines().map(|line| format!("          {line}")));
                self.failed.push(name.to_owned());
            }
        }
    }
}

/// Runs a test runner and returns its own closing lines, which it must have printed.
fn closing(what: &str, command: &mut Command) -> Result<Vec<String>, Failure> {
    let (succeeded, lines) = tee(what, command)?;
    let is_closing = |line: &&String| {
        let plain = line.trim_start_matches("\u{1b}[32m");
        CLOSING.iter().any(|start| plain.starts_with(start))
            && !plain.contains("test session starts")
            && !plain.contains("short test summary")
            && !plain.starts_with("test result: ok. 0 passed; 0 failed; 0 ignored")
    };
    let mut closing: Vec<String> = lines.iter().filter(is_closing).cloned().collect();
    if !succeeded {
        let said = if closing.is_empty() { lines.last().cloned().unwrap_or_default() } else { closing.join("\n") };
        return Err(Failure::new(what, said));
    }
    if closing.is_empty() {
        return Err(Failure::new(what, "it ended without a closing line: no test ran"));
    }
    closing.extend(skipped(&lines));
    Ok(closing)
}

/// What tests said that they left out, each once.
fn skipped(lines: &[String]) -> Vec<String> {
    let mut said: Vec<String> = Vec::new();
    for line in lines.iter().filter_map(|line| line.find("skipped: ").map(|at| &line[at..])) {
        if !said.iter().any(|known| known == line) {
            said.push(line.to_owned());
        }
    }
    said
}

/// Runs a tool of which the exit code says it all.
fn check(what: &str, command: &mut Command) -> Result<Vec<String>, Failure> {
    crate::shell::run(what, command).map(|()| Vec::new())
}

/// An environment with the wheel, what its tests need, and a graphics driver.
pub fn environment(wheel: &Path) -> Result<Environment, Failure> {
    let python = Environment::new("test", &any()?, &PYTHON_TESTS)?;
    python.install(wheel)?;
    vulkan::ensure(&python)?;
    Ok(python)
}

/// Everything, in the order in which failures are cheap to find.
pub fn run() -> Result<(), Failure> {
    let start = Instant::now();
    let mut report = Report::default();
    report.step("cargo fmt --check", || check("cargo fmt", cargo().args(["fmt", "--all", "--check"])));
    report.step("ruff", || wheel::lint().map(|()| Vec::new()));
    let clippy = ["clippy", "--workspace", "--all-targets", "--quiet", "--", "--deny", "warnings"];
    report.step("cargo clippy --deny warnings", || check("cargo clippy", cargo().args(clippy)));

    // The wheel comes before the tests in Rust: its environment is asked whether a graphics driver answers.
    let wheel = wheel::native()?;
    let mut environment = None;
    report.step("set-up", || {
        environment = Some(self::environment(&wheel)?);
        Ok(Vec::new())
    });

    // An extension module has no test executable: it takes Python's symbols from the process that loads it.
    // Optimised, as the wheel is: one build of the renderer, and tests in f64 that end.
    let rust = ["test", "--release", "--workspace", "--exclude", "lisle-python", "--no-fail-fast"];
    report.step("cargo test --workspace", || closing("cargo test", cargo().args(rust)));
    if let Some(python) = &environment {
        report.step("pytest tests/python", || pytest(&mut python.python(), "tests/python"));
    }

    let (modules, missing) = Modules::all()?;
    let mut archive = None;
    if let Some(module) = modules.first() {
        report.step("the extension, and blender_ext.py validate", || {
            archive = extension::build(std::slice::from_ref(&wheel), || module.extension_tool())?.pop();
            Ok(Vec::new())
        });
    }
    for module in &modules {
        report.step(&format!("pytest tests/blender in Blender {}", module.release), || {
            // Not in the environment itself, where it would hide the one that the extension brings.
            let site = target().join("site");
            module.environment.unpack(&wheel, &site)?;
            let mut python = module.environment.python();
            python.env("PYTHONPATH", &site);
            if let Some(archive) = &archive {
                python.env("LISLE_PACKAGE", archive);
            }
            pytest(&mut python, "tests/blender")
        });
    }
    if let (Some(python), Some(archive)) = (&environment, &archive) {
        report.step("pytest tests/window in the blender on PATH, if there is one", || {
            pytest(python.python().env("LISLE_PACKAGE", archive), "tests/window")
        });
    }

    say("Summary");
    for line in &report.lines {
        println!("{line}");
    }
    for line in &missing {
        println!("skipped {line}");
    }
    println!("in {:.0} s", start.elapsed().as_secs_f64());
    if modules.is_empty() {
        report.failed.push("no test ran inside Blender".to_owned());
    }
    if report.failed.is_empty() { Ok(()) } else { Err(Failure::new("the test", report.failed.join("; "))) }
}

fn pytest(python: &mut Command, folder: &str) -> Result<Vec<String>, Failure> {
    closing(
        &format!("pytest {folder}"),
        python.args(["-m", "pytest", "-p", "no:cacheprovider"]).arg(root().join(folder)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_left_out_is_told_once() {
        let lines =
            ["test a ... skipped: no data (a)", "test b ... ok", "skipped: no data (a)", "skipped: no data (b)"];
        let lines = lines.map(str::to_owned);
        assert_eq!(skipped(&lines), ["skipped: no data (a)", "skipped: no data (b)"]);
    }
}
