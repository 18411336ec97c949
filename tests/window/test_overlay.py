"""Yarn over the pictures of other engines: hidden by what is nearer, hiding the rest, of the frame on the clock."""

import time

import numpy as np
import pytest
from looking import IMPOSSIBLE, at, screen, settled, shows, srgb, world

ENGINES = {"EEVEE": "BLENDER_EEVEE", "CYCLES": "CYCLES"}

PICTURE = """
np.save({path!r}, next(iter(painter()._views.values())).picture.combined)
"""


@pytest.fixture
def over(view):
    """The view in Solid shading with the overlay on: a cube in front of the yarn's left, and one behind its right."""
    view.do(
        "scene = bpy.context.scene\n"
        "scene.render.engine = 'BLENDER_WORKBENCH'\n"
        "space().shading.type = 'SOLID'\n"
        "def cube(name, location):\n"
        "    mesh = bpy.data.meshes.new(name)\n"
        "    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]\n"
        "    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]\n"
        "    mesh.from_pydata(corners, [], faces)\n"
        "    obj = bpy.data.objects.new(name, mesh)\n"
        "    obj.location, obj.scale = location, (0.7, 1.2, 0.4)\n"
        "    scene.collection.objects.link(obj)\n"
        "cube('Front', (-1.5, 0, 1.2)); cube('Behind', (1.5, 0, -1.2))\n"
        "space().overlay.show_overlays = True\n"
        "overlay = space().overlay\n"
        "for name in ('show_floor', 'show_axis_x', 'show_axis_y', 'show_cursor', 'show_text', 'show_extras',\n"
        "             'show_outline_selected', 'show_object_origins', 'show_relationship_lines', 'show_bones'):\n"
        "    setattr(overlay, name, False)\n"
        "scene.lisle.show_overlay = True"
    )
    return view


