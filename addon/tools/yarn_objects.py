# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves objects from native yarns."""

import bpy
import numpy as np
from bpy.props import EnumProperty

from ..presets import DEFAULT_FIBER, DEFAULT_YARN, FIBER_ITEMS, YARN_ITEMS

_CATMULL_ROM, _POLY, _B_SPLINE = 0, 1, 4
"""lisle's codes."""


def yarn_data(name, yarns, scale=1.0):
    """A new `bpy.types.Curves` with the points, radii and cyclic flags of lisle.Yarns, times `scale`.

    Raises ValueError for curves that are neither Catmull-Rom nor linear nor B-splines.
    """
    if not np.isin(yarns.basis, (_CATMULL_ROM, _POLY, _B_SPLINE)).all():
        raise ValueError(f"{name} has curves that are neither Catmull-Rom nor linear nor B-splines")
    data = curves_data(name, yarns.points * np.float32(scale), yarns.offsets, yarns.radii * np.float32(scale))
    for basis, kind in ((_POLY, "POLY"), (_B_SPLINE, "NURBS")):
        which = np.flatnonzero(yarns.basis == basis)
        if len(which):
            data.set_types(type=kind, indices=which.tolist())
    if (yarns.basis == _B_SPLINE).any():  # cubic, with evenly spaced knots
        order = _attribute(data, "nurbs_order", "INT8", "CURVE")
        order.data.foreach_set("value", np.full(len(yarns.basis), 4, np.int32))
    if yarns.closed.any():
        _attribute(data, "cyclic", "BOOLEAN", "CURVE").data.foreach_set("value", yarns.closed)
    return data


def curves_data(name, points, offsets, radii, kind="CATMULL_ROM"):
    """A new `bpy.types.Curves`: points (n, 3) and radii (n,) float32, offsets (c + 1,); all curves of one kind."""
    data = bpy.data.hair_curves.new(name)
    data.add_curves(np.diff(offsets.astype(np.int64)).tolist())
    if kind != "CATMULL_ROM":
        data.set_types(type=kind)
    data.position_data.foreach_set("vector", points.ravel())
    _attribute(data, "radius", "FLOAT", "POINT").data.foreach_set("value", radii)
    data.update_tag()
    return data


def in_object_mode(operator, context):
    """For operators that add objects: elsewhere Blender would add to what is being edited."""
    if context.mode != "OBJECT":
        operator.poll_message_set("Leave the mode you are in: objects are added in Object Mode")
        return False
    return True


class NewMaterial:
    """For operators that add yarns: presets to choose, and the material made of them."""

    yarn: EnumProperty(
        name="Yarn", description="What the new material is spun like", items=YARN_ITEMS, default=DEFAULT_YARN
    )
    fiber: EnumProperty(
        name="Fiber", description="What the new material scatters light like", items=FIBER_ITEMS, default=DEFAULT_FIBER
    )

    def add_material(self, data, name, fiber=None):
        """Gives curves a new material of the chosen presets; `fiber` takes the place of the chosen one."""
        material = bpy.data.materials.new(name)
        material.lisle.yarn.preset, material.lisle.fiber.preset = self.yarn, fiber or self.fiber
        data.materials.append(material)


def _attribute(data, name, kind, domain):
    return data.attributes.get(name) or data.attributes.new(name, kind, domain)
