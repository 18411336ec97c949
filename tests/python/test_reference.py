"""The path tracer, and the fibers that it draws, from Python and the command line."""

import dataclasses

import lisle
import numpy as np
import pytest
from conftest import line
from test_cli import cloth, run  # noqa: F401

SIZE = (40, 30)
SUN = lisle.Sun(direction=(-1, 1, -2), strength=3.0)


@pytest.fixture(scope="module")
def scene(swatch):
    scene = lisle.Scene(lisle.Camera.fit(swatch, size=SIZE), [SUN], (0.3, 0.3, 0.3))
    scene.add(swatch, lisle.Yarn.preset("silk-1"), lisle.Material.preset("cotton-2"))
    return scene


def draw(scene, **options):
    return lisle.Reference().render(scene, **{"samples": 2, "bounces": 2, **options})


def test_the_image_has_a_variance(scene):
    image = draw(scene, samples=8)
    assert list(image) == ["combined", "depth", "alpha", "normal", "tangent", "object_id", "variance"]
    assert image["variance"].shape == (30, 40, 3)
    assert np.isfinite(image["variance"]).all()
    covered = image["alpha"] > 0.99
    assert covered.sum() > 100
    assert (image["variance"][covered] > 0).any()
    assert not image["variance"][image["alpha"] == 0].any()
    assert set(np.unique(image["object_id"])) == {0, 1}


def test_the_variance_is_that_of_means_of_other_seeds(scene):
    images = [draw(scene, samples=4, seed=seed, bounces=1) for seed in range(24)]
    means = np.stack([image["combined"][..., :3] for image in images]).astype(np.float64)
    claimed = np.mean([image["variance"] for image in images], axis=0, dtype=np.float64).sum()
    found = means.var(axis=0, ddof=1).sum()
    assert 0.8 < found / claimed < 1.25
    assert not 0.8 < 2 * found / claimed < 1.25


def test_scattered_light_adds_and_comes_to_an_end(scene):
    mean = [draw(scene, samples=16, bounces=bounces)["combined"][..., :3].mean() for bounces in (1, 2, 4, None)]
    assert mean == sorted(mean)
    assert mean[1] > 1.05 * mean[0]


def test_it_sees_what_the_renderer_sees(scene, renderer):
    """Where rays through pixels' centres meet fibers, and how far away, near enough that fibers are pixels wide."""
    near = {"size": (1600, 1200), "region": (700, 500, 860, 620), "samples": 1, "filter_width": 0}
    rendered = renderer.render(scene, lod_pixels=0, **near)
    seen = rendered["alpha"] > 0.5
    radius = float(scene.objects[0].yarns.radii[0])

    def agreement(scene):
        """Shares of pixels in which coverage, depth and tangent agree."""
        reference = draw(scene, **near)
        both = (reference["alpha"] > 0.5) & seen
        depth = np.abs(reference["depth"] - rendered["depth"]) < 0.02 * radius
        tangent = np.einsum("ijk,ijk->ij", reference["tangent"], rendered["tangent"]) > 0.99
        return ((reference["alpha"] > 0.5) == seen).mean(), (depth & tangent)[both].mean()

    coverage, same = agreement(scene)
    assert seen.mean() > 0.2
    assert coverage > 0.98
    assert same > 0.9
    other = lisle.Scene(scene.camera, scene.lights, scene.ambient)
    other.add(scene.objects[0].yarns, scene.objects[0].yarn, scene.objects[0].material, object_id=2)
    assert agreement(other)[1] < 0.7


def test_progress_and_cancelling(scene):
    seen = []
    draw(scene, progress=lambda fraction: seen.append(fraction))
    assert seen == sorted(seen)
    assert seen[-1] == 1
    with pytest.raises(lisle.Cancelled):
        draw(scene, progress=lambda _: False)
    with pytest.raises(ZeroDivisionError):
        draw(scene, progress=lambda _: 1 / 0)


