//! Lisle: python.
