//! Multiple scattering within a yarn, as a table.

mod medium;
mod store;
mod table;
mod walk;

pub use store::TransportStore;
pub use table::{Transport, TransportSize};
