import dataclasses

import lisle
import pytest


@pytest.mark.parametrize(("kind", "count"), [(lisle.Yarn, 9), (lisle.Material, 13)])
def test_every_preset_has_every_field(kind, count):
    assert len(kind.presets()) == count
    for name in kind.presets():
        preset = kind.preset(name)
        assert preset == kind.preset(name)
        assert preset == kind(**dataclasses.asdict(preset))


def test_yarn_presets_are_those_of_the_paper():
    yarn = lisle.Yarn.preset("rayon-4")
    assert (yarn.plies, yarn.fibers_per_ply, yarn.density_beta) == (2, 122, 0.671)
    assert (yarn.fiber_twist, yarn.ply_twist) == (0.560, -0.498)
    assert (yarn.hair_density, yarn.hair_z_span) == (65.23, (0.009, 0.048))


def test_material_presets_are_those_of_the_paper():
    material = lisle.Material.preset("gabardine")
    assert (material.color_r, material.color_tt) == ((0.185, 0.047, 0.069), (0.999, 0.330, 0.354))
    angles = (material.beta_r_deg, material.beta_tt_deg, material.gamma_tt_deg)
    assert angles == pytest.approx((2.141, 10, 23.548))


def test_replacing_fields():
    yarn = lisle.Yarn.preset("silk-1")
    assert yarn.replace(plies=2).plies == 2
    assert yarn.replace(plies=2).replace(plies=3) == yarn
    with pytest.raises(TypeError, match="ply_count"):
        yarn.replace(ply_count=2)
    with pytest.raises(dataclasses.FrozenInstanceError):
        yarn.plies = 2


@pytest.mark.parametrize(
    ("kind", "preset", "field", "value"),
    [
        (lisle.Yarn, "silk-1", "plies", 0),
        (lisle.Yarn, "silk-1", "plies", -1),
        (lisle.Yarn, "silk-1", "plies", "three"),
        (lisle.Yarn, "silk-1", "fiber_twist", 0.0),
        (lisle.Yarn, "silk-1", "r_min", 1.5),
        (lisle.Yarn, "silk-1", "ellipse_long", float("nan")),
        (lisle.Yarn, "silk-1", "loop_r_max", (0.1,)),
        (lisle.Yarn, "silk-1", "hair_z_span", (0.1, -1.0)),
        (lisle.Material, "silk", "color_r", (0.5, 0.5, 1.5)),
        (lisle.Material, "silk", "color_tt", 0.5),
        (lisle.Material, "silk", "beta_r_deg", 0.0),
        (lisle.Material, "silk", "diffuse_weight", -0.1),
    ],
)
def test_values_out_of_range_are_refused_by_name(kind, preset, field, value):
    with pytest.raises(lisle.InputError, match=field):
        kind.preset(preset).replace(**{field: value})


@pytest.mark.parametrize("kind", [lisle.Yarn, lisle.Material])
def test_unknown_presets_are_refused_with_the_known_ones(kind):
    with pytest.raises(lisle.InputError, match=r"tweed.*cotton-1"):
        kind.preset("tweed")


def test_angles_are_refused_in_degrees():
    with pytest.raises(lisle.InputError, match=r"`beta_r_deg` is 95: expected an angle from 0\.0573 to 90 degrees"):
        lisle.Material.preset("silk").replace(beta_r_deg=95)
