# SPDX-License-Identifier: GPL-3.0-or-later
"""Add › Curve › Knit Swatch, Knit Tube."""

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty

from .add_cloth import AddCloth

PATTERNS = (
    ("stockinette", "Stockinette", "Knit stitches on the front, purl on the back"),
    ("garter", "Garter", "Rows of knit and purl in turn"),
    ("rib-1-1", "Rib 1×1", "One knit and one purl column in turn"),
    ("rib-2-2", "Rib 2×2", "Two knit and two purl columns in turn"),
    ("CHART", "Chart", "A chart of your own"),
)


class KnitPattern:
    """For operators that knit: which stitches follow each other."""

    pattern: EnumProperty(name="Pattern", description="How stitches follow each other", items=PATTERNS)
    chart: StringProperty(
        name="Chart",
        description="Letters k (knit) and p (purl), rows from the top separated by spaces; it repeats over the piece",
        default="kp pk",
    )

    def stitches(self):
        """As the native module names them."""
        return self.chart if self.pattern == "CHART" else self.pattern

    def draw_stitches(self, layout):
        layout.prop(self, "pattern")
        if self.pattern == "CHART":
            layout.prop(self, "chart")


class _AddKnit(KnitPattern, AddCloth):
    courses: IntProperty(name="Courses", description="Rows of stitches", min=1, soft_max=200, max=5000, default=24)
    wales: IntProperty(name="Wales", description="Columns of stitches", min=1, soft_max=200, max=5000, default=24)

    def draw_pattern(self, layout):
        self.draw_stitches(layout)
        column = layout.column(align=True)
        column.prop(self, "courses")
        column.prop(self, "wales")

    def make(self, lisle):
        return self.maker(lisle)(self.stitches(), self.courses, self.wales, self.yarn_radius)


class LISLE_OT_add_knit_swatch(_AddKnit, bpy.types.Operator):
    """Add a flat knitted piece, upright, its front towards −Y; every course is a yarn"""

    bl_idname = "lisle.add_knit_swatch"
    bl_label = "Knit Swatch"
    NAME = "Knit Swatch"

    @staticmethod
    def maker(lisle):
        return lisle.knit_swatch


class LISLE_OT_add_knit_tube(_AddKnit, bpy.types.Operator):
    """Add a knitted tube about the Z axis; every course is a closed yarn"""

    bl_idname = "lisle.add_knit_tube"
    bl_label = "Knit Tube"
    NAME = "Knit Tube"

    @staticmethod
    def maker(lisle):
        return lisle.knit_tube
