//! Cloth on meshes: where its stitches are, where it is closed, and what is refused.

use crate::distance::{Polyline, closest_approach};
use crate::{Error, FlatPatch, Knit, MeshKnit, Pattern, Surface, Tube, UvMesh};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

const RADIUS_M: f64 = 1e-3;

/// A grid of triangles on a surface; joined at the seam where the last column of vertices is the first.
fn mesh_of(surface: &impl Surface, columns: usize, rows: usize, joined: bool) -> UvMesh {
    let uv = |column: usize, row: usize| DVec2::new(column as f64 / columns as f64, row as f64 / rows as f64);
    let width = if joined { columns } else { columns + 1 };
    let vertex = |column: usize, row: usize| (row * width + column % width) as u32;
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for row in 0..=rows {
        for column in 0..width {
            let uv = uv(column, row);
            positions.push(surface.position(uv.x, uv.y));
            normals.push(surface.normal(uv.x, uv.y));
        }
    }
    let (mut triangles, mut uvs) = (Vec::new(), Vec::new());
    for row in 0..rows {
        for column in 0..columns {
            let corner = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[x, y]| [column + x, row + y]);
            for three in [[0, 1, 2], [0, 2, 3]] {
                triangles.push(three.map(|k: usize| vertex(corner[k][0], corner[k][1])));
                uvs.push(three.map(|k: usize| uv(corner[k][0], corner[k][1])));
            }
        }
    }
    UvMesh { positions, normals, triangles, uvs }
}

fn patch_of(knit: &Knit) -> UvMesh {
    mesh_of(&FlatPatch { size_m: knit.size_m() }, 5, 3, false)
}

#[test]
fn cloth_on_a_flat_mesh_is_a_swatch() {
    for pattern in [Pattern::stockinette(), Pattern::rib(2, 2).expect("a rib")] {
        let knit = Knit::flat(&pattern, 9, 12, RADIUS_M).expect("cloth");
        let size_m = knit.size_m();
        let on_mesh = MeshKnit::new(&pattern, &patch_of(&knit), RADIUS_M).expect("cloth");
        // Loops reach beyond the stitches' own cells, by less than one.
        let [courses, wales] = on_mesh.stitches;
        assert!((9..=10).contains(&courses) && (12..=13).contains(&wales), "{:?}", on_mesh.stitches);
        let same = Knit::flat(&pattern, courses, wales, RADIUS_M).expect("cloth");
        let swatch = same.swatch(&FlatPatch { size_m }).expect("a swatch");
        assert_eq!(on_mesh.curves.offsets, swatch.offsets);
        for (a, b) in on_mesh.curves.points.iter().zip(&swatch.points) {
            let [a, b] = [a, b].map(|p| DVec3::from(p.map(f64::from)));
            assert!(a.distance(b) < 1e-7, "{a} {b}");
        }
        on_mesh.curves.validate().expect("drawable curves");
    }
}

#[test]
fn a_tube_is_closed_and_its_yarns_do_not_intersect() {
    let knit = Knit::round(&Pattern::stockinette(), 12, 40, RADIUS_M).expect("cloth");
    // Around the middle of the cloth, as a mesh of a sleeve is modelled.
    let radius_m = knit.size_m().x / (2.0 * PI) * 1.1;
    let tube = Tube { radius_m, height_m: knit.size_m().y };
    let on_mesh = MeshKnit::new(&Pattern::stockinette(), &mesh_of(&tube, 256, 4, true), RADIUS_M).expect("cloth");
    let [courses, wales] = on_mesh.stitches;
    assert!((43..=45).contains(&wales), "{wales}");
    assert_eq!(on_mesh.curves.len(), courses);
    assert!(on_mesh.curves.closed.iter().all(|&closed| closed));
    let yarns: Vec<Polyline> = (0..courses)
        .map(|course| {
            let points = on_mesh.curves.points[on_mesh.curves.range(course)].iter();
            let control: Vec<DVec3> = points.map(|p| DVec3::from(p.map(f64::from)) / RADIUS_M).collect();
            Polyline::from_catmull_rom(&control, true, 6)
        })
        .collect();
    // Counts are whole and facets flat, so that stitches are a few percent off their natural size.
    let closest = closest_approach(&yarns, 3.0, PI).expect("yarns touch");
    assert!(closest > 1.85, "{closest}");
    // With its seam left open the same tube is a wrapped flat piece.
    let open = MeshKnit::new(&Pattern::stockinette(), &mesh_of(&tube, 256, 4, false), RADIUS_M).expect("cloth");
    assert!(open.curves.closed.iter().all(|&closed| closed), "vertices that lie on each other count as one");
    let half = |u: f64, v: f64| tube.position(0.5 * u, v);
    let open = MeshKnit::new(&Pattern::stockinette(), &mesh_of(&half, 128, 4, false), RADIUS_M).expect("cloth");
    assert!(open.curves.closed.iter().all(|&closed| !closed));
}

