//! BCC files: what is read, what is refused, and that nothing panics.

use lisle_core::curve::Basis;
use lisle_formats::bcc::{BccError, parse};
use lisle_formats::{Error, UpAxis, load};
use std::io::Write;
use std::path::PathBuf;

/// The bytes of a file with these curves: points, and whether the curve is closed.
fn file(curve_type: &[u8; 2], up: u8, curves: &[(Vec<[f32; 3]>, bool)]) -> Vec<u8> {
    let mut bytes = b"BCC\x44".to_vec();
    bytes.extend(curve_type);
    bytes.extend([3, up]);
    bytes.extend((curves.len() as u64).to_le_bytes());
    bytes.extend(curves.iter().map(|(points, _)| points.len() as u64).sum::<u64>().to_le_bytes());
    let mut info = [0; 40];
    info[..11].copy_from_slice(b"a test file");
    bytes.extend(info);
    for (points, closed) in curves {
        let count = points.len() as i32;
        bytes.extend(if *closed { -count } else { count }.to_le_bytes());
        bytes.extend(points.iter().flatten().flat_map(|coordinate| coordinate.to_le_bytes()));
    }
    bytes
}

fn points(n: usize) -> Vec<[f32; 3]> {
    (0..n).map(|i| [i as f32, 0.5 * i as f32, (i * i) as f32]).collect()
}

fn two_curves() -> Vec<u8> {
    file(b"C0", 1, &[(points(4), false), (points(6), true)])
}

#[test]
fn curves_come_back_as_written() {
    let loaded = parse(&two_curves()).expect("a valid file");
    assert_eq!(loaded.up, UpAxis::Y);
    assert_eq!(loaded.info, "a test file");
    assert_eq!(loaded.curves.points, [points(4), points(6)].concat());
    assert_eq!(loaded.curves.offsets, [0, 4, 10]);
    assert_eq!(loaded.curves.closed, [false, true]);
    assert_eq!(loaded.curves.basis, [Basis::CatmullRom, Basis::CatmullRom]);
    assert_eq!(loaded.curves.radii, None);

    let spline = parse(&file(b"BS", 2, &[(points(5), false)])).expect("a valid file");
    assert_eq!((spline.up, &spline.curves.basis[..]), (UpAxis::Z, &[Basis::BSpline][..]));
}

#[test]
fn broken_files_are_refused_with_place_and_reason() {
    let broken = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = two_curves();
        change(&mut bytes);
        parse(&bytes).expect_err("a broken file")
    };
    type Change<'a> = &'a dyn Fn(&mut Vec<u8>);
    let cases: &[(Change, BccError)] = &[
        (&|b| b[0] = b'X', BccError::BadMagic { found: "XCC".into() }),
        (&|b| b.clear(), BccError::BadMagic { found: String::new() }),
        (&|b| b.truncate(63), BccError::TruncatedHeader { bytes: 63 }),
        (&|b| b[3] = 0x88, BccError::NumberFormat { code: 0x88 }),
        (&|b| b[4..6].copy_from_slice(b"CX"), BccError::CurveType { code: "CX".into() }),
        (&|b| b[6] = 2, BccError::Dimensions { found: 2 }),
        (&|b| b[7] = 0, BccError::UpAxis { code: 0 }),
        (&|b| b[8..16].fill(0xff), BccError::TooMany { curves: u64::MAX, points: 10 }),
        (&|b| b[16..24].fill(0x7f), BccError::TooMany { curves: 2, points: 0x7f7f_7f7f_7f7f_7f7f }),
        (&|b| b[16] = 9, BccError::CurveTooLong { offset: 116, curve: 1, points: 6, left: 5 }),
        (&|b| b[16] = 11, BccError::Truncated { bytes: 192, expected: 204, curves: 2, points: 11 }),
        (&|b| b.truncate(191), BccError::Truncated { bytes: 191, expected: 192, curves: 2, points: 10 }),
        (&|b| b.push(0), BccError::TrailingBytes { offset: 192, count: 1 }),
        (&|b| b[64] = 11, BccError::CurveTooLong { offset: 64, curve: 0, points: 11, left: 10 }),
        (
            &|b| b[64..68].copy_from_slice(&i32::MIN.to_le_bytes()),
            BccError::CurveTooLong { offset: 64, curve: 0, points: 1 << 31, left: 10 },
        ),
        (&|b| b[116..120].copy_from_slice(&5_i32.to_le_bytes()), BccError::PointCount { expected: 10, found: 9 }),
        // A header of 4 billion points is refused before memory is claimed for them.
        (
            &|b| b[16..20].fill(0xff),
            BccError::Truncated { bytes: 192, expected: 64 + 8 + 12 * 0xffff_ffff, curves: 2, points: 0xffff_ffff },
        ),
    ];
    for (change, expected) in cases {
        assert_eq!(&broken(change), expected);
    }
}

