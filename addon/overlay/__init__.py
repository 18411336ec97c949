# SPDX-License-Identifier: GPL-3.0-or-later
"""Yarn with its fibers over the picture of any engine, in any shading mode. Imports `engine`."""

import bpy

from . import handler
from .handler import problem
from .operator import LISLE_OT_toggle_overlay

__all__ = ("problem", "register", "unregister")


def register():
    bpy.utils.register_class(LISLE_OT_toggle_overlay)
    handler.register()


def unregister():
    handler.unregister()
    bpy.utils.unregister_class(LISLE_OT_toggle_overlay)
