//! Multiple scattering within a yarn, as a table.

mod medium;
mod table;
mod walk;

pub use table::{Transport, TransportSize};
