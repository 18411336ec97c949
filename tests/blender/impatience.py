"""A user who stops pictures: Blender in the background has none."""

from contextlib import contextmanager


class _Engine:
    """Blender's engine, but for who answers whether to stop."""

    def __init__(self, engine, test_break):
        self._engine, self.test_break = engine, test_break

    def __getattr__(self, name):
        return getattr(self._engine, name)


@contextmanager
def stopping(addon, test_break):
    """Renders within are stopped as soon as `test_break()` is true."""
    module = addon.engine.engine
    draw = module.draw
    module.draw = lambda engine, *arguments: draw(_Engine(engine, test_break), *arguments)
    try:
        yield
    finally:
        module.draw = draw
