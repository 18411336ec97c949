"""The built extension in a Blender that has never seen it: installed, enabled, drawn with, removed.

`LISLE_PACKAGE` is the archive that packaging built for this platform.
"""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

SETTINGS = """
import os, sys
import bpy
import numpy as np

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.preferences.addon_enable(module="bl_pkg")
assert not hasattr(bpy.types.Scene, "lisle")

def install(archive):
    assert bpy.ops.extensions.package_install_files(
        repo="user_default", filepath=archive, enable_on_install=True) == {{"FINISHED"}}
    assert hasattr(bpy.types.Scene, "lisle")

def uninstall():
    repositories = [repository.module for repository in bpy.context.preferences.extensions.repos]
    bpy.ops.extensions.package_uninstall(repo_index=repositories.index("user_default"), pkg_id="lisle_blender")
    assert not hasattr(bpy.types.Scene, "lisle")

def versions():
    "Of the extension and of the wheels that are installed."
    import tomllib
    from pathlib import Path
    user = Path({user!r})
    manifests = [tomllib.loads(path.read_text()) for path in user.rglob("lisle_blender/blender_manifest.toml")]
    wheels = [path.name.split("-")[1].removesuffix(".dist") for path in user.rglob("lisle-*.dist-info")]
    return [manifest["version"] for manifest in manifests], wheels
"""

LIFE = (
    SETTINGS
    + """
install({package!r})
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

install({package!r})  # an upgrade over itself, while loaded
uninstall()
print("end of life")
sys.stdout.flush()
os._exit(0)
"""
)


UPGRADE = (
    SETTINGS
    + """
install({older!r})
assert versions() == (["0.0.1"], ["0.0.1"]), versions()
import lisle
scene = bpy.context.scene
scene.render.engine = "LISLE"
scene.lisle.samples = 3
material = bpy.data.materials.new("Wool")
material.lisle.yarn.preset = "silk-2"
install({package!r})
(version,), wheels = versions()
assert version != "0.0.1" and wheels == [version], versions()
assert (scene.render.engine, scene.lisle.samples, material.lisle.yarn.preset) == ("LISLE", 3, "silk-2")
assert len([name for name in sys.modules if name.endswith("lisle_blender")]) == 1
lisle.Yarn.preset("cotton-1")  # what is loaded still works
uninstall()
assert versions() == ([], []), versions()
print("end of life")
sys.stdout.flush()
os._exit(0)
"""
)


def older(archive, folder):
    """The same extension and wheel as if of version 0.0.1."""
    made = folder / "older.zip"
    with zipfile.ZipFile(archive) as source, zipfile.ZipFile(made, "w") as target:
        for name in source.namelist():
            data = source.read(name)
            if name.endswith(".whl"):
                old = Path(name).name
                version = old.split("-")[1]
                data = _renamed_wheel(data, version, folder)
                name = name.replace(version, "0.0.1")
            elif name == "blender_manifest.toml":
                lines = data.decode().splitlines()
                version = next(line for line in lines if line.startswith("version = ")).split('"')[1]
                data = data.replace(version.encode(), b"0.0.1")
            target.writestr(name, data)
    return made


def _renamed_wheel(data, version, folder):
    wheel, made = folder / "new.whl", folder / "old.whl"
    wheel.write_bytes(data)
    with zipfile.ZipFile(wheel) as source, zipfile.ZipFile(made, "w") as target:
        for name in source.namelist():
            content = source.read(name)
            if ".dist-info/" in name:
                content = content.replace(version.encode(), b"0.0.1")
            target.writestr(name.replace(f"lisle-{version}.dist-info", "lisle-0.0.1.dist-info"), content)
    return made.read_bytes()


def run(script, tmp_path, **paths):
    package = os.environ.get("LISLE_PACKAGE")
    if not package:
        pytest.skip("no package: set LISLE_PACKAGE to the built extension")
    user = tmp_path / "user"
    user.mkdir()
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment["BLENDER_USER_RESOURCES"] = environment["TMPDIR"] = str(user)
    paths = {name: str(make(package)) for name, make in paths.items()}
    script = script.format(package=os.path.abspath(package), user=str(user), **paths)
    result = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, env=environment, check=False, timeout=300
    )
    assert result.returncode == 0 and "end of life" in result.stdout, result.stdout + result.stderr
    return user


def test_installs_draws_and_uninstalls(tmp_path):
    picture = tmp_path / "picture.png"
    user = run(LIFE, tmp_path, picture=lambda _: picture)
    assert picture.stat().st_size > 0
    assert not list(user.rglob("lisle*"))


def test_upgrades_over_an_older_version_while_loaded(tmp_path):
    run(UPGRADE, tmp_path, older=lambda package: older(package, tmp_path))
