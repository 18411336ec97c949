import math

import lisle
import numpy as np
import pytest
from conftest import line


@pytest.mark.parametrize("direction", [(0, -1, 0.3), (1, 0, 0), (0, 0, 1), (0, 0, -5), (-3, 2, -1)])
@pytest.mark.parametrize("size", [(1280, 960), (200, 900)])
def test_a_fitted_camera_sees_every_point_and_not_much_else(direction, size):
    yarns = lisle.knit_tube(courses=12, wales=24)
    camera = lisle.Camera.fit(yarns, direction, size)
    assert camera.size == size
    clip_from_world = camera.clip_from_camera @ np.linalg.inv(camera.world_from_camera)
    clip = np.column_stack([yarns.points, np.ones(len(yarns.points))]) @ clip_from_world.T
    assert (clip[:, 3] > 0).all()
    view = clip[:, :3] / clip[:, 3:]
    assert (np.abs(view) < 1).all()
    assert np.abs(view[:, :2]).max() > 0.7
    rotation = camera.world_from_camera[:3, :3]
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1)
    np.testing.assert_allclose(rotation[:, 2], np.array(direction) / np.linalg.norm(direction), atol=1e-12)


def test_a_camera_keeps_its_matrices():
    world_from_camera = np.eye(4)
    world_from_camera[:3, 3] = 1, 2, 3
    camera = lisle.Camera.from_matrices(world_from_camera.tolist(), np.diag([1, 2, -1, 1]), (20, 10))
    np.testing.assert_array_equal(camera.world_from_camera, world_from_camera)
    np.testing.assert_array_equal(camera.clip_from_camera, np.diag([1.0, 2.0, -1.0, 1.0]))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: lisle.Camera.from_matrices(np.eye(3), np.eye(4), (1, 1)), ["world_from_camera", "(3, 3)"]),
        (lambda: lisle.Camera.from_matrices(np.eye(4), np.eye(4) * np.nan, (1, 1)), ["clip_from_camera", "[0, 0]"]),
        (lambda: lisle.Camera.from_matrices(np.eye(4), np.zeros((4, 4)), (1, 1)), ["clip_from_camera", "singular"]),
        (lambda: lisle.Camera.from_matrices(np.eye(4), np.eye(4), (0, 1)), ["size", "0×1"]),
        (lambda: lisle.Camera(np.eye(4), np.eye(4), (1, 1), aperture_radius=-1), ["Camera.aperture_radius", "-1"]),
        (lambda: lisle.Camera(np.eye(4), np.eye(4), (1, 1), focus_distance=0), ["Camera.focus_distance", "0"]),
        (lambda: lisle.Camera(np.eye(4), np.eye(4), (1, 1), ratio=math.nan), ["Camera.ratio", "nan"]),
        (lambda: lisle.Camera(np.eye(4), np.eye(4), (1, 1), blades=-3), ["Camera.blades", "-3"]),
        (lambda: lisle.Sun(direction=(0, 0, 0)), ["Sun.direction"]),
        (lambda: lisle.Sun(direction=(0, 0, 1), strength=-1), ["Sun.strength", "-1"]),
        (lambda: lisle.Gaussian(direction=(0, 0, 0)), ["Gaussian.direction"]),
        (lambda: lisle.Gaussian((0, 0, 1), strength=-2), ["Gaussian.strength", "-2"]),
        (lambda: lisle.Gaussian((0, 0, 1), sharpness=0), ["Gaussian.sharpness", "0", "1e-06"]),
        (lambda: lisle.Gaussian((0, 0, 1), sharpness=math.nan), ["Gaussian.sharpness", "nan"]),
        (lambda: lisle.Gaussian((0, 0, 1), sharpness="wide"), ["Gaussian.sharpness", "'wide'"]),
        (lambda: lisle.Gaussian((0, 0, 1), color=(1, 1)), ["Gaussian.color", "three numbers"]),
        (lambda: lisle.Point(position=(0, 0)), ["Point.position", "three numbers"]),
        (lambda: lisle.Point(position=(0, 0, math.inf)), ["Point.position", "inf"]),
        (lambda: lisle.Spot((0, 0, 0), (0, 0, 1), cone_angle_rad=4), ["Spot.cone_angle_rad"]),
        (lambda: lisle.Spot((0, 0, 0), (0, 0, 1), blend=2), ["Spot.blend"]),
        (lambda: lisle.Area(np.zeros((4, 4))), ["Area.world_from_light", "singular"]),
        (lambda: lisle.Area(np.eye(4), size=(1, 0)), ["Area.size"]),
        (lambda: lisle.Area(np.eye(4), shape="star"), ["Area.shape", "star"]),
        (lambda: lisle.Camera(np.eye(4), np.eye(4), (1, 1), blades="six"), ["Camera.blades", "'six'"]),
        (lambda: lisle.Camera(np.eye(4), np.eye(4), (1, 1), blades=1.5), ["Camera.blades", "1.5"]),
        (lambda: lisle.Environment(np.ones((1, 2, 3)), rotation="east"), ["Environment.rotation", "'east'"]),
        (lambda: lisle.knit_swatch(7), ["pattern", "7"]),
        (lambda: lisle.knit_swatch(courses="many"), ["courses", "'many'"]),
        (lambda: lisle.woven_swatch(warp=2.5), ["warp", "2.5"]),
        (lambda: lisle.sweater("all"), ["points", "'all'"]),
        (lambda: lisle.Renderer(3), ["adapter", "3"]),
        (lambda: lisle.Mesh([(0, 0, 0)], [(0, 0, 0)], normals="up"), ["mesh: normals", "str"]),
        (lambda: lisle.Mesh([(0, 0, 0)], [(0, 0, 0)], object_id="first"), ["mesh: object_id", "'first'"]),
        (lambda: lisle.Mesh([(0, 0, 0)], [(0, 0, 0)], material_index=1.5), ["mesh: material_index", "1.5"]),
    ],
)
def test_bad_cameras_and_lights_are_refused_by_name(make, words):
    with pytest.raises(lisle.InputError) as caught:
        make()
    for word in words:
        assert word in str(caught.value)


