# SPDX-License-Identifier: GPL-3.0-or-later
"""Object properties."""

import bpy

from ..export.guides import Guides
from ..export.legacy import left_out
from ..export.meshes import TYPES as MESH_TYPES
from ..export.meshes import plan_of
from .panel import LislePanel, YarnPanel, wrapped_label


class LISLE_OBJECT_PT_yarn(YarnPanel, bpy.types.Panel):
    bl_label = "Yarn"
    bl_context = "object"

    @classmethod
    def poll(cls, context):
        obj = context.object
        return super().poll(context) and obj is not None and obj.type in {"CURVE", "CURVES", "MESH", "POINTCLOUD"}

    def draw(self, context):
        layout, obj = self.split_layout(), context.object
        settings = obj.lisle
        layout.prop(settings, "is_yarn")
        use = Guides().use_of(obj)
        if use is not None and settings.is_yarn == "AUTO":
            wrapped_label(layout, f"No yarn: {use}", icon="INFO")
        layout = layout.column()
        layout.active = settings.is_yarn == "ALWAYS" or (settings.is_yarn == "AUTO" and use is None)
        sentence = left_out(obj)
        if sentence is not None:
            wrapped_label(layout, sentence[0].upper() + sentence[1:], icon="INFO")
        layout.prop(settings, "yarn_radius")
        layout.prop(settings, "remeasure")
        row = layout.row(heading="Reference Frame")
        row.active = not settings.remeasure
        row.prop(settings, "use_reference_frame", text="")
        sub = row.row()
        sub.active = settings.use_reference_frame
        sub.prop(settings, "reference_frame", text="")


class LISLE_OBJECT_PT_mesh(LislePanel, bpy.types.Panel):
    bl_label = "Mesh"
    bl_context = "object"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.object is not None and context.object.type in MESH_TYPES

    def draw(self, context):
        layout, obj = self.split_layout(), context.object
        layout.prop(obj.lisle, "mesh_kind", text="Seen As")
        notes = []
        for slot in obj.material_slots:
            plan_of(slot.material, notes.append)
        for note in dict.fromkeys(notes):
            wrapped_label(layout, note[0].upper() + note[1:], icon="INFO")


PANELS = (LISLE_OBJECT_PT_yarn, LISLE_OBJECT_PT_mesh)
