//! The visibility buffer with 64-bit atomics and with two passes of 32-bit ones: the same picture to the bit.

mod support;

use std::sync::OnceLock;

use glam::DVec3;
use lisle_gpu::{Image, Renderer, Scene, Settings, Shading};
use support::{
    curves, draw_with, exact, looking, measure, object, orthographic, perspective, preset, scene, sun, yarns_of,
};

const SIZE: [u32; 2] = [120, 80];

fn narrow() -> &'static Renderer {
    static RENDERER: OnceLock<Renderer> = OnceLock::new();
    RENDERER.get_or_init(|| Renderer::with_narrow_atomics(None).expect("an adapter"))
}

/// Scenes with single fibers, with core fibers, with both, and with several objects in one pixel.
fn cases() -> Vec<(&'static str, Scene, Settings)> {
    let yarns = yarns_of(curves::wave(4.0, 0.25, 60), false, 0.3);
    let ring = yarns_of(curves::ring(80), true, 0.2);
    let view = looking(DVec3::new(0.3, -3.0, 0.5), DVec3::ZERO);
    let one = |camera| scene(vec![object(&yarns, &preset("cotton-1"))], camera);
    let near = perspective(view, 0.2, SIZE, [0.0, 0.0]);
    let far = perspective(view, 1.2, SIZE, [0.0, 0.0]);
    let middle = perspective(view, 0.8, SIZE, [0.0, 0.0]);
    let mut crowd = one(orthographic(view, 3.0, SIZE, [0.1, 0.0]));
    crowd.objects.push(object(&ring, &preset("rayon-4")));
    crowd.objects.push(lisle_gpu::Object { id: 7, ..object(&ring, &preset("rayon-4")) });
    crowd.lights.push(sun([1.0, 1.0, -1.0], 2.0));
    let lod = |lod_pixels| Settings { lod_pixels, samples: 3, filter_width: 1.5, ..exact(SIZE) };
    vec![
        ("every fiber", one(near), exact(SIZE)),
        ("core fibers alone", one(far), lod(60.0)),
        ("core and fibers", one(middle), lod(1.0)),
        ("three objects", crowd.clone(), Settings { shading: Shading::Simple, ..lod(2.0) }),
        ("three objects, two tiles", crowd, Settings { size: [2100, 16], ..exact(SIZE) }),
    ]
}

fn pair(scene: &Scene, settings: &Settings) -> [Image; 2] {
    [draw_with(support::renderer(), scene, settings), draw_with(narrow(), scene, settings)]
}

#[test]
fn wide_and_narrow_atomics_give_the_same_bits() {
    assert!(support::renderer().adapter().wide_atomics, "this adapter has no 64-bit atomics: nothing is compared");
    for (name, scene, settings) in cases() {
        let [wide, narrow] = pair(&scene, &settings);
        assert!(measure::area(&wide) > 100.0, "{name}: nothing is drawn");
        assert_eq!(measure::difference(&wide, &narrow), None, "{name}");
    }
}

#[test]
fn the_comparison_sees_a_single_bit() {
    let (_, scene, settings) = &cases()[0];
    let [wide, mut narrow] = pair(scene, settings);
    let value = &mut narrow.depth[40 * 120 + 60];
    *value = f32::from_bits(value.to_bits() ^ 1);
    assert!(measure::difference(&wide, &narrow).is_some());
}
