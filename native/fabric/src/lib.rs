//! Lisle: fabric.
