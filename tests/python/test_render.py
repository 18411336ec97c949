import math

import lisle
import numpy as np
import pytest
from conftest import SIZE

WIDTH, HEIGHT = SIZE


def test_passes_have_the_promised_shapes_and_types(draw):
    image = draw()
    assert image.size == SIZE
    assert list(image) == ["combined", "depth", "alpha", "normal", "tangent", "object_id"]
    for name, dtype, channels in [
        ("combined", np.float32, (4,)),
        ("depth", np.float32, ()),
        ("alpha", np.float32, ()),
        ("normal", np.float32, (3,)),
        ("tangent", np.float32, (3,)),
        ("object_id", np.uint32, ()),
    ]:
        assert image[name].dtype == dtype, name
        assert image[name].shape == (HEIGHT, WIDTH, *channels), name
        assert np.isfinite(image[name]).all(), name
    with pytest.raises(KeyError, match="no pass 'beauty': expected combined"):
        image["beauty"]


def test_the_picture_shows_the_yarns(draw):
    image = draw(samples=4)
    alpha = image["alpha"]
    assert 0.2 < alpha.mean() < 0.95
    assert alpha.max() == pytest.approx(1, abs=1e-3)
    assert image["combined"][..., :3].max() > 0.01
    assert (image["combined"][alpha == 0] == 0).all()
    hit = image["object_id"] != 0
    assert set(np.unique(image["object_id"])) == {0, 1}
    assert (image["depth"][~hit] == 1e10).all()
    assert (image["depth"][hit] < 10).all()


def test_depth_is_metres_along_the_view_axis(draw, swatch, camera):
    image = draw(samples=1, filter_width=0)
    camera_from_world = np.linalg.inv(camera.world_from_camera)
    depth = -(camera_from_world[2, :3] @ swatch.points.T + camera_from_world[2, 3])
    hit = image["depth"] < 1e9
    radius = swatch.radii.max()
    assert depth.min() - 2 * radius <= image["depth"][hit].min()
    assert image["depth"][hit].max() <= depth.max() + 2 * radius


