//! How soon a stopped picture is back: `cargo run --release -p lisle-reference --example stops`.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{DMat4, DVec3, DVec4, Vec3};
use lisle_core::sampling::{hash_u32, unit_from_hash};
use lisle_core::scattering::Material;
use lisle_core::scene::{Camera, Light, Object, Scene};
use lisle_core::yarn::Yarn;
use lisle_core::{Curves, Yarns};
use lisle_reference::{Error, Reference, Settings};

const STOPS: u32 = 100;

/// Rows of waves.
fn cloth() -> Result<Yarns, lisle_core::Error> {
    let point = |row: u16, i: u16| {
        let x = 0.1 * f32::from(i);
        [x, 0.3 * (3.0 * x).sin(), 0.25 * f32::from(row)]
    };
    let rows = (0..24).map(|row| (0..100).map(|i| point(row, i)).collect());
    Yarns::new(Curves::catmull_rom(rows.collect(), false), Some(0.1))
}

fn scene(yarns: Yarns) -> Option<Scene> {
    let yarn = Yarn::preset("silk-1")?;
    let (middle, extent) = (DVec3::new(5.0, 0.0, 3.0), 10.0);
    // Along +Y from outside, orthographic.
    let turn = DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let object = Object {
        name: "yarn".into(),
        id: 1,
        yarns: Arc::new(yarns),
        yarn: Arc::new(yarn),
        material: Arc::new(Material::preset("cotton")?),
        world_from_object: DMat4::IDENTITY,
        labels: Default::default(),
        is_holdout: false,
    };
    Some(Scene {
        objects: vec![object],
        meshes: Vec::new(),
        lights: vec![Light::Sun {
            direction: DVec3::new(0.3, 1.0, -1.0),
            irradiance: Vec3::splat(3.0),
            angle_rad: 0.1,
        }],
        ambient: Vec3::splat(0.2),
        environment: None,
        camera: Camera {
            world_from_camera: DMat4::from_translation(middle - DVec3::Y * extent) * turn,
            clip_from_camera: DMat4::from_cols(
                DVec4::X * (2.0 / extent),
                DVec4::Y * (2.0 / extent),
                DVec4::Z * (-2.0 / (3.0 * extent)),
                DVec4::new(0.0, 0.0, -1.0, 1.0),
            ),
            lens: None,
        },
    })
}

/// Draws until a time has passed; how long that took after it.
fn late(scene: &Scene, settings: &Settings, stop: Duration) -> Result<(Duration, Duration), Error> {
    let start = Instant::now();
    let (mut asked, mut longest) = (start, Duration::ZERO);
    let mut go_on = || {
        longest = longest.max(asked.elapsed());
        asked = Instant::now();
        if start.elapsed() < stop { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let mut draw = || {
        let reference = Reference::new(scene, settings, &mut go_on)?;
        let preparing = start.elapsed();
        let mut film = reference.film();
        reference.render(&mut film, &mut |_| go_on())?;
        if stop == Duration::MAX {
            println!("{:.2} s of preparation", preparing.as_secs_f64());
        }
        Ok(())
    };
    match draw() {
        Ok(()) | Err(Error::Cancelled) => Ok((start.elapsed().saturating_sub(stop), longest)),
        Err(error) => Err(error),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = scene(cloth()?).ok_or("no preset")?;
    let settings = Settings { size: [320, 320], samples: 1, ..Settings::default() };

    let start = Instant::now();
    let (_, longest) = late(&scene, &settings, Duration::MAX)?;
    let whole = start.elapsed();
    println!("{:.2} s for a picture, {:.0} ms at most between two questions", whole.as_secs_f64(), ms(longest));
    let mut found = Vec::new();
    for number in 0..STOPS {
        let stop = whole.mul_f64(unit_from_hash(hash_u32(number)));
        found.push((late(&scene, &settings, stop)?.0, stop));
    }
    found.sort();
    let (worst, at) = found[found.len() - 1];
    println!(
        "{STOPS} stops: back after {:.0} ms (median), {:.0} ms (most, stopped after {:.2} s)",
        ms(found[found.len() / 2].0),
        ms(worst),
        at.as_secs_f64()
    );
    Ok(())
}

fn ms(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}
