# SPDX-License-Identifier: GPL-3.0-or-later
"""World properties."""

import bpy

from ..export.world import plan_of
from .panel import LislePanel, wrapped_label


class LISLE_WORLD_PT_notes(LislePanel, bpy.types.Panel):
    """Only there if something in the world is left out."""

    bl_label = "Not Drawn by Lisle"
    bl_context = "world"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and bool(_notes(context.world))

    def draw(self, context):
        for note in _notes(context.world):
            wrapped_label(self.layout, note, icon="INFO")


def _notes(world):
    notes = []
    plan_of(world, notes.append)
    return notes


PANELS = (LISLE_WORLD_PT_notes,)
