"""`lisle render`: a file of yarn curves to a picture, or an animated one to a sequence of pictures."""

import argparse
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

from .._native import Yarns, set_threads
from ..camera import Camera
from ..errors import InputError
from ..loading import load
from ..material import Material
from ..renderer import Renderer
from ..yarn import Yarn
from .options import (
    add_film,
    add_input,
    add_picture,
    add_threads,
    check_output,
    frame_range,
    lighting,
    open_animation,
    whole,
)
from .progress import Bar


def add_to(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Adds the command to a parser."""
    parser = commands.add_parser(
        "render",
        help="draw a file",
        description="Draws a file of yarn curves under a sun and constant ambient light, or a picture of the sky.",
    )
    add_input(parser, ".png or .exr; #### stands for the frame")
    add_picture(parser, samples=16)
    parser.add_argument(
        "--transport-photons",
        type=whole,
        default=500_000,
        metavar="N",
        help="precision of light that is scattered more than once, 0 for none (default 500000)",
    )
    add_film(parser)
    add_threads(parser)
    parser.add_argument("--adapter", metavar="NAME", help="a part of an adapter's name, see `lisle devices`")
    frames = parser.add_mutually_exclusive_group()
    frames.add_argument("--frame", type=float, metavar="F", help="time code of an animated USD file (default: first)")
    frames.add_argument("--frames", type=frame_range, metavar="A-B", help="time codes A to B, one picture each")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Renders what the command line says."""
    output, frames = arguments.output, arguments.frames
    if frames is not None and "#" not in output.name:
        raise InputError(f"{output}: --frames needs a place for the frame's number, such as {output.stem}.####.png")
    check_output(output, (".png", ".exr"), "picture")
    if arguments.passes and output.suffix.lower() != ".exr":
        raise InputError(f"{output}: --passes needs an .exr, which holds them")
    if arguments.threads is not None:
        set_threads(arguments.threads)

    reference, pictures = open_input(arguments)
    camera = Camera.fit(reference, arguments.direction, arguments.size)
    renderer = Renderer(arguments.adapter)
    yarn, material = Yarn.preset(arguments.yarn), Material.preset(arguments.material)
    light = lighting(arguments)
    with Bar(len(pictures)) as bar:
        for step, (path, yarns) in enumerate(pictures):
            bar.begin(step, path.name)
            image = renderer.render(
                yarns(),
                yarn=yarn,
                material=material,
                camera=camera,
                **light,
                samples=arguments.samples,
                seed=arguments.seed,
                filter=arguments.filter,
                filter_width=arguments.filter_width,
                noise_threshold=arguments.noise_threshold,
                time_limit_s=arguments.time_limit,
                passes=arguments.passes,
                shading=arguments.shading,
                transport_photons=arguments.transport_photons,
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
    animation = open_animation(path, radius)
    frames = [arguments.frame] if arguments.frames is None else list(arguments.frames)
    for frame in frames:
        animation.check(frame)
    return animation.reference, [(numbered(output, frame), partial(animation.at, frame)) for frame in frames]


def numbered(output: Path, frame: float) -> Path:
    """The file of a frame: its number in place of the #s, with as many digits before the point at least."""
    whole, point, part = f"{abs(frame):.6f}".rstrip("0").rstrip(".").partition(".")
    sign = "-" if frame < 0 else ""
    return output.with_name(
        re.sub("#+", lambda hashes: f"{sign}{whole.zfill(len(hashes[0]))}{point}{part}", output.name)
    )
