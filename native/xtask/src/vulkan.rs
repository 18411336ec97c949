//! A graphics driver.

use crate::failure::Failure;
use crate::python::Environment;
use crate::shell::{command, output, run, say};

const PACKAGE: &str = "mesa-vulkan-drivers";

/// Names of the adapters that answer, the default one first, asked through an environment that has the wheel.
fn adapters(environment: &Environment) -> Result<String, Failure> {
    let script = "import lisle; print(', '.join(adapter.name for adapter in lisle.adapters()))";
    let names = output("looking for graphics adapters", environment.python().args(["-c", script]))?;
    Ok(names.trim().to_owned())
}

/// Makes sure that an adapter answers: where none does, Debian's software driver is installed, given the right to.
/// Returns the names of those that answer, the default one first.
pub fn ensure(environment: &Environment) -> Result<String, Failure> {
    let found = adapters(environment)?;
    if !found.is_empty() {
        return Ok(found);
    }
    let none = || Failure::new("looking for graphics adapters", "no Vulkan driver answers");
    let is_root = output("id", command("id").arg("-u")).is_ok_and(|id| id.trim() == "0");
    let has_apt = output("apt-get", command("apt-get").arg("--version")).is_ok();
    if !(is_root && has_apt) {
        return Err(none().remedy(format!("install one; on Debian, as root: apt install {PACKAGE} libvulkan1")));
    }
    say(&format!("No Vulkan driver answers: installing {PACKAGE}"));
    run("apt-get update", command("apt-get").args(["update", "--quiet"]))?;
    let install = ["install", "--quiet", "--yes", "--no-install-recommends", PACKAGE, "libvulkan1"];
    run("apt-get install", command("apt-get").args(install).env("DEBIAN_FRONTEND", "noninteractive"))?;
    let found = adapters(environment)?;
    if found.is_empty() { Err(none().remedy("see `vulkaninfo --summary`")) } else { Ok(found) }
}
