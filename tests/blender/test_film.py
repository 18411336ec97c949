"""Motion blur, passes and colour, as Blender's own settings ask for them."""

import json
import struct

import exr
import numpy as np
import pytest
import scenes
from test_rest import stretching
from test_wheel import lit_yarns

pytestmark = pytest.mark.blender

WHEEL = pytest.mark.blender("wheel")


def render(lisle):
    """What the renderer is given for the present frame, and its settings."""
    import bpy

    bpy.ops.render.render()
    return lisle.scenes[-1]


def use_motion_blur(shutter=0.5, position="CENTER", steps=2):
    import bpy

    scene = bpy.context.scene
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter, scene.render.motion_blur_position = shutter, position
    scene.lisle.motion_steps = steps


@pytest.mark.parametrize(("position", "begin", "end"), [("START", 3.0, 3.5), ("CENTER", 2.75, 3.25), ("END", 2.5, 3.0)])
def test_the_shutter_is_open_when_blender_says(lisle, position, begin, end):
    import bpy

    scene = bpy.context.scene
    stretching()
    moving = scenes.curves("Moving", scenes.line())
    scenes.keyframes(moving, "location", {0: (0, 0, 0), 10: (10, 0, 0)})
    scenes.keyframes(scene.camera, "location", {0: (0, 0, 10), 10: (0, 10, 10)})
    for owner in (moving, scene.camera):
        make_linear(owner)
    scene.frame_set(3)
    use_motion_blur(0.5, position, steps=4)
    steps, _ = render(lisle)
    assert len(steps) == 5
    for step, time in zip(steps, np.linspace(begin, end, 5), strict=True):
        stretched = max(entry.yarns.points[0, 0] for entry in step.entries)
        longest = min(entry.yarns.points[0, 0] for entry in step.entries)
        assert {entry.name for entry in step.entries} == {"Yarn", "Moving"}
        by_name = {entry.name: entry for entry in step.entries}
        assert by_name["Moving"].transform[0, 3] == pytest.approx(time, abs=1e-4)
        assert step.camera.world_from_camera[1, 3] == pytest.approx(time, abs=1e-4)
        assert min(stretched, longest) == pytest.approx(-3 * (1 + time / 10), abs=1e-4)
        assert by_name["Yarn"].yarns.rest_points[0, 0] == pytest.approx(-3 * 1.1, abs=1e-4)
    assert (scene.frame_current, scene.frame_subframe) == (3, 0)
    scene.render.use_motion_blur = False
    still, _ = render(lisle)
    assert not isinstance(still, list)


def make_linear(owner):
    """Keyframes without easing, in every version of Blender."""
    action = owner.animation_data.action
    curves = action.fcurves if hasattr(action, "fcurves") else action.layers[0].strips[0].channelbags[0].fcurves
    for curve in curves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def test_what_is_not_there_all_the_time_stands_still(lisle):
    import bpy
    from test_rest import growing

    growing().lisle.remeasure = True
    bpy.context.scene.frame_set(3)
    use_motion_blur(2.0)
    steps, _ = render(lisle)
    assert {len(step.entries[0].yarns.points) for step in steps} == {5}


def test_an_error_in_a_subframe_leaves_the_frame_as_it_was(lisle):
    import bpy

    scene = bpy.context.scene
    scenes.curves("Yarn", scenes.line())
    use_motion_blur()
    scene.frame_set(2)
    camera = scene.camera
    camera.data.keyframe_insert("type", frame=2)
    camera.data.type = "PANO"
    camera.data.keyframe_insert("type", frame=1)
    scene.frame_set(2)
    with pytest.raises(RuntimeError, match="PANO"):
        bpy.ops.render.render()
    assert (scene.frame_current, scene.frame_subframe) == (2, 0)


