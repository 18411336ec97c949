"""A rendered picture."""

import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from .errors import InputError
from .scene import Scene

FURTHER_PASSES = (
    "position",
    "uv",
    "vector",
    "object_index",
    "material_index",
    "crypto_object",
    "crypto_material",
    "diffuse",
    "specular",
    "transmission",
    "scattered",
    "ambient",
    "shadow",
    "albedo",
    "denoising_normal",
)
"""Those that are drawn when asked for."""

PASSES = ("combined", "depth", "alpha", "normal", "tangent", "object_id", "variance", *FURTHER_PASSES)

CRYPTOMATTES = {"crypto_object": "CryptoObject", "crypto_material": "CryptoMaterial"}
"""Cryptomatte passes, and what files call them."""

CHANNELS = (
    {
        "combined": ("R", "G", "B", "A"),
        "depth": ("Z",),
        "normal": ("normal.X", "normal.Y", "normal.Z"),
        "tangent": ("tangent.X", "tangent.Y", "tangent.Z"),
        "object_id": ("object_id",),
        "variance": ("variance.R", "variance.G", "variance.B"),
        "position": ("position.X", "position.Y", "position.Z"),
        "uv": ("uv.U", "uv.V"),
        "vector": ("vector.X", "vector.Y", "vector.Z", "vector.W"),
        "object_index": ("object_index",),
        "material_index": ("material_index",),
        "shadow": ("shadow",),
        "denoising_normal": ("denoising_normal.X", "denoising_normal.Y", "denoising_normal.Z"),
    }
    | {
        name: tuple(f"{name}.{channel}" for channel in "RGB")
        for name in ("diffuse", "specular", "transmission", "scattered", "ambient", "albedo")
    }
    | {
        name: tuple(f"{layer}{rank:02}.{channel}" for rank in range(3) for channel in "RGBA")
        for name, layer in CRYPTOMATTES.items()
    }
)
"""Of an EXR, by pass."""


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

    Depth, object id and what is marked * belong to the pixel's centre, all else to the whole pixel. By `Renderer`, when
    asked for:

    | pass | shape | meaning |
    |---|---|---|
    | position * | (h, w, 3) f32 | world space, 0 where nothing is |
    | uv * | (h, w, 2) f32 | length coordinate along the yarn, angle around it from its normal in turns, 0 to 1 |
    | vector * | (h, w, 4) f32 | movement on the picture, see below |
    | object_index * | (h, w) f32 | `object_index` of the object or mesh |
    | material_index * | (h, w) f32 | `material_index`, likewise |
    | crypto_object | (h, w, 12) f32 | six pairs of id and coverage, for names, as Cryptomatte has them |
    | crypto_material | (h, w, 12) f32 | the same for `material_name` |
    | diffuse, specular, transmission | (h, w, 3) f32 | light of lamps scattered once, by the lobe of the fiber |
    | scattered | (h, w, 3) f32 | light of lamps scattered more than once |
    | ambient | (h, w, 3) f32 | ambient light; with those above it adds up to the colour of the yarn |
    | shadow | (h, w) f32 | share of the lamps' light that shadows leave, premultiplied |
    | albedo | (h, w, 3) f32 | colour without light, premultiplied, for a denoiser |
    | denoising_normal | (h, w, 3) f32 | mean normal, world space, not of unit length |

    "vector" is in pixels, X to the right, Y up: the place one frame before minus the present one, then the present one
    minus the place one frame after, as in Blender.
    """

    statistics: dict[str, Any]
    """What drawing took: segments drawn, milliseconds by pass, memory on the device."""

    manifests: dict[str, dict[str, int]]
    """Of each Cryptomatte pass: its names, and their hashes, of which an id is the float."""

    def __init__(
        self,
        passes: Mapping[str, npt.NDArray[Any]],
        statistics: dict[str, Any],
        manifests: dict[str, dict[str, int]] | None = None,
    ) -> None:
        self._passes = dict(passes)
        self._passes["alpha"] = self._passes["combined"][..., 3]
        self.statistics = statistics
        self.manifests = manifests or {}

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

    def cryptomatte_metadata(self, layer_prefix: str = "") -> dict[str, str]:
        """What a file says of its Cryptomatte passes, as the specification wants it: text by attribute.

        Args:
            layer_prefix: what names of channels begin with before "CryptoObject" and "CryptoMaterial".
        """
        return cryptomatte_metadata(self.manifests, layer_prefix)

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
            channels = [(CHANNELS[name], np.ascontiguousarray(self[name])) for name in self if name != "alpha"]
            _native.save_exr(path, channels, self.cryptomatte_metadata())
        else:
            raise InputError(f"{path}: unknown kind of picture {suffix!r}: expected .png or .exr")


def manifests(scene: Scene, passes: Iterable[str]) -> dict[str, dict[str, int]]:
    """Names and hashes of the Cryptomatte passes among those."""
    names = {
        "crypto_object": [entry.name for entry in scene.objects] + [mesh.name for mesh in scene.meshes],
        "crypto_material": [entry.material_name for entry in scene.objects]
        + [mesh.material_name for mesh in scene.meshes],
    }
    return {
        key: {name: _native.cryptomatte_hash(name) for name in sorted(set(names[key]))}
        for key in CRYPTOMATTES
        if key in passes
    }


def cryptomatte_metadata(manifests: Mapping[str, Mapping[str, int]], layer_prefix: str = "") -> dict[str, str]:
    """What a file says of its Cryptomatte passes, as the specification wants it."""
    metadata: dict[str, str] = {}
    for key, manifest in manifests.items():
        layer = layer_prefix + CRYPTOMATTES[key]
        prefix = f"cryptomatte/{_native.cryptomatte_hash(layer):08x}"[: len("cryptomatte/") + 7]
        hashes = {name: f"{number:08x}" for name, number in manifest.items()}
        metadata |= {
            f"{prefix}/name": layer,
            f"{prefix}/hash": "MurmurHash3_32",
            f"{prefix}/conversion": "uint32_to_float32",
            f"{prefix}/manifest": json.dumps(hashes, separators=(",", ":")),
        }
    return metadata
