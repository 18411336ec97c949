# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene at other times than the present frame's: over the shutter, and one frame before and after."""

import math
from dataclasses import replace

from ..export.camera import native_camera
from ..export.scene import collect
from .job import stop_if_asked


def present(scene):
    """The frame on the clock with its part, as `frame_set` takes it: before Blender remaps time."""
    return scene.frame_current + scene.frame_subframe


def shutter_times(scene):
    """Frames at even steps over the time that the shutter is open; none without motion blur."""
    render = scene.render
    if not render.use_motion_blur or render.motion_blur_shutter <= 0:
        return []
    begin = {"START": 0.0, "CENTER": -0.5, "END": -1.0}[render.motion_blur_position]
    steps = scene.lisle.motion_steps
    now = present(scene)
    return [now + render.motion_blur_shutter * (begin + step / steps) for step in range(steps + 1)]


def at_times(lisle, engine, depsgraph, content, times, camera, size):
    """[(export.scene.Content, lisle.Camera)] of `content`, which was collected at the present frame, at other frames.

    What is not there at another time, or has other curves, stays as it is now. Evaluates the frames, and the present
    one again: references into `depsgraph` from before are invalid afterwards.
    """
    scene = depsgraph.scene
    frame, subframe = scene.frame_current, scene.frame_subframe
    found = []
    try:
        for time in times:
            stop_if_asked(engine)
            whole = math.floor(time)
            engine.frame_set(whole, time - whole)
            moved = _moved(content, collect(lisle, depsgraph, lambda _: None))
            found.append((moved, native_camera(lisle, camera, depsgraph, size)))
    finally:
        if times:
            engine.frame_set(frame, subframe)
    return found


def _moved(content, other):
    """`content` with the points and places that `other` has for the same things."""
    geometries = {}
    for key, geometry in content.geometries.items():
        there = other.geometries.get(key)
        if there is not None and there.curves.difference_from_rest(geometry.curves) is None:
            geometry = replace(geometry, curves=replace(geometry.curves, points=there.curves.points))
        geometries[key] = geometry
    places = {}
    for placement in other.placements:
        places.setdefault((placement.key, placement.identity), []).append(placement.world_from_object)
    placements = []
    for placement in content.placements:
        there = places.get((placement.key, placement.identity))
        placements.append(replace(placement, world_from_object=there.pop(0)) if there else placement)
    return replace(content, geometries=geometries, placements=placements, meshes=_moved_meshes(content, other))


def _moved_meshes(content, other):
    places = {}
    for placement in other.meshes:
        places.setdefault(placement.identity, []).append(placement)
    meshes = []
    for placement in content.meshes:
        there = places.get(placement.identity)
        if there:
            moved = there.pop(0)
            surface = moved.surface if moved.surface.corresponds(placement.surface) else placement.surface
            placement = replace(placement, world_from_object=moved.world_from_object, surface=surface)
        meshes.append(placement)
    return meshes
