//! Lisle: formats.
