"""A long animation: memory stays, and no frame takes longer than those before it.

`LISLE_SOAK_FRAMES` is how many frames (60 unless set; a full run has 300).
"""

import os
import resource
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import scenes

FRAMES = int(os.environ.get("LISLE_SOAK_FRAMES", "60"))

pytestmark = [
    pytest.mark.blender("wheel"),
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc"),
]


def resident_mib():
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 2**20


def grows(values, tolerance):
    """Whether the median of the last third is above that of the middle one by more than a share."""
    third = len(values) // 3
    return np.median(values[-third:]) > (1 + tolerance) * np.median(values[third : 2 * third])


def test_growth_is_noticed():
    assert not grows([5, 9, 7] + [8, 8.2, 7.9] + [8, 8.1, 30], 0.05)
    assert grows(np.linspace(100, 125, 30), 0.05)


def test_an_animation_of_many_frames(lisle, tmp_path):
    import bpy

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=6)
    mesh_object = bpy.context.active_object
    mesh_object.shape_key_add(name="Basis")
    bent = mesh_object.shape_key_add(name="Bent")
    for point in bent.data:
        point.co.z += 0.1 * point.co.x**2
    scenes.keyframes(bent, "value", {1: 0.0, FRAMES: 1.0})
    bpy.ops.lisle.knit_from_mesh(yarn_radius=0.1)
    bpy.ops.lisle.add_woven_swatch(warp=12, weft=12, yarn_radius=0.1, rotation=(-1.5708, 0, 0), location=(0, 0, 1))
    sun = scenes.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    sun.data.energy = 3
    scene = bpy.context.scene
    scene.frame_end, scene.lisle.samples = FRAMES, 2
    scenes.use_exr(tmp_path / "f_")
    memory, processor, clock = [], [time.process_time()], [time.monotonic()]

    def note(*_):
        memory.append(resident_mib())
        processor.append(time.process_time())
        clock.append(time.monotonic())

    bpy.app.handlers.render_write.append(note)
    bpy.ops.render.render(animation=True)
    bpy.app.handlers.render_write.remove(note)
    assert len(memory) == FRAMES == len(list(tmp_path.iterdir()))
    seconds, cpu = np.diff(clock), np.diff(processor)
    third = FRAMES // 3
    for name, values in (("MiB", memory), ("s a frame", seconds), ("s of processors a frame", cpu)):
        print(name, [round(float(np.median(part)), 3) for part in np.array_split(values, 3)])
    assert not grows(memory, 0.05), memory[third::5]
    # Processor time, because other work on the machine changes the clock's.
    assert not grows(cpu, 0.15), cpu[third::5]
