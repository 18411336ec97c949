# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves as flat arrays, the one form in which they travel from Blender to the native module."""

import hashlib
from dataclasses import dataclass, fields, replace

import numpy as np

CATMULL_ROM, POLY, BEZIER, NURBS = range(4)
"""Curve types, numbered as Blender does."""


@dataclass(frozen=True)
class CurveArrays:
    """`c` curves with `n` control points in all, in object space.

    A Bézier curve lists its whole control polygon, handles included: 3k + 1 points if open, 3k if closed.
    """

    points: np.ndarray
    """(n, 3) float32, metres."""
    offsets: np.ndarray
    """(c + 1,) uint32: curve `i` has the points `offsets[i]` to `offsets[i + 1]`."""
    closed: np.ndarray
    """(c,) bool."""
    basis: np.ndarray
    """(c,) uint8, one of the curve types above."""
    radii: np.ndarray
    """(n,) float32, metres."""
    nurbs_order: np.ndarray | None = None
    """(c,) uint8; None without NURBS, like the two below."""
    nurbs_weights: np.ndarray | None = None
    """(n,) float32."""
    nurbs_knots_mode: np.ndarray | None = None
    """(c,) uint8, numbered as Blender does."""
    length_coordinates: np.ndarray | None = None
    """(n,) float32, metres: arc length at rest, if the artist stored it."""
    material_index: np.ndarray | None = None
    """(c,) int32; None if all curves have material 0."""

    @property
    def curve_count(self):
        return len(self.offsets) - 1

    def equals(self, other):
        """Whether all numbers are the same."""
        pairs = ((getattr(self, field.name), getattr(other, field.name)) for field in fields(self))
        return all(a is b or (a is not None and b is not None and np.array_equal(a, b)) for a, b in pairs)

    def digest(self):
        """Hash of all that reaches the native module: equal digests make equal yarns."""
        hasher = hashlib.blake2b(digest_size=16)
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name == "material_index" or value is None:
                hasher.update(b"-")
                continue
            hasher.update(f"{value.dtype}{value.shape}".encode())
            hasher.update(np.ascontiguousarray(value))
        return hasher.digest()

    def select(self, curve_mask):
        """Only the curves where `curve_mask` ((c,) bool) holds."""
        if curve_mask.all():
            return self
        counts = np.diff(self.offsets.astype(np.int64))
        point_mask = np.repeat(curve_mask, counts)
        offsets = np.concatenate(([0], np.cumsum(counts[curve_mask]))).astype(np.uint32)

        def pick(values, mask):
            return None if values is None else values[mask]

        return CurveArrays(
            points=self.points[point_mask],
            offsets=offsets,
            closed=self.closed[curve_mask],
            basis=self.basis[curve_mask],
            radii=self.radii[point_mask],
            nurbs_order=pick(self.nurbs_order, curve_mask),
            nurbs_weights=pick(self.nurbs_weights, point_mask),
            nurbs_knots_mode=pick(self.nurbs_knots_mode, curve_mask),
            length_coordinates=pick(self.length_coordinates, point_mask),
            material_index=pick(self.material_index, curve_mask),
        )

    def as_drawn(self):
        """As Blender draws them: NURBS with fewer points than their order as polylines, rings of two points open."""
        counts, basis = np.diff(self.offsets.astype(np.int64)), self.basis
        if self.nurbs_order is not None:
            basis = np.where((basis == NURBS) & (counts < self.nurbs_order), np.uint8(POLY), basis)
        return replace(self, basis=basis, closed=self.closed & ((counts > 2) | (basis == BEZIER)))

    def has_extent(self):
        """(c,) bool: whether two points of a curve differ; numbers that are none differ from all."""
        first, last = self.offsets[:-1].astype(np.int64), self.offsets[1:].astype(np.int64) - 1
        several = last > first
        differing = np.cumsum(np.append(False, (self.points[1:] != self.points[:-1]).any(axis=1)))
        several[several] = differing[last[several]] > differing[first[several]]
        return several

    def difference_from_rest(self, rest):
        """Why these curves cannot be the moved curves `rest`, in words, or None if they can."""
        if self.curve_count != rest.curve_count:
            return f"it has {self.curve_count} curves, {rest.curve_count} at rest"
        counts, rest_counts = np.diff(self.offsets.astype(np.int64)), np.diff(rest.offsets.astype(np.int64))
        if (counts != rest_counts).any():
            curve = int(np.flatnonzero(counts != rest_counts)[0])
            return f"its curve {curve} has {counts[curve]} points, {rest_counts[curve]} at rest"
        for name, what in (
            ("closed", "cyclic setting"),
            ("basis", "curve type"),
            ("nurbs_order", "NURBS order"),
            ("nurbs_knots_mode", "NURBS knots mode"),
        ):
            mine, theirs = getattr(self, name), getattr(rest, name)
            if (mine is None) != (theirs is None):
                return f"its {what} is set at one of the two only"
            if mine is not None and not np.array_equal(mine, theirs):
                curve = int(np.flatnonzero(mine != theirs)[0])
                return f"the {what} of curve {curve} differs"
        return None

    def at_rest(self, rest):
        """These curves in the shape of `rest`: this frame's radii and weights, the other's points and lengths."""
        return replace(
            rest,
            radii=self.radii,
            nurbs_weights=self.nurbs_weights,
            material_index=self.material_index,
        )


