# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of every kind, read without a Python loop over points.

Blender gives new-style curves (`GeometrySet.curves`) for Curves objects, for geometry nodes, and for legacy
curves without bevel. A legacy curve with bevel is only a mesh: then its splines are read (`legacy.py`).
"""

import numpy as np

from ..core.curves import BEZIER, CATMULL_ROM, NURBS, CurveArrays, bezier_polygons, interpolate
from ..core.errors import GeometryError

DEFAULT_RADIUS_M = 0.01
"""Radius of curves that carry none; Blender draws those with the same radius."""

_BUFFERS = {"FLOAT": np.float32, "INT": np.int32, "INT8": np.int32, "BOOLEAN": bool}
"""By the type of a scalar attribute."""


def read_attribute(curves, name, domain, count, object_name):
    """Values of a scalar attribute, or None where it does not exist on that domain.

    Raises GeometryError where it is of another type.
    """
    attribute = curves.attributes.get(name)
    if attribute is None or attribute.domain != domain or len(attribute.data) != count:
        return None
    if attribute.data_type not in _BUFFERS:
        reason = f"its attribute '{name}' is of type {attribute.data_type}: store it as FLOAT, one number for each"
        raise GeometryError(object_name, f"{reason} {domain.lower()}")
    values = np.empty(count, _BUFFERS[attribute.data_type])
    attribute.data.foreach_get("value", values)
    return values


def _read_vectors(curves, name, fallback):
    attribute = curves.attributes.get(name)
    if attribute is None:
        return fallback
    values = np.empty(fallback.size, np.float32)
    attribute.data.foreach_get("vector", values)
    return values.reshape(-1, 3)


def read_curves(curves, object_name):
    """A `bpy.types.Curves` of an object as CurveArrays, in its own space; None if it has no point.

    Raises GeometryError where an attribute is of a type that Lisle cannot read.
    """
    point_count, curve_count = len(curves.points), len(curves.curves)
    if point_count == 0:
        return None
    points = np.empty(point_count * 3, np.float32)
    curves.position_data.foreach_get("vector", points)
    points = points.reshape(-1, 3)
    offsets = np.empty(curve_count + 1, np.int32)
    curves.curve_offset_data.foreach_get("value", offsets)
    offsets = offsets.astype(np.uint32)

    def of_curves(name):
        return read_attribute(curves, name, "CURVE", curve_count, object_name)

    def of_points(name):
        return read_attribute(curves, name, "POINT", point_count, object_name)

    def per_curve(name, default, dtype):
        values = of_curves(name)
        return np.full(curve_count, default, dtype) if values is None else values.astype(dtype)

    closed = per_curve("cyclic", False, bool)
    basis = per_curve("curve_type", CATMULL_ROM, np.uint8)
    radii = of_points("radius")
    if radii is None:
        radii = np.full(point_count, DEFAULT_RADIUS_M, np.float32)
    lengths = of_points("length_coordinate")
    weights = order = knots_mode = None
    if (basis == NURBS).any():
        weights = of_points("nurbs_weight")
        if weights is None:
            weights = np.ones(point_count, np.float32)
        # Blender's default for both attributes.
        order = per_curve("nurbs_order", 4, np.uint8)
        knots_mode = per_curve("knots_mode", 0, np.uint8)
    if (basis == BEZIER).any():
        left, right = (_read_vectors(curves, name, points) for name in ("handle_left", "handle_right"))
        points, offsets, between = bezier_polygons(points, left, right, offsets, closed, basis == BEZIER)
        radii, lengths, weights = (interpolate(values, between) for values in (radii, lengths, weights))
    return CurveArrays(
        points=points,
        offsets=offsets,
        closed=closed,
        basis=basis,
        radii=radii,
        nurbs_order=order,
        nurbs_weights=weights,
        nurbs_knots_mode=knots_mode,
        length_coordinates=lengths,
        material_index=of_curves("material_index"),
    ).as_drawn()
