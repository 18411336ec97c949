# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels. They read settings and draw them; nothing here computes."""

import bpy

from . import blender_panels, menus, overlay
from .material import PANELS as MATERIAL_PANELS
from .object import PANELS as OBJECT_PANELS
from .presets import CLASSES as PRESET_CLASSES
from .render import PANELS as RENDER_PANELS
from .view_layer import PANELS as VIEW_LAYER_PANELS
from .world import PANELS as WORLD_PANELS

_PANELS = (*RENDER_PANELS, *VIEW_LAYER_PANELS, *OBJECT_PANELS, *MATERIAL_PANELS, *WORLD_PANELS)


def register():
    for cls in (*PRESET_CLASSES, *_PANELS):
        bpy.utils.register_class(cls)
    blender_panels.register()
    overlay.register()
    menus.register()


def unregister():
    menus.unregister()
    overlay.unregister()
    blender_panels.unregister()
    for cls in reversed((*PRESET_CLASSES, *_PANELS)):
        bpy.utils.unregister_class(cls)
