"""`blender -b`: what a render farm calls. Frames on disk and the exit code are all that it sees."""

import os

import numpy as np
from PIL import Image

BUG_AT_FRAME_3 = """
import sys
engine = sys.modules["bl_ext.user_default.lisle_blender.engine.engine"]
draw = engine.draw
def broken(self, depsgraph, *arguments):
    if depsgraph.scene.frame_current == 3:
        raise ZeroDivisionError("made for the test")
    return draw(self, depsgraph, *arguments)
engine.draw = broken
"""


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def pixels(path):
    """(h, w, 4) float in 0 to 1."""
    return np.asarray(Image.open(path).convert("RGBA"), np.float64) / 255


def shows_yarn(picture):
    """Whether the yarn crosses the middle: covered and lit there, empty in the corner."""
    middle = picture[22:26, 30:34]
    return middle[..., 3].mean() > 0.8 and middle[..., :3].mean() > 0.05 and picture[0, 0, 3] == 0


def test_a_blank_picture_does_not_show_yarn():
    assert not shows_yarn(np.zeros((48, 64, 4)))
    assert not shows_yarn(np.ones((48, 64, 4)))


def test_an_animation_writes_every_frame(blender, scene, tmp_path):
    done = blender.run("-b", scene("sound"), "-o", tmp_path / "f_####", "-a")
    assert done.returncode == 0, done.stdout
    assert names(tmp_path) == [f"f_{frame:04}.png" for frame in range(1, 6)]
    pictures = [pixels(path) for path in sorted(tmp_path.iterdir())]
    assert all(shows_yarn(picture) for picture in pictures)
    assert np.abs(pictures[0] - pictures[4]).mean() > 0.02, "it does not move"


def test_a_part_of_the_frames(blender, scene, tmp_path):
    done = blender.run("-b", scene("sound"), "-o", tmp_path / "f_####", "-s", 2, "-e", 4, "-j", 2, "-a")
    assert done.returncode == 0, done.stdout
    assert names(tmp_path) == ["f_0002.png", "f_0004.png"]


def test_a_frame_alone_is_the_same_as_in_the_animation(blender, scene, tmp_path):
    for folder, arguments in (("alone", ("-f", "4")), ("list", ("-f", "2,4..5")), ("all", ("-a",))):
        (tmp_path / folder).mkdir()
        done = blender.run("-b", scene("sound"), "-o", tmp_path / folder / "f_####", *arguments)
        assert done.returncode == 0, done.stdout
    assert names(tmp_path / "alone") == ["f_0004.png"]
    assert names(tmp_path / "list") == ["f_0002.png", "f_0004.png", "f_0005.png"]
    for folder in ("alone", "list"):
        for path in (tmp_path / folder).iterdir():
            np.testing.assert_array_equal(pixels(path), pixels(tmp_path / "all" / path.name))


def test_the_engine_can_be_named_on_the_command_line(blender, scene, tmp_path):
    assert "LISLE" in blender.run("-b", "-E", "help").stdout
    other = ("--python-expr", "import bpy; bpy.context.scene.render.engine = 'BLENDER_WORKBENCH'")
    done = blender.run("-b", scene("sound"), *other, "-E", "LISLE", "-o", tmp_path / "f_####", "-f", 1)
    assert done.returncode == 0, done.stdout
    assert shows_yarn(pixels(tmp_path / "f_0001.png"))


def test_an_error_in_the_scene_stops_the_animation(blender, scene, tmp_path):
    done = blender.run("-b", scene("broken"), "-o", tmp_path / "f_####", "-a")
    assert done.returncode == 1
    assert "object 'Yarn'" in done.stdout and "frame 3 against reference frame 1" in done.stdout, done.stdout
    assert names(tmp_path) == ["f_0001.png", "f_0002.png"]
    assert all(shows_yarn(pixels(path)) for path in tmp_path.iterdir())


def test_a_bug_stops_the_animation(blender, scene, tmp_path):
    done = blender.run("-b", scene("sound"), "--python-expr", BUG_AT_FRAME_3, "-o", tmp_path / "f_####", "-a")
    assert done.returncode == 1
    assert "ZeroDivisionError: made for the test" in done.stdout, done.stdout
    assert names(tmp_path) == ["f_0001.png", "f_0002.png"]


def test_an_error_in_a_still_saves_nothing(blender, scene, tmp_path):
    done = blender.run("-b", scene("broken"), "-o", tmp_path / "f_####", "-f", 3)
    assert done.returncode == 1
    assert "object 'Yarn'" in done.stdout
    assert names(tmp_path) == []


THREADS = """
import bpy, sys
bpy.context.view_layer.objects.active = bpy.data.objects["Yarn"]
bpy.data.objects["Yarn"].select_set(True)
if {render}:
    bpy.ops.render.render()
bpy.ops.lisle.fibers_to_curves(for_camera=False)
print("threads:", sys.modules["lisle"].threads())
"""


def test_threads_bound_pictures_and_tools(blender, scene):
    """`-t` also bounds what is computed outside of renders."""

    def threads(render, *options):
        done = blender.run("-b", *options, scene("sound"), "--python-expr", THREADS.format(render=render))
        assert done.returncode == 0 and "threads: " in done.stdout, done.stdout
        return int(done.stdout.partition("threads: ")[2].split()[0])

    assert threads(False, "-t", 1) == threads(True, "-t", 1) == 1
    assert threads(True, "--threads", 3) == 3
    assert threads(False) == len(os.sched_getaffinity(0))
