"""The renderer."""

from collections.abc import Callable, Iterable, Sequence

from . import _arguments as arguments
from . import _native
from ._arguments import Vector
from ._native import Adapter, Yarns
from .camera import Camera
from .environment import Environment
from .errors import InputError
from .image import FURTHER_PASSES, Image, manifests
from .lights import Light
from .material import Material
from .mesh import Mesh
from .scene import Scene, moved, scenes_of
from .yarn import Yarn

Progress = Callable[[float], bool | None]
"""Called with the finished fraction, 0 to 1; returning False cancels."""


class Renderer:
    """A graphics adapter that draws yarns.

    Args:
        adapter: a part of its name, see `adapters`; the most capable one unless given.

    Raises:
        DeviceError: there is no such adapter, or none that is usable.
    """

    def __init__(self, adapter: str | None = None) -> None:
        self._native = _native.Renderer(None if adapter is None else arguments.text("adapter", adapter))

    @property
    def adapter(self) -> Adapter:
        """What it draws with."""
        return self._native.adapter

    def __repr__(self) -> str:
        return f"Renderer({self.adapter.name!r})"

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
        samples: int = 16,
        size: tuple[int, int] | None = None,
        shading: str = "physical",
        transport_photons: int = 500_000,
        occlusion: str = "distance",
        region: tuple[int, int, int, int] | None = None,
        transparent: bool = True,
        lod_pixels: float = 1.0,
        filter: str = "blackman-harris",
        filter_width: float = 1.5,
        noise_threshold: float = 0.0,
        time_limit_s: float | None = None,
        table_resolution: int = 1,
        sky_directions: int = 8,
        shadow_resolution: int = 2048,
        seed: int = 0,
        first_sample: int = 0,
        passes: Iterable[str] = (),
        before: Yarns | Scene | None = None,
        after: Yarns | Scene | None = None,
        progress: Progress | None = None,
    ) -> Image:
        """Draws yarns, or a scene.

        Motion blur: a list of scenes, or of shapes of the same yarns (`with_points`) and of cameras, stands for even
        steps over the time that the shutter is open. Between them everything moves evenly. Objects and meshes
        correspond by their order; meshes of other triangles keep their shape, and all stay where they are if a scene
        has not as many. Lights are those of the first scene. What belongs to the pixel's centre, such as depth, is of
        the middle of that time.

        Args:
            what: yarns, with the next seven arguments; or a scene, which has them already; or a list, see above.
            yarn: the procedural yarn; "cotton-1" unless given.
            material: how its fibers scatter; "cotton" unless given.
            camera: viewpoint, or one for each time step; `Camera.fit(yarns)` of the first unless given.
            lights: any number of lights.
            ambient: constant radiance from everywhere, scene-linear.
            environment: radiance from everywhere, which is added to `ambient`; each sample takes a few directions.
            meshes: surfaces that hide yarn, throw shadows on it and take its own.
            samples: jittered samples per pixel; the most, if one of the two below stops earlier.
            size: width and height of the whole frame, pixels; the camera's unless given.
            shading: "physical" (R + TT and diffuse) or "simple".
            transport_photons: photons by which light that is scattered more than once is precomputed for each yarn and
                material, with physical shading; 0 leaves it out.
            occlusion: "distance" (cubic in the distance from the yarn's centre) or "table".
            region: part of the frame to draw, x0, y0, x1, y1 in pixels from the bottom left, x1 and y1 exclusive.
            transparent: leaves the background transparent; otherwise it is that of ambient and environment.
            lod_pixels: fibers thinner than this are merged; 0 draws every fiber.
            filter: of pixels: "blackman-harris", "gaussian" or "box".
            filter_width: from one of its ends to the other, pixels; 0 for a point sample at the centre of each pixel.
            noise_threshold: stops before `samples` when the noise is down to this, 0.01 for example; 0 for never. It is
                half the difference between the two halves of the samples, relative to the square root of the colour,
                as root of the mean square over what shows anything; looked at after 16, 32, 64 … samples.
            time_limit_s: stops when so many seconds have passed. The picture then depends on the machine's speed.
            table_resolution: times as many texels along each side of the tables of self-shadow and occlusion, 1 to 4.
            sky_directions: in which sky and other yarns are seen, over all samples at least, 1 to 8: few are quick, and
                hang on which they are.
            shadow_resolution: texels along one side of a shadow map, 16 to 16384.
            seed: of the sample sequence.
            first_sample: its number in that sequence: samples 0 to 7 and 8 to 15 are two halves of one picture of 16.
                Sample 0 is taken at the pixel's centre, through the lens's centre.
            passes: further ones to draw, see `Image`; without them they take neither time nor memory.
            before, after: what is drawn as it is one frame earlier and one later, for the pass "vector".
            progress: called now and then with the finished fraction; returning False cancels.

        Raises:
            InputError: something in the scene or the arguments cannot be drawn.
            DeviceError: the adapter failed.
            Cancelled: `progress` returned False. What `progress` raises comes through as it is.
        """
        steps = scenes_of(what, yarn, material, camera, lights, ambient, environment, meshes)
        scene = steps[0]
        if (before is None) != (after is None):
            raise InputError("before, after: expected both or neither")
        neighbours = [moved(scene, other) for other in (before, after) if other is not None]
        passes = arguments.items("passes", passes, "a list of names")
        for name in passes:
            if name not in FURTHER_PASSES:
                raise InputError(f"passes: {name!r} is none of {', '.join(FURTHER_PASSES)}")
        size = arguments.pixels("size", scene.camera.size if size is None else size)
        drawn, statistics = self._native.render(
            scene.objects,
            scene.numbered_meshes(),
            scene.lights,
            scene.ambient,
            scene.environment,
            scene.camera,
            [(step.objects, step.numbered_meshes(), step.camera) for step in steps[1:]],
            [(other.objects, other.numbered_meshes(), other.camera) for other in neighbours],
            {
                "size": size,
                "region": None if region is None else arguments.from_top_left(region, size),
                "samples": samples,
                "shading": shading,
                "transport_photons": transport_photons,
                "occlusion": occlusion,
                "transparent": transparent,
                "lod_pixels": lod_pixels,
                "filter": filter,
                "filter_width": filter_width,
                "noise_threshold": noise_threshold,
                "time_limit_s": time_limit_s,
                "table_resolution": table_resolution,
                "sky_directions": sky_directions,
                "shadow_resolution": shadow_resolution,
                "seed": seed,
                "first_sample": first_sample,
                "passes": passes,
            },
            progress,
        )
        return Image(drawn, statistics, manifests(scene, passes))
