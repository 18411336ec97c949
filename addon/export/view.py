# SPDX-License-Identifier: GPL-3.0-or-later
"""The view of a region of a 3D viewport."""

import numpy as np

from ..core.view import View, camera_frame, part_of, whole_pixels
from .camera import lens_of


def view_of(context, scene, depsgraph=None):
    """core.view.View of the region that is being drawn. With a depsgraph, what a camera has out of focus is blurred."""
    region, region_data, space = context.region, context.region_data, context.space_data
    size = (region.width, region.height)
    clip_from_camera = np.array(region_data.window_matrix, dtype=np.float64)
    camera_from_world = np.array(region_data.view_matrix, dtype=np.float64)
    rectangle = (0, 0, *size)
    lens = {}
    render = scene.render
    if region_data.view_perspective == "CAMERA":
        camera = space.camera if space.use_local_camera else scene.camera
        is_camera = camera is not None and camera.type == "CAMERA"
        if is_camera and depsgraph is not None:
            lens = lens_of(camera.evaluated_get(depsgraph), depsgraph)
        if render.use_border and is_camera:
            corners = np.array(camera.data.view_frame(scene=scene), dtype=np.float64)
            frame = camera_frame(corners, clip_from_camera, size)
            rectangle = part_of(frame, _border(render, "border"))
    elif space.use_render_border:
        rectangle = part_of(rectangle, _border(space, "render_border"))
    return View(np.linalg.inv(camera_from_world), clip_from_camera, size, whole_pixels(rectangle, size), lens)


def _border(owner, prefix):
    return tuple(getattr(owner, f"{prefix}_{edge}") for edge in ("min_x", "min_y", "max_x", "max_y"))
