# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that make and change yarn. Imports `engine`, `export` and `core`."""

import bpy

from .add_knit import LISLE_OT_add_knit_swatch, LISLE_OT_add_knit_tube
from .add_woven import LISLE_OT_add_woven_swatch
from .fibers_to_curves import LISLE_OT_fibers_to_curves
from .import_bcc import LISLE_FH_bcc, LISLE_OT_import_bcc
from .knit_from_mesh import LISLE_OT_knit_from_mesh
from .store_length import LISLE_OT_store_length

_CLASSES = (
    LISLE_OT_add_knit_swatch,
    LISLE_OT_add_knit_tube,
    LISLE_OT_add_woven_swatch,
    LISLE_OT_knit_from_mesh,
    LISLE_OT_import_bcc,
    LISLE_FH_bcc,
    LISLE_OT_store_length,
    LISLE_OT_fibers_to_curves,
)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
