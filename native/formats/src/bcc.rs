//! BCC, the binary curve collection of Cem Yuksel's yarn-level cloth models.
//!
//! Little-endian. A header of 64 bytes:
//!
//! | offset | bytes | |
//! |---|---|---|
//! | 0 | 3 | `"BCC"` |
//! | 3 | 1 | 0x44: integers and floats of 4 bytes |
//! | 4 | 2 | curve type: `"C0"` uniform Catmull-Rom, `"BS"` uniform cubic B-spline |
//! | 6 | 1 | dimensions: 3 |
//! | 7 | 1 | up axis: 1 is Y, 2 is Z |
//! | 8 | 8 | number of curves |
//! | 16 | 8 | number of control points of all curves |
//! | 24 | 40 | information, text |
//!
//! then per curve an `i32` (the number of its points, negative for a closed curve) and the points, three `f32` each.
//! Such files say nothing of the yarn's radius, and nothing of the unit.

use crate::{Loaded, UpAxis};
use lisle_core::curve::{Basis, Curves};

const HEADER_BYTES: usize = 64;
const POINT_BYTES: usize = 12;

/// Why bytes are not a BCC file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BccError {
    /// The first bytes are others.
    #[error("offset 0: expected \"BCC\", found {found:?}")]
    BadMagic {
        /// The first bytes, as text.
        found: String,
    },
    /// The file is shorter than its header.
    #[error("{bytes} bytes: the header alone has 64")]
    TruncatedHeader {
        /// Length of the file.
        bytes: usize,
    },
    /// Only 4-byte integers and floats occur in the wild.
    #[error("offset 3: number format 0x{code:02x}; only 0x44 (integers and floats of 4 bytes) is supported")]
    NumberFormat {
        /// The code found.
        code: u8,
    },
    /// A curve type that nobody has told us about.
    #[error("offset 4: unknown curve type {code:?}; supported are \"C0\" (Catmull-Rom) and \"BS\" (B-spline)")]
    CurveType {
        /// The code found.
        code: String,
    },
    /// Curves live in three dimensions.
    #[error("offset 6: {found} dimensions, expected 3")]
    Dimensions {
        /// The number found.
        found: u8,
    },
    /// Up is Y or Z.
    #[error("offset 7: up axis {code}, expected 1 (Y) or 2 (Z)")]
    UpAxis {
        /// The code found.
        code: u8,
    },
    /// Points are counted with 32 bits here.
    #[error("{curves} curves and {points} points are more than 2^32 - 1")]
    TooMany {
        /// Curves by the header.
        curves: u64,
        /// Points by the header.
        points: u64,
    },
    /// The file ends too early.
    #[error("{bytes} bytes: {expected} are needed for the header's {curves} curves and {points} points")]
    Truncated {
        /// Length of the file.
        bytes: usize,
        /// Length by the header.
        expected: usize,
        /// Curves by the header.
        curves: u64,
        /// Points by the header.
        points: u64,
    },
    /// The file goes on after its last curve.
    #[error("offset {offset}: {count} bytes follow the last curve")]
    TrailingBytes {
        /// Where they begin.
        offset: usize,
        /// How many.
        count: usize,
    },
    /// A curve claims more points than are left.
    #[error("offset {offset}, curve {curve}: {points} points, but only {left} of the header's points are left")]
    CurveTooLong {
        /// Offset of the curve's count.
        offset: usize,
        /// Index of the curve.
        curve: usize,
        /// Points of the curve.
        points: u32,
        /// Points left by the header.
        left: usize,
    },
    /// The curves' points do not add up.
    #[error("the header promises {expected} points, the curves have {found}")]
    PointCount {
        /// Points by the header.
        expected: usize,
        /// Points of all curves.
        found: usize,
    },
}

/// Reads the bytes of a BCC file.
///
/// # Errors
/// [`BccError`], by offset or curve. Memory is only claimed for what the bytes hold.
pub fn parse(bytes: &[u8]) -> Result<Loaded, BccError> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if !bytes.starts_with(b"BCC") {
        return Err(BccError::BadMagic { found: text(&bytes[..bytes.len().min(3)]) });
    }
    let Some((header, body)) = bytes.split_first_chunk::<HEADER_BYTES>() else {
        return Err(BccError::TruncatedHeader { bytes: bytes.len() });
    };
    if header[3] != 0x44 {
        return Err(BccError::NumberFormat { code: header[3] });
    }
    let basis = match &header[4..6] {
        b"C0" => Basis::CatmullRom,
        b"BS" => Basis::BSpline,
        code => return Err(BccError::CurveType { code: text(code) }),
    };
    if header[6] != 3 {
        return Err(BccError::Dimensions { found: header[6] });
    }
    let up = match header[7] {
        1 => UpAxis::Y,
        2 => UpAxis::Z,
        code => return Err(BccError::UpAxis { code }),
    };
    let [curves, points] = [8, 16].map(|at| u64::from_le_bytes(std::array::from_fn(|i| header[at + i])));
    if curves.max(points) > u64::from(u32::MAX) {
        return Err(BccError::TooMany { curves, points });
    }
    let (curve_count, point_count) = (curves as usize, points as usize);
    let expected = HEADER_BYTES + 4 * curve_count + POINT_BYTES * point_count;
    if bytes.len() < expected {
        return Err(BccError::Truncated { bytes: bytes.len(), expected, curves, points });
    }

    let mut result = Curves {
        points: Vec::with_capacity(point_count),
        offsets: Vec::with_capacity(curve_count + 1),
        closed: Vec::with_capacity(curve_count),
        basis: vec![basis; curve_count],
        radii: None,
    };
    result.offsets.push(0);
    let mut rest = body;
    for curve in 0..curve_count {
        let offset = bytes.len() - rest.len();
        // The lengths were checked above, and no curve takes more than its share below.
        let (count, after) = rest.split_first_chunk::<4>().expect("a count for every curve");
        let count = i32::from_le_bytes(*count);
        let left = point_count - result.points.len();
        if count.unsigned_abs() as usize > left {
            return Err(BccError::CurveTooLong { offset, curve, points: count.unsigned_abs(), left });
        }
        let (coordinates, after) = after.split_at(POINT_BYTES * count.unsigned_abs() as usize);
        let coordinate =
            |point: &[u8; POINT_BYTES], axis: usize| f32::from_le_bytes(std::array::from_fn(|i| point[4 * axis + i]));
        let (chunks, _) = coordinates.as_chunks::<POINT_BYTES>();
        result.points.extend(chunks.iter().map(|point| [0, 1, 2].map(|axis| coordinate(point, axis))));
        result.offsets.push(result.points.len() as u32);
        result.closed.push(count < 0);
        rest = after;
    }
    if result.points.len() != point_count {
        return Err(BccError::PointCount { expected: point_count, found: result.points.len() });
    }
    if !rest.is_empty() {
        return Err(BccError::TrailingBytes { offset: bytes.len() - rest.len(), count: rest.len() });
    }
    let info = text(&header[24..]).trim_end_matches(['\0', ' ']).to_owned();
    Ok(Loaded { curves: result, up, length_coordinates: None, info })
}
