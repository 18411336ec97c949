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
        uvs: (m, 3, 2) places on the texture at the corners of triangles.
        texture: that share by place, in the stead of `base_color`.
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
    texels: _native.Texels | None
    """Of the texture."""
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
        uvs: npt.ArrayLike | None = None,
        texture: "Texture | None" = None,
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
        self.triangles = _triangles(name, positions, triangles, normals, uvs)
        if not isinstance(texture, Texture | None):
            raise InputError(f"{name}: texture: expected a lisle.Texture, got {type(texture).__name__}")
        if texture is not None and uvs is None:
            raise InputError(f"{name}: texture: it needs uvs")
        self.texels = None if texture is None else texture.texels
        # The path tracer has one colour for all of it.
        color = base_color if texture is None else texture.mean
        self.base_color = arguments.triple(f"{name}: base_color", color)
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


class Texture:
    """A picture of colours on surfaces, repeated endlessly, with (0, 0) at its bottom left and (1, 1) at its top right.

    Args:
        codes: (h, w, 3) or (h, w, 4) uint8 sRGB codes, row 0 at the top; a fourth channel is left out.

    Raises:
        InputError: the picture has another shape or type.
    """

    texels: _native.Texels
    """The picture on the device's side."""
    mean: Triple
    """Its mean colour, scene-linear Rec.709."""

    def __init__(self, codes: npt.ArrayLike) -> None:
        array = np.asarray(codes)
        if array.ndim != 3 or array.shape[2] not in (3, 4) or 0 in array.shape or array.dtype != np.uint8:
            raise InputError(f"Texture: expected (h, w, 3) or (h, w, 4) uint8, got {array.shape} {array.dtype}")
        texels = np.full((*array.shape[:2], 4), 255, np.uint8)
        texels[..., :3] = array[::-1, :, :3]
        self.texels = _native.Texels(texels)
        code = np.arange(256) / 255
        light = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)
        counts = (np.bincount(texels[..., channel].ravel(), minlength=256) for channel in range(3))
        red, green, blue = (float(light @ count) / texels[..., 0].size for count in counts)
        self.mean = (red, green, blue)

    def __repr__(self) -> str:
        width, height = self.texels.size
        return f"Texture({width}×{height})"


def _triangles(
    name: str,
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    normals: npt.ArrayLike | None,
    uvs: npt.ArrayLike | None,
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
        at_corners = _floats(f"{name}: normals", normals)
        if at_corners.shape == points.shape and at_corners.shape != (*corners.shape, 3):
            at_corners = at_corners[corners]
        if at_corners.shape != (*corners.shape, 3):
            raise InputError(
                f"{name}: normals: expected shape {points.shape} or {(*corners.shape, 3)}, got {at_corners.shape}"
            )
        at_corners = np.ascontiguousarray(at_corners)
    places = None
    if uvs is not None:
        places = np.ascontiguousarray(_floats(f"{name}: uvs", uvs))
        if places.shape != (*corners.shape, 2):
            raise InputError(f"{name}: uvs: expected shape {(*corners.shape, 2)}, got {places.shape}")
    return _native.Triangles(points, corners.astype(np.uint32), at_corners, places)


def _floats(name: str, value: npt.ArrayLike) -> npt.NDArray[np.float32]:
    try:
        return np.asarray(value, np.float32)
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected an array, got {type(value).__name__}") from None


def _array(name: str, value: npt.ArrayLike, kind: type[np.generic]) -> npt.NDArray[Any]:
    try:
        array = np.asarray(value)
        array = np.ascontiguousarray(array, kind)
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected an array of shape (n, 3), got {type(value).__name__}") from None
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"{name}: expected shape (n, 3), got {array.shape}")
    return array