def test_row_0_is_the_top(renderer, swatch):
    """The yarns in the upper half of the picture."""
    camera = lisle.Camera.fit(swatch, (0, -1, 0), SIZE)
    lifted = np.eye(4)
    lifted[2, 3] = 0.5 * np.ptp(swatch.points[:, 2])
    scene = lisle.Scene(camera, ambient=(1, 1, 1))
    scene.add(swatch, transform=lifted)
    alpha = renderer.render(scene, samples=1)["alpha"]
    assert alpha[: HEIGHT // 2].sum() > 5 * alpha[HEIGHT // 2 :].sum() + 1


def test_more_light_is_brighter_and_no_light_is_black(draw):
    off, dim, bright = (
        draw(lights=[lisle.Sun(direction=(-1, 1, -2), strength=strength)])["combined"] for strength in (0.0, 1.0, 2.0)
    )
    assert (off[..., :3] == 0).all()
    np.testing.assert_allclose(bright[..., :3], 2 * dim[..., :3], rtol=1e-3, atol=1e-6)
    np.testing.assert_array_equal(off[..., 3], dim[..., 3])


@pytest.mark.parametrize(
    "light",
    [
        lisle.Sun(direction=(0, 1, 0), strength=3, angle_rad=0.1),
        lisle.Gaussian(direction=(0, 1, 0), strength=3, sharpness=20),
        lisle.Point(position=(0, -0.2, 0), power=1, radius=0.01),
        lisle.Spot(position=(0, -0.2, 0), direction=(0, 1, 0), power=1, cone_angle_rad=1.0),
        lisle.Area(
            np.array([[1, 0, 0, 0], [0, 0, -1, -0.2], [0, 1, 0, 0], [0, 0, 0, 1.0]]), size=(0.1, 0.2), shape="disk"
        ),
    ],
    ids=lambda light: type(light).__name__,
)
def test_every_kind_of_light_lights(draw, light):
    assert draw(lights=[light])["combined"][..., :3].mean() > 1e-4


def test_a_spot_lights_its_cone_only(draw):
    away = lisle.Spot(position=(0, -0.2, 0), direction=(0, -1, 0), power=1, cone_angle_rad=1.0)
    assert (draw(lights=[away])["combined"][..., :3] == 0).all()


def test_settings_change_the_picture(draw):
    plain = draw(samples=2)["combined"]
    for change in (
        dict(shading="simple"),
        dict(yarn=lisle.Yarn.preset("rayon-3")),
        dict(material=lisle.Material.preset("fleece")),
        dict(ambient=(1, 0, 0)),
        dict(lod_pixels=0.0),
        dict(seed=7),
        dict(filter_width=0.0),
        dict(shadow_resolution=64),
        dict(table_resolution=2),
        dict(sky_directions=1),
        dict(samples=3),
    ):
        assert not np.array_equal(draw(**{"samples": 2, **change})["combined"], plain), change


def test_size_overrules_the_camera(draw):
    assert draw(size=(40, 30)).size == (40, 30)


def test_a_picture_too_large_for_memory_is_refused(draw):
    with pytest.raises(lisle.InputError, match="more than"):
        draw(size=(65000, 65000))


def test_an_opaque_background_is_the_ambient_light(draw):
    image = draw(transparent=False, ambient=(0.25, 0.5, 0.75))
    assert (image["alpha"] == 1).all()
    empty = draw()["alpha"] == 0
    np.testing.assert_allclose(image["combined"][empty][:, :3], [[0.25, 0.5, 0.75]] * empty.sum(), rtol=1e-5)


def test_a_region_is_that_part_of_the_whole(draw):
    x0, y0, x1, y1 = 30, 10, 71, 49
    whole, part = draw(), draw(region=(x0, y0, x1, y1))
    assert part.size == (x1 - x0, y1 - y0)
    for name in ("combined", "depth", "object_id"):
        cut = whole[name][HEIGHT - y1 : HEIGHT - y0, x0:x1]
        np.testing.assert_array_equal(part[name], cut, err_msg=name)
    beside = whole["combined"][HEIGHT - y1 : HEIGHT - y0, x0 + 1 : x1 + 1]
    assert not np.allclose(part["combined"], beside, atol=1e-2)


def test_a_scene_of_several_objects(renderer, swatch, camera):
    scene = lisle.Scene(camera, [lisle.Sun(direction=(-1, 1, -2), strength=3)])
    beside = np.eye(4)
    beside[0, 3] = 0.5 * np.ptp(swatch.points[:, 0])
    before = np.eye(4)
    before[:3, :3] *= 0.5
    before[1, 3] = -0.02
    scene.add(swatch, transform=beside, object_id=5)
    scene.add(swatch, transform=before, object_id=2**32 - 1, material=lisle.Material.preset("silk"))
    ids = renderer.render(scene, samples=1)["object_id"]
    assert set(np.unique(ids)) == {0, 5, 2**32 - 1}
    assert ids[HEIGHT // 2, WIDTH // 2] in (2**32 - 1, 0)


def test_an_empty_scene_is_an_empty_picture(renderer, camera):
    image = renderer.render(lisle.Scene(camera), samples=1)
    assert (image["combined"] == 0).all()
    assert (image["object_id"] == 0).all()


def test_defaults_draw(renderer, swatch):
    assert renderer.render(swatch, size=(32, 24), samples=1)["alpha"].max() > 0.5


def test_statistics(draw, swatch):
    statistics = draw().statistics
    assert statistics["segments"] == len(swatch.points) - len(swatch)
    assert statistics["fiber_lines"] >= statistics["fiber_segments"] > 0
    assert statistics["gpu_bytes"] >= statistics["knot_bytes"] > 0
    assert statistics["adapter"]


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (dict(samples=0), "samples"),
        (dict(samples=-1), "samples"),
        (dict(samples="many"), "samples"),
        (dict(size=(0, 10)), "size"),
        (dict(size=(10,)), "size"),
        (dict(shading="toon"), "toon"),
        (dict(occlusion="none"), "occlusion"),
        (dict(lod_pixels=-1.0), "lod_pixels"),
        (dict(filter_width=math.nan), "filter_width"),
        (dict(shadow_resolution=8), "shadow_resolution"),
        (dict(table_resolution=0), "table_resolution"),
        (dict(table_resolution=5), "table_resolution"),
        (dict(sky_directions=0), "sky_directions"),
        (dict(sky_directions=9), "sky_directions"),
        (dict(region=(0, 0, 0, 10)), "region"),
        (dict(region=(0, 0, WIDTH + 1, 10)), "region"),
        (dict(region=(1, 2, 3)), "region"),
        (dict(ambient=(1, 1)), "ambient"),
        (dict(lights=["sun"]), "light 0"),
        (dict(yarn="cotton-1"), "yarn"),
    ],
)
def test_bad_arguments_are_named(draw, options, word):
    with pytest.raises(lisle.InputError, match=word):
        draw(**options)


def test_a_scene_has_its_own_lights(renderer, camera, swatch):
    scene = lisle.Scene(camera)
    scene.add(swatch)
    with pytest.raises(lisle.InputError, match="lights: the scene has its own"):
        renderer.render(scene, lights=[])
    for what, found in ((3, "int"), ([3], "int"), ([], "list")):
        with pytest.raises(lisle.InputError, match=f"got {found}"):
            renderer.render(what)


