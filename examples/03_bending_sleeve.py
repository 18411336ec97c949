"""A knitted sleeve on an arm that bends at the elbow."""

import argparse
from math import cos, radians, sin
from pathlib import Path

import lisle

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("out", nargs="?", type=Path, default=Path("out/examples"), help="folder for the pictures")
out = parser.parse_args().out
out.mkdir(parents=True, exist_ok=True)


def sleeve(angle_deg):
    """The sleeve about an arm bent by that angle: an upper arm along +Z, an elbow that keeps its length, a forearm.

    Its courses are so few that they have room on the inside of the elbow: where a line bends with a radius of 120 mm, a
    tube of 34 mm about it is shorter by 34 / 120 there.
    """
    bend = radians(max(angle_deg, 1))
    radius = 0.12 * radians(70) / bend
    line = [(0.0, 0.0, 0.0075 * i) for i in range(8)]
    line += [(radius * (1 - cos(bend * i / 24)), 0.0, 0.06 + radius * sin(bend * i / 24)) for i in range(25)]
    x, _, z = line[-1]
    line += [(x + sin(bend) * 0.0075 * i, 0.0, z + cos(bend) * 0.0075 * i) for i in range(1, 9)]
    return lisle.knit_sleeve(line, radius=0.034, pattern="rib-1-1", courses=40, wales=28)


rest = sleeve(0)
renderer = lisle.Renderer()
camera = lisle.Camera.fit(sleeve(70), direction=(-0.2, -1, 0.15), size=(640, 640))
for number, angle in enumerate((0, 35, 70)):
    image = renderer.render(
        rest.with_points(sleeve(angle).points),
        yarn=lisle.Yarn.preset("cotton-2"),
        material=lisle.Material.preset("rayon-1"),
        camera=camera,
        lights=[lisle.Sun(direction=(1, 0.8, -0.9), strength=5, angle_rad=0.05)],
        ambient=(0.4, 0.4, 0.4),
        samples=16,
    )
    path = out / f"sleeve_{number:04d}.png"
    image.save(path)
    print(path)
