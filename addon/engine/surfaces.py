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
            key = _key(placement)
            mesh = kept.get(key) or self._kept.get(key) or _native(lisle, placement)
            kept[key] = mesh
            identity = free_id(placement.identity, taken)
            taken.add(identity)
            pass_index_of[identity] = placement.pass_index
            meshes.append(_placed(mesh, placement, identity))
        self._kept = kept
        return meshes, pass_index_of

    def moved(self, lisle, meshes, placements, others):
        """[lisle.Mesh] like `meshes`, which are of `placements`, at the places and in the shapes of `others`."""
        made, found = {}, []
        for mesh, placement, other in zip(meshes, placements, others, strict=True):
            if other.surface.digest == placement.surface.digest:
                shape = mesh
            else:
                key = _key(other)
                if key not in made:
                    made[key] = _native(lisle, other)
                shape = made[key]
            found.append(_placed(shape, other, mesh.object_id))
        return found


def _key(placement):
    """Equal for what one native mesh can show."""
    picture = 0 if placement.picture is None else placement.picture.number
    label = placement.material_name, placement.material_index
    return (placement.surface.digest, placement.color, placement.kind, *label, picture)


def _native(lisle, placement):
    surface = placement.surface
    return lisle.Mesh(
        surface.positions,
        surface.triangles,
        surface.normals,
        base_color=placement.color,
        uvs=surface.uvs,
        texture=None if placement.picture is None else placement.picture.native,
        kind=placement.kind,
        name=placement.name,
        material_name=placement.material_name,
        material_index=placement.material_index,
    )


def _placed(mesh, placement, identity):
    return mesh.at(
        placement.world_from_object,
        object_id=identity,
        name=placement.name,
        object_index=placement.pass_index,
    )
