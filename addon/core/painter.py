# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of views that improve while one looks: a thread draws, the caller shows what is there.

A view first gets a draft, small enough to come at once; then samples at full size, cut into strips so that no call is
long, because a new camera must not wait for an old one. A view without a picture goes before all that refine theirs.
"""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

CALL_S = 0.07
"""What one call to draw should take, as far as pixels make the time. Much of it may be the scene's, shadows for
example: smaller drafts or strips would not help against that."""

_FIRST_DRAFT_PIXELS = 40_000
_LEAST_DRAFT_PIXELS = 16_000
_FIRST_STRIP_PIXELS = 80_000
_LEAST_STRIP_PIXELS = 40_000
_MOST_SAMPLES_A_CALL = 8

DRAFT, FIRST_SAMPLE, OTHER_SAMPLES = range(3)
"""Qualities that are asked for: each may take more time than the one before."""


class Stopped(Exception):
    """Raised by `Task.draw` where `go_on` said no."""


@dataclass(frozen=True)
class Task:
    """What a view shows."""

    key: object
    """Equal keys mean equal pictures."""
    size: tuple
    """(w, h) of the whole view, pixels."""
    region: tuple
    """Part to draw: (x0, y0, x1, y1) from the bottom left, end exclusive; not empty."""
    samples: int
    draw: Callable
    """`draw(size, region, samples, first_sample, quality, go_on)` → (combined (h, w, 4), depth (h, w)), float32,
    top row first. `quality` is one of `DRAFT`, `FIRST_SAMPLE`, `OTHER_SAMPLES`. `go_on()` is asked now
    and then; draws nothing and raises Stopped once it says False."""


@dataclass(frozen=True, eq=False)
class Picture:
    """A state of a view's picture."""

    key: object
    combined: np.ndarray
    """(h, w, 4) float32, scene-linear, premultiplied, bottom row first; a draft has fewer pixels than its region."""
    depth: np.ndarray
    """(h, w) float32, distance along the view axis, 1e10 where there is nothing."""
    region: tuple
    samples: int
    """0 for a draft."""


@dataclass(eq=False)
class _View:
    task: Task
    steps: object = None
    picture: Picture | None = None
    error: Exception | None = None
    draft_pixels: float = _FIRST_DRAFT_PIXELS
    draft_s: float = 0.0
    strip_pixels: float = _FIRST_STRIP_PIXELS
    seen: Picture | Exception | None = None

    def has_something(self):
        """Whether there is anything to show for the present task."""
        return self.error is not None or (self.picture is not None and self.picture.key == self.task.key)


