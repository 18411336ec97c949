"""Rendered shading with Lisle in a real window: what stands on the screen, pixel by pixel."""

import time

import numpy as np
import pytest
from looking import IMPOSSIBLE, at, screen, settled, srgb, world, yarn_mask
from PIL import Image

ALONG = "answer = on_screen([(x, y, 0) for x in (-2.5, 0, 2.5) for y in (-1, 0, 1)])"


@pytest.mark.parametrize(
    "look",
    ["rotation=(0.5, 0.2, 0.3)", "perspective='ORTHO'", "rotation=(0.9, 0, 1), at=(1, 0, 0), distance=7"],
)
def test_yarn_stands_where_blender_projects_it(view, look):
    world(view, (0.2, 0.4, 0.6))
    view.do(f"look({look})")
    pixels = settled(view, keep="placed")
    background = srgb((0.2, 0.4, 0.6))
    places = view.do(ALONG)
    left, top, right, bottom = view.do("answer = rectangle()")
    inside = [left < x < right and top < y < bottom for x, y in places]
    assert sum(inside) >= 6
    for number, (place, shown) in enumerate(zip(places, inside, strict=True)):
        if shown:
            is_background = np.abs(at(pixels, place) - background).max() <= 2
            assert is_background == (number % 3 != 1), (number, place, at(pixels, place))


def test_the_background_is_the_worlds_colour_as_with_cycles(view):
    for transform in ("Standard", "AgX"):
        colors = {}
        for engine in ("CYCLES", "LISLE"):
            view.do(f"bpy.context.scene.render.engine = {engine!r}")
            view.do(f"bpy.context.scene.view_settings.view_transform = {transform!r}")
            world(view, (0.7, 0.3, 0.1))
            view.do("look((0, 3.14159, 0), at=(0, 0, 40)); bpy.context.scene.cycles.preview_samples = 1")
            time.sleep(1)
            corner = view.do("left, top, right, bottom = rectangle(); answer = [right - 20, bottom - 20]")
            colors[engine] = at(screen(view), corner)
        assert np.abs(colors["LISLE"] - colors["CYCLES"]).max() <= 1, (transform, colors)
        if transform == "Standard":
            assert np.abs(colors["LISLE"] - srgb((0.7, 0.3, 0.1))).max() <= 1, colors


def test_a_finished_view_is_the_final_picture(view, tmp_path):
    """Through the camera, whose frame is made to fill the viewport, against a render of as many pixels."""
    world(view, (0.05, 0.05, 0.1))
    path = tmp_path / "final.png"
    view.do(
        "scene = bpy.context.scene\n"
        "scene.lisle.viewport_samples = scene.lisle.samples = 64\n"
        "rv3d().view_perspective = 'CAMERA'\n"
        "left, top, right, bottom = rectangle()\n"
        "scene.render.resolution_x, scene.render.resolution_y = right - left, bottom - top\n"
        "operator(bpy.ops.view3d.view_center_camera)\n"
    )
    # Zoomed so that the frame is the region: 1 in Blender's peculiar scale.
    view.do("rv3d().view_camera_zoom = 29.2893; rv3d().view_camera_offset = (0, 0)")
    pixels = settled(view, keep="camera")
    view.do(
        "scene.render.image_settings.file_format = 'PNG'\n"
        f"scene.render.filepath = {str(path)!r}\n"
        "answer = list(bpy.ops.render.render(write_still=True))"
    )
    left, top, right, bottom = view.do("answer = rectangle()")
    final = np.asarray(Image.open(path).convert("RGB"), float)
    shown = pixels[top:bottom, left:right].astype(float)
    assert final.shape == shown.shape
    assert np.abs(final[4:-4, 4:-4] - shown[4:-4, 4:-4]).mean() < 2
    assert final.std() > 10


