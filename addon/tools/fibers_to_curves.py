# SPDX-License-Identifier: GPL-3.0-or-later
"""Object › Fibers to Curves: what Lisle draws, as curves that any engine renders."""

import bpy
import numpy as np
from bpy.props import BoolProperty, FloatProperty, IntProperty
from mathutils import Matrix

from .. import native
from ..core.errors import LisleError, SceneError
from ..engine.assembly import by_material
from ..engine.rest import RestShapes
from ..export.camera import native_camera
from ..export.scene import collect
from .yarn_objects import curves_data, in_object_mode


class LISLE_OT_fibers_to_curves(bpy.types.Operator):
    """Make curves of the selected yarns' fibers, all or as many as the camera tells apart; Cycles draws them as hair"""

    bl_idname = "lisle.fibers_to_curves"
    bl_label = "Fibers to Curves"
    bl_options = {"REGISTER", "UNDO"}

    for_camera: BoolProperty(
        name="Only What the Camera Tells Apart",
        description="Fewer and wider fibers where the scene's camera is too far to see them one by one",
        default=True,
    )
    detail: FloatProperty(
        name="Level of Detail",
        description="Fibers thinner than this many pixels of the camera are merged",
        min=0.01,
        max=100,
        default=1,
        subtype="PIXEL",
    )
    most_points: IntProperty(
        name="Most Points",
        description="Refuse to make more points than these, in millions",
        min=1,
        soft_max=500,
        default=50,
    )

    @classmethod
    def poll(cls, context):
        if not context.selected_objects:
            cls.poll_message_set("Select yarn: Curves objects, or what geometry nodes make curves of")
            return False
        return in_object_mode(cls, context)

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "for_camera")
        row = layout.row()
        row.active = self.for_camera
        row.prop(self, "detail")
        layout.prop(self, "most_points")

    def execute(self, context):
        try:
            lisle = native.module()
            try:
                made = self._make(lisle, context)
            except lisle.Error as error:
                raise LisleError(str(error)) from error
        except LisleError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for obj in context.selected_objects:
            obj.select_set(False)
        for obj in made:
            obj.select_set(True)
        return {"FINISHED"}

    def _make(self, lisle, context):
        scene = context.scene
        depsgraph = context.evaluated_depsgraph_get()
        names = {obj.name_full for obj in context.selected_objects}
        content = collect(lisle, depsgraph, lambda _: None, only=names)
        if not content.placements:
            raise SceneError("None of the selected objects has curves")
        camera = None
        if self.for_camera and scene.camera is not None:
            scale = scene.render.resolution_percentage / 100
            size = (round(scene.render.resolution_x * scale), round(scene.render.resolution_y * scale))
            camera = native_camera(lisle, scene.camera, depsgraph, size)
        rest_shapes = RestShapes()
        at_rest = rest_shapes.find(lisle, _Clock(scene), depsgraph, content)
        prepared, points = [], 0
        for placement in content.placements:
            geometry = content.geometries[placement.key]
            for yarns, (yarn, fiber), _ in by_material(
                lisle, geometry, at_rest[geometry.key], rest_shapes, lambda text: self.report({"INFO"}, text)
            ):
                found = lisle.fibers(
                    yarns,
                    yarn,
                    object_id=placement.identity,
                    camera=None if camera is None else _seen_from(lisle, camera, placement.world_from_object),
                    lod_pixels=self.detail,
                )
                points += len(found.points)
                if points > 1_000_000 * self.most_points:
                    raise SceneError(f"More than {self.most_points} million points: raise Most Points, or use a camera")
                prepared.append((placement, found, fiber))
        collection = bpy.data.collections.new("Fibers")
        scene.collection.children.link(collection)
        return [_add(collection, *each) for each in prepared]


class _Clock:
    """Lets rest shapes be looked up at other frames, as a render engine does."""

    def __init__(self, scene):
        self._scene = scene

    def frame_set(self, frame, subframe):
        self._scene.frame_set(frame, subframe=subframe)


def _seen_from(lisle, camera, world_from_object):
    """The camera in an object's space, where its fibers are made."""
    world_from_camera = np.linalg.solve(world_from_object, camera.world_from_camera)
    return lisle.Camera.from_matrices(world_from_camera, camera.clip_from_camera, camera.size)


def _add(collection, placement, fibers, fiber):
    name = f"{placement.name} Fibers"
    data = curves_data(name, fibers.points, fibers.offsets, fibers.radii, "POLY")
    obj = bpy.data.objects.new(name, data)
    obj.matrix_world = Matrix(placement.world_from_object)
    collection.objects.link(obj)
    data.materials.append(_hair_material(name, fiber))
    return obj


def _hair_material(name, fiber):
    """A hair shader of the fiber's colour."""
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    hair = nodes.new("ShaderNodeBsdfHairPrincipled")
    hair.parametrization = "COLOR"
    hair.inputs["Color"].default_value = (*fiber.color_tt, 1)
    links.new(hair.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material