#[test]
fn cloth_follows_the_mesh() {
    let knit = Knit::flat(&Pattern::garter(), 6, 6, RADIUS_M).expect("cloth");
    let mesh = patch_of(&knit);
    let on_mesh = MeshKnit::new(&Pattern::garter(), &mesh, RADIUS_M).expect("cloth");
    let turn = glam::DAffine3::from_rotation_translation(
        glam::DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 1.1),
        DVec3::new(0.3, 0.1, -0.2),
    );
    let positions: Vec<DVec3> = mesh.positions.iter().map(|p| turn.transform_point3(*p)).collect();
    let normals: Vec<DVec3> = mesh.normals.iter().map(|n| turn.transform_vector3(*n)).collect();
    for (point, rest) in on_mesh.points.iter().zip(&on_mesh.curves.points) {
        let expected = turn.transform_point3(DVec3::from(rest.map(f64::from)));
        assert!(point.position(&positions, &normals).distance(expected) < 1e-7);
        assert!((point.weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn courses_end_at_holes_and_at_the_borders_of_islands() {
    let knit = Knit::flat(&Pattern::stockinette(), 8, 12, RADIUS_M).expect("cloth");
    let mut mesh = mesh_of(&FlatPatch { size_m: knit.size_m() }, 6, 1, false);
    let whole = MeshKnit::new(&Pattern::stockinette(), &mesh, RADIUS_M).expect("cloth");
    // The third column of squares goes.
    mesh.triangles.drain(4..6);
    mesh.uvs.drain(4..6);
    let holed = MeshKnit::new(&Pattern::stockinette(), &mesh, RADIUS_M).expect("cloth");
    assert_eq!(holed.curves.len(), 2 * whole.curves.len());
    assert!((holed.points.len() as f64 / whole.points.len() as f64 - 5.0 / 6.0).abs() < 0.02);
    // Two islands side by side in the map, the right one elsewhere on a mesh of its own.
    let mut mesh = mesh_of(&FlatPatch { size_m: knit.size_m() }, 6, 1, false);
    let count = mesh.positions.len() as u32;
    let shifted: Vec<DVec3> = mesh.positions.iter().map(|p| *p + DVec3::X).collect();
    mesh.positions.extend(shifted);
    mesh.normals.extend(mesh.normals.clone());
    for triangle in &mut mesh.triangles[6..] {
        *triangle = triangle.map(|vertex| vertex + count);
    }
    let apart = MeshKnit::new(&Pattern::stockinette(), &mesh, RADIUS_M).expect("cloth");
    assert_eq!(apart.curves.len(), 2 * whole.curves.len());
    for curve in 0..apart.curves.len() {
        let points = &apart.curves.points[apart.curves.range(curve)];
        let longest =
            points.windows(2).map(|w| DVec3::from(w[0].map(f64::from)).distance(DVec3::from(w[1].map(f64::from))));
        assert!(longest.fold(0.0, f64::max) < 3.0 * RADIUS_M, "curve {curve} jumps");
    }
}

#[test]
fn corners_that_were_rounded_twice_do_not_cut_the_map() {
    let knit = Knit::flat(&Pattern::stockinette(), 8, 12, RADIUS_M).expect("cloth");
    let exact = mesh_of(&FlatPatch { size_m: knit.size_m() }, 6, 6, false);
    let mut rounded = exact.clone();
    for (i, uv) in rounded.uvs.iter_mut().flatten().enumerate() {
        *uv += DVec2::splat((i % 3) as f64 * 6e-8);
    }
    let [exact, rounded] = [exact, rounded]
        .map(|mesh| MeshKnit::new(&Pattern::stockinette(), &mesh, RADIUS_M).expect("cloth").curves.offsets);
    assert_eq!(exact, rounded);
}

#[test]
fn what_cannot_be_knitted_is_refused_by_name() {
    let knit = Knit::flat(&Pattern::stockinette(), 8, 12, RADIUS_M).expect("cloth");
    let mesh = patch_of(&knit);
    let error =
        |mesh: &UvMesh, radius_m: f64| MeshKnit::new(&Pattern::stockinette(), mesh, radius_m).expect_err("an error");
    assert!(matches!(error(&mesh, 0.0), Error::YarnRadius { .. }));
    assert!(matches!(error(&mesh, 1.0), Error::NoStitches { .. }));
    let empty = UvMesh { triangles: Vec::new(), uvs: Vec::new(), ..mesh.clone() };
    assert!(error(&empty, RADIUS_M).to_string().contains("no faces"));
    let flat = UvMesh { uvs: vec![[DVec2::ZERO; 3]; mesh.uvs.len()], ..mesh.clone() };
    assert!(error(&flat, RADIUS_M).to_string().contains("no area"));
    let mut broken = mesh.clone();
    broken.positions[3].x = f64::NAN;
    assert!(error(&broken, RADIUS_M).to_string().contains("vertex 3 is not finite"));
    let mut beyond = mesh.clone();
    beyond.triangles[1][2] = 999;
    assert!(error(&beyond, RADIUS_M).to_string().contains("triangle 1"));
    // The upper half mirrored onto the lower one, as maps of symmetric meshes often are.
    let mut mirrored = mesh_of(&FlatPatch { size_m: knit.size_m() }, 4, 4, false);
    for uv in mirrored.uvs.iter_mut().flatten() {
        uv.y = if uv.y > 0.5 { 1.0 - uv.y } else { uv.y };
    }
    assert!(matches!(error(&mirrored, RADIUS_M), Error::OverlappingUvs { .. }), "{:?}", error(&mirrored, RADIUS_M));
}
