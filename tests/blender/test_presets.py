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
