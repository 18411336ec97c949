# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators share that add a piece of cloth."""

from bpy_extras.object_utils import AddObjectHelper, object_data_add

from .. import native
from ..core.errors import LisleError
from ..properties import yarn_radius
from .yarn_objects import NewMaterial, in_object_mode, yarn_data


class AddCloth(NewMaterial, AddObjectHelper):
    """A subclass has NAME, FIELDS to show, and `make`."""

    bl_options = {"REGISTER", "UNDO"}
    NAME = ""

    yarn_radius: yarn_radius("Radius of the yarn; the cloth grows with it", min=1e-5, default=0.001)

    @classmethod
    def poll(cls, context):
        return in_object_mode(cls, context)

    def make(self, lisle):
        """lisle.Yarns of the cloth."""
        raise NotImplementedError

    def draw_pattern(self, layout):
        """What the cloth is made like."""
        raise NotImplementedError

    def draw_materials(self, layout):
        column = layout.column()
        column.prop(self, "yarn")
        column.prop(self, "fiber")

    def finish(self, data):
        """Gives the new curves what goes with them."""
        self.add_material(data, self.NAME)

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        self.draw_pattern(layout)
        layout.prop(self, "yarn_radius")
        self.draw_materials(layout)
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
        try:
            yarns = self.make(lisle)
        except lisle.Error as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        data = yarn_data(self.NAME, yarns)
        self.finish(data)
        object_data_add(context, data, operator=self)
        return {"FINISHED"}
