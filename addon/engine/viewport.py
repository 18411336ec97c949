# SPDX-License-Identifier: GPL-3.0-or-later
"""One region of a 3D viewport that shows yarn: as the engine's Rendered shading, or over another engine's picture."""

import itertools
import time

from .. import native
from ..core.errors import LisleError, message_of_bug
from ..core.painter import Task
from . import painting
from .screen import Screen
from .snapshot import Snapshot

WAIT_S = 0.07
"""How long a redraw waits at most for the first picture of a new view; what comes later gets a redraw of its own."""

REDRAW_S = 0.095
"""What it may take in all: it waits less where the lines that stand for a late picture took long the last time."""

_numbers = itertools.count()


class Viewport:
    """What is kept for a region."""

    def __init__(self, on_news):
        """`on_news` has the region redrawn, and returns whether it is still there."""
        self.name = f"viewport {next(_numbers)}"
        self._on_news = on_news
        self._screen = Screen()
        self._snapshot = None
        self._lines_s = 0.0
        self.problem = None
        """Why nothing is drawn, in words; None if all is well."""

    def update(self, space, depsgraph):
        """Reads the scene: something in it has changed, though perhaps nothing that is seen here."""
        old, self._snapshot, self.problem = self._snapshot, None, None
        try:
            new = Snapshot(native.module(), depsgraph, lambda obj: obj.visible_in_viewport_get(space))
        except LisleError as error:
            self.problem = str(error)
            return
        except Exception as error:
            self.problem = message_of_bug(error)
            raise
        if old is not None and new.shows_the_same_as(old):
            old.notes = new.notes
            new = old
        self._snapshot = new

    def draw(self, view):
        """Draws a core.view.View as the whole picture. Returns a line for the status."""
        if view.is_empty or self._snapshot is None:
            return self.problem or ""
        picture, status = self._picture(view)
        if picture is not None:
            self._screen.draw(picture, view)
            return " · ".join((status, *dict.fromkeys(self._snapshot.left_out())))
        if self._snapshot.background is not None:
            self._screen.fill(self._snapshot.background, view)
        self._draw_lines(view)
        return status

    def draw_over(self, view, lighting, transform):
        """Draws the yarns alone, hidden by what is nearer. `lighting` as in Snapshot.painter, `transform` as in
        Screen.draw_in_depth."""
        if view.is_empty or self._snapshot is None or not self._snapshot.content.placements:
            return
        picture, _ = self._picture(view, lighting, alone=True)
        if picture is not None:
            self._screen.draw_in_depth(picture, view, transform)
        else:
            self._draw_lines(view, "LESS_EQUAL", transform)

    def _draw_lines(self, view, *options):
        start = time.perf_counter()
        self._screen.draw_lines(self._snapshot, view, *options)
        self._lines_s = time.perf_counter() - start

    def _picture(self, view, lighting=None, alone=False):
        """The picture if there is one, and a line for the status."""
        snapshot, lisle = self._snapshot, native.module()
        camera = lisle.Camera(view.world_from_camera, view.clip_from_camera, view.size, **view.lens)
        key = (snapshot.number, view.key(), repr(lighting))
        draw = snapshot.painter(camera, lighting, alone)
        painting.PAINTER.show(self.name, Task(key, view.size, view.region, snapshot.samples, draw))
        painting.watch(self.name, self._on_news)
        try:
            picture = painting.PAINTER.picture(self.name, max(min(WAIT_S, REDRAW_S - self._lines_s), 0.0))
        except Exception as error:  # raised in the thread
            return None, str(error)
        return picture, "Drawing" if picture is None else f"Sample {picture.samples}/{snapshot.samples}"

    def close(self):
        painting.close(self.name)
