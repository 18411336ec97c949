"""How much more the renderer's pictures change from frame to frame than the reference's, once motion is compensated."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import lisle
import measures
import models
import numpy as np
from lisle.usd import Animation
from measures import Picture

SEQUENCES = ("yarn_stock_stretchX", "yarn_satin_stretchX")

FRAMES = (4, 10, 18)
"""Each with its next: most of the motion lies before frame 25."""

SIZE = 128
HEIGHT = 24.0
"""Of the picture, in radii of the yarn: 5 pixels each."""

REACH = 45.0
"""Radii around the middle of the cloth within which whole curves are kept."""

MOST_POINTS = 6000


@dataclass(frozen=True)
class Flicker:
    """Change from one frame to the next over the first one's root mean square, of all pairs of frames of a sequence."""

    sequence: str
    moved_pixels: float
    """Greatest motion from a frame to the next."""
    still: float
    """The reference's, motion not compensated."""
    reference: float
    renderer: float
    anew: float
    """The renderer's if length coordinates are computed anew in each frame."""


@dataclass(frozen=True)
class _View:
    """Axes of the picture as rows (right, top, towards the camera) and the point in its middle, metres."""

    axes: np.ndarray
    middle: np.ndarray
    radius: float

    def camera(self) -> lisle.Camera:
        world = np.eye(4)
        distance = 60 * self.radius
        world[:3, :3] = self.axes.T
        world[:3, 3] = self.middle + distance * self.axes[2]
        half = 0.5 * HEIGHT * self.radius
        near, far = 0.1 * distance, 2 * distance
        clip = np.diag([1 / half, 1 / half, -2 / (far - near), 1.0])
        clip[2, 3] = -(far + near) / (far - near)
        return lisle.Camera(world, clip, (SIZE, SIZE))

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """Where points are in the picture: columns, and rows from the top."""
        offset = (points - self.middle) @ self.axes[:2].T / (HEIGHT * self.radius)
        return SIZE * np.column_stack([0.5 + offset[:, 0], 0.5 - offset[:, 1]])


class _Cloth:
    """The curves about the middle of an animated cloth."""

    def __init__(self, animation: Animation) -> None:
        self._animation = animation
        whole = animation.reference
        points = whole.points.astype(np.float64)
        self.radius = float(np.mean(whole.radii))
        thin = int(np.argmin(np.ptp(points, axis=0)))
        axes = np.roll(np.eye(3), -thin - 1, axis=0)
        self.view = _View(axes, 0.5 * (points.min(axis=0) + points.max(axis=0)), self.radius)
        offsets = whole.offsets.astype(int)
        beside = np.linalg.norm((points - self.view.middle) @ axes[:2].T, axis=1)
        nearest = np.minimum.reduceat(beside, offsets[:-1])
        chosen: list[int] = []
        for curve in np.argsort(nearest):
            count = sum(offsets[c + 1] - offsets[c] for c in [*chosen, curve])
            if nearest[curve] < REACH * self.radius and count <= MOST_POINTS:
                chosen.append(int(curve))
        self._kept = np.concatenate([np.arange(offsets[c], offsets[c + 1]) for c in chosen])
        self._offsets = np.concatenate([[0], np.cumsum([offsets[c + 1] - offsets[c] for c in chosen])])
        if animation.frames is None:
            raise ValueError("the cloth does not move")
        self._first = self.anew(animation.frames[0])

    def points(self, frame: float) -> np.ndarray:
        return np.asarray(self._animation.at(frame).points[self._kept])

    def anew(self, frame: float) -> lisle.Yarns:
        """With length coordinates of the frame itself."""
        return lisle.Yarns(self.points(frame), self._offsets, yarn_radius=self.radius)

    def at(self, frame: float) -> lisle.Yarns:
        return self._first.with_points(self.points(frame))

    def motion(self, frame: float) -> np.ndarray:
        """Pixels that what is seen at each pixel's centre moves by until the next frame, (h, w, 2).

        The mean over the control points about a pixel: a cloth carries its yarns along.
        """
        here, there = (self.view.pixels(self.points(f)) for f in (frame, frame + 1))
        moved = there - here
        columns, rows = np.meshgrid(np.arange(SIZE) + 0.5, np.arange(SIZE) + 0.5)
        reach = SIZE / HEIGHT
        field = np.empty((SIZE, SIZE, 2))
        for row in range(SIZE):
            away = (columns[row, :, None] - here[:, 0]) ** 2 + (rows[row, :, None] - here[:, 1]) ** 2
            weights = np.exp(-0.5 * away / reach**2) + 1e-30
            field[row] = weights @ moved / weights.sum(axis=1, keepdims=True)
        return field


Draw = Callable[[lisle.Yarns, int], Picture]


def _pictures(draw: Draw, frames: list[lisle.Yarns]) -> list[list[Picture]]:
    return [[draw(yarns, seed) for yarns in frames] for seed in (0, 1)]


def _root(pairs: list[tuple[float, float]]) -> float:
    """Of the sum of squared changes over that of squares."""
    change, square = np.sum(pairs, axis=0)
    return float(np.sqrt(max(change, 0.0) / square))


def flicker(renderer: lisle.Renderer, samples: int) -> Iterator[Flicker]:
    """Of each sequence that is there."""
    yarn = lisle.Yarn.preset("cotton-1")
    material = lisle.Material.preset(models.MATERIALS["light"])
    for name in SEQUENCES:
        path = models.DATA / "animated" / f"{name}.usdc"
        if not path.is_file():
            continue
        cloth = _Cloth(Animation(path))
        view = cloth.view
        direction = np.array(models.SUNS["front"]) @ view.axes

        def scene(yarns: lisle.Yarns, view: _View = view, direction: np.ndarray = direction) -> lisle.Scene:
            made = lisle.Scene(view.camera(), [lisle.Sun(direction=direction, strength=3.0)], (0.0, 0.0, 0.0))
            made.add(yarns, yarn, material)
            return made

        def rendered(yarns: lisle.Yarns, seed: int) -> Picture:
            image = renderer.render(scene(yarns), samples=samples, transport_photons=0, seed=seed)
            return image["combined"][..., :3].astype(np.float64)

        def traced(yarns: lisle.Yarns, seed: int) -> Picture:
            image = lisle.Reference().render(scene(yarns), bounces=1, samples=samples, seed=seed)
            return image["combined"][..., :3].astype(np.float64)

        found: dict[str, list[tuple[float, float]]] = {"still": [], "reference": [], "renderer": [], "anew": []}
        most = 0.0
        for frame in FRAMES:
            motion = cloth.motion(frame)
            most = max(most, float(np.linalg.norm(motion, axis=2).max()))
            kept = [cloth.at(f) for f in (frame, frame + 1)]
            anew = [cloth.anew(f) for f in (frame, frame + 1)]
            reference = _pictures(traced, kept)
            found["reference"].append(measures.squared_change(reference, motion))
            found["still"].append(measures.squared_change(reference, np.zeros_like(motion)))
            found["renderer"].append(measures.squared_change(_pictures(rendered, kept), motion))
            found["anew"].append(measures.squared_change(_pictures(rendered, anew), motion))
        roots = {key: _root(pairs) for key, pairs in found.items()}
        yield Flicker(name, most, **roots)
