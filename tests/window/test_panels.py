"""What panels show that there is only with a window."""

import pytest
from looking import screen, settled, world

SIMULATES_EVENTS = True

PICTURES = """
import importlib
material = bpy.data.materials.new('Pictures')
thumbnails = importlib.import_module(PACKAGE + '.presets.thumbnails')
presets = importlib.import_module(PACKAGE + '.presets')
answer = [
    [item[3] for item in thumbnails.items_of(kind, items)(None, None)]
    for kind, items in (('yarn', presets.YARN_ITEMS), ('fiber', presets.FIBER_ITEMS))
]
bpy.data.materials.remove(material)
"""

SELECT = """
yarn = bpy.data.objects['Yarn']
if not yarn.data.materials:
    yarn.data.materials.append(bpy.data.materials.new('Wool'))
bpy.context.view_layer.objects.active = yarn
yarn.select_set(True)
"""

PROPERTIES = """
area = next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == 'PROPERTIES')
area.spaces.active.context = {!r}
area.tag_redraw()
"""

REDRAW = "bpy.ops.wm.redraw_timer(type='DRAW_WIN_SWAP', iterations=3)"


def test_every_preset_has_an_icon_of_its_own(any_window):
    for icons in any_window.do(PICTURES):
        assert 0 not in icons and len(set(icons)) == len(icons) >= 9


@pytest.mark.parametrize("tab", ["RENDER", "VIEW_LAYER", "WORLD", "OBJECT", "MATERIAL"])
def test_panels_draw(view, tab):
    world(view, (0.2, 0.4, 0.6))
    view.do(SELECT)
    view.do(PROPERTIES.format(tab))
    view.do(REDRAW)
    screen(view, keep=f"panel-{tab.lower()}")
    log = view.news()
    assert "Traceback" not in log and "rna_uiItem" not in log, log


POPUPS = {
    "overlays": "operator(bpy.ops.wm.call_panel, invoke=True, name='VIEW3D_PT_overlay')",
    "add": "operator(bpy.ops.wm.call_menu, invoke=True, name='VIEW3D_MT_curve_add')",
    "object": "operator(bpy.ops.wm.call_menu, invoke=True, name='VIEW3D_MT_object')",
}


@pytest.mark.parametrize("name", POPUPS)
def test_what_pops_up_draws(view, name):
    view.do(SELECT)
    view.do("window = bpy.context.window_manager.windows[0]")
    view.do("window.event_simulate(type='MOUSEMOVE', value='NOTHING', x=330, y=300)")
    before = settled(view)
    view.do(POPUPS[name])
    pixels = screen(view, keep=f"popup-{name}")
    assert (pixels != before).any(axis=2).mean() > 0.02, "nothing popped up"
    view.do(
        "window = bpy.context.window_manager.windows[0]; window.event_simulate(type='ESC', value='PRESS', x=5, y=5)"
    )
    view.do("window.event_simulate(type='ESC', value='RELEASE', x=5, y=5)")
    log = view.news()
    assert "Traceback" not in log and "rna_uiItem" not in log, log
