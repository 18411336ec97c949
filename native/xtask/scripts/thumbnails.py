"""Draws the pictures that Blender shows of presets: `python thumbnails.py FOLDER [NAME …]`, with lisle and Pillow.

Yarns are a bent piece of each on a transparent ground; fibers are a knitted swatch of each that fills the picture.
"""

import sys
from pathlib import Path

import lisle
import numpy as np
from PIL import Image

SIZE = 160
"""Pixels a side."""
SAMPLES = 36
QUALITY = 80
LARGEST_FILE = 20_000

LIGHTS = [lisle.Sun(direction=(0.7, 1.0, -1.1), strength=2.4), lisle.Sun(direction=(-1.0, 0.3, 0.2), strength=0.6)]
AMBIENT = (0.18, 0.18, 0.2)


def camera(height: float) -> lisle.Camera:
    """Looks along +Y at the origin; `height` is what it sees."""
    distance, half_angle = 20 * height, np.arctan(1 / 40)
    world = np.eye(4)
    world[:3, :3] = [(1, 0, 0), (0, 0, -1), (0, 1, 0)]
    world[1, 3] = -distance
    near, far = 0.5 * distance, 2 * distance
    clip = np.diag([1 / np.tan(half_angle)] * 2 + [0, 0])
    clip[2, 2:] = (near + far) / (near - far), 2 * near * far / (near - far)
    clip[3, 2] = -1
    return lisle.Camera(world, clip, (SIZE, SIZE))


def bent() -> lisle.Yarns:
    """A piece of yarn of radius 1 that crosses the picture in a wave."""
    t = np.linspace(-1, 1, 33)
    wave = np.column_stack([7 * t, 0 * t, 2 * t + 2 * np.sin(2 * np.pi * t)])
    return lisle.Yarns(wave, [0, len(t)], yarn_radius=1.0)


def swatch() -> lisle.Yarns:
    return lisle.knit_swatch(courses=8, wales=5, yarn_radius=1.0)


def draw(renderer: lisle.Renderer, yarns: lisle.Yarns, yarn: str, fiber: str, height: float) -> Image.Image:
    """Straight alpha, sRGB."""
    scene = lisle.Scene(camera(height), LIGHTS, AMBIENT)
    scene.add(yarns, lisle.Yarn.preset(yarn), lisle.Material.preset(fiber))
    picture = renderer.render(scene, samples=SAMPLES)["combined"].astype(np.float64)
    alpha = picture[..., 3:]
    linear = np.clip(picture[..., :3] / np.maximum(alpha, 1e-6), 0, 1)
    encoded = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return Image.fromarray(np.round(255 * np.concatenate([encoded, alpha], axis=2)).astype(np.uint8))


def main(folder: Path, names: list[str]) -> None:
    renderer = lisle.Renderer()
    pictures = {("yarn", name): (bent, name, "cotton-2", 10.0) for name in lisle.Yarn.presets()}
    pictures |= {("fiber", name): (swatch, "cotton-1", name, 19.0) for name in lisle.Material.presets()}
    for (kind, name), (make, yarn, fiber, height) in pictures.items():
        if names and name not in names:
            continue
        path = folder / kind / f"{name}.webp"
        path.parent.mkdir(parents=True, exist_ok=True)
        draw(renderer, make(), yarn, fiber, height).save(path, quality=QUALITY, method=6)
        size = path.stat().st_size
        print(f"{path}: {size} bytes")
        if size > LARGEST_FILE:
            raise SystemExit(f"{path} is larger than {LARGEST_FILE} bytes")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
