# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of every kind, read without a Python loop over points.

Blender gives new-style curves (`GeometrySet.curves`) for Curves objects, for geometry nodes, and for legacy
curves without bevel. A legacy curve with bevel is only a mesh: then its splines are read (`legacy.py`).
"""

import numpy as np

from ..core.curves import BEZIER, CATMULL_ROM, NURBS, CurveArrays, bezier_polygons, interpolate

DEFAULT_RADIUS_M = 0.01
"""Radius of curves that carry none; Blender draws those with the same radius."""

_INTEGER_BUFFERS = {"INT": np.int32, "INT8": np.int32, "BOOLEAN": bool}


def read_attribute(curves, name, domain, count):
    """Values of a scalar attribute, or None where it does not exist on that domain."""
    attribute = curves.attributes.get(name)
    if attribute is None or attribute.domain != domain or len(attribute.data) != count:
        return None
    values = np.empty(count, _INTEGER_BUFFERS.get(attribute.data_type, np.float32))
    attribute.data.foreach_get("value", values)
    return values


def _read_vectors(curves, name, fallback):
    attribute = curves.attributes.get(name)
    if attribute is None:
        return fallback
    values = np.empty(fallback.size, np.float32)
    attribute.data.foreach_get("vector", values)
    return values.reshape(-1, 3)


def read_curves(curves):
    """A `bpy.types.Curves` as CurveArrays, in its own space; None if it has no point."""
    point_count, curve_count = len(curves.points), len(curves.curves)
    if point_count == 0:
        return None
    points = np.empty(point_count * 3, np.float32)
    curves.position_data.foreach_get("vector", points)
    points = points.reshape(-1, 3)
    offsets = np.empty(curve_count + 1, np.int32)
    curves.curve_offset_data.foreach_get("value", offsets)
    offsets = offsets.astype(np.uint32)

    def per_curve(name, default, dtype):
        values = read_attribute(curves, name, "CURVE", curve_count)
        return np.full(curve_count, default, dtype) if values is None else values.astype(dtype)

    closed = per_curve("cyclic", False, bool)
    basis = per_curve("curve_type", CATMULL_ROM, np.uint8)
    radii = read_attribute(curves, "radius", "POINT", point_count)
    if radii is None:
        radii = np.full(point_count, DEFAULT_RADIUS_M, np.float32)
    lengths = read_attribute(curves, "length_coordinate", "POINT", point_count)
    weights = order = knots_mode = None
    if (basis == NURBS).any():
        weights = read_attribute(curves, "nurbs_weight", "POINT", point_count)
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
        material_index=read_attribute(curves, "material_index", "CURVE", curve_count),
    )
