"""The path tracer against an independent one, Mitsuba 3, on the same fibers with the same scattering: Lambert's.

Both take a random place of each pixel for each sample: Mitsuba by a box filter, Lisle by a moving camera. Pictures
are compared by means over blocks of pixels, each within what both standard errors allow; the bound is corrected for the
number of blocks.
"""

import dataclasses
from statistics import NormalDist

import lisle
import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="mitsuba is not installed")

SIZE = (48, 36)
BLOCK = 6
ALBEDO = 0.8
IRRADIANCE = 3.0
SKY = 0.4
DOWN = (0.5, 0.8, -1.0)

ROUNDS = 32
"""Independent pictures by each, from which standard errors are taken."""

SAMPLES = 8
"""Of one picture by Mitsuba, pixel by pixel; of one by Lisle there is one, in each of as many pictures."""

CHANCE = 1e-3
"""Of a false alarm among all blocks of a comparison."""


@pytest.fixture(scope="module", autouse=True)
def variant():
    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)


def lambert(albedo=ALBEDO):
    """A material of Lambert cylinders."""
    return dataclasses.replace(lisle.Material.preset("silk"), diffuse=(albedo,) * 3, specular=(0.0, 0.0, 0.0))


def yarns():
    """Three strands across each other, one of them a loop."""
    t = np.linspace(0, 1, 12)
    strands = [
        np.column_stack([2 * t - 1, 0.1 * np.sin(9 * t), 0.15 * np.cos(7 * t) + 0.1]),
        np.column_stack([0.3 * np.sin(5 * t), 0.15 + 0.1 * np.cos(8 * t), 1.6 * t - 0.8]),
        np.column_stack([0.4 * np.cos(6 * t) - 0.2, 0.1 + 0.2 * t, 0.4 * np.sin(6 * t)]),
    ]
    return lisle.Yarns(np.concatenate(strands), [0, 12, 24, 36], yarn_radius=0.12)


def yarn():
    """Few and thick fibers, one of which a pixel can hold."""
    return dataclasses.replace(lisle.Yarn.preset("silk-1"), fibers_per_ply=12, fiber_radius=0.004)


CHORD_ERROR = 0.01
"""So small that normals of fibers and normals of the cones that stand for them are the same within the noise."""


def camera(shift=(0.0, 0.0)):
    """The viewpoint, moved on the picture by a part of a pixel."""
    fitted = lisle.Camera.fit(yarns(), direction=(0.2, -1.0, 0.3), size=SIZE)
    moved = np.eye(4)
    moved[0, 3], moved[1, 3] = 2 * shift[0] / SIZE[0], 2 * shift[1] / SIZE[1]
    return dataclasses.replace(fitted, clip_from_camera=moved @ fitted.clip_from_camera)


def by_lisle(bounces, seed, albedo=ALBEDO):
    """Independent pictures of (h, w), each of SAMPLES samples."""
    random = np.random.default_rng(seed)
    pictures = []
    for round in range(ROUNDS):
        total = np.zeros(SIZE[::-1])
        for sample in range(SAMPLES):
            image = lisle.Reference().render(
                yarns(),
                yarn=yarn(),
                material=lambert(albedo),
                camera=camera(random.uniform(-0.5, 0.5, 2)),
                lights=[lisle.Sun(direction=DOWN, strength=IRRADIANCE)],
                ambient=(SKY,) * 3,
                shading="simple",
                bounces=bounces,
                samples=1,
                filter_width=0,
                transparent=False,
                chord_error=CHORD_ERROR,
                seed=10_000 * seed + SAMPLES * round + sample,
            )
            total += image["combined"][..., 0]
        pictures.append(total / SAMPLES)
    return np.stack(pictures)


