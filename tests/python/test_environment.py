"""Light from a picture of the sky: the renderer beside the path tracer, files, the command line."""

import lisle
import numpy as np
import pytest
from conftest import line
from test_cli import cloth, run  # noqa: F401

SIZE = (48, 36)


def directions(height, width):
    """(h, w, 3): where the texels of a picture lie."""
    longitude = (0.5 - (np.arange(width) + 0.5) / width) * 2 * np.pi
    polar = (np.arange(height) + 0.5) / height * np.pi
    across = np.sin(polar)[:, None]
    z = np.broadcast_to(np.cos(polar)[:, None], (height, width))
    return np.stack([across * np.cos(longitude), across * np.sin(longitude), z], axis=-1)


def glowing(toward, height=32, width=64):
    """A dim sky with a warm glow about a direction."""
    toward = np.array(toward) / np.linalg.norm(toward)
    glow = np.maximum(directions(height, width) @ toward, 0) ** 8
    return (np.array([0.15, 0.2, 0.3]) + glow[..., None] * np.array([4.0, 3.0, 2.0])).astype(np.float32)


@pytest.fixture(scope="module")
def yarns():
    """One thick fiber: nothing that it shades, and nothing that light goes on to."""
    return lisle.Yarns(line(30, 0.1), [0, 30], yarn_radius=0.25)


def scene(yarns, environment):
    camera = lisle.Camera.fit(yarns, direction=(0, -1, 0.3), size=SIZE)
    scene = lisle.Scene(camera, environment=environment)
    yarn = lisle.Yarn.preset("cotton-1").replace(
        plies=1, fibers_per_ply=1, fiber_radius=0.01, r_min=1.0, loop_density=0.0, hair_density=0.0
    )
    scene.add(yarns, yarn, lisle.Material.preset("cotton-2").replace(diffuse_weight=0.0))
    return scene


def mean(image):
    """Of what is covered."""
    combined = image["combined"].astype(np.float64)
    return combined[..., :3].sum() / combined[..., 3].sum()


@pytest.mark.parametrize("toward", [(0.2, -0.7, 0.6), (0.5, 0.6, 0.7), (-0.6, 0.1, -0.9)])
def test_the_renderer_is_lit_as_the_path_tracer_is(renderer, yarns, toward):
    sky = lisle.Environment(glowing(toward))
    drawn = mean(renderer.render(scene(yarns, sky), samples=256, shadow_resolution=256))
    right = mean(lisle.Reference().render(scene(yarns, sky), samples=128, bounces=1))
    print(toward, drawn, right, drawn / right)
    assert drawn == pytest.approx(right, rel=0.015)
    turned = lisle.Environment(sky.image, rotation=np.pi / 2)
    wrong = mean(renderer.render(scene(yarns, turned), samples=256, shadow_resolution=256))
    assert wrong != pytest.approx(right, rel=0.015)


def test_a_turn_of_the_sky_turns_its_picture(renderer, yarns):
    sky = glowing((1, 0, 0.3))
    turned = lisle.Environment(sky, rotation=np.pi / 2)
    moved = lisle.Environment(np.roll(sky, -16, axis=1))
    a, b = (renderer.render(scene(yarns, each), samples=4, transparent=False)["combined"] for each in (turned, moved))
    rows = slice(0, 8)  # above the yarn: its light comes from other directions in both
    assert np.allclose(a[rows], b[rows], atol=2e-3)
    c = renderer.render(scene(yarns, lisle.Environment(sky)), samples=4, transparent=False)["combined"]
    assert not np.allclose(a[rows], c[rows], atol=0.05)


def test_four_channels_and_strength(renderer, yarns):
    sky = glowing((0, -1, 1))
    with_alpha = np.concatenate([sky, np.full((32, 64, 1), 0.5, np.float32)], axis=2)
    a = renderer.render(scene(yarns, lisle.Environment(sky)), samples=2)["combined"]
    b = renderer.render(scene(yarns, lisle.Environment(with_alpha, strength=2.0)), samples=2)["combined"]
    np.testing.assert_allclose(b[..., :3], 2 * a[..., :3], rtol=1e-5, atol=1e-6)
    with pytest.raises(lisle.InputError, match="strength"):
        lisle.Environment(sky, strength=-1.0)


def test_files_are_read(renderer, yarns, tmp_path):
    image = renderer.render(scene(yarns, lisle.Environment(glowing((0, -1, 1)))), samples=1, transparent=False)
    image.save(tmp_path / "sky.exr")
    expected = renderer.render(scene(yarns, lisle.Environment(image["combined"])), samples=1)["combined"]
    found = renderer.render(scene(yarns, lisle.Environment(tmp_path / "sky.exr")), samples=1)["combined"]
    np.testing.assert_array_equal(found, expected)
    # Four bytes a texel, without runs: red 1, green 0.5, blue 0.25 at an exponent of 1.
    texel = bytes([128, 64, 32, 129])
    (tmp_path / "sky.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n" + 8 * texel)
    even = lisle.Environment(tmp_path / "sky.hdr")
    assert even.image.size == (4, 2)
    assert renderer.render(scene(yarns, even), samples=1, transparent=False)["combined"][0, 0] == pytest.approx(
        (1.0, 0.5, 0.25, 1.0), rel=1e-3
    )
    (tmp_path / "broken.exr").write_bytes(b"no picture")
    for name in ("broken.exr", "none.hdr"):
        with pytest.raises(OSError, match=name):
            lisle.Environment(tmp_path / name)


@pytest.mark.parametrize("command", ["render", "reference"])
def test_the_command_line_takes_a_sky(cloth, tmp_path, renderer, yarns, command):  # noqa: F811
    sky = renderer.render(scene(yarns, lisle.Environment(glowing((0, -1, 1)))), samples=1, transparent=False)
    sky.save(tmp_path / "sky.exr")
    pictures = {}
    for name, options in {
        "sky": ["--environment", tmp_path / "sky.exr"],
        "turned": ["--environment", tmp_path / "sky.exr", "--environment-rotation", 180],
        "sun": [],
    }.items():
        output = tmp_path / f"{name}.png"
        result = run(command, cloth, "-o", output, "--size", "32x24", "--samples", "2", *options)
        assert (result.returncode, result.stderr) == (0, "")
        pictures[name] = output.read_bytes()
    assert len(set(pictures.values())) == 3
    result = run(command, cloth, "-o", tmp_path / "none.png", "--environment", tmp_path / "none.hdr")
    assert result.returncode == 1 and "none.hdr" in result.stderr