@pytest.mark.parametrize("shutter", [0.5, None])
def test_remapped_time_is_remapped_once(lisle, shutter):
    """Frame 3 shows what is keyed at 1.5; the shutter and the frames around it are on the clock's side."""
    import bpy

    scene = bpy.context.scene
    moving = scenes.curves("Moving", scenes.line())
    scenes.keyframes(moving, "location", {0: (0, 0, 0), 10: (10, 0, 0)})
    make_linear(moving)
    scene.render.frame_map_old, scene.render.frame_map_new = 100, 200
    scene.frame_set(3)
    if shutter is None:
        bpy.context.view_layer.use_pass_vector = True
        _, settings = render(lisle)
        found, expected = [settings["before"], settings["after"]], (1.0, 2.0)
    else:
        use_motion_blur(shutter)
        found, expected = render(lisle)[0], (1.375, 1.5, 1.625)
    places = [step.entries[0].transform[0, 3] for step in found]
    np.testing.assert_allclose(places, expected, atol=1e-5)


def test_vectors_see_the_frames_before_and_after(lisle):
    import bpy

    scene = bpy.context.scene
    stretching()
    scene.frame_set(3)
    bpy.context.view_layer.use_pass_vector = True
    _, settings = render(lisle)
    ends = [settings[name].entries[0].yarns.points[0, 0] for name in ("before", "after")]
    np.testing.assert_allclose(ends, (-3 * 1.2, -3 * 1.4), rtol=1e-5)
    use_motion_blur()
    _, settings = render(lisle)
    assert "before" not in settings


LIGHT = ("diffuse", "specular", "transmission", "scattered", "ambient", "shadow")


def use_all_passes(layer):
    for name in ("z", "position", "normal", "vector", "uv", "object_index", "material_index", "cryptomatte_object"):
        setattr(layer, f"use_pass_{name}", True)
    layer.use_pass_cryptomatte_material = True
    layer.pass_cryptomatte_depth = 4
    for name in (*LIGHT, "denoising", "tangent", "coverage"):
        setattr(layer.lisle, f"use_pass_{name}", True)


def test_passes_have_the_sockets_of_other_engines(lisle):
    import bpy

    scene, layer = bpy.context.scene, bpy.context.view_layer
    if bpy.app.version >= (5, 0, 0):
        tree = scene.compositing_node_group = bpy.data.node_groups.new("Compositor", "CompositorNodeTree")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
    node = tree.nodes.new("CompositorNodeRLayers")
    use_all_passes(layer)
    ours = {socket.name for socket in node.outputs if socket.enabled}
    scene.render.engine, scene.cycles.use_denoising = "CYCLES", False
    layer.update_render_passes()
    theirs = {socket.name for socket in node.outputs if socket.enabled}
    assert "Vector" in theirs and "CryptoMaterial01" in theirs
    assert theirs <= ours, theirs - ours
    extra = {"Denoising Albedo", "Denoising Normal", *(name.title() for name in LIGHT), "Tangent", "Coverage"}
    assert extra <= ours
    assert "CryptoObject02" not in ours
    scene.render.engine, layer.pass_cryptomatte_depth = "LISLE", 16
    ours = {socket.name for socket in node.outputs if socket.enabled}
    assert "CryptoObject02" in ours and "CryptoObject03" not in ours


