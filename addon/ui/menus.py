# SPDX-License-Identifier: GPL-3.0-or-later
"""Where Lisle's operators stand in Blender's menus."""

import bpy


def _add(self, _context):
    self.layout.separator()
    self.layout.operator("lisle.add_knit_swatch", icon="OUTLINER_OB_CURVES")
    self.layout.operator("lisle.add_knit_tube", icon="OUTLINER_OB_CURVES")
    self.layout.operator("lisle.add_woven_swatch", icon="OUTLINER_OB_CURVES")


def _import(self, _context):
    self.layout.operator("lisle.import_bcc", text="Yarn Curves (.bcc)")


def _object(self, _context):
    self.layout.separator()
    self.layout.operator("lisle.knit_from_mesh")
    self.layout.operator("lisle.store_length_coordinate")
    self.layout.operator("lisle.fibers_to_curves")


_ENTRIES = (("VIEW3D_MT_curve_add", _add), ("TOPBAR_MT_file_import", _import), ("VIEW3D_MT_object", _object))


def register():
    for menu, draw in _ENTRIES:
        getattr(bpy.types, menu).append(draw)


def unregister():
    for menu, draw in _ENTRIES:
        getattr(bpy.types, menu).remove(draw)
