# SPDX-License-Identifier: GPL-3.0-or-later
"""Library overrides of settings, kept.

Since 5.0 Blender compares an override's settings with those of the linked data only where these are stored. Elsewhere
it notes that all of them differ, and cannot apply that. So the linked data gets its defaults stored, in memory.
"""

import bpy
from bpy.app.handlers import persistent


def keep(owner):
    """Has overrides of `owner.lisle` last, if `owner` is a library override."""
    if owner.override_library is not None and owner.override_library.reference is not None:
        _store(owner.override_library.reference.lisle)


def _store(group):
    """Stores a setting of a group, and of those in it, as it is."""
    plain = None
    for prop in group.bl_rna.properties:
        if prop.type == "POINTER" and prop.identifier != "rna_type":
            _store(getattr(group, prop.identifier))
        elif plain is None and prop.type in {"INT", "FLOAT"} and not prop.is_array:
            plain = prop.identifier
    if plain is not None and not group.is_property_set(plain):
        setattr(group, plain, getattr(group, plain))


@persistent
def _keep_all(*_):
    for owner in (*bpy.data.objects, *bpy.data.materials):
        keep(owner)


_HANDLERS = ("load_post", "save_pre")


def register():
    for name in _HANDLERS:
        getattr(bpy.app.handlers, name).append(_keep_all)


def unregister():
    for name in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(_keep_all)
