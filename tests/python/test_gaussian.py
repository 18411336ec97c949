"""Spherical-Gaussian light: the renderer beside the path tracer, and at its ends."""

from math import pi

import lisle
import numpy as np
import pytest

SIZE = (24, 18)
DOWN = (0.4, 0.9, -0.6)


@pytest.fixture(scope="module")
def fiber():
    """One fiber without turns, near, so thin that its yarn keeps no light from it: nothing is approximated there."""
    x = np.linspace(-8, 8, 17)
    yarns = lisle.Yarns(np.column_stack([x, 0 * x, 0 * x]), [0, 17], yarn_radius=1.0)
    yarn = lisle.Yarn.preset("silk-1").replace(loop_density=0.0, hair_density=0.0, plies=1, fibers_per_ply=1)
    yarn = yarn.replace(fiber_radius=2e-4, fiber_twist=1e4, ply_twist=1e4, r_min=1.0)
    material = lisle.Material.preset("cotton").replace(beta_r_deg=12.0)
    made = lisle.fibers(yarns, yarn)
    radius = float(made.radii[0])
    middle = made.points[np.abs(made.points[:, 0]).argmin()] + np.outer([-4 * radius, 0, 4 * radius], [1, 0, 0])
    camera = lisle.Camera.fit(lisle.Yarns(middle, [0, 3], yarn_radius=radius), (0.1, -1, 0.2), SIZE)
    return yarns, yarn, material, camera


@pytest.fixture
def lit(fiber):
    yarns, yarn, material, camera = fiber

    def lit(*lights, ambient=0.0):
        scene = lisle.Scene(camera, lights, (ambient,) * 3)
        scene.add(yarns, yarn, material)
        return scene

    return lit


def colour(image):
    """Mean over what is covered."""
    return image["combined"][..., :3].sum((0, 1), dtype=np.float64) / image["alpha"].sum(dtype=np.float64)


def by_path_tracer(scene, **options):
    """Mean colours, and their standard errors."""
    image = lisle.Reference().render(scene, **{"samples": 4096, "bounces": 1, **options})
    error = np.sqrt(image["variance"].sum((0, 1), dtype=np.float64)) / image["alpha"].sum(dtype=np.float64)
    return colour(image), error


def by_renderer(renderer, scene):
    return colour(renderer.render(scene, samples=512, transport_photons=0, lod_pixels=0, shadow_resolution=256))


def agree(found, expected, errors):
    """Within the path tracer's noise, and 0.4 %: of 512 directions, and of the tables of a fiber's normalisers."""
    assert np.all(errors < 0.004 * expected), "the noise hides what is wrong"
    return bool(np.all(np.abs(found - expected) < 4 * errors + 0.004 * expected))


@pytest.mark.parametrize("sharpness", [0.01, 3.0, 40.0, 1e5])
def test_a_fiber_is_as_bright_by_both(renderer, lit, sharpness):
    def light(**changes):
        return lit(lisle.Gaussian(**{"direction": DOWN, "strength": 3.0, "sharpness": sharpness, **changes}))

    found = by_renderer(renderer, light())
    expected, errors = by_path_tracer(light())
    print(sharpness, found / expected - 1, errors / expected)
    assert agree(found, expected, errors)
    for changes in ({"strength": 3.15}, {"color": (1.0, 1.0, 0.9)}, {"sharpness": 10.0}):
        assert not agree(by_renderer(renderer, light(**changes)), expected, errors), changes


def test_at_its_ends_it_is_a_sun_and_an_even_sky(renderer, lit):
    sharp, sun = lit(lisle.Gaussian(DOWN, 3.0, 1e5)), lit(lisle.Sun(DOWN, 3.0))
    wide, sky = lit(lisle.Gaussian(DOWN, 4 * pi * 0.7, 1e-6)), lit(ambient=0.7)
    for scene, other in ((sharp, sun), (wide, sky)):
        expected, errors = by_path_tracer(other)
        found, own = by_path_tracer(scene, seed=1)
        assert agree(found, expected, np.hypot(errors, own))
        assert agree(by_renderer(renderer, scene), by_renderer(renderer, other), 0 * errors)
    assert not agree(by_renderer(renderer, wide), by_renderer(renderer, sharp), np.zeros(3))