def test_what_is_left_out_is_said_in_the_status(view):
    view.do(
        "viewport = sys.modules[PACKAGE + '.engine.viewport'].Viewport\n"
        "plain, said = viewport.draw, []\n"
        "def draw(self, view):\n"
        "    said.append(plain(self, view))\n"
        "    return said[-1]\n"
        "viewport.draw = draw\n"
        "volume = bpy.data.objects.new('Smoke', bpy.data.volumes.new('Smoke'))\n"
        "bpy.context.scene.collection.objects.link(volume)"
    )
    settled(view)
    view.do("areas()[0].tag_redraw()")
    status = view.until("answer = said and 'Smoke' in said[-1] and said[-1]")
    view.do("viewport.draw = plain")
    assert status.startswith("Sample 8/8 · objects of these kinds are not drawn: 'Smoke' (volume)"), status


def test_an_impossible_yarn_is_not_drawn_as_it_was(view):
    world(view, (0.2, 0.4, 0.6))
    settled(view)
    (middle,) = view.do("answer = on_screen([(0, 0, 0)])")
    view.do(IMPOSSIBLE)
    view.do(
        "import gc\n"
        "Viewport = sys.modules[PACKAGE + '.engine.viewport'].Viewport\n"
        "def problems():\n"
        "    return [each.problem for each in gc.get_objects() if isinstance(each, Viewport)]\n"
    )
    (problem,) = view.until("answer = [problem for problem in problems() if problem]")
    assert problem.startswith("object 'Yarn': material 'Impossible': ") and "ply_twist" in problem
    grey = at(screen(view, keep="impossible"), middle)
    assert np.abs(grey - at(screen(view), (middle[0], middle[1] + 150))).max() <= 2
    view.do("material.lisle.yarn.customize = False")
    view.until("answer = not any(problems())")
    assert np.abs(at(settled(view), middle) - grey).max() > 10


def test_a_transparent_film_shows_what_is_behind(view):
    world(view, (0.7, 0.3, 0.1), transparent=True)
    pixels = settled(view, keep="transparent")
    corner, middle = view.do("left, top, *_ = rectangle(); answer = [(left + 20, top + 20), *on_screen([(0, 0, 0)])]")
    assert np.abs(at(pixels, corner) - srgb((0.7, 0.3, 0.1))).max() > 30
    assert at(pixels, middle).max() > 60


def test_a_border_is_drawn_alone(view):
    world(view, (0.2, 0.4, 0.6))
    background = srgb((0.2, 0.4, 0.6))
    view.do(
        "view = space(); view.use_render_border = True\n"
        "view.render_border_min_x, view.render_border_max_x = 0.25, 0.5\n"
        "view.render_border_min_y, view.render_border_max_y = 0.25, 0.75\n"
        "areas()[0].tag_redraw()"
    )
    pixels = settled(view, keep="border")
    left, top, right, bottom = view.do("answer = rectangle()")
    width, height = right - left, bottom - top
    inside = at(pixels, (left + 0.3 * width, top + 0.3 * height))
    outside = at(pixels, (left + 0.7 * width, top + 0.3 * height))
    assert np.abs(inside - background).max() <= 2
    assert np.abs(outside - background).max() > 20


def test_camera_view_with_shift_and_border(view):
    world(view, (0.2, 0.4, 0.6))
    view.do(
        "scene = bpy.context.scene; rv3d().view_perspective = 'CAMERA'\n"
        "scene.camera.data.shift_x, scene.camera.data.shift_y = 0.1, -0.15\n"
        "scene.render.use_border = True\n"
        "scene.render.border_min_x, scene.render.border_max_x = 0.0, 0.5\n"
        "scene.render.border_min_y, scene.render.border_max_y = 0.0, 1.0\n"
    )
    pixels = settled(view, keep="shifted")
    background = srgb((0.2, 0.4, 0.6))
    # The camera of 8 by 6 m looks down; its frame's middle is shifted by 0.8 and -1.2 m.
    places = view.do("answer = on_screen([(-2, 0, 0), (-2, 1.5, 0), (2, 0, 0), (2.5, 1.5, 0)])")
    yarn, empty, cut, beyond = (at(pixels, place) for place in places)
    assert np.abs(yarn - background).max() > 20 and np.abs(empty - background).max() <= 2
    assert np.abs(cut - beyond).max() <= 12 and np.abs(beyond - background).max() > 20


