# SPDX-License-Identifier: GPL-3.0-or-later
"""Legacy curve objects ('CURVE'): radii, materials, and the shapes that Blender delivers only as a mesh."""

from dataclasses import replace

import numpy as np

from ..core.curves import (
    BEZIER,
    NURBS,
    POLY,
    CurveArrays,
    bezier_polygons,
    interpolate,
    polylines_of_wire,
)
from ..core.errors import GeometryError
from ..core.trim import places
from .curves import DEFAULT_RADIUS_M, read_curves

_KNOTS_ENDPOINT, _KNOTS_BEZIER = 1, 2


def read_legacy(obj, geometry, depsgraph):
    """The evaluated legacy curve object `obj` as CurveArrays, or None if it has no point.

    Raises GeometryError where a modifier moves the tube mesh, not the curve in it.
    """
    if geometry.curves is not None:
        arrays = read_curves(geometry.curves, obj.name)
        if arrays is None:
            return None
        arrays = _with_spline_materials(arrays, obj.data)
        return replace(arrays, radii=_radii_in_metres(arrays.radii, obj))
    if not is_shortened(obj.data):
        if geometry.mesh is None or len(geometry.mesh.vertices) == 0:
            return None
        if len(geometry.mesh.polygons) == 0:
            return _read_wire(geometry.mesh, obj)
    _refuse_modifiers_of_the_tube(obj)
    # Modifiers that apply to splines, shape keys and hooks are in this copy, bevel or not.
    curve = obj.to_curve(depsgraph, apply_modifiers=True)
    try:
        arrays = read_splines(curve)
    finally:
        obj.to_curve_clear()
    if arrays is None:
        return None
    return replace(arrays, radii=arrays.radii * np.float32(_metres_per_radius(obj)))


def shown_parts(obj, arrays):
    """Which part of each curve is there, (c, 2) places as in core.trim; None if all are whole. As Blender has it, a
    bevel has a start and an end, a line without bevel has none."""
    curve = obj.data
    if arrays is None or not is_shortened(curve):
        return None
    ends = ((getattr(curve, f"bevel_factor_{end}"), getattr(curve, f"bevel_factor_mapping_{end}")) for end in _ENDS)
    return places(arrays, *ends)


def left_out(obj):
    """What of a legacy curve is left out, in words; None if nothing is."""
    if obj.type != "CURVE" or not is_shortened(obj.data):
        return None
    if any(spline.type == "NURBS" and not spline.use_cyclic_u for spline in obj.data.splines):
        return "its bevel's start and end do not shorten NURBS: convert them to Bézier splines"
    return None


_ENDS = ("start", "end")


def is_shortened(curve):
    """Whether only a part of a legacy curve has a bevel, perhaps none."""
    is_bevelled = max(curve.bevel_depth, curve.extrude) > 0 or curve.bevel_mode == "OBJECT"
    return is_bevelled and sorted((curve.bevel_factor_start, curve.bevel_factor_end)) != [0.0, 1.0]


def _refuse_modifiers_of_the_tube(obj):
    for modifier in obj.modifiers:
        if modifier.show_render and not getattr(modifier, "use_apply_on_spline", False):
            raise GeometryError(
                obj.name,
                f"its modifier '{modifier.name}' works on the bevelled mesh, which leaves no curve to draw yarn along. "
                "Turn on 'Apply on Spline' in the modifier's header, or set the curve's bevel depth to 0 "
                "and the yarn radius in Object › Yarn",
            )


def _metres_per_radius(obj):
    """Legacy curves have a relative radius per point: its unit is the bevel depth."""
    curve = obj.data
    if obj.lisle.yarn_radius > 0:
        return obj.lisle.yarn_radius
    if curve.bevel_mode != "OBJECT" and max(curve.bevel_depth, curve.extrude) > 0:
        return max(curve.bevel_depth, curve.extrude)
    return DEFAULT_RADIUS_M


def _radii_in_metres(radii, obj):
    """Radii that are the splines' own are relative; others were set by geometry nodes, in metres."""
    if any(modifier.type == "NODES" and modifier.show_render for modifier in obj.modifiers):
        own = read_splines(obj.data)
        if own is None or not np.array_equal(own.radii, radii):
            return radii
    return radii * np.float32(_metres_per_radius(obj))


