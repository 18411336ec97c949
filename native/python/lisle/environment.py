"""Light from all sides."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from . import _native
from .errors import InputError


class Environment:
    """A picture of the sky in equal steps of longitude and latitude, as Blender and most renderers have it.

    It lights the yarn, and stands behind it where the film is not transparent. With no rotation, the direction
    (x, y, z) lies at ½ − atan2(y, x) / 2π of the width from the left, and asin z / π + ½ of the height from the bottom.

    Args:
        image: (h, w, 3) or (h, w, 4) radiance, scene-linear Rec.709, row 0 at the top; a fourth channel is left out. Or
            the path of an .exr or .hdr file.
        rotation: angle about Z by which the sky is turned, radians, counter-clockwise from above; or a 3×3 rotation,
            from the picture's axes to the world's.
        strength: factor of the radiance, at least 0.

    Raises:
        InputError: the picture has another shape, or texels that are negative or not finite.
        OSError: the file cannot be read.
    """

    image: _native.EnvironmentImage
    """The picture, on which any number of environments can stand."""
    world_from_environment: npt.NDArray[np.float64]
    """(3, 3), a rotation."""
    strength: float

    def __init__(
        self,
        image: npt.ArrayLike | str | Path | _native.EnvironmentImage,
        rotation: float | npt.ArrayLike = 0.0,
        strength: float = 1.0,
    ) -> None:
        if isinstance(image, (str, Path)):
            image = _native.load_image(Path(image))
        self.image = image if isinstance(image, _native.EnvironmentImage) else _image(image)
        self.world_from_environment = _rotation(rotation)
        self.strength = arguments.number("Environment.strength", strength)
        if self.strength < 0.0:
            raise InputError(f"Environment.strength: {self.strength} is less than 0")

    def __repr__(self) -> str:
        width, height = self.image.size
        return f"Environment({width}×{height}, strength={self.strength})"


def _image(image: npt.ArrayLike) -> _native.EnvironmentImage:
    try:
        array = np.asarray(image, np.float32)
    except (TypeError, ValueError):
        raise InputError(f"Environment: expected a picture, got {type(image).__name__}") from None
    if array.ndim != 3 or array.shape[2] not in (3, 4):
        raise InputError(f"Environment: expected shape (h, w, 3) or (h, w, 4), got {array.shape}")
    return _native.EnvironmentImage(np.ascontiguousarray(array[:, :, :3]))


def _rotation(rotation: float | npt.ArrayLike) -> npt.NDArray[np.float64]:
    try:
        matrix = np.array(rotation, np.float64)
    except (TypeError, ValueError):
        raise InputError(f"Environment.rotation: expected an angle or a 3×3 matrix, got {rotation!r}") from None
    if matrix.ndim == 0:
        angle = arguments.number("Environment.rotation", rotation)
        c, s = np.cos(angle), np.sin(angle)
        matrix = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    if matrix.shape != (3, 3):
        raise InputError(f"Environment.rotation: expected an angle or a 3×3 matrix, got shape {matrix.shape}")
    if not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-6):
        raise InputError("Environment.rotation: the matrix is no rotation")
    matrix.flags.writeable = False
    return matrix
