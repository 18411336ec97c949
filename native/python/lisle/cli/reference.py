"""`lisle reference`: a file of yarn curves to a picture by the path tracer."""

import argparse
from pathlib import Path

from .._native import set_threads
from ..camera import Camera
from ..material import Material
from ..reference import Reference
from ..yarn import Yarn
from .options import add_input, add_picture, add_threads, at_least_one, check_output, lighting, open_still, whole
from .progress import Bar


def add_to(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Adds the command to a parser."""
    parser = commands.add_parser(
        "reference",
        help="draw a file, slowly and right",
        description="Draws a file of yarn curves with every fiber explicit and light scattered between them, under the "
        "light of `lisle render`. An .exr holds the variance of each pixel as well.",
    )
    add_input(parser, ".png or .exr")
    add_picture(parser, samples=64)
    add = parser.add_argument
    add(
        "--bounces",
        type=at_least_one,
        metavar="N",
        help="most scatterings; 1 is `lisle render --transport-photons 0` (default: any)",
    )
    add("--seed", type=whole, default=0, metavar="N", help="of all random numbers (default 0)")
    add("--checkpoint", type=Path, metavar="FILE", help="keeps the work here, and goes on with it if it is there")
    add_threads(parser)
    add("--frame", type=float, metavar="F", help="time code of an animated USD file (default: first)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Draws what the command line says."""
    output = arguments.output
    check_output(output, (".png", ".exr"), "picture")
    if arguments.threads is not None:
        set_threads(arguments.threads)
    first, yarns = open_still(arguments.input, arguments.yarn_radius, arguments.frame)
    with Bar(1) as bar:
        bar.begin(0, output.name)
        image = Reference().render(
            yarns,
            yarn=Yarn.preset(arguments.yarn),
            material=Material.preset(arguments.material),
            camera=Camera.fit(first, arguments.direction, arguments.size),
            **lighting(arguments),
            samples=arguments.samples,
            shading=arguments.shading,
            bounces=arguments.bounces,
            seed=arguments.seed,
            checkpoint=arguments.checkpoint,
            progress=bar.update,
        )
    image.save(output)
