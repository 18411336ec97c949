# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels of Blender's images."""

import numpy as np

from ..core.pixels import LINEAR_SPACES


def colours_of(image):
    """(h, w, 3) float32 as the image has them, row 0 at the top; one channel counts for all three."""
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, image.channels)[::-1]
    return pixels[:, :, :3] if image.channels >= 3 else np.repeat(pixels[:, :, :1], 3, axis=2)


def is_linear(image, space):
    """Whether colours of an image in that space are scene-linear: Blender brings pictures of floats into its scene's
    space when it loads them."""
    return image.is_float or space in LINEAR_SPACES
