//! The Blender extension: a copy of `addon/` with the wheel in it, packed and checked by Blender's own tool.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::failure::Failure;
use crate::shell::{folder, output, root, say, target};

const ID: &str = "lisle_blender";

/// Builds an archive for the platform of each wheel with Blender's tool for extensions, and returns their paths.
pub fn build(wheels: &[PathBuf], tool: impl Fn() -> Result<Command, Failure>) -> Result<Vec<PathBuf>, Failure> {
    say("Packing the extension");
    let source = target().join("extension/source");
    if source.is_dir() {
        std::fs::remove_dir_all(&source).map_err(|error| failed(&source, error))?;
    }
    copy(&root().join("addon"), &source)?;
    folder(&source.join("wheels"))?;
    let mut names = Vec::new();
    for wheel in wheels {
        let name = wheel.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        std::fs::copy(wheel, source.join("wheels").join(&name)).map_err(|error| failed(wheel, error))?;
        names.push(name);
    }
    let platforms = names.iter().map(|name| platform(name)).collect::<Result<Vec<_>, _>>()?;
    let manifest = source.join("blender_manifest.toml");
    let text = std::fs::read_to_string(&manifest).map_err(|error| failed(&manifest, error))?;
    std::fs::write(&manifest, packaged(&text, &names, &platforms)?).map_err(|error| failed(&manifest, error))?;

    let name = format!("{ID}-{}", env!("CARGO_PKG_VERSION"));
    let folder = target().join("extension");
    let mut build = tool()?;
    build.args(["build", "--split-platforms", "--source-dir"]).arg(&source);
    build.arg("--output-filepath").arg(folder.join(format!("{name}.zip")));
    output("building the extension", &mut build)?;
    let mut archives = Vec::new();
    for platform in platforms {
        let archive = folder.join(format!("{name}-{}.zip", platform.replace('-', "_")));
        let said = output("validating the extension", tool()?.arg("validate").arg(&archive))?;
        println!("{}", said.trim());
        archives.push(archive);
    }
    Ok(archives)
}

/// Blender's name of the platform that a wheel is for.
fn platform(wheel: &str) -> Result<&'static str, Failure> {
    let tag = wheel.trim_end_matches(".whl").rsplit('-').next().unwrap_or_default();
    let known = [
        ("linux", "x86_64", "linux-x64"),
        ("linux", "aarch64", "linux-arm64"),
        ("win", "amd64", "windows-x64"),
        ("win", "arm64", "windows-arm64"),
        ("macosx", "arm64", "macos-arm64"),
        ("macosx", "x86_64", "macos-x64"),
    ];
    known
        .into_iter()
        .find(|(system, machine, _)| tag.contains(system) && tag.ends_with(machine))
        .map(|(.., platform)| platform)
        .ok_or_else(|| Failure::new("packing the extension", format!("no Blender runs on the platform of {wheel}")))
}

/// The manifest with the wheels, their platforms and the workspace's version.
fn packaged(manifest: &str, wheels: &[String], platforms: &[&str]) -> Result<String, Failure> {
    let wheels: Vec<String> = wheels.iter().map(|wheel| format!("./wheels/{wheel}")).collect();
    let mut replacements = [
        ("wheels = ", format!("wheels = {wheels:?}"), false),
        ("platforms = ", format!("platforms = {platforms:?}"), false),
        ("version = ", format!("version = \"{}\"", env!("CARGO_PKG_VERSION")), false),
    ];
    let mut lines = Vec::new();
    for line in manifest.lines() {
        match replacements.iter_mut().find(|(start, ..)| line.starts_with(*start)) {
            Some((_, replacement, found)) => {
                *found = true;
                lines.push(replacement.clone());
            }
            // Comments are for those who read the folder.
            None if line.starts_with('#') => {}
            None => lines.push(line.to_owned()),
        }
    }
    match replacements.iter().find(|(.., found)| !found) {
        None => Ok(lines.join("\n") + "\n"),
        Some((start, ..)) => {
            Err(Failure::new("packing the extension", format!("addon/blender_manifest.toml has no line `{start}…`")))
        }
    }
}

fn copy(from: &Path, to: &Path) -> Result<(), Failure> {
    folder(to)?;
    for entry in std::fs::read_dir(from).map_err(|error| failed(from, error))? {
        let entry = entry.map_err(|error| failed(from, error))?;
        let name = entry.file_name();
        if name == "__pycache__" || name == "wheels" || name.to_string_lossy().starts_with('.') {
            continue;
        }
        let (from, to) = (entry.path(), to.join(&name));
        if from.is_dir() {
            copy(&from, &to)?;
        } else {
            std::fs::copy(&from, &to).map_err(|error| failed(&from, error))?;
        }
    }
    Ok(())
}

fn failed(path: &Path, error: std::io::Error) -> Failure {
    Failure::new("packing the extension", format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn platforms_follow_from_the_tags_of_wheels() {
        let of = |tag: &str| platform(&format!("lisle-0.1.0-cp311-abi3-{tag}.whl")).ok();
        assert_eq!(of("manylinux_2_28_x86_64"), Some("linux-x64"));
        assert_eq!(of("linux_aarch64"), Some("linux-arm64"));
        assert_eq!(of("win_amd64"), Some("windows-x64"));
        assert_eq!(of("macosx_11_0_arm64"), Some("macos-arm64"));
        assert_eq!(of("any"), None);
    }

    #[test]
    fn the_manifest_names_the_wheels_and_one_without_a_place_for_it_is_refused() {
        let manifest = "# note\nid = \"x\"\nversion = \"9\"\nplatforms = []\nwheels = []\n";
        let wheels = ["a.whl".to_owned(), "b.whl".to_owned()];
        let packaged = |text| super::packaged(text, &wheels, &["linux-x64", "windows-x64"]);
        let version = env!("CARGO_PKG_VERSION");
        let expected = format!(
            "id = \"x\"\nversion = \"{version}\"\nplatforms = [\"linux-x64\", \"windows-x64\"]\nwheels = [\"./wheels/a.whl\", \"./wheels/b.whl\"]\n"
        );
        assert_eq!(packaged(manifest).expect("complete"), expected);
        assert!(packaged("id = \"x\"\nversion = \"9\"\nplatforms = []\n").is_err());
    }
}
