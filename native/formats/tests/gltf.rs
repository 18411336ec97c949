//! glTF files: what is read, what is refused, and that nothing panics.

use base64::Engine;
use lisle_core::curve::Basis;
use lisle_formats::gltf_lines::{GltfError, parse};
use lisle_formats::{UpAxis, load};

/// A file in the making: bytes of the one buffer, and JSON of views, accessors, primitives and nodes.
#[derive(Default)]
struct File {
    buffer: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
    primitives: Vec<String>,
    nodes: Option<&'static str>,
    scenes: Option<&'static str>,
}

impl File {
    /// Adds an accessor and returns its index.
    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let offset = self.buffer.len();
        self.buffer.extend(bytes);
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let view = self.views.len();
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{offset},"byteLength":{}}}"#, bytes.len()));
        let bounds = if kind == "VEC3" { r#","min":[0,0,0],"max":[9,9,9]"# } else { "" };
        self.accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":{component},"type":"{kind}","count":{count}{bounds}}}"#
        ));
        self.accessors.len() - 1
    }

    fn floats(&mut self, values: &[f32], kind: &str) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(&bytes, 5126, kind, values.len() / if kind == "VEC3" { 3 } else { 1 })
    }

    fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(&bytes, 5123, "SCALAR", values.len())
    }

    fn primitive(&mut self, mode: u32, attributes: &[(&str, usize)], indices: Option<usize>) {
        let attributes: Vec<String> = attributes.iter().map(|(name, at)| format!(r#""{name}":{at}"#)).collect();
        let indices = indices.map_or(String::new(), |at| format!(r#","indices":{at}"#));
        self.primitives.push(format!(r#"{{"mode":{mode},"attributes":{{{}}}{indices}}}"#, attributes.join(",")));
    }

    fn json(&self, uri: Option<&str>) -> String {
        let uri = uri.map_or(String::new(), |uri| format!(r#","uri":"{uri}""#));
        format!(
            r#"{{"asset":{{"version":"2.0","generator":"a test"}},"buffers":[{{"byteLength":{}{uri}}}],
            "bufferViews":[{}],"accessors":[{}],"meshes":[{{"primitives":[{}]}}],"nodes":{},"scenes":{}}}"#,
            self.buffer.len(),
            self.views.join(","),
            self.accessors.join(","),
            self.primitives.join(","),
            self.nodes.unwrap_or(r#"[{"mesh":0}]"#),
            self.scenes.unwrap_or(r#"[{"nodes":[0]}]"#),
        )
    }

    /// A `.gltf` with its buffer in a data URI.
    fn embedded(&self) -> Vec<u8> {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.buffer);
        self.json(Some(&format!("data:application/octet-stream;base64,{data}"))).into_bytes()
    }

    fn binary(&self) -> Vec<u8> {
        let mut json = self.json(None).into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        bytes.extend((28 + json.len() as u32 + self.buffer.len() as u32).to_le_bytes());
        bytes.extend((json.len() as u32).to_le_bytes());
        bytes.extend(b"JSON");
        bytes.extend(json);
        bytes.extend((self.buffer.len() as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(&self.buffer);
        bytes
    }
}

const POSITIONS: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 2.0, 3.0];
const POINTS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [0.0, 2.0, 3.0]];

const LINES: u32 = 1;
const LINE_LOOP: u32 = 2;
const LINE_STRIP: u32 = 3;
const TRIANGLES: u32 = 4;

/// A strip with radii and lengths.
fn strip() -> File {
    let mut file = File::default();
    let positions = file.floats(&POSITIONS, "VEC3");
    let radii = file.floats(&[0.1, 0.2, 0.3, 0.4], "SCALAR");
    let lengths = file.floats(&[0.0, 1.0, 3.0, 6.5], "SCALAR");
    file.primitive(LINE_STRIP, &[("POSITION", positions), ("_RADIUS", radii), ("_LENGTH", lengths)], None);
    file
}

#[test]
fn a_strip_comes_back_with_its_attributes_from_text_and_binary() {
    for bytes in [strip().embedded(), strip().binary()] {
        let loaded = parse(&bytes, None).expect("a valid file");
        assert_eq!(loaded.curves.points, POINTS);
        assert_eq!(loaded.curves.offsets, [0, 4]);
        assert_eq!(loaded.curves.closed, [false]);
        assert_eq!(loaded.curves.basis, [Basis::Linear]);
        assert_eq!(loaded.curves.radii.as_deref(), Some(&[0.1, 0.2, 0.3, 0.4][..]));
        assert_eq!(loaded.length_coordinates.as_deref(), Some(&[0.0, 1.0, 3.0, 6.5][..]));
        assert_eq!((loaded.up, loaded.info.as_str()), (UpAxis::Y, "a test"));
        loaded.curves.validate().expect("drawable curves");
    }
}

#[test]
fn loops_close_lines_chain_and_triangles_are_left_alone() {
    let mut file = File::default();
    let positions = file.floats(&POSITIONS, "VEC3");
    let (triangle, lines) = (file.indices(&[0, 1, 2]), file.indices(&[2, 3, 0, 2, 1, 1]));
    file.primitive(TRIANGLES, &[("POSITION", positions)], Some(triangle));
    file.primitive(LINE_LOOP, &[("POSITION", positions)], None);
    file.primitive(LINES, &[("POSITION", positions)], Some(lines));
    file.primitive(LINES, &[("POSITION", positions)], None);
    let curves = parse(&file.embedded(), None).expect("a valid file").curves;
    assert_eq!(curves.offsets, [0, 4, 7, 9, 11]);
    assert_eq!(curves.closed, [true, false, false, false]);
    assert_eq!(curves.points[4..7], [POINTS[0], POINTS[2], POINTS[3]]);
    assert_eq!(curves.points[7..], POINTS);
    assert_eq!(curves.radii, None);
}

#[test]
fn transforms_of_all_ancestors_are_applied() {
    let mut file = strip();
    // Twice the size, then a quarter turn about Z (x → y), then up by 10; and the mesh once more at the root.
    file.nodes = Some(
        r#"[{"children":[1],"translation":[0,0,10],"rotation":[0,0,0.70710678,0.70710678]},
            {"mesh":0,"scale":[2,2,2]},{"mesh":0}]"#,
    );
    file.scenes = Some(r#"[{"nodes":[0,2]}]"#);
    let loaded = parse(&file.embedded(), None).expect("a valid file");
    let curves = &loaded.curves;
    assert_eq!(curves.offsets, [0, 4, 8]);
    for (point, [x, y, z]) in curves.points.iter().zip(POINTS) {
        let expected = [-2.0 * y, 2.0 * x, 2.0 * z + 10.0];
        assert!((0..3).all(|axis| (point[axis] - expected[axis]).abs() < 1e-5), "{point:?} {expected:?}");
    }
    assert_eq!(curves.points[4..], POINTS);
    let (radii, lengths) = (curves.radii.as_ref().expect("radii"), loaded.length_coordinates.expect("lengths"));
    assert!((radii[3] - 0.8).abs() < 1e-6 && radii[7] == 0.4, "{radii:?}");
    assert!((lengths[3] - 13.0).abs() < 1e-5 && lengths[7] == 6.5, "{lengths:?}");
}

#[test]
fn buffers_beside_the_file_are_found_by_their_decoded_names() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let file = strip();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a file for the test");
        path
    };
    write("my yarn.bin", &file.buffer);
    let path = write("yarn.gltf", file.json(Some("my%20yarn.bin")).as_bytes());
    assert_eq!(load(path).expect("a valid file").curves.points, POINTS);

    let message = |name: &str, json: String| load(write(name, json.as_bytes())).expect_err("an error").to_string();
    let text = message("a.gltf", file.json(Some("nowhere.bin")));
    assert!(text.contains("a.gltf: glTF: buffer 0: ") && text.contains("nowhere.bin"), "{text}");
    let text = message("b.gltf", file.json(Some("http://example.org/yarn.bin")));
    assert!(text.contains("is not a file beside this one"), "{text}");
    write("short.bin", &file.buffer[..20]);
    let text = message("c.gltf", file.json(Some("short.bin")));
    assert!(text.contains("buffer 0: 20 bytes, but byteLength is 80"), "{text}");
    assert!(message("d.glb", "garbage".to_owned()).contains("d.glb: glTF: "));
}

#[test]
fn broken_files_are_refused_with_place_and_reason() {
    let refuse = |file: File, expected: &str| {
        let text = parse(&file.embedded(), None).expect_err(expected).to_string();
        assert!(text.contains(expected), "{text:?} should contain {expected:?}");
    };
    let with_indices = |mode: u32, indices: &[u16]| {
        let mut file = File::default();
        let positions = file.floats(&POSITIONS, "VEC3");
        let indices = file.indices(indices);
        file.primitive(mode, &[("POSITION", positions)], Some(indices));
        file
    };
    refuse(with_indices(LINE_STRIP, &[0, 1, 4]), "mesh 0, primitive 0: index 2 is 4, but there are 4 vertices");
    refuse(with_indices(LINES, &[0, 1, 2]), "mesh 0, primitive 0: 3 indices do not make whole lines");
    refuse(with_indices(TRIANGLES, &[0, 1, 2]), "no LINES, LINE_STRIP or LINE_LOOP");

    let mut file = strip();
    file.accessors[0] = file.accessors[0].replace("\"count\":4", "\"count\":4000000000");
    refuse(file, "accessor 0 (POSITION): its elements reach beyond its buffer view");
    let mut file = strip();
    file.accessors[1] = file.accessors[1].replace("5126", "5125");
    refuse(file, "accessor 1 (_RADIUS): Scalar of U32, expected Scalar of F32");
    let mut file = strip();
    file.accessors[1] = file.accessors[1].replace("\"count\":4", "\"count\":3");
    refuse(file, "_RADIUS has 3 values for 4 vertices");
    let mut file = strip();
    file.views[0] = file.views[0].replace("\"byteLength\":48", "\"byteLength\":480");
    refuse(file, "accessor 0 (POSITION): its buffer view reaches beyond the buffer");
    let mut file = strip();
    file.primitive(LINE_STRIP, &[("POSITION", 0), ("_LENGTH", 2)], None);
    refuse(file, "some line primitives have _RADIUS and others have not");
    let mut file = strip();
    file.nodes = Some(r#"[{"children":[1]},{"mesh":0,"children":[0]}]"#);
    refuse(file, "node 0 occurs twice");
    let mut file = strip();
    file.primitives[0] = file.primitives[0].replace("\"POSITION\":0", "\"POSITION\":7");
    refuse(file, "mesh 0, primitive 0: POSITION is accessor 7, which does not exist");
    let mut file = strip();
    file.primitives[0] = file.primitives[0].replace("\"_RADIUS\":1", "\"_RADIUS\":7");
    refuse(file, "meshes[0].primitives[0].attributes[\"_RADIUS\"]");
    let mut file = strip();
    file.scenes = Some("[]");
    assert!(matches!(parse(&file.embedded(), None), Err(GltfError::NoScene)));

    let mut binary = strip().binary();
    binary[8..12].copy_from_slice(&11_u32.to_le_bytes());
    assert!(matches!(parse(&binary, None), Err(GltfError::BinaryLength { length: 11 })));
    assert!(matches!(parse(b"", None), Err(GltfError::Document(_))));
}

#[test]
fn every_truncation_is_an_error() {
    for bytes in [strip().embedded(), strip().binary()] {
        for length in 0..bytes.len() {
            parse(&bytes[..length], None).expect_err("a truncated file");
        }
    }
}

#[test]
fn flipped_bytes_never_panic() {
    for bytes in [strip().embedded(), strip().binary()] {
        for at in 0..bytes.len() {
            for value in [0x00, b'"', b'9', b'-', 0x7f, 0xff] {
                let mut flipped = bytes.clone();
                flipped[at] = value;
                if let Ok(loaded) = parse(&flipped, None) {
                    let curves = &loaded.curves;
                    assert_eq!(curves.offsets.last().map(|&end| end as usize), Some(curves.points.len()));
                    assert!(curves.radii.as_ref().is_none_or(|radii| radii.len() == curves.points.len()));
                }
            }
        }
    }
}
