# SPDX-License-Identifier: GPL-3.0-or-later
"""Lisle: yarn curves drawn as cloth made of plies and fibers.

Imports point one way: overlay and tools → engine → export → core, and ui on top. `core` holds what can be tested
without Blender.
"""

import bpy

from . import engine, native, overlay, overrides, properties, tools, ui

SUPPORTED = (4, 5, 0), (5, 3, 0)
"""First Blender version it is made for, and the first that it has not been tried with."""

_MODULES = (properties, overrides, engine, overlay, tools, ui)


def register():
    if bpy.app.version < SUPPORTED[0]:
        raise RuntimeError(f"Lisle needs Blender {'.'.join(map(str, SUPPORTED[0][:2]))} or later")
    if bpy.app.version >= SUPPORTED[1]:
        print(f"Lisle: not tested with Blender {bpy.app.version_string}")
    for module in _MODULES:
        module.register()
    problem = native.problem()
    if problem is not None:
        print(f"Lisle: {problem}")


def unregister():
    for module in reversed(_MODULES):
        module.unregister()
