# SPDX-License-Identifier: GPL-3.0-or-later
"""Object › Store Length Coordinate: the yarn's length at a frame, kept as an attribute of its points."""

from dataclasses import replace

import bpy
import numpy as np
from bpy.props import BoolProperty, IntProperty

from .. import native
from ..core.errors import GeometryError, LisleError
from ..export.curves import read_curves

NAME = "length_coordinate"


class LISLE_OT_store_length(bpy.types.Operator):
    """Measure the selected yarns at a frame and keep the lengths, so that fibers stay where they are on the yarn"""

    bl_idname = "lisle.store_length_coordinate"
    bl_label = "Store Length Coordinate"
    bl_options = {"REGISTER", "UNDO"}

    use_current: BoolProperty(name="Current Frame", description="Measure at the frame on the clock", default=True)
    frame: IntProperty(name="Frame", description="Frame at which the yarn has its natural length", default=1)

    @classmethod
    def poll(cls, context):
        if not any(obj.type == "CURVES" for obj in context.selected_objects):
            cls.poll_message_set("Select Curves objects")
            return False
        return True

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "use_current")
        row = layout.row()
        row.active = not self.use_current
        row.prop(self, "frame")

    def execute(self, context):
        scene = context.scene
        frame, subframe = scene.frame_current, scene.frame_subframe
        stored = 0
        try:
            lisle = native.module()
            if not self.use_current:
                scene.frame_set(self.frame)
            depsgraph = context.evaluated_depsgraph_get()
            for obj in context.selected_objects:
                if obj.type == "CURVES":
                    _store(lisle, obj, depsgraph)
                    stored += 1
        except LisleError as error:
            self.report({"ERROR"}, str(error))
        finally:
            if not self.use_current:
                scene.frame_set(frame, subframe=subframe)
        return {"FINISHED"} if stored else {"CANCELLED"}


def _store(lisle, obj, depsgraph):
    if obj.data.library is not None or obj.data.override_library is not None:
        file = (obj.data.library or obj.data.override_library.reference.library).filepath
        raise GeometryError(obj.name, f"its curves are linked from '{file}': store their lengths there")
    geometry = obj.evaluated_get(depsgraph).evaluated_geometry()
    curves = None if geometry.curves is None else read_curves(geometry.curves, obj.name)
    data = obj.data
    if curves is None or len(curves.points) != len(data.points):
        found = 0 if curves is None else len(curves.points)
        raise GeometryError(
            obj.name,
            f"its modifiers make {found} points of {len(data.points)}: apply them first, "
            f"or store an attribute '{NAME}' in the geometry nodes",
        )
    try:
        # Lengths stored before must not measure themselves.
        fresh = replace(curves, length_coordinates=None)
        lengths = native.native_yarns(lisle, fresh, obj.name).length_coordinates
    except lisle.Error as error:
        raise GeometryError(obj.name, str(error)) from error
    attribute = data.attributes.get(NAME)
    if attribute is not None and (attribute.data_type, attribute.domain) != ("FLOAT", "POINT"):
        data.attributes.remove(attribute)
        attribute = None
    attribute = attribute or data.attributes.new(NAME, "FLOAT", "POINT")
    attribute.data.foreach_set("value", np.asarray(lengths, np.float32))
    data.update_tag()
