"""Tools as they are called from menus: with progress, Escape, undo and redo."""

import time

import pytest

SIMULATES_EVENTS = True

SWATCH = """
for obj in list(bpy.data.objects):
    if obj.type == 'CURVES':
        bpy.data.objects.remove(obj)
space().shading.type = 'SOLID'
operator(bpy.ops.lisle.add_knit_swatch, courses={0}, wales={0})
bpy.ops.ed.undo_push(message='swatch')
window = bpy.context.window_manager.windows[0]
import threading
def fibers():
    return any(thread.name == 'Lisle fibers' for thread in threading.enumerate())
"""

START = "answer = operator(bpy.ops.lisle.fibers_to_curves, invoke=True, for_camera=False, most_points=500)"

KEY = """
window.event_simulate(type='{0}', value='PRESS', x=300, y=300, ctrl={1})
window.event_simulate(type='{0}', value='RELEASE', x=300, y=300, ctrl={1})
"""


@pytest.fixture
def made(view):
    """Whether there are fibers in the scene."""

    def made():
        return view.do("answer = 'Fibers' in bpy.data.collections")

    return made


def test_fibers_are_made_while_blender_goes_on_and_escape_stops_them(view, made):
    view.do(SWATCH.format(60))
    assert view.do(START) == ["RUNNING_MODAL"]
    for number in range(3):
        assert view.do(f"look((0.1 * {number}, 0, 0)); answer = fibers()"), "too fast to be stopped"
    view.do(KEY.format("ESC", False))
    view.until("answer = not fibers()")
    time.sleep(0.3)
    assert not made() and view.do("answer = [obj.name for obj in bpy.context.selected_objects]") == ["Knit Swatch"]


def test_fibers_from_the_menu_can_be_undone_and_made_again(view, made):
    view.do(SWATCH.format(3))
    assert view.do(START) == ["RUNNING_MODAL"]
    view.until("answer = 'Fibers' in bpy.data.collections")
    assert view.do("answer = [obj.name for obj in bpy.context.selected_objects]") == ["Knit Swatch Fibers"]
    time.sleep(0.3)
    view.do(KEY.format("Z", True))
    view.until("answer = 'Fibers' not in bpy.data.collections")
    view.do("operator(bpy.ops.ed.redo)")
    view.until("answer = 'Fibers' in bpy.data.collections")
    log = view.news()
    assert "Traceback" not in log, log
