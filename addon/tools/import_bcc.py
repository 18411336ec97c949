# SPDX-License-Identifier: GPL-3.0-or-later
"""File › Import › Yarn Curves (.bcc), and files dropped into a viewport."""

from pathlib import Path

import bpy
from bpy.props import CollectionProperty, FloatProperty, StringProperty
from bpy_extras.io_utils import ImportHelper
from bpy_extras.object_utils import object_data_add

from .. import native
from ..core.errors import LisleError
from ..properties import yarn_radius
from .yarn_objects import NewMaterial, in_object_mode, yarn_data


class LISLE_OT_import_bcc(bpy.types.Operator, NewMaterial, ImportHelper):
    """Import yarn curves in the BCC format"""

    bl_idname = "lisle.import_bcc"
    bl_label = "Import BCC"
    bl_options = {"REGISTER", "UNDO", "PRESET"}

    filename_ext = ".bcc"
    filter_glob: StringProperty(default="*.bcc", options={"HIDDEN"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})

    scale: FloatProperty(
        name="Scale",
        description="Metres to a unit of the file. The files that go with the paper are in centimetres",
        min=1e-6,
        soft_max=1,
        default=0.01,
        precision=4,
    )
    yarn_radius: yarn_radius("Radius of the yarn; 0 estimates it from how close neighbouring strands come")

    @classmethod
    def poll(cls, context):
        return in_object_mode(cls, context)

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        for name in ("scale", "yarn_radius", "yarn", "fiber"):
            layout.prop(self, name)

    def invoke(self, context, event):
        return self.invoke_popup(context) if self.directory and self.files else super().invoke(context, event)

    def execute(self, context):
        try:
            lisle = native.module()
        except LisleError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        names = [entry.name for entry in self.files if entry.name]
        paths = [Path(self.directory) / name for name in names] if names else [Path(self.filepath)]
        radius = self.yarn_radius / self.scale if self.yarn_radius else None
        imported = 0
        for path in paths:
            try:
                data = yarn_data(path.stem, lisle.load(path, yarn_radius=radius), self.scale)
            except (lisle.Error, OSError, ValueError) as error:
                self.report({"ERROR"}, str(error))
                continue
            self.add_material(data, path.stem)
            object_data_add(context, data)
            imported += 1
        return {"FINISHED"} if imported else {"CANCELLED"}


class LISLE_FH_bcc(bpy.types.FileHandler):
    bl_idname = "LISLE_FH_bcc"
    bl_label = "Yarn Curves"
    bl_import_operator = "lisle.import_bcc"
    bl_file_extensions = ".bcc"

    @classmethod
    def poll_drop(cls, context):
        return context.area is not None and context.area.type in {"VIEW_3D", "OUTLINER"}
