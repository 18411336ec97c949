# SPDX-License-Identifier: GPL-3.0-or-later
"""Object › Fibers to Curves: what Lisle draws, as curves that any engine renders."""

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty
from mathutils import Matrix

from .. import native
from ..core.errors import Cancelled, LisleError, SceneError
from ..engine.assembly import by_material
from ..engine.rest import RestShapes
from ..export.camera import native_camera
from ..export.scene import collect
from .fiber_work import FiberWork
from .yarn_objects import curves_data, in_object_mode

_POLL_S = 0.05


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

    def invoke(self, context, _event):
        """As from a menu: the interface goes on while fibers are made, Escape stops that."""
        if bpy.app.background:
            return self.execute(context)
        try:
            self._work = self._prepare(context)
        except LisleError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(_POLL_S, window=context.window)
        manager.modal_handler_add(self)
        context.workspace.status_text_set("Making fibers. Esc: Cancel")
        self._work.start()
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self._work.stop()
            return {"RUNNING_MODAL"}
        context.window_manager.progress_update(round(100 * self._work.share))
        if self._work.is_alive():
            return {"PASS_THROUGH"}
        self._leave(context)
        return self._finish(context, self._work)

    def cancel(self, context):
        """Blender is about to quit, or to open another file."""
        self._work.stop()
        self._leave(context)

    def _leave(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def execute(self, context):
        try:
            work = self._prepare(context)
        except LisleError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        work.run()
        return self._finish(context, work)

    def _finish(self, context, work):
        try:
            made = work.result()
        except Cancelled:
            return {"CANCELLED"}
        except LisleError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        collection = bpy.data.collections.new("Fibers")
        context.scene.collection.children.link(collection)
        for obj in context.selected_objects:
            obj.select_set(False)
        for each in made:
            _add(collection, *each).select_set(True)
        return {"FINISHED"}

    def _prepare(self, context):
        """The FiberWork of the selected yarns."""
        lisle, scene = native.module(), context.scene
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
        try:
            pieces = [
                (placement, *piece[:2])
                for placement in content.placements
                for piece in by_material(
                    lisle,
                    content.geometries[placement.key],
                    at_rest[placement.key],
                    rest_shapes,
                    lambda text: self.report({"INFO"}, text),
                )
            ]
        except lisle.Error as error:
            raise LisleError(str(error)) from error
        return FiberWork(lisle, pieces, camera, self.detail, self.most_points)


class _Clock:
    """Lets rest shapes be looked up at other frames, as a render engine does."""

    def __init__(self, scene):
        self._scene = scene

    def frame_set(self, frame, subframe):
        self._scene.frame_set(frame, subframe=subframe)


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
