"""The pictures of the README: striped stockinette, one yarn in three colours, in folds and from near to far."""

import argparse
from math import pi, radians, tan
from pathlib import Path

import lisle
import numpy as np

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("out", nargs="?", type=Path, default=Path("out/examples"), help="folder for the pictures")
parser.add_argument("scale", nargs="?", type=float, default=1.0, help="of the pictures: the drape is 1200 wide at 1")
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


def striped(swatch, points, stripes):
    """The courses of each colour as yarns of their own, with their material."""
    repeat = sum(len(rows) for rows in stripes.values())
    for color, rows in stripes.items():
        courses = [c for c in range(len(swatch.offsets) - 1) if c % repeat in rows]
        spans = [slice(swatch.offsets[c], swatch.offsets[c + 1]) for c in courses]
        yarns = lisle.Yarns(
            np.concatenate([points[s] for s in spans]),
            np.cumsum([0] + [s.stop - s.start for s in spans]),
            radii=np.concatenate([swatch.radii[s] for s in spans]),
        )
        yield yarns, wool(*color)


renderer = lisle.Renderer()


def draw(name, objects, yarn, view, lights, ambient):
    """One picture; `view` is the eye, the target, the opening in degrees, and the size at a scale of 1."""
    eye, target, opening_deg, full_size = view
    size = tuple(max(round(arguments.scale * pixels), 1) for pixels in full_size)
    scene = lisle.Scene(camera=look_at(eye, target, opening_deg, size), lights=lights, ambient=ambient)
    for number, (yarns, material) in enumerate(objects):
        scene.add(yarns, yarn=yarn, material=material, object_id=number + 1, name=f"stripe {number}")
    renderer.render(scene, samples=arguments.samples).save(arguments.out / f"{name}.png")
    print(arguments.out / f"{name}.png")


# A twenty-fifth larger than it was knitted: room for the yarns on the inside of the folds.
swatch = lisle.knit_swatch("stockinette", courses=30, wales=22)
points = folds(1.04 * swatch.points.astype(np.float64)).astype(np.float32)
draw(
    "drape",
    striped(
        swatch,
        points,
        {(0.82, 0.70, 0.50): range(4), (0.50, 0.055, 0.045): range(4, 8), (0.05, 0.12, 0.20): range(8, 10)},
    ),
    lisle.Yarn.preset("cotton-1"),
    ((0.045, -0.11, 0.045), (0.002, 0, 0.004), 22, (1200, 750)),
    [
        lisle.Sun(direction=(1, 0.75, -0.8), strength=6, color=(1, 0.94, 0.86), angle_rad=0.06),
        lisle.Sun(direction=(-1, 0.25, -0.1), strength=1.5, color=(0.7, 0.82, 1), angle_rad=0.2),
    ],
    (0.42, 0.45, 0.5),
)

swatch = lisle.knit_swatch("stockinette", courses=36, wales=30)
middle = swatch.points.mean(axis=0)
top = swatch.points[:, 2].max() - middle[2]
stripes = {(0.04, 0.26, 0.30): range(7), (0.78, 0.46, 0.08): range(7, 9), (0.70, 0.66, 0.58): range(9, 12)}
objects = list(striped(swatch, swatch.points, stripes))
# Of finer fibers than cotton has, and more of them fly away.
yarn = lisle.Yarn.preset("cotton-1").replace(fibers_per_ply=180, fiber_radius=0.0013, hair_density=60.0)
for name, eye, target, opening_deg, size in [
    ("near", (0.004, -0.06, 0.014), (0.0005, 0, 0.0005), 14, (960, 640)),
    ("middle", (0.03, -0.11, 0.03), (0, 0, 0), 22, (480, 320)),
    ("far", (0.16, -0.52, 0.16), (0, 0, 0), 20, (480, 320)),
    ("edge", (0.01, -0.06, top + 0.01), (0, 0, top - 0.002), 12, (480, 320)),
]:
    draw(
        name,
        objects,
        yarn,
        (middle + eye, middle + target, opening_deg, size),
        [
            lisle.Sun(direction=(1, 0.75, -0.9), strength=5.5, color=(1, 0.93, 0.84), angle_rad=0.08),
            lisle.Sun(direction=(-1, 0.35, -0.15), strength=2, color=(0.72, 0.84, 1), angle_rad=0.3),
        ],
        (0.5, 0.53, 0.58),
    )
