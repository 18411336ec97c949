"""Pictures on meshes, as they reach the native module."""

import numpy as np
import pytest
from test_meshes import cube, drawn, material

pytestmark = pytest.mark.blender

CODES = np.array([[(255, 0, 0), (0, 255, 0)], [(0, 0, 128), (64, 64, 64)]], np.uint8)
"""Row 0 at the top."""


def image(name="Check", space="sRGB", is_float=False):
    import bpy

    made = bpy.data.images.new(name, 2, 2, float_buffer=is_float)
    made.colorspace_settings.name = space
    values = CODES[::-1] / 255
    made.pixels.foreach_set(np.concatenate((values, np.ones((2, 2, 1))), axis=2).astype(np.float32).ravel())
    made.update()
    return made


def checked(source=None):
    """A cube with a picture on it, the node, and its tree."""
    made = material("Checked", (1, 1, 1, 1), viewport=(0.1, 0.2, 0.3, 1))
    tree = made.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = source or image()
    principled = tree.get_output_node("ALL").inputs["Surface"].links[0].from_node
    tree.links.new(node.outputs["Color"], principled.inputs["Base Color"])
    obj = cube(materials=(made,))
    for number, name in enumerate(("First", "Second")):
        layer = obj.data.uv_layers.new(name=name)
        places = np.random.default_rng(number).random(2 * len(obj.data.loops)).astype(np.float32)
        layer.uv.foreach_set("vector", places)
    obj.data.uv_layers["Second"].active_render = True
    return obj, node, tree


def places(obj, name):
    """(loops, 2)"""
    values = np.empty(2 * len(obj.data.loops), np.float32)
    obj.data.uv_layers[name].uv.foreach_get("vector", values)
    return values.reshape(-1, 2)


def collected(lisle):
    import bpy
    from lisle_blender.export.scene import collect

    bpy.context.view_layer.update()
    notes = []
    return collect(lisle, bpy.context.evaluated_depsgraph_get(), notes.append), notes


def test_the_picture_of_a_base_colour_comes_by_the_map_that_renders(lisle):
    obj, node, tree = checked()
    (mesh,) = drawn(lisle)
    np.testing.assert_array_equal(mesh.texture.codes, CODES)
    obj.data.calc_loop_triangles()
    loops = [list(triangle.loops) for triangle in obj.data.loop_triangles]
    np.testing.assert_array_equal(mesh.uvs, places(obj, "Second")[loops])
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["UV"], node.inputs["Vector"])
    np.testing.assert_array_equal(drawn(lisle)[0].uvs, mesh.uvs)
    named = tree.nodes.new("ShaderNodeUVMap")
    named.uv_map = "First"
    tree.links.new(named.outputs["UV"], node.inputs["Vector"])
    np.testing.assert_array_equal(drawn(lisle)[0].uvs, places(obj, "First")[loops])


@pytest.mark.parametrize(("space", "is_float"), [("Non-Color", False), ("Linear Rec.709", True)])
def test_light_becomes_codes(lisle, space, is_float):
    checked(image(space=space, is_float=is_float))
    codes = drawn(lisle)[0].texture.codes
    light = CODES / 255
    expected = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055)
    np.testing.assert_allclose(codes, 255 * expected, atol=0.51 if is_float else 1.5)


def test_two_materials_take_their_own_maps(lisle):
    obj, _, _ = checked()
    obj.data.materials.append(material("Plain", (0.9, 0.1, 0.2, 1)))
    for face in obj.data.polygons:
        face.material_index = face.index % 2
    by_name = {mesh.material_name: mesh for mesh in drawn(lisle)}
    assert by_name["Plain"].texture is None and by_name["Plain"].uvs is None
    assert len(by_name["Checked"].corners) == len(by_name["Checked"].uvs) == 6


