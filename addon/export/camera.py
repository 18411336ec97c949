# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera as two matrices; Blender itself works out sensor fit, shift, aspect and projection."""

import numpy as np

from ..core.camera import without_scale
from ..core.errors import SceneError


def native_camera(lisle, camera, depsgraph, size):
    """`lisle.Camera` of a camera object for a full frame of `size` = (w, h) pixels."""
    if camera is None:
        raise SceneError("The scene has no camera")
    if camera.type != "CAMERA":
        raise SceneError(f"The scene's camera '{camera.name}' is of type {camera.type}: use a camera object")
    evaluated = camera.evaluated_get(depsgraph)
    if evaluated.data.type not in {"PERSP", "ORTHO"}:
        raise SceneError(
            f"Camera '{camera.name}' is of type {evaluated.data.type}: Lisle draws perspective and orthographic cameras"
        )
    render = depsgraph.scene.render
    clip_from_camera = evaluated.calc_matrix_camera(
        depsgraph, x=size[0], y=size[1], scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y
    )
    return lisle.Camera.from_matrices(
        without_scale(evaluated.matrix_world), np.array(clip_from_camera, dtype=np.float64), size
    )
