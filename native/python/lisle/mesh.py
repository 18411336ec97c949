"""Surfaces among the yarns."""

import copy
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from . import _native
from ._arguments import Triple, Vector
from .errors import InputError

Kind = Literal["shaded", "shadow-catcher", "holdout"]
KINDS = ("shaded", "shadow-catcher", "holdout")


class Mesh:
    """Triangles that hide yarn and are hidden by it, throw shadows and take them.

    Args:
        positions: (n, 3), object space.
        triangles: (m, 3) places of corners among the positions.
        normals: (n, 3) at positions or (m, 3, 3) at the corners of triangles, of any length; flat unless given.
        base_color: share of the light that the matt surface gives back, scene-linear Rec.709, 0 to 1.
        kind: "shaded", "shadow-catcher" (only the shadows on it, as coverage) or "holdout" (a hole in the picture).
        transform: 4×4, object to world.
        object_id: the number in the object-id pass, above 0; in a scene, those without one count on from its yarns.
        name: for messages, and in the pass "crypto_object".
        object_index: the number in the pass "object_index", which need not be unique.
        material_name: the name in the pass "crypto_material".
        material_index: the number in the pass "material_index".

    Raises:
        InputError: an array has another shape, a number is not finite, or a corner does not exist.
    """

    triangles: _native.Triangles
    """The geometry, which instances share."""
    base_color: Triple
    kind: Kind
    world_from_object: npt.NDArray[np.float64]
    object_id: int | None
    name: str
    object_index: int
    material_name: str
    material_index: int

    def __init__(
        self,
        positions: npt.ArrayLike,
        triangles: npt.ArrayLike,
        normals: npt.ArrayLike | None = None,
        *,
        base_color: Vector = (0.8, 0.8, 0.8),
        kind: Kind = "shaded",
        transform: npt.ArrayLike | None = None,
        object_id: int | None = None,
        name: str = "mesh",
        object_index: int = 0,
        material_name: str = "",
        material_index: int = 0,
    ) -> None:
        self.name = name
        self.object_index = arguments.label_index(f"{name}: object_index", object_index)
        self.material_name = str(material_name)
        self.material_index = arguments.label_index(f"{name}: material_index", material_index)
        self.triangles = _triangles(name, positions, triangles, normals)
        self.base_color = arguments.triple(f"{name}: base_color", base_color)
        if not all(0.0 <= channel <= 1.0 for channel in self.base_color):
            raise InputError(f"{name}: base_color: {self.base_color} is not from 0 to 1")
        if kind not in KINDS:
            raise InputError(f"{name}: kind: {kind!r} is none of {', '.join(KINDS)}")
        self.kind = kind
        self._place(np.eye(4) if transform is None else transform, object_id)

    def at(
        self,
        transform: npt.ArrayLike,
        object_id: int | None = None,
        name: str | None = None,
        object_index: int | None = None,
    ) -> "Mesh":
        """The same surface at another place; both share their geometry on the device."""
        other = copy.copy(self)
        other.name = self.name if name is None else name
        if object_index is not None:
            other.object_index = arguments.label_index(f"{other.name}: object_index", object_index)
        other._place(transform, object_id)
        return other

    def _place(self, transform: npt.ArrayLike, object_id: int | None) -> None:
        self.world_from_object = arguments.matrix(f"{self.name}: transform", transform)
        self.object_id = None if object_id is None else arguments.object_id(self.name, object_id)

    def __repr__(self) -> str:
        return f"Mesh({self.name!r}, {len(self.triangles)} triangles, {self.kind!r})"


def _triangles(
    name: str, positions: npt.ArrayLike, triangles: npt.ArrayLike, normals: npt.ArrayLike | None
) -> _native.Triangles:
    points: npt.NDArray[np.float32] = _array(f"{name}: positions", positions, np.float32)
    corners: npt.NDArray[np.int64] = _array(f"{name}: triangles", triangles, np.int64)
    outside = ((corners < 0) | (corners >= len(points))).any(axis=1)
    if outside.any():
        wrong = int(np.argmax(outside))
        raise InputError(
            f"{name}: triangle {wrong} is {corners[wrong].tolist()}, but there are {len(points)} positions"
        )
    at_corners = None
    if normals is not None:
        try:
            at_corners = np.asarray(normals, np.float32)
        except (TypeError, ValueError):
            raise InputError(f"{name}: normals: expected an array, got {type(normals).__name__}") from None
        if at_corners.shape == points.shape and at_corners.shape != (*corners.shape, 3):
            at_corners = at_corners[corners]
        if at_corners.shape != (*corners.shape, 3):
            raise InputError(
                f"{name}: normals: expected shape {points.shape} or {(*corners.shape, 3)}, got {at_corners.shape}"
            )
        at_corners = np.ascontiguousarray(at_corners)
    return _native.Triangles(points, corners.astype(np.uint32), at_corners)


def _array(name: str, value: npt.ArrayLike, kind: type[np.generic]) -> npt.NDArray[Any]:
    try:
        array = np.asarray(value)
        array = np.ascontiguousarray(array, kind)
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected an array of shape (n, 3), got {type(value).__name__}") from None
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"{name}: expected shape (n, 3), got {array.shape}")
    return array
