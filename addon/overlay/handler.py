# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the overlay at the end of every viewport's redraw, and notices what makes it stale."""

import traceback

import bpy
from bpy.app.handlers import persistent

from ..engine.viewport import Viewport
from ..export.view import view_of
from . import display
from .lighting import lighting_of


class _Shown:
    """The overlay of one region."""

    def __init__(self, region):
        self.viewport = Viewport(lambda: _redraw(region))
        self.version = None


_shown = {}
"""By the region's address."""

_layout = None
"""Of the screen that was drawn last: its address and number of regions."""

_said = None
"""The problem that was printed last."""

_version = 0
"""Counts what may have changed the scene."""


def _draw():
    context = bpy.context
    scene, space, address = context.scene, context.space_data, context.region.as_pointer()
    if not _is_on(scene, space):
        _close(address)
        return
    _forget_closed(context.screen, address)
    try:
        shown = _shown.get(address)
        if shown is None:
            shown = _shown[address] = _Shown(address)
        version = (_version, scene.name_full, context.view_layer.name, space.local_view is not None)
        if shown.version != version:
            shown.version = version
            shown.viewport.update(space, context.evaluated_depsgraph_get())
            _say(shown.viewport.problem)
        view = view_of(context, scene)
        shown.viewport.draw_over(view, lighting_of(space, view), display.transform_of(scene, space))
    except Exception:  # Blender would go on calling it
        traceback.print_exc()


def _is_on(scene, space):
    if not (scene.lisle.show_overlay and space.overlay.show_overlays):
        return False
    return not (space.shading.type == "RENDERED" and scene.render.engine == "LISLE")


def _regions():
    """All that there are, by their addresses."""
    windows = bpy.context.window_manager.windows
    return {r.as_pointer(): r for window in windows for area in window.screen.areas for r in area.regions}


def _redraw(address):
    """Has a region redrawn; whether it is still there."""
    region = _regions().get(address)
    if region is None:
        return _close(address)
    region.tag_redraw()
    return True


def _forget_closed(screen, address):
    """Drops the pictures of regions that are no more, when `address` is a new one or a screen has changed: nobody says
    when one is removed."""
    global _layout
    layout = screen.as_pointer(), sum(len(area.regions) for area in screen.areas)
    if not _shown or (layout == _layout and address in _shown):
        return
    _layout = layout
    for closed in _shown.keys() - _regions().keys():
        _close(closed)


def _say(problem):
    """Prints what keeps the overlay from showing yarn, once."""
    global _said
    if problem != _said:
        _said = problem
        if problem is not None:
            print(f"Lisle: {problem}", flush=True)


def problem():
    """What keeps a viewport's overlay from showing yarn; None if nothing does."""
    return next((shown.viewport.problem for shown in _shown.values() if shown.viewport.problem), None)


def _close(address):
    shown = _shown.pop(address, None)
    if shown is not None:
        shown.viewport.close()
    return False


def _close_all():
    for address in list(_shown):
        _close(address)


@persistent
def _changed(*_):
    global _version
    _version += 1


@persistent
def _loaded(*_):
    _close_all()
    _changed()


_HANDLERS = (
    ("depsgraph_update_post", _changed),
    ("frame_change_post", _changed),
    ("undo_post", _changed),
    ("redo_post", _changed),
    ("load_post", _loaded),
)

_handle = None


def register():
    global _handle
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)
    _handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")


def unregister():
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
    _close_all()
    display.forget()
