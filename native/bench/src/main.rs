//! Lisle: bench.
fn main() {}