def test_a_checkpoint_goes_on_to_the_same_bits(scene, tmp_path):
    file = tmp_path / "work.lisle"
    expected = draw(scene, samples=6)
    with pytest.raises(lisle.Cancelled):
        draw(scene, samples=6, checkpoint=file, progress=lambda fraction: fraction < 0.3)
    assert [path.name for path in tmp_path.iterdir()] == ["work.lisle"]
    again = draw(scene, samples=6, checkpoint=file)
    for name in expected:
        assert np.array_equal(expected[name], again[name]), name
    with pytest.raises(lisle.InputError, match="another scene"):
        draw(scene, samples=6, seed=1, checkpoint=file)
    with pytest.raises(lisle.InputError, match="more samples"):
        draw(scene, samples=2, checkpoint=file)
    file.write_bytes(file.read_bytes()[:-5])
    with pytest.raises(lisle.InputError, match="cut off"):
        draw(scene, samples=6, checkpoint=file)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"samples": 0}, "samples"),
        ({"bounces": 0}, "bounces"),
        ({"chord_error": 0.0}, "chord_error"),
        ({"filter_width": -1.0}, "filter_width"),
        ({"shading": "wool"}, "shading"),
        ({"region": (0, 0, 41, 30)}, "region"),
        ({"checkpoint": "/no/such/folder/work"}, "cannot be written"),
    ],
)
def test_what_cannot_be_drawn_is_named(scene, options, message):
    with pytest.raises((lisle.InputError, OSError), match=message):
        draw(scene, **options)


def test_an_even_environment_is_ambient_light(scene):

    def under(ambient, environment=None):
        lit = lisle.Scene(scene.camera, [], (ambient, ambient, ambient), environment)
        lit.add(scene.objects[0].yarns, scene.objects[0].yarn, scene.objects[0].material)
        return draw(lit, samples=32, transparent=False)

    a = under(0.0, lisle.Environment(np.full((8, 16, 3), 0.35), strength=2.0))
    b = under(0.7)

    def deviation(a, b):
        error = np.sqrt(a["variance"].sum(dtype=np.float64) + b["variance"].sum(dtype=np.float64))
        return (a["combined"][..., :3].sum(dtype=np.float64) - b["combined"][..., :3].sum(dtype=np.float64)) / error

    assert abs(deviation(a, b)) < 4
    assert np.allclose(a["combined"][a["object_id"] == 0][0], (0.7, 0.7, 0.7, 1.0), atol=0.3)
    assert abs(deviation(under(0.0, lisle.Environment(np.full((8, 16, 3), 0.8))), b)) > 4


def test_a_bright_texel_is_a_sun(scene):
    """A texel of known solid angle, seen from afar, against a sun of the same irradiance from its middle."""
    height, width, row, column = 64, 128, 14, 90
    z = np.cos(np.pi * np.array([row, row + 1]) / height)
    solid_angle = 2 * np.pi / width * (z[0] - z[1])
    radiance = np.zeros((height, width, 3))
    radiance[row, column] = 3.0 / solid_angle
    longitude, latitude = (0.5 - (column + 0.5) / width) * 2 * np.pi, np.arcsin(z.mean())
    toward = np.array([np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)])

    def lit(lights, environment=None):
        dark = lisle.Scene(scene.camera, lights, (0, 0, 0), environment)
        dark.add(scene.objects[0].yarns, scene.objects[0].yarn, scene.objects[0].material.replace(diffuse_weight=0.5))
        return draw(dark, samples=256, bounces=1)["combined"][..., 0].mean(dtype=np.float64)

    expected = lit([lisle.Sun(direction=-toward, strength=3.0)])
    # Interpolation spreads the texel over its neighbours, and narrow lobes see it no point: 3 %.
    assert lit([], lisle.Environment(radiance)) == pytest.approx(expected, rel=0.03)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert lit([lisle.Sun(direction=-turn @ toward, strength=3.0)]) == pytest.approx(
        lit([], lisle.Environment(radiance, turn)), rel=0.03
    )
    assert lit([], lisle.Environment(radiance, turn)) != pytest.approx(expected, rel=0.03)