def test_what_is_added_to_a_scene_is_checked(swatch, camera):
    scene = lisle.Scene(camera)
    scene.add(swatch, name="front")
    assert [(added.name, added.object_id) for added in scene.objects] == [("front", 1)]
    for arguments, words in [
        (dict(yarns="swatch"), "Yarns"),
        (dict(yarns=swatch, yarn="cotton-1"), "back: yarn"),
        (dict(yarns=swatch, material=lisle.Yarn.preset("silk-1")), "back: material"),
        (dict(yarns=swatch, transform=np.eye(3)), "back: transform"),
        (dict(yarns=swatch, object_id=0), "back: object_id 0"),
        (dict(yarns=swatch, object_id="front"), "back: object_id: expected a whole number, got 'front'"),
        (dict(yarns=swatch, object_index=None), "back: object_index: expected a whole number, got None"),
    ]:
        with pytest.raises(lisle.InputError, match=words):
            scene.add(**arguments, name="back")
    with pytest.raises(lisle.InputError, match="light 1: expected a Sun, Gaussian, Point, Spot or Area, got str"):
        lisle.Scene(camera, [lisle.Sun((0, 0, -1)), "lamp"])
    with pytest.raises(lisle.InputError, match="camera"):
        lisle.Scene(None)
    with pytest.raises(lisle.InputError, match="lights: expected a list of lights, got Sun"):
        lisle.Scene(camera, lisle.Sun((0, 0, -1)))
    with pytest.raises(lisle.InputError, match="meshes: expected a list of meshes, got int"):
        lisle.Scene(camera, meshes=3)


def test_makers_of_cloth():
    swatch = lisle.knit_swatch("rib-2-2", courses=5, wales=8)
    assert len(swatch) == 5
    assert not swatch.closed.any()
    assert lisle.knit_tube(courses=5, wales=12).closed.all()
    straight = lisle.knit_sleeve([(0, 0, 0), (0, 0, 0.1), (0, 0, 0.2)], 0.03, courses=8, wales=20)
    bent = lisle.knit_sleeve([(0, 0, 0), (0, 0, 0.1), (0.1, 0, 0.15)], 0.03, courses=8, wales=20)
    assert straight.with_points(bent.points).points.shape == straight.points.shape
    assert lisle.sweater(20_000).points.shape[0] <= 20_000
    np.testing.assert_array_equal(lisle.knit_swatch("kp pk").points, lisle.knit_swatch("KP PK").points)
    woven = lisle.woven_swatch("twill-2-1", warp=6, weft=9, yarn_radius=0.002, spacing=1.2)
    assert len(woven) == 15 and not woven.closed.any()
    np.testing.assert_array_equal(woven.points, lisle.woven_swatch("oxx xxo xox", 6, 9, 0.002, 1.2).points)
    upwards = np.ptp(woven.points[: woven.offsets[6]].reshape(6, -1, 3), axis=1)
    assert (upwards[:, 2] > 10 * upwards[:, 0]).all()
    for call, word in [
        (lambda: lisle.woven_swatch("satin-6"), "satin of 6"),
        (lambda: lisle.woven_swatch("twill-2-0"), "warp yarn 0"),
        (lambda: lisle.woven_swatch("velvet"), "'v'"),
        (lambda: lisle.woven_swatch(warp=0), "0 warp"),
        (lambda: lisle.woven_swatch(spacing=0.9), "spacing 0.9"),
        (lambda: lisle.knit_swatch("knots"), "pattern row 0 .*, column 1: 'n' is neither 'k'"),
        (lambda: lisle.knit_swatch(courses=0), "0 courses"),
        (lambda: lisle.knit_swatch(courses=-1), "courses"),
        (lambda: lisle.knit_swatch(yarn_radius=0), "radius"),
        (lambda: lisle.knit_tube("rib-2-2", wales=13), "13 wales"),
        (lambda: lisle.knit_sleeve([(0, 0, 0)], 0.1), "centre line"),
        (lambda: lisle.sweater(10), "10"),
    ]:
        with pytest.raises(lisle.InputError, match=word):
            call()


