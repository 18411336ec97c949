//! The reference: every fiber explicit, and light scattered between them as often as it likes. Slow and right, it says how far
//! off the renderer is; nothing of it runs on a GPU.

pub mod assembly;
pub mod cone;
pub mod fibers;
