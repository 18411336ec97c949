# SPDX-License-Identifier: GPL-3.0-or-later
"""A view of the scene in a rectangle of the screen."""

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class View:
    """A camera that fills `size` pixels, and the part of them that is drawn."""

    world_from_camera: np.ndarray
    """(4, 4) float64; looks down its −Z, Y is up."""
    clip_from_camera: np.ndarray
    """(4, 4) float64, OpenGL's clip space."""
    size: tuple
    """(w, h) pixels."""
    region: tuple
    """(x0, y0, x1, y1) pixels from the bottom left, end exclusive; empty if x0 = x1 or y0 = y1."""
    lens: dict = field(default_factory=dict)
    """What `lisle.Camera` takes to blur what is out of focus; nothing for a pinhole."""

    def key(self):
        """Equal for equal views."""
        lens = tuple(sorted(self.lens.items()))
        return self.world_from_camera.tobytes(), self.clip_from_camera.tobytes(), self.size, self.region, lens

    @property
    def is_empty(self):
        x0, y0, x1, y1 = self.region
        return x0 >= x1 or y0 >= y1


def part_of(frame, border):
    """The part `border` (min_x, min_y, max_x, max_y in 0 to 1) of a rectangle `frame` (x0, y0, x1, y1)."""
    x0, y0, x1, y1 = frame
    return (
        x0 + border[0] * (x1 - x0), y0 + border[1] * (y1 - y0), x0 + border[2] * (x1 - x0), y0 + border[3] * (y1 - y0),
    )  # fmt: skip


def whole_pixels(rectangle, size):
    """A rectangle in pixels rounded and cut to a view of `size` = (w, h)."""
    limits = (*size, *size)
    return tuple(min(max(round(edge), 0), limit) for edge, limit in zip(rectangle, limits, strict=True))


def camera_frame(corners, clip_from_camera, size):
    """The rectangle (x0, y0, x1, y1) in pixels that a camera's frame fills in a view through it.

    `corners` are (4, 3), in camera space.
    """
    homogeneous = np.concatenate((corners, np.ones((len(corners), 1))), axis=1) @ clip_from_camera.T
    pixels = (homogeneous[:, :2] / homogeneous[:, 3:] + 1) / 2 * size
    return (*pixels.min(axis=0), *pixels.max(axis=0))