class Painter:
    """Draws any number of views in one thread, which sleeps when all are done."""

    def __init__(self):
        self._condition = threading.Condition()
        self._views = {}
        self._thread = None
        self._paused = False
        self._stopping = False
        self._last = None
        self._round, self._round_end = set(), 0.0

    def show(self, name, task):
        """From now on the view `name` shows that; the same key as before changes nothing."""
        with self._condition:
            view = self._views.get(name)
            if view is None:
                view = self._views[name] = _View(task)
            elif view.task.key == task.key:
                return
            view.task, view.error = task, None
            view.steps = self._steps(view, task)
            if self._thread is None:
                self._stopping = False
                self._thread = threading.Thread(target=self._run, name="Lisle viewport", daemon=True)
                self._thread.start()
            self._condition.notify_all()

    def picture(self, name, wait_s=0.0):
        """The best Picture of what the view shows now, or None; raises what drawing it raised.

        Waits up to `wait_s` for one, unless it pauses. Views that are asked for one after the other, as in one redraw
        of several, wait no longer than that together.
        """
        with self._condition:
            view = self._views.get(name)
            if view is None:
                return None
            if not self._paused:
                self._condition.wait_for(view.has_something, self._patience(name, wait_s))
            view.seen = view.error or view.picture
            if view.error is not None:
                raise view.error
            return view.picture if view.has_something() else None

    def _patience(self, name, wait_s):
        """Seconds left to wait for a view: those whose turn comes before it is asked for again share them."""
        now = time.monotonic()
        if name in self._round or now > self._round_end + wait_s:
            self._round, self._round_end = set(), now + wait_s
        self._round.add(name)
        return max(self._round_end - now, 0.0)

    def news(self):
        """Names of the views that have more to show than `picture` last returned."""
        with self._condition:
            return [
                name
                for name, view in self._views.items()
                if view.has_something() and view.seen is not (view.error or view.picture)
            ]

    def busy(self):
        """Whether there is anything left to draw."""
        with self._condition:
            return self._thread is not None and any(view.steps is not None for view in self._views.values())

    def close(self, name):
        """Forgets a view."""
        with self._condition:
            self._close(name)

    def pause(self, paused=True):
        """Draws nothing more until it is told to go on, with `pause(False)`."""
        with self._condition:
            self._paused = paused
            self._condition.notify_all()

    def stop(self):
        """Forgets all views and ends the thread; returns when it has ended."""
        with self._condition:
            for name in list(self._views):
                self._close(name)
            self._stopping = True
            self._paused = False
            thread, self._thread = self._thread, None
            self._condition.notify_all()
        if thread is not None:
            thread.join()

    def _close(self, name):
        view = self._views.pop(name, None)
        if view is not None:
            # Both know the view: with its pictures and its scene, they would wait for the garbage collector.
            view.steps = view.error = None
            if self._last is view:
                self._last = None

    def _run(self):
        while self._step():
            pass

    def _step(self):
        """Waits for something to do and does it; False when there will be nothing more. Holds on to nothing."""
        with self._condition:
            self._condition.wait_for(lambda: self._stopping or self._next() is not None)
            if self._stopping:
                return False
            view = self._last = self._next()
            steps = view.steps
        try:
            next(steps)
        except StopIteration:
            self._finish(view, steps, None)
        except Exception as error:  # it is shown where the picture would be
            self._finish(view, steps, error)
        return True

    def _finish(self, view, steps, error):
        with self._condition:
            if view.steps is steps:
                view.steps, view.error = None, error
                self._condition.notify_all()

    def _next(self):
        """The view to draw next, None if there is nothing to do."""
        if self._paused:
            return None
        pending = [view for view in self._views.values() if view.steps is not None]
        waiting = [view for view in pending if not view.has_something()]
        if waiting:
            return waiting[0]
        others = [view for view in pending if view is not self._last]
        return (others or pending or [None])[0]

    def _wanted(self, view, task):
        """Whether it makes sense to go on drawing that."""
        with self._condition:
            if self._stopping or self._paused or view.task is not task or view not in self._views.values():
                return False
            return not view.has_something() or all(other.has_something() for other in self._views.values())

    def _steps(self, view, task):
        """Draws a task; yields after every call. Runs in the thread, one step at a time."""
        draw = self._timed(view, task)
        width, height = task.region[2] - task.region[0], task.region[3] - task.region[1]
        share = (view.draft_pixels / (width * height)) ** 0.5
        has_draft = share < 0.8
        if has_draft:
            yield from self._draft(view, task, draw, share)
        first_s = 0.0
        combined = depth = None
        done = 0
        while done < task.samples:
            # The first sample alone, to come soon; then many at once, which share what is drawn once a call.
            count = min(_MOST_SAMPLES_A_CALL, task.samples - done) if done else 1
            fresh = np.empty((height, width, 4), np.float32)
            fresh_depth = np.empty((height, width), np.float32)
            low = 0
            while low < height:
                rows = min(max(int(view.strip_pixels / width), 1), height - low)
                region = (task.region[0], task.region[1] + low, task.region[2], task.region[1] + low + rows)
                drawn = draw(task.size, region, count, done, OTHER_SAMPLES if done else FIRST_SAMPLE)
                if drawn is not None:
                    strip, strip_depth, seconds = drawn
                    first_s += 0.0 if done else seconds
                    fresh[low : low + rows] = strip[::-1]
                    fresh_depth[low : low + rows] = strip_depth[::-1]
                    speed = max(CALL_S, 2 * view.draft_s) * count / seconds
                    if speed < 1 or rows < height - low:  # a small rest says little
                        view.strip_pixels = _adapted(view.strip_pixels, speed, _LEAST_STRIP_PIXELS)
                    low += rows
                yield
            if combined is None:
                combined, depth = fresh, fresh_depth
                if not has_draft:  # it was as good as one: what is too slow now gets one next time
                    view.draft_pixels = _adapted(width * height, CALL_S / first_s, _LEAST_DRAFT_PIXELS)
            else:
                fresh -= combined
                fresh *= count / (done + count)
                fresh += combined
                combined = fresh
            done += count
            self._publish(view, task, Picture(task.key, combined, depth, task.region, done))

    def _draft(self, view, task, draw, share):
        size = tuple(max(round(n * share), 1) for n in task.size)
        scale = np.array([*size, *size]) / [*task.size, *task.size]
        x0, y0 = np.floor(task.region[:2] * scale[:2]).astype(int)
        x1, y1 = np.ceil(task.region[2:] * scale[2:]).astype(int)
        region = (int(x0), int(y0), int(min(max(x1, x0 + 1), size[0])), int(min(max(y1, y0 + 1), size[1])))
        while True:
            drawn = draw(size, region, 1, 0, DRAFT)
            if drawn is not None:
                break
            yield
        combined, depth, seconds = drawn
        view.draft_pixels = _adapted(view.draft_pixels, CALL_S / seconds, _LEAST_DRAFT_PIXELS)
        view.draft_s = seconds
        covered = tuple(np.array(region) / scale)
        flipped = np.ascontiguousarray(combined[::-1]), np.ascontiguousarray(depth[::-1])
        self._publish(view, task, Picture(task.key, *flipped, covered, 0))
        yield

    def _timed(self, view, task):
        """`task.draw` with the seconds it took, or None if something else was to be drawn first."""

        def draw(size, region, samples, first_sample, quality):
            start = time.perf_counter()
            try:
                drawn = task.draw(size, region, samples, first_sample, quality, lambda: self._wanted(view, task))
            except Stopped:
                return None
            return *drawn, max(time.perf_counter() - start, 1e-6)

        return draw

    def _publish(self, view, task, picture):
        with self._condition:
            if view.task is task:
                view.picture = picture
                self._condition.notify_all()


def _adapted(pixels, speed, least):
    """How many pixels to draw in one call after one that was `speed` times as fast as it should be."""
    return pixels if 0.8 < speed < 1.6 else max(pixels * min(max(speed, 0.3), 2.0), least)
