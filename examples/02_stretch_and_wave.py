"""A swatch that is stretched and waved. Length coordinates and rest frames are those of the first shape, so that every
fiber stays where it is on its yarn."""

import argparse
from math import pi
from pathlib import Path

import lisle
import numpy as np

FRAMES = 24
LOOSE = 1.12
"""So much larger than it was knitted: room for its yarns when the cloth narrows and leans."""

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("out", nargs="?", type=Path, default=Path("out/examples"), help="folder for the pictures")
out = parser.parse_args().out
out.mkdir(parents=True, exist_ok=True)


def deform(points, frame):
    """Stretches along X by up to 12 %, narrows along Z, and sends a wave through it."""
    phase = 2 * pi * frame / FRAMES
    stretch = 1 + 0.06 * (1 - np.cos(phase))
    x, y, z = LOOSE * points.T
    wave = 0.004 * np.sin(2 * pi * x / 0.07 + phase) * np.sin(phase / 2) ** 2
    return np.stack([x * stretch, y + wave, z / np.sqrt(stretch)], axis=1).astype(np.float32)


rest = lisle.knit_swatch("rib-2-2", courses=16, wales=12)
camera = lisle.Camera.fit(rest.with_points(deform(rest.points, FRAMES / 2)), direction=(0.4, -1, 0.35), size=(640, 480))
renderer = lisle.Renderer()
for frame in range(FRAMES):
    image = renderer.render(
        rest.with_points(deform(rest.points, frame)),
        yarn=lisle.Yarn.preset("rayon-2"),
        material=lisle.Material.preset("fleece"),
        camera=camera,
        lights=[lisle.Sun(direction=(1, 0.8, -1.1), strength=5, angle_rad=0.05)],
        ambient=(0.4, 0.4, 0.4),
        samples=8,
    )
    path = out / f"stretch_{frame:04d}.png"
    image.save(path)
    print(path)
