//! A graphics driver.

use crate::debian;
use crate::failure::Failure;
use crate::python::Environment;
use crate::shell::output;

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
    debian::install("No Vulkan driver answers", &["mesa-vulkan-drivers", "libvulkan1"], none())?;
    let found = adapters(environment)?;
    if found.is_empty() { Err(none().remedy("see `vulkaninfo --summary`")) } else { Ok(found) }
}
