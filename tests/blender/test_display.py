"""The overlay's view transform, beside what Blender saves with the same settings."""

from types import SimpleNamespace

import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.blender

SHADING = {
    "type": "RENDERED", "use_scene_lights": False, "use_scene_world": False, "use_scene_lights_render": True,
    "use_scene_world_render": True,
}  # fmt: skip


def space(**shading):
    return SimpleNamespace(shading=SimpleNamespace(**SHADING | shading))


def saved(colors, folder):
    """The display codes of (n, 3) scene-linear colours, as Blender saves them in the present scene."""
    import bpy

    scene = bpy.context.scene
    scene.render.dither_intensity = 0
    settings = scene.render.image_settings
    if bpy.app.version >= (5, 0, 0):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGB", "16"
    image = bpy.data.images.new("Card", len(colors), 1, float_buffer=True)
    image.pixels.foreach_set(np.c_[colors, np.ones(len(colors))].astype(np.float32).ravel())
    path = str(folder / "card.png")
    image.save_render(path)
    back = bpy.data.images.load(path)
    back.colorspace_settings.is_data = True
    return np.array(back.pixels[:]).reshape(-1, 4)[:, :3]


@pytest.mark.parametrize(
    "settings",
    [
        {"view_transform": "AgX"},
        {"view_transform": "AgX", "look": "AgX - Punchy", "exposure": 2.5, "gamma": 1.2},
        {"view_transform": "Filmic", "exposure": -3},
        {"view_transform": "Standard", "exposure": 1},
        {"view_transform": "AgX", "use_white_balance": True, "white_balance_temperature": 4000},
        {"view_transform": "Filmic", "use_curve_mapping": True},
    ],
    ids=["agx", "punchy", "filmic", "standard", "balance", "curves"],
)
def test_tables_show_what_blender_saves(addon, settings, tmp_path):
    import bpy
    from lisle_blender.core.display import look_up
    from lisle_blender.overlay.display import transform_of

    scene = bpy.context.scene
    for name, value in settings.items():
        setattr(scene.view_settings, name, value)
    if "use_curve_mapping" in settings:
        curve = scene.view_settings.curve_mapping.curves[3]
        curve.points.new(0.25, 0.6)
        scene.view_settings.curve_mapping.update()
    random = np.random.default_rng(1)
    colors = np.concatenate(
        ([[0.18] * 3, [0] * 3, [0.9, 0.3, 0.1]], random.random((200, 3)) ** 2, 8 * random.random((50, 3)))
    )
    before = {name: len(getattr(bpy.data, name)) for name in ("scenes", "images")}
    transform = transform_of(scene, space())
    assert before == {name: len(getattr(bpy.data, name)) for name in ("scenes", "images")}
    assert transform_of(scene, space()) is transform, "kept"
    shown = np.array([look_up(transform.codes, transform.exposure, color) for color in colors])
    expected = saved(colors, tmp_path)
    error = 255 * np.abs(shown - expected)
    assert np.median(error) < 0.5 and error.max() < 4, (np.median(error), error.max(), colors[error.max(1).argmax()])
    scene.view_settings.exposure += 0.5
    assert 255 * np.abs(saved(colors, tmp_path) - shown).max() > 8, "another exposure is not this one"


def test_a_picture_in_studio_light_keeps_the_transform_and_the_look_alone(addon):
    import bpy
    from lisle_blender.overlay.display import settings_of, transform_of

    scene = bpy.context.scene
    view = scene.view_settings
    view.view_transform, view.look, view.exposure, view.gamma = "AgX", "AgX - Punchy", 2, 1.5

    def exposure(**shading):
        settings = settings_of(scene, space(**shading))
        return None if settings is None else (settings["look"], settings["exposure"], settings["gamma"])

    studio, final = ("AgX - Punchy", 0, 1), ("AgX - Punchy", 2, 1.5)
    assert exposure(type="SOLID") is exposure(type="WIREFRAME") is None
    assert exposure(type="MATERIAL") == studio
    assert exposure(type="MATERIAL", use_scene_lights=True) == exposure(type="MATERIAL", use_scene_world=True) == final
    assert exposure() == exposure(use_scene_lights_render=False) == final
    assert exposure(use_scene_lights_render=False, use_scene_world_render=False) == studio
    scene.render.engine = "BLENDER_WORKBENCH"
    assert exposure(type="MATERIAL") == final
    scene.render.engine = "LISLE"
    view.view_transform = "Standard"
    assert transform_of(scene, space(type="MATERIAL")) is None, "it has no such look"
    assert transform_of(scene, space()) is not None
    view.exposure, view.gamma = 0, 1
    assert transform_of(scene, space()) is None


def test_all_settings_tell_transforms_apart(addon):
    import bpy
    from lisle_blender.overlay.display import settings_of

    scenes.curves("Yarn", scenes.line())
    scene, seen = bpy.context.scene, []
    view = scene.view_settings
    view.view_transform = "AgX"
    for change in (
        lambda: None,
        lambda: setattr(view, "look", "AgX - Punchy"),
        lambda: setattr(view, "exposure", 1),
        lambda: setattr(view, "gamma", 1.5),
        lambda: setattr(view, "use_white_balance", True),
        lambda: setattr(view, "white_balance_tint", 20),
        lambda: setattr(view, "use_curve_mapping", True),
        lambda: view.curve_mapping.curves[0].points.new(0.5, 0.7),
        lambda: setattr(view.curve_mapping, "white_level", (2, 2, 2)),
        lambda: setattr(view, "view_transform", "Filmic"),
    ):
        change()
        seen.append(repr(settings_of(scene, space())))
    assert len(set(seen)) == len(seen)
