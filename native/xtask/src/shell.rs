//! Other programs, and the tree they run in.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc;

use crate::failure::Failure;

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap_or_else(|_| PathBuf::from("."))
}

/// The folder for what is built: cargo's own.
pub fn target() -> PathBuf {
    let folder = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    root().join(folder)
}

/// A program that runs in the root of the repository.
pub fn command(program: impl AsRef<std::ffi::OsStr>) -> Command {
    let mut command = Command::new(program);
    command.current_dir(root());
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // Without a desktop session, Mesa's layer that picks a GPU by the session's wishes complains on standard error.
        command.env("NODEVICE_SELECT", "1");
    }
    command
}

/// `cargo`, the one that runs this.
pub fn cargo() -> Command {
    command(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

fn line_of(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}

/// Runs a program with its output on the terminal.
pub fn run(what: &str, command: &mut Command) -> Result<(), Failure> {
    let status = command.status().map_err(|error| Failure::new(what, format!("{}: {error}", line_of(command))))?;
    if status.success() {
        Ok(())
    } else {
        Err(Failure::new(what, format!("`{}` ended with {status}", line_of(command))))
    }
}

/// Runs a program and returns its standard output; on failure what it said goes into the error.
pub fn output(what: &str, command: &mut Command) -> Result<String, Failure> {
    let output = command.output().map_err(|error| Failure::new(what, format!("{}: {error}", line_of(command))))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        return Ok(text);
    }
    let said = format!("{text}{}", String::from_utf8_lossy(&output.stderr));
    Err(Failure::new(what, format!("`{}` ended with {}:\n{}", line_of(command), output.status, said.trim_end())))
}

/// Runs a program with its output on the terminal, and also returns all lines of it, and whether it succeeded.
pub fn tee(what: &str, command: &mut Command) -> Result<(bool, Vec<String>), Failure> {
    let fail = |error: std::io::Error| Failure::new(what, error);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().map_err(fail)?;
    let (sender, receiver) = mpsc::channel();
    let pipes: [Option<Box<dyn Read + Send>>; 2] =
        [child.stdout.take().map(|pipe| Box::new(pipe) as _), child.stderr.take().map(|pipe| Box::new(pipe) as _)];
    for pipe in pipes.into_iter().flatten() {
        let sender = sender.clone();
        std::thread::spawn(move || {
            let mut reader = BufReader::new(pipe);
            let mut line = Vec::new();
            while reader.read_until(b'\n', &mut line).is_ok_and(|read| read > 0) {
                if sender.send(String::from_utf8_lossy(&line).into_owned()).is_err() {
                    break;
                }
                line.clear();
            }
        });
    }
    drop(sender);
    let mut lines = Vec::new();
    for line in receiver {
        print!("{line}");
        let _ = std::io::stdout().flush();
        lines.push(line.trim_end().to_owned());
    }
    Ok((child.wait().map_err(fail)?.success(), lines))
}

/// A short name for the content of a file, to notice changes.
pub fn digest(path: &Path) -> Result<String, Failure> {
    let bytes = std::fs::read(path).map_err(|error| Failure::new(format!("reading {}", path.display()), error))?;
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    Ok(format!("{:016x}", hasher.finish()))
}

/// Does a step unless its stamp says that exactly this was done before.
pub fn once(stamp: &Path, content: &str, step: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    if std::fs::read_to_string(stamp).is_ok_and(|done| done == content) {
        return Ok(());
    }
    let _ = std::fs::remove_file(stamp);
    step()?;
    std::fs::write(stamp, content).map_err(|error| Failure::new(format!("writing {}", stamp.display()), error))
}

/// Makes a folder and those above it.
pub fn folder(path: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path).map_err(|error| Failure::new(format!("making the folder {}", path.display()), error))
}

/// Says what happens next.
pub fn say(text: &str) {
    println!("\n\x1b[1m▸ {text}\x1b[0m");
}