@WHEEL
def test_three_view_layers_with_all_passes(lisle, tmp_path):
    import bpy

    scene, first = bpy.context.scene, bpy.context.view_layer
    lit_yarns()
    for number, name in enumerate(("Upper", "Lower"), 1):
        obj = bpy.data.objects[name]
        obj.pass_index = number
        material = bpy.data.materials.new(f"{name} wool")
        material.pass_index = 10 * number
        obj.data.materials.append(material)
    second, third = scene.view_layers.new("Second"), scene.view_layers.new("Third")
    use_all_passes(first)
    use_all_passes(second)
    third.use_pass_z = True
    path = tmp_path / "a.exr"
    channels = scenes.render_channels(path, multilayer=True)

    def layer(of, name, letters):
        return np.stack([channels[f"{of.name}.{name}.{letter}"] for letter in letters], axis=-1)

    combined = layer(first, "Combined", "RGBA")
    parts = sum(layer(first, name.title(), "RGB") for name in LIGHT[:-1])
    np.testing.assert_allclose(parts, combined[..., :3], atol=1e-5, rtol=1e-5)
    is_there = channels["ViewLayer.Depth.Z"] < 1e9
    position = layer(first, "Position", "XYZ")
    rows = (3 - (np.arange(48) + 0.5) / 8)[:, None] * np.ones(64)
    assert np.abs(position[..., 1] - rows)[is_there].max() < 0.13
    np.testing.assert_allclose(10 - position[..., 2][is_there], channels["ViewLayer.Depth.Z"][is_there], atol=1e-3)
    uv = layer(first, "UV", "UV")
    columns = ((np.arange(64) + 0.5) / 8 - 4)[None, :] * np.ones((48, 1))
    assert np.abs(uv[..., 0] - (columns + 5))[is_there].max() < 0.4
    named = bpy.app.version >= (5, 0, 0)
    objects = channels[f"ViewLayer.{'Object Index' if named else 'IndexOB'}.X"]
    materials = channels[f"ViewLayer.{'Material Index' if named else 'IndexMA'}.X"]
    np.testing.assert_array_equal(materials, 10 * objects)
    assert set(np.unique(objects)) == {0, 1, 2}
    assert not layer(first, "Vector", "XYZW").any()
    for name in ("Denoising Albedo.R", "Denoising Normal.Z", "Shadow.X"):
        assert np.isfinite(channels[f"ViewLayer.{name}"]).all() and channels[f"ViewLayer.{name}"].any()
    for name in [name for name in channels if name.startswith("ViewLayer.")]:
        twin = channels[name.replace("ViewLayer", "Second")]
        np.testing.assert_array_equal(channels[name], twin, err_msg=name)
    assert "Third.Depth.Z" in channels and "Third.Position.X" not in channels

    # Coverage by name, as another program finds it: by the metadata.
    said = {}
    for key, value in exr.read_attributes(path).items():
        if key.startswith("cryptomatte/"):
            said.setdefault(key.split("/")[1], {})[key.split("/")[2]] = value.decode()
    layers = {entry["name"]: entry for entry in said.values()}
    assert {"ViewLayer.CryptoObject", "ViewLayer.CryptoMaterial", "Second.CryptoObject"} <= layers.keys()
    for crypto, name, number in (("CryptoObject", "Upper", 1), ("CryptoMaterial", "Lower wool", 2)):
        entry = layers[f"ViewLayer.{crypto}"]
        assert (entry["hash"], entry["conversion"]) == ("MurmurHash3_32", "uint32_to_float32")
        number_of = int(json.loads(entry["manifest"])[name], 16)
        ident = struct.unpack("<f", struct.pack("<I", number_of))[0]
        pairs = np.concatenate([layer(first, f"{crypto}{rank:02}", "rgba") for rank in (0, 1)], axis=-1)
        coverage = np.where(pairs[..., 0::2] == np.float32(ident), pairs[..., 1::2], 0).sum(axis=-1)
        assert (coverage[objects == number] > 0).all()
        assert coverage.sum() == pytest.approx(combined[..., 3][rows * (3 - 2 * number) > 0].sum(), rel=0.02)


@WHEEL
def test_motion_blur_smears_and_a_frame_alone_is_that_of_the_sequence(lisle, tmp_path):
    import bpy
    from test_rest import frame_channels

    scene = bpy.context.scene
    yarn = scenes.curves("Yarn", scenes.line(30, (0, -5, 0), (0, 5, 0)), radius=0.2)
    scenes.keyframes(yarn, "location", {0: (-4, 0, 0), 8: (4, 0, 0)})
    make_linear(yarn)
    scene.lisle.samples = 16
    use_motion_blur(1.0)
    (tmp_path / "alone").mkdir()
    scene.frame_start, scene.frame_end = 2, 4
    sequence = frame_channels(tmp_path, [2, 3, 4])
    alone = frame_channels(tmp_path / "alone", [4], animation=False)
    for name, picture in alone[4].items():
        np.testing.assert_array_equal(picture, sequence[4][name], err_msg=name)
    alpha = alone[4]["A"].mean(axis=0)
    covered = np.flatnonzero(alpha > 0.02)
    # A metre to either side of its place is half a metre of yarn and half a metre of way.
    assert covered[0] == pytest.approx(32 - 8 * 0.7, abs=2) and covered[-1] == pytest.approx(32 + 8 * 0.7, abs=2)
    scene.render.use_motion_blur = False
    sharp = frame_channels(tmp_path / "alone", [4], animation=False)[4]["A"].mean(axis=0)
    # The filter alone makes a narrow yarn 3 % wider or narrower, by where in a pixel it lies.
    assert alpha.sum() == pytest.approx(sharp.sum(), rel=0.06) and (sharp > 0.02).sum() < 0.6 * len(covered)


