# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view layer shows at one frame: curves, where they are placed, lights, meshes.

Blender lists geometry-nodes output twice: in the geometry set of the object that makes it, and as extra entries of
`depsgraph.object_instances` without attributes. Only the first is read; instances of whole objects and collections
come from the second.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from ..core.curves import CurveArrays
from ..core.pixels import stable_id
from . import follow
from .curves import read_curves
from .guides import Guides
from .instances import instancer_of
from .legacy import is_shortened, left_out, read_legacy, shown_parts
from .lights import native_light
from .materials import geometry_materials, yarn_and_material
from .meshes import TYPES as MESH_TYPES
from .meshes import MeshPlacement, MeshReader


@dataclass(frozen=True)
class Geometry:
    """Curves of one object, or of one geometry that its geometry nodes instance."""

    key: tuple
    """Name of the object, then the indices of the instanced geometry: the same in every frame and process."""
    object_name: str
    curves: CurveArrays
    materials: list
    """(lisle.Yarn, lisle.Material) by material index; never empty."""
    labels: list
    """(name, Blender's index) of the materials, likewise."""
    reference_frame: int
    remeasure: bool
    parts: np.ndarray | None = None
    """(c, 2) float64: which part of each curve is there, as in core.trim; None if all are whole."""

    def equals(self, other):
        """Whether both look the same."""
        return (
            self.materials == other.materials
            and self.curves.equals(other.curves)
            and np.array_equal(self.parts, other.parts)
        )


@dataclass(frozen=True)
class Placement:
    """A geometry at a place."""

    key: tuple
    world_from_object: np.ndarray
    """(4, 4) float64."""
    identity: int
    """Tells this placement from others, above 0; the same in every frame and process."""
    pass_index: int
    """Blender's object index."""
    name: str
    is_holdout: bool

    def order(self):
        """Sorts placements the same way in every process; equal if they look the same."""
        return self.key, self.identity, self.world_from_object.tobytes(), self.is_holdout


@dataclass
class Content:
    """What `collect` returns. Holds no reference into Blender's data."""

    geometries: dict = field(default_factory=dict)
    """Geometry by key."""
    placements: list = field(default_factory=list)
    lights: list = field(default_factory=list)
    meshes: list = field(default_factory=list)
    """MeshPlacement."""

    def equals(self, other):
        """Whether both look the same."""
        return (
            self.geometries.keys() == other.geometries.keys()
            and all(mine.equals(other.geometries[key]) for key, mine in self.geometries.items())
            and [placement.order() for placement in self.placements] == [p.order() for p in other.placements]
            and repr(self.lights) == repr(other.lights)
            and [placement.order() for placement in self.meshes] == [p.order() for p in other.meshes]
        )


def collect(lisle, depsgraph, note, only=None, shows=None):
    """Reads the curves, lights and meshes of a view layer at the frame that `depsgraph` is at.

    `only` limits it to the curves of objects of these names (as in `Geometry.key`), without lights and meshes.
    `shows(object)` says whether a view shows an object, or what it instances; without it, all are shown.
    `note` is called with each sentence about something left out.
    """
    content = Content()
    parts_of, reader, guides = {}, MeshReader(lisle, note), Guides()
    ignored = set()
    for instance in depsgraph.object_instances:
        obj = instance.object
        if obj.type != obj.original.type:  # a component of some geometry set under its owner's name
            continue
        if obj.type == "LIGHT":
            if only is None and instance.show_self:
                light = native_light(lisle, obj, instance.matrix_world, note)
                content.lights += [] if light is None else [light]
            continue
        name = obj.original.name_full
        if only is not None and name not in only:
            continue
        if shows is not None and not shows((instance.parent if instance.is_instance else obj).original):
            continue
        is_yarn = _may_have_curves(obj) and guides.is_yarn(obj)
        if only is None and (obj.type in MESH_TYPES or (obj.type == "CURVE" and not is_yarn)):
            content.meshes += reader.read(instance)
        if not is_yarn:
            if obj.type in _IGNORED_TYPES:
                ignored.add(f"'{name}' ({obj.type.lower()})")
            continue
        if only is None and not obj.visible_camera:
            continue
        follow.check(obj, depsgraph)
        geometry = obj.evaluated_geometry()
        if instance.is_instance and _is_component(obj, geometry):
            continue
        if name not in parts_of:
            parts_of[name] = _read_parts(lisle, obj, geometry, depsgraph)
            sentence = left_out(obj)
            if sentence is not None and parts_of[name]:
                note(f"object '{obj.name}': {sentence}")
            for part, _ in parts_of[name]:
                content.geometries[part.key] = part
        world_from_object = np.array(instance.matrix_world, dtype=np.float64)
        instancer = instancer_of(instance)
        for part, transforms in parts_of[name]:
            if not instance.show_self and len(part.key) == 1:
                continue
            for number, transform in enumerate(transforms):
                matrix = world_from_object @ transform
                if np.linalg.det(matrix[:3, :3]) == 0:  # scaled away
                    continue
                identity = stable_id(part.key, *instancer, number)
                content.placements.append(
                    Placement(part.key, matrix, identity, obj.pass_index, obj.name, obj.is_holdout)
                )
    if ignored and only is None:
        note(f"objects of these kinds are not drawn: {', '.join(sorted(ignored)[:5])}")
    content.placements.sort(key=Placement.order)
    content.meshes.sort(key=MeshPlacement.order)
    return content


