"""The extension's lists of presets against the native module's."""

import pytest

pytestmark = pytest.mark.blender("wheel")


def test_every_native_preset_has_an_entry_and_none_is_made_up(addon, lisle):
    presets = addon.presets
    assert {item[0] for item in presets.YARN_ITEMS} == set(lisle.Yarn.presets())
    assert {item[0] for item in presets.FIBER_ITEMS} == set(lisle.Material.presets())
    for items, default in ((presets.YARN_ITEMS, presets.DEFAULT_YARN), (presets.FIBER_ITEMS, presets.DEFAULT_FIBER)):
        assert default in {item[0] for item in items}
        assert [item[3] for item in items] == list(range(len(items)))


def test_every_preset_has_a_picture_of_its_own(addon):
    import bpy

    thumbnails = addon.presets.thumbnails
    for kind in ("yarn", "fiber"):
        files = sorted(path.stem for path in (thumbnails.FOLDER / kind).glob("*.webp"))
        assert files == sorted(item[0] for item in getattr(addon.presets, f"{kind.upper()}_ITEMS"))
        for path in (thumbnails.FOLDER / kind).glob("*.webp"):
            assert path.stat().st_size <= 20_000
            image = bpy.data.images.load(str(path))
            assert tuple(image.size) == (160, 160) and len(set(image.pixels)) > 100
            bpy.data.images.remove(image)


def test_presets_survive_the_extension_being_turned_off_and_on(addon):
    import bpy

    material = bpy.data.materials.new("Material")
    material.lisle.yarn.preset = "silk-2"
    addon.unregister()
    assert not hasattr(material, "lisle")
    addon.register()
    assert material.lisle.yarn.preset == "silk-2"
    assert bpy.data.materials.new("Other").lisle.fiber.preset == addon.presets.DEFAULT_FIBER


def test_customized_presets_are_the_presets(addon, lisle):
    """Each preset, copied into Blender's properties and back, is the same to single precision."""
    import bpy

    material = bpy.data.materials.new("Material")
    for group in (material.lisle.yarn, material.lisle.fiber):
        group.customize = True
        for preset in [item.identifier for item in group.bl_rna.properties["preset"].enum_items]:
            group.preset = preset
            original = group.native_preset(lisle)
            for field in group.FIELDS:
                stored, value = getattr(group, field), getattr(original, field)
                if not isinstance(value, int | float):
                    stored = tuple(stored)
                assert stored == pytest.approx(value, rel=1e-6, abs=1e-9), f"{preset}: {field}"


@pytest.mark.blender
def test_presets_of_ones_own_are_kept_and_come_back(addon, tmp_path, monkeypatch):
    import bpy
    import scenes

    monkeypatch.setenv("BLENDER_USER_RESOURCES", str(tmp_path))
    obj = scenes.curves("Yarn", scenes.line())
    bpy.context.view_layer.objects.active = obj
    obj.data.materials.append(bpy.data.materials.new("Wool"))
    yarn = obj.active_material.lisle.yarn
    yarn.preset, yarn.customize = "silk-1", True
    yarn.plies, yarn.loop_r_max = 7, (0.125, 0.5)
    fiber = obj.active_material.lisle.fiber
    fiber.customize, fiber.color_tt = True, (0.25, 0.5, 0.75)
    bpy.ops.lisle.yarn_preset_add(name="My Yarn")
    bpy.ops.lisle.fiber_preset_add(name="My Fiber")
    files = {kind: list((tmp_path / "scripts" / "presets" / "lisle" / kind).iterdir()) for kind in ("yarn", "fiber")}
    assert [path.stem for path in files["yarn"]] == ["My_Yarn"]
    other = bpy.data.materials.new("Other")
    obj.data.materials[0] = other
    for (path,), menu in zip(files.values(), ("LISLE_PT_yarn_presets", "LISLE_PT_fiber_presets"), strict=True):
        bpy.ops.script.execute_preset(filepath=str(path), menu_idname=menu)
    assert (other.lisle.yarn.preset, other.lisle.yarn.plies) == ("silk-1", 7)
    assert tuple(other.lisle.yarn.loop_r_max) == (0.125, 0.5)
    assert tuple(other.lisle.fiber.color_tt) == (0.25, 0.5, 0.75)
