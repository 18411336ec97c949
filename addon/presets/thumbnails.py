# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the presets, drawn by `cargo xtask thumbnails`: `thumbnails/KIND/NAME.webp`."""

from pathlib import Path

import bpy.utils.previews

FOLDER = Path(__file__).parent / "thumbnails"

_pictures = None
_shown = {}
"""Items by kind. Blender reads their strings from here: they must outlast the call."""


def items_of(kind, items):
    """A callback for EnumProperty: items as in `presets`, with their pictures for icons."""

    def shown(_group, _context):
        if kind not in _shown:
            _shown[kind] = [
                (name, label, text, _icon(kind, name), number) for name, label, text, number in items
            ]  # fmt: skip
        return _shown[kind]

    return shown


def _icon(kind, name):
    """Number of the icon; 0, which is none, where there is no picture."""
    path = FOLDER / kind / f"{name}.webp"
    if _pictures is None or not path.is_file():
        return 0
    key = f"{kind}/{name}"
    picture = _pictures.get(key) or _pictures.load(key, str(path), "IMAGE")
    return picture.icon_id


def register():
    global _pictures
    _pictures = bpy.utils.previews.new()


def unregister():
    global _pictures
    _shown.clear()
    bpy.utils.previews.remove(_pictures)
    _pictures = None