def _with_spline_materials(arrays, curve):
    """Blender drops the material of a spline on the way to new-style curves."""
    if len(curve.materials) < 2 or len(curve.splines) != arrays.curve_count:
        return arrays
    return replace(arrays, material_index=_per_spline(curve, "material_index", np.int32))


def _per_spline(curve, name, dtype):
    values = np.empty(len(curve.splines), dtype)
    curve.splines.foreach_get(name, values)
    return values


def _read_wire(mesh, obj):
    """A wire mesh: an unbevelled curve behind a modifier that works on meshes."""
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    edges = np.empty(len(mesh.edges) * 2, np.int32)
    mesh.edges.foreach_get("vertices", edges)
    points = points.reshape(-1, 3)
    offsets, closed = polylines_of_wire(points, edges.reshape(-1, 2))
    arrays = CurveArrays(
        points=points,
        offsets=offsets,
        closed=closed,
        basis=np.full(len(closed), POLY, np.uint8),
        radii=np.ones(len(points), np.float32),
    )
    own = read_splines(obj.data)
    if own is not None and own.curve_count == arrays.curve_count:
        arrays = replace(arrays, radii=_resampled_radii(own, arrays), material_index=own.material_index)
    return replace(arrays, radii=arrays.radii * np.float32(_metres_per_radius(obj)))


def _resampled_radii(own, wire):
    """The splines' relative radii at the vertices of the wire, linear in the parameter along each spline."""
    radii = np.empty(len(wire.points), np.float32)
    for curve in range(own.curve_count):
        of_spline = own.radii[own.offsets[curve] : own.offsets[curve + 1]]
        if own.closed[curve]:
            of_spline = np.append(of_spline, of_spline[0])
        begin, end = wire.offsets[curve], wire.offsets[curve + 1]
        along = np.linspace(0, len(of_spline) - 1, end - begin, endpoint=not own.closed[curve])
        radii[begin:end] = np.interp(along, np.arange(len(of_spline)), of_spline)
    return radii


def read_splines(curve):
    """The splines of a `bpy.types.Curve` as CurveArrays with relative radii; None if there are none.

    One Python step per spline, none per point.
    """
    splines = [_read_spline(spline) for spline in curve.splines if len(spline.bezier_points) + len(spline.points)]
    if not splines:
        return None
    points, left, right, radii, weights, basis, closed, order, knots, material = zip(*splines, strict=True)
    counts = [len(p) for p in points]
    offsets = np.concatenate(([0], np.cumsum(counts))).astype(np.uint32)
    points, left, right, radii, weights = (np.concatenate(a) for a in (points, left, right, radii, weights))
    basis, closed = np.array(basis, np.uint8), np.array(closed, bool)
    if (basis == BEZIER).any():
        points, offsets, between = bezier_polygons(points, left, right, offsets, closed, basis == BEZIER)
        radii, weights = (interpolate(values, between) for values in (radii, weights))
    nurbs = (basis == NURBS).any()
    return CurveArrays(
        points=points,
        offsets=offsets,
        closed=closed,
        basis=basis,
        radii=radii,
        nurbs_order=np.array(order, np.uint8) if nurbs else None,
        nurbs_weights=weights if nurbs else None,
        nurbs_knots_mode=np.array(knots, np.uint8) if nurbs else None,
        material_index=np.array(material, np.int32) if len(curve.materials) > 1 else None,
    ).as_drawn()


def _read_spline(spline):
    if spline.type == "BEZIER":
        data = spline.bezier_points
        points, left, right = (_floats(data, name, 3) for name in ("co", "handle_left", "handle_right"))
        weights = np.ones(len(data), np.float32)
        basis = BEZIER
    else:
        data = spline.points
        homogeneous = _floats(data, "co", 4)
        points = left = right = np.ascontiguousarray(homogeneous[:, :3])
        weights = homogeneous[:, 3]
        basis = NURBS if spline.type == "NURBS" else POLY
    radii = _floats(data, "radius", 1).reshape(-1)
    knots_mode = _KNOTS_ENDPOINT * spline.use_endpoint_u + _KNOTS_BEZIER * spline.use_bezier_u
    return (
        points, left, right, radii, weights,
        basis, spline.use_cyclic_u, spline.order_u, knots_mode, spline.material_index,
    )  # fmt: skip


def _floats(data, name, width):
    values = np.empty(len(data) * width, np.float32)
    data.foreach_get(name, values)
    return values.reshape(-1, width)
