# SPDX-License-Identifier: GPL-3.0-or-later
"""Render passes: which ones a view layer has, and how pictures get into them."""

from dataclasses import dataclass

import bpy

from ..core.pixels import cut_channels, pass_rect


@dataclass(frozen=True)
class Pass:
    """A pass as Blender and as the native module name it."""

    name: str
    channels: str
    """One letter each, as Blender names them in files."""
    kind: str
    """'COLOR', 'VECTOR' or 'VALUE': the type of the compositor socket."""
    image: str
    """Which picture it shows."""
    setting: str | None = None
    """Path of the view layer's switch; None if the pass is always there."""
    first: int = 0
    """Of the picture's channels."""
    least: int = 0
    """Least levels of Cryptomatte with which it is there."""

    def enabled(self, view_layer):
        if self.least > view_layer.pass_cryptomatte_depth:
            return False
        return self.setting is None or bool(view_layer.path_resolve(self.setting))


def _name(old, new):
    """Blender 5.0 spelled the names of its passes out."""
    return new if bpy.app.version >= (5, 0, 0) else old


def _light(name, image):
    return Pass(name, "RGB", "COLOR", image, f"lisle.use_pass_{image}")


_CRYPTOMATTE_LEVELS = 6
"""What the renderer tells apart in a pixel."""


def _cryptomattes():
    """Two pairs of id and coverage each; names and letters as other engines have them."""
    for what in ("object", "material"):
        for number in range(_CRYPTOMATTE_LEVELS // 2):
            name, setting = f"Crypto{what.title()}{number:02}", f"use_pass_cryptomatte_{what}"
            yield Pass(name, "rgba", "COLOR", f"crypto_{what}", setting, 4 * number, 2 * number + 1)


PASSES = (
    Pass("Combined", "RGBA", "COLOR", "combined"),
    Pass("Depth", "Z", "VALUE", "depth", "use_pass_z"),
    Pass("Position", "XYZ", "VECTOR", "position", "use_pass_position"),
    Pass("Normal", "XYZ", "VECTOR", "normal", "use_pass_normal"),
    Pass("Vector", "XYZW", "VECTOR", "vector", "use_pass_vector"),
    Pass("UV", "UVA", "VECTOR", "uv", "use_pass_uv"),
    Pass(_name("IndexOB", "Object Index"), "X", "VALUE", "pass_index", "use_pass_object_index"),
    Pass(_name("IndexMA", "Material Index"), "X", "VALUE", "material_index", "use_pass_material_index"),
    Pass("Tangent", "XYZ", "VECTOR", "tangent", "lisle.use_pass_tangent"),
    # Not "Alpha": the node has a socket of that name already, and some releases of Blender then take others away.
    Pass("Coverage", "A", "VALUE", "alpha", "lisle.use_pass_coverage"),
    _light("Diffuse", "diffuse"),
    _light("Specular", "specular"),
    _light("Transmission", "transmission"),
    _light("Scattered", "scattered"),
    _light("Ambient", "ambient"),
    Pass("Shadow", "X", "VALUE", "shadow", "lisle.use_pass_shadow"),
    Pass("Denoising Albedo", "RGB", "COLOR", "albedo", "lisle.use_pass_denoising"),
    Pass("Denoising Normal", "XYZ", "VECTOR", "denoising_normal", "lisle.use_pass_denoising"),
    *_cryptomattes(),
)


def wanted_passes(view_layer):
    """`Pass.image` of the passes that a view layer has."""
    return {render_pass.image for render_pass in PASSES if render_pass.enabled(view_layer)}


def register_passes(engine, scene, view_layer):
    """Makes the compositor's sockets."""
    for render_pass in PASSES:
        if render_pass.enabled(view_layer):
            engine.register_pass(
                scene, view_layer, render_pass.name, len(render_pass.channels), render_pass.channels, render_pass.kind
            )


def write_passes(result, pictures):
    """Writes pictures by `Pass.image` into a render result. Raises LookupError for a pass it cannot fill."""
    size = result.resolution_x, result.resolution_y
    by_name = {render_pass.name: render_pass for render_pass in PASSES}
    for target in result.layers[0].passes:
        source = by_name.get(target.name)
        if source is None:
            raise LookupError(f"Blender asks for the pass '{target.name}', which Lisle does not have")
        picture = cut_channels(pictures[source.image], source.first, target.channels)
        target.rect.foreach_set(pass_rect(picture, target.channels, size))
