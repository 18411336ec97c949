"""What is looked at, from where, and in which light. Lengths are radii of the yarn."""

import os
from collections.abc import Callable
from pathlib import Path

import lisle
import numpy as np

REPOSITORY = Path(__file__).parents[2]
DATA = Path(os.environ.get("LISLE_DATA", REPOSITORY.parent / "shared" / "data"))

SPAN = 48.0
"""Extent of a model: what a far view sees, and some more."""

VIEWS = {"near": (6.0, 96), "middle": (24.0, 96), "far": (40.0, 48)}
"""Height of the picture, and its pixels: a yarn is 32, 8 and 2.4 pixels wide."""

REFERENCE_SAMPLES = {"near": 1, "middle": 1, "far": 16}
RENDERER_SAMPLES = {"near": 1, "middle": 1, "far": 8}
"""Times as many samples: few pixels, each of many fibers, are noisy. A far picture of 48 is 1 to 3 % off its mean."""

SUNS = {"front": (0.3, -0.4, -1.0), "back": (0.2, -0.4, 1.0), "grazing": (1.0, -0.2, -0.15)}
"""Directions in which light travels, along the picture's right, its top, and towards the camera."""

LIGHTS = (*SUNS, "sky", "image", "gaussian")
"""Also an even sky, a picture of one, and a spherical Gaussian about the direction of the front."""

MATERIALS = {"light": "cotton", "dark": "rayon-3"}

BACKWARD = np.array([0.15, -1.0, 0.2]) / np.linalg.norm([0.15, -1.0, 0.2])
"""Towards the camera."""

HALF_ANGLE_RAD = 0.3


def lone() -> lisle.Yarns:
    """One yarn along X."""
    x = np.linspace(-0.5 * SPAN, 0.5 * SPAN, 49)
    return lisle.Yarns(np.column_stack([x, 0 * x, 0 * x]), [0, len(x)], yarn_radius=1.0)


def straight() -> lisle.Yarns:
    """Eleven yarns along X, 4 apart: each has fibers of its own, which decide how bright it is."""
    one = lone().points
    heights = np.arange(-5, 6) * 4.0
    points = np.concatenate([one + [0.0, 0.0, height] for height in heights])
    return lisle.Yarns(points, np.arange(len(heights) + 1) * len(one), yarn_radius=1.0)


def knit() -> lisle.Yarns:
    """A stockinette swatch; a stitch is about 8 wide and 4 high."""
    return lisle.knit_swatch(courses=11, wales=6, yarn_radius=1.0)


def woven() -> lisle.Yarns:
    """Plain weave; yarns are 3.8 apart."""
    return lisle.woven_swatch("plain", 12, 12, yarn_radius=1.0, spacing=3.8 / (2 * 3**0.5))


def glove() -> lisle.Yarns:
    """A piece of one side of a knitted glove: all of it takes the reference more memory than most machines have.

    Its thinnest side is turned towards the camera, and the middle of that side lies at the origin.
    """
    whole = lisle.load(DATA / "yarns" / "glove.bcc")
    radius = float(whole.radii.mean())
    points = whole.points.astype(np.float64) / radius
    thin, *wide = np.argsort(np.ptp(points, axis=0))
    # A proper rotation, so that the twist keeps its hand.
    frame = np.zeros((3, 3))
    frame[0, wide[0]], frame[2, wide[1]] = 1.0, 1.0
    frame[1] = np.cross(frame[2], frame[0])
    assert abs(frame[1, thin]) == 1.0
    points = points @ frame.T
    points -= 0.5 * (points.min(axis=0) + points.max(axis=0))
    beside = np.abs(points[:, [0, 2]]).max(axis=1)
    points[:, 1] -= points[beside < 4, 1].min() + 1.0
    pieces = []
    for start, end in zip(whole.offsets[:-1], whole.offsets[1:], strict=True):
        inside = start + np.flatnonzero((beside[start:end] < 0.5 * SPAN) & (points[start:end, 1] < 0.5 * SPAN))
        runs = np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1)
        pieces += [points[run] for run in runs if len(run) >= 4]
    offsets = np.concatenate([[0], np.cumsum([len(piece) for piece in pieces])])
    return lisle.Yarns(np.concatenate(pieces), offsets, yarn_radius=1.0)


