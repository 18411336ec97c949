# SPDX-License-Identifier: GPL-3.0-or-later
"""What all of Lisle's panels share."""


class LislePanel:
    """A panel of the properties editor that shows with the Lisle engine."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = frozenset({"LISLE"})

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES

    def split_layout(self):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        return layout


class YarnPanel(LislePanel):
    """One that shows wherever yarn does: with the Lisle engine, or in the overlay over another one's picture."""

    @classmethod
    def poll(cls, context):
        return super().poll(context) or context.scene.lisle.show_overlay


def wrapped_label(layout, text, icon="NONE", width=60):
    """A text of several lines; Blender's labels have only one."""
    column = layout.column(align=True)
    line = ""
    for word in text.split():
        if line and len(line) + 1 + len(word) > width:
            column.label(text=line, icon=icon)
            line, icon = word, "BLANK1"
        else:
            line = f"{line} {word}".strip()
    if line:
        column.label(text=line, icon=icon)
