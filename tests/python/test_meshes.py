"""Meshes in scenes from Python."""

import lisle
import numpy as np
import pytest
from conftest import line

SIZE = (64, 48)
SQUARE = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float32)
HALVES = [(0, 1, 2), (0, 2, 3)]


@pytest.fixture(scope="module")
def yarns():
    return lisle.Yarns(line(20, 0.1) - [1, 0, 0], [0, 20], yarn_radius=0.1)


def from_above():
    """Shows x, y in -1.6 to 1.6 by -1.2 to 1.2."""
    world_from_camera = np.eye(4)
    world_from_camera[2, 3] = 5
    return lisle.Camera(world_from_camera, np.diag([1 / 1.6, 1 / 1.2, -0.02, 1.0]) + 0.0, SIZE)


def square(z=0.0, scale=1.0, **options):
    transform = np.diag([scale, scale, scale, 1.0])
    transform[2, 3] = z
    return lisle.Mesh(SQUARE, HALVES, transform=transform, **options)


def draw(renderer, yarns, meshes, **options):
    settings = {"lights": [lisle.Sun(direction=(0, 0.6, -0.8), strength=np.pi)], "samples": 1, "filter_width": 0.0}
    return renderer.render(yarns, camera=from_above(), meshes=meshes, **settings | options)


def test_a_mesh_hides_and_is_numbered(renderer, yarns):
    below = draw(renderer, yarns, [square(z=-0.5)])
    assert set(np.unique(below["object_id"])) == {0, 1, 2}
    above = draw(renderer, yarns, [square(z=0.5, object_id=40)])
    assert set(np.unique(above["object_id"])) >= {0, 40}
    assert (above["object_id"][24, 15:50] == 40).all()
    lit = below["combined"][30, 32]
    np.testing.assert_allclose(lit, (0.64, 0.64, 0.64, 1), rtol=1e-3)


def test_meshes_are_in_the_manifest(renderer, yarns):
    image = draw(renderer, yarns, [square(z=0.5, name="Table")], passes=["crypto_object"])
    number = np.array([image.manifests["crypto_object"]["Table"]], np.uint32).view(np.float32)[0]
    assert image["crypto_object"][24, 32, 0] == number and image["crypto_object"][24, 32, 1] == 1


def test_labels_of_meshes_reach_their_passes(renderer, yarns):
    table = square(z=0.5, object_index=7, material_name="Oak", material_index=9)
    image = draw(renderer, yarns, [table], passes=["crypto_material", "object_index", "material_index"])
    number = np.array([image.manifests["crypto_material"]["Oak"]], np.uint32).view(np.float32)[0]
    assert image["crypto_material"][24, 32, 0] == number and image["crypto_material"][24, 32, 1] == 1
    assert (image["object_index"][24, 32], image["material_index"][24, 32]) == (7, 9)
    moved = table.at(table.world_from_object, object_index=8)
    assert (moved.object_index, moved.material_name, moved.material_index) == (8, "Oak", 9)


def test_kinds_and_colours(renderer, yarns):
    shaded = draw(renderer, yarns, [square(z=-0.5, base_color=(0.5, 0.25, 0.0))])
    np.testing.assert_allclose(shaded["combined"][30, 32], (0.4, 0.2, 0, 1), rtol=1e-3)
    caught = draw(renderer, yarns, [square(z=-0.5, kind="shadow-catcher")])
    rows = caught["alpha"][:, 32]
    assert rows[16] > 0.9 and rows[30] == 0.0, "the shadow lies 0.5 · 0.6 / 0.8 beside the yarn"
    hole = draw(renderer, yarns, [square(z=-0.5, kind="holdout")], transparent=False, ambient=(0.3, 0.3, 0.3))
    assert not hole["combined"][30, 32].any() and hole["alpha"][2, 32] == 1


