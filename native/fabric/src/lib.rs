//! Lisle: yarn makers over parametric surfaces.
//!
//! A [`Pattern`] of knit and purl stitches becomes a [`Knit`] cloth, and a [`Weave`] a [`Woven`] one; their yarns are laid on any [`Surface`]:
//!
//! ```
//! use lisle_fabric::{FlatPatch, Knit, Pattern, YARN_RADIUS_M};
//! let knit = Knit::flat(&Pattern::rib(2, 2)?, 12, 16, YARN_RADIUS_M)?;
//! let curves = knit.swatch(&FlatPatch { size_m: knit.size_m() })?;
//! assert_eq!(curves.len(), 12);
//! # Ok::<(), lisle_fabric::Error>(())
//! ```

mod cell;
mod distance;
mod error;
mod garment;
mod knit;
#[cfg(test)]
mod knit_tests;
mod mesh;
#[cfg(test)]
mod mesh_tests;
mod pattern;
mod relax;
mod surface;
mod uv_grid;
mod weave;
mod woven;
#[cfg(test)]
mod woven_tests;

pub use cell::POINTS_PER_STITCH;
pub use error::Error;
pub use garment::sweater;
pub use knit::{Knit, YARN_RADIUS_M};
pub use mesh::{MeshKnit, MeshPoint, UvMesh};
pub use pattern::{Pattern, Stitch};
pub use surface::{FlatPatch, Sleeve, Surface, Tube};
pub use weave::Weave;
pub use woven::{SPACING, Woven};
