"""Light scattered more than once: the renderer's tables beside the path tracer's paths."""

import lisle
import numpy as np
import pytest

SIZE = (64, 48)

BOUND = 0.18
"""Of the mean colour. These are within 15 %, as in the pages of `cargo xtask fidelity`; the rest is noise of the
reference, which has a standard error of 2 %."""


@pytest.fixture(scope="module")
def cloth():
    return lisle.knit_swatch(courses=5, wales=4, yarn_radius=1.0)


@pytest.fixture
def lit(cloth):
    """A cloth of bare fibers under a sun, near."""

    def lit(material, direction):
        camera = lisle.Camera.fit(cloth, direction=(0.1, -1, 0.2), size=SIZE)
        scene = lisle.Scene(camera, [lisle.Sun(direction=direction, strength=3.0)], (0, 0, 0))
        scene.add(cloth, lisle.Yarn.preset("cotton-1"), lisle.Material.preset(material))
        return scene

    return lit


def mean(image):
    return image["combined"][..., :3].mean((0, 1), dtype=np.float64)


@pytest.mark.parametrize(
    ("material", "direction"), [("cotton", (0.3, 1, -0.4)), ("silk-1", (0.3, 1, -0.4)), ("cotton", (0.2, -1, -0.4))]
)
def test_cloth_has_the_colour_of_all_paths(renderer, lit, material, direction):
    scene = lit(material, direction)
    expected = mean(lisle.Reference().render(scene, samples=48))
    if material == "cotton":
        # Nearly white: what its channels differ by is noise, of few paths that are very bright.
        expected[:] = expected.mean()
    drawn = mean(renderer.render(scene, samples=16, transport_photons=200_000))
    once = mean(renderer.render(scene, samples=16, transport_photons=0))
    print(material, direction, drawn / expected - 1, once / expected - 1)
    assert np.all(np.abs(drawn / expected - 1) < BOUND), drawn / expected - 1
    assert np.all(np.abs(once / expected - 1) > BOUND), "light scattered once passes as all of it"


def test_more_photons_are_the_same_light_with_less_noise(renderer, lit):
    scene = lit("silk-1", (0.3, 1, -0.4))
    few, many, most = (
        mean(renderer.render(scene, samples=4, transport_photons=photons)) for photons in (20_000, 200_000, 800_000)
    )
    assert np.all(np.abs(few / most - 1) < 0.06)
    assert np.all(np.abs(many / most - 1) < 0.04)
    assert not np.array_equal(few, many)


def test_progress_counts_tables_and_samples(renderer, lit):
    scene = lit("fleece", (0.3, 1, -0.4))
    for first in (True, False):
        seen: list[float] = []
        renderer.render(scene, samples=3, transport_photons=41_000, progress=seen.append)
        assert seen == sorted(seen) and seen[-1] == 1
        # It is called in between as well; each batch of photons and each sample is a step.
        assert len({fraction for fraction in seen if fraction > 0}) == (3 + 3 if first else 3), seen


def test_simple_shading_has_no_tables(renderer, lit):
    scene = lit("polyester-1", (0.3, 1, -0.4))
    seen: list[float] = []
    picture = renderer.render(scene, samples=2, shading="simple", progress=seen.append)
    assert {fraction for fraction in seen if fraction > 0} == {0.5, 1.0}
    same = renderer.render(scene, samples=2, shading="simple", transport_photons=0)
    assert np.array_equal(picture["combined"], same["combined"])