MODELS: dict[str, Callable[[], lisle.Yarns]] = {"straight": straight, "knit": knit, "woven": woven, "glove": glove}


def models() -> tuple[str, ...]:
    """Those that can be made here."""
    return tuple(name for name in MODELS if name != "glove" or (DATA / "yarns" / "glove.bcc").is_file())


def frame() -> np.ndarray:
    """Right, top, and towards the camera, as columns."""
    right = np.cross([0.0, 0.0, 1.0], BACKWARD)
    right /= np.linalg.norm(right)
    return np.column_stack([right, np.cross(BACKWARD, right), BACKWARD])


def camera(view: str) -> lisle.Camera:
    """A square picture of the origin."""
    height, pixels = VIEWS[view]
    distance = 0.5 * height / np.tan(HALF_ANGLE_RAD) + 2.0
    world = np.eye(4)
    world[:3, :3] = frame()
    world[:3, 3] = distance * BACKWARD
    near, far = 0.05 * distance, 20 * distance + 10 * SPAN
    clip = np.zeros((4, 4))
    clip[0, 0] = clip[1, 1] = 1 / np.tan(HALF_ANGLE_RAD)
    clip[2, 2:] = (near + far) / (near - far), 2 * near * far / (near - far)
    clip[3, 2] = -1
    return lisle.Camera(world, clip, (pixels, pixels))


def sun(direction: tuple[float, float, float]) -> lisle.Sun:
    """A sun without a penumbra that shines along a direction as in `SUNS`."""
    return lisle.Sun(direction=frame() @ direction, strength=3.0)


def image() -> lisle.Environment:
    """A picture of a sky: dim ground, a horizon brighter than the zenith, and a warm glow where the front's sun is."""
    height, width = 64, 128
    polar = np.pi * (np.arange(height)[:, None] + 0.5) / height
    longitude = 2 * np.pi * (0.5 - (np.arange(width)[None, :] + 0.5) / width)
    z = np.broadcast_to(np.cos(polar), (height, width))
    directions = np.stack([np.sin(polar) * np.cos(longitude), np.sin(polar) * np.sin(longitude), z], axis=-1)
    toward = -(frame() @ SUNS["front"])
    cosine = np.maximum(directions @ (toward / np.linalg.norm(toward)), 0)[..., None]
    zenith, horizon, ground = np.array([[0.15, 0.3, 0.7], [0.6, 0.7, 0.8], [0.12, 0.1, 0.08]])
    sky = zenith + (horizon - zenith) * (1 - np.abs(z[..., None])) ** 2
    return lisle.Environment(np.where(z[..., None] > 0, sky, ground) + np.array([12.0, 9.0, 6.0]) * cosine**40)


def gaussian() -> lisle.Gaussian:
    """As strong as the suns, from within about half a radian of where the front's is."""
    return lisle.Gaussian(direction=frame() @ SUNS["front"], strength=3.0, sharpness=5.0)


def scene(
    yarns: lisle.Yarns, yarn: lisle.Yarn, material: lisle.Material, view: str, light: str | lisle.Sun
) -> lisle.Scene:
    """Yarns under one light."""
    lights: list[lisle.Light] = []
    if isinstance(light, lisle.Sun):
        lights.append(light)
    elif light in SUNS:
        lights.append(sun(SUNS[light]))
    elif light == "gaussian":
        lights.append(gaussian())
    ambient = (1.0, 1.0, 1.0) if light == "sky" else (0.0, 0.0, 0.0)
    made = lisle.Scene(camera(view), lights, ambient, image() if light == "image" else None)
    made.add(yarns, yarn, material)
    return made