def bezier_polygons(points, left, right, offsets, closed, is_bezier):
    """Spells out the control polygons of Bézier curves among others.

    `points`, `left`, `right` are (n, 3); the other curves' points are kept as they are.
    Returns the new points, the new offsets, and for each new point the two old points it lies between
    with its share of the second one, to carry other attributes along.
    """
    counts = np.diff(offsets.astype(np.int64))
    is_bezier = is_bezier & (counts > 0)
    # A closed curve has three points per segment, an open one lacks both its outermost handles.
    new_counts = np.where(is_bezier, np.where(closed, 3 * counts, 3 * counts - 2), counts)
    new_offsets = np.concatenate(([0], np.cumsum(new_counts)))
    curve = np.repeat(np.arange(len(counts)), new_counts)
    step = np.arange(new_offsets[-1]) - new_offsets[curve]
    first, count, bezier = offsets[curve].astype(np.int64), counts[curve], is_bezier[curve]

    # Within a Bézier curve the polygon runs anchor, right handle, next left handle, next anchor.
    segment, part = np.divmod(step, 3)
    anchor = first + np.where(bezier, segment, step)
    successor = first + np.where(bezier, (segment + 1) % np.maximum(count, 1), step)
    part = np.where(bezier, part, 0)
    polygon = points[anchor].copy()
    polygon[part == 1] = right[anchor[part == 1]]
    polygon[part == 2] = left[successor[part == 2]]
    successor = np.where(part == 0, anchor, successor)
    return polygon, new_offsets.astype(np.uint32), (anchor, successor, (part / 3).astype(np.float32))


def interpolate(values, between):
    """Values per old point carried to the polygons of `bezier_polygons`; linear along each segment."""
    if values is None:
        return None
    first, second, share = between
    return (values[first] * (1 - share) + values[second] * share).astype(np.float32)


def polylines_of_wire(points, edges):
    """The polylines of a wire mesh whose vertices follow each other along every curve.

    Returns offsets ((c + 1,) uint32) and closed ((c,) bool); the points keep their order.
    """
    count = len(points)
    low, high = edges.min(axis=1), edges.max(axis=1)
    follows = np.zeros(count, bool)
    follows[high[high == low + 1]] = True
    starts = np.flatnonzero(~follows)
    offsets = np.concatenate((starts, [count])).astype(np.uint32)
    closing = np.full(count, -1)
    jumps = high > low + 1
    closing[low[jumps]] = high[jumps]
    closed = closing[starts] == offsets[1:].astype(np.int64) - 1
    return offsets, closed


def polylines(curves, most_points):
    """The control polygons of CurveArrays as lines: points (k, 3) float32 and pairs of them (m, 2) int32.

    Points are left out evenly where there are more than `most_points`.
    """
    step = -(-len(curves.points) // most_points)
    curve = np.repeat(np.arange(curves.curve_count), np.diff(curves.offsets.astype(np.int64)))[::step]
    joined = np.flatnonzero(curve[1:] == curve[:-1]).astype(np.int32)
    return np.ascontiguousarray(curves.points[::step]), np.stack((joined, joined + 1), axis=1)
