//! Lisle: precompute.
