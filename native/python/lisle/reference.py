"""The reference: every fiber explicit, and light scattered between them as often as it likes."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from . import _native
from ._arguments import Vector
from ._native import Yarns
from .camera import Camera
from .environment import Environment
from .errors import InputError
from .image import Image
from .lights import Light
from .material import Material
from .mesh import Mesh
from .renderer import Progress
from .scene import DEFAULT_YARN, Scene, scenes_of
from .yarn import Yarn

CHORD_ERROR = 0.25
"""How far a chord may depart from its fiber, radii of the fiber."""


class Fibers(NamedTuple):
    """Fibers as chains of points, in the space and unit of the yarns' points.

    A hair, and what begins beyond its tip, are chains of their own.
    """

    points: npt.NDArray[np.float32]
    """(n, 3) positions."""
    offsets: npt.NDArray[np.uint32]
    """(c + 1,): chain i owns the points offsets[i] to offsets[i + 1], at least 2."""
    radii: npt.NDArray[np.float32]
    """(n,), 0 at the tips of hairs."""


def fibers(
    yarns: Yarns,
    yarn: Yarn | None = None,
    *,
    chord_error: float = CHORD_ERROR,
    object_id: int = 1,
    camera: Camera | None = None,
    lod_pixels: float = 1.0,
    progress: Progress | None = None,
) -> Fibers:
    """The fibers of yarns, loops and hairs included, as any other renderer can draw them.

    Args:
        yarns: the curves.
        yarn: the procedural yarn; "cotton-1" unless given.
        chord_error: how far a chord may depart from its fiber, in radii of the fiber, 0.001 to 10.
        object_id: that of the object in a scene, which seeds its fibers; a scene's first object has 1.
        camera: makes fewer fibers where this view does not tell them apart, each as much wider, and chords up to a
            quarter of a pixel off; all fibers unless given.
        lod_pixels: with a camera, the width in pixels below which fibers are merged.
        progress: called now and then with the finished fraction; returning False cancels.

    Raises:
        InputError: an argument is out of range, or there are more than 2³² points.
        Cancelled: `progress` returned False. What `progress` raises comes through as it is.
    """
    if not isinstance(yarns, Yarns):
        raise InputError(f"yarns: expected lisle.Yarns, got {type(yarns).__name__}")
    object_id = arguments.object_id("fibers", object_id)
    chord_error = arguments.number("chord_error", chord_error)
    view = None
    if camera is not None:
        lod_pixels = arguments.number("lod_pixels", lod_pixels)
        if not 0.0 < lod_pixels <= 100.0:
            raise InputError(f"lod_pixels: {lod_pixels} is not above 0 and at most 100 pixels")
        view = (camera, camera.size, lod_pixels)
    yarn = yarn or Yarn.preset(DEFAULT_YARN)
    return Fibers(*_native.fibers(yarns, yarn, chord_error, object_id, view, progress))


class Reference:
    """A path tracer through explicit fibers: slow, and right.

    It draws the same as `Renderer`, from the same arguments.

    It runs on all cores and needs no graphics adapter. Memory: 40 bytes for each segment of a fiber, up to 200
    while it starts. A knitted glove, 140 000 yarn radii of yarn with 225 fibers, has 100 million.
    """

    def render(
        self,
        what: Yarns | Scene | Sequence[Yarns] | Sequence[Scene],
        *,
        yarn: Yarn | None = None,
        material: Material | None = None,
        camera: Camera | Sequence[Camera] | None = None,
        lights: Iterable[Light] | None = None,
        ambient: Vector | None = None,
        environment: Environment | None = None,
        meshes: Iterable[Mesh] | None = None,
        samples: int = 64,
        size: tuple[int, int] | None = None,
        shading: str = "physical",
        bounces: int | None = None,
        region: tuple[int, int, int, int] | None = None,
        transparent: bool = True,
        filter_width: float = 1.5,
        chord_error: float = CHORD_ERROR,
        seed: int = 0,
        checkpoint: str | Path | None = None,
        progress: Progress | None = None,
    ) -> Image:
        """Draws yarns, or a scene. The picture has the pass "variance".

        The same arguments give the same bits on any number of cores.

        Motion blur as by `Renderer.render`: a list stands for even steps over the time that the shutter is open. Each
        sample has a time of its own. Meshes stay where they are at the first step. If more than the camera moves,
        fibers are made anew for each sample.

        Args:
            what: yarns, with the next seven arguments; or a scene, which has them already; or a list, see above.
            yarn: the procedural yarn; "cotton-1" unless given.
            material: how its fibers scatter; "cotton" unless given.
            camera: viewpoint, or one for each time step; `Camera.fit(yarns)` of the first unless given.
            lights: any number of lights.
            ambient: constant radiance from everywhere, scene-linear.
            environment: light from all sides, which is added to `ambient`.
            meshes: matt surfaces, from and to which light is scattered; under a texture, of its mean colour. A shadow
                catcher or a hole in the picture is one for the camera alone.
            samples: independent paths per pixel.
            size: width and height of the whole frame, pixels; the camera's unless given.
            shading: "physical" (R + TT and diffuse) or "simple".
            bounces: most times that light is scattered, 1 as the renderer without photons; any number unless given.
            region: part of the frame to draw, x0, y0, x1, y1 in pixels from the bottom left, x1 and y1 exclusive.
            transparent: leaves the background transparent; otherwise it is that of ambient and environment.
            filter_width: of the pixel filter, pixels; 0 for a point sample at the centre of each pixel.
            chord_error: how far a chord may depart from its fiber, in radii of the fiber, 0.001 to 10.
            seed: of all random numbers.
            checkpoint: a file that keeps the work. If it is there, the picture goes on with it, to the same bits. It is
                written every minute, on cancelling, and at the end, when more samples can follow later.
            progress: called now and then with the finished fraction; returning False cancels.

        Raises:
            InputError: something in the scene or the arguments cannot be drawn; a checkpoint is of another picture.
            OSError: the checkpoint cannot be read or written.
            Cancelled: `progress` returned False. What `progress` raises comes through as it is.
        """
        steps = scenes_of(what, yarn, material, camera, lights, ambient, environment, meshes)
        scene = steps[0]
        size = arguments.pixels("size", scene.camera.size if size is None else size)
        passes, statistics = _native.reference(
            scene.objects,
            scene.numbered_meshes(),
            scene.lights,
            scene.ambient,
            scene.environment,
            scene.camera,
            [(step.objects, step.numbered_meshes(), step.camera) for step in steps[1:]],
            {
                "size": size,
                "region": None if region is None else arguments.from_top_left(region, size),
                "samples": samples,
                "seed": seed,
                "bounces": bounces,
                "shading": shading,
                "transparent": transparent,
                "filter_width": filter_width,
                "chord_error": chord_error,
            },
            None if checkpoint is None else Path(checkpoint),
            progress,
        )
        return Image(passes, statistics)