def test_an_environment_that_is_none_is_refused(scene):
    for wrong in (np.zeros((4, 4)), np.zeros((4, 4, 2)), "sky.png"):
        with pytest.raises(lisle.InputError, match="expected"):
            lisle.Environment(wrong)
    with pytest.raises(lisle.InputError, match="environment"):
        lisle.Scene(scene.camera, environment=np.zeros((4, 8, 3)))
    with pytest.raises(lisle.InputError, match=r"texel \(0, 0\)"):
        lisle.Environment(np.full((4, 8, 3), np.nan))
    with pytest.raises(lisle.InputError, match="rotation"):
        lisle.Environment(np.ones((4, 8, 3)), np.zeros((3, 3)))
    with pytest.raises(lisle.InputError, match="the scene has its own"):
        draw(scene, environment=lisle.Environment(np.ones((4, 8, 3))))
    with pytest.raises(OSError, match=r"none\.exr"):
        lisle.Environment("none.exr")


def test_an_exr_keeps_the_variance(scene, tmp_path):
    OpenEXR = pytest.importorskip("OpenEXR", reason="OpenEXR is not installed")
    image = draw(scene)
    image.save(tmp_path / "picture.exr")
    with OpenEXR.File(str(tmp_path / "picture.exr"), separate_channels=True) as file:
        for i, name in enumerate(("variance.R", "variance.G", "variance.B")):
            assert np.array_equal(file.channels()[name].pixels, image["variance"][..., i])


def quiet(yarn):
    return dataclasses.replace(yarn, loop_density=0.0, hair_density=0.0)


def test_fibers_are_chains_with_radii():
    yarns = lisle.Yarns(line(20, 0.1), [0, 20], yarn_radius=0.1)
    yarn = quiet(lisle.Yarn.preset("silk-1"))
    made = lisle.fibers(yarns, yarn)
    assert len(made.offsets) == 3 * 33 + 1
    assert made.offsets[-1] == len(made.points) == len(made.radii)
    assert (np.diff(made.offsets.astype(np.int64)) >= 2).all()
    assert made.points.dtype == made.radii.dtype == np.float32
    # All within the yarn, whose outer radius is half the ply distance and the long half axis.
    assert np.hypot(made.points[:, 1], made.points[:, 2]).max() < 0.1
    outer = 0.5 * yarn.ply_radius + yarn.ellipse_long
    assert np.allclose(made.radii, 0.1 * yarn.fiber_radius / outer, rtol=1e-5)


def test_hairs_end_in_tips_of_no_width():
    yarns = lisle.Yarns(line(40, 0.1), [0, 40], yarn_radius=0.1)
    yarn = lisle.Yarn.preset("silk-1")
    made = lisle.fibers(yarns, yarn)
    chains = len(made.offsets) - 1
    hairs = chains - 3 * 33
    assert hairs > 20
    # Each hair ends one chain and begins another, both at no width.
    assert np.count_nonzero(made.radii == 0) == 2 * hairs
    ends = np.concatenate([made.offsets[:-1], made.offsets[1:] - 1])
    assert set(np.flatnonzero(made.radii == 0)) <= set(ends)
    # About as many as the density says, per ply length in table units: a Poisson number has the deviation of its root.
    length = 3.9 / 0.1 * (0.5 * yarn.ply_radius + yarn.ellipse_long)
    expected = 3 * yarn.hair_density * length
    assert abs(hairs - expected) < 5 * np.sqrt(expected)


def test_a_smaller_chord_error_takes_more_points_and_lies_closer():
    points = np.array([[np.cos(a), np.sin(a), 0.2 * a] for a in np.linspace(0, 6, 25)])
    yarns = lisle.Yarns(points, [0, 25], yarn_radius=0.1)
    yarn = quiet(lisle.Yarn.preset("cotton-2"))

    def farthest(error):
        """From the fine chains to the coarse ones, in fiber radii."""
        coarse, fine = (lisle.fibers(yarns, yarn, chord_error=e) for e in (error, 0.001))
        worst = 0.0
        for chain in range(0, len(coarse.offsets) - 1, 7):
            a = coarse.points[coarse.offsets[chain] : coarse.offsets[chain + 1]].astype(np.float64)
            p = fine.points[fine.offsets[chain] : fine.offsets[chain + 1]].astype(np.float64)
            start, along = a[:-1], np.diff(a, axis=0)
            t = np.einsum("pij,ij->pi", p[:, None] - start, along) / np.einsum("ij,ij->i", along, along)
            nearest = start + np.clip(t, 0, 1)[..., None] * along
            worst = max(worst, np.linalg.norm(p[:, None] - nearest, axis=2).min(axis=1).max())
        return worst / float(coarse.radii.max()), len(coarse.points)

    (coarse, few), (fine, many) = farthest(0.5), farthest(0.05)
    assert coarse < 0.5
    assert fine < 0.05
    assert coarse > 0.1, "the check sees the difference"
    assert many > 1.5 * few


