//! Blender, as a program on PATH or as the module `bpy` in a virtual environment.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::debian;
use crate::failure::Failure;
use crate::python::{Environment, Interpreter, interpreters};
use crate::shell::{command, folder, once, output, run, say};

/// Releases that are supported, with the Python of their `bpy` wheels; the one that a demo takes first.
const RELEASES: [(&str, (u32, u32)); 3] = [("5.0", (3, 11)), ("4.5", (3, 11)), ("5.2", (3, 13))];

/// The oldest that the extension runs in.
const OLDEST: (u32, u32) = (4, 5);

/// What the `bpy` wheel loads and does not bring, as Debian's packages.
const LIBRARIES: [&str; 8] =
    ["libgl1", "libx11-6", "libxi6", "libxrender1", "libxfixes3", "libxkbcommon0", "libsm6", "libice6"];

/// Where the extension is enabled: its package below Blender's own.
pub const MODULE: &str = "bl_ext.user_default.lisle_blender";

/// Blender as a Python module.
pub struct Modules {
    /// Such as "5.0".
    pub release: &'static str,
    /// With `bpy`, and what tests need.
    pub environment: Environment,
}

impl Modules {
    fn new(release: &'static str, interpreter: &Interpreter) -> Result<Self, Failure> {
        let bpy = format!("bpy=={release}.*");
        let environment = Environment::new(&format!("bpy-{release}"), interpreter, &[&bpy, "pytest>=8"])?;
        let modules = Self { release, environment };
        if let Err(failure) = modules.load() {
            if !failure.to_string().contains("cannot open shared object file") {
                return Err(failure);
            }
            debian::install("Blender lacks libraries", &LIBRARIES, failure)?;
            modules.load()?;
        }
        Ok(modules)
    }

    /// Whether `bpy` loads. A second time it is not tried.
    fn load(&self) -> Result<(), Failure> {
        once(&self.environment.stamp("bpy-loads"), self.release, || {
            output("loading bpy", self.environment.python().args(["-c", "import bpy"])).map(|_| ())
        })
    }

    /// One for every release whose Python is on this machine, and the releases that were left out with the reason.
    pub fn all() -> Result<(Vec<Self>, Vec<String>), Failure> {
        let found = interpreters();
        let (mut modules, mut missing) = (Vec::new(), Vec::new());
        for (release, version) in RELEASES {
            match found.iter().find(|interpreter| interpreter.version == version) {
                Some(interpreter) => modules.push(Self::new(release, interpreter)?),
                None => missing.push(format!("Blender {release}: no Python {}.{} here", version.0, version.1)),
            }
        }
        Ok((modules, missing))
    }

    /// The first of [`RELEASES`] whose Python is on this machine.
    fn preferred() -> Result<Self, Failure> {
        let found = interpreters();
        for (release, version) in RELEASES {
            if let Some(interpreter) = found.iter().find(|interpreter| interpreter.version == version) {
                return Self::new(release, interpreter);
            }
        }
        Err(Failure::new("looking for Blender", "there is neither a blender ≥ 4.5 on PATH nor a Python 3.11 or 3.13")
            .remedy("install Blender, or Python 3.11; on Debian 12: apt install python3.11-venv"))
    }

    /// Blender's tool for extensions, which is plain Python.
    pub fn extension_tool(&self) -> Result<Command, Failure> {
        let script = "import importlib.util as u; print(u.find_spec('bpy').submodule_search_locations[0])";
        let package = output("looking for bpy", self.environment.python().args(["-c", script]))?;
        let tool = Path::new(package.trim()).join(self.release).join("scripts/addons_core/bl_pkg/cli/blender_ext.py");
        let mut python = self.environment.python();
        python.arg(tool);
        Ok(python)
    }
}

/// Blender, as this machine has it.
pub enum Blender {
    /// On PATH, with its version.
    Program(String),
    /// In a virtual environment.
    Module(Modules),
}

impl Blender {
    /// The program on PATH, if it is recent enough. The module is fetched only where there is none.
    pub fn found() -> Result<Self, Failure> {
        Self::choose(on_path(), Modules::preferred)
    }

    fn choose(program: Option<String>, modules: impl FnOnce() -> Result<Modules, Failure>) -> Result<Self, Failure> {
        match program {
            Some(version) => Ok(Self::Program(version)),
            None => modules().map(Self::Module),
        }
    }

    /// Its tool for extensions.
    pub fn extension_tool(&self) -> Result<Command, Failure> {
        match self {
            Self::Program(_) => {
                let mut blender = command("blender");
                blender.args(["--factory-startup", "--command", "extension"]);
                Ok(blender)
            }
            Self::Module(modules) => modules.extension_tool(),
        }
    }

    /// With settings in a folder of its own.
    pub fn host(self, settings: PathBuf) -> Host {
        match self {
            Self::Program(version) => Host::program(&version, settings),
            Self::Module(modules) => Host::module(modules, settings),
        }
    }
}

/// The version of the program on PATH, if it is recent enough.
fn on_path() -> Option<String> {
    recent(&output("blender", command("blender").arg("--version")).ok()?)
}

/// The version that Blender says it has, unless it is too old.
fn recent(text: &str) -> Option<String> {
    let version = text.split_whitespace().nth(1)?;
    let mut numbers = version.split('.').map_while(|number| number.parse::<u32>().ok());
    let release = (numbers.next()?, numbers.next()?);
    (release >= OLDEST).then(|| version.to_owned())
}

/// Something that runs a Python script inside Blender, with settings of its own that leave the user's alone.
pub struct Host {
    run: Box<dyn Fn(&Path) -> Command>,
    /// For people.
    pub name: String,
    settings: PathBuf,
}

impl Host {
    fn program(version: &str, settings: PathBuf) -> Self {
        let run = |script: &Path| {
            let mut blender = command("blender");
            blender.args(["--background", "--python-exit-code", "1", "--python"]).arg(script).arg("--");
            blender
        };
        Self { run: Box::new(run), name: format!("Blender {version}"), settings }
    }

    fn module(modules: Modules, settings: PathBuf) -> Self {
        let name = format!("Blender {} (bpy)", modules.release);
        let run = move |script: &Path| {
            let mut python = modules.environment.python();
            python.arg(script).arg("--");
            python
        };
        Self { run: Box::new(run), name, settings }
    }

    /// A script in it; arguments follow.
    pub fn script(&self, script: &Path) -> Command {
        let mut command = (self.run)(script);
        command.env("BLENDER_USER_RESOURCES", &self.settings);
        command
    }

    /// Installs and enables an extension, unless this very one is there.
    pub fn install(&self, archive: &Path, content: &str) -> Result<(), Failure> {
        folder(&self.settings)?;
        once(&self.settings.join("lisle-extension"), &format!("{} {content}", self.name), || {
            say(&format!("Installing the extension in {}", self.name));
            let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/install_extension.py");
            run("installing the extension", self.script(&script).arg(archive).arg(MODULE))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_module_is_fetched_only_where_no_recent_blender_is_on_path() {
        let fetch = || Err(Failure::new("fetching bpy", "it was asked for"));
        let found = Blender::choose(recent("Blender 5.2.2 LTS\n\tbuild date: 2026-10-20\n"), fetch);
        assert!(matches!(found, Ok(Blender::Program(version)) if version == "5.2.2"));
        for text in ["Blender 4.4.3", "no such program", ""] {
            assert!(Blender::choose(recent(text), fetch).is_err(), "{text}");
        }
    }
}
