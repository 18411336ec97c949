from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, final

import numpy as np
import numpy.typing as npt

from .camera import Camera
from .environment import Environment
from .lights import Light
from .material import Material
from .mesh import Mesh
from .scene import Object
from .yarn import Yarn

__all__ = [
    "Adapter",
    "EnvironmentImage",
    "Renderer",
    "Texels",
    "Triangles",
    "Yarns",
    "__version__",
    "adapters",
    "check_material",
    "check_yarn",
    "cryptomatte_hash",
    "fibers",
    "knit_flat",
    "knit_mesh",
    "knit_sleeve",
    "knit_tube",
    "load",
    "load_image",
    "material_preset",
    "material_presets",
    "reference",
    "save_exr",
    "save_png",
    "set_threads",
    "sweater",
    "threads",
    "woven_flat",
    "yarn_preset",
    "yarn_presets",
]

__version__: str

@final
class Adapter:
    """A graphics adapter."""

    @property
    def name(self) -> str: ...
    @property
    def driver(self) -> str: ...
    @property
    def backend(self) -> str: ...
    @property
    def device_type(self) -> str: ...
    @property
    def has_int64_atomics(self) -> bool: ...

def adapters() -> list[Adapter]:
    """All usable adapters, the one that a renderer takes by default first."""

@final
class Yarns:
    """Yarn curves in a rest shape and a current shape: n control points, c curves.

    Length coordinates, radii and rest frames belong to the rest shape, in which they are made; `with_points` gives the
    same yarns in another shape. All arrays are read-only.

    Args:
        points: (n, 3), in any unit.
        offsets: (c + 1,), curve i owns the points offsets[i] to offsets[i + 1].
        closed: (c,) or one for all: whether the curve returns to its start.
        basis: "catmull-rom" (unless given), "linear", "bezier", "nurbs" or "b-spline" for all curves, or (c,) codes:
            0 Catmull-Rom, 1 linear, 2 Bézier, 3 NURBS, 4 B-spline.
        radii: (n,) yarn radii in the unit of the points.
        nurbs_order: (c,) or one for all, 2 to 12; 4 unless given.
        nurbs_weights: (n,), above 0.
        nurbs_knots_mode: (c,) or one for all: 0 normal, 1 endpoint, 2 Bézier, 3 endpoint and Bézier, as in Blender.
        yarn_radius: for all points, in place of `radii`. Without either, it is estimated from the closest approach of
            neighbouring strands.
        length_coordinates: (n,) rest arc length up to each point; measured on `points` unless given.
        name: for messages.

    Raises:
        InputError: something cannot be drawn; the message names the curve, the index and the reason.
    """

    def __new__(
        cls,
        points: npt.ArrayLike,
        offsets: npt.ArrayLike,
        closed: npt.ArrayLike | None = None,
        basis: str | npt.ArrayLike | None = None,
        radii: npt.ArrayLike | None = None,
        *,
        nurbs_order: npt.ArrayLike | None = None,
        nurbs_weights: npt.ArrayLike | None = None,
        nurbs_knots_mode: npt.ArrayLike | None = None,
        yarn_radius: float | None = None,
        length_coordinates: npt.ArrayLike | None = None,
        name: str = "",
    ) -> Yarns: ...
    def with_points(self, points: npt.ArrayLike) -> Yarns:
        """The same yarns in another shape, (n, 3): the next frame of an animation."""

    @property
    def name(self) -> str: ...
    @property
    def points(self) -> npt.NDArray[np.float32]:
        """(n, 3) control points of the current shape."""

    @property
    def rest_points(self) -> npt.NDArray[np.float32]:
        """(n, 3) control points of the rest shape."""

    @property
    def offsets(self) -> npt.NDArray[np.uint32]:
        """(c + 1,)"""

    @property
    def closed(self) -> npt.NDArray[np.bool_]:
        """(c,)"""

    @property
    def basis(self) -> npt.NDArray[np.uint8]:
        """(c,) codes: 0 Catmull-Rom, 1 linear, 2 Bézier, 3 NURBS, 4 B-spline."""

    @property
    def radii(self) -> npt.NDArray[np.float32]:
        """(n,) yarn radii, above 0."""

    @property
    def length_coordinates(self) -> npt.NDArray[np.float32]:
        """(n,) arc length of the rest yarn up to each control point, from 0 for each curve."""

    @property
    def length(self) -> float:
        """Of all curves at rest."""

    def __len__(self) -> int: ...

