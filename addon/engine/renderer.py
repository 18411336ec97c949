# SPDX-License-Identifier: GPL-3.0-or-later
"""The one native renderer of this process. It holds the GPU and its tables, which take seconds to make."""

import threading

_renderer = None
_lock = threading.Lock()


def renderer(lisle):
    """The shared `lisle.Renderer`, made at the first call. Raises lisle.DeviceError without a usable GPU."""
    global _renderer
    with _lock:
        if _renderer is None:
            _renderer = lisle.Renderer()
            print(f"Lisle: drawing on {_renderer.adapter.name}")
        return _renderer


def drop():
    """Forgets the renderer, after a device error for example: the next call makes a new one."""
    global _renderer
    _renderer = None
