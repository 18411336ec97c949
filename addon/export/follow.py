# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that follow a mesh: a geometry-nodes group that any engine evaluates, and what can be wrong with its input.

Each point carries three vertices of the mesh, their weights, and a height. Its place is the weighted mean of the
vertices, raised along that of their normals. The group reads nothing else, so a frame alone equals the same frame in a
sequence.
"""

import bpy

from ..core.errors import GeometryError
from .meshes import evaluated_mesh

VERTICES = ("lisle_vertex_1", "lisle_vertex_2", "lisle_vertex_3")
"""Point attributes: numbers of the vertices."""
WEIGHTS = "lisle_weights"
"""Point attribute: their weights."""
HEIGHT = "lisle_height"
"""Point attribute: metres along the normal."""

_MARK = "lisle_follow_mesh"
"""Custom property of the node group: the version of how it is made."""
_VERSION = 1
_OBJECT, _COUNT = "Mesh", "Vertices"


def follow(obj, mesh_object, vertex_count):
    """Has the curves of `obj` follow a mesh that has so many vertices when it is evaluated."""
    modifier = obj.modifiers.new("Follow Mesh", "NODES")
    modifier.node_group = _node_group()
    _set(modifier, _OBJECT, mesh_object)
    _set(modifier, _COUNT, vertex_count)


def check(obj, depsgraph):
    """Raises GeometryError where the curves of an evaluated object cannot follow their mesh."""
    for modifier in obj.modifiers:
        if modifier.type != "NODES" or modifier.node_group is None or _MARK not in modifier.node_group:
            continue
        if not (modifier.show_render if depsgraph.mode == "RENDER" else modifier.show_viewport):
            continue
        mesh_object, count = _get(modifier, _OBJECT), _get(modifier, _COUNT)
        if mesh_object is None:
            raise GeometryError(obj.name, f"the mesh that its modifier '{modifier.name}' follows is gone")
        evaluated = mesh_object.evaluated_get(depsgraph)
        with evaluated_mesh(evaluated) as mesh:
            found = 0 if mesh is None else len(mesh.vertices)
        if found != count:
            advice = (
                "leave Edit Mode, in which its modifiers may be off"
                if evaluated.mode == "EDIT"
                else "its modifiers need the same levels in the viewport and in pictures; "
                "if the mesh itself was changed, use Knit from Mesh again"
            )
            raise GeometryError(
                obj.name,
                f"the mesh '{mesh_object.name}' has {found} vertices, {count} when it was knitted on: {advice}",
            )


def _identifier(modifier, name):
    """Of an input of a modifier's node group."""
    items = modifier.node_group.interface.items_tree
    return next(item.identifier for item in items if item.in_out == "INPUT" and item.name == name)


# Newer releases made custom properties of modifiers real ones.
if "properties" in bpy.types.NodesModifier.bl_rna.properties:

    def _get(modifier, name):
        return getattr(modifier.properties.inputs, _identifier(modifier, name)).value

    def _set(modifier, name, value):
        getattr(modifier.properties.inputs, _identifier(modifier, name)).value = value

else:

    def _get(modifier, name):
        return modifier[_identifier(modifier, name)]

    def _set(modifier, name, value):
        modifier[_identifier(modifier, name)] = value


def _node_group():
    for group in bpy.data.node_groups:
        if group.get(_MARK) == _VERSION and group.library is None:
            return group
    group = bpy.data.node_groups.new("Follow Mesh", "GeometryNodeTree")
    group[_MARK] = _VERSION
    group.is_modifier = True
    interface = group.interface
    interface.new_socket("Curves", in_out="INPUT", socket_type="NodeSocketGeometry")
    interface.new_socket(_OBJECT, in_out="INPUT", socket_type="NodeSocketObject")
    count = interface.new_socket(_COUNT, in_out="INPUT", socket_type="NodeSocketInt")
    count.description = "Of the mesh when it was knitted on"
    interface.new_socket("Curves", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    _fill(group)
    return group


def _fill(group):
    nodes, links = group.nodes, group.links
    inputs, output = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    mesh = nodes.new("GeometryNodeObjectInfo")
    mesh.transform_space = "RELATIVE"
    links.new(inputs.outputs[_OBJECT], mesh.inputs["Object"])
    geometry = mesh.outputs["Geometry"]

    def attribute(name, kind):
        node = nodes.new("GeometryNodeInputNamedAttribute")
        node.data_type = kind
        node.inputs["Name"].default_value = name
        return next(socket for socket in node.outputs if socket.enabled)

    def vector_math(operation, *values):
        node = nodes.new("ShaderNodeVectorMath")
        node.operation = operation
        for socket, value in zip(node.inputs, values, strict=False):
            links.new(value, socket)
        return node.outputs["Vector"]

    split = nodes.new("ShaderNodeSeparateXYZ")
    links.new(attribute(WEIGHTS, "FLOAT_VECTOR"), split.inputs[0])
    vertices = [attribute(name, "INT") for name in VERTICES]

    def mean(field):
        """The weighted mean of a field of the mesh."""
        total = None
        for vertex, weight in zip(vertices, split.outputs, strict=True):
            sample = nodes.new("GeometryNodeSampleIndex")
            sample.data_type, sample.domain = "FLOAT_VECTOR", "POINT"
            links.new(geometry, sample.inputs["Geometry"])
            links.new(field, next(socket for socket in sample.inputs if socket.name == "Value" and socket.enabled))
            links.new(vertex, sample.inputs["Index"])
            value = next(socket for socket in sample.outputs if socket.enabled)
            scale = nodes.new("ShaderNodeVectorMath")
            scale.operation = "SCALE"
            links.new(value, scale.inputs[0])
            links.new(weight, scale.inputs["Scale"])
            scaled = scale.outputs["Vector"]
            total = scaled if total is None else vector_math("ADD", total, scaled)
        return total

    normal = vector_math("NORMALIZE", mean(nodes.new("GeometryNodeInputNormal").outputs["Normal"]))
    lift = nodes.new("ShaderNodeVectorMath")
    lift.operation = "SCALE"
    links.new(normal, lift.inputs[0])
    links.new(attribute(HEIGHT, "FLOAT"), lift.inputs["Scale"])
    place = nodes.new("GeometryNodeSetPosition")
    links.new(inputs.outputs["Curves"], place.inputs["Geometry"])
    position = mean(nodes.new("GeometryNodeInputPosition").outputs["Position"])
    links.new(vector_math("ADD", position, lift.outputs["Vector"]), place.inputs["Position"])
    links.new(place.outputs["Geometry"], output.inputs[0])

    # What other engines draw wrong without a word.
    size = nodes.new("GeometryNodeAttributeDomainSize")
    links.new(geometry, size.inputs["Geometry"])
    differs = nodes.new("FunctionNodeCompare")
    differs.data_type, differs.operation = "INT", "NOT_EQUAL"
    integers = [socket for socket in differs.inputs if socket.enabled]
    links.new(size.outputs["Point Count"], integers[0])
    links.new(inputs.outputs[_COUNT], integers[1])
    warning = nodes.new("GeometryNodeWarning")
    warning.inputs["Message"].default_value = "The mesh has another number of vertices than when it was knitted on"
    links.new(differs.outputs[0], warning.inputs["Show"])
    for number, node in enumerate(nodes):
        node.location = (200 * (number % 8), -200 * (number // 8))