@WHEEL
def test_depth_of_field_blurs_the_picture(lisle, tmp_path):
    import bpy

    lit_yarns(0.1)
    camera = bpy.context.scene.camera
    camera.data.type, camera.data.lens, camera.location.z = "PERSP", 50, 12
    bpy.context.scene.lisle.samples = 32

    def edge():
        return np.abs(np.diff(scenes.render_rgba(tmp_path / "a.exr")[..., 3], axis=0)).max(axis=0).mean()

    dof = camera.data.dof
    sharp = edge()
    dof.use_dof, dof.aperture_fstop, dof.focus_distance = True, 0.02, 12
    assert edge() > 0.9 * sharp
    dof.focus_distance = 4
    assert edge() < 0.6 * sharp


@WHEEL
def test_a_grey_card_is_that_of_cycles(lisle, tmp_path):
    """What is behind everything, 18 % grey: the same numbers in a linear file, and after the view transform."""
    import bpy

    scene = bpy.context.scene
    world = scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    world.node_tree.get_output_node("ALL").inputs["Surface"].links[0].from_node.inputs["Color"].default_value = (
        0.18, 0.18, 0.18, 1,
    )  # fmt: skip
    scene.render.film_transparent = False
    scene.cycles.samples, scene.cycles.use_denoising = 1, False

    def pictures(engine):
        scene.render.engine = engine
        linear = scenes.render_rgba(tmp_path / "a.exr")
        settings = scene.render.image_settings
        settings.file_format, settings.color_depth = "PNG", "16"
        scene.render.filepath = str(tmp_path / "a.png")
        bpy.ops.render.render(write_still=True)
        shown = bpy.data.images.load(str(tmp_path / "a.png"), check_existing=False)
        shown.colorspace_settings.name = "Non-Color"
        return linear, np.array(shown.pixels[:])

    ours, theirs = pictures("LISLE"), pictures("CYCLES")
    np.testing.assert_allclose(ours[0], theirs[0], rtol=1e-6)
    np.testing.assert_allclose(ours[1], theirs[1], atol=1 / 65535)
    assert ours[0][0, 0, 0] == pytest.approx(0.18) and 0.2 < ours[1][0] < 0.6


def test_meshes_move_while_the_shutter_is_open(lisle):
    import bpy
    from test_meshes import cube

    scenes.curves("Yarn", scenes.line())
    moving, bending, other = (cube(name) for name in ("Moving", "Bending", "Other"))
    scenes.keyframes(moving, "location", {0: (0, 0, 0), 10: (10, 0, 0)})
    make_linear(moving)
    bending.shape_key_add(name="Basis")
    key = bending.shape_key_add(name="Bent")
    key.data[0].co.x += 10
    scenes.keyframes(key, "value", {0: 0.0, 10: 1.0})
    make_linear(bending.data.shape_keys)
    subdivision = other.modifiers.new("Subdivision", "SUBSURF")
    for frame, levels in ((3, 0), (4, 1)):
        subdivision.render_levels = levels
        subdivision.keyframe_insert("render_levels", frame=frame)
    bpy.context.scene.frame_set(3)
    use_motion_blur(1.0, "START", steps=2)
    steps, _ = render(lisle)
    by_name = [{mesh.name: mesh for mesh in step.meshes} for step in steps]
    assert [mesh["Moving"].world_from_object[0, 3] for mesh in by_name] == pytest.approx([3, 3.5, 4], abs=1e-4)
    corners = [mesh["Bending"].positions[0, 0] for mesh in by_name]
    assert np.diff(corners) == pytest.approx([0.5, 0.5], abs=1e-3)
    assert by_name[0]["Moving"].triangles is by_name[2]["Moving"].triangles
    assert [len(mesh["Other"].corners) for mesh in by_name] == [12] * 3, "one of more triangles is not the same, moved"
    assert [[mesh.object_id for mesh in step.meshes] for step in steps] == [[m.object_id for m in steps[0].meshes]] * 3