def test_edits_show(view):
    world(view, (0.2, 0.4, 0.6))
    background = srgb((0.2, 0.4, 0.6))
    settled(view)
    rectangle = view.do("answer = rectangle()")

    def shown(code, keep=None):
        view.do(code)
        time.sleep(0.1)
        return yarn_mask(settled(view, keep), rectangle, background)

    before = shown("")
    assert before.mean() > 0.02
    moved = shown("bpy.ops.ed.undo_push(); bpy.data.objects['Yarn'].location.y = 1; bpy.ops.ed.undo_push()")
    assert (moved & before).sum() < 0.5 * before.sum()
    assert np.array_equal(shown("operator(bpy.ops.ed.undo)"), before)
    thin = shown("bpy.data.objects['Yarn'].lisle.yarn_radius = 0.1")
    assert thin.sum() < 0.5 * before.sum()
    assert np.array_equal(shown("bpy.data.objects['Yarn'].lisle.yarn_radius = 0"), before)

    def colors(code):
        view.do(code)
        time.sleep(0.1)
        return settled(view).astype(float)

    plain = colors(
        "material = bpy.data.materials.new('Wool'); bpy.data.objects['Yarn'].data.materials.append(material)"
    )
    assert np.abs(colors("material.lisle.fiber.preset = 'fleece'") - plain).max() > 30
    assert np.abs(colors("material.lisle.fiber.preset = 'cotton-1'") - plain).max() <= 1
    customized = colors("material.lisle.yarn.customize = True; material.lisle.yarn.plies = 8")
    assert np.abs(customized - plain).max() > 10
    assert np.abs(colors("bpy.context.scene.lisle.shading = 'simple'") - customized).max() > 5
    assert not shown("bpy.data.objects.remove(bpy.data.objects['Yarn'])", keep="deleted").any()


def test_local_view_and_hiding(view):
    world(view, (0.2, 0.4, 0.6))
    background = srgb((0.2, 0.4, 0.6))
    view.do(
        "other = bpy.data.objects['Yarn'].copy(); other.animation_data_clear(); other.location.y = 2; "
        "bpy.context.scene.collection.objects.link(other)"
    )
    rectangle = view.do("answer = rectangle()")
    both = yarn_mask(settled(view), rectangle, background)
    view.do(
        "bpy.context.view_layer.objects.active = other\n"
        "[obj.select_set(obj == other) for obj in bpy.context.scene.objects]\n"
        "operator(bpy.ops.view3d.localview, frame_selected=False)"
    )
    time.sleep(0.2)
    one = yarn_mask(settled(view, "local"), rectangle, background)
    assert 0.3 * both.sum() < one.sum() < 0.7 * both.sum()
    view.do("operator(bpy.ops.view3d.localview, frame_selected=False)")
    time.sleep(0.2)
    assert np.array_equal(yarn_mask(settled(view), rectangle, background), both)
    view.do("other.hide_set(True)")
    time.sleep(0.2)
    hidden = yarn_mask(settled(view), rectangle, background)
    assert 0.3 * both.sum() < hidden.sum() < 0.7 * both.sum()


def test_two_viewports_and_four(view):
    world(view, (0.2, 0.4, 0.6))
    view.do("operator(bpy.ops.screen.region_quadview)")
    time.sleep(0.3)
    settled(view, "quad", views=4)
    view.do("operator(bpy.ops.screen.region_quadview)")
    view.until("answer = len(painter()._views) == 1")
    view.do("operator(bpy.ops.screen.area_split, direction='VERTICAL', factor=0.5)")
    time.sleep(0.3)
    view.do("for area in areas(): bare(area); space(area).shading.type = 'RENDERED'")
    view.do("look((0.5, 0, 0), area=areas()[1])")
    pixels = settled(view, "two", views=2)
    background = srgb((0.2, 0.4, 0.6))
    for number in range(2):
        places = view.do(f"answer = on_screen([(0, 0, 0), (0, 2, 0)], areas()[{number}])")
        assert np.abs(at(pixels, places[0]) - background).max() > 20
        assert np.abs(at(pixels, places[1]) - background).max() <= 2
    view.do("operator(bpy.ops.screen.area_close, areas()[1])")
    view.until("answer = len(areas()) == 1 and len(painter()._views) == 1")