@pytest.mark.parametrize("perspective", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("shading", ["SOLID", "MATERIAL", "EEVEE", "CYCLES"])
def test_yarn_and_scene_hide_each_other(over, shading, perspective):
    if shading == "MATERIAL":
        over.do(f"scene.render.engine = {ENGINES['EEVEE']!r}; space().shading.type = 'MATERIAL'")
    elif shading != "SOLID":
        world(over, (0.02, 0.02, 0.02))
        over.do(f"scene.render.engine = {ENGINES[shading]!r}; space().shading.type = 'RENDERED'")
        over.do("scene.cycles.preview_samples = scene.eevee.taa_samples = 1")
        time.sleep(1)
    over.do("material = bpy.data.materials.new('Orange'); material.lisle.fiber.preset = 'cotton-2'")
    over.do("bpy.data.objects['Yarn'].data.materials.append(material)")
    over.do(f"look((0.2, 0.1, 0), perspective={perspective!r})")
    settled(over)
    places = over.do("answer = on_screen([(-1.5, 0, 0.8), (-1.5, 0, 1.6), (0, 0, 0.4), (1.5, 0, 0.3), (1.5, 1, -0.8)])")
    # Blender shows nothing of a mesh while it compiles the mesh's shaders.
    pixels = shows(over, places[1], keep=f"over-{shading}-{perspective}")
    inside, front, alone, before, behind = (at(pixels, place) for place in places)
    orange = [color[0] > 1.5 * color[2] for color in (inside, front, alone, before, behind)]
    assert orange == [False, False, True, True, False], (inside, front, alone, before, behind)
    over.do("scene.lisle.show_overlay = False")
    over.until("answer = not painter()._views")
    assert not np.array_equal(screen(over), pixels)


def test_what_is_drawn_is_the_offscreen_picture(over, tmp_path):
    over.do("look((0.4, 0.3, 0)); bpy.data.objects.remove(bpy.data.objects['Front'])")
    over.do("bpy.data.objects.remove(bpy.data.objects['Behind']); bpy.data.objects['Yarn'].display_type = 'BOUNDS'")
    pixels = settled(over, keep="offscreen")
    over.do("import numpy as np" + PICTURE.format(path=str(tmp_path / "p.npy")))
    picture = np.load(tmp_path / "p.npy")[::-1]
    left, top, right, bottom = over.do("answer = rectangle()")
    shown = pixels[top:bottom, left:right]
    solid = picture[..., 3] > 0.999
    assert solid.mean() > 0.02
    # Not the mean: the box's lines are in front of a few pixels.
    assert np.median(np.abs(shown[solid] - srgb(picture[solid][:, :3]))) < 1
    mirrored = picture[:, ::-1]
    wrong = mirrored[..., 3] > 0.999
    assert np.median(np.abs(shown[wrong] - srgb(mirrored[wrong][:, :3]))) > 5


@pytest.mark.parametrize("settings", [("AgX", "None", 0.0), ("AgX", "AgX - Punchy", 1.0), ("Standard", "None", -1.0)])
def test_its_colours_are_those_of_the_viewports_view_transform(over, settings, tmp_path):
    """Over Cycles it is the yarn that the engine's own Rendered shading shows, to which Blender gives its transform."""
    names = ("view_transform", "look", "exposure")
    over.do("".join(f"scene.view_settings.{n} = {v!r}\n" for n, v in zip(names, settings, strict=True)))
    over.do("for name in ('Front', 'Behind'): bpy.data.objects.remove(bpy.data.objects[name])")
    over.do("look((0.4, 0.3, 0))")
    world(over, (0.18, 0.18, 0.18))
    over.do("scene.render.engine = 'LISLE'; space().shading.type = 'RENDERED'")
    expected = settled(over)
    over.do("scene.render.engine = 'CYCLES'; scene.cycles.preview_samples = 1; scene.lisle.show_overlay = True")
    time.sleep(1)
    pixels = settled(over, keep=f"view-transform-{settings[0]}-{settings[2]:+.0f}")
    over.do("import numpy as np" + PICTURE.format(path=str(tmp_path / "p.npy")))
    solid = np.load(tmp_path / "p.npy")[::-1, :, 3] > 0.999
    assert solid.mean() > 0.02
    left, top, right, bottom = over.do("answer = rectangle()")
    shown, expected = (p[top:bottom, left:right].astype(int) for p in (pixels, expected))
    assert np.abs(shown[20, 20] - expected[20, 20]).max() <= 1, "the world behind is the same grey card"
    difference = np.abs(shown[solid] - expected[solid])
    assert np.percentile(difference, 90) <= 1, np.percentile(difference, (50, 90, 99))
    # What the display's own curve would make of it is far from that.
    over.do(
        "display = sys.modules[PACKAGE + '.overlay.display']; transform_of = display.transform_of\n"
        "display.transform_of = lambda *_: None; areas()[0].tag_redraw()\n"
        "bpy.ops.wm.redraw_timer(type='DRAW_WIN_SWAP', iterations=1)"
    )
    plain = screen(over)[top:bottom, left:right].astype(int)
    over.do("display.transform_of = transform_of")
    assert np.median(np.abs(plain[solid] - expected[solid])) > 8


def test_the_switch(over):
    settled(over)
    assert over.do("answer = operator(bpy.ops.lisle.toggle_overlay)") == ["FINISHED"]
    over.until("answer = not painter()._views")
    over.do("operator(bpy.ops.lisle.toggle_overlay); space().overlay.show_overlays = False")
    time.sleep(0.3)
    assert over.do("answer = not painter()._views")
    over.do("space().overlay.show_overlays = True")
    settled(over)
    # The engine's own shading shows the yarn already.
    over.do("scene.render.engine = 'LISLE'; space().shading.type = 'RENDERED'")
    settled(over, views=1)


@pytest.mark.parametrize("change", ["toggle_quadview", "split"])
def test_regions_that_are_closed_are_forgotten(over, change):
    settled(over)
    if change == "toggle_quadview":
        call = "operator(bpy.ops.screen.region_quadview)"
        there, back = call, call
    else:
        there = "operator(bpy.ops.screen.area_split, direction='VERTICAL', factor=0.5)"
        back = "operator(bpy.ops.screen.area_close, area=areas()[-1])"
    for _ in range(3):
        over.do(there)
        over.until("answer = len(painter()._views) > 1 and is_settled(len(painter()._views))")
        over.do(back)
        over.do("[area.tag_redraw() for area in areas()]")
        settled(over, views=1)
    assert over.do("answer = len(sys.modules[PACKAGE + '.overlay.handler']._shown)") == 1


def test_an_impossible_yarn_is_said_once(over):
    settled(over)
    over.do(IMPOSSIBLE)
    over.until("answer = sys.modules[PACKAGE + '.overlay'].problem()")
    for _ in range(3):
        over.do("areas()[0].tag_redraw(); bpy.ops.wm.redraw_timer(type='DRAW_WIN_SWAP', iterations=1)")
    log = over.news()
    assert log.count("object 'Yarn': material 'Impossible': ") == 1 and "Traceback" not in log, log
    over.do("material.lisle.yarn.customize = False")
    over.until("answer = sys.modules[PACKAGE + '.overlay'].problem() is None")
    settled(over)


RECORD = """
viewport = sys.modules[PACKAGE + '.engine.viewport']
if not hasattr(viewport, 'plain_picture'):
    viewport.plain_picture = viewport.Viewport._picture
def recorded(self, *arguments, **options):
    picture, status = viewport.plain_picture(self, *arguments, **options)
    yarn = self._snapshot.content.placements[0].world_from_object[1, 3]
    drawn = None if picture is None else picture.key[0] == self._snapshot.number
    record.append([bpy.context.scene.frame_current, float(yarn), drawn])
    return picture, status
record = []
viewport.Viewport._picture = recorded
"""


@pytest.mark.parametrize("shading", ["SOLID", "RENDERED"])
def test_playback_shows_the_frame_on_the_clock(over, shading):
    over.do(
        "yarn = bpy.data.objects['Yarn']; yarn.animation_data_clear()\n"
        "scene.frame_end = 100\n"
        "for frame in (1, 100):\n"
        "    yarn.location.y = 0.01 * frame\n"
        "    yarn.keyframe_insert('location', frame=frame)\n"
        "scene.frame_set(1)"
    )
    if shading == "RENDERED":
        over.do("scene.render.engine = 'LISLE'; space().shading.type = 'RENDERED'")
    settled(over)
    over.do(RECORD)
    over.do("operator(bpy.ops.screen.animation_play)")
    time.sleep(3)
    over.do("operator(bpy.ops.screen.animation_cancel, restore_frame=False)")
    settled(over)
    over.do("viewport.Viewport._picture = viewport.plain_picture")
    record = over.do("answer = record")
    positions = dict(
        over.do(
            "answer = []\n"
            f"for frame in {sorted({frame for frame, *_ in record})}:\n"
            "    scene.frame_set(frame)\n"
            "    answer.append([frame, yarn.matrix_world[1][3]])\n"
        )
    )
    assert len(positions) >= 5, record
    for frame, position, drawn in record:
        assert position == pytest.approx(positions[frame], abs=1e-5), frame
        assert drawn is not False
    # How many depends on the machine: one that is slow shows the yarn's lines in between.
    assert any(drawn for frame, _, drawn in record if frame > 1), record