def mitsuba_scene(fibers, bounces):
    """Fibers as Mitsuba describes them, under the same light and before the same camera."""
    view = camera()
    angle = 2 * np.degrees(np.arctan(1 / view.clip_from_camera[1, 1]))
    # Mitsuba's camera looks along its +Z with +X to the left.
    to_world = view.world_from_camera @ np.diag([-1.0, 1.0, -1.0, 1.0])
    film = {"type": "hdrfilm", "width": SIZE[0], "height": SIZE[1], "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    return mi.load_dict(
        {
            "type": "scene",
            # Its depth counts segments of a path, the one from the camera included, and light that is met as one more.
            "integrator": {"type": "path", "max_depth": -1 if bounces is None else bounces + 1, "rr_depth": 8},
            "fibers": fibers,
            "sun": {"type": "directional", "direction": DOWN, "irradiance": {"type": "rgb", "value": IRRADIANCE}},
            "sky": {"type": "constant", "radiance": {"type": "rgb", "value": SKY}},
            "sensor": {
                "type": "perspective",
                "fov": angle,
                "fov_axis": "y",
                "near_clip": 1e-3,
                "far_clip": 1e4,
                "to_world": mi.ScalarTransform4f(to_world),
                "film": film,
            },
        }
    )


def by_mitsuba(bounces, seed, folder):
    """The same by Mitsuba, of the fibers that Lisle exports."""
    made = lisle.fibers(yarns(), yarn(), chord_error=CHORD_ERROR)
    file = folder / "fibers.txt"
    with file.open("w") as out:
        for start, end in zip(made.offsets[:-1], made.offsets[1:], strict=True):
            # A cone of no width is none to Mitsuba; the tip of a hair is a thousandth of one.
            radii = np.maximum(made.radii[start:end], 1e-3 * made.radii.max())
            np.savetxt(out, np.column_stack([made.points[start:end], radii]), fmt="%.9g")
            out.write("\n")
    diffuse = {"type": "diffuse", "reflectance": {"type": "rgb", "value": ALBEDO}}
    scene = mitsuba_scene({"type": "linearcurve", "filename": str(file), "bsdf": diffuse}, bounces)
    return np.stack(
        [np.array(mi.render(scene, spp=SAMPLES, seed=1000 * seed + i))[..., 0] for i in range(ROUNDS)]
    ).astype(np.float64)


def deviations(a, b):
    """Differences of block means in standard errors, for blocks in which anything is uncertain."""

    def blocks(pictures):
        shape = (len(pictures), SIZE[1] // BLOCK, BLOCK, SIZE[0] // BLOCK, BLOCK)
        return pictures.reshape(shape).mean(axis=(2, 4)).reshape(len(pictures), -1)

    a, b = blocks(a), blocks(b)
    error = np.sqrt(a.var(axis=0, ddof=1) / len(a) + b.var(axis=0, ddof=1) / len(b))
    uncertain = error > 1e-4
    return ((a.mean(axis=0) - b.mean(axis=0))[uncertain]) / error[uncertain]


def bound(count):
    """Deviation that a block exceeds by chance only once in so many comparisons (Šidák)."""
    return NormalDist().inv_cdf(0.5 + 0.5 * (1 - CHANCE) ** (1 / count))


@pytest.mark.parametrize("bounces", [1, 2, None], ids=["direct", "two", "all"])
def test_means_agree_within_their_errors(bounces, tmp_path):
    found = deviations(by_lisle(bounces, 1), by_mitsuba(bounces, 2, tmp_path))
    assert len(found) >= 20
    print(f"{len(found)} blocks: worst {np.abs(found).max():.2f} of {bound(len(found)):.2f}, mean {found.mean():.2f}")
    assert np.abs(found).max() < bound(len(found))
    # A small bias everywhere is no single block's: the sum of all is a test of its own.
    assert abs(found.sum()) / np.sqrt(len(found)) < bound(1)


def test_a_wrong_albedo_is_rejected(tmp_path):
    found = deviations(by_lisle(None, 3, albedo=ALBEDO - 0.04), by_mitsuba(None, 4, tmp_path))
    assert abs(found.sum()) / np.sqrt(len(found)) > bound(1)
