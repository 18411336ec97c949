"""A progress bar."""

import sys
import time
from types import TracebackType

WIDTH = 32
REDRAW_S = 0.1


class Bar:
    """A bar on standard error when that is a terminal, silent otherwise."""

    def __init__(self, steps: int) -> None:
        self._steps = steps
        self._step = 0
        self._label = ""
        self._shown = sys.stderr.isatty()
        self._start = self._drawn = time.monotonic()

    def __enter__(self) -> "Bar":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if self._shown:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()

    def begin(self, step: int, label: str) -> None:
        """A step of `steps` begins."""
        self._step, self._label = step, label
        self._draw(0.0)

    def update(self, fraction: float) -> None:
        """So much of the current step is done."""
        if time.monotonic() - self._drawn >= REDRAW_S:
            self._draw(fraction)

    def _draw(self, fraction: float) -> None:
        if not self._shown:
            return
        self._drawn = time.monotonic()
        done = (self._step + fraction) / self._steps
        filled = round(WIDTH * done)
        elapsed = self._drawn - self._start
        left = f" {elapsed * (1 - done) / done:.0f} s left" if done > 0 and elapsed > 2 else ""
        bar = "█" * filled + "░" * (WIDTH - filled)
        sys.stderr.write(f"\r\x1b[K{self._label} {bar} {100 * done:3.0f} %{left}")
        sys.stderr.flush()
