# SPDX-License-Identifier: GPL-3.0-or-later
"""Add › Curve › Woven Swatch."""

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..presets import DEFAULT_FIBER, FIBER_ITEMS
from .add_cloth import AddCloth

_WEAVES = (
    ("plain", "Plain", "Over one, under one: linen, poplin"),
    ("twill-2-2", "Twill 2/2", "Over two, under two, shifted by one each row: tweed"),
    ("twill-3-1", "Twill 3/1", "Over three, under one: denim, with more of the warp in front"),
    ("satin-5", "Satin 5", "Over four, under one: long floats of the warp"),
    ("satin-8", "Satin 8", "Over seven, under one: the longest floats of the warp"),
    ("CHART", "Chart", "A chart of your own"),
)


class LISLE_OT_add_woven_swatch(AddCloth, bpy.types.Operator):
    """Add a flat woven piece, upright, its front towards −Y; warp and weft can have fibers of their own"""

    bl_idname = "lisle.add_woven_swatch"
    bl_label = "Woven Swatch"
    NAME = "Woven Swatch"

    weave: EnumProperty(name="Weave", description="Where the warp lies in front of the weft", items=_WEAVES)
    chart: StringProperty(
        name="Chart",
        description="Letters x (warp in front) and o (weft in front), rows from the top separated by spaces; "
        "it repeats over the piece",
        default="xxoo xoox ooxx oxxo",
    )
    warp: IntProperty(name="Warp", description="Yarns that run upwards", min=1, soft_max=400, max=20000, default=48)
    weft: IntProperty(name="Weft", description="Yarns that run across", min=1, soft_max=400, max=20000, default=48)
    spacing: FloatProperty(
        name="Spacing",
        description="From yarn to yarn; 1 is as tight as round yarns can be",
        min=1,
        soft_max=3,
        max=100,
        default=1.01,
        precision=3,
        step=1,
    )
    use_weft_fiber: BoolProperty(name="Other Weft", description="The weft has a material of its own")
    weft_fiber: EnumProperty(
        name="Weft Fiber",
        description="What the weft scatters light like",
        items=FIBER_ITEMS,
        default=DEFAULT_FIBER,
    )

    def draw_pattern(self, layout):
        layout.prop(self, "weave")
        if self.weave == "CHART":
            layout.prop(self, "chart")
        column = layout.column(align=True)
        column.prop(self, "warp")
        column.prop(self, "weft")
        layout.prop(self, "spacing")

    def draw_materials(self, layout):
        super().draw_materials(layout)
        row = layout.row(heading="Weft Fiber")
        row.prop(self, "use_weft_fiber", text="")
        sub = row.row()
        sub.active = self.use_weft_fiber
        sub.prop(self, "weft_fiber", text="")

    def make(self, lisle):
        weave = self.chart if self.weave == "CHART" else self.weave
        return lisle.woven_swatch(weave, self.warp, self.weft, self.yarn_radius, self.spacing)

    def finish(self, data):
        if not self.use_weft_fiber:
            super().finish(data)
            return
        self.add_material(data, f"{self.NAME} Warp")
        self.add_material(data, f"{self.NAME} Weft", self.weft_fiber)
        slots = np.repeat((0, 1), (self.warp, self.weft)).astype(np.int32)
        data.attributes.new("material_index", "INT", "CURVE").data.foreach_set("value", slots)