def test_normals_by_corner_and_by_position(renderer, yarns):
    slanting = np.tile(np.array((0.3, 0.0, 1.0), np.float32), (4, 1))
    a = draw(renderer, yarns, [lisle.Mesh(SQUARE - [0, 0, 0.5], HALVES, slanting)])
    b = draw(renderer, yarns, [lisle.Mesh(SQUARE - [0, 0, 0.5], HALVES, slanting[np.array(HALVES)])])
    np.testing.assert_array_equal(a["combined"], b["combined"])
    np.testing.assert_allclose(a["normal"][30, 32], slanting[0] / np.linalg.norm(slanting[0]), atol=1e-3)


def test_instances_share_their_geometry(renderer, yarns):
    mesh = square(z=-0.5)
    far = np.eye(4)
    far[2, 3] = -1
    other = mesh.at(far, name="other")
    assert other.triangles is mesh.triangles and mesh.world_from_object[2, 3] == -0.5
    assert set(np.unique(draw(renderer, yarns, [mesh, other])["object_id"])) == {0, 1, 2}


@pytest.mark.parametrize(
    "arguments, message",
    [
        (((SQUARE, [(0, 1, 4)]), {}), r"mesh: triangle 0 is \[0, 1, 4\], but there are 4"),
        (((SQUARE, [(0, 1, -1)]), {}), "triangle 0"),
        (((SQUARE[:, :2], HALVES), {}), r"positions: expected shape \(n, 3\)"),
        (((SQUARE * np.nan, HALVES), {}), "position 0"),
        (((SQUARE, HALVES, SQUARE[:3]), {}), "normals: expected shape"),
        (((SQUARE, HALVES), {"kind": "glass"}), "kind: 'glass'"),
        (((SQUARE, HALVES), {"base_color": (2, 0, 0)}), "base_color"),
        (((SQUARE, HALVES), {"object_id": 0}), "object_id 0"),
        (((SQUARE, HALVES), {"transform": np.eye(3)}), "transform"),
    ],
)
def test_what_is_no_mesh_is_named(arguments, message):
    positional, named = arguments
    with pytest.raises(lisle.InputError, match=message):
        lisle.Mesh(*positional, **named)


def test_a_scene_takes_meshes_alone(renderer, yarns):
    with pytest.raises(lisle.InputError, match=r"mesh 0: expected a lisle\.Mesh"):
        lisle.Scene(from_above(), meshes=[SQUARE])
    scene = lisle.Scene(from_above(), [lisle.Sun(direction=(0, 0, -1))], meshes=[square()])
    assert set(np.unique(renderer.render(scene, samples=1)["object_id"])) == {0, 1}
    traced = lisle.Reference().render(scene, samples=2)
    np.testing.assert_allclose(traced["combined"][24, 32], (0.8 / np.pi,) * 3 + (1.0,), rtol=1e-3)
    assert set(np.unique(traced["object_id"])) == {0, 1}


