//! Python interpreters and virtual environments.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::failure::Failure;
use crate::shell::{command, digest, folder, once, output, run, say, target};

/// An interpreter on this machine that can make virtual environments.
#[derive(Clone, Debug)]
pub struct Interpreter {
    path: PathBuf,
    /// Such as (3, 11).
    pub version: (u32, u32),
}

/// Versions that something here needs, the preferred one first.
const VERSIONS: [(u32, u32); 4] = [(3, 11), (3, 13), (3, 12), (3, 14)];

const PROBE: &str = "import sys, venv, ensurepip; print(sys.version_info[0], sys.version_info[1])";

/// All usable interpreters: those on PATH, and those that pyenv has.
pub fn interpreters() -> Vec<Interpreter> {
    let mut candidates: Vec<PathBuf> =
        VERSIONS.iter().map(|(major, minor)| PathBuf::from(format!("python{major}.{minor}"))).collect();
    candidates.extend(["python3".into(), "python".into()]);
    let home = std::env::var_os("HOME").or_else(|| std::env::var_os("USERPROFILE")).unwrap_or_default();
    let pyenv = std::env::var_os("PYENV_ROOT").map_or_else(|| Path::new(&home).join(".pyenv"), PathBuf::from);
    if let Ok(versions) = std::fs::read_dir(pyenv.join("versions")) {
        candidates.extend(versions.flatten().map(|version| version.path().join("bin/python3")));
    }
    let mut found: Vec<Interpreter> = Vec::new();
    for path in candidates {
        let Ok(answer) = output("python", command(&path).args(["-c", PROBE])) else { continue };
        let mut numbers = answer.split_whitespace().map_while(|number| number.parse().ok());
        let (Some(major), Some(minor)) = (numbers.next(), numbers.next()) else { continue };
        if VERSIONS.contains(&(major, minor)) && !found.iter().any(|known| known.version == (major, minor)) {
            found.push(Interpreter { path, version: (major, minor) });
        }
    }
    found.sort_by_key(|interpreter| VERSIONS.iter().position(|version| *version == interpreter.version));
    found
}

/// Any interpreter that runs the wheel.
pub fn any() -> Result<Interpreter, Failure> {
    interpreters().into_iter().next().ok_or_else(|| {
        Failure::new("looking for Python", "no Python from 3.11 to 3.14 with venv is on PATH")
            .remedy("install one; on Debian 12: apt install python3.11-venv")
    })
}

/// A virtual environment under `target/venv/`.
pub struct Environment {
    folder: PathBuf,
}

impl Environment {
    /// An environment with packages from the registry; made anew when they change.
    pub fn new(name: &str, interpreter: &Interpreter, packages: &[&str]) -> Result<Self, Failure> {
        let environment = Self { folder: target().join("venv").join(name) };
        let stamp = environment.folder.join("lisle-packages");
        let content = format!("{}\n{}", interpreter.path.display(), packages.join("\n"));
        once(&stamp, &content, || {
            say(&format!("Setting up Python: {name} ({})", packages.join(", ")));
            folder(&environment.folder)?;
            let make = format!("making the virtual environment {name}");
            let clear = ["-m", "venv", "--clear"];
            run(&make, command(&interpreter.path).args(clear).arg(&environment.folder))?;
            environment.pip(&format!("installing {}", packages.join(", ")), packages)
        })?;
        Ok(environment)
    }

    /// A file that remembers what was done in the environment; gone when that is made anew.
    pub fn stamp(&self, name: &str) -> PathBuf {
        self.folder.join(format!("lisle-{name}"))
    }

    fn pip(&self, what: &str, arguments: &[&str]) -> Result<(), Failure> {
        let quiet = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        run(what, self.python().args(quiet).args(arguments))
            .map_err(|failure| failure.remedy("check the connection to the package registry, then run this again"))
    }

    /// Installs a wheel unless this very one is there.
    pub fn install(&self, wheel: &Path) -> Result<(), Failure> {
        once(&self.folder.join("lisle-wheel"), &digest(wheel)?, || {
            let path = wheel.to_string_lossy();
            self.pip("installing the wheel", &["--force-reinstall", "--no-deps", &path])
        })
    }

    /// Unpacks a wheel into a folder for `PYTHONPATH`, unless this very one is there.
    pub fn unpack(&self, wheel: &Path, site: &Path) -> Result<(), Failure> {
        folder(site)?;
        once(&site.join("lisle-wheel"), &digest(wheel)?, || {
            let (site, wheel) = (site.to_string_lossy(), wheel.to_string_lossy());
            self.pip("unpacking the wheel", &["--no-deps", "--upgrade", "--target", &site, &wheel])
        })
    }

    /// Its interpreter.
    pub fn python(&self) -> Command {
        let mut python = command(self.executable("python"));
        // Programs of the environment are found first, as if it were activated.
        let path = std::env::var_os("PATH").unwrap_or_default();
        let folders = std::iter::once(self.scripts()).chain(std::env::split_paths(&path));
        if let Ok(path) = std::env::join_paths(folders) {
            python.env("PATH", path);
        }
        python.env("PYTHONDONTWRITEBYTECODE", "1");
        python
    }

    /// A program of the environment.
    pub fn executable(&self, name: &str) -> PathBuf {
        self.scripts().join(if cfg!(windows) { format!("{name}.exe") } else { name.to_owned() })
    }

    fn scripts(&self) -> PathBuf {
        self.folder.join(if cfg!(windows) { "Scripts" } else { "bin" })
    }
}
