"""A rendered picture."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from .errors import InputError

PASSES = ("combined", "depth", "alpha", "normal", "tangent", "object_id", "variance")


class Image(Mapping[str, npt.NDArray[Any]]):
    """The passes of a picture by name; row 0 is the top.

    | pass | shape | meaning |
    |---|---|---|
    | combined | (h, w, 4) f32 | scene-linear Rec.709, premultiplied alpha |
    | depth | (h, w) f32 | metres along the view axis, 1e10 where nothing is |
    | alpha | (h, w) f32 | coverage, 0 to 1 |
    | normal | (h, w, 3) f32 | world space |
    | tangent | (h, w, 3) f32 | direction of the fiber, world space |
    | object_id | (h, w) u32 | 0 where nothing is |
    | variance | (h, w, 3) f32 | of the means in `combined`: standard errors squared; by `Reference` alone |
    """

    statistics: dict[str, Any]
    """What drawing took: segments drawn, milliseconds by pass, memory on the device."""

    def __init__(self, passes: Mapping[str, npt.NDArray[Any]], statistics: dict[str, Any]) -> None:
        self._passes = dict(passes)
        self._passes["alpha"] = self._passes["combined"][..., 3]
        self.statistics = statistics

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        try:
            return self._passes[name]
        except KeyError:
            raise KeyError(f"no pass {name!r}: expected {', '.join(self)}") from None

    def __iter__(self) -> Iterator[str]:
        return (name for name in PASSES if name in self._passes)

    def __len__(self) -> int:
        return len(self._passes)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        height, width = self._passes["combined"].shape[:2]
        return width, height

    def save(self, path: str | Path, bits: int = 8) -> None:
        """Writes a file, whole or not at all.

        Args:
            path: `.png` for the combined pass in sRGB with straight alpha, or `.exr` for all passes, scene-linear.
            bits: per channel of a PNG, 8 or 16.
        """
        path = Path(path)
        suffix = path.suffix.lower()
        if suffix == ".png":
            if bits not in (8, 16):
                raise InputError(f"bits: a PNG has 8 or 16, not {bits}")
            _native.save_png(path, np.ascontiguousarray(self["combined"]), bits)
        elif suffix == ".exr":
            passes = {name: np.ascontiguousarray(self[name]) for name in self if name != "alpha"}
            _native.save_exr(path, **passes)
        else:
            raise InputError(f"{path}: unknown kind of picture {suffix!r}: expected .png or .exr")
