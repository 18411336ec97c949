# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as Blender's passes want them."""

import zlib

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


def cut_channels(image, first, count):
    """Channels `first` to `first + count` of a picture; 0 beyond its own. A picture of one channel stays as it is."""
    if image.ndim == 2:
        return image
    found = image[..., first : first + count]
    missing = count - found.shape[2]
    return np.pad(found, ((0, 0), (0, 0), (0, missing))) if missing else found


LINEAR_SPACES = {"Linear Rec.709", "Linear", "Non-Color", "scene_linear"}
"""Colour spaces whose 8-bit numbers are light as they are."""


def srgb_from_linear(values):
    """Display codes in 0 to 1 of light, IEC 61966-2-1."""
    return np.where(values <= 0.0031308, values * 12.92, 1.055 * np.maximum(values, 0.0) ** (1 / 2.4) - 0.055)


def linear_from_srgb(values):
    """Light of display codes in 0 to 1, IEC 61966-2-1; float32."""
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4).astype(np.float32)


def free_id(identity, taken):
    """The first id from `identity` on that is not in `taken`: for two of equal hash, which come in a stable order."""
    while identity in taken:
        identity += 1
    return identity


def stable_id(*identity):
    """A number from 1 to 2²⁴ − 1 that is the same for the same identity in every process.

    24 bits are what single precision holds exactly, in which pictures carry it.
    """
    return zlib.crc32(repr(identity).encode()) & 0xFFFFFF or 1


def look_up(ids, values):
    """The picture `ids` ((h, w) integers) with each id replaced by `values[id]`, others by 0; float32."""
    known = np.array(sorted(values), dtype=np.int64)
    if not len(known):
        return np.zeros(ids.shape, np.float32)
    of_known = np.array([values[number] for number in known], dtype=np.float32)
    place = np.minimum(np.searchsorted(known, ids), len(known) - 1)
    return np.where(known[place] == ids, of_known[place], np.float32(0))
