"""What is linked from another file, and library overrides of it."""

import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.blender("wheel")


@pytest.fixture
def library(lisle, tmp_path):
    """A file with a yarn, its material, and a mesh to knit on, of which none is in the present one."""
    import bpy

    obj = scenes.curves("Yarn", scenes.line())
    obj.data.materials.append(bpy.data.materials.new("Wool"))
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=0.1)
    path = tmp_path / "library.blend"
    bpy.data.libraries.write(str(path), {obj, bpy.data.objects["Grid"]}, fake_user=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path


def linked(library, name):
    import bpy

    with bpy.data.libraries.load(str(library), link=True) as (_, there):
        there.objects = [name]
    obj = scenes.link(there.objects[0])
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    return obj


def reloaded(tmp_path):
    import bpy

    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "here.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "here.blend"))


def test_overrides_of_settings_are_saved(library, tmp_path):
    import bpy

    obj = linked(library, "Yarn").override_create(remap_local_usages=True)
    data = obj.data.override_create(remap_local_usages=True)
    material = data.materials[0].override_create(remap_local_usages=True)
    scenes.curves("Own", scenes.line()).data.materials.append(material)
    obj.lisle.yarn_radius, obj.lisle.mesh_kind, obj.lisle.reference_frame = 0.25, "HOLDOUT", 7
    material.lisle.yarn.preset, material.lisle.fiber.preset = "silk-1", "rayon-3"
    material.lisle.yarn.customize = True
    material.lisle.yarn.plies, material.lisle.yarn.hair_r_min = 2, (0.5, 0.25)
    for _ in range(3):
        reloaded(tmp_path)
    obj = bpy.data.objects["Yarn"]
    material = bpy.data.objects["Own"].data.materials[0]
    assert obj.override_library is not None and material.override_library is not None
    assert (obj.lisle.yarn_radius, obj.lisle.mesh_kind, obj.lisle.reference_frame) == (0.25, "HOLDOUT", 7)
    yarn = material.lisle.yarn
    assert (yarn.preset, material.lisle.fiber.preset, yarn.customize) == ("silk-1", "rayon-3", True)
    assert yarn.plies == 2 and tuple(yarn.hair_r_min) == (0.5, 0.25)


def test_every_property_can_be_overridden(addon):
    import bpy

    properties = addon.properties
    for group in properties._GROUPS:
        for name in set(group.bl_rna.properties.keys()) - {"name", "rna_type"}:
            assert group.bl_rna.properties[name].is_overridable, (group.__name__, name)
    for owner, _ in properties._OWNERS:
        assert owner.bl_rna.properties["lisle"].is_overridable, owner
    assert not bpy.types.Object.bl_rna.properties["type"].is_overridable


def test_knitting_on_an_override_hides_its_mesh_for_good(library, tmp_path):
    import bpy

    linked(library, "Grid").override_create(remap_local_usages=True)
    other = bpy.data.scenes.new("Other")
    other.collection.objects.link(bpy.data.objects["Grid"])
    assert bpy.ops.lisle.knit_from_mesh() == {"FINISHED"}
    assert bpy.data.objects["Grid Knit"].users_collection == (bpy.context.scene.collection,)
    reloaded(tmp_path)
    mesh_object = bpy.data.objects["Grid"]
    assert mesh_object.override_library is not None
    assert mesh_object.hide_render and mesh_object.lisle.mesh_kind == "INVISIBLE"
    assert "Grid Knit" in bpy.context.scene.objects


def test_a_linked_mesh_is_knitted_on_and_stays_as_it_is(library, tmp_path):
    import bpy

    mesh_object = linked(library, "Grid")
    assert bpy.ops.lisle.knit_from_mesh() == {"FINISHED"}
    assert not mesh_object.hide_render and mesh_object.lisle.mesh_kind == "SHADED"
    reloaded(tmp_path)
    points = np.array([p.position[:] for p in bpy.data.objects["Grid Knit"].data.points])
    assert np.ptp(points[:, 0]) > 0.05


def test_knitting_into_a_linked_collection_is_refused_and_leaves_nothing(library, tmp_path):
    import bpy

    collection = bpy.data.collections.new("Set")
    path = tmp_path / "set.blend"
    bpy.data.libraries.write(str(path), {collection}, fake_user=True)
    bpy.data.collections.remove(collection)
    with bpy.data.libraries.load(str(path), link=True) as (_, there):
        there.collections = ["Set"]
    bpy.context.scene.collection.children.link(there.collections[0])
    linked(library, "Grid")
    bpy.context.view_layer.active_layer_collection = bpy.context.view_layer.layer_collection.children["Set"]
    before = len(bpy.data.objects), len(bpy.data.hair_curves), len(bpy.data.materials)
    with pytest.raises(RuntimeError, match="collection 'Set' is linked"):
        bpy.ops.lisle.knit_from_mesh()
    assert (len(bpy.data.objects), len(bpy.data.hair_curves), len(bpy.data.materials)) == before


@pytest.mark.parametrize("override", [False, True])
def test_lengths_of_linked_curves_are_not_stored(library, override):
    import bpy

    obj = linked(library, "Yarn")
    if override:
        obj.override_create(remap_local_usages=True).select_set(True)
    with pytest.raises(RuntimeError, match=r"object 'Yarn': its curves are linked from '.*library\.blend'"):
        bpy.ops.lisle.store_length_coordinate()
