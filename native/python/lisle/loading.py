"""Yarn curves from files."""

from pathlib import Path

from . import _native
from ._native import Yarns
from .errors import InputError

USD_SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
NATIVE_SUFFIXES = (".bcc", ".gltf", ".glb")


def load(path: str | Path, yarn_radius: float | None = None, frame: float | None = None) -> Yarns:
    """Reads yarn curves from a BCC, glTF or USD file.

    Args:
        path: the file; its suffix says what it is.
        yarn_radius: radius for all curves, in the file's unit, in place of the file's own. A file without radii gets
            one estimated from the closest approach of neighbouring strands.
        frame: time code of an animated USD stage; its first time sample unless given. Length coordinates and rest
            frames are those of the first time sample in any case.

    Raises:
        InputError: the file is not what its suffix says, or holds curves that cannot be drawn.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix in USD_SUFFIXES:
        from .usd import Animation

        animation = Animation(path, yarn_radius)
        return animation.reference if frame is None else animation.at(frame)
    if suffix not in NATIVE_SUFFIXES:
        expected = ", ".join(NATIVE_SUFFIXES + USD_SUFFIXES)
        raise InputError(f"{path}: unknown kind of file {suffix!r}: expected {expected}")
    if frame is not None:
        raise InputError(f"{path}: frame {frame:g} was asked for, but {suffix} files hold no animation")
    return _native.load(path, yarn_radius)
