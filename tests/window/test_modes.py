"""Yarn while it is edited and sculpted, and while what shows it changes or goes."""

import time

import numpy as np
import pytest
from looking import settled, srgb, world, yarn_mask

SIMULATES_EVENTS = True

BACKGROUND = (0.2, 0.4, 0.6)

ACTIVE = """
window = bpy.context.window_manager.windows[0]
yarn = bpy.data.objects['Yarn']
bpy.context.view_layer.objects.active = yarn
yarn.select_set(True)
bpy.ops.ed.undo_push(message='begin')
"""

COMB = """
operator(bpy.ops.object.mode_set, mode='SCULPT_CURVES')
operator(bpy.ops.brush.asset_activate, asset_library_type='ESSENTIALS',
         relative_asset_identifier='brushes/essentials_brushes-curve_sculpt.blend/Brush/Comb')
bpy.ops.ed.undo_push(message='sculpt')
there = region()
places = [location_3d_to_region_2d(there, rv3d(), Vector((0, 0.2 * step, 0))) for step in range(12)]
places = [(int(there.x + place.x), int(there.y + place.y)) for place in places]
window.event_simulate(type='MOUSEMOVE', value='NOTHING', x=places[0][0], y=places[0][1])
window.event_simulate(type='LEFTMOUSE', value='PRESS', x=places[0][0], y=places[0][1])
"""

POINTS = """
values = [0.0] * (3 * len(yarn.data.points))
yarn.data.position_data.foreach_get('vector', values)
answer = values[1::3]
"""


@pytest.fixture
def shown(view):
    """Where the window shows the yarn once it has done something; `shown.view` is the window."""
    world(view, BACKGROUND)
    view.do(ACTIVE)

    def shown(code="", keep=None):
        view.do(code)
        time.sleep(0.2)
        return yarn_mask(settled(view, keep), view.do("answer = rectangle()"), srgb(BACKGROUND))

    shown.view = view
    return shown


def test_a_yarn_in_edit_mode_follows_its_points(shown):
    view, before = shown.view, shown()
    assert before.mean() > 0.02
    edited = shown("operator(bpy.ops.object.mode_set, mode='EDIT'); bpy.ops.ed.undo_push(message='edit')")
    np.testing.assert_array_equal(edited, before)
    moved = shown(
        "operator(bpy.ops.curves.select_all, action='SELECT')\n"
        "operator(bpy.ops.transform.translate, value=(0, 1, 0)); bpy.ops.ed.undo_push(message='moved')",
        keep="edited",
    )
    assert view.do("answer = bpy.context.mode") == "EDIT_CURVES"
    assert (moved & before).sum() < 0.5 * before.sum() and moved.sum() == pytest.approx(before.sum(), rel=0.1)
    np.testing.assert_array_equal(shown("operator(bpy.ops.ed.undo); yarn = bpy.data.objects['Yarn']"), before)
    operator = "operator(bpy.ops.object.mode_set, mode='OBJECT')"
    np.testing.assert_array_equal(shown(operator), before)


def test_a_sculpted_yarn_follows_the_brush(shown):
    view, before = shown.view, shown()
    view.do(COMB)
    during = []
    for number in range(12):
        view.do(f"x, y = places[{number}]; window.event_simulate(type='MOUSEMOVE', value='NOTHING', x=x, y=y)")
        time.sleep(0.05)
        during.append(view.do("answer = [view.has_something() for view in painter()._views.values()]"))
    view.do("window.event_simulate(type='LEFTMOUSE', value='RELEASE', x=x, y=y)")
    # With the mouse goes the circle of the brush.
    view.do(
        "window.event_simulate(type='MOUSEMOVE', value='NOTHING', x=2, y=2); space().show_region_asset_shelf = False"
    )
    assert all(len(views) == 1 for views in during)
    after = shown(keep="sculpted")
    assert view.do("answer = bpy.context.mode") == "SCULPT_CURVES" and max(view.do(POINTS)) > 0.3
    rows = [np.flatnonzero(mask.any(axis=1)) for mask in (before, after)]
    assert rows[1][0] < rows[0][0] - 10, "nothing was combed upwards"
    undone = shown("operator(bpy.ops.ed.undo); yarn = bpy.data.objects['Yarn']", keep="comb-undone")
    assert max(view.do(POINTS)) == 0
    np.testing.assert_array_equal(undone, before)


REMOVED = "bpy.data.objects.remove(bpy.data.objects['Yarn'])"
WHILE = {
    "another engine": "bpy.context.scene.render.engine = 'CYCLES'",
    "another shading": "space().shading.type = 'SOLID'",
    "the yarn removed": REMOVED,
    "its curves removed": "bpy.data.hair_curves.remove(bpy.data.hair_curves['Yarn'])",
    "undo": "operator(bpy.ops.ed.undo)",
    "edit mode": "operator(bpy.ops.object.mode_set, mode='EDIT')",
    "another material": "yarn.data.materials.append(bpy.data.materials.new('Wool'))",
    "another size": "a = areas()[0]; operator(bpy.ops.screen.area_move, x=a.x + a.width, y=a.y + 50, delta=-60)",
    "the same file": "bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath, load_ui=False)",
}


@pytest.mark.parametrize("what", WHILE)
def test_changes_while_it_draws(shown, what):
    view = shown.view
    shown("yarn.location.y = 1; bpy.ops.ed.undo_push(message='moved')")
    view.do("bpy.context.scene.lisle.viewport_samples = 10_000; look((0.1, 0, 0))")
    view.until("answer = painter().busy() and [v.picture.samples for v in painter()._views.values() if v.picture]")
    view.do(WHILE[what])
    time.sleep(0.3)
    view.do(
        "scene = bpy.context.scene; scene.render.engine = 'LISLE'; scene.lisle.viewport_samples = 4\n"
        "space().shading.type = 'RENDERED'; look()"
    )
    mask = shown(keep=f"while-{what.replace(' ', '-')}")
    assert mask.any() == ("removed" not in what)
    if "removed" in what:
        view.do("operator(bpy.ops.ed.undo)")
        assert shown().any()
    log = view.news()
    assert "Traceback" not in log and "panicked" not in log, log
    view.do("a = areas()[0]; operator(bpy.ops.screen.area_move, x=a.x + a.width, y=a.y + 50, delta=60)")
