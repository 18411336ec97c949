"""Installs an extension from disk into this Blender's settings and enables it: `-- ARCHIVE MODULE`."""

import os
import shutil
import sys

import bpy

archive, module = sys.argv[sys.argv.index("--") + 1 :]
if "bl_pkg" not in bpy.context.preferences.addons:
    bpy.ops.preferences.addon_enable(module="bl_pkg")
bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True)
if module not in bpy.context.preferences.addons:
    print(f"{module} is not enabled after its installation", file=sys.stderr)
    os._exit(1)
bpy.ops.wm.save_userpref()
# As a module, Blender may hang at exit: leave without it, and remove what it would.
shutil.rmtree(bpy.app.tempdir, ignore_errors=True)
sys.stdout.flush()
os._exit(0)
