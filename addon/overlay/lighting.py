# SPDX-License-Identifier: GPL-3.0-or-later
"""Light on the overlay: the scene's where the viewport uses it, otherwise a studio that goes with the viewer."""

import numpy as np

from .. import native

# No ambient light: its shadows would cost more than these suns together.
_STUDIO = (
    # Direction of travel in camera space, irradiance.
    ((0.5, -0.7, -0.6), 3.6),
    ((-0.8, -0.2, -0.5), 1.4),
    ((0.0, 0.0, -1.0), 0.9),
    ((0.1, 0.8, -0.2), 0.8),
)


def lighting_of(space, view):
    """A list of lights, or None for the scene's and its world."""
    shading = space.shading
    if (shading.type == "MATERIAL" and shading.use_scene_lights) or (
        shading.type == "RENDERED" and shading.use_scene_lights_render
    ):
        return None
    return studio(view.world_from_camera)


def studio(world_from_camera):
    """Lights that go with a camera."""
    lisle = native.module()
    rotation = np.asarray(world_from_camera)[:3, :3]
    return [lisle.Sun(direction=tuple(rotation @ way), strength=strength) for way, strength in _STUDIO]
