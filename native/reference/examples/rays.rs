//! Bytes and rays per second of a BCC file's fibers: `cargo run --release -p lisle-reference --example rays -- FILE [YARN] [CHORD_ERROR]`.

use std::ops::ControlFlow;
use std::time::Instant;

use glam::DVec3;
use lisle_core::Yarns;
use lisle_core::sampling::{hash_combine, unit_from_hash};
use lisle_core::yarn::Yarn;
use lisle_reference::assembly::{Assembly, Ray};
use lisle_reference::fibers::{Options, fibers};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let file = arguments.first().ok_or("a BCC file is missing")?;
    let yarn = arguments.get(1).map_or("cotton-1", String::as_str);
    let chord_error = arguments.get(2).map_or(Ok(0.25), |text| text.parse())?;
    let yarn = Yarn::preset(yarn).ok_or("no such yarn")?;
    let curves = lisle_formats::load(file)?.into_z_up().curves;
    let yarns = Yarns::new(curves, None)?;

    let start = Instant::now();
    let made = fibers(yarns.strands(), &yarn, &Options { chord_error, ..Options::default() }, &mut |_| {
        ControlFlow::Continue(())
    })?;
    let segments = made.segments();
    println!("{} fibers, {segments} segments in {:.1} s", made.len(), start.elapsed().as_secs_f64());
    let start = Instant::now();
    let assembly = Assembly::new(made, &mut || ControlFlow::Continue(()))?;
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "hierarchy in {seconds:.1} s; {} bytes, {:.1} a segment",
        assembly.bytes(),
        assembly.bytes() as f64 / segments as f64
    );

    let (center, radius) = assembly.bounds();
    let unit = |ray: u32, key: u32| unit_from_hash(hash_combine(ray, key));
    const RAYS: u32 = 1_000_000;
    let camera = |i: u32| {
        let offset = DVec3::new(unit(i, 0) - 0.5, 0.0, unit(i, 1) - 0.5) * radius;
        Ray { origin: center + offset + DVec3::NEG_Y * 3.0 * radius, direction: DVec3::Y }
    };
    let start = Instant::now();
    let hits: Vec<_> = (0..RAYS).into_par_iter().map(|i| assembly.nearest(&camera(i), f64::INFINITY)).collect();
    let seconds = start.elapsed().as_secs_f64();
    let met = hits.iter().flatten().count();
    println!(
        "camera rays: {:.2} M/s, {:.1} % hit",
        f64::from(RAYS) / seconds / 1e6,
        100.0 * met as f64 / f64::from(RAYS)
    );
    let bounced: Vec<Ray> = hits
        .iter()
        .zip(0..)
        .filter_map(|(hit, i)| {
            let surface = assembly.surface(&camera(i), hit.as_ref()?);
            let direction = lisle_core::sampling::sphere([unit(i, 2), unit(i, 3)]);
            let origin = surface.position
                + surface.cone_normal * (1e-4 * surface.radius * surface.cone_normal.dot(direction).signum());
            Some(Ray { origin, direction })
        })
        .collect();
    let start = Instant::now();
    let blocked = bounced.par_iter().filter(|ray| assembly.is_blocked(ray, f64::INFINITY)).count();
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "shadow rays: {:.2} M/s, {:.1} % blocked",
        bounced.len() as f64 / seconds / 1e6,
        100.0 * blocked as f64 / bounced.len() as f64
    );
    let start = Instant::now();
    let again = bounced.par_iter().filter(|ray| assembly.nearest(ray, f64::INFINITY).is_some()).count();
    println!("scattered rays: {:.2} M/s, {again} hit", bounced.len() as f64 / start.elapsed().as_secs_f64() / 1e6);
    Ok(())
}
