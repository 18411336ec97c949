"""What several commands take."""

import argparse
import re
from math import isfinite, nan, radians
from pathlib import Path
from typing import TypedDict

from .._native import Yarns
from ..environment import Environment
from ..errors import InputError
from ..image import FURTHER_PASSES
from ..lights import Sun
from ..loading import USD_SUFFIXES, load
from ..material import Material
from ..scene import DEFAULT_MATERIAL, DEFAULT_YARN
from ..usd import Animation
from ..yarn import Yarn

SUN = Sun(direction=(-1, 1, -2), strength=3.0)
AMBIENT = (0.3, 0.3, 0.3)


def add_input(parser: argparse.ArgumentParser, output: str) -> None:
    """Files, and the yarn in them."""
    add = parser.add_argument
    add("input", metavar="IN", type=Path, help="BCC, glTF or USD file")
    add("-o", "--output", metavar="OUT", type=Path, required=True, help=output)
    add("--yarn", choices=Yarn.presets(), default=DEFAULT_YARN, metavar="P", help=names(Yarn.presets(), DEFAULT_YARN))
    add("--yarn-radius", type=positive, metavar="R", help="in the file's unit (default: the file's own, or estimated)")


def add_picture(parser: argparse.ArgumentParser, samples: int) -> None:
    """What a picture shows, and how."""
    add = parser.add_argument
    add("--samples", type=at_least_one, default=samples, metavar="N", help=f"samples per pixel (default {samples})")
    add(
        "--material",
        choices=Material.presets(),
        default=DEFAULT_MATERIAL,
        metavar="P",
        help=names(Material.presets(), DEFAULT_MATERIAL),
    )
    add("--shading", choices=("physical", "simple"), default="physical", help="shading model (default physical)")
    add(
        "--environment",
        type=Path,
        metavar="FILE",
        help="light from a picture of the sky, .exr or .hdr, in place of a sun and constant ambient light",
    )
    add(
        "--environment-rotation",
        type=number,
        default=0.0,
        metavar="DEG",
        help="by which it is turned about Z, degrees, counter-clockwise from above (default 0)",
    )
    add_view(parser)


class Lighting(TypedDict):
    """What a picture is lit by, as arguments of a render."""

    lights: list[Sun]
    ambient: tuple[float, float, float]
    environment: Environment | None


def lighting(arguments: argparse.Namespace) -> Lighting:
    """As the command line says."""
    if arguments.environment is None:
        return Lighting(lights=[SUN], ambient=AMBIENT, environment=None)
    environment = Environment(arguments.environment, radians(arguments.environment_rotation))
    return Lighting(lights=[], ambient=(0.0, 0.0, 0.0), environment=environment)


def add_threads(parser: argparse.ArgumentParser) -> None:
    """What runs on the processor."""
    parser.add_argument(
        "-t",
        "--threads",
        type=at_least_one,
        metavar="N",
        help="on the processor, not the graphics adapter (default: all)",
    )


def add_film(parser: argparse.ArgumentParser) -> None:
    """How samples become a picture, and which passes it has."""
    add = parser.add_argument
    add("--seed", type=whole, default=0, metavar="N", help="of the sample sequence (default 0)")
    add("--filter", choices=("blackman-harris", "gaussian", "box"), default="blackman-harris", help="pixel filter")
    add("--filter-width", type=positive, default=1.5, metavar="PX", help="of the pixel filter (default 1.5)")
    add(
        "--noise-threshold",
        type=positive,
        default=0.0,
        metavar="E",
        help="stops before all samples when the noise is down to this, such as 0.01 (default: never)",
    )
    add("--time-limit", type=positive, metavar="S", help="stops when a picture has taken so many seconds")
    add(
        "--passes",
        type=passes,
        default=(),
        metavar="P,P",
        help=f"further passes in an .exr: {', '.join(name for name in FURTHER_PASSES if name != 'vector')}",
    )


def passes(text: str) -> tuple[str, ...]:
    """Names with commas between them."""
    names = tuple(text.split(","))
    for name in names:
        if name not in FURTHER_PASSES or name == "vector":
            raise argparse.ArgumentTypeError(f"{name!r} is no pass that can be asked for")
    return names


def add_view(parser: argparse.ArgumentParser) -> None:
    """From where, and how large."""
    add = parser.add_argument
    add("--size", type=size, default=(1280, 960), metavar="WxH", help="pixels (default 1280x960)")
    add(
        "--direction",
        type=direction,
        default=(0.0, -1.0, 0.3),
        metavar="X,Y,Z",
        help="from the yarns to the camera, Z up (default 0,-1,0.3; write --direction=-1,0,0 if X is negative)",
    )


def check_output(output: Path, suffixes: tuple[str, ...], kind: str) -> None:
    """Refuses a file that cannot be written before any work is done."""
    if output.suffix.lower() not in suffixes:
        expected = " or ".join(suffixes)
        raise InputError(f"{output}: unknown kind of {kind} {output.suffix!r}: expected {expected}")
    if not output.parent.is_dir():
        raise InputError(f"{output}: the folder {output.parent} does not exist")


def open_still(path: Path, radius: float | None, frame: float | None) -> tuple[Yarns, Yarns]:
    """The yarns that the camera looks at, which are those of the first time sample, and those of a frame."""
    if frame is None:
        yarns = load(path, radius)
        return yarns, yarns
    animation = open_animation(path, radius)
    return animation.reference, animation.at(frame)


def open_animation(path: Path, radius: float | None) -> Animation:
    """A file that may hold frames."""
    if path.suffix.lower() not in USD_SUFFIXES:
        raise InputError(f"{path}: a frame was asked for, but only USD files hold an animation")
    return Animation(path, radius)


def names(presets: tuple[str, ...], default: str) -> str:
    """Help for a choice among presets."""
    return f"one of {', '.join(presets)} (default {default})"


def size(text: str) -> tuple[int, int]:
    """WxH, each from 1 to 65536."""
    match = re.fullmatch(r"(\d{1,5})[x×](\d{1,5})", text)
    if not match or not (int(match[1]) and int(match[2])):
        raise argparse.ArgumentTypeError(f"{text!r} is not a width and a height such as 1280x960")
    return int(match[1]), int(match[2])


def at_least_one(text: str) -> int:
    """A whole number ≥ 1."""
    if not re.fullmatch(r"\d{1,6}", text) or not int(text):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of at least 1")
    return int(text)


def whole(text: str) -> int:
    """A whole number from 0 to 2³² − 1."""
    if not re.fullmatch(r"\d{1,10}", text) or int(text) >= 2**32:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 0 to 4294967295")
    return int(text)


def number(text: str) -> float:
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        value = nan
    if not isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number")
    return value


def positive(text: str) -> float:
    """A finite number > 0."""
    try:
        value = float(text)
    except ValueError:
        value = nan
    if not (isfinite(value) and value > 0.0):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number above 0")
    return value


def direction(text: str) -> tuple[float, float, float]:
    """X,Y,Z, not all zero."""
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        x = y = z = 0.0
    if not all(map(isfinite, (x, y, z))) or not any((x, y, z)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a direction such as 0,-1,0.3")
    return x, y, z


def frame_range(text: str) -> range:
    """A-B, both whole and A ≤ B."""
    match = re.fullmatch(r"(-?\d+)-(-?\d+)", text)
    if not match or int(match[1]) > int(match[2]):
        raise argparse.ArgumentTypeError(f"{text!r} is not a range of frames such as 1-24")
    return range(int(match[1]), int(match[2]) + 1)
