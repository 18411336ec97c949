# SPDX-License-Identifier: GPL-3.0-or-later
"""The overlay's switch as an operator."""

import bpy


class LISLE_OT_toggle_overlay(bpy.types.Operator):
    """Show or hide yarn with its fibers in the viewports of this scene"""

    bl_idname = "lisle.toggle_overlay"
    bl_label = "Toggle Yarn Fibers"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        settings = context.scene.lisle
        settings.show_overlay = not settings.show_overlay
        return {"FINISHED"}
