"""What is drawn."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import count
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from ._arguments import Triple, Vector
from ._native import Yarns
from .camera import Camera
from .environment import Environment
from .errors import InputError
from .lights import Light
from .material import Material
from .mesh import Mesh
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
    object_index: int = 0
    material_name: str = ""
    material_index: int = 0
    is_holdout: bool = False


class Scene:
    """Objects, lights and a viewpoint.

    Args:
        camera: viewpoint.
        lights: any number of lights.
        ambient: constant radiance from everywhere, scene-linear.
        environment: radiance from everywhere, which is added to that.
        meshes: surfaces that hide yarn, throw shadows on it and take its own.
    """

    camera: Camera
    lights: tuple[Light, ...]
    ambient: Triple
    environment: Environment | None
    meshes: tuple[Mesh, ...]

    def __init__(
        self,
        camera: Camera,
        lights: Iterable[Light] = (),
        ambient: Vector = (0.0, 0.0, 0.0),
        environment: Environment | None = None,
        meshes: Iterable[Mesh] = (),
    ) -> None:
        if not isinstance(camera, Camera):
            raise InputError(f"camera: expected a lisle.Camera, got {type(camera).__name__}")
        self.camera = camera
        self.lights = arguments.items("lights", lights, "a list of lights")
        for index, light in enumerate(self.lights):
            if not isinstance(light, Light):
                names = "Sun, Gaussian, Point, Spot or Area"
                raise InputError(f"light {index}: expected a {names}, got {type(light).__name__}")
        self.ambient = arguments.triple("ambient", ambient)
        if not isinstance(environment, Environment | None):
            raise InputError(f"environment: expected a lisle.Environment, got {type(environment).__name__}")
        self.environment = environment
        self.meshes = arguments.items("meshes", meshes, "a list of meshes")
        for index, mesh in enumerate(self.meshes):
            if not isinstance(mesh, Mesh):
                raise InputError(f"mesh {index}: expected a lisle.Mesh, got {type(mesh).__name__}")
        self._objects: list[Object] = []

    @property
    def objects(self) -> tuple[Object, ...]:
        """What has been added."""
        return tuple(self._objects)

    def numbered_meshes(self) -> list[tuple[Mesh, int]]:
        """Each mesh with its number in the object-id pass: its own, or the next after all those that are given."""
        taken = [added.object_id for added in self._objects]
        taken += [mesh.object_id for mesh in self.meshes if mesh.object_id is not None]
        free = count(max(taken, default=0) + 1)
        return [(mesh, next(free) if mesh.object_id is None else mesh.object_id) for mesh in self.meshes]

    def add(
        self,
        yarns: Yarns,
        yarn: Yarn | None = None,
        material: Material | None = None,
        transform: npt.ArrayLike | None = None,
        object_id: int | None = None,
        name: str | None = None,
        object_index: int = 0,
        material_name: str = "",
        material_index: int = 0,
        holdout: bool = False,
    ) -> Object:
        """Adds yarn curves.

        Args:
            yarns: the curves, object space.
            yarn: the procedural yarn; "cotton-1" unless given.
            material: how its fibers scatter; "cotton" unless given.
            transform: 4×4, object to world.
            object_id: the number in the object-id pass, above 0, which also seeds the fibers; the object's place in the
                scene unless given.
            name: for messages, and in the pass "crypto_object".
            object_index: the number in the pass "object_index", which need not be unique.
            material_name: the name in the pass "crypto_material".
            material_index: the number in the pass "material_index".
            holdout: a hole in the picture, which hides what is behind and casts shadows.
        """
        if not isinstance(yarns, Yarns):
            raise InputError(f"yarns: expected lisle.Yarns, got {type(yarns).__name__}")
        number = len(self._objects) + 1 if object_id is None else object_id
        name = (yarns.name or f"object {number}") if name is None else name
        number = arguments.object_id(name, number)
        added = Object(
            yarns=yarns,
            yarn=_expect(name, "yarn", Yarn, yarn or Yarn.preset(DEFAULT_YARN)),
            material=_expect(name, "material", Material, material or Material.preset(DEFAULT_MATERIAL)),
            world_from_object=arguments.matrix(f"{name}: transform", np.eye(4) if transform is None else transform),
            object_id=number,
            name=name,
            object_index=arguments.label_index(f"{name}: object_index", object_index),
            material_name=str(material_name),
            material_index=arguments.label_index(f"{name}: material_index", material_index),
            is_holdout=bool(holdout),
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
    environment: Environment | None,
    meshes: Iterable[Mesh] | None,
) -> Scene:
    """What is to be drawn: a scene as it is, or yarns with the rest or its defaults."""
    if isinstance(what, Scene):
        given = {
            "yarn": yarn,
            "material": material,
            "camera": camera,
            "lights": lights,
            "ambient": ambient,
            "environment": environment,
            "meshes": meshes,
        }
        for name, value in given.items():
            if value is not None:
                raise InputError(f"{name}: the scene has its own")
        return what
    if not isinstance(what, Yarns):
        raise InputError(f"expected lisle.Yarns or a lisle.Scene, got {type(what).__name__}")
    scene = Scene(
        camera or Camera.fit(what),
        lights or (),
        (0.0, 0.0, 0.0) if ambient is None else ambient,
        environment,
        meshes or (),
    )
    scene.add(what, yarn, material)
    return scene


def scenes_of(
    what: Yarns | Scene | Sequence[Yarns] | Sequence[Scene],
    yarn: Yarn | None,
    material: Material | None,
    camera: Camera | Sequence[Camera] | None,
    lights: Iterable[Light] | None,
    ambient: Vector | None,
    environment: Environment | None,
    meshes: Iterable[Mesh] | None,
) -> list[Scene]:
    """The same at several times: lists of scenes, yarns or cameras, of one length; what is no list counts for all."""
    if not isinstance(what, (Yarns, Scene, Sequence)) or (isinstance(what, Sequence) and not what):
        raise InputError(f"expected lisle.Yarns, a lisle.Scene or a list of either, got {type(what).__name__}")
    shapes: list[Yarns | Scene] = [what] if isinstance(what, (Yarns, Scene)) else list(what)
    cameras = [camera] if camera is None or isinstance(camera, Camera) else list(camera)
    times = max(len(shapes), len(cameras))
    for name, items in (("time steps", shapes), ("cameras", cameras)):
        if len(items) not in (1, times):
            raise InputError(f"{name}: there are {len(items)}, expected {times}, as many as of the others")
    first = scene_of(shapes[0], yarn, material, cameras[0], lights, ambient, environment, meshes)
    scenes = [first]
    for step in range(1, times):
        shape, seen_from = shapes[step % len(shapes)], cameras[step % len(cameras)]
        scenes.append(moved(first, shape, seen_from))
    return scenes


def moved(scene: Scene, what: Yarns | Scene, camera: Camera | None = None) -> Scene:
    """A scene at another time: as given, or with its only object's yarns in another shape."""
    if isinstance(what, Scene):
        if camera is not None:
            raise InputError("camera: the scene has its own")
        return what
    if not isinstance(what, Yarns):
        raise InputError(f"expected lisle.Yarns or a lisle.Scene, got {type(what).__name__}")
    if len(scene.objects) != 1:
        raise InputError("yarns in another shape stand for a scene of one object")
    other = Scene(camera or scene.camera, scene.lights, scene.ambient, scene.environment, scene.meshes)
    other._objects.append(replace(scene.objects[0], yarns=what))
    return other


def _expect(name: str, argument: str, kind: type[T], value: object) -> T:
    if not isinstance(value, kind):
        raise InputError(f"{name}: {argument}: expected a lisle.{kind.__name__}, got {type(value).__name__}")
    return value
