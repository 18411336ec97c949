# SPDX-License-Identifier: GPL-3.0-or-later
"""The one painter of this process, and how its news reach Blender: a timer in the main thread asks while it is busy."""

import bpy
from bpy.app.handlers import persistent

from ..core.painter import Painter
from .snapshot import REST_SHAPES, SURFACES

PAINTER = Painter()

_POLL_S = 0.02

_on_news = {}


def watch(name, on_news):
    """Calls `on_news()` in the main thread whenever view `name` has a better picture, as long as it returns True."""
    _on_news[name] = on_news
    if not bpy.app.timers.is_registered(_poll):
        bpy.app.timers.register(_poll, first_interval=_POLL_S, persistent=True)


def close(name):
    """Forgets a view."""
    _on_news.pop(name, None)
    PAINTER.close(name)


def _poll():
    busy = PAINTER.busy()
    for name in PAINTER.news():
        on_news = _on_news.get(name)
        if on_news is None or not on_news():
            close(name)
    return _POLL_S if busy else None


@persistent
def _pause(*_):
    PAINTER.pause()


@persistent
def _go_on(*_):
    PAINTER.pause(False)


@persistent
def _forget(*_):
    for name in list(_on_news):
        close(name)
    PAINTER.stop()
    REST_SHAPES.clear()
    SURFACES.clear()


# A final render has the graphics adapter for itself.
_HANDLERS = (
    ("render_init", _pause),
    ("render_complete", _go_on),
    ("render_cancel", _go_on),
    ("load_pre", _forget),
)


def register():
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    if bpy.app.timers.is_registered(_poll):
        bpy.app.timers.unregister(_poll)
    _forget()
