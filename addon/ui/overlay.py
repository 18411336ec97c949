# SPDX-License-Identifier: GPL-3.0-or-later
"""The switch in the Overlays popover."""

import bpy

from .. import overlay
from .panel import wrapped_label


def _draw(self, context):
    column = self.layout.column()
    column.active = context.space_data.overlay.show_overlays
    settings = context.scene.lisle
    column.prop(settings, "show_overlay")
    problem = overlay.problem()
    if settings.show_overlay and problem is not None:
        wrapped_label(column, problem, icon="ERROR", width=40)


def register():
    bpy.types.VIEW3D_PT_overlay.append(_draw)


def unregister():
    bpy.types.VIEW3D_PT_overlay.remove(_draw)
