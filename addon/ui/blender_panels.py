# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own panels that also apply to Lisle: camera, output, light, world, material slots."""

import bpy

_GENERIC = "BLENDER_RENDER"
"""Blender puts this engine on panels that suit any renderer."""

_NOT_FOR_US = {
    "DATA_PT_light",  # only the light's type, which the fuller panel below has too
    "DATA_PT_preview",
    "RENDER_PT_stereoscopy",
    "NODE_DATA_PT_light",
}
_NOT_FOR_US_PREFIXES = ("VIEWLAYER_PT_freestyle", "RENDER_PT_freestyle", "MATERIAL_PT_freestyle")

_OF_OTHER_ENGINES = {
    "DATA_PT_EEVEE_light",  # colour, power, radius: the units are the same
    "EEVEE_MATERIAL_PT_context_material",  # the list of material slots
    "EEVEE_WORLD_PT_surface",
}


def _applies(panel):
    name = panel.__name__
    if name in _NOT_FOR_US or name.startswith(_NOT_FOR_US_PREFIXES):
        return False
    return name in _OF_OTHER_ENGINES or _GENERIC in panel.COMPAT_ENGINES


def _panels():
    pending = list(bpy.types.Panel.__subclasses__())
    while pending:
        panel = pending.pop()
        pending += panel.__subclasses__()
        # Panels of add-ons may share or freeze theirs.
        if isinstance(getattr(panel, "COMPAT_ENGINES", None), set):
            yield panel


def register():
    for panel in _panels():
        if _applies(panel):
            panel.COMPAT_ENGINES.add("LISLE")


def unregister():
    for panel in _panels():
        panel.COMPAT_ENGINES.discard("LISLE")
