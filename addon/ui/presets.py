# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of one's own for yarns and fibers, as Blender keeps them: files in the user's folder."""

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from ..properties import LisleFiber, LisleYarn

_MATERIAL = "(getattr(bpy.context, 'material', None) or bpy.context.object.active_material)"


class _Add(AddPresetBase):
    bl_options = {"REGISTER", "INTERNAL"}

    @classmethod
    def poll(cls, context):
        return (getattr(context, "material", None) or getattr(context.object, "active_material", None)) is not None


class LISLE_PT_yarn_presets(PresetPanel, bpy.types.Panel):
    bl_label = "Yarn Presets"
    preset_subdir = "lisle/yarn"
    preset_operator = "script.execute_preset"
    preset_add_operator = "lisle.yarn_preset_add"


class LISLE_OT_yarn_preset_add(_Add, bpy.types.Operator):
    """Add or remove a preset with all numbers of this yarn"""

    bl_idname = "lisle.yarn_preset_add"
    bl_label = "Add Yarn Preset"
    preset_menu = "LISLE_PT_yarn_presets"
    preset_subdir = "lisle/yarn"
    preset_defines = (f"yarn = {_MATERIAL}.lisle.yarn",)
    # The order counts: customizing copies the preset's numbers first.
    preset_values = ("yarn.preset", "yarn.customize", *(f"yarn.{field}" for field in LisleYarn.FIELDS))


class LISLE_PT_fiber_presets(PresetPanel, bpy.types.Panel):
    bl_label = "Fiber Presets"
    preset_subdir = "lisle/fiber"
    preset_operator = "script.execute_preset"
    preset_add_operator = "lisle.fiber_preset_add"


class LISLE_OT_fiber_preset_add(_Add, bpy.types.Operator):
    """Add or remove a preset with all numbers of this fiber"""

    bl_idname = "lisle.fiber_preset_add"
    bl_label = "Add Fiber Preset"
    preset_menu = "LISLE_PT_fiber_presets"
    preset_subdir = "lisle/fiber"
    preset_defines = (f"fiber = {_MATERIAL}.lisle.fiber",)
    preset_values = ("fiber.preset", "fiber.customize", *(f"fiber.{field}" for field in LisleFiber.FIELDS))


CLASSES = (LISLE_PT_yarn_presets, LISLE_OT_yarn_preset_add, LISLE_PT_fiber_presets, LISLE_OT_fiber_preset_add)