def test_shadows_are_those_of_the_path_tracer(renderer, yarns):
    """A plate shades one half of a yarn, and the yarn a floor."""
    floor = square(z=-0.5, scale=4.0, base_color=(0.5, 0.5, 0.5))
    turned = np.diag([1.0, 1.0, 1.0, 1.0])
    turned[:3, 3] = (1.0, -0.85, 1.0)
    # In the sun's way to the half at x > 0: 1 above the yarn, and beside it for the camera.
    plate = lisle.Mesh(SQUARE * (1.0, 0.7, 1.0), HALVES, transform=turned)
    # Fibers without glints, whose means converge.
    matt = lisle.Material.preset("silk").replace(diffuse=(0.6,) * 3, specular=(0.0,) * 3)
    options = {"material": matt, "shading": "simple", "filter_width": 1.0}

    def both(meshes):
        rendered = draw(renderer, yarns, meshes, samples=64, lod_pixels=0, **options)
        traced = draw(lisle.Reference(), yarns, meshes, samples=64, bounces=1, **options)
        return [image["combined"][..., 0].astype(np.float64) for image in (rendered, traced)]

    (ours, expected), (ours_open, open_) = both([floor, plate]), both([floor])
    on_yarn = slice(23, 25)
    for picture, free in ((ours, ours_open), (expected, open_)):
        shares = picture[on_yarn].mean(axis=0) / free[on_yarn].mean(axis=0)
        assert (np.abs(shares[15:29] - 1.0) < 0.05).all(), "the half in the sun stays as it is"
        assert (shares[35:50] < 0.02).all(), "the other is dark"
    # Where the edge of the shadow lies, the brightness of plate and floor, and the yarn's shadow on the floor.
    np.testing.assert_allclose(
        *((a[on_yarn].sum(axis=0) / b[on_yarn].sum(axis=0))[15:50] for a, b in ((ours, ours_open), (expected, open_))),
        atol=0.05,
    )
    np.testing.assert_allclose(ours[28:46, 15:50].mean(), expected[28:46, 15:50].mean(), rtol=0.02)
    rows = slice(12, 21)
    lit = open_[44, 17:47].mean()
    shade, expected_shade = (picture[rows, 17:47].mean(axis=1) / lit for picture in (ours_open, open_))
    # The renderer's shadow on a mesh is that of the yarn's tube: nearly a row more on either side.
    np.testing.assert_allclose(shade[[0, 1, 3, 4, 5, 7, 8]], (1, 1, 0, 0, 0, 1, 1), atol=0.02)
    np.testing.assert_allclose(expected_shade[[0, 1, 3, 4, 5, 7, 8]], (1, 1, 0, 0, 0, 1, 1), atol=0.02)
    assert (expected_shade >= shade - 0.01).all()


def scene_with(yarns, mesh):
    scene = lisle.Scene(from_above(), [lisle.Sun(direction=(0, 0, -1), strength=np.pi)], meshes=[mesh])
    scene.add(yarns)
    return scene


def expose(renderer, yarns, meshes, **options):
    """Through a shutter; one mesh is a picture without motion."""
    scenes = [scene_with(yarns, mesh) for mesh in meshes]
    return renderer.render(scenes if len(scenes) > 1 else scenes[0], **{"filter_width": 0.0, "samples": 64} | options)


def shifted(distance):
    transform = np.eye(4)
    transform[0, 3] = distance
    return transform


def test_meshes_blur_by_moving_and_by_changing_their_shape(renderer, yarns):
    small = 0.4 * SQUARE + [0, 0.6, 0.5]
    still = lisle.Mesh(small, HALVES)
    before = expose(renderer, yarns, [still])["combined"]
    moved = expose(renderer, yarns, [still.at(shifted(-0.4)), still.at(shifted(0.4))])["alpha"][12]
    # Of the shutter's time, a place is covered as long as the square of 0.8 m takes to pass: it travels 0.8 m.
    x = (np.arange(64) + 0.5) / 20 - 1.6
    expected = np.clip(1 - np.abs(x) / 0.8, 0, 1)
    np.testing.assert_allclose(moved, expected, atol=0.04)
    ends = [lisle.Mesh(small + [side, 0, 0], HALVES) for side in (-0.4, 0.4)]
    changed = expose(renderer, yarns, ends)["alpha"][12]
    np.testing.assert_allclose(changed, expected, atol=0.04)
    # Nothing of it is left behind.
    np.testing.assert_array_equal(expose(renderer, yarns, [still])["combined"], before)
    first = expose(renderer, yarns, ends[:1])["alpha"]
    np.testing.assert_array_equal(first, expose(lisle.Renderer(), yarns, ends[:1])["alpha"])


