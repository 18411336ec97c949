# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine that Blender talks to.

Nothing may leave `render` but a written result: an exception, or no result, makes Blender crash when it saves the
frame. So whatever happens, a full-size result is delivered, and then an error report stops the job before Blender
saves it.
"""

import functools
import traceback
import weakref

import bpy

from ..core.errors import Cancelled, LisleError, message_of_bug
from ..export.view import view_of
from . import job
from .frame import draw
from .passes import register_passes, write_passes
from .viewport import Viewport


class LisleRenderEngine(bpy.types.RenderEngine):
    """Draws curves as yarn made of plies and fibers."""

    bl_idname = "LISLE"
    bl_label = "Lisle"
    bl_use_postprocess = True
    bl_use_eevee_viewport = True

    _viewport = None
    """Of the region that this instance draws; none in a final render."""

    def __del__(self):
        try:
            viewport = self._viewport
        except ReferenceError:  # Blender removed the engine of a final picture first
            return
        if viewport is not None:
            viewport.close()

    def update_render_passes(self, scene, view_layer):
        register_passes(self, scene, view_layer)

    def render(self, depsgraph):
        notes = []
        result, error = None, None
        try:
            # Blender cuts the rectangle to the border, exactly as it will use it.
            result = self.begin_result(0, 0, self.resolution_x, self.resolution_y, layer=depsgraph.view_layer.name)
            pictures, metadata = draw(self, depsgraph, (result.resolution_x, result.resolution_y), notes.append)
            write_passes(result, pictures)
            for name, text in metadata.items():  # to the whole picture: what belongs to one layer's is lost
                self.get_result().stamp_data_add_field(name, text)
        except BaseException as caught:
            error = caught
        if result is not None:
            self.end_result(result)
        for sentence in job.not_said_before(notes):
            self.report({"INFO"}, f"Lisle: {sentence}")
        message = _message(error)
        del error  # it knows this frame and what was drawn, which would wait for the garbage collector
        if message is not None:
            self.report({"ERROR"}, f"Lisle: {message}")

    def view_update(self, context, depsgraph):
        if self._viewport is None:
            self._viewport = Viewport(functools.partial(_redraw, weakref.ref(self)))
        try:
            self._viewport.update(context.space_data, depsgraph)
        except Exception:  # Blender would show the trace at every redraw
            traceback.print_exc()

    def view_draw(self, context, depsgraph):
        if self._viewport is None:
            return
        self.bind_display_space_shader(depsgraph.scene)
        try:
            self._say(self._viewport.draw(view_of(context, depsgraph.scene, depsgraph)))
        except Exception:
            traceback.print_exc()
        finally:
            self.unbind_display_space_shader()

    _said = None

    def _say(self, text):
        """Shows a line in the corner of the viewport."""
        if text != self._said:
            self._said = text
            self.update_stats("Lisle", text)
            self.tag_redraw()  # Blender has written the old one already


def _redraw(reference):
    """Has the engine of a weak reference draw again; whether it is still there."""
    engine = reference()
    if engine is None:
        return False
    try:
        engine.tag_redraw()
    except ReferenceError:
        return False
    return True


def _message(error):
    """What to tell the user about an exception; None if there is nothing to tell."""
    if error is None or isinstance(error, Cancelled):
        return None
    if isinstance(error, LisleError):
        return str(error)
    traceback.print_exception(error)
    return message_of_bug(error)
