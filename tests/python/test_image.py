"""Files of pictures, read back with other libraries."""

import json
import os
import stat

import lisle
import numpy as np
import pytest

PIL = pytest.importorskip("PIL.Image", reason="Pillow is not installed")
OpenEXR = pytest.importorskip("OpenEXR", reason="OpenEXR is not installed")


def picture(height=5, width=7):
    """Every pixel different, with alpha 0, ½, 1, and values beyond 1."""
    random = np.random.default_rng(1)
    alpha = np.resize(np.array([0, 0.5, 1], np.float32), (height, width))
    combined = np.dstack([1.2 * random.random((height, width, 3), np.float32) * alpha[..., None], alpha])
    passes = {
        "combined": combined.astype(np.float32),
        "depth": random.random((height, width), np.float32),
        "normal": random.random((height, width, 3), np.float32) - 0.5,
        "tangent": random.random((height, width, 3), np.float32) - 0.5,
        "object_id": random.integers(0, 2**32, (height, width), np.uint32),
    }
    return lisle.Image(passes, {})


def display(combined):
    """sRGB with straight alpha, 0 to 1; IEC 61966-2-1."""
    alpha = combined[..., 3:]
    linear = np.clip(np.divide(combined[..., :3], alpha, out=np.zeros_like(combined[..., :3]), where=alpha > 0), 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.dstack([encoded, alpha])


def test_png_is_for_a_display(tmp_path):
    image = picture()
    image.save(tmp_path / "picture.png")
    with PIL.open(tmp_path / "picture.png") as file:
        assert file.mode == "RGBA"
        values = np.asarray(file)
    np.testing.assert_allclose(values, 255 * display(image["combined"]), atol=0.51)


def test_png_of_16_bits(tmp_path):
    image = picture()
    image.save(tmp_path / "picture.PNG", bits=16)
    content = (tmp_path / "picture.PNG").read_bytes()
    assert content[24:26] == bytes([16, 6])  # bit depth and colour type of the header: RGBA
    with PIL.open(tmp_path / "picture.PNG") as file:
        values = np.asarray(file)
    np.testing.assert_allclose(values, 255 * display(image["combined"]), atol=1.01)


def test_exr_holds_every_pass(tmp_path):
    image = picture()
    image.save(str(tmp_path / "picture.exr"))
    with OpenEXR.File(str(tmp_path / "picture.exr"), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    combined = np.dstack([channels.pop(name) for name in "RGBA"])
    np.testing.assert_array_equal(combined, image["combined"])
    np.testing.assert_array_equal(channels.pop("Z"), image["depth"])
    for name in ("normal", "tangent"):
        vectors = np.dstack([channels.pop(f"{name}.{axis}") for axis in "XYZ"])
        np.testing.assert_array_equal(vectors, image[name])
    ids = channels.pop("object_id")
    assert ids.dtype == np.uint32
    np.testing.assert_array_equal(ids, image["object_id"])
    assert not channels


def test_a_file_appears_whole_or_not_at_all(tmp_path):
    folder = tmp_path / "taken.png"
    folder.mkdir()
    (folder / "kept").touch()
    for path in (tmp_path / "missing" / "picture.png", folder):
        with pytest.raises(OSError, match=path.name):
            picture().save(path)
    assert [path.name for path in tmp_path.iterdir()] == ["taken.png"]


def test_an_older_file_is_replaced(tmp_path):
    path = tmp_path / "picture.exr"
    path.write_text("older")
    picture().save(path)
    assert path.read_bytes()[:4] == bytes([0x76, 0x2F, 0x31, 0x01])
    assert [path.name for path in tmp_path.iterdir()] == ["picture.exr"]


@pytest.mark.skipif(os.name != "posix", reason="POSIX permissions")
def test_permissions_follow_the_umask(tmp_path):
    before = os.umask(0o027)
    try:
        picture().save(tmp_path / "picture.png")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "picture.png").stat().st_mode) == 0o640


def test_other_kinds_are_refused(tmp_path):
    for name in ("picture.jpg", "picture"):
        with pytest.raises(lisle.InputError, match=r"expected \.png or \.exr"):
            picture().save(tmp_path / name)
    with pytest.raises(lisle.InputError, match="bits"):
        picture().save(tmp_path / "picture.png", bits=32)
    assert not list(tmp_path.iterdir())


def test_further_passes_are_in_the_file_with_their_manifest(renderer, camera, swatch, tmp_path):
    scene = lisle.Scene(camera, ambient=(1, 1, 1))
    scene.add(swatch, name="Wäsche", object_index=3, material_name="wool", material_index=7)
    wanted = [name for name in lisle.FURTHER_PASSES if name != "vector"]
    image = renderer.render(scene, samples=2, passes=wanted)
    assert set(wanted) <= set(image)
    path = tmp_path / "a.exr"
    image.save(path)
    openexr = pytest.importorskip("OpenEXR")
    with openexr.File(str(path), separate_channels=True) as file:
        channels, header = file.channels(), dict(file.header())
        np.testing.assert_array_equal(channels["position.X"].pixels, image["position"][..., 0])
        np.testing.assert_array_equal(channels["CryptoMaterial00.G"].pixels, image["crypto_material"][..., 1])
        np.testing.assert_array_equal(channels["shadow"].pixels, image["shadow"])
    covered = image["depth"] < 1e9
    assert (image["object_index"][covered] == 3).all() and (image["material_index"][covered] == 7).all()
    manifests = {header[k.replace("manifest", "name")]: json.loads(header[k]) for k in header if "manifest" in k}
    assert manifests.keys() == {"CryptoObject", "CryptoMaterial"}
    (ident,) = manifests["CryptoObject"].values()
    assert manifests["CryptoObject"].keys() == {"Wäsche"}
    number = np.array([int(ident, 16)], np.uint32).view(np.float32)[0]
    assert (image["crypto_object"][covered][:, 0] == number).all()
    np.testing.assert_allclose(image["crypto_object"][..., 1], image["alpha"], atol=1e-6)
