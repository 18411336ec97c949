"""The example that `cargo xtask demo` renders."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).parents[1]))
from closest import closest_approach

REPOSITORY = Path(__file__).parents[2]
pytestmark = pytest.mark.blender("wheel")

FRAMES = 24


def test_the_yarns_of_the_demo_do_not_intersect(addon, lisle):
    import bpy

    script = REPOSITORY / "examples" / "05_blender_knit_animation.py"
    before, main, after = script.read_text().rpartition("\nmain()\n")
    assert main and not after
    example = {"__name__": "example", "__doc__": None}
    exec(compile(before, script, "exec"), example)
    cloth = example["add_cloth"]()
    example["add_wave"](cloth, FRAMES)

    rest = np.empty(3 * len(cloth.data.points), np.float32)
    cloth.data.position_data.foreach_get("vector", rest)
    moved = []
    for frame in (1, 7, 13, 19):
        bpy.context.scene.frame_set(frame)
        curves = cloth.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        points = np.empty(3 * len(curves.points), np.float32)
        curves.position_data.foreach_get("vector", points)
        moved.append(np.abs(points - rest).max())
        ends = np.cumsum([curve.points_length for curve in curves.curves])[:-1]
        yarns = [(part, False) for part in np.split(points.reshape(-1, 3), ends)]
        distance = closest_approach(yarns, curves.points[0].radius)
        print(frame, distance, moved[-1])
        assert distance > 2, f"frame {frame}: centre lines come within {distance:.3f} radii"
    assert moved[0] < 1e-6 and moved[2] > 0.003
