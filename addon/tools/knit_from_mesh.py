# SPDX-License-Identifier: GPL-3.0-or-later
"""Object › Knit from Mesh: yarn that follows a mesh, a cloth simulation for example."""

import bpy
import numpy as np
from bpy.props import BoolProperty
from mathutils import Matrix

from .. import native
from ..core.errors import GeometryError, LisleError, SceneError
from ..export.follow import HEIGHT, VERTICES, WEIGHTS, follow
from ..properties import yarn_radius
from .add_knit import KnitPattern
from .store_length import NAME as LENGTH
from .yarn_objects import NewMaterial, yarn_data


class LISLE_OT_knit_from_mesh(KnitPattern, NewMaterial, bpy.types.Operator):
    """Knit on the active mesh: courses run along u of its active UV map, wales along v; the yarn follows the mesh"""

    bl_idname = "lisle.knit_from_mesh"
    bl_label = "Knit from Mesh"
    bl_options = {"REGISTER", "UNDO"}

    yarn_radius: yarn_radius("Radius of the yarn; stitches have their natural size on average", min=1e-5, default=0.001)
    hide_mesh: BoolProperty(
        name="Hide Mesh",
        description="Keep the mesh out of pictures, and show it as wire. It moves the yarn all the same",
        default=True,
    )

    @classmethod
    def poll(cls, context):
        obj = context.active_object
        if obj is None or obj.type != "MESH" or obj.mode != "OBJECT":
            cls.poll_message_set("Make a mesh object active, in Object Mode")
            return False
        return True

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        self.draw_stitches(layout)
        layout.prop(self, "yarn_radius")
        column = layout.column()
        column.prop(self, "yarn")
        column.prop(self, "fiber")
        layout.prop(self, "hide_mesh")

    def execute(self, context):
        try:
            made = self._make(native.module(), context)
        except LisleError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for obj in context.selected_objects:
            obj.select_set(False)
        made.select_set(True)
        context.view_layer.objects.active = made
        return {"FINISHED"}

    def _make(self, lisle, context):
        mesh_object, collection = context.active_object, context.collection
        if collection.library is not None or collection.override_library is not None:
            raise SceneError(f"The collection '{collection.name}' is linked: make one of this file active")
        evaluated = mesh_object.evaluated_get(context.evaluated_depsgraph_get())
        location, rotation, _ = evaluated.matrix_world.decompose()
        placed = Matrix.LocRotScale(location, rotation, None)
        # The yarn has no scale: its radius is in metres.
        positions, normals, triangles, uvs = _read(evaluated, placed.inverted_safe() @ evaluated.matrix_world)
        try:
            knit = lisle.knit_on_mesh(positions, normals, triangles, uvs, self.stitches(), self.yarn_radius)
        except lisle.Error as error:
            raise GeometryError(mesh_object.name, str(error)) from error
        name = f"{mesh_object.name} Knit"
        data = yarn_data(name, knit.yarns)
        _store(data, knit)
        self.add_material(data, name)
        obj = bpy.data.objects.new(name, data)
        collection.objects.link(obj)
        obj.parent = mesh_object
        obj.matrix_parent_inverse = mesh_object.matrix_world.inverted_safe()
        obj.matrix_world = placed
        follow(obj, mesh_object, len(positions))
        if self.hide_mesh and mesh_object.library is not None:
            self.report(
                {"WARNING"}, f"'{mesh_object.name}' is linked and cannot be hidden here: make a library override of it"
            )
        elif self.hide_mesh:
            mesh_object.hide_render, mesh_object.display_type = True, "WIRE"
            mesh_object.lisle.mesh_kind = "INVISIBLE"
        unequal = [modifier.name for modifier in mesh_object.modifiers if _differs_in_pictures(modifier)]
        if unequal:
            self.report(
                {"WARNING"}, f"Give '{unequal[0]}' the same levels in the viewport and in pictures: the yarn needs them"
            )
        self.report({"INFO"}, f"Knitted {len(knit.yarns):,} yarns of {len(knit.heights):,} points")
        return obj


def _differs_in_pictures(modifier):
    """Whether a modifier makes another mesh in a picture than in the viewport."""
    levels = getattr(modifier, "levels", None) == getattr(modifier, "render_levels", None)
    return not levels or modifier.show_viewport != modifier.show_render


def _read(evaluated, space_from_object):
    """Vertices (v, 3), normals (v, 3), triangles (t, 3) and the UVs of their corners (t, 3, 2), all in a space."""
    mesh = evaluated.data
    if mesh.uv_layers.active is None:
        raise GeometryError(evaluated.name, "it has no UV map: unwrap it first, with courses along u")
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    triangles, corners = np.empty(3 * count, np.int32), np.empty(3 * count, np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    mesh.loop_triangles.foreach_get("loops", corners)
    uvs = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers.active.uv.foreach_get("vector", uvs)
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", positions)
    normals = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertex_normals.foreach_get("vector", normals)
    linear = np.array(space_from_object, np.float64)[:3, :3]
    positions = positions.reshape(-1, 3) @ linear.T + np.array(space_from_object.translation)
    normals = normals.reshape(-1, 3) @ np.linalg.pinv(linear)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return positions, normals, triangles.reshape(-1, 3), uvs.reshape(-1, 2)[corners].reshape(-1, 3, 2)


def _store(data, knit):
    for name, vertices in zip(VERTICES, knit.vertices.T, strict=True):
        data.attributes.new(name, "INT", "POINT").data.foreach_set("value", vertices.astype(np.int32))
    data.attributes.new(WEIGHTS, "FLOAT_VECTOR", "POINT").data.foreach_set("vector", knit.weights.ravel())
    data.attributes.new(HEIGHT, "FLOAT", "POINT").data.foreach_set("value", knit.heights)
    data.attributes.new(LENGTH, "FLOAT", "POINT").data.foreach_set("value", knit.yarns.length_coordinates)
