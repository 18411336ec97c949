# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as colours of meshes: the one of an Image Texture node, through a UV map."""

import itertools
from dataclasses import dataclass

import numpy as np
from mathutils import Euler

from ..core.pixels import srgb_from_linear
from .images import colours_of, is_linear
from .nodes import source_of

_MOST_KEPT = 32

_kept = {}
"""Picture by what tells images apart."""

_numbers = itertools.count(1)


@dataclass(frozen=True, eq=False)
class Picture:
    """The pixels of an image at one time."""

    number: int
    """Differs from that of any other."""
    native: object
    """lisle.Texture"""


def picture(lisle, image):
    """The Picture of a `bpy.types.Image`."""
    space = image.colorspace_settings.name
    key = (image.session_uid, image.filepath, tuple(image.size), image.is_float, space)
    if key not in _kept:
        while len(_kept) >= _MOST_KEPT:
            del _kept[next(iter(_kept))]
        _kept[key] = Picture(next(_numbers), lisle.Texture(_codes(image, space)))
    return _kept[key]


def forget():
    """Reads images again the next time: their pixels may have changed."""
    _kept.clear()


def read_node(node, plan):
    """Fills the `image`, `uv_map` ("" for the map that renders) and `mapping` (as of `_mapping_of`) of a plan from an
    Image Texture node. Returns why that cannot be, in words, or None."""
    image = node.image
    if image is None:
        return f"'{node.name}' has no picture"
    if image.source not in {"FILE", "GENERATED"}:
        return f"the picture '{image.name}' is a {image.source.lower()}"
    if 0 in image.size:
        return f"the picture '{image.name}' cannot be loaded"
    if node.projection != "FLAT" or node.extension != "REPEAT":
        return f"'{node.name}' is not flat and repeated"
    vector, mapping = source_of(node.inputs["Vector"]), None
    if vector.is_output and vector.node.type == "MAPPING":
        mapping = _mapping_of(vector.node)
        vector = source_of(vector.node.inputs["Vector"])
        if mapping is None or not vector.is_output:
            return f"'{node.name}' is not placed by a UV map and fixed numbers alone"
    if vector.is_output:
        if vector.node.type == "UVMAP":
            plan.uv_map = vector.node.uv_map
        elif vector.node.type != "TEX_COORD" or vector.name != "UV":
            return f"'{node.name}' is not placed by a UV map alone"
    plan.image, plan.mapping = image, mapping
    return None


def _mapping_of(node):
    """What a Mapping node does to u and v: ((du/du, du/dv, shift of u), the same of v). None if another node has a say
    in it, or if it does something else."""
    if node.vector_type == "NORMAL":
        return None
    sockets = {socket.name: socket for socket in node.inputs if socket.enabled and socket.name != "Vector"}
    if any(source_of(socket).is_output for socket in sockets.values()):
        return None
    location, rotation, scale = (
        sockets[name].default_value if name in sockets else plain
        for name, plain in (("Location", (0, 0, 0)), ("Rotation", Euler()), ("Scale", (1, 1, 1)))
    )
    turn, sizes = np.array(rotation.to_matrix()), np.array(scale)
    if node.vector_type == "TEXTURE":
        linear = np.diag(np.divide(1, sizes, out=np.zeros(3), where=sizes != 0)) @ turn.T
        shift = -linear @ np.array(location)
    else:
        linear = turn @ np.diag(sizes)
        shift = np.array(location)
    return tuple((*map(float, linear[row, :2]), float(shift[row])) for row in range(2))


def uvs_of(mesh, name, mapping, corners):
    """(m, 3, 2) float32 places on a map of the mesh, mapped as `_mapping_of` says, at corners of triangles ((m, 3)
    places of corners); None without that map. An empty name stands for the map that renders."""
    layers = mesh.uv_layers
    layer = layers.get(name) if name else next((layer for layer in layers if layer.active_render), None)
    if layer is None:
        return None
    values = np.empty(2 * len(mesh.loops), np.float32)
    layer.uv.foreach_get("vector", values)
    values = values.reshape(-1, 2)
    if mapping is not None:
        matrix = np.array(mapping)
        values = (values @ matrix[:, :2].T + matrix[:, 2]).astype(np.float32)
    return values[corners]


def _codes(image, space):
    """(h, w, 3) uint8 sRGB codes, row 0 at the top."""
    pixels = np.clip(np.nan_to_num(colours_of(image)), 0, 1)
    if is_linear(image, space):
        pixels = srgb_from_linear(pixels)
    return np.round(255 * pixels).astype(np.uint8)
