//! Knitted and woven cloth.

use glam::{DVec2, DVec3};
use lisle_fabric::{FlatPatch, Knit, MeshKnit, Pattern, Sleeve, Tube, UvMesh, Weave, Woven};
use pyo3::prelude::*;

use crate::convert::{array, integers, numbers, vectors};
use crate::error::Failure;
use crate::gil::detached;
use crate::yarns::Yarns;

/// A pattern by name, such as "rib-2-2", or as a chart of k and p.
fn pattern(text: &str) -> Result<Pattern, lisle_fabric::Error> {
    match (text, counts(text, "rib-")) {
        ("stockinette", _) => Ok(Pattern::stockinette()),
        ("garter", _) => Ok(Pattern::garter()),
        (_, Some((knit, purl))) => Pattern::rib(knit, purl),
        _ => Pattern::from_chart(text),
    }
}

/// A weave by name, such as "twill-2-2", or as a chart of x and o.
fn weave(text: &str) -> Result<Weave, lisle_fabric::Error> {
    match (text, counts(text, "twill-"), text.strip_prefix("satin-").and_then(|ends| ends.parse().ok())) {
        ("plain", ..) => Ok(Weave::plain()),
        (_, Some((over, under)), _) => Weave::twill(over, under),
        (_, _, Some(ends)) => Weave::satin(ends),
        _ => Weave::from_chart(text),
    }
}

/// The two numbers of a name such as "rib-2-2".
fn counts(name: &str, prefix: &str) -> Option<(usize, usize)> {
    let (first, second) = name.strip_prefix(prefix)?.split_once('-')?;
    Some((first.parse().ok()?, second.parse().ok()?))
}

/// A woven piece on an upright patch of its own size, front towards −Y, centred on the origin.
#[pyfunction]
pub fn woven_flat(
    py: Python<'_>,
    crossings: &str,
    warp: usize,
    weft: usize,
    yarn_radius: f64,
    spacing: f64,
) -> Result<Yarns, Failure> {
    let curves = detached(py, || {
        let woven = Woven::new(&weave(crossings)?, warp, weft, yarn_radius, spacing)?;
        woven.swatch(&FlatPatch { size_m: woven.size_m() })
    })?;
    Yarns::at_rest(py, curves, None, None, "woven swatch".to_owned())
}

/// A flat piece on an upright patch of its own size, front towards −Y, centred on the origin.
#[pyfunction]
pub fn knit_flat(
    py: Python<'_>,
    stitches: &str,
    courses: usize,
    wales: usize,
    yarn_radius: f64,
) -> Result<Yarns, Failure> {
    let curves = detached(py, || {
        let knit = Knit::flat(&pattern(stitches)?, courses, wales, yarn_radius)?;
        knit.swatch(&FlatPatch { size_m: knit.size_m() })
    })?;
    Yarns::at_rest(py, curves, None, None, "knitted swatch".to_owned())
}

/// A tube of its own radius about the Z axis, standing on z = 0.
#[pyfunction]
pub fn knit_tube(
    py: Python<'_>,
    stitches: &str,
    courses: usize,
    wales: usize,
    yarn_radius: f64,
) -> Result<Yarns, Failure> {
    let curves = detached(py, || {
        let knit = Knit::round(&pattern(stitches)?, courses, wales, yarn_radius)?;
        knit.swatch(&Tube { radius_m: knit.tube_radius_m(), height_m: knit.size_m().y })
    })?;
    Yarns::at_rest(py, curves, None, None, "knitted tube".to_owned())
}

/// A tube about a centre line.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called from one place in the package, by position")]
pub fn knit_sleeve(
    py: Python<'_>,
    centre_line: Vec<[f64; 3]>,
    radius: f64,
    seam_direction: [f64; 3],
    stitches: &str,
    courses: usize,
    wales: usize,
    yarn_radius: f64,
) -> Result<Yarns, Failure> {
    let curves = detached(py, || {
        let centre_line: Vec<DVec3> = centre_line.into_iter().map(DVec3::from).collect();
        let sleeve = Sleeve::new(&centre_line, radius, DVec3::from(seam_direction))?;
        Knit::round(&pattern(stitches)?, courses, wales, yarn_radius)?.swatch(&sleeve)
    })?;
    Yarns::at_rest(py, curves, None, None, "knitted sleeve".to_owned())
}

/// A sweater of at most so many control points.
#[pyfunction]
pub fn sweater(py: Python<'_>, points: usize) -> Result<Yarns, Failure> {
    let curves = detached(py, || lisle_fabric::sweater(points))?;
    Yarns::at_rest(py, curves, None, None, "knitted sweater".to_owned())
}

/// Yarns on a mesh, and what their points are bound to.
type Bound3<'py> = (Yarns, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Cloth bound to a mesh: three numbers of `triangles` and six of `uvs` for each triangle. Vertices and weights are (n, 3),
/// heights (n,).
#[pyfunction]
pub fn knit_mesh<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    normals: &Bound<'py, PyAny>,
    triangles: &Bound<'py, PyAny>,
    uvs: &Bound<'py, PyAny>,
    stitches: &str,
    yarn_radius: f64,
) -> Result<Bound3<'py>, Failure> {
    let wide = |values: Vec<[f32; 3]>| values.into_iter().map(|v| DVec3::from(v.map(f64::from))).collect();
    let uvs = numbers::<f64>("uvs", uvs)?;
    let mesh = UvMesh {
        positions: wide(vectors("positions", positions)?),
        normals: wide(vectors("normals", normals)?),
        triangles: integers::<u32>("triangles", triangles)?.as_chunks::<3>().0.to_vec(),
        uvs: uvs
            .as_chunks::<6>()
            .0
            .iter()
            .map(|[a, b, c, d, e, f]| [[*a, *b], [*c, *d], [*e, *f]].map(DVec2::from))
            .collect(),
    };
    let MeshKnit { curves, points, .. } = detached(py, || MeshKnit::new(&pattern(stitches)?, &mesh, yarn_radius))?;
    let count = points.len();
    let vertices: Vec<u32> = points.iter().flat_map(|point| point.vertices).collect();
    let weights: Vec<f32> = points.iter().flat_map(|point| point.weights).collect();
    let heights: Vec<f32> = points.iter().map(|point| point.height_m).collect();
    Ok((
        Yarns::at_rest(py, curves, None, None, "knitted mesh".to_owned())?,
        array(py, vertices, &[count, 3])?,
        array(py, weights, &[count, 3])?,
        array(py, heights, &[count])?,
    ))
}
