# SPDX-License-Identifier: GPL-3.0-or-later
"""What feeds a socket of a node tree."""


def source_of(socket):
    """The output socket that an input's value comes from, past reroutes and muted nodes; where there is none, the input
    whose own value counts. `is_output` tells the two apart."""
    own = socket
    while socket.is_linked:
        link = socket.links[0]
        if link.is_muted:
            return own
        node, output = link.from_node, link.from_socket
        if node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.mute:
            through = next((inner.from_socket for inner in node.internal_links if inner.to_socket == output), None)
            if through is None:
                return own
            own = socket = through
        else:
            return output
    return own
