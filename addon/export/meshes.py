# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of the scene, as they hide yarn and throw shadows on it."""

from contextlib import contextmanager
from dataclasses import dataclass
from types import SimpleNamespace

import bpy
import numpy as np

from ..core.pixels import stable_id
from ..core.surfaces import HOLDOUT, SHADED, SHADOW_CATCHER, Surface, by_material
from . import textures
from .instances import instancer_of
from .nodes import source_of

TYPES = {"MESH", "FONT", "META", "SURFACE"}
"""Objects that are meshes when they are evaluated."""

_GREY = (0.8, 0.8, 0.8)
_KINDS = {"SHADED": SHADED, "SHADOW_CATCHER": SHADOW_CATCHER, "HOLDOUT": HOLDOUT}


@dataclass(frozen=True, eq=False)
class MeshPlacement:
    """One material's part of a mesh at a place."""

    surface: Surface
    world_from_object: np.ndarray
    """(4, 4) float64."""
    color: tuple
    """Scene-linear (r, g, b)."""
    kind: str
    identity: int
    """As that of a yarn's placement."""
    pass_index: int
    name: str
    material_name: str
    material_index: int
    """Blender's."""
    picture: textures.Picture | None = None
    """In the stead of `color`."""

    def order(self):
        """Sorts placements the same way in every process; equal if they look the same."""
        return (
            self.identity, self.surface.digest, self.world_from_object.tobytes(), self.color, self.kind,
            self.pass_index, self.name, self.material_name, self.material_index,
            0 if self.picture is None else self.picture.number,
        )  # fmt: skip


class MeshReader:
    """Reads meshes, each geometry once. Tells `note` (a callable) what is left out."""

    def __init__(self, lisle, note):
        self._lisle, self._note = lisle, note
        self._parts_of = {}

    def read(self, instance):
        """[MeshPlacement] of an entry of `depsgraph.object_instances` whose object is one of `TYPES`."""
        obj = instance.object
        kind = mesh_kind(obj)
        if kind is None or not instance.show_self:
            return []
        world_from_object = np.array(instance.matrix_world, dtype=np.float64)
        instancer = instancer_of(instance)
        materials = [slot.material for slot in obj.material_slots] or [None]
        plans = [plan_of(material, self._note) for material in materials]
        placements = []
        for index, surface in self._parts(obj, plans):
            slot = min(index, len(materials) - 1)
            material, plan = materials[slot], plans[slot]
            picture = None
            if plan.image is not None and surface.uvs is None:
                self._note(f"object '{obj.name}': it lacks the UV map of '{plan.image.name}', a colour counts")
            elif plan.image is not None:
                picture = textures.picture(self._lisle, plan.image)
            label = (material.name, material.pass_index) if material is not None else ("", 0)
            identity = stable_id("mesh", obj.original.name_full, index, *instancer)
            placements.append(
                MeshPlacement(
                    surface, world_from_object, plan.color, kind, identity, obj.pass_index, obj.name, *label, picture
                )
            )
        return placements

    def _parts(self, obj, plans):
        """[(material index, Surface)]"""
        maps = tuple(None if plan.image is None else (plan.uv_map, plan.mapping) for plan in plans)
        key = obj.data.as_pointer() if obj.type == "MESH" else obj.as_pointer(), maps
        if key not in self._parts_of:
            with evaluated_mesh(obj) as mesh:
                self._parts_of[key] = [] if mesh is None else _read(mesh, maps)
        return self._parts_of[key]


@contextmanager
def evaluated_mesh(obj):
    """The mesh of an evaluated object of one of `TYPES`, None without one; not to be kept."""
    # In Edit Mode Blender leaves the data of an evaluated mesh empty.
    if obj.type == "MESH" and not obj.data.is_editmode:
        yield obj.data
        return
    try:
        yield obj.to_mesh()
    finally:
        obj.to_mesh_clear()


def mesh_kind(obj):
    """The native name of what is seen of a mesh object; None if nothing is."""
    kind = obj.lisle.mesh_kind
    if kind == "INVISIBLE" or not obj.visible_camera:
        return None
    if kind == "SHADED" and obj.is_holdout:
        return HOLDOUT
    if kind == "SHADED" and obj.is_shadow_catcher:
        return SHADOW_CATCHER
    return _KINDS[kind]


def plan_of(material, note):
    """What is taken of a material: `color`, scene-linear (r, g, b); `image` in its stead, or None, the name of its
    `uv_map`, and its `mapping`. The colour is that of the node that makes the surface, or the one in the viewport.
    Tells `note` what is left out."""
    plan = SimpleNamespace(color=_GREY, image=None, uv_map="", mapping=None)
    if material is None:
        return plan
    color = material.diffuse_color
    surface = _surface(material)
    if surface is not None:
        socket = surface.inputs.get("Base Color") or surface.inputs.get("Color")
        source = None if socket is None else source_of(socket)
        if source is None:
            why = f"its '{surface.name}' node has no colour"
        elif source.is_output and source.node.type == "TEX_IMAGE" and source.name == "Color":
            why = textures.read_node(source.node, plan)
        elif source.type == "RGBA" and (not source.is_output or source.node.type == "RGB"):
            why, color = None, source.default_value
        else:
            why = f"what is linked to {socket.name} is ignored"
        if why is not None:
            note(f"material '{material.name}': {why}, its colour in the viewport counts")
    plan.color = tuple(min(max(channel, 0.0), 1.0) for channel in color[:3])
    return plan


def _surface(material):
    """The node that makes a material's surface, or None."""
    # Since 5.0 a material always has nodes, and asking is deprecated.
    if material.node_tree is None or (bpy.app.version < (5, 0, 0) and not material.use_nodes):
        return None
    output = material.node_tree.get_output_node("ALL")
    source = None if output is None else source_of(output.inputs["Surface"])
    return source.node if source is not None and source.is_output else None


def _read(mesh, maps):
    """[(material index, Surface)] of an evaluated mesh; `maps` are (name, mapping) of UV maps by material, None without
    one."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    if not count:
        return []
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", positions)
    triangles = np.empty(3 * count, np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    material_index = np.empty(count, np.int32)
    mesh.loop_triangles.foreach_get("material_index", material_index)
    corners = np.empty(3 * count, np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    corners = corners.reshape(-1, 3)
    normals = None
    if mesh.normals_domain != "FACE":
        at_corners = np.empty(3 * len(mesh.loops), np.float32)
        mesh.corner_normals.foreach_get("vector", at_corners)
        normals = at_corners.reshape(-1, 3)[corners]

    def uvs(index):
        place = maps[min(index, len(maps) - 1)]
        return None if place is None else textures.uvs_of(mesh, *place, corners)

    return by_material(positions.reshape(-1, 3), triangles.reshape(-1, 3), normals, material_index, uvs)