def test_a_far_view_takes_fewer_fibers_of_the_same_area():
    yarns = lisle.Yarns(line(40, 0.1), [0, 40], yarn_radius=0.1)
    yarn = lisle.Yarn.preset("cotton-1")

    def area(fibers):
        """Of all chains as ribbons."""
        a, b = fibers.points[:-1], fibers.points[1:]
        lengths = np.linalg.norm((b - a).astype(np.float64), axis=1) * (fibers.radii[:-1] + fibers.radii[1:])
        between = np.ones(len(lengths), bool)
        between[fibers.offsets[1:-1] - 1] = False
        return lengths[between].sum()

    everything = lisle.fibers(yarns, yarn)
    near = lisle.Camera.fit(yarns, size=(20_000, 10_000))
    assert area(lisle.fibers(yarns, yarn, camera=near)) == pytest.approx(area(everything), rel=0.01)
    points = []
    for width in (400, 100, 25):
        far = lisle.Camera.fit(yarns, size=(width, max(width // 2, 1)))
        made = lisle.fibers(yarns, yarn, camera=far)
        points.append(len(made.points))
        assert area(made) == pytest.approx(area(everything), rel=0.1)
        # None is thinner than the limit but where it fades or tapers.
        pixel = 4.0 / width
        assert np.median(made.radii) >= 0.45 * pixel
    assert points == sorted(points, reverse=True)
    assert points[-1] < 0.1 * len(everything.points)


def test_fibers_refuse_what_makes_no_sense(swatch):
    with pytest.raises(lisle.InputError, match="chord_error"):
        lisle.fibers(swatch, chord_error=-1)
    with pytest.raises(lisle.InputError, match="object_id"):
        lisle.fibers(swatch, object_id=0)
    with pytest.raises(lisle.InputError, match="lod_pixels"):
        lisle.fibers(swatch, camera=lisle.Camera.fit(swatch), lod_pixels=0)
    with pytest.raises(lisle.InputError, match="Yarns"):
        lisle.fibers("swatch")
    with pytest.raises(lisle.Cancelled):
        lisle.fibers(swatch, progress=lambda _: False)


def test_reference_writes_a_picture(cloth, tmp_path):  # noqa: F811
    output = tmp_path / "cloth.png"
    options = ["--size", "32x24", "--samples", "1", "--bounces", "1", "--yarn", "silk-1"]
    result = run("reference", cloth, "-o", output, *options, "--checkpoint", tmp_path / "work")
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    first = output.read_bytes()
    assert run("reference", cloth, "-o", output, *options, "--seed", "1").returncode == 0
    assert output.read_bytes() != first
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cloth.bcc", "cloth.png", "work"]
    failed = run("reference", cloth, "-o", output, *options, "--seed", "1", "--checkpoint", tmp_path / "work")
    assert failed.returncode == 1
    assert "another scene" in failed.stderr
    assert run("reference", cloth, "-o", output, "--bounces", "0").returncode == 2


def test_fibers_writes_a_stage(cloth, tmp_path):  # noqa: F811
    Usd = pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
    from pxr import UsdGeom

    output = tmp_path / "fibers.usdc"
    result = run("fibers", cloth, "-o", output, "--yarn", "silk-1", "--chord-error", "1")
    assert (result.returncode, result.stderr) == (0, "")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cloth.bcc", "fibers.usdc"]
    made = lisle.fibers(lisle.load(cloth), lisle.Yarn.preset("silk-1"), chord_error=1)
    assert f"{len(made.offsets) - 1} fibers" in result.stdout
    stage = Usd.Stage.Open(str(output))
    prim = UsdGeom.BasisCurves(stage.GetDefaultPrim())
    assert prim.GetTypeAttr().Get() == "linear"
    assert np.array_equal(np.array(prim.GetPointsAttr().Get()), made.points)
    assert np.array_equal(np.array(prim.GetWidthsAttr().Get()), 2 * made.radii)
    assert np.array_equal(np.array(prim.GetCurveVertexCountsAttr().Get()), np.diff(made.offsets))
    size = output.stat().st_size
    assert (
        run("fibers", cloth, "-o", output, "--yarn", "silk-1", "--lod-pixels", "2", "--size", "64x48").returncode == 0
    )
    assert output.stat().st_size < 0.5 * size
    assert run("fibers", cloth, "-o", tmp_path / "fibers.obj").returncode == 1
    assert run("fibers", cloth, "-o", tmp_path / "no" / "fibers.usdc").returncode == 1
    assert not (tmp_path / "no").exists()


def test_a_lens_blurs_the_same(scene, renderer):
    """Coverage, which has no light in it: the same camera in both."""
    camera = scene.camera
    at = camera.world_from_camera
    distance = float((at[:3, 3] - scene.objects[0].yarns.points.mean(axis=0)) @ at[:3, 2])
    lens = {"aperture_radius": 0.06 * distance, "focus_distance": 0.6 * distance, "blades": 5, "ratio": 2.0}

    def pictures(**lens):
        seen = lisle.Scene(dataclasses.replace(camera, **lens), scene.lights, scene.ambient)
        for entry in scene.objects:
            seen.add(entry.yarns, entry.yarn, entry.material)
        rendered = renderer.render(seen, samples=128, lod_pixels=0, shadow_resolution=64)
        return rendered, draw(seen, samples=128, bounces=1)

    def difference(a, b):
        """Of means over 2 × 2 pixels, in which the reference's noise is half as large."""
        blocks = (a["alpha"] - b["alpha"]).reshape(15, 2, 20, 2).mean(axis=(1, 3))
        return float(np.sqrt((blocks**2).mean()))

    sharp, sharp_reference = pictures()
    blurred, blurred_reference = pictures(**lens)
    error = difference(blurred, blurred_reference)
    turned, _ = pictures(**lens | {"ratio": 0.5})
    print(error, difference(sharp, sharp_reference), difference(blurred, sharp), difference(turned, blurred_reference))
    assert error < 0.025
    assert difference(sharp, sharp_reference) < 0.025
    assert difference(blurred, sharp) > 3 * error
    assert difference(turned, blurred_reference) > 1.5 * error
    np.testing.assert_array_equal(blurred["depth"], sharp["depth"])
    mean = [image["combined"][..., :3].mean() for image in (blurred, sharp)]
    assert mean[0] == pytest.approx(mean[1], rel=0.03)


@pytest.mark.parametrize("name", ["cotton-2", "rayon-4"])
def test_light_along_a_yarn_meets_its_twist(renderer, name):
    """Such light goes across fibers that are wound towards it, along those that are wound away: of two suns that are
    mirrored, one reaches more of a yarn. Straight yarns of one or the other twist, every fiber drawn, scattered once.
    """
    x = np.linspace(-24, 24, 49)
    points = np.concatenate([np.column_stack([x, 0 * x, 0 * x + 4.0 * row]) for row in range(-4, 5)])
    yarns = lisle.Yarns(points, np.arange(10) * len(x), yarn_radius=1.0)
    yarn = lisle.Yarn.preset(name).replace(loop_density=0.0, hair_density=0.0)
    camera = lisle.Camera.fit(yarns, direction=(0, -1, 0), size=(96, 72))
    means = []
    for along in (0.7, -0.7):
        scene = lisle.Scene(camera, [lisle.Sun(direction=(along, 1.0, -0.4), strength=3.0)])
        scene.add(yarns, yarn, lisle.Material.preset("fleece"))
        pictures = (
            renderer.render(scene, samples=32, lod_pixels=0, transport_photons=0),
            draw(scene, samples=32, bounces=1),
        )
        means.append([float(picture["combined"][..., :3].mean(dtype=np.float64)) for picture in pictures])
    rendered, expected = np.array(means).T
    print(rendered / expected, rendered[0] / rendered[1], expected[0] / expected[1])
    assert np.abs(rendered / expected - 1).max() < 0.06
    assert abs(rendered[0] / rendered[1] / (expected[0] / expected[1]) - 1) < 0.05
    # Where the other sun's is taken, the comparison sees it.
    assert abs(rendered[1] / rendered[0] / (expected[0] / expected[1]) - 1) > 0.1
