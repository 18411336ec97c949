# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of curves: cut out of them without a change of the shape that is left.

A place on a curve is a number of segments from its first point, with a fraction in the parameter of its polynomial.
"""

from dataclasses import replace

import numpy as np

from .curves import BEZIER, POLY

RESOLUTION, SEGMENTS, SPLINE = "RESOLUTION", "SEGMENTS", "SPLINE"
"""What a share of a curve is a share of: of its parameter; of its length, but of the parameter within a segment; of its
length. Named as Blender does."""

_LEAST = 1e-6
"""Of a segment: what is shorter is nothing."""

_STEPS = 32
"""Chords to a Bézier segment where lengths are measured."""


def places(curves, start, end):
    """(c, 2) float64 places where each curve begins and ends if the rest is cut off: `start` and `end` are (share,
    kind), in any order. Closed curves and NURBS are whole."""
    found = np.zeros((curves.curve_count, 2))
    for curve in range(curves.curve_count):
        points = curves.points[curves.offsets[curve] : curves.offsets[curve + 1]].astype(np.float64)
        if not can_cut(curves, curve):
            found[curve, 1] = len(points)
            continue
        found[curve] = sorted(_place(points, curves.basis[curve], *each) for each in (start, end))
    return found


def can_cut(curves, curve):
    """Whether a part of a curve is a curve of the same kind."""
    return not curves.closed[curve] and curves.basis[curve] in (POLY, BEZIER)


def cut(curves, parts):
    """Only the `parts` ((c, 2) places) of CurveArrays; a curve of which there is nothing is dropped. And (c',) float32
    metres: how long what was cut off at the beginning of each is."""
    there = parts[:, 1] - parts[:, 0] > _LEAST
    curves, parts = curves.select(there), parts[there]
    if not there.any():
        return curves, np.zeros(0, np.float32)
    weights = np.ones(len(curves.points), np.float32) if curves.nurbs_weights is None else curves.nurbs_weights
    values = np.column_stack((curves.points, curves.radii, weights)).astype(np.float64)
    pieces, skipped = [], []
    for curve, (begin, end) in enumerate(parts):
        piece = values[curves.offsets[curve] : curves.offsets[curve + 1]]
        skipped.append(0.0)
        if can_cut(curves, curve):
            cumulative, degree = _lengths(piece[:, :3], curves.basis[curve])
            skipped[-1] = _at(cumulative, (len(piece) - 1) // degree, begin)
            piece = _part(piece, degree, begin, end)
        pieces.append(piece)
    values = np.concatenate(pieces).astype(np.float32)
    cut_curves = replace(
        curves,
        points=np.ascontiguousarray(values[:, :3]),
        radii=values[:, 3].copy(),
        nurbs_weights=None if curves.nurbs_weights is None else values[:, 4].copy(),
        offsets=np.concatenate(([0], np.cumsum([len(piece) for piece in pieces]))).astype(np.uint32),
    )
    return cut_curves, np.array(skipped, np.float32)


def _lengths(points, basis):
    """Length of a curve up to even steps of its parameter, and its degree."""
    degree, steps = (3, _STEPS) if basis == BEZIER else (1, 1)
    corners = points
    if degree == 3:
        t = np.linspace(0, 1, steps, endpoint=False)[:, np.newaxis, np.newaxis]
        a, b, c, d = (points[place : len(points) - 3 + place : 3] for place in range(4))
        along = (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d
        corners = np.concatenate((along.swapaxes(0, 1).reshape(-1, 3), points[-1:]))
    return np.append(0, np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))), degree


def _at(cumulative, segments, place):
    return np.interp(place / segments, np.linspace(0, 1, len(cumulative)), cumulative)


def _place(points, basis, share, kind):
    """The place of a share of a curve."""
    cumulative, degree = _lengths(points, basis)
    segments = (len(points) - 1) // degree
    if kind == RESOLUTION or cumulative[-1] == 0:
        return share * segments
    even = np.linspace(0, segments, len(cumulative))
    if kind == SEGMENTS:
        step = (len(cumulative) - 1) // segments
        even, cumulative = even[::step], cumulative[::step]
    return np.interp(share * cumulative[-1], cumulative, even)


def _part(values, degree, begin, end):
    """The control values of a part of a curve of polynomials."""
    segments = (len(values) - 1) // degree
    first = min(int(begin), segments - 1)
    last = max(min(int(np.ceil(end)), segments) - 1, first)
    values = values[first * degree : (last + 1) * degree + 1].copy()
    # The end first: it does not move the parameter of what is before it.
    values[-degree - 1 :] = _split(values[-degree - 1 :], end - last)[0]
    begin -= first
    if last == first:
        begin /= end - first
    values[: degree + 1] = _split(values[: degree + 1], begin)[1]
    return values


def _split(values, share):
    """The control values of both parts of a polynomial, by de Casteljau."""
    left, right = [values[0]], [values[-1]]
    while len(values) > 1:
        values = (1 - share) * values[:-1] + share * values[1:]
        left.append(values[0])
        right.append(values[-1])
    return np.array(left), np.array(right[::-1])
