"""Runs against a real `blender` ≥ 4.5 on PATH, and says so where there is none.

`LISLE_PACKAGE` is the extension's archive for this platform.
"""

import os
import sys
import warnings
from pathlib import Path

import pytest

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import program  # noqa: E402
import window  # noqa: E402


@pytest.fixture(scope="session")
def blender(tmp_path_factory):
    """A `program.Program` in which the extension is installed and enabled."""
    path, reason = program.find()
    if path is None:
        pytest.skip(reason)
    package = os.environ.get("LISLE_PACKAGE")
    if not package:
        pytest.skip("no package: set LISLE_PACKAGE to the built extension")
    blender = program.Program(path, tmp_path_factory.mktemp("blender"))
    blender.install(Path(package).absolute())
    return blender


@pytest.fixture(scope="session")
def scene(blender, tmp_path_factory):
    """Makes the scene of a kind (see make_scene.py), once."""
    folder, made = tmp_path_factory.mktemp("scenes"), {}

    def make(kind):
        if kind not in made:
            made[kind] = folder / f"{kind}.blend"
            blender.script(HERE / "make_scene.py", made[kind], kind)
        return made[kind]

    return make


def artefacts():
    """Folder for screenshots."""
    folder = Path(os.environ.get("LISLE_ARTEFACTS", HERE.parent.parent / "out" / "window"))
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@pytest.fixture(scope="module", params=["opengl", "vulkan"])
def any_window(request, blender, scene, tmp_path_factory):
    """A `window.Window` on each of Blender's graphics back ends; it lasts for the tests of a file. Where that has
    `SIMULATES_EVENTS`, tests can: on Vulkan such a Blender is never idle.

    Not for all: without Lisle as well, Blender's Vulkan back end crashes on Mesa's software driver after some hundreds
    of scenes.
    """
    problem = window.Display.problem()
    if problem is not None:
        pytest.skip(problem)
    folder = tmp_path_factory.mktemp(request.param)
    for name in ("pixels", "commands"):
        (folder / name).mkdir()
    display = window.Display(folder / "pixels")
    options = ("--enable-event-simulate",) if getattr(request.module, "SIMULATES_EVENTS", False) else ()
    opened = window.Window(blender, display, scene("sound"), folder / "commands", request.param, options)
    opened.artefacts = artefacts()
    yield opened
    code = opened.close()
    display.close()
    assert code == 0, opened.last_words()


@pytest.fixture
def view(any_window, scene):
    """The window with the scene as it was, in Rendered shading, without overlays."""
    any_window.begin()
    opening = f"bpy.ops.wm.open_mainfile(filepath={str(scene('sound'))!r}, load_ui=False)"
    try:
        any_window.do(opening)
    except window.Ended as ended:
        if any_window.backend != "vulkan":
            raise
        # As it does without Lisle: see `any_window`. What a test does itself is not tried again.
        warnings.warn(f"between two tests {ended}", stacklevel=1)
        any_window.open()
        any_window.do(opening)
    any_window.do(
        "bare(); look(); space().shading.type = 'RENDERED'; space().use_render_border = False;"
        "bpy.context.scene.view_settings.view_transform = 'Standard'"
    )
    return any_window