def test_shadows_of_meshes_blur_with_them(renderer, yarns):
    """A roof beyond the picture throws a shadow on the floor that wanders while the shutter is open."""
    floor = lisle.Mesh(2 * SQUARE - [0, 0, 1], HALVES)
    roof = 0.4 * SQUARE + [0, 2.6, 1]

    def scene(offset):
        roofs = lisle.Mesh(roof + [offset, 0, 0], HALVES)
        scene = lisle.Scene(from_above(), [lisle.Sun(direction=(0, -1, -1), strength=1)], meshes=[floor, roofs])
        scene.add(yarns)
        return scene

    lit = renderer.render([scene(-0.4), scene(0.4)], samples=64, filter_width=0.0)["combined"][12, :, 0]
    expected = np.clip(np.abs((np.arange(64) + 0.5) / 20 - 1.6) / 0.8, 0, 1) * lit.max()
    np.testing.assert_allclose(lit, expected, atol=0.12 * lit.max())


def test_meshes_that_are_others_stay_as_they_are(renderer, yarns):
    still = lisle.Mesh(0.4 * SQUARE + [0, 0.6, 0.5], HALVES)
    plain = expose(renderer, yarns, [still])["alpha"]
    other = lisle.Mesh(0.8 * SQUARE + [0, 0.6, 0.5], HALVES[:1])
    np.testing.assert_array_equal(expose(renderer, yarns, [still, other])["alpha"], plain)
    without = scene_with(yarns, still)
    without.meshes = ()
    scenes = [scene_with(yarns, still.at(shifted(0.3))), without]
    held = renderer.render(scenes, filter_width=0.0, samples=64)["alpha"]
    assert held[12, 32 + 6] == 1, "where it is at first"


def test_vectors_of_meshes_follow_their_shape(renderer, yarns):
    def bent(lean, up, transform=None):
        return lisle.Mesh(
            SQUARE + [0, 0, 0.5] + np.outer(SQUARE[:, 1], [lean, 0, 0]) + [0, up, 0], HALVES, transform=transform
        )

    ends = {"before": scene_with(yarns, bent(-0.1, 0)), "after": scene_with(yarns, bent(0, 0.05, shifted(0.2)))}
    image = renderer.render(scene_with(yarns, bent(0, 0)), passes=["vector"], samples=1, **ends)
    inside = image["vector"][6:42, 14:50]
    y = 1.2 - (np.arange(48) + 0.5)[6:42, None] / 20
    per_metre = 20
    expected = np.stack(
        np.broadcast_arrays(-0.1 * y * per_metre, 0 * y, -0.2 * per_metre + 0 * y, -0.05 * per_metre + 0 * y), -1
    )
    np.testing.assert_allclose(inside, np.broadcast_to(expected, inside.shape), atol=0.01)
    rigid = {name: scene_with(yarns, bent(0, 0)) for name in ends}
    assert not renderer.render(scene_with(yarns, bent(0, 0)), passes=["vector"], samples=1, **rigid)["vector"].any()


def textured(codes, uvs=None, **options):
    """The square below the yarn, under a picture; from corner to corner unless `uvs` are given."""
    at_corners = (SQUARE[:, :2] + 1) / 2 if uvs is None else uvs
    return lisle.Mesh(
        SQUARE - [0, 0, 0.5], HALVES, uvs=at_corners[np.array(HALVES)], texture=lisle.Texture(codes), **options
    )


def light_of(codes):
    """Scene-linear."""
    code = np.asarray(codes) / 255
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


QUARTERS = np.array([[(255, 0, 0), (0, 128, 0)], [(0, 0, 64), (200, 200, 10)]], np.uint8)
"""Red and green above blue and yellow."""


