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
        column.prop(view_layer, "use_pass_normal")
        column.prop(view_layer.lisle, "use_pass_tangent")
        column.prop(view_layer.lisle, "use_pass_alpha")
        column = layout.column(heading="Indices")
        column.prop(view_layer, "use_pass_object_index")


PANELS = (LISLE_VIEWLAYER_PT_passes,)
