# SPDX-License-Identifier: GPL-3.0-or-later
"""View layer properties."""

import bpy

from .panel import LislePanel


class LISLE_VIEWLAYER_PT_passes(LislePanel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context):
        layout, view_layer = self.split_layout(), context.view_layer
        column = layout.column(heading="Data")
        column.prop(view_layer, "use_pass_z")
        column.prop(view_layer, "use_pass_position")
        column.prop(view_layer, "use_pass_normal")
        column.prop(view_layer.lisle, "use_pass_tangent")
        vector = column.column()
        vector.active = not context.scene.render.use_motion_blur
        vector.prop(view_layer, "use_pass_vector")
        column.prop(view_layer, "use_pass_uv")
        column.prop(view_layer.lisle, "use_pass_coverage")
        column.prop(view_layer.lisle, "use_pass_denoising")
        column = layout.column(heading="Indices")
        column.prop(view_layer, "use_pass_object_index")
        column.prop(view_layer, "use_pass_material_index")


class LISLE_VIEWLAYER_PT_light(LislePanel, bpy.types.Panel):
    bl_label = "Light"
    bl_context = "view_layer"
    bl_parent_id = "LISLE_VIEWLAYER_PT_passes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, settings = self.split_layout(), context.view_layer.lisle
        column = layout.column(heading="Lamps")
        for name in ("diffuse", "specular", "transmission", "scattered", "shadow"):
            column.prop(settings, f"use_pass_{name}")
        layout.column(heading="World").prop(settings, "use_pass_ambient")


class LISLE_VIEWLAYER_PT_cryptomatte(LislePanel, bpy.types.Panel):
    bl_label = "Cryptomatte"
    bl_context = "view_layer"
    bl_parent_id = "LISLE_VIEWLAYER_PT_passes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, view_layer = self.split_layout(), context.view_layer
        column = layout.column(heading="Include")
        column.prop(view_layer, "use_pass_cryptomatte_object", text="Object")
        column.prop(view_layer, "use_pass_cryptomatte_material", text="Material")
        layout.prop(view_layer, "pass_cryptomatte_depth", text="Levels")
        if view_layer.pass_cryptomatte_depth > 6:
            layout.label(text="Six levels at most", icon="INFO")


PANELS = (LISLE_VIEWLAYER_PT_passes, LISLE_VIEWLAYER_PT_light, LISLE_VIEWLAYER_PT_cryptomatte)
