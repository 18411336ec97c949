import struct

import lisle
import numpy as np
import pytest
from conftest import line


def bcc(curves, up=2, kind=b"C0"):
    """A BCC file; a curve is (points, closed)."""
    points = sum(len(curve) for curve, _ in curves)
    header = b"BCC\x44" + kind + bytes([3, up]) + struct.pack("<QQ", len(curves), points) + bytes(40)
    body = b"".join(
        struct.pack("<i", -len(curve) if closed else len(curve)) + np.asarray(curve, "<f4").tobytes()
        for curve, closed in curves
    )
    return header + body


def test_bcc(tmp_path):
    (tmp_path / "two.bcc").write_bytes(bcc([(line(4), False), (line(5) + [0, 1, 0], True)]))
    yarns = lisle.load(tmp_path / "two.bcc", yarn_radius=0.03)
    assert yarns.offsets.tolist() == [0, 4, 9]
    assert yarns.closed.tolist() == [False, True]
    np.testing.assert_array_equal(yarns.points[:4], line(4))
    np.testing.assert_array_equal(yarns.radii, np.full(9, 0.03, np.float32))
    assert yarns.name == "two.bcc"


def test_y_up_becomes_z_up(tmp_path):
    (tmp_path / "up.bcc").write_bytes(bcc([(np.array([[0, 0, 0], [1, 2, 3]], np.float32), False)], up=1))
    yarns = lisle.load(str(tmp_path / "up.bcc"), yarn_radius=0.1)
    np.testing.assert_array_equal(yarns.points, [[0, 0, 0], [1, -3, 2]])


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("missing.bcc", None, ["missing.bcc"]),
        ("cut.bcc", bcc([(line(4), False)])[:-1], ["cut.bcc"]),
        ("empty.bcc", b"", ["empty.bcc"]),
        ("kind.bcc", bcc([(line(4), False)], kind=b"XY"), ["kind.bcc", "XY"]),
        ("nan.bcc", bcc([(line(4), False), (line(4) * np.nan, False)]), ["nan.bcc", "curve 1", "point 0"]),
        ("short.bcc", bcc([(line(1), False)]), ["short.bcc", "curve 0"]),
        ("text.gltf", b"not JSON", ["text.gltf"]),
        ("cloth.obj", b"v 0 0 0", ["cloth.obj", ".obj", ".bcc"]),
    ],
)
def test_files_that_cannot_be_read_are_named(tmp_path, name, content, words):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(lisle.InputError) as caught:
        lisle.load(tmp_path / name)
    for word in words:
        assert word in str(caught.value)


def test_a_still_file_has_no_frames(tmp_path):
    (tmp_path / "still.bcc").write_bytes(bcc([(line(4), False)]))
    with pytest.raises(lisle.InputError, match="frame 3"):
        lisle.load(tmp_path / "still.bcc", frame=3)


@pytest.mark.parametrize(
    ("name", "curves", "points", "length"),
    [
        ("openwork_trellis_pattern", 1, 19_730, 2_734.7),
        ("flame_ribbing_pattern", 1, 49_745, 10_858.2),
        ("glove", 70, 58_545, 13_918.8),
        ("alien_sweater", 146, 139_528, 30_154.1),
        ("sweater_flame_ribbing", 253, 271_978, 57_472.6),
    ],
)
def test_real_yarns(data, name, curves, points, length):
    """Figures of a separate reader, whose lengths are of the polyline through the control points."""
    yarns = lisle.load(data / "yarns" / f"{name}.bcc")
    assert (len(yarns), len(yarns.points)) == (curves, points)
    polyline = 0.0
    for start, end, closed in zip(yarns.offsets[:-1], yarns.offsets[1:], yarns.closed, strict=True):
        curve = yarns.points[start:end].astype(np.float64)
        curve = np.vstack([curve, curve[:1]]) if closed else curve
        polyline += np.linalg.norm(np.diff(curve, axis=0), axis=1).sum()
    assert polyline == pytest.approx(length, rel=1e-3)
    assert yarns.length == pytest.approx(polyline, rel=0.05)
    assert 0.08 < yarns.radii[0] < 0.12
