# SPDX-License-Identifier: GPL-3.0-or-later
"""One view layer at one frame, from Blender's scene to the native image."""

from dataclasses import dataclass

import numpy as np

from .. import native
from ..core.camera import border_pixels
from ..core.errors import Cancelled, LisleError, SceneError
from ..core.pixels import look_up
from ..export.camera import native_camera
from ..export.scene import collect
from ..export.world import read_world
from . import reference
from .assembly import add_objects
from .job import REST_SHAPES, SURFACES, stop_if_asked
from .motion import at_times, present, shutter_times
from .passes import wanted_passes
from .renderer import drop, renderer


def draw(engine, depsgraph, size, note):
    """The pictures of a view layer by `Pass.image`, of `size` = (w, h) pixels: the border's size if there is one. And
    metadata of its Cryptomattes, text by name.

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
    wanted = wanted_passes(depsgraph.view_layer)
    settings, render = depsgraph.scene.lisle, depsgraph.scene.render
    if render.threads_mode == "FIXED":
        lisle.set_threads(render.threads)  # of no effect once there was any work in this process
    shot = _native_shot(lisle, engine, depsgraph, frame_size, note, "vector" in wanted)

    shown = None

    def progress(fraction):
        """Asked again and again, also where nothing is new."""
        nonlocal shown
        if fraction != shown:
            shown = fraction
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
        if any(name in wanted for name in lisle.FURTHER_PASSES):
            note("the path tracer leaves passes black that only the renderer draws")
        image = reference.draw(lisle, shot.steps or shot.scene, settings, **options)
    else:
        if not settings.multiple_scattering:
            options["transport_photons"] = 0
        if shot.neighbours:
            options["before"], options["after"] = shot.neighbours
        image = renderer(lisle).render(
            shot.steps or shot.scene,
            passes=[n for n in lisle.FURTHER_PASSES if n in wanted and (n != "vector" or shot.neighbours)],
            samples=settings.samples,
            shading=settings.shading,
            occlusion=settings.occlusion,
            lod_pixels=settings.lod,
            seed=settings.seed,
            filter=settings.filter,
            filter_width=settings.filter_width,
            noise_threshold=settings.noise_threshold if settings.use_noise_threshold else 0.0,
            time_limit_s=settings.time_limit or None,
            **options,
        )
    black = np.zeros((size[1], size[0], 1), np.float32)
    pictures = dict.fromkeys(lisle.FURTHER_PASSES, black) | {name: image[name] for name in image}
    if "pass_index" in wanted:
        pictures["pass_index"] = look_up(image["object_id"], shot.pass_index_of)
    return pictures, image.cryptomatte_metadata(f"{depsgraph.view_layer.name}.")


def _region(render, frame_size, size):
    """The border in pixels, or None for the whole frame."""
    if not render.use_border:
        return None
    border = (render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y)
    x0, y0, x1, y1 = border_pixels(border, frame_size)
    if (x1 - x0, y1 - y0) != size:
        raise SceneError(f"The render border of {size[0]} x {size[1]} pixels is not at {(x0, y0, x1, y1)} as expected")
    return x0, y0, x1, y1


@dataclass
class _Shot:
    """What a picture is drawn from."""

    scene: object
    """lisle.Scene at the present frame."""
    steps: list
    """The same at even steps over the time that the shutter is open; empty without motion blur."""
    neighbours: list
    """The same one frame before and one after, for the vector pass; empty without it."""
    pass_index_of: dict
    """Blender's object index by object id."""


def _native_shot(lisle, engine, depsgraph, frame_size, note, with_neighbours):
    if depsgraph.scene.render.use_multiview:
        raise SceneError("Stereoscopy is not supported: turn it off in the output properties")
    engine.update_stats("", "Reading curves")
    content = collect(lisle, depsgraph, note)
    if not (content.placements or content.meshes):
        note("the view layer shows neither curves nor meshes")
    stop_if_asked(engine)
    at_rest = REST_SHAPES.find(lisle, engine, depsgraph, content)
    stop_if_asked(engine)
    camera = engine.camera_override or depsgraph.scene.camera
    world = read_world(lisle, depsgraph.scene.world, note)

    def scene_of(moved, seen_from):
        scene = lisle.Scene(
            camera=seen_from, lights=content.lights, ambient=world.ambient, environment=world.environment
        )
        return scene, add_objects(lisle, scene, moved, at_rest, REST_SHAPES, note)

    scene, pass_index_of = scene_of(content, native_camera(lisle, camera, depsgraph, frame_size))
    scene.meshes, of_meshes = SURFACES.meshes(lisle, content.meshes, pass_index_of)
    pass_index_of |= of_meshes
    shutter, now = shutter_times(depsgraph.scene), present(depsgraph.scene)
    if shutter and with_neighbours:
        note("the pass Vector is black, because there is motion blur")
    around = [now - 1, now + 1] if with_neighbours and not shutter else []
    moved = at_times(lisle, engine, depsgraph, content, shutter or around, camera.original, frame_size)
    others = [scene_of(*moment)[0] for moment in moved]
    if scene.meshes:
        for other, (there, _) in zip(others, moved, strict=True):
            other.meshes = SURFACES.moved(lisle, scene.meshes, content.meshes, there.meshes)
    if shutter and depsgraph.scene.lisle.method == "REFERENCE":
        places = [mesh.order() for mesh in content.meshes]
        if any([mesh.order() for mesh in there.meshes] != places for there, _ in moved):
            note("the path tracer does not blur meshes by motion")
    return _Shot(scene, others if shutter else [], others if around else [], pass_index_of)
