# SPDX-License-Identifier: GPL-3.0-or-later
"""From what was read out of Blender to the native scene. Touches nothing of Blender's: any thread may call it."""

from dataclasses import replace

import numpy as np

from ..core.pixels import free_id
from ..core.trim import cut
from ..native import native_yarns


def add_objects(lisle, scene, content, at_rest, rest_shapes, note):
    """Adds the yarns of `content` (export.scene.Content), measured on `at_rest`, to a lisle.Scene.
    Tells `note` (a callable) what is left out.

    Returns Blender's object index by object id.
    """
    parts = {
        key: by_material(lisle, geometry, at_rest[key], rest_shapes, note)
        for key, geometry in content.geometries.items()
    }
    pass_index_of = {}
    for placement in content.placements:
        identity = free_id(placement.identity, pass_index_of)
        pass_index_of[identity] = placement.pass_index
        for yarns, (yarn, material), (material_name, material_index) in parts[placement.key]:
            scene.add(
                yarns,
                yarn=yarn,
                material=material,
                transform=placement.world_from_object,
                object_id=identity,
                name=placement.name,
                object_index=placement.pass_index,
                material_name=material_name,
                material_index=material_index,
                holdout=placement.is_holdout,
            )
    return pass_index_of


def by_material(lisle, geometry, at_rest, rest_shapes, note):
    """[(lisle.Yarns, (lisle.Yarn, lisle.Material), label)]: the curves of one geometry, by material.

    Curves without length at rest are left out, of which `note` is told.
    """
    curves, materials, labels = geometry.curves, geometry.materials, geometry.labels
    there = at_rest.has_extent()
    if not there.all():
        first, count = int(np.argmin(there)), int((~there).sum())
        note(
            f"object '{geometry.object_name}': {count} of its {len(there)} curves are not drawn, curve {first} first: "
            "their points at rest are one place"
        )
        if not there.any():
            return []
        is_rest, curves = curves is at_rest, curves.select(there)
        at_rest = curves if is_rest else at_rest.select(there)
    if geometry.parts is not None:
        is_rest, parts = curves is at_rest, geometry.parts[there]
        at_rest, skipped = cut(at_rest, parts)
        if not len(skipped):
            return []
        at_rest = _with_lengths_after(lisle, at_rest, skipped, geometry.object_name)
        curves = at_rest if is_rest else cut(curves, parts)[0]
    if curves.material_index is None or len(materials) == 1:
        return [(rest_shapes.yarns(lisle, geometry.key, curves, at_rest), materials[0], labels[0])]
    # Blender draws an index beyond the last slot with the last one.
    slots = np.clip(curves.material_index, 0, len(materials) - 1)
    return [
        (
            rest_shapes.yarns(lisle, (*geometry.key, f"material {slot}"), part, part if curves is at_rest else rest),
            materials[slot],
            labels[slot],
        )
        for slot in np.unique(slots)
        for part, rest in [(curves.select(slots == slot), at_rest.select(slots == slot))]
    ]


def _with_lengths_after(lisle, curves, skipped, name):
    """Curves of which something was cut off at the beginning, with the length coordinates that they had."""
    if not skipped.any():
        return curves
    own = native_yarns(lisle, curves, name).length_coordinates
    return replace(curves, length_coordinates=own + np.repeat(skipped, np.diff(curves.offsets.astype(np.int64))))
