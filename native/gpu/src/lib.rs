//! Lisle: gpu.
