# SPDX-License-Identifier: GPL-3.0-or-later
"""Native meshes, kept from picture to picture so that the device holds on to what has not changed."""

from ..core.pixels import free_id


class Surfaces:
    """Those of the scene that was drawn last."""

    def __init__(self):
        self._kept = {}

    def clear(self):
        self._kept = {}

    def meshes(self, lisle, placements, taken):
        """[lisle.Mesh] of MeshPlacements, and Blender's object index by object id, for ids that are not in `taken`."""
        kept, meshes, pass_index_of, taken = {}, [], {}, set(taken)
        for placement in placements:
            surface = placement.surface
            label = {"material_name": placement.material_name, "material_index": placement.material_index}
            key = (surface.digest, placement.color, placement.kind, *label.values())
            mesh = kept.get(key) or self._kept.get(key)
            if mesh is None:
                mesh = lisle.Mesh(
                    surface.positions,
                    surface.triangles,
                    surface.normals,
                    base_color=placement.color,
                    kind=placement.kind,
                    name=placement.name,
                    **label,
                )
            kept[key] = mesh
            identity = free_id(placement.identity, taken)
            taken.add(identity)
            pass_index_of[identity] = placement.pass_index
            meshes.append(
                mesh.at(
                    placement.world_from_object,
                    object_id=identity,
                    name=placement.name,
                    object_index=placement.pass_index,
                )
            )
        self._kept = kept
        return meshes, pass_index_of