_IGNORED_TYPES = {"VOLUME", "POINTCLOUD", "GPENCIL", "GREASEPENCIL"}


def _may_have_curves(obj):
    return obj.type in {"CURVES", "CURVE"} or any(modifier.type == "NODES" for modifier in obj.modifiers)


def _is_component(obj, geometry):
    """Whether an instance is a bare component of some geometry set: those carry neither curves nor instances."""
    if geometry.curves is not None or geometry.instances_pointcloud() is not None:
        return False
    return obj.type != "CURVE" or (geometry.mesh is None and not is_shortened(obj.data))


def _read_parts(lisle, obj, geometry, depsgraph):
    """[(Geometry, (k, 4, 4) object_from_part)] of one evaluated object."""
    name, settings, scene = obj.original.name_full, obj.lisle, depsgraph.scene
    if settings.use_reference_frame:
        reference_frame = settings.reference_frame
    elif scene.lisle.use_reference_frame:
        reference_frame = scene.lisle.reference_frame
    else:
        reference_frame = scene.frame_start

    parts = []

    def add(path, arrays, materials, transforms, shown=None):
        if arrays is None:
            return
        if settings.yarn_radius > 0 and obj.type != "CURVE":
            arrays = _with_radius(arrays, settings.yarn_radius)
        native = [yarn_and_material(lisle, material, obj.name) for material in materials or [None]]
        labels = [(material.name, material.pass_index) if material else ("", 0) for material in materials or [None]]
        geometry = Geometry((name, *path), obj.name, arrays, native, labels, reference_frame, settings.remeasure, shown)
        parts.append((geometry, transforms))

    own = np.eye(4)[np.newaxis]
    if obj.type == "CURVE":
        arrays = read_legacy(obj, geometry, depsgraph)
        add((), arrays, geometry_materials(obj, geometry.curves or obj.data), own, shown_parts(obj, arrays))
    elif geometry.curves is not None:
        add((), read_curves(geometry.curves, obj.name), geometry_materials(obj, geometry.curves), own)
    for path, curves, transforms in _instanced_curves(geometry, (), own):
        add(path, read_curves(curves, obj.name), list(curves.materials), transforms)
    return parts


def _with_radius(arrays, radius_m):
    return replace(arrays, radii=np.full(len(arrays.points), radius_m, np.float32))


def _instanced_curves(geometry, path, transforms):
    """(path, curves, (k, 4, 4) object_from_curves) of every geometry that a geometry set instances, at any depth."""
    instances = geometry.instances_pointcloud()
    if instances is None:
        return
    count = len(instances.points)
    references = np.empty(count, np.int32)
    instances.attributes[".reference_index"].data.foreach_get("value", references)
    matrices = np.empty(count * 16, np.float32)
    instances.attributes["instance_transform"].data.foreach_get("value", matrices)
    matrices = matrices.reshape(count, 4, 4).transpose(0, 2, 1).astype(np.float64)  # stored by columns
    for index, reference in enumerate(geometry.instance_references()):
        if not hasattr(reference, "instance_references"):  # an object or a collection: an entry of its own
            continue
        local = matrices[references == index]
        nested = np.einsum("aij,bjk->abik", transforms, local).reshape(-1, 4, 4)
        if reference.curves is not None:
            yield (*path, index), reference.curves, nested
        yield from _instanced_curves(reference, (*path, index), nested)
