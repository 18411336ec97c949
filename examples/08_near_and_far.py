"""Pictures of the README: one striped stockinette swatch from a few stitches to the whole, and at its edge."""

import argparse
from math import radians, tan
from pathlib import Path

import lisle
import numpy as np

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("out", nargs="?", type=Path, default=Path("out/examples"), help="folder for the pictures")
parser.add_argument("scale", nargs="?", type=float, default=1.0, help="of the pictures: 960 pixels wide at 1")
parser.add_argument("samples", nargs="?", type=int, default=32)
arguments = parser.parse_args()
arguments.out.mkdir(parents=True, exist_ok=True)


def look_at(eye, target, opening_deg, size):
    """A camera at `eye` that looks at `target`, Z up."""
    back = np.subtract(eye, target) / np.linalg.norm(np.subtract(eye, target))
    right = np.cross([0, 0, 1], back)
    right /= np.linalg.norm(right)
    world_from_camera = np.eye(4)
    world_from_camera[:3, :4] = np.stack([right, np.cross(back, right), back, eye], axis=1)
    f, near, far = 1 / tan(radians(opening_deg) / 2), 0.005, 5.0
    clip_from_camera = np.zeros((4, 4))
    clip_from_camera[[0, 1, 3], [0, 1, 2]] = f * size[1] / size[0], f, -1
    clip_from_camera[2, 2:] = (near + far) / (near - far), 2 * near * far / (near - far)
    return lisle.Camera.from_matrices(world_from_camera, clip_from_camera, size)


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


# Courses of each colour, of every twelve.
STRIPES = {(0.04, 0.26, 0.30): range(7), (0.78, 0.46, 0.08): range(7, 9), (0.70, 0.66, 0.58): range(9, 12)}

swatch = lisle.knit_swatch("stockinette", courses=36, wales=30)
objects = []
for number, (color, rows) in enumerate(STRIPES.items()):
    spans = [slice(swatch.offsets[c], swatch.offsets[c + 1]) for c in range(len(swatch.offsets) - 1) if c % 12 in rows]
    yarns = lisle.Yarns(
        np.concatenate([swatch.points[s] for s in spans]),
        np.cumsum([0] + [s.stop - s.start for s in spans]),
        radii=np.concatenate([swatch.radii[s] for s in spans]),
    )
    objects.append((yarns, wool(*color), f"stripe {number}"))

# Of finer fibers than cotton has, and more of them fly away.
yarn = lisle.Yarn.preset("cotton-1").replace(fibers_per_ply=180, fiber_radius=0.0013, hair_density=60.0)
renderer = lisle.Renderer()
middle = swatch.points.mean(axis=0)
top = swatch.points[:, 2].max() - middle[2]
VIEWS = {
    # Name: eye and target, from the middle; opening in degrees; width and height.
    "near": ((0.004, -0.06, 0.014), (0.0005, 0, 0.0005), 14.0, (960, 640)),
    "middle": ((0.03, -0.11, 0.03), (0, 0, 0), 22.0, (480, 320)),
    "far": ((0.16, -0.52, 0.16), (0, 0, 0), 20.0, (480, 320)),
    "edge": ((0.01, -0.06, top + 0.01), (0, 0, top - 0.002), 12.0, (480, 320)),
}
for name, (eye, target, opening_deg, size) in VIEWS.items():
    width, height = (max(round(arguments.scale * pixels), 1) for pixels in size)
    scene = lisle.Scene(
        camera=look_at(middle + eye, middle + target, opening_deg, (width, height)),
        lights=[
            lisle.Sun(direction=(1, 0.75, -0.9), strength=5.5, color=(1, 0.93, 0.84), angle_rad=0.08),
            lisle.Sun(direction=(-1, 0.35, -0.15), strength=2.0, color=(0.72, 0.84, 1), angle_rad=0.3),
        ],
        ambient=(0.5, 0.53, 0.58),
    )
    for yarns, material, stripe in objects:
        scene.add(yarns, yarn=yarn, material=material, name=stripe)
    image = renderer.render(scene, samples=arguments.samples)
    image.save(arguments.out / f"{name}.png")
    print(arguments.out / f"{name}.png")
