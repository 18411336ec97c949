# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered shading: one region of a 3D viewport that shows the scene with Lisle."""

import itertools

from .. import native
from ..core.errors import LisleError
from ..core.painter import Task
from ..export.view import view_of
from . import painting
from .screen import Screen
from .snapshot import Snapshot

WAIT_S = 0.06
"""How long a redraw waits for the first picture of a new view; what comes later gets a redraw of its own."""

_numbers = itertools.count()


class Viewport:
    """What the engine keeps for the region it was made for."""

    def __init__(self, redraw):
        """`redraw` is a weak reference to a callable that says whether there is still something to redraw."""
        self.name = f"engine {next(_numbers)}"
        self._redraw = redraw
        self._screen = Screen()
        self._snapshot = None
        self._problem = None

    def update(self, context, depsgraph):
        """Reads the scene: something in it has changed."""
        space = context.space_data
        try:
            lisle = native.module()
            self._snapshot = Snapshot(lisle, depsgraph, lambda obj: obj.visible_in_viewport_get(space))
            self._problem = None
        except LisleError as error:
            self._snapshot, self._problem = None, str(error)

    def draw(self, context, depsgraph):
        """Draws the view of the context's region. Returns a line for the status."""
        if self._snapshot is None:
            return self._problem or ""
        snapshot, lisle = self._snapshot, native.module()
        view = view_of(context, depsgraph.scene)
        if view.is_empty:
            return ""
        camera = lisle.Camera.from_matrices(view.world_from_camera, view.clip_from_camera, view.size)
        key = (snapshot.number, view.key())
        painting.PAINTER.show(self.name, Task(key, view.size, view.region, snapshot.samples, snapshot.painter(camera)))
        painting.watch(self.name, self._on_news)
        try:
            picture = painting.PAINTER.picture(self.name, WAIT_S)
        except Exception as error:  # raised in the thread
            return f"{error}"
        if picture is None:
            if snapshot.background is not None:
                self._screen.fill(snapshot.background, view.region, view.size)
            self._screen.draw_lines(snapshot, view)
            return "Drawing"
        self._screen.draw(picture, view.size)
        return f"Sample {picture.samples}/{snapshot.samples}"

    def _on_news(self):
        redraw = self._redraw()
        return redraw is not None and redraw()

    def close(self):
        painting.close(self.name)
