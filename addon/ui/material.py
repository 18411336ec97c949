# SPDX-License-Identifier: GPL-3.0-or-later
"""Material properties: the yarn, and how its fibers scatter light."""

import bpy

from .panel import YarnPanel
from .presets import LISLE_PT_fiber_presets, LISLE_PT_yarn_presets


class _MaterialPanel(YarnPanel):
    bl_context = "material"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.material is not None


def _draw_preset(layout, group):
    layout.template_icon_view(group, "preset", show_labels=True, scale=5, scale_popup=6)
    layout.prop(group, "preset")
    layout.prop(group, "customize")


class _NumbersPanel(_MaterialPanel):
    """Numbers that only matter once a preset is customized."""

    bl_options = {"DEFAULT_CLOSED"}
    GROUP = ""
    FIELDS = ()

    def draw(self, context):
        layout, group = self.split_layout(), getattr(context.material.lisle, self.GROUP)
        layout.active = group.customize
        column = layout.column()
        for field in self.FIELDS:
            column.prop(group, field)


class LISLE_MATERIAL_PT_yarn(_MaterialPanel, bpy.types.Panel):
    bl_label = "Yarn"

    def draw_header_preset(self, _context):
        LISLE_PT_yarn_presets.draw_panel_header(self.layout)

    def draw(self, context):
        _draw_preset(self.split_layout(), context.material.lisle.yarn)


class LISLE_MATERIAL_PT_yarn_plies(_NumbersPanel, bpy.types.Panel):
    bl_label = "Plies"
    bl_parent_id = "LISLE_MATERIAL_PT_yarn"
    GROUP = "yarn"
    FIELDS = ("plies", "ply_twist", "ply_radius", "ellipse_long", "ellipse_short")


class LISLE_MATERIAL_PT_yarn_fibers(_NumbersPanel, bpy.types.Panel):
    bl_label = "Fibers"
    bl_parent_id = "LISLE_MATERIAL_PT_yarn"
    GROUP = "yarn"
    FIELDS = (
        "fibers_per_ply", "fiber_radius", "fiber_twist", "density_beta", "density_epsilon", "r_min", "migration_rate",
    )  # fmt: skip


class LISLE_MATERIAL_PT_yarn_flyaways(_NumbersPanel, bpy.types.Panel):
    bl_label = "Flyaways"
    bl_parent_id = "LISLE_MATERIAL_PT_yarn"
    GROUP = "yarn"
    FIELDS = (
        "loop_density", "loop_r_max", "hair_density", "hair_r_min", "hair_r_span", "hair_z_span", "hair_theta_span",
    )  # fmt: skip


class LISLE_MATERIAL_PT_fiber(_MaterialPanel, bpy.types.Panel):
    bl_label = "Fiber Shading"

    def draw_header_preset(self, _context):
        LISLE_PT_fiber_presets.draw_panel_header(self.layout)

    def draw(self, context):
        _draw_preset(self.split_layout(), context.material.lisle.fiber)


class LISLE_MATERIAL_PT_fiber_physical(_NumbersPanel, bpy.types.Panel):
    bl_label = "Scattering"
    bl_parent_id = "LISLE_MATERIAL_PT_fiber"
    GROUP = "fiber"
    FIELDS = ("color_tt", "color_r", "beta_r", "beta_tt", "gamma_tt", "diffuse", "diffuse_weight")


class LISLE_MATERIAL_PT_fiber_simple(_NumbersPanel, bpy.types.Panel):
    bl_label = "Simple Shading"
    bl_parent_id = "LISLE_MATERIAL_PT_fiber"
    GROUP = "fiber"
    FIELDS = ("specular", "specular_beta")


PANELS = (
    LISLE_MATERIAL_PT_yarn,
    LISLE_MATERIAL_PT_yarn_plies,
    LISLE_MATERIAL_PT_yarn_fibers,
    LISLE_MATERIAL_PT_yarn_flyaways,
    LISLE_MATERIAL_PT_fiber,
    LISLE_MATERIAL_PT_fiber_physical,
    LISLE_MATERIAL_PT_fiber_simple,
)
