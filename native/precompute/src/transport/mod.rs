//! Multiple scattering within a yarn, as a table.

mod section;
mod store;
mod table;
mod walk;

pub use store::TransportStore;
pub use table::{Entry, Transport, TransportSize};
