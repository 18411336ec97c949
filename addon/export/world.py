# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: constant radiance from everywhere, or a picture of the sky."""

from dataclasses import dataclass
from types import SimpleNamespace

import bpy
import numpy as np

from ..core.errors import SceneError
from ..core.pixels import linear_from_srgb
from . import textures
from .images import colours_of, is_linear
from .nodes import source_of

_MOST_KEPT = 4

_kept = {}
"""lisle.EnvironmentImage by what tells pictures apart."""


@dataclass(frozen=True, eq=False)
class World:
    """Light from all sides."""

    ambient: tuple
    """Scene-linear (r, g, b)."""
    environment: object
    """lisle.Environment or None."""

    def equals(self, other):
        """Whether both look the same."""
        mine, theirs = self.environment, other.environment
        if self.ambient != other.ambient or (mine is None) != (theirs is None):
            return False
        return mine is None or (
            mine.image is theirs.image
            and mine.strength == theirs.strength
            and np.array_equal(mine.world_from_environment, theirs.world_from_environment)
        )


DARK = World((0.0, 0.0, 0.0), None)


def read_world(lisle, world, note):
    """The World of a `bpy.types.World`; dark for None. Tells `note` what is left out.

    Raises SceneError where its picture cannot be read.
    """
    plan = plan_of(world, note)
    if plan.image is None:
        return World(plan.ambient, None)
    try:
        image = _native_image(lisle, plan.image)
        return World(plan.ambient, lisle.Environment(image, rotation=plan.rotation, strength=plan.strength))
    except lisle.InputError as error:
        raise SceneError(f"world '{world.name}': {error}") from error


def forget_images():
    """Reads pictures again the next time: their pixels may have changed."""
    _kept.clear()
    textures.forget()


def plan_of(world, note):
    """What `read_world` takes from a world, without its pixels: `ambient`, `image`, `rotation` (3×3) and `strength`."""
    plan = SimpleNamespace(ambient=(0.0, 0.0, 0.0), image=None, rotation=np.eye(3), strength=1.0)
    if world is None:
        return plan
    # Since 5.0 a world always has nodes, and asking is deprecated.
    if world.node_tree is None or (bpy.app.version < (5, 0, 0) and not world.use_nodes):
        plan.ambient = tuple(world.color)
        return plan
    output = world.node_tree.get_output_node("ALL")
    surface = None if output is None else source_of(output.inputs["Surface"])
    if surface is None or not surface.is_output:
        return plan
    if source_of(output.inputs["Volume"]).is_output:
        note(f"world '{world.name}': its volume is ignored")
    node = surface.node
    if node.type not in {"BACKGROUND", "EMISSION"}:
        note(f"world '{world.name}': its '{node.name}' node is ignored, Lisle reads a Background node")
        return plan

    def constant(name, kind):
        own = node.inputs[name]
        source = source_of(own)
        if source.type != own.type or (source.is_output and source.node.type != kind):
            note(f"world '{world.name}': what is linked to {name} is ignored, the socket's own value counts")
            return own.default_value
        return source.default_value

    strength = max(constant("Strength", "VALUE"), 0.0)
    color = source_of(node.inputs["Color"])
    if color.is_output and color.node.type == "TEX_ENVIRONMENT":
        _read_texture(world, color.node, plan, note)
        plan.strength = strength
    else:
        plan.ambient = tuple(max(channel * strength, 0.0) for channel in constant("Color", "RGB")[:3])
    return plan


def _read_texture(world, node, plan, note):
    """The picture of an Environment Texture node and how it is turned."""
    image = node.image
    if image is None:
        note(f"world '{world.name}': '{node.name}' has no picture and gives no light")
        return
    if image.source not in {"FILE", "GENERATED"}:
        note(f"world '{world.name}': the picture '{image.name}' is a {image.source.lower()}, which is ignored")
        return
    if 0 in image.size:
        note(f"world '{world.name}': the picture '{image.name}' cannot be loaded and gives no light")
        return
    if node.projection != "EQUIRECTANGULAR":
        note(f"world '{world.name}': '{node.name}' counts as equirectangular")
    plan.image = image
    vector = source_of(node.inputs["Vector"])
    if vector.is_output:
        plan.rotation = _rotation(world, vector.node, note)


def _rotation(world, node, note):
    """(3, 3) from the picture's axes to the world's, by what is linked to the picture's Vector."""
    if node.type in {"TEX_COORD", "NEW_GEOMETRY"}:
        return np.eye(3)
    if node.type != "MAPPING":
        note(f"world '{world.name}': its '{node.name}' node is ignored, Lisle reads a Mapping node")
        return np.eye(3)
    turn = np.array(node.inputs["Rotation"].default_value.to_matrix(), dtype=np.float64)
    others = [node.inputs[name] for name in ("Location", "Scale") if name in node.inputs]
    if any(socket.is_linked for socket in (*others, node.inputs["Rotation"])) or any(
        tuple(socket.default_value) != ((1, 1, 1) if socket.name == "Scale" else (0, 0, 0)) for socket in others
    ):
        note(f"world '{world.name}': of '{node.name}', only the rotation in its own fields counts")
    # The node turns directions of the world into those of the picture; a texture mapping is the inverse of the others.
    return turn if node.vector_type == "TEXTURE" else turn.T


def _native_image(lisle, image):
    """The lisle.EnvironmentImage of a `bpy.types.Image`."""
    space = image.colorspace_settings.name
    key = (image.session_uid, image.filepath, tuple(image.size), image.is_float, space)
    if key not in _kept:
        while len(_kept) >= _MOST_KEPT:
            del _kept[next(iter(_kept))]
        _kept[key] = lisle.Environment(_radiance(image, space)).image
    return _kept[key]


def _radiance(image, space):
    """(h, w, 3) float32, row 0 at the top."""
    pixels = np.nan_to_num(np.maximum(colours_of(image), 0), posinf=np.finfo(np.float32).max)
    return pixels if is_linear(image, space) else linear_from_srgb(pixels)
