# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera as two matrices and a lens; Blender itself works out sensor fit, shift, aspect and projection."""

import numpy as np

from ..core.camera import without_scale
from ..core.errors import SceneError

_LEAST_FOCUS = 1e-5


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
    return lisle.Camera(
        without_scale(evaluated.matrix_world),
        np.array(clip_from_camera, dtype=np.float64),
        size,
        **lens_of(evaluated, depsgraph),
    )


def lens_of(camera, depsgraph):
    """What `lisle.Camera` takes to blur what an evaluated camera object has out of focus; nothing for a pinhole.

    As Cycles has it: the f-stop divides the focal length, or one metre for an orthographic camera.
    """
    dof = camera.data.dof
    if not dof.use_dof:
        return {}
    focal_length = 1.0 if camera.data.type == "ORTHO" else camera.data.lens * 1e-3
    return {
        "aperture_radius": focal_length / (2 * max(dof.aperture_fstop, 1e-5)),
        "focus_distance": max(_focus_distance(camera, dof, depsgraph), _LEAST_FOCUS),
        "blades": dof.aperture_blades,
        "rotation_rad": dof.aperture_rotation,
        "ratio": dof.aperture_ratio,
    }


def _focus_distance(camera, dof, depsgraph):
    """Along the view axis."""
    if dof.focus_object is None:
        return dof.focus_distance
    focus = dof.focus_object.evaluated_get(depsgraph)
    target = focus.matrix_world
    bone = focus.pose.bones.get(dof.focus_subtarget) if focus.pose is not None else None
    if bone is not None:
        target = target @ bone.matrix
    axis = camera.matrix_world.col[2].xyz.normalized()
    return abs(axis.dot(target.translation - camera.matrix_world.translation))
