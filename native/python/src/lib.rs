//! The extension module `lisle._native`: conversions, one error map ([`error`]), one place that releases the GIL ([`gil`]).
//! What people call is the Python package around it.

mod adapter;
mod convert;
mod environment;
mod error;
mod exr;
mod fabric;
mod gil;
mod load;
mod material;
mod mesh;
mod png;
mod reference;
mod renderer;
mod save;
mod scene;
mod yarn;
mod yarns;

use pyo3::pymodule;

/// Everything that `lisle` is built from.
#[pymodule(name = "_native")]
mod native {
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_export]
    use super::adapter::{Adapter, adapters};
    #[pymodule_export]
    use super::environment::{EnvironmentImage, load_image};
    #[pymodule_export]
    use super::exr::{cryptomatte_hash, save_exr};
    #[pymodule_export]
    use super::fabric::{knit_flat, knit_mesh, knit_sleeve, knit_tube, sweater, woven_flat};
    #[pymodule_export]
    use super::gil::{set_threads, threads};
    #[pymodule_export]
    use super::load::load;
    #[pymodule_export]
    use super::material::{check_material, material_preset, material_presets};
    #[pymodule_export]
    use super::mesh::{Texels, Triangles};
    #[pymodule_export]
    use super::png::save_png;
    #[pymodule_export]
    use super::reference::{fibers, reference};
    #[pymodule_export]
    use super::renderer::Renderer;
    #[pymodule_export]
    use super::yarn::{check_yarn, yarn_preset, yarn_presets};
    #[pymodule_export]
    use super::yarns::Yarns;
}