def test_pictures_lie_on_meshes_by_their_uvs(renderer, yarns):
    image = draw(renderer, yarns, [textured(np.kron(QUARTERS, np.ones((8, 8, 1), np.uint8)))], passes=["albedo"])
    # Within the quarters, beside the shadow of the yarn.
    within = [((8, 22), (8, 42)), ((34, 22), (34, 42))]
    for codes, places in zip(QUARTERS, within, strict=True):
        for code, place in zip(codes, places, strict=True):
            np.testing.assert_allclose(image["combined"][place][:3], 0.8 * light_of(code), atol=1e-4)
            np.testing.assert_allclose(image["albedo"][place], light_of(code), atol=1e-4)
    # Half as large and moved by half a picture, it repeats: what lay at a place of four quarters lies at each.
    corners = SQUARE[:, :2] + 1.5
    twice = draw(renderer, yarns, [textured(np.kron(QUARTERS, np.ones((8, 8, 1), np.uint8)), corners)])["combined"]
    np.testing.assert_allclose(twice[8, 22, :3], twice[28, 42, :3], atol=1e-4)
    assert not np.allclose(twice[8, 22, :3], image["combined"][8, 22, :3], atol=0.05)


def test_pictures_are_interpolated_between_texels(renderer, yarns):
    ramp = np.array([[(0, 0, 0), (255, 255, 255)]], np.uint8)
    row = draw(renderer, yarns, [textured(ramp)])["combined"][34, 14:50, 0] / 0.8
    x = (np.arange(64) + 0.5)[14:50] / 20 - 1.6
    # Middles of texels lie at x = ±0.5; beyond, the next repetition begins.
    expected = np.interp(x, (-1.5, -0.5, 0.5, 1.5), (1, 0, 1, 0))
    np.testing.assert_allclose(row, expected, atol=1e-3)


def test_instances_have_pictures_of_their_own(renderer, yarns):
    red, blue = (np.full((2, 2, 3), code, np.uint8) for code in ((255, 0, 0), (0, 0, 255)))
    shared = textured(red)
    other = textured(blue, transform=shifted(1.6))
    plain = lisle.Mesh(SQUARE - [0, 0, 0.5], HALVES, transform=shifted(-1.6), base_color=(0, 1, 0))
    row = draw(renderer, yarns, [shared.at(shifted(0)), plain, other])["combined"][34, :, :3]
    assert row[4].tolist() == pytest.approx([0, 0.8, 0], abs=1e-3)
    assert row[32].tolist() == pytest.approx([0.8, 0, 0], abs=1e-3)
    assert row[60].tolist() == pytest.approx([0, 0, 0.8], abs=1e-3)
    again = draw(renderer, yarns, [textured(blue)])["combined"][34, 32, :3]
    assert again.tolist() == pytest.approx([0, 0, 0.8], abs=1e-3)
    traced = draw(lisle.Reference(), yarns, [textured(QUARTERS)])["combined"][34, 32, :3]
    mean = light_of(QUARTERS).mean(axis=(0, 1))
    np.testing.assert_allclose(traced, 0.8 * mean, rtol=0.2)
    np.testing.assert_allclose(textured(QUARTERS).base_color, mean, rtol=1e-6)


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: lisle.Texture(np.zeros((2, 2, 3))), "expected .h, w, 3. or .h, w, 4. uint8, got .2, 2, 3. float64"),
        (lambda: lisle.Texture(np.zeros((2, 0, 3), np.uint8)), "Texture"),
        (lambda: lisle.Texture("picture.png"), "Texture"),
        (lambda: lisle.Mesh(SQUARE, HALVES, texture=lisle.Texture(QUARTERS)), "mesh: texture: it needs uvs"),
        (lambda: lisle.Mesh(SQUARE, HALVES, texture=QUARTERS), "mesh: texture: expected a lisle.Texture, got ndarray"),
        (lambda: lisle.Mesh(SQUARE, HALVES, uvs=SQUARE[:, :2]), r"uvs: expected shape \(2, 3, 2\), got \(4, 2\)"),
        (lambda: lisle.Mesh(SQUARE, HALVES, uvs=np.full((2, 3, 2), np.nan)), "UV coordinates of triangle 0"),
    ],
)
def test_what_is_no_picture_is_named(make, message):
    with pytest.raises(lisle.InputError, match=message):
        make()
