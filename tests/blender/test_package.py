"""The built extension in a Blender that has never seen it: installed, enabled, drawn with, removed.

`LISLE_PACKAGE` is the archive that packaging built for this platform.
"""

import os
import subprocess
import sys

import pytest

LIFE = """
import os, sys
import bpy
import numpy as np

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.preferences.addon_enable(module="bl_pkg")
assert not hasattr(bpy.types.Scene, "lisle")
install = dict(repo="user_default", filepath={package!r}, enable_on_install=True)
assert bpy.ops.extensions.package_install_files(**install) == {{"FINISHED"}}

import lisle
assert lisle.__file__.startswith({user!r}), lisle.__file__
scene = bpy.context.scene
data = bpy.data.hair_curves.new("Yarn")
data.add_curves([20])
data.position_data.foreach_set("vector", np.linspace((-3, 0, 0), (3, 0, 0), 20, dtype=np.float32).ravel())
data.attributes.new("radius", "FLOAT", "POINT").data.foreach_set("value", np.full(20, 0.5, np.float32))
for obj in (
    bpy.data.objects.new("Yarn", data),
    bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")),
    bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")),
):
    scene.collection.objects.link(obj)
scene.camera = bpy.data.objects["Camera"]
scene.camera.location.z = 10
scene.render.engine = "LISLE"
scene.render.resolution_x, scene.render.resolution_y = 64, 48
scene.lisle.samples = 1
scene.render.filepath = {picture!r}
scene.render.image_settings.file_format = "PNG"
bpy.ops.render.render(write_still=True)

repositories = [repository.module for repository in bpy.context.preferences.extensions.repos]
bpy.ops.extensions.package_install_files(**install)  # an upgrade over itself, while loaded
assert hasattr(bpy.types.Scene, "lisle")
bpy.ops.extensions.package_uninstall(repo_index=repositories.index("user_default"), pkg_id="lisle_blender")
assert not hasattr(bpy.types.Scene, "lisle")
print("end of life")
sys.stdout.flush()
os._exit(0)
"""


def test_installs_draws_and_uninstalls(tmp_path):
    package = os.environ.get("LISLE_PACKAGE")
    if not package:
        pytest.skip("no package: set LISLE_PACKAGE to the built extension")
    user, picture = tmp_path / "user", tmp_path / "picture.png"
    user.mkdir()
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment["BLENDER_USER_RESOURCES"] = environment["TMPDIR"] = str(user)
    script = LIFE.format(package=os.path.abspath(package), user=str(user), picture=str(picture))
    result = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, env=environment, check=False, timeout=300
    )
    assert result.returncode == 0 and "end of life" in result.stdout, result.stdout + result.stderr
    assert picture.stat().st_size > 0
