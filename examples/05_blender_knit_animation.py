"""A knitted cloth that a geometry-nodes modifier stretches and waves, rendered by Blender with the Lisle engine.

With a `blender` on the PATH:  blender -b -P 05_blender_knit_animation.py -- out/demo
With the `bpy` wheel:          python 05_blender_knit_animation.py out/demo

Options after the folder: --frames N (24), --size WxH (640x480), --samples N (6), --save FILE.blend to keep the scene,
--still to render the first frame alone.
"""

import argparse
import sys
from math import radians
from pathlib import Path

import bpy


def enable_lisle():
    """Switches the extension on, wherever it was installed from."""
    import addon_utils

    names = [module.__name__ for module in addon_utils.modules()]
    names = [name for name in names if name.rpartition(".")[2] == "lisle_blender"]
    if not names:
        sys.exit("The Lisle extension is not installed: `cargo xtask package` builds it, Install from Disk installs it")
    addon_utils.enable(names[0])


def add_cloth():
    """The yarn as a Curves object: its points and radii are all that Lisle needs.

    It is an eighth larger than it was knitted: room for its yarns when the cloth narrows and leans.
    """
    import lisle

    yarns = lisle.knit_swatch("stockinette", courses=18, wales=11)
    data = bpy.data.hair_curves.new("Knit")
    data.add_curves([int(b - a) for a, b in zip(yarns.offsets[:-1], yarns.offsets[1:], strict=True)])
    data.position_data.foreach_set("vector", 1.125 * yarns.points.ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", yarns.radii)
    cloth = bpy.data.objects.new("Knit", data)
    bpy.context.scene.collection.objects.link(cloth)
    return cloth


def add_material(cloth):
    material = bpy.data.materials.new("Red wool")
    fiber = material.lisle.fiber
    fiber.preset = "cotton-2"
    fiber.customize = True
    fiber.color_r = (0.06, 0.06, 0.06)
    fiber.color_tt = (0.74, 0.28, 0.24)
    fiber.beta_r, fiber.beta_tt = radians(6), radians(20)
    fiber.diffuse = (0.60, 0.09, 0.06)
    cloth.data.materials.append(material)


def add_wave(cloth, frames):
    """Set Position by a wave that runs along X, and a stretch, both driven by the scene's time."""
    group = bpy.data.node_groups.new("Stretch and wave", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    nodes, links = group.nodes, group.links

    def math(operation, a, b=None):
        node = nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, (a, b), strict=False):
            if isinstance(value, (int, float)):
                socket.default_value = value
            elif value is not None:
                links.new(value, socket)
        return node.outputs[0]

    time = nodes.new("GeometryNodeInputSceneTime").outputs["Frame"]
    position = nodes.new("GeometryNodeInputPosition").outputs[0]
    split = nodes.new("ShaderNodeSeparateXYZ")
    links.new(position, split.inputs[0])
    x, y, z = split.outputs
    phase = math("MULTIPLY", math("SUBTRACT", time, 1), 6.283185 / frames)
    swing = math("SUBTRACT", 1, math("COSINE", phase))
    stretch = math("ADD", 1, math("MULTIPLY", swing, 0.05))
    wave = math("SINE", math("ADD", math("MULTIPLY", x, 90), phase))
    join = nodes.new("ShaderNodeCombineXYZ")
    links.new(math("MULTIPLY", x, stretch), join.inputs[0])
    links.new(math("ADD", y, math("MULTIPLY", wave, math("MULTIPLY", swing, 0.002))), join.inputs[1])
    links.new(math("DIVIDE", z, stretch), join.inputs[2])
    move = nodes.new("GeometryNodeSetPosition")
    links.new(nodes.new("NodeGroupInput").outputs[0], move.inputs["Geometry"])
    links.new(join.outputs[0], move.inputs["Position"])
    links.new(move.outputs[0], nodes.new("NodeGroupOutput").inputs[0])
    cloth.modifiers.new("Stretch and wave", "NODES").node_group = group


def add_camera_and_lights():
    from mathutils import Vector

    scene = bpy.context.scene

    def add(name, data, location, target=(0, 0, 0)):
        obj = bpy.data.objects.new(name, data)
        obj.location = location
        obj.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
        scene.collection.objects.link(obj)
        return obj

    camera = bpy.data.cameras.new("Camera")
    camera.lens, camera.clip_start = 70, 0.01
    scene.camera = add("Camera", camera, (0.075, -0.225, 0.06))
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle, sun.color = 5, 0.05, (1, 0.95, 0.88)
    add("Sun", sun, (-0.5, -1, 1.1))
    rim = bpy.data.lights.new("Rim", "AREA")
    rim.energy, rim.size, rim.color = 0.25, 0.2, (0.75, 0.85, 1)
    add("Rim", rim, (0.2, 0.1, 0.2))
    world = bpy.data.worlds.new("World")
    world.color = (0.35, 0.37, 0.40)
    if world.node_tree:
        world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.35, 0.37, 0.40, 1)
    scene.world = world


def main():
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--samples", type=int, default=6)
    parser.add_argument("--save", type=Path)
    parser.add_argument("--still", action="store_true")
    options = parser.parse_args(arguments)

    bpy.ops.wm.read_factory_settings(use_empty=True)
    enable_lisle()
    scene = bpy.context.scene
    scene.render.engine = "LISLE"
    scene.lisle.samples = options.samples
    scene.render.resolution_x, scene.render.resolution_y = map(int, options.size.split("x"))
    scene.render.resolution_percentage = 100
    scene.frame_start, scene.frame_end = 1, options.frames
    scene.frame_set(1)
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = str(options.folder.absolute() / "knit_")

    cloth = add_cloth()
    add_material(cloth)
    add_wave(cloth, options.frames)
    add_camera_and_lights()
    if options.save:
        bpy.ops.wm.save_as_mainfile(filepath=str(options.save.absolute()))
    options.folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.render.render(animation=not options.still, write_still=options.still)


main()
