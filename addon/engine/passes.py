# SPDX-License-Identifier: GPL-3.0-or-later
"""Render passes: which ones a view layer has, and how pictures get into them."""

from dataclasses import dataclass

import bpy

from ..core.pixels import pass_rect


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

    def enabled(self, view_layer):
        return self.setting is None or bool(view_layer.path_resolve(self.setting))


PASSES = (
    Pass("Combined", "RGBA", "COLOR", "combined"),
    Pass("Depth", "Z", "VALUE", "depth", "use_pass_z"),
    Pass("Normal", "XYZ", "VECTOR", "normal", "use_pass_normal"),
    # Blender 5.0 spelled the names of its passes out.
    Pass(
        "Object Index" if bpy.app.version >= (5, 0, 0) else "IndexOB",
        "X",
        "VALUE",
        "pass_index",
        "use_pass_object_index",
    ),
    Pass("Tangent", "XYZ", "VECTOR", "tangent", "lisle.use_pass_tangent"),
    Pass("Alpha", "A", "VALUE", "alpha", "lisle.use_pass_alpha"),
)


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
        target.rect.foreach_set(pass_rect(pictures[source.image], target.channels, size))