@final
class Triangles:
    """A surface, object space."""

    def __new__(
        cls,
        positions: npt.NDArray[np.float32],
        triangles: npt.NDArray[np.uint32],
        normals: npt.NDArray[np.float32] | None,
        uvs: npt.NDArray[np.float32] | None,
    ) -> Triangles: ...
    def __len__(self) -> int: ...

@final
class Texels:
    """A picture of colours on surfaces."""

    def __new__(cls, codes: npt.NDArray[np.uint8]) -> Texels: ...
    @property
    def size(self) -> tuple[int, int]: ...

@final
class EnvironmentImage:
    """A picture of the sky with what finds its bright parts."""

    def __new__(cls, radiance: npt.NDArray[np.float32]) -> EnvironmentImage: ...
    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""

@final
class Renderer:
    def __new__(cls, adapter: str | None) -> Renderer: ...
    @property
    def adapter(self) -> Adapter: ...
    def render(
        self,
        objects: Sequence[Object],
        meshes: Sequence[tuple[Mesh, int]],
        lights: Sequence[Light],
        ambient: tuple[float, float, float],
        environment: Environment | None,
        camera: Camera,
        later: Sequence[tuple[Sequence[Object], Sequence[tuple[Mesh, int]], Camera]],
        neighbours: Sequence[tuple[Sequence[Object], Sequence[tuple[Mesh, int]], Camera]],
        settings: Mapping[str, Any],
        progress: Callable[[float], bool | None] | None,
    ) -> tuple[dict[str, npt.NDArray[Any]], dict[str, Any]]: ...

def fibers(
    yarns: Yarns,
    yarn: Yarn,
    chord_error: float,
    object_id: int,
    view: tuple[Camera, tuple[int, int], float] | None,
    progress: Callable[[float], bool | None] | None,
) -> list[npt.NDArray[Any]]: ...
def reference(
    objects: Sequence[Object],
    meshes: Sequence[tuple[Mesh, int]],
    lights: Sequence[Light],
    ambient: tuple[float, float, float],
    environment: Environment | None,
    camera: Camera,
    later: Sequence[tuple[Sequence[Object], Sequence[tuple[Mesh, int]], Camera]],
    settings: Mapping[str, Any],
    checkpoint: Path | None,
    progress: Callable[[float], bool | None] | None,
) -> tuple[dict[str, npt.NDArray[Any]], dict[str, Any]]: ...
def load(path: Path, yarn_radius: float | None) -> Yarns: ...
def load_image(path: Path) -> npt.NDArray[np.float32]: ...
def save_png(path: Path, combined: npt.NDArray[np.float32], bits: int) -> None: ...
def save_exr(
    path: Path, passes: Sequence[tuple[Sequence[str], npt.NDArray[Any]]], metadata: Mapping[str, str]
) -> None: ...
def set_threads(count: int) -> bool:
    """Threads for all that runs on the processor: tables and the path tracer. False once such work has begun."""

def threads() -> int:
    """How many there are of those."""

def cryptomatte_hash(name: str) -> int: ...
def check_yarn(yarn: Yarn) -> None: ...
def yarn_presets() -> tuple[str, ...]: ...
def yarn_preset(name: str) -> dict[str, Any]: ...
def check_material(material: Material) -> None: ...
def material_presets() -> tuple[str, ...]: ...
def material_preset(name: str) -> dict[str, Any]: ...
def knit_flat(stitches: str, courses: int, wales: int, yarn_radius: float) -> Yarns: ...
def knit_tube(stitches: str, courses: int, wales: int, yarn_radius: float) -> Yarns: ...
def knit_sleeve(
    centre_line: Sequence[Sequence[float]],
    radius: float,
    seam_direction: Sequence[float],
    stitches: str,
    courses: int,
    wales: int,
    yarn_radius: float,
) -> Yarns: ...
def knit_mesh(
    positions: npt.ArrayLike,
    normals: npt.ArrayLike,
    triangles: npt.ArrayLike,
    uvs: npt.ArrayLike,
    stitches: str,
    yarn_radius: float,
) -> tuple[Yarns, npt.NDArray[np.uint32], npt.NDArray[np.float32], npt.NDArray[np.float32]]: ...
def sweater(points: int) -> Yarns: ...
def woven_flat(crossings: str, warp: int, weft: int, yarn_radius: float, spacing: float) -> Yarns: ...
