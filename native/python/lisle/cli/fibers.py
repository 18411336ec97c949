"""`lisle fibers`: a file of yarn curves to one of fibers, for any other renderer."""

import argparse

from ..camera import Camera
from ..reference import CHORD_ERROR, fibers
from ..usd_export import save_fibers
from ..yarn import Yarn
from .options import add_input, add_view, check_output, open_still, positive
from .progress import Bar


def add_to(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Adds the command to a parser."""
    parser = commands.add_parser(
        "fibers",
        help="write the fibers of a file",
        description="Writes all fibers of a file of yarn curves as linear BasisCurves with widths, hairs included.",
    )
    add_input(parser, ".usdc or .usda")
    parser.add_argument(
        "--chord-error",
        type=positive,
        default=CHORD_ERROR,
        metavar="E",
        help=f"how far a chord may depart from its fiber, in radii of the fiber (default {CHORD_ERROR:g})",
    )
    parser.add_argument(
        "--lod-pixels",
        type=positive,
        metavar="P",
        help="merge fibers that the view of --size and --direction shows thinner than this (default: write all fibers)",
    )
    add_view(parser)
    parser.add_argument("--frame", type=float, metavar="F", help="time code of an animated USD file (default: first)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Writes what the command line says."""
    output = arguments.output
    check_output(output, (".usdc", ".usda"), "file")
    first, yarns = open_still(arguments.input, arguments.yarn_radius, arguments.frame)
    with Bar(1) as bar:
        bar.begin(0, output.name)
        lod_pixels = arguments.lod_pixels
        made = fibers(
            yarns,
            Yarn.preset(arguments.yarn),
            chord_error=arguments.chord_error,
            camera=None if lod_pixels is None else Camera.fit(first, arguments.direction, arguments.size),
            lod_pixels=lod_pixels or 1.0,
            progress=bar.update,
        )
    save_fibers(output, made)
    print(f"{output}: {len(made.offsets) - 1} fibers, {len(made.points)} points")
