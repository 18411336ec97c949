# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as constant radiance from everywhere."""

import bpy


def ambient_radiance(world, note):
    """Scene-linear (r, g, b) of a `bpy.types.World`; black for None. Tells `note` what is left out."""
    if world is None:
        return (0.0, 0.0, 0.0)
    # Since 5.0 a world always has nodes, and asking is deprecated.
    if world.node_tree is None or (bpy.app.version < (5, 0, 0) and not world.use_nodes):
        return tuple(world.color)
    output = world.node_tree.get_output_node("ALL")
    if output is None or not output.inputs["Surface"].is_linked:
        return (0.0, 0.0, 0.0)
    node = output.inputs["Surface"].links[0].from_node
    if node.type not in {"BACKGROUND", "EMISSION"}:
        note(f"world '{world.name}': its '{node.name}' node is ignored, Lisle reads a Background node")
        return (0.0, 0.0, 0.0)
    for name in ("Color", "Strength"):
        if node.inputs[name].is_linked and node.inputs[name].links[0].from_node.type not in {"RGB", "VALUE"}:
            note(f"world '{world.name}': what is linked to {name} is ignored, the socket's own value counts")
    color = _socket_value(node.inputs["Color"], "RGB")
    strength = _socket_value(node.inputs["Strength"], "VALUE")
    return tuple(channel * strength for channel in color[:3])


def _socket_value(socket, constant_node):
    if socket.is_linked and socket.links[0].from_node.type == constant_node:
        return socket.links[0].from_socket.default_value
    return socket.default_value
