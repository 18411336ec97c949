"""What is drawn."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from ._arguments import Triple, Vector
from ._native import Yarns
from .camera import Camera
from .errors import InputError
from .lights import Area, Light, Point, Spot, Sun
from .material import Material
from .yarn import Yarn

T = TypeVar("T")

DEFAULT_YARN = "cotton-1"
DEFAULT_MATERIAL = "cotton"


@dataclass(frozen=True, eq=False)
class Object:
    """Yarn curves at a place, with what they are made of."""

    yarns: Yarns
    yarn: Yarn
    material: Material
    world_from_object: npt.NDArray[np.float64]
    object_id: int
    name: str


class Scene:
    """Objects, lights and a viewpoint.

    Args:
        camera: viewpoint.
        lights: any number of lights.
        ambient: constant radiance from everywhere, scene-linear.
    """

    camera: Camera
    lights: tuple[Light, ...]
    ambient: Triple

    def __init__(self, camera: Camera, lights: Iterable[Light] = (), ambient: Vector = (0.0, 0.0, 0.0)) -> None:
        if not isinstance(camera, Camera):
            raise InputError(f"camera: expected a lisle.Camera, got {type(camera).__name__}")
        self.camera = camera
        self.lights = tuple(lights)
        for index, light in enumerate(self.lights):
            if not isinstance(light, (Sun, Point, Spot, Area)):
                raise InputError(f"light {index}: expected a Sun, Point, Spot or Area, got {type(light).__name__}")
        self.ambient = arguments.triple("ambient", ambient)
        self._objects: list[Object] = []

    @property
    def objects(self) -> tuple[Object, ...]:
        """What has been added."""
        return tuple(self._objects)

    def add(
        self,
        yarns: Yarns,
        yarn: Yarn | None = None,
        material: Material | None = None,
        transform: npt.ArrayLike | None = None,
        object_id: int | None = None,
        name: str | None = None,
    ) -> Object:
        """Adds yarn curves.

        Args:
            yarns: the curves, object space.
            yarn: the procedural yarn; "cotton-1" unless given.
            material: how its fibers scatter; "cotton" unless given.
            transform: 4×4, object to world.
            object_id: the number in the object-id pass, above 0, which also seeds the fibers; the object's place in the
                scene unless given.
            name: for messages.
        """
        if not isinstance(yarns, Yarns):
            raise InputError(f"yarns: expected lisle.Yarns, got {type(yarns).__name__}")
        number = len(self._objects) + 1 if object_id is None else int(object_id)
        name = (yarns.name or f"object {number}") if name is None else name
        if not 0 < number < 2**32:
            raise InputError(f"{name}: object_id {number} is not from 1 to 2³² − 1")
        added = Object(
            yarns=yarns,
            yarn=_expect(name, "yarn", Yarn, yarn or Yarn.preset(DEFAULT_YARN)),
            material=_expect(name, "material", Material, material or Material.preset(DEFAULT_MATERIAL)),
            world_from_object=arguments.matrix(f"{name}: transform", np.eye(4) if transform is None else transform),
            object_id=number,
            name=name,
        )
        self._objects.append(added)
        return added


def scene_of(
    what: Yarns | Scene,
    yarn: Yarn | None,
    material: Material | None,
    camera: Camera | None,
    lights: Iterable[Light] | None,
    ambient: Vector | None,
) -> Scene:
    """What is to be drawn: a scene as it is, or yarns with the rest or its defaults."""
    if isinstance(what, Scene):
        given = {"yarn": yarn, "material": material, "camera": camera, "lights": lights, "ambient": ambient}
        for name, value in given.items():
            if value is not None:
                raise InputError(f"{name}: the scene has its own")
        return what
    if not isinstance(what, Yarns):
        raise InputError(f"expected lisle.Yarns or a lisle.Scene, got {type(what).__name__}")
    scene = Scene(camera or Camera.fit(what), lights or (), (0.0, 0.0, 0.0) if ambient is None else ambient)
    scene.add(what, yarn, material)
    return scene


def _expect(name: str, argument: str, kind: type[T], value: object) -> T:
    if not isinstance(value, kind):
        raise InputError(f"{name}: {argument}: expected a lisle.{kind.__name__}, got {type(value).__name__}")
    return value