def square(size=0.1):
    """positions, normals, triangles, uvs of an upright square that faces −Y."""
    positions = size * np.array([(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)], np.float32)
    triangles = np.array([(0, 1, 2), (0, 2, 3)])
    return positions, np.tile([0.0, -1.0, 0.0], (4, 1)), triangles, positions[triangles][:, :, ::2] / size


def test_knit_on_a_mesh_follows_it():
    positions, normals, triangles, uvs = square()
    knit = lisle.knit_on_mesh(positions, normals, triangles, uvs, "garter", 0.001)
    np.testing.assert_allclose(knit.weights.sum(axis=1), 1, atol=1e-6)
    assert np.ptp(knit.heights) > 0.003 and knit.vertices.max() == 3
    np.testing.assert_allclose(knit.yarns.points[:, 1], -knit.heights, atol=1e-9)
    turn = np.array([(0, -1, 0), (1, 0, 0), (0, 0, 1)])
    moved = knit.follow(positions @ turn.T + (1, 2, 3), normals @ turn.T)
    np.testing.assert_allclose(moved.points, knit.yarns.points @ turn.T + (1, 2, 3), atol=1e-6)
    np.testing.assert_array_equal(moved.length_coordinates, knit.yarns.length_coordinates)
    twice = np.concatenate([triangles, triangles])
    for call, word in [
        (lambda: lisle.knit_on_mesh(positions, normals, triangles, uvs[:1]), "uvs: expected"),
        (lambda: lisle.knit_on_mesh(positions, normals, triangles[:, :2], uvs), "triangles: expected"),
        (lambda: lisle.knit_on_mesh(positions, normals[:2], triangles, uvs), "2 normals"),
        (lambda: lisle.knit_on_mesh(positions, normals, triangles - 1, uvs), "out of range"),
        (lambda: lisle.knit_on_mesh(positions, normals, twice, np.concatenate([uvs, uvs])), "overlaps"),
        (lambda: lisle.knit_on_mesh(positions, normals, triangles, 0 * uvs), "no area"),
        (lambda: lisle.knit_on_mesh(positions, normals, triangles, uvs, yarn_radius=0.1), "no stitch fits"),
    ]:
        with pytest.raises(lisle.InputError, match=word):
            call()


def test_one_straight_yarn_has_a_camera_too():
    camera = lisle.Camera.fit(lisle.Yarns(line(), [0, 5], yarn_radius=0.01), direction=(1, 0, 0))
    assert np.isfinite(camera.world_from_camera).all()


@pytest.mark.parametrize("by", ["renderer", "reference"])
def test_a_holdout_is_a_hole(renderer, swatch, camera, by):
    """It shows nothing, not even the background, and hides the same cloth behind it, but where that stands aside."""
    aside = np.eye(4)
    aside[0, 3] = 0.5 * np.ptp(swatch.points[:, 0])
    aside[1, 3] = 0.02

    def draw(*holdouts, transparent=True):
        scene = lisle.Scene(camera, [lisle.Sun(direction=(-1, 1, -2), strength=3.0)], (0.2, 0.3, 0.4))
        for transform, holdout in zip((np.eye(4), aside), holdouts, strict=False):
            scene.add(swatch, transform=transform, holdout=holdout)
        if by == "reference":
            return lisle.Reference().render(scene, samples=1, filter_width=0, bounces=1, transparent=transparent)
        options = {"samples": 1, "filter_width": 0, "lod_pixels": 0, "transport_photons": 0}
        return renderer.render(scene, transparent=transparent, **options)

    plain, hole = draw(False), draw(True)
    assert plain["alpha"].max() == 1 and not hole["combined"].any()
    before_background = draw(True, transparent=False)["combined"]
    covered = plain["alpha"] == 1
    assert not before_background[covered].any() and (before_background[~covered][:, 3] == 1).all()
    both = draw(True, False)["combined"]
    assert not both[covered].any(), "it hides what is behind"
    assert both.any()
