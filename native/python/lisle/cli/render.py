"""`lisle render`: a file of yarn curves to a picture, or an animated one to a sequence of pictures."""

import argparse
import re
from collections.abc import Callable
from functools import partial
from math import isfinite, nan
from pathlib import Path

from .._native import Yarns
from ..camera import Camera
from ..errors import InputError
from ..lights import Sun
from ..loading import USD_SUFFIXES, load
from ..material import Material
from ..renderer import Renderer
from ..scene import DEFAULT_MATERIAL, DEFAULT_YARN
from ..usd import Animation
from ..yarn import Yarn
from .progress import Bar

SUN = Sun(direction=(-1, 1, -2), strength=3.0)
AMBIENT = (0.3, 0.3, 0.3)


def add_to(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Adds the command to a parser."""
    parser = commands.add_parser(
        "render", help="draw a file", description="Draws a file of yarn curves under a sun and constant ambient light."
    )
    add = parser.add_argument
    add("input", metavar="IN", type=Path, help="BCC, glTF or USD file")
    add("-o", "--output", metavar="OUT", type=Path, required=True, help=".png or .exr; #### stands for the frame")
    add("--size", type=size, default=(1280, 960), metavar="WxH", help="pixels (default 1280x960)")
    add("--samples", type=at_least_one, default=16, metavar="N", help="samples per pixel (default 16)")
    add("--yarn", choices=Yarn.presets(), default=DEFAULT_YARN, metavar="P", help=names(Yarn.presets(), DEFAULT_YARN))
    add(
        "--material",
        choices=Material.presets(),
        default=DEFAULT_MATERIAL,
        metavar="P",
        help=names(Material.presets(), DEFAULT_MATERIAL),
    )
    add("--shading", choices=("physical", "simple"), default="physical", help="shading model (default physical)")
    add("--yarn-radius", type=positive, metavar="R", help="in the file's unit (default: the file's own, or estimated)")
    add(
        "--direction",
        type=direction,
        default=(0.0, -1.0, 0.3),
        metavar="X,Y,Z",
        help="from the yarns to the camera, Z up (default 0,-1,0.3; write --direction=-1,0,0 if X is negative)",
    )
    add("--adapter", metavar="NAME", help="a part of an adapter's name, see `lisle devices`")
    frames = parser.add_mutually_exclusive_group()
    frames.add_argument("--frame", type=float, metavar="F", help="time code of an animated USD file (default: first)")
    frames.add_argument("--frames", type=frame_range, metavar="A-B", help="time codes A to B, one picture each")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Renders what the command line says."""
    output, frames = arguments.output, arguments.frames
    if frames is not None and "#" not in output.name:
        raise InputError(f"{output}: --frames needs a place for the frame's number, such as {output.stem}.####.png")
    if output.suffix.lower() not in (".png", ".exr"):
        raise InputError(f"{output}: unknown kind of picture {output.suffix!r}: expected .png or .exr")
    if not output.parent.is_dir():
        raise InputError(f"{output}: the folder {output.parent} does not exist")

    reference, pictures = open_input(arguments)
    camera = Camera.fit(reference, arguments.direction, arguments.size)
    renderer = Renderer(arguments.adapter)
    yarn, material = Yarn.preset(arguments.yarn), Material.preset(arguments.material)
    with Bar(len(pictures)) as bar:
        for step, (path, yarns) in enumerate(pictures):
            bar.begin(step, path.name)
            image = renderer.render(
                yarns(),
                yarn=yarn,
                material=material,
                camera=camera,
                lights=[SUN],
                ambient=AMBIENT,
                samples=arguments.samples,
                shading=arguments.shading,
                progress=bar.update,
            )
            image.save(path)


def open_input(arguments: argparse.Namespace) -> tuple[Yarns, list[tuple[Path, Callable[[], Yarns]]]]:
    """The yarns that the camera looks at; each picture's file, and what makes its yarns.

    The camera looks at the first time sample whichever frames are asked for, so that a frame is the same alone and
    within a sequence.
    """
    path, output, radius = arguments.input, arguments.output, arguments.yarn_radius
    if arguments.frame is None and arguments.frames is None:
        yarns = load(path, radius)
        return yarns, [(output, lambda: yarns)]
    if path.suffix.lower() not in USD_SUFFIXES:
        raise InputError(f"{path}: a frame was asked for, but only USD files hold an animation")
    animation = Animation(path, radius)
    frames = [arguments.frame] if arguments.frames is None else list(arguments.frames)
    for frame in frames:
        animation.check(frame)
    return animation.reference, [(numbered(output, frame), partial(animation.at, frame)) for frame in frames]


def numbered(output: Path, frame: float) -> Path:
    """The file of a frame: its number in place of the #s."""
    return output.with_name(re.sub("#+", lambda hashes: f"{frame:0{len(hashes[0])}g}", output.name))


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