def test_an_unknown_adapter_is_refused_with_the_known_ones():
    with pytest.raises(lisle.DeviceError, match="no such thing"):
        lisle.Renderer("no such thing")


def test_adapters(renderer):
    names = [adapter.name for adapter in lisle.adapters()]
    assert renderer.adapter.name in names
    assert lisle.Renderer(renderer.adapter.name[:5].upper()).adapter.name.startswith(renderer.adapter.name[:5])


def test_filters_blur_by_their_width(draw):
    def roughness(**options):
        return np.abs(np.diff(draw(samples=64, **options)["alpha"], axis=1)).sum()

    sharp = roughness(filter_width=0.01)
    assert roughness() < 0.97 * sharp
    assert roughness(filter="box", filter_width=3.0) < 0.8 * sharp
    assert roughness(filter="gaussian", filter_width=6.0) < roughness(filter="gaussian") < 1.02 * sharp
    with pytest.raises(lisle.InputError, match='filter: "sinc" is none of'):
        draw(filter="sinc")


def test_a_picture_stops_when_it_is_smooth(draw):
    rough = draw(samples=256, noise_threshold=1.0)
    smooth = draw(samples=256, noise_threshold=0.03)
    assert rough.statistics["samples"] == 16
    assert rough.statistics["samples"] < smooth.statistics["samples"]
    assert draw(samples=24, noise_threshold=1e-6).statistics["samples"] == 24
    # It is the picture of as many samples.
    alone = draw(samples=16)
    for name in alone:
        np.testing.assert_array_equal(rough[name], alone[name], err_msg=name)
    # And the threshold says how far it is from the end.
    end = draw(samples=1024)["combined"]
    covered = end[..., 3] > 0

    def error(image):
        relative = (image["combined"] - end) / np.sqrt(np.maximum(end, 1e-3))
        return float(np.sqrt((relative[covered] ** 2).mean()))

    assert error(smooth) < 0.03 < 3 * error(rough)
    with pytest.raises(lisle.InputError, match="noise_threshold"):
        draw(noise_threshold=-1)


def test_a_picture_stops_in_time(draw):
    image = draw(samples=65536, time_limit_s=0.5)
    assert 1 <= image.statistics["samples"] < 65536
    assert np.isfinite(image["combined"]).all() and image["alpha"].max() == pytest.approx(1)
    with pytest.raises(lisle.InputError, match="time_limit_s"):
        draw(time_limit_s=0)


def test_seeds_change_the_noise_alone(draw):
    first, second, again = (draw(samples=16, seed=seed) for seed in (1, 2, 1))
    np.testing.assert_array_equal(first["combined"], again["combined"])
    assert (first["combined"] != second["combined"]).any()
    assert first["combined"].mean() == pytest.approx(second["combined"].mean(), rel=0.02)
    np.testing.assert_array_equal(first["depth"], second["depth"])


def test_moving_yarns_and_cameras_are_lists(renderer, swatch, camera):
    shifted = swatch.with_points(swatch.points + np.float32([0.01, 0, 0]))
    options = {"samples": 8, "ambient": (1, 1, 1)}
    still = renderer.render(swatch, camera=camera, **options)
    moving = renderer.render([swatch, shifted], camera=camera, **options)
    assert (moving["alpha"] > 0).sum() > 1.05 * (still["alpha"] > 0).sum()
    same = renderer.render([swatch, swatch], camera=[camera, camera], **options)
    np.testing.assert_array_equal(same["combined"], still["combined"])
    other = lisle.knit_swatch(courses=6, wales=6)
    for what, cameras, words in (
        ([swatch, other], camera, "another rest shape"),
        ([swatch, shifted], [camera] * 3, "time steps: there are 2, expected 3"),
    ):
        with pytest.raises(lisle.InputError, match=words):
            renderer.render(what, camera=cameras, **options)
    with pytest.raises(lisle.InputError, match="both or neither"):
        renderer.render(swatch, camera=camera, before=shifted)
    ends = {"before": swatch, "after": shifted}
    vectors = renderer.render(swatch, camera=camera, passes=["vector"], **ends, **options)["vector"]
    covered = still["depth"] < 1e9
    assert np.abs(vectors[..., :2]).max() < 0.01 and (vectors[covered][:, 2] < -0.5).all()
    with pytest.raises(lisle.InputError, match="'beauty' is none of position"):
        renderer.render(swatch, camera=camera, passes=["beauty"])
