//! Lisle: xtask.
fn main() {}
