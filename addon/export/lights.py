# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights, with Blender's radiometric units: W/m² for suns, W for the others."""

import numpy as np

from ..core.camera import without_scale
from ..core.errors import SceneError
from ..core.lights import area_m2, unnormalized_factor


def native_light(lisle, obj, matrix_world, note):
    """The native light of a light object at `matrix_world`, None if it gives none; tells `note` (a callable) what is
    left out.

    Raises SceneError with the object's name where its settings cannot be drawn.
    """
    try:
        return _native_light(lisle, obj, matrix_world, note)
    except lisle.InputError as error:
        raise SceneError(f"light '{obj.name}': {error}") from error


def _native_light(lisle, obj, matrix_world, note):
    light = obj.data
    world_from_light = without_scale(matrix_world)
    position, direction = world_from_light[:3, 3], -world_from_light[:3, 2]
    color = np.array(light.color[:], dtype=np.float64)
    if light.use_temperature:
        color = color * light.temperature_color[:]
    power = light.energy * 2.0**light.exposure
    if power < 0:
        note(f"light '{obj.name}': its strength is negative, which gives no light")
        return None
    if light.type != "POINT" and np.linalg.matrix_rank(world_from_light[:3, :3]) < 3:
        note(f"light '{obj.name}': it is scaled to 0 and gives no light")
        return None
    if getattr(light, "node_tree", None) is not None and _has_used_nodes(light):
        note(f"light '{obj.name}': its shader nodes are ignored, its colour and power count")
    if light.type == "SUN":
        if not light.normalize:
            power *= unnormalized_factor("SUN", angle_rad=light.angle)
        return lisle.Sun(direction=tuple(direction), strength=power, color=tuple(color), angle_rad=light.angle)
    if light.type == "AREA":
        size, is_disk = _size(light, matrix_world)
        if 0 in size:
            note(f"light '{obj.name}': its size is 0, which gives no light")
            return None
        return _area(lisle, light, size, is_disk, world_from_light, power, color)
    if not light.normalize:
        power *= unnormalized_factor(light.type, radius_m=light.shadow_soft_size)
    common = {
        "position": tuple(position),
        "power": power,
        "color": tuple(color),
        "radius": light.shadow_soft_size,
    }
    if light.type == "POINT":
        return lisle.Point(**common)
    return lisle.Spot(**common, direction=tuple(direction), cone_angle_rad=light.spot_size, blend=light.spot_blend)


def _size(light, matrix_world):
    """Extents of an area light, m, and whether it is a disk."""
    scale = np.linalg.norm(np.array(matrix_world, dtype=np.float64)[:3, :2], axis=0)
    is_disk = light.shape in {"DISK", "ELLIPSE"}
    height = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    return (light.size * scale[0], height * scale[1]), is_disk


def _area(lisle, light, size, is_disk, world_from_light, power, color):
    if not light.normalize:
        power *= unnormalized_factor("AREA", area_m2=area_m2(size, is_disk))
    return lisle.Area(
        world_from_light=world_from_light,
        shape="disk" if is_disk else "rectangle",
        size=size,
        power=power,
        color=tuple(color),
    )


def _has_used_nodes(light):
    """Whether the nodes are more than the emission node that Blender makes for every light."""
    if not light.use_nodes:
        return False
    plain = {"OUTPUT_LIGHT", "EMISSION"}
    return any(
        node.type not in plain or any(i.is_linked for i in node.inputs if i.name != "Surface")
        for node in light.node_tree.nodes
    )
