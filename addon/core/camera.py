# SPDX-License-Identifier: GPL-3.0-or-later
"""Matrices and pixel rectangles of a view."""

import numpy as np


def without_scale(world_from_object):
    """A (4, 4) float64 matrix with the axes brought to unit length, as Blender uses for cameras and lights."""
    matrix = np.array(world_from_object, dtype=np.float64)
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    matrix[:3, :3] /= np.where(lengths > 0, lengths, 1)
    return matrix


def border_pixels(border, size):
    """The pixels of a render border: (x0, y0, x1, y1), origin bottom left, end exclusive.

    `border` is (min_x, min_y, max_x, max_y) in 0 to 1, `size` the full frame. Blender multiplies in
    single precision and cuts the fraction off; in double precision a quarter of all borders come out a pixel off.
    """
    scale = np.array((*size, *size), dtype=np.float32)
    x0, y0, x1, y1 = (int(edge) for edge in np.array(border, dtype=np.float32) * scale)
    return x0, y0, x1, y1
