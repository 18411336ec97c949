# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender material's Lisle settings as native yarn and material."""

from math import degrees

from ..core.errors import SceneError
from ..presets import DEFAULT_FIBER, DEFAULT_YARN


def yarn_and_material(lisle, material, object_name):
    """(lisle.Yarn, lisle.Material) of a `bpy.types.Material`, or the defaults for None.

    Raises SceneError with the material's name, and that of the object that has it, where its numbers make no yarn.
    """
    if material is None:
        return lisle.Yarn.preset(DEFAULT_YARN), lisle.Material.preset(DEFAULT_FIBER)
    try:
        return _native(lisle, material.lisle.yarn), _native(lisle, material.lisle.fiber)
    except lisle.InputError as error:
        raise SceneError(f"object '{object_name}': material '{material.name}': {error}") from error


def _native(lisle, group):
    preset = group.native_preset(lisle)
    if not group.customize:
        return preset
    values = {field: _plain(getattr(group, field)) for field in group.FIELDS}
    # Rounded, so that a preset's own angles come back from single precision.
    angles = {f"{field}_deg": round(degrees(values.pop(field)), 4) for field in group.ANGLES}
    return preset.replace(**values, **angles)


def _plain(value):
    """Vectors as tuples of floats."""
    return value if isinstance(value, int | float) else tuple(value)


def geometry_materials(obj, data):
    """Materials by slot index of curves `data` on `obj`; a slot linked to the object wins over the data's."""
    materials = list(data.materials) if data is not None else []
    slots = obj.material_slots
    if not materials:
        return [slot.material for slot in slots]
    for index, slot in enumerate(slots):
        if slot.link == "OBJECT" and index < len(materials):
            materials[index] = slot.material
    return materials
