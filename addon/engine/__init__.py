# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: when Blender asks for a picture, and what it gets. Imports `export` and `core`."""

import bpy

from . import job, painting, renderer
from .engine import LisleRenderEngine


def register():
    bpy.utils.register_class(LisleRenderEngine)
    job.register()
    painting.register()


def unregister():
    painting.unregister()
    job.unregister()
    bpy.utils.unregister_class(LisleRenderEngine)
    renderer.drop()
