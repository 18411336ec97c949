//! What is measured: yarn files that lie on this machine, and a generated garment.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lisle_core::Yarns;

/// A model that is not loaded yet.
pub struct Model {
    name: String,
    source: Source,
}

enum Source {
    File(PathBuf),
    Garment { points: usize },
}

/// The garment's name; with [`QUICK_GARMENT`] points, another one, so that nobody mistakes its figures.
pub const GARMENT: &str = "garment, 2 M points";
const QUICK_GARMENT: &str = "garment, 100 k points";

impl Model {
    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn is_garment(&self) -> bool {
        matches!(self.source, Source::Garment { .. })
    }

    /// The yarns, Z up.
    pub fn load(&self) -> Result<Arc<Yarns>, Box<dyn Error>> {
        let curves = match &self.source {
            Source::File(path) => lisle_formats::load(path)?.into_z_up().curves,
            Source::Garment { points } => lisle_fabric::sweater(*points)?,
        };
        Ok(Arc::new(Yarns::new(curves, None)?))
    }
}

/// All models, files first. Says so when there are no files.
pub fn list(quick: bool) -> Result<Vec<Model>, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder =
        std::env::var_os("LISLE_DATA").map_or_else(|| root.join("../shared/data"), PathBuf::from).join("yarns");
    let mut models = Vec::new();
    if folder.is_dir() {
        for entry in std::fs::read_dir(&folder)? {
            let path = entry?.path();
            if path.extension().is_some_and(|extension| extension == "bcc") {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                models.push(Model { name, source: Source::File(path) });
            }
        }
        models.sort_by(|a, b| a.name.cmp(&b.name));
    }
    if models.is_empty() {
        println!("Yarn files: skipped: no data\n");
    }
    let (name, points) = if quick { (QUICK_GARMENT, 100_000) } else { (GARMENT, 2_000_000) };
    models.push(Model { name: name.into(), source: Source::Garment { points } });
    Ok(models)
}
