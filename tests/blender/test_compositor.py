"""Passes as Blender's compositor gets them."""

import numpy as np
import pytest
import scenes
from test_film import LIGHT, lit_yarns, use_all_passes

pytestmark = pytest.mark.blender("wheel")


class Compositor:
    """A node tree whose result is the picture that is saved."""

    def __init__(self):
        import bpy

        scene = bpy.context.scene
        scene.render.use_compositing = True
        if bpy.app.version >= (5, 0, 0):
            self.tree = scene.compositing_node_group = bpy.data.node_groups.new("Compositor", "CompositorNodeTree")
            self.tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
            self.result = self.tree.nodes.new("NodeGroupOutput").inputs[0]
        else:
            scene.use_nodes = True
            self.tree = scene.node_tree
            self.tree.nodes.clear()
            self.result = self.tree.nodes.new("CompositorNodeComposite").inputs["Image"]
        self.layers = self.tree.nodes.new("CompositorNodeRLayers")

    def link(self, output, given):
        self.tree.links.new(output, given)

    def show(self, output, path):
        """(h, w, 4): the picture that an output makes."""
        self.link(output, self.result)
        return scenes.render_rgba(path)


def test_passes_arrive_as_in_a_file(lisle, tmp_path):
    import bpy

    lit_yarns()
    material = bpy.data.materials.new("Matt")
    material.lisle.fiber.customize, material.lisle.fiber.diffuse_weight = True, 0.3
    for number, name in enumerate(("Upper", "Lower"), 1):
        bpy.data.objects[name].pass_index = number
        bpy.data.objects[name].data.materials.append(material)
    bpy.context.scene.world = bpy.data.worlds.new("World")
    bpy.context.scene.world.color = (0.2, 0.3, 0.4)
    bpy.context.scene.lisle.samples = 4
    use_all_passes(bpy.context.view_layer)
    channels = scenes.render_channels(tmp_path / "a.exr", multilayer=True)
    index = "Object Index" if bpy.app.version >= (5, 0, 0) else "IndexOB"
    compositor = Compositor()
    passes = {
        "Depth": "Z", index: "X", "Position": "XYZ", "Normal": "XYZ", "Tangent": "XYZ",
        "Denoising Albedo": "RGB", "Denoising Normal": "XYZ",
    } | {name.title(): "RGB" for name in LIGHT[:-1]}  # fmt: skip
    for name, letters in passes.items():
        picture = compositor.show(compositor.layers.outputs[name], tmp_path / "b.exr")
        for place, letter in enumerate(letters):
            expected = channels[f"ViewLayer.{name}.{letter}"]
            assert expected.any(), name
            np.testing.assert_allclose(picture[..., place], expected, rtol=1e-6, atol=1e-7, err_msg=name)


def test_a_cryptomatte_node_finds_an_object_by_name(lisle, tmp_path):
    import bpy

    lit_yarns()
    use_all_passes(bpy.context.view_layer)
    alpha = scenes.render_rgba(tmp_path / "a.exr")[..., 3]
    compositor = Compositor()
    node = compositor.tree.nodes.new("CompositorNodeCryptomatteV2")
    node.source, node.scene, node.matte_id = "RENDER", bpy.context.scene, "Upper"
    node.layer_name = "ViewLayer.CryptoObject"
    matte = compositor.show(node.outputs["Matte"], tmp_path / "b.exr")[..., 0]
    upper = np.arange(48)[:, None] < 24
    assert not matte[24:].any()
    # Coverage counts samples alike, the picture's filter does not.
    assert np.abs(matte - np.where(upper, alpha, 0)).max() < 0.3
    assert matte.sum() == pytest.approx(alpha[:24].sum(), rel=0.02)


def test_the_denoise_node_takes_what_is_delivered_for_it(lisle, tmp_path):
    """With albedo and normal, a picture of few samples comes nearer to one of many."""
    import bpy

    scene = bpy.context.scene
    bpy.ops.lisle.add_knit_swatch(courses=6, wales=8, yarn_radius=0.1, rotation=(-1.5708, 0, 0))
    sun = scenes.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    sun.data.energy, sun.rotation_euler = 3, (0.7, 0.3, 0)
    scene.render.resolution_x, scene.render.resolution_y = 160, 120
    scene.lisle.samples = 64
    clean = scenes.render_rgba(tmp_path / "a.exr")[..., :3]
    scene.lisle.samples = 1
    noisy = scenes.render_rgba(tmp_path / "b.exr")[..., :3]
    bpy.context.view_layer.lisle.use_pass_denoising = True
    compositor = Compositor()
    node = compositor.tree.nodes.new("CompositorNodeDenoise")
    compositor.link(compositor.layers.outputs["Image"], node.inputs["Image"])
    colour_alone = compositor.show(node.outputs["Image"], tmp_path / "c.exr")[..., :3]
    for name in ("Albedo", "Normal"):
        compositor.link(compositor.layers.outputs[f"Denoising {name}"], node.inputs[name])
    denoised = compositor.show(node.outputs["Image"], tmp_path / "d.exr")[..., :3]

    def off(picture):
        return np.sqrt(np.mean((picture - clean) ** 2))

    print(f"off: {off(noisy):.4f}, denoised {off(denoised):.4f}, by colour alone {off(colour_alone):.4f}")
    assert off(denoised) < 0.8 * off(noisy)
    assert not np.array_equal(denoised, colour_alone)
