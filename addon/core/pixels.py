# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as Blender's passes want them."""

import numpy as np


def pass_rect(image, channels, size):
    """A picture with its top row first, as the flat rectangle of a pass: bottom row first, float32.

    `image` is (h, w) or (h, w, c); `size` is (w, h) of the pass. Raises ValueError if they do not fit,
    because Blender reads as many values as the pass has, whatever it is given.
    """
    array = np.asarray(image, dtype=np.float32)
    expected = (size[1], size[0]) if channels == 1 else (size[1], size[0], channels)
    if array.ndim == 3 and channels == 1 and array.shape[2] == 1:
        array = array[:, :, 0]
    if array.shape != expected:
        raise ValueError(f"picture of shape {array.shape} for a pass of shape {expected}")
    return array[::-1].ravel()
