# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as flat arrays."""

import functools
import hashlib
from dataclasses import dataclass

import numpy as np

SHADED, SHADOW_CATCHER, HOLDOUT = "shaded", "shadow-catcher", "holdout"
"""Kinds, as the native module names them."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles in object space."""

    positions: np.ndarray
    """(n, 3) float32, metres."""
    triangles: np.ndarray
    """(m, 3) int32."""
    normals: np.ndarray | None
    """(m, 3, 3) float32 at the corners; None if it is flat."""
    uvs: np.ndarray | None = None
    """(m, 3, 2) float32 at the corners: places on a picture; None without one."""

    @functools.cached_property
    def digest(self):
        """Equal for equal surfaces."""
        hasher = hashlib.blake2b(digest_size=16)
        for array in (self.positions, self.triangles, self.normals, self.uvs):
            hasher.update(b"-" if array is None else str(array.shape).encode())
            if array is not None:
                hasher.update(np.ascontiguousarray(array))
        return hasher.digest()

    def corresponds(self, other):
        """Whether it is the other with its corners moved."""
        return (
            self.positions.shape == other.positions.shape
            and np.array_equal(self.triangles, other.triangles)
            and (self.normals is None) == (other.normals is None)
            and (self.uvs is None) == (other.uvs is None)
        )


def by_material(positions, triangles, normals, material_index, uvs):
    """[(index, Surface)]: the triangles of each material, with the positions that they have. `uvs(index)` gives the
    places on the material's picture of all triangles, or None."""
    parts = []
    for index in np.unique(material_index):
        mine = material_index == index
        places = uvs(int(index))
        if mine.all():
            parts.append((int(index), Surface(positions, triangles, normals, places)))
            continue
        used, corners = np.unique(triangles[mine], return_inverse=True)
        surface = Surface(
            positions[used],
            corners.reshape(-1, 3).astype(np.int32),
            None if normals is None else normals[mine],
            None if places is None else places[mine],
        )
        parts.append((int(index), surface))
    return parts
