"""The picture at the top of the README: a striped stockinette swatch in folds, one yarn in three colours."""

import argparse
from math import pi, radians, tan
from pathlib import Path

import lisle
import numpy as np

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("out", nargs="?", type=Path, default=Path("out/examples"), help="folder for the picture")
parser.add_argument("size", nargs="?", default="1200x750", help="of the picture, pixels")
parser.add_argument("samples", nargs="?", type=int, default=32)
arguments = parser.parse_args()
out, samples = arguments.out, arguments.samples
out.mkdir(parents=True, exist_ok=True)
width, height = (int(n) for n in arguments.size.split("x"))


def look_at(eye, target, opening_deg):
    """A camera at `eye` that looks at `target`, Z up."""
    back = np.subtract(eye, target) / np.linalg.norm(np.subtract(eye, target))
    right = np.cross([0, 0, 1], back)
    right /= np.linalg.norm(right)
    world_from_camera = np.eye(4)
    world_from_camera[:3, :4] = np.stack([right, np.cross(back, right), back, eye], axis=1)
    f, near, far = 1 / tan(radians(opening_deg) / 2), 0.005, 5.0
    clip_from_camera = np.zeros((4, 4))
    clip_from_camera[[0, 1, 3], [0, 1, 2]] = f * height / width, f, -1
    clip_from_camera[2, 2:] = (near + far) / (near - far), 2 * near * far / (near - far)
    return lisle.Camera.from_matrices(world_from_camera, clip_from_camera, (width, height))


def wool(red, green, blue):
    """Dyed wool: what passes through a fiber is tinted less than what the cloth sends back."""
    color = np.array([red, green, blue])
    return lisle.Material.preset("cotton-2").replace(
        color_r=(0.05, 0.05, 0.05),
        color_tt=tuple(np.sqrt(color)),
        beta_r_deg=6,
        beta_tt_deg=20,
        diffuse=tuple(color),
    )


def folds(points, askew=(70 / 71, 12 / 71), waves_per_m=11.3, slope_deg=26):
    """A flat cloth bent to and fro along a line askew: its middle keeps all lengths."""
    x, y, z = points.T
    across, up = askew
    along, beside = across * x + up * z, across * z - up * x

    def angle(s):
        return radians(slope_deg) * np.cos(2 * pi * waves_per_m * s)

    def way(component):
        s = np.linspace(-0.2, 0.2, 20001)
        total = np.cumsum(component(angle(s))) * (s[1] - s[0])
        return np.interp(along, s, total) - np.interp(0, s, total)

    forward = way(np.cos) - y * np.sin(angle(along))
    outward = way(np.sin) + y * np.cos(angle(along))
    return np.stack([across * forward - up * beside, outward, up * forward + across * beside], axis=1)


# A twenty-fifth larger than it was knitted: room for the yarns on the inside of the folds.
swatch = lisle.knit_swatch("stockinette", courses=30, wales=22)
points = folds(1.04 * swatch.points.astype(np.float64)).astype(np.float32)

scene = lisle.Scene(
    camera=look_at((0.045, -0.11, 0.045), (0.002, 0, 0.004), 22),
    lights=[
        lisle.Sun(direction=(1, 0.75, -0.8), strength=6, color=(1, 0.94, 0.86), angle_rad=0.06),
        lisle.Sun(direction=(-1, 0.25, -0.1), strength=1.5, color=(0.7, 0.82, 1), angle_rad=0.2),
    ],
    ambient=(0.42, 0.45, 0.5),
)
stripes = {(0.82, 0.70, 0.50): (0, 1, 2, 3), (0.50, 0.055, 0.045): (4, 5, 6, 7), (0.05, 0.12, 0.20): (8, 9)}
for number, (color, rows) in enumerate(stripes.items()):
    courses = [c for c in range(len(swatch.offsets) - 1) if c % 10 in rows]
    spans = [slice(swatch.offsets[c], swatch.offsets[c + 1]) for c in courses]
    yarns = lisle.Yarns(
        np.concatenate([points[s] for s in spans]),
        np.cumsum([0] + [s.stop - s.start for s in spans]),
        radii=np.concatenate([swatch.radii[s] for s in spans]),
    )
    yarn = lisle.Yarn.preset("cotton-1")
    scene.add(yarns, yarn=yarn, material=wool(*color), object_id=number + 1, name=f"stripe {number}")

image = lisle.Renderer().render(scene, samples=samples)
image.save(out / "drape.png")
print(out / "drape.png")
