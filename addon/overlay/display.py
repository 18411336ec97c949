# SPDX-License-Identifier: GPL-3.0-or-later
"""The view transform of a viewport. Blender gives it to the scene's picture, not to what is drawn over that."""

import tempfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..core import display

_NEUTRAL = {"exposure": 0.0, "gamma": 1.0, "look": "None"}
_MOST_KEPT = 4

_kept = {}
"""Transform by its settings."""


@dataclass(frozen=True, eq=False)
class Transform:
    """From scene-linear colours to display codes."""

    codes: np.ndarray
    """Of the lattice in core.display."""
    exposure: float


def transform_of(scene, space):
    """The Transform of a viewport's picture, None for the display's own curve (the view transform Standard)."""
    settings = settings_of(scene, space)
    if settings is None:
        return None
    key = repr(settings)
    if key not in _kept:
        while len(_kept) >= _MOST_KEPT:
            del _kept[next(iter(_kept))]
        _kept[key] = Transform(_codes(settings), settings["exposure"])
    return _kept[key]


def forget():
    """Drops all tables."""
    _kept.clear()


def settings_of(scene, space):
    """What tells transforms apart, by names of Blender's view settings; None as above.

    As Blender has it: Solid and Wireframe show the display's own curve; a picture in the light of the scene has all of
    the scene's settings; one in the light of a studio its view transform and look.
    """
    shading, view = space.shading, scene.view_settings
    if shading.type not in {"MATERIAL", "RENDERED"}:
        return None
    is_final = shading.type == "RENDERED"
    all_of_them = (
        scene.render.engine == "BLENDER_WORKBENCH"
        or (shading.use_scene_lights_render if is_final else shading.use_scene_lights)
        or (shading.use_scene_world_render if is_final else shading.use_scene_world)
    )
    settings = {"display_device": scene.display_settings.display_device, "view_transform": view.view_transform}
    settings |= _NEUTRAL | {"look": view.look}
    if all_of_them:
        settings |= {"exposure": view.exposure, "gamma": view.gamma}
        if view.use_white_balance:
            names = ("white_balance_temperature", "white_balance_tint")
            settings |= {"use_white_balance": True} | {name: getattr(view, name) for name in names}
        if view.use_curve_mapping:
            settings["curves"] = _curves(view.curve_mapping)
    is_plain = settings["view_transform"] == "Standard" and settings["display_device"] == "sRGB"
    rest = {name: value for name, value in settings.items() if name not in {"view_transform", "display_device"}}
    return None if is_plain and rest == _NEUTRAL else settings


def _curves(mapping):
    """All that a curve mapping does."""
    return {
        "black_level": tuple(mapping.black_level),
        "white_level": tuple(mapping.white_level),
        "tone": mapping.tone,
        "extend": mapping.extend,
        "points": tuple(
            tuple((*point.location, point.handle_type) for point in curve.points) for curve in mapping.curves
        ),
    }


def _set_curves(mapping, curves):
    for name in ("black_level", "white_level", "tone", "extend"):
        setattr(mapping, name, curves[name])
    for curve, points in zip(mapping.curves, curves["points"], strict=True):
        while len(curve.points) < len(points):
            curve.points.new(0.5, 0.5)
        while len(curve.points) > len(points):
            curve.points.remove(curve.points[1])
        for point, (x, y, handle) in zip(curve.points, points, strict=True):
            point.location, point.handle_type = (x, y), handle
    mapping.update()


def _codes(settings):
    """Display codes of the lattice: Blender saves it as a picture of these settings, in data of its own."""
    colors = display.lattice(settings["exposure"])
    with bpy.data.temp_data() as data, tempfile.TemporaryDirectory(dir=bpy.app.tempdir or None) as folder:
        scene = data.scenes.new("Display")
        scene.display_settings.display_device = settings["display_device"]
        view = scene.view_settings
        for name, value in settings.items():
            if name not in {"display_device", "curves"}:
                setattr(view, name, value)
        if "curves" in settings:
            view.use_curve_mapping = True
            _set_curves(view.curve_mapping, settings["curves"])
        file = scene.render.image_settings
        if bpy.app.version >= (5, 0, 0):
            file.media_type = "IMAGE"
        file.file_format, file.color_mode, file.color_depth, file.compression = "PNG", "RGB", "16", 0
        scene.render.dither_intensity = 0
        size = (display.SIZE**2, display.SIZE)
        image = data.images.new("Display", *size, float_buffer=True, alpha=False)
        with suppress(TypeError):  # not all configurations have it
            image.colorspace_settings.name = "scene_linear"
        image.pixels.foreach_set(np.c_[colors, np.ones(len(colors), np.float32)].ravel())
        path = Path(folder) / "display.png"
        image.save_render(str(path), scene=scene)
        saved = data.images.load(str(path))
        saved.colorspace_settings.is_data = True
        codes = np.empty(4 * len(colors), np.float32)
        saved.pixels.foreach_get(codes)
    return codes.reshape(-1, 4)[:, :3]
