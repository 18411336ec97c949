"""The measures of `cargo xtask fidelity` notice what is wrong, and by how much."""

import sys

import lisle
import numpy as np
import pytest
from conftest import REPOSITORY

pytest.importorskip("flip_evaluator", reason="flip-evaluator is not installed")
sys.path.append(str(REPOSITORY / "tests" / "fidelity"))

import measures
import models

COVERED = np.ones((32, 32), bool)


@pytest.fixture
def reference():
    x, y = np.meshgrid(np.linspace(0, 9, 32), np.linspace(0, 7, 32))
    return np.stack([1.2 + np.sin(x), 1.5 + np.cos(y), 1.1 + np.sin(x + y)], axis=2)


def test_a_picture_beside_itself_has_no_error(reference):
    assert measures.mean_error(reference, reference) == 0
    assert measures.rmse(reference, reference) == 0
    assert measures.flip(reference, reference, COVERED)[0] == 0


def test_brightness_is_measured_with_its_sign(reference):
    for factor in (0.9, 1.03):
        picture = factor * reference
        assert measures.mean_error(picture, reference) == pytest.approx(factor - 1)
        assert measures.rmse(picture, reference) == pytest.approx(abs(factor - 1))
        assert measures.flip(picture, reference, COVERED)[0] > 0.005


def test_another_hue_of_the_same_brightness_is_an_error(reference):
    shifted = reference.mean() * np.array([1.1, 1.0, 0.9]) * np.ones_like(reference)
    grey = np.full_like(reference, reference.mean())
    assert abs(measures.mean_error(shifted, grey)) == pytest.approx(0.1 * np.sqrt(2 / 3))


def test_a_shift_leaves_the_mean_and_not_the_rest(reference):
    moved = np.roll(reference, 5, axis=1)
    assert measures.mean_error(moved, reference) == pytest.approx(0, abs=1e-12)
    assert measures.rmse(moved, reference) > 0.3
    assert measures.flip(moved, reference, COVERED)[0] > 0.1


def test_flip_is_that_of_what_is_covered(reference):
    half = COVERED.copy()
    half[:, :16] = False
    wrong = reference.copy()
    wrong[:, 24:] *= 0.5
    everywhere, within = (measures.flip(wrong, reference, covered)[0] for covered in (COVERED, half))
    assert within > 1.5 * everywhere


def test_noise_is_that_which_its_variance_makes(reference):
    random = np.random.default_rng(3)
    variance = (0.2 * reference) ** 2
    pictures = [reference + random.normal(size=reference.shape) * np.sqrt(variance) for _ in range(200)]
    clipped = [np.maximum(picture, 0) for picture in pictures]
    means = np.array([picture.mean(axis=(0, 1)) for picture in pictures])
    found = np.linalg.norm(means.std(axis=0)) / np.linalg.norm(reference.mean(axis=(0, 1)))
    assert measures.mean_noise(variance, reference) == pytest.approx(found, rel=0.15)
    assert measures.mean_noise(2 * variance, reference) != pytest.approx(found, rel=0.15)
    rmse = np.mean([measures.rmse(picture, reference) for picture in clipped])
    assert measures.rmse_noise(variance, reference) == pytest.approx(rmse, rel=0.03)
    flip = np.mean([measures.flip(picture, reference, COVERED)[0] for picture in clipped[:10]])
    assert measures.flip_noise(variance, reference, COVERED) == pytest.approx(flip, rel=0.1)
    assert measures.flip_noise(0.25 * variance, reference, COVERED) < 0.7 * flip


def test_what_is_no_picture_is_refused(reference):
    black = np.zeros_like(reference)
    broken = reference.copy()
    broken[3, 4, 1] = np.nan
    for measure in (measures.mean_error, measures.rmse, measures.mean_noise, measures.rmse_noise):
        with pytest.raises(ValueError, match="shape"):
            measure(reference[:-1], reference)
        with pytest.raises(ValueError, match="shape"):
            measure(reference[..., 0], reference[..., 0])
        with pytest.raises(ValueError, match="finite"):
            measure(broken, reference)
        with pytest.raises(ValueError, match="less than 0"):
            measure(-reference, reference)
        with pytest.raises(ValueError, match="black"):
            measure(reference, black)
    with pytest.raises(ValueError, match="covered"):
        measures.flip(reference, reference, COVERED[1:])
    with pytest.raises(ValueError, match="nothing"):
        measures.flip(reference, reference, ~COVERED)


def test_woven_yarns_keep_clear_of_each_other():
    yarns = models.woven()
    curves = np.split(yarns.points.astype(np.float64), yarns.offsets[1:-1])
    # Straight between control points, which cuts corners by up to 0.02.
    steps = [np.linspace(0, len(curve) - 1, 1 + 8 * (len(curve) - 1)) for curve in curves]
    fine = [
        np.column_stack([np.interp(step, np.arange(len(curve)), curve[:, axis]) for axis in range(3)])
        for step, curve in zip(steps, curves, strict=True)
    ]
    a, b = fine[len(fine) // 2], fine[len(fine) // 2 + 1]
    for other in fine:
        for one in (a, b):
            if other is not one:
                assert np.linalg.norm(one[:, None] - other, axis=2).min() > 1.97


def test_suns_come_from_where_they_say():
    scene = models.scene(models.straight(), lisle.Yarn.preset("silk-1"), lisle.Material.preset("silk"), "near", "back")
    toward_camera = scene.camera.world_from_camera[:3, 2]
    assert np.dot(scene.lights[0].direction, toward_camera) > 0
    assert np.linalg.det(models.frame()) == pytest.approx(1)


def waves(shift, brightness=1.0):
    """A picture that moves by a shift in pixels, columns and rows."""
    x, y = np.meshgrid(np.arange(48) - shift[0], np.arange(48) - shift[1])
    value = brightness * (1.5 + np.sin(0.35 * x + 0.1 * y) * np.cos(0.25 * y))
    return np.repeat(value[..., None], 3, axis=2)


def change(pictures, motion):
    change, square = measures.squared_change(pictures, np.broadcast_to(np.asarray(motion, float), (48, 48, 2)))
    return np.sqrt(max(change, 0) / square)


def test_motion_is_no_flicker_once_it_is_compensated():
    pictures = [[waves((0, 0)), waves((2.5, -1.25))]] * 2
    # Half-way between pixels, the linear interpolation of a wave is off by 0.35² / 8 = 0.015 of it.
    assert change(pictures, (2.5, -1.25)) < 0.015
    assert change(pictures, (0, 0)) > 0.2
    assert change(pictures, (-2.5, 1.25)) > 0.3


def test_a_picture_that_brightens_flickers_by_as_much():
    assert change([[waves((0, 0)), waves((3, 0), brightness=1.1)]] * 2, (3, 0)) == pytest.approx(0.1, rel=0.02)


def test_noise_is_no_flicker():
    noise = np.random.default_rng(3)
    pictures = [[waves((0, 0)) + noise.uniform(0, 0.5, (48, 48, 3)) for _ in range(2)] for _ in range(2)]
    assert change(pictures, (0, 0)) < 0.03
    same = [pictures[0], pictures[0]]
    assert change(same, (0, 0)) > 0.08, "noise that both have is seen"