def test_what_cannot_be_taken_is_noted_and_the_viewports_colour_counts(lisle):
    import bpy

    obj, node, tree = checked()
    assert not collected(lisle)[1]

    def refused(words):
        content, notes = collected(lisle)
        (mesh,) = content.meshes
        assert mesh.picture is None and mesh.color == pytest.approx((0.1, 0.2, 0.3))
        assert len(notes) == 1 and words in notes[0], notes

    node.extension = "CLIP"
    refused("material 'Checked': 'Image Texture' is not flat and repeated")
    node.extension, node.projection = "REPEAT", "BOX"
    refused("not flat")
    node.projection = "FLAT"
    mapping = tree.nodes.new("ShaderNodeMapping")
    tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    refused("not placed by a UV map and fixed numbers alone")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    refused("not placed by a UV map alone")
    tree.links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
    assert not collected(lisle)[1]
    tree.links.new(coordinates.outputs["Normal"], mapping.inputs["Scale"])
    refused("not placed by a UV map and fixed numbers alone")
    tree.links.remove(mapping.inputs["Scale"].links[0])
    mapping.vector_type = "NORMAL"
    refused("not placed by a UV map and fixed numbers alone")
    tree.links.remove(mapping.inputs["Vector"].links[0])
    mapping.mute = True
    assert not collected(lisle)[1]
    node.image.source = "SEQUENCE"
    refused("the picture 'Check' is a sequence")
    node.image = None
    refused("has no picture")
    node.image = image()
    while obj.data.uv_layers:
        obj.data.uv_layers.remove(obj.data.uv_layers[0])
    obj.data.update_tag()
    refused("object 'Cube': it lacks the UV map of")
    checker = tree.nodes.new("ShaderNodeTexChecker")
    principled = tree.get_output_node("ALL").inputs["Surface"].links[0].from_node
    tree.links.new(checker.outputs["Color"], principled.inputs["Base Color"])
    refused("what is linked to Base Color is ignored")
    bpy.data.materials["Checked"].node_tree.links.remove(principled.inputs["Base Color"].links[0])
    assert not collected(lisle)[1]


@pytest.mark.blender("wheel")
@pytest.mark.parametrize("kind", ["POINT", "TEXTURE", "VECTOR"])
def test_a_mapping_places_the_picture_as_in_cycles(lisle, tmp_path, kind):
    import bpy
    import scenes

    scene, layer = bpy.context.scene, bpy.context.view_layer
    bpy.ops.mesh.primitive_plane_add(size=20)
    plane = bpy.context.active_object
    picture = bpy.data.images.new("Steps", 8, 8)
    picture.colorspace_settings.name = "Non-Color"  # otherwise Cycles mixes codes between texels, Lisle light
    values = np.random.default_rng(3).random((8, 8, 4)).astype(np.float32)
    values[..., 3] = 1
    picture.pixels.foreach_set(values.ravel())
    picture.update()
    made = material("Checked", (1, 1, 1, 1))
    tree = made.node_tree
    node, mapping, coordinates = (tree.nodes.new(f"ShaderNode{name}") for name in ("TexImage", "Mapping", "TexCoord"))
    node.image, mapping.vector_type = picture, kind
    mapping.inputs["Rotation"].default_value = (0, 0, 0.5)
    mapping.inputs["Scale"].default_value = (1.5, 0.7, 1)
    if kind != "VECTOR":
        mapping.inputs["Location"].default_value = (0.3, 0.2, 0)
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    tree.links.new(node.outputs["Color"], diffuse.inputs["Color"])
    tree.links.new(diffuse.outputs["BSDF"], tree.get_output_node("ALL").inputs["Surface"])
    plane.data.materials.append(made)
    scene.lisle.samples, layer.lisle.use_pass_denoising = 16, True
    ours = scenes.render_channels(tmp_path / "a.exr", multilayer=True)
    scene.render.engine, layer.use_pass_diffuse_color = "CYCLES", True
    scene.cycles.samples, scene.cycles.use_denoising = 64, False
    theirs = scenes.render_channels(tmp_path / "b.exr", multilayer=True)
    named = "Diffuse Color" if bpy.app.version >= (5, 0, 0) else "DiffCol"
    a, b = (
        np.stack([channels[f"ViewLayer.{name}.{letter}"] for letter in "RGB"])
        for channels, name in ((ours, "Denoising Albedo"), (theirs, named))
    )
    assert a.std() > 0.05
    assert np.abs(a - b).mean() < 0.02, np.abs(a - b).mean()
    assert np.abs(a - b[:, ::-1]).mean() > 0.05


def test_views_notice_that_a_picture_was_painted(lisle):
    from lisle_blender.export.world import forget_images

    _, node, _ = checked()
    before = collected(lisle)[0]
    assert collected(lisle)[0].equals(before)
    node.image.pixels[0] = 0.5
    forget_images()
    assert not collected(lisle)[0].equals(before)
