# SPDX-License-Identifier: GPL-3.0-or-later
"""One view layer at one frame, from Blender's scene to the native image."""

from .. import native
from ..core.camera import border_pixels
from ..core.errors import Cancelled, LisleError, SceneError
from ..core.pixels import look_up
from ..export.camera import native_camera
from ..export.scene import collect
from ..export.world import ambient_radiance
from . import reference
from .assembly import add_objects
from .job import REST_SHAPES
from .renderer import drop, renderer


def draw(engine, depsgraph, size, note):
    """The pictures of a view layer by `Pass.image`, of `size` = (w, h) pixels: the border's size if there is one.

    Raises LisleError with a message for the user; Cancelled if the user stopped it.
    """
    lisle = native.module()
    try:
        return _draw(lisle, engine, depsgraph, size, note)
    except lisle.Cancelled as error:
        raise Cancelled from error
    except lisle.DeviceError as error:
        drop()
        raise LisleError(str(error)) from error
    except lisle.Error as error:
        raise LisleError(str(error)) from error


def _draw(lisle, engine, depsgraph, size, note):
    frame_size = engine.resolution_x, engine.resolution_y
    region = _region(depsgraph.scene.render, frame_size, size)
    scene, pass_index_of = _native_scene(lisle, engine, depsgraph, frame_size, note)
    settings, render = depsgraph.scene.lisle, depsgraph.scene.render

    def progress(fraction):
        engine.update_progress(fraction)
        return not engine.test_break()

    engine.update_stats("", "Drawing")
    options = {
        "size": frame_size,
        "region": region,
        "transparent": render.film_transparent,
        "progress": progress,
    }
    if settings.method == "REFERENCE":
        image = reference.draw(lisle, scene, settings, **options)
    else:
        if not settings.multiple_scattering:
            options["transport_photons"] = 0
        image = renderer(lisle).render(
            scene,
            samples=settings.samples,
            shading=settings.shading,
            occlusion=settings.occlusion,
            lod_pixels=settings.lod,
            seed=settings.seed,
            **options,
        )
    pictures = {name: image[name] for name in image}
    if depsgraph.view_layer.use_pass_object_index:
        pictures["pass_index"] = look_up(image["object_id"], pass_index_of)
    return pictures


def _region(render, frame_size, size):
    """The border in pixels, or None for the whole frame."""
    if not render.use_border:
        return None
    border = (render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y)
    x0, y0, x1, y1 = border_pixels(border, frame_size)
    if (x1 - x0, y1 - y0) != size:
        raise SceneError(f"The render border of {size[0]} x {size[1]} pixels is not at {(x0, y0, x1, y1)} as expected")
    return x0, y0, x1, y1


def _native_scene(lisle, engine, depsgraph, frame_size, note):
    """The lisle.Scene, and Blender's object index by object id."""
    if depsgraph.scene.render.use_multiview:
        raise SceneError("Stereoscopy is not supported: turn it off in the output properties")
    engine.update_stats("", "Reading curves")
    content = collect(lisle, depsgraph, note)
    if not content.placements:
        note("the view layer shows no curves")
    at_rest = REST_SHAPES.find(lisle, engine, depsgraph, content)
    camera = engine.camera_override or depsgraph.scene.camera
    scene = lisle.Scene(
        camera=native_camera(lisle, camera, depsgraph, frame_size),
        lights=content.lights,
        ambient=ambient_radiance(depsgraph.scene.world, note),
    )
    return scene, add_objects(lisle, scene, content, at_rest, REST_SHAPES)
