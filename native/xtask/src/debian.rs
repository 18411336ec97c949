//! Debian's packages, where this runs on Debian with the right to install them.

use crate::failure::Failure;
use crate::shell::{command, output, run, say};

/// Installs packages because of `why`; `missing` is the failure if that is not for us to do, with advice added.
pub fn install(why: &str, packages: &[&str], missing: Failure) -> Result<(), Failure> {
    let is_root = output("id", command("id").arg("-u")).is_ok_and(|id| id.trim() == "0");
    let has_apt = output("apt-get", command("apt-get").arg("--version")).is_ok();
    if !(is_root && has_apt) {
        let packages = packages.join(" ");
        return Err(missing.remedy(format!("install it; on Debian, as root: apt install {packages}")));
    }
    say(&format!("{why}: installing {}", packages.join(" ")));
    run("apt-get update", command("apt-get").args(["update", "--quiet"]))?;
    let install = ["install", "--quiet", "--yes", "--no-install-recommends"];
    run("apt-get install", command("apt-get").args(install).args(packages).env("DEBIAN_FRONTEND", "noninteractive"))
}
