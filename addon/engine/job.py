# SPDX-License-Identifier: GPL-3.0-or-later
"""What lasts as long as a render job: one picture or a whole animation. Blender makes a new engine for every frame.

It is forgotten between jobs, because anything may have been edited there.
"""

import bpy
from bpy.app.handlers import persistent

from ..core.errors import Cancelled
from ..export.world import forget_images
from .rest import RestShapes
from .surfaces import Surfaces

REST_SHAPES = RestShapes()
SURFACES = Surfaces()

_said = set()


def not_said_before(sentences):
    """Those of the sentences that are new in this job."""
    new = [sentence for sentence in dict.fromkeys(sentences) if sentence not in _said]
    _said.update(new)
    return new


def stop_if_asked(engine):
    """Raises Cancelled if the user wants no more of the picture."""
    if engine.test_break():
        raise Cancelled


@persistent
def _forget(*_):
    REST_SHAPES.clear()
    SURFACES.clear()
    _said.clear()
    forget_images()


_HANDLERS = ("render_init", "render_complete", "render_cancel", "load_pre")


def register():
    for name in _HANDLERS:
        getattr(bpy.app.handlers, name).append(_forget)


def unregister():
    for name in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(_forget)
    _forget()
