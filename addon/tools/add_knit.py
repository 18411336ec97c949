# SPDX-License-Identifier: GPL-3.0-or-later
"""Add › Curve › Knit Swatch, Knit Tube."""

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.object_utils import AddObjectHelper, object_data_add

from .. import native
from ..core.errors import LisleError
from .yarn_objects import NewMaterial, yarn_data

_PATTERNS = (
    ("stockinette", "Stockinette", "Knit stitches on the front, purl on the back"),
    ("garter", "Garter", "Rows of knit and purl in turn"),
    ("rib-1-1", "Rib 1×1", "One knit and one purl column in turn"),
    ("rib-2-2", "Rib 2×2", "Two knit and two purl columns in turn"),
    ("CHART", "Chart", "A chart of your own"),
)


class _AddKnit(NewMaterial, AddObjectHelper):
    bl_options = {"REGISTER", "UNDO"}

    pattern: EnumProperty(name="Pattern", description="How stitches follow each other", items=_PATTERNS)
    chart: StringProperty(
        name="Chart",
        description="Letters k (knit) and p (purl), rows from the top separated by spaces; it repeats over the piece",
        default="kp pk",
    )
    courses: IntProperty(name="Courses", description="Rows of stitches", min=1, soft_max=200, max=5000, default=24)
    wales: IntProperty(name="Wales", description="Columns of stitches", min=1, soft_max=200, max=5000, default=24)
    yarn_radius: FloatProperty(
        name="Yarn Radius",
        description="Radius of the yarn; the stitches grow with it",
        min=1e-5,
        soft_max=0.1,
        default=0.001,
        precision=4,
        step=0.01,
        subtype="DISTANCE",
        unit="LENGTH",
    )

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "pattern")
        if self.pattern == "CHART":
            layout.prop(self, "chart")
        column = layout.column(align=True)
        column.prop(self, "courses")
        column.prop(self, "wales")
        layout.prop(self, "yarn_radius")
        column = layout.column()
        column.prop(self, "yarn")
        column.prop(self, "fiber")
        column = layout.column()
        column.prop(self, "align")
        column.prop(self, "location")
        column.prop(self, "rotation")

    def execute(self, context):
        try:
            lisle = native.module()
        except LisleError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        pattern = self.chart if self.pattern == "CHART" else self.pattern
        try:
            yarns = self.make(lisle)(pattern, self.courses, self.wales, self.yarn_radius)
        except lisle.Error as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        data = yarn_data(self.NAME, yarns)
        self.add_material(data, self.NAME)
        object_data_add(context, data, operator=self)
        return {"FINISHED"}


class LISLE_OT_add_knit_swatch(_AddKnit, bpy.types.Operator):
    """Add a flat knitted piece, upright, its front towards −Y; every course is a yarn"""

    bl_idname = "lisle.add_knit_swatch"
    bl_label = "Knit Swatch"
    NAME = "Knit Swatch"

    @staticmethod
    def make(lisle):
        return lisle.knit_swatch


class LISLE_OT_add_knit_tube(_AddKnit, bpy.types.Operator):
    """Add a knitted tube about the Z axis; every course is a closed yarn"""

    bl_idname = "lisle.add_knit_tube"
    bl_label = "Knit Tube"
    NAME = "Knit Tube"

    @staticmethod
    def make(lisle):
        return lisle.knit_tube
