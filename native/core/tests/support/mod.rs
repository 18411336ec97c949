//! What several tests share.
#![allow(dead_code, reason = "each test crate uses a part")]

use std::io::Write;

use glam::DVec3;
use lisle_core::Curves;

pub fn point(p: [f32; 3]) -> DVec3 {
    DVec3::from_array(p.map(f64::from))
}

pub fn single(points: Vec<[f32; 3]>, closed: bool) -> Curves {
    Curves::catmull_rom(vec![points], closed)
}

/// `count` points of a curve given by its point number.
pub fn sampled(count: usize, at: impl Fn(f64) -> DVec3) -> Vec<[f32; 3]> {
    (0..count).map(|i| at(i as f64).as_vec3().to_array()).collect()
}

/// The center line of a knitted row: loops that lean over each other, `per_loop` points each, in the xy plane with
/// depth in z. One loop is one unit wide.
pub fn knitted(count: usize, per_loop: f64) -> Vec<[f32; 3]> {
    sampled(count, |i| {
        let t = std::f64::consts::TAU * i / per_loop;
        DVec3::new(t / std::f64::consts::TAU - 0.35 * (2.0 * t).sin() / 2.0, 0.6 * t.cos(), 0.2 * (2.0 * t).cos())
    })
}

/// A coil about the x axis.
pub fn coiled(count: usize, per_turn: f64) -> Vec<[f32; 3]> {
    sampled(count, |i| {
        let t = std::f64::consts::TAU * i / per_turn;
        DVec3::new(0.1 * t, t.cos(), t.sin())
    })
}

/// Deterministic numbers in [-1, 1).
pub struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    }

    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }
}

/// Catmull-Rom curves of a BCC file in the data folder; `None`, said aloud, if it is not there.
pub fn bcc(name: &str) -> Option<Curves> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let data = std::env::var_os("LISLE_DATA").map_or_else(|| root.join("../shared/data"), Into::into);
    let Ok(bytes) = std::fs::read(data.join("yarns").join(name)) else {
        // Not by a macro, whose lines a passing test keeps to itself.
        let _ = writeln!(std::io::stderr(), "skipped: no data ({name})");
        return None;
    };
    let word = |at: usize| <[u8; 4]>::try_from(&bytes[at..at + 4]).expect("four bytes");
    let curves = u64::from_le_bytes(bytes[8..16].try_into().expect("eight bytes"));
    let mut set = Curves::catmull_rom(Vec::new(), false);
    let mut at = 64;
    for _ in 0..curves {
        let n = i32::from_le_bytes(word(at));
        at += 4;
        for _ in 0..n.unsigned_abs() {
            set.points.push(std::array::from_fn(|c| f32::from_le_bytes(word(at + 4 * c))));
            at += 12;
        }
        set.offsets.push(set.points.len() as u32);
        set.closed.push(n < 0);
        set.basis.push(lisle_core::Basis::CatmullRom);
    }
    Some(set)
}
