# SPDX-License-Identifier: GPL-3.0-or-later
"""The switch in the Overlays popover."""

import bpy


def _draw(self, context):
    column = self.layout.column()
    column.active = context.space_data.overlay.show_overlays
    column.prop(context.scene.lisle, "show_overlay")


def register():
    bpy.types.VIEW3D_PT_overlay.append(_draw)


def unregister():
    bpy.types.VIEW3D_PT_overlay.remove(_draw)
