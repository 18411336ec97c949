"""Makes the scene of the batch tests: `-- FILE.blend KIND`, with a yarn that swings in 5 frames.

KIND is `sound`, or `broken`: then the yarn has one point more from frame 3 on, which no fiber can follow.
"""

import sys

import bpy
import numpy as np

path, kind = sys.argv[sys.argv.index("--") + 1 :]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.preferences.addon_enable(module="bl_ext.user_default.lisle_blender")
scene = bpy.context.scene
scene.render.engine = "LISLE"
scene.lisle.samples = 2
scene.render.resolution_x, scene.render.resolution_y = 64, 48
scene.render.film_transparent = True
scene.render.image_settings.file_format = "PNG"
scene.render.image_settings.color_mode = "RGBA"
scene.frame_start, scene.frame_end = 1, 5

data = bpy.data.hair_curves.new("Yarn")
data.add_curves([20])
data.position_data.foreach_set("vector", np.linspace((-3, 0, 0), (3, 0, 0), 20, dtype=np.float32).ravel())
radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
radius.data.foreach_set("value", np.full(20, 0.5, np.float32))
yarn = bpy.data.objects.new("Yarn", data)
camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
for obj in (yarn, camera, sun):
    scene.collection.objects.link(obj)
camera.location.z = 10
camera.data.type, camera.data.ortho_scale = "ORTHO", 8
sun.data.energy = 3
scene.camera = camera
for frame, angle in ((1, 0.0), (5, 0.8)):
    yarn.rotation_euler.z = angle
    yarn.keyframe_insert("rotation_euler", frame=frame)

if kind == "broken":
    tree = bpy.data.node_groups.new("Points", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    resample = tree.nodes.new("GeometryNodeResampleCurve")
    late = tree.nodes.new("ShaderNodeMath")
    late.operation = "GREATER_THAN"
    late.inputs[1].default_value = 2.5
    count = tree.nodes.new("ShaderNodeMath")
    count.inputs[1].default_value = 12
    frame = tree.nodes.new("GeometryNodeInputSceneTime").outputs["Frame"]
    for source, target in (
        (tree.nodes.new("NodeGroupInput").outputs[0], resample.inputs["Curve"]),
        (frame, late.inputs[0]),
        (late.outputs[0], count.inputs[0]),
        (count.outputs[0], resample.inputs["Count"]),
        (resample.outputs[0], tree.nodes.new("NodeGroupOutput").inputs[0]),
    ):
        tree.links.new(source, target)
    yarn.modifiers.new("Points", "NODES").node_group = tree
bpy.ops.wm.save_as_mainfile(filepath=path)