def test_a_first_picture_comes_soon_and_an_idle_view_costs_nothing(view):
    settled(view)
    waits = []
    for number in range(12):
        waits.append(
            view.do(
                "import time\n"
                f"look((0.05 * {number} + 0.1, 0.3, 0))\n"
                "start = time.perf_counter()\n"
                "operator(bpy.ops.wm.redraw_timer, type='DRAW_WIN', iterations=1)\n"
                "answer = time.perf_counter() - start"
            )
        )
        view.until("answer = all(view.has_something() for view in painter()._views.values())")
    assert np.median(waits) < 0.15, waits
    settled(view)
    begin = view.do("answer = time.process_time()")
    time.sleep(2)
    assert view.do("answer = time.process_time()") - begin < 0.3


PROFILE = """
import threading
ran = set()
def note(frame, event, argument):
    code = frame.f_code
    if event == 'call' and PACKAGE.rpartition('.')[2] in code.co_filename:
        ran.add(code)
threading.setprofile(note)
painter().stop()  # its next thread is watched
"""


def test_the_thread_that_draws_knows_nothing_of_blender(view):
    view.do(PROFILE)
    view.do("bpy.ops.mesh.primitive_cube_add(location=(0, 0, -3)); look((0.4, 0, 0))")
    settled(view)
    view.do("threading.setprofile(None)")
    functions = view.do("answer = [[code.co_filename, code.co_name, list(code.co_names)] for code in ran]")
    assert {"_step", "draw", "add_objects"} <= {name for _, name, _ in functions}
    assert not [function for function in functions if "bpy" in function[2]]
    view.do("painter().stop(); areas()[0].tag_redraw()")


def test_switching_engines_files_and_shading_leaves_no_view_behind(view):
    settled(view)
    for engine in ("BLENDER_WORKBENCH", "LISLE", "CYCLES", "LISLE"):
        view.do(f"bpy.context.scene.render.engine = {engine!r}")
        view.until(f"answer = len(painter()._views) == {int(engine == 'LISLE')}")
    view.do("space().shading.type = 'SOLID'")
    view.until("answer = not painter()._views")
    view.do("space().shading.type = 'RENDERED'")
    settled(view)
    view.do("bpy.ops.wm.read_homefile(use_factory_startup=False, load_ui=False)")
    time.sleep(0.3)
    assert view.do("answer = not painter().busy()")


def test_the_extension_can_go_while_it_draws(view):
    view.do("bpy.context.scene.lisle.viewport_samples = 5000; look((0.3, 0.2, 0))")
    view.until("answer = painter().busy()")
    view.do("bpy.ops.preferences.addon_disable(module=PACKAGE)")
    view.do(
        "import threading\n"
        "assert not any(thread.name.startswith('Lisle') for thread in threading.enumerate())\n"
        "assert not hasattr(bpy.context.scene, 'lisle')"
    )
    time.sleep(0.5)
    view.do("bpy.ops.preferences.addon_enable(module=PACKAGE)")
    view.do("bpy.context.scene.render.engine = 'LISLE'; bpy.context.scene.lisle.viewport_samples = 2")
    settled(view)


def test_a_final_render_and_the_viewport_share_the_adapter(view):
    view.do("bpy.context.scene.lisle.viewport_samples = 500; look((0.3, 0.2, 0))")
    view.until("answer = painter().busy()")
    assert view.do("answer = list(bpy.ops.render.render())") == ["FINISHED"]
    view.do("bpy.context.scene.lisle.viewport_samples = 4")
    settled(view)
    # As from the menu: a job of its own, while the viewport goes on being redrawn.
    view.do("bpy.context.scene.lisle.samples = 40; operator(bpy.ops.render.render, invoke=True)")
    for number in range(10):
        view.do(f"look((0.3, 0.02 * {number}, 0))")
        time.sleep(0.1)
    view.until("answer = not bpy.app.is_job_running('RENDER')")
    view.do("close_other_windows()")
    view.until("answer = is_settled() or len(painter()._views) == 0")
