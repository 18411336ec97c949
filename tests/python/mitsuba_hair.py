"""Makes `native/reference/tests/mitsuba/hair.txt`: pictures by Mitsuba 3 with its hair model, of Lisle's fibers.

python tests/python/mitsuba_hair.py
"""

import dataclasses
from pathlib import Path

import lisle
import mitsuba as mi
import numpy as np
from test_mitsuba import BLOCK, CHORD_ERROR, SIZE, camera, mitsuba_scene, yarn, yarns

OUT = Path(__file__).parents[2] / "native" / "reference" / "tests" / "mitsuba" / "hair.txt"

HAIR = {
    "type": "hair",
    "sigma_a": {"type": "rgb", "value": 0.3},
    "int_ior": 1.55,
    "ext_ior": 1.0,
    "longitudinal_roughness": 0.3,
    "azimuthal_roughness": 0.3,
    "scale_tilt": 0.0,
}
"""The same as in `native/reference/tests/hair.rs`."""

ROUNDS = 48
SAMPLES = 64


def through(points):
    """Control points of the uniform cubic B-spline that goes through points, which Mitsuba begins at the second.

    (c[i-1] + 4 c[i] + c[i+1]) / 6 = p[i], and no curvature at the ends.
    """
    n = len(points)
    matrix = np.zeros((n + 2, n + 2))
    for i in range(n):
        matrix[i + 1, i : i + 3] = 1, 4, 1
    matrix[0, :3] = matrix[-1, -3:] = 1, -2, 1
    return np.linalg.solve(matrix, np.concatenate([[0 * points[0]], 6 * points, [0 * points[0]]]))


def main():
    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    quiet = dataclasses.replace(yarn(), loop_density=0.0, hair_density=0.0)
    made = lisle.fibers(yarns(), quiet, chord_error=CHORD_ERROR)
    OUT.parent.mkdir(exist_ok=True)
    file = OUT.with_suffix(".fibers")
    with file.open("w") as out:
        for start, end in zip(made.offsets[:-1], made.offsets[1:], strict=True):
            chain = np.column_stack([made.points[start:end], made.radii[start:end]]).astype(np.float64)
            np.savetxt(out, through(chain), fmt="%.9g")
            out.write("\n")

    def row(name, numbers):
        return f"{name} {' '.join(f'{number:.9g}' for number in np.ravel(numbers))}\n"

    view, curves = camera(), yarns()
    text = f"# By tests/python/mitsuba_hair.py with Mitsuba {mi.__version__}: mean and standard error of each block.\n"
    text += row("size", (*SIZE, BLOCK))
    text += row("world_from_camera", view.world_from_camera) + row("clip_from_camera", view.clip_from_camera)
    text += row("yarn_radius", curves.radii[:1])
    for points in np.split(curves.points, curves.offsets[1:-1]):
        text += row("curve", points)
    for name, bounces in (("direct", 1), ("two", 2), ("all", None)):
        shown = mitsuba_scene({"type": "bsplinecurve", "filename": str(file), "bsdf": HAIR}, bounces)
        rounds = np.stack([np.array(mi.render(shown, spp=SAMPLES, seed=i))[..., 0] for i in range(ROUNDS)])
        shape = (ROUNDS, SIZE[1] // BLOCK, BLOCK, SIZE[0] // BLOCK, BLOCK)
        blocks = rounds.astype(np.float64).reshape(shape).mean(axis=(2, 4)).reshape(ROUNDS, -1)
        text += row(name, np.column_stack([blocks.mean(axis=0), blocks.std(axis=0, ddof=1) / np.sqrt(ROUNDS)]))
    file.unlink()
    OUT.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
