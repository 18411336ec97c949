# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables that turn scene-linear colours into what a display shows, for view transforms of any kind.

A table holds display codes at lattice points. Along each channel they lie evenly in log2(1 + 256 x), with x scaled by
2^exposure, up to x = 64: what a view transform can tell apart in the dark and in the light.
"""

import numpy as np

SIZE = 48
"""Lattice points along a channel."""

STEEPNESS = 256.0
BRIGHTEST = 64.0

_STOPS = np.log2(1 + STEEPNESS * BRIGHTEST)


def lattice(exposure):
    """(SIZE³, 3) float32 scene-linear colours, red fastest."""
    along = (np.exp2(np.linspace(0, _STOPS, SIZE)) - 1) / (STEEPNESS * 2.0**exposure)
    blue, green, red = np.meshgrid(along, along, along, indexing="ij")
    return np.stack((red, green, blue), axis=-1).reshape(-1, 3).astype(np.float32)


def scales(exposure):
    """(a, b): a channel x lies b log2(1 + a x) of the way along the table."""
    return STEEPNESS * 2.0**exposure, 1 / _STOPS


def look_up(codes, exposure, color):
    """The display codes of a scene-linear (r, g, b), linear between lattice points; `codes` is (SIZE³, 3)."""
    a, b = scales(exposure)
    place = np.clip(np.log2(1 + a * np.maximum(color, 0)) * b, 0, 1) * (SIZE - 1)
    low = np.minimum(place.astype(int), SIZE - 2)
    share = place - low
    table = np.asarray(codes).reshape(SIZE, SIZE, SIZE, 3)
    for axis in (2, 1, 0):  # blue, green, red: each drops the first axis
        first = low[axis]
        table = table[first] * (1 - share[axis]) + table[first + 1] * share[axis]
    return table