#[test]
fn every_truncation_is_an_error() {
    let bytes = two_curves();
    for length in 0..bytes.len() {
        parse(&bytes[..length]).expect_err("a truncated file");
    }
}

#[test]
fn flipped_bytes_never_panic() {
    let bytes = two_curves();
    for at in 0..bytes.len() {
        for value in [0x00, 0x01, 0x7f, 0x80, 0xff] {
            let mut flipped = bytes.clone();
            flipped[at] = value;
            if let Ok(loaded) = parse(&flipped) {
                assert_eq!(loaded.curves.points.len(), 10);
                assert_eq!(loaded.curves.offsets.last(), Some(&10));
            }
        }
    }
}

#[test]
fn errors_name_the_file() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let folder = folder.path();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("a file for the test");
        path
    };
    // By content, whatever the extension; by extension, if the content says nothing.
    assert!(load(write("curves.bin", &two_curves())).is_ok());
    let message = |path: PathBuf| load(path).expect_err("an error").to_string();
    let text = message(write("broken.bcc", b"garbage"));
    assert!(text.contains("broken.bcc: BCC: offset 0"), "{text}");
    assert!(message(write("other.obj", b"garbage")).contains("other.obj: neither BCC nor glTF"));
    assert!(message(folder.join("missing.bcc")).contains("missing.bcc"));
    assert!(matches!(load(folder.join("missing.bcc")), Err(Error::Read { .. })));
}

/// Figures of the real yarns, computed elsewhere: up, curves, closed, points, shortest and longest curve,
/// half extents, length of the open polylines through the control points (a closed curve's last step left out).
type Figures = (&'static str, UpAxis, usize, usize, usize, [usize; 2], [f64; 3], f64);

const REAL: [Figures; 5] = [
    ("openwork_trellis_pattern", UpAxis::Z, 1, 0, 19_730, [19_730, 19_730], [10.844, 7.302, 0.570], 2_734.7),
    ("flame_ribbing_pattern", UpAxis::Z, 1, 0, 49_745, [49_745, 49_745], [15.777, 16.513, 0.616], 10_858.2),
    ("glove", UpAxis::Y, 70, 70, 58_545, [299, 1_226], [13.901, 17.328, 12.997], 13_918.8),
    ("alien_sweater", UpAxis::Y, 146, 146, 139_528, [427, 2_550], [25.758, 19.549, 12.276], 30_154.1),
    ("sweater_flame_ribbing", UpAxis::Y, 253, 253, 271_978, [11, 2_455], [46.477, 24.795, 11.719], 57_472.6),
];

#[test]
fn real_yarns_have_their_known_figures() {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    let folder = std::env::var_os("LISLE_DATA").map_or_else(|| PathBuf::from(default), PathBuf::from).join("yarns");
    if !folder.is_dir() {
        // Not by a macro, whose lines a passing test keeps to itself.
        let _ = writeln!(std::io::stderr(), "skipped: no data ({})", folder.display());
        return;
    }
    for (name, up, curves, closed, points, lengths, half_extents, length) in REAL {
        let loaded = load(folder.join(name).with_extension("bcc")).expect(name);
        let yarns = &loaded.curves;
        yarns.validate().expect(name);
        assert_eq!(loaded.up, up, "{name}");
        assert_eq!((yarns.len(), yarns.points.len()), (curves, points), "{name}");
        assert_eq!(yarns.closed.iter().filter(|&&closed| closed).count(), closed, "{name}");
        let counts = || (0..yarns.len()).map(|curve| yarns.range(curve).len());
        assert_eq!([counts().min(), counts().max()], lengths.map(Some), "{name}");
        for axis in 0..3 {
            let values = || yarns.points.iter().map(|point| f64::from(point[axis]));
            let half = 0.5 * (values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min));
            assert!((half - half_extents[axis]).abs() < 6e-4, "{name}, axis {axis}: {half}");
        }
        let total: f64 = (0..yarns.len())
            .map(|curve| {
                let points = &yarns.points[yarns.range(curve)];
                (0..points.len() - 1)
                    .map(|i| {
                        let (a, b) = (points[i], points[i + 1]);
                        (0..3).map(|k| (f64::from(b[k]) - f64::from(a[k])).powi(2)).sum::<f64>().sqrt()
                    })
                    .sum::<f64>()
            })
            .sum();
        assert!((total - length).abs() < 0.06, "{name}: length {total}");
    }
}
