"""`lisle info`: what a file holds."""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from ..loading import USD_SUFFIXES, load


def add_to(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Adds the command to a parser."""
    parser = commands.add_parser("info", help="describe a file", description="Says what a file of yarn curves holds.")
    parser.add_argument("input", metavar="IN", type=Path, help="BCC, glTF or USD file")
    parser.add_argument("--json", action="store_true", help="machine-readable")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Prints the description."""
    facts = describe(arguments.input)
    if arguments.json:
        print(json.dumps(facts, indent=2))
        return
    low, high = (" ".join(f"{value:.4g}" for value in facts[key]) for key in ("bounds_min", "bounds_max"))
    thin, thick = facts["radius_min"], facts["radius_max"]
    print(f"{facts['path']}: {facts['curves']} curves ({facts['closed']} closed), {facts['points']} points")
    print(f"  points per curve  {facts['points_per_curve_min']} to {facts['points_per_curve_max']}")
    print(f"  bounds            {low} to {high}")
    print(f"  length            {facts['length']:.6g}")
    print(f"  yarn radius       {thin:.4g}" + (f" to {thick:.4g}" if thick > thin else ""))
    if facts["frames"]:
        print("  frames            {:g} to {:g}".format(*facts["frames"]))


def describe(path: Path) -> dict[str, Any]:
    """The file's contents in numbers; lengths in the file's unit (USD: metres)."""
    frames = None
    if path.suffix.lower() in USD_SUFFIXES:
        from ..usd import Animation

        animation = Animation(path)
        yarns, frames = animation.reference, animation.frames
    else:
        yarns = load(path)
    counts = np.diff(yarns.offsets)
    return {
        "path": str(path),
        "curves": len(counts),
        "closed": int(yarns.closed.sum()),
        "points": len(yarns.points),
        "points_per_curve_min": int(counts.min()),
        "points_per_curve_max": int(counts.max()),
        "bounds_min": yarns.points.min(axis=0).tolist(),
        "bounds_max": yarns.points.max(axis=0).tolist(),
        "length": yarns.length,
        "radius_min": float(yarns.radii.min()),
        "radius_max": float(yarns.radii.max()),
        "frames": frames,
    }
