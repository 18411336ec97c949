//! Integer hashes that Rust and WGSL (`shaders/math/hash.wgsl`) evaluate to the same bits, low-discrepancy sequences, and what is
//! drawn from either.

mod filter;
mod hash;
mod random;
mod sequence;
mod spread;

pub use filter::{Filter, PixelFilter};
pub use hash::{hash_combine, hash_u32, normal_from_hash, unit_from_hash};
pub use random::Random;
pub use sequence::{Use, basis, concentric_disc, disc, pair, sphere};
pub use spread::even_ranks;
