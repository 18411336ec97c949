"""What panels show that there is only with a window."""

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
area.spaces.active.context = 'MATERIAL'
area.tag_redraw()
"""


def test_every_preset_has_an_icon_of_its_own(any_window):
    for icons in any_window.do(PICTURES):
        assert 0 not in icons and len(set(icons)) == len(icons) >= 9


def test_the_material_panel_draws(view):
    view.do(SELECT)
    view.do(PROPERTIES)
    view.do("bpy.ops.wm.redraw_timer(type='DRAW_WIN_SWAP', iterations=3)")
    log = view.news()
    assert "Traceback" not in log, log
