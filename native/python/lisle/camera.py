"""The camera."""

from dataclasses import dataclass
from math import hypot, tan

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from ._arguments import Vector
from ._native import Yarns
from .errors import InputError

FIT_ANGLE_RAD = 0.6
"""Vertical opening angle of a fitted camera: a short portrait lens."""

FIT_MARGIN = 1.05
"""How much room a fitted camera leaves around the yarns, as a factor on their extent."""

MOST_BLADES = 1000

FIT_DEPTH = 100.0
"""Clip planes of a fitted camera: its distance divided and multiplied by this, so that animated yarns stay inside."""


@dataclass(frozen=True, eq=False)
class Camera:
    """A viewpoint: perspective or orthographic, with or without lens shift, as two matrices, and a lens.

    `dataclasses.replace(camera, aperture_radius=0.002, focus_distance=0.3)` is the same view through a lens that blurs
    what is out of focus.

    Args:
        world_from_camera: 4×4, camera to world; the camera looks down its −Z, Y is up.
        clip_from_camera: 4×4, projection to OpenGL's clip space (z from −1 to 1).
        size: width and height of the picture, pixels.
        aperture_radius: of the lens, to its corners if it has blades, in the unit of the scene; 0 for a pinhole, which
            has everything in focus. A photographer's lens has half its focal length divided by its f-stop.
        focus_distance: of the plane in focus, along the view axis.
        blades: sides of a polygonal aperture; below 3 for a round one.
        rotation_rad: turns the polygon counterclockwise. Without it a side lies to the right.
        ratio: the aperture is this many times as high as it is wide, for the bokeh of an anamorphic lens.
    """

    world_from_camera: npt.NDArray[np.float64]
    clip_from_camera: npt.NDArray[np.float64]
    size: tuple[int, int]
    aperture_radius: float = 0.0
    focus_distance: float = 1.0
    blades: int = 0
    rotation_rad: float = 0.0
    ratio: float = 1.0

    def __post_init__(self) -> None:
        for name in ("world_from_camera", "clip_from_camera"):
            matrix = arguments.matrix(f"Camera.{name}", getattr(self, name))
            if np.linalg.det(matrix) == 0.0:
                raise InputError(f"Camera.{name}: the matrix is singular")
            object.__setattr__(self, name, matrix)
        object.__setattr__(self, "size", arguments.pixels("Camera.size", self.size))
        for name in ("aperture_radius", "focus_distance", "rotation_rad", "ratio"):
            object.__setattr__(self, name, arguments.number(f"Camera.{name}", getattr(self, name)))
        if self.aperture_radius < 0.0:
            raise InputError(f"Camera.aperture_radius: {self.aperture_radius} is below 0")
        for name in ("focus_distance", "ratio"):
            if getattr(self, name) <= 0.0:
                raise InputError(f"Camera.{name}: {getattr(self, name)} is not above 0")
        object.__setattr__(self, "blades", arguments.integer("Camera.blades", self.blades))
        if not 0 <= self.blades <= MOST_BLADES:
            raise InputError(f"Camera.blades: {self.blades} is not from 0 to {MOST_BLADES}")

    @classmethod
    def from_matrices(
        cls, world_from_camera: npt.ArrayLike, clip_from_camera: npt.ArrayLike, size: tuple[int, int]
    ) -> "Camera":
        """A camera from its two 4×4 matrices, which act on column vectors."""
        return cls(np.asarray(world_from_camera), np.asarray(clip_from_camera), size)

    @classmethod
    def fit(cls, yarns: Yarns, direction: Vector = (0, -1, 0.3), size: tuple[int, int] = (1280, 960)) -> "Camera":
        """A perspective camera that sees all the yarns.

        Args:
            yarns: what to look at.
            direction: from the yarns to the camera; of any length.
            size: width and height of the picture, pixels.
        """
        width, height = arguments.pixels("size", size)
        backward = np.array(arguments.direction("direction", direction))
        backward /= np.linalg.norm(backward)
        # Looking straight up or down, north is up.
        north = np.array([0.0, 0.0, 1.0]) if hypot(backward[0], backward[1]) > 1e-6 else np.array([0.0, 1.0, 0.0])
        right = np.cross(north, backward)
        right /= np.linalg.norm(right)
        camera_from_world = np.stack([right, np.cross(backward, right), backward])

        points = yarns.points.astype(np.float64)
        radius = float(yarns.radii.max())
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        local = (points - middle) @ camera_from_world.T
        low, high = local.min(axis=0), local.max(axis=0)
        centre = 0.5 * (low + high)
        local -= centre
        tangent_y = tan(0.5 * FIT_ANGLE_RAD)
        tangent_x = tangent_y * width / height
        reach = FIT_MARGIN * (np.abs(local[:, :2]) + radius)
        distance = float((local[:, 2] + np.maximum(reach[:, 0] / tangent_x, reach[:, 1] / tangent_y)).max()) + radius

        world_from_camera = np.eye(4)
        world_from_camera[:3, :3] = camera_from_world.T
        world_from_camera[:3, 3] = middle + camera_from_world.T @ (centre + np.array([0.0, 0.0, distance]))
        near, far = distance / FIT_DEPTH, distance * FIT_DEPTH
        clip_from_camera = np.array(
            [
                [1.0 / tangent_x, 0.0, 0.0, 0.0],
                [0.0, 1.0 / tangent_y, 0.0, 0.0],
                [0.0, 0.0, (near + far) / (near - far), 2.0 * near * far / (near - far)],
                [0.0, 0.0, -1.0, 0.0],
            ]
        )
        return cls(world_from_camera, clip_from_camera, (width, height))
