"""Scenes for the tests, made with Blender's API, and pictures of them."""

import bpy
import exr
import numpy as np


def prepare(scene, size=(64, 48)):
    """A scene for Lisle with a camera above the XY plane that shows x, y in -4 to 4 by -3 to 3."""
    scene.render.engine = "LISLE"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = True
    scene.frame_start, scene.frame_end = 1, 5
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 8
    obj = link(bpy.data.objects.new("Camera", camera))
    obj.location.z = 10
    scene.camera = obj


def link(obj):
    bpy.context.scene.collection.objects.link(obj)
    return obj


def line(count=20, begin=(-3, 0, 0), end=(3, 0, 0)):
    return np.linspace(begin, end, count, dtype=np.float32)


def curves(name, *lines, radius=0.05):
    """A Curves object."""
    data = bpy.data.hair_curves.new(name)
    data.add_curves([len(points) for points in lines])
    data.position_data.foreach_set("vector", np.concatenate(lines).astype(np.float32).ravel())
    if radius is not None:
        attribute = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
        attribute.data.foreach_set("value", np.full(len(data.points), radius, np.float32))
    return link(bpy.data.objects.new(name, data))


def legacy(name, kind, points, closed=False, **settings):
    """A legacy curve object with one spline; `settings` are attributes of the curve data."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "3D"
    for key, value in settings.items():
        setattr(data, key, value)
    add_spline(data, kind, points, closed)
    return link(bpy.data.objects.new(name, data))


def add_spline(data, kind, points, closed=False):
    spline = data.splines.new(kind)
    if kind == "BEZIER":
        spline.bezier_points.add(len(points) - 1)
        for target, point in zip(spline.bezier_points, points, strict=True):
            target.co = point
            target.handle_left_type = target.handle_right_type = "FREE"
            target.handle_left = (point[0] - 0.1, point[1], point[2] + 1)
            target.handle_right = (point[0] + 0.1, point[1], point[2] - 1)
    else:
        spline.points.add(len(points) - 1)
        for target, point in zip(spline.points, points, strict=True):
            target.co = (*point, 1)
    spline.use_cyclic_u = closed
    return spline


def empty_mesh(name, points=((0, 0, 0),)):
    data = bpy.data.meshes.new(name)
    data.from_pydata(list(points), [], [])
    return link(bpy.data.objects.new(name, data))


class Nodes:
    """A geometry-nodes modifier on an object: `with Nodes(obj) as n: n.link(…)`."""

    def __init__(self, obj):
        self.tree = bpy.data.node_groups.new(obj.name, "GeometryNodeTree")
        for direction in ("INPUT", "OUTPUT"):
            self.tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
        self.input = self.tree.nodes.new("NodeGroupInput").outputs[0]
        self.output = self.tree.nodes.new("NodeGroupOutput").inputs[0]
        obj.modifiers.new("Nodes", "NODES").node_group = self.tree

    def new(self, kind, **inputs):
        node = self.tree.nodes.new(f"GeometryNode{kind}")
        for name, value in inputs.items():
            socket = node.inputs[name.replace("_", " ")]
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            else:
                socket.default_value = value
        return node

    def finish(self, *geometries):
        join = self.tree.nodes.new("GeometryNodeJoinGeometry")
        for geometry in geometries:
            self.tree.links.new(geometry, join.inputs[0])
        self.tree.links.new(join.outputs[0], self.output)


def collection_instance(name, *objects, location=(0, 0, 0)):
    """Moves the objects into a collection and instances it."""
    collection = bpy.data.collections.new(name)
    for obj in objects:
        collection.objects.link(obj)
        bpy.context.scene.collection.objects.unlink(obj)
    empty = bpy.data.objects.new(name, None)
    empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", collection, location
    return link(empty)


def keyframes(obj, path, values):
    """Linear keyframes {frame: value}."""
    for frame, value in values.items():
        setattr(obj, path, value)
        obj.keyframe_insert(path, frame=frame)


def use_exr(path, multilayer=False):
    """Makes renders save an uncompressed float EXR."""
    render = bpy.context.scene.render
    settings = render.image_settings
    if bpy.app.version >= (5, 0, 0):
        settings.media_type = "MULTI_LAYER_IMAGE" if multilayer else "IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER" if multilayer else "OPEN_EXR"
    settings.color_mode, settings.color_depth, settings.exr_codec = "RGBA", "32", "NONE"
    render.filepath = str(path)


def render_channels(path, multilayer=False):
    """Renders the present frame; {channel: (h, w), top row first}."""
    use_exr(path, multilayer)
    bpy.ops.render.render(write_still=True)
    return exr.read_exr(path)


def render_rgba(path):
    """Renders the present frame; (h, w, 4), top row first."""
    channels = render_channels(path)
    return np.stack([channels[name] for name in "RGBA"], axis=-1)
