import json
import os
import subprocess
import sys

import lisle
import numpy as np
import pytest
from test_load import bcc

SMALL = ["--size", "64x48", "--samples", "1"]


def run(*arguments, **options):
    command = [sys.executable, "-m", "lisle", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, **options)


@pytest.fixture
def cloth(tmp_path, swatch):
    path = tmp_path / "cloth.bcc"
    curves = np.split(swatch.points, swatch.offsets[1:-1])
    path.write_bytes(bcc([(curve, False) for curve in curves]))
    return path


@pytest.fixture
def moving(tmp_path):
    """An animated stage of three frames."""
    pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
    from pxr import Usd, UsdGeom, Vt

    swatch = lisle.knit_swatch(courses=4, wales=4)
    path = tmp_path / "moving.usdc"
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    curves = UsdGeom.BasisCurves.Define(stage, "/Yarns")
    curves.CreateTypeAttr("cubic")
    curves.CreateBasisAttr("catmullRom")
    curves.CreateWrapAttr("pinned")
    curves.CreateCurveVertexCountsAttr([int(count) for count in np.diff(swatch.offsets)])
    curves.CreateWidthsAttr([2e-3])
    curves.SetWidthsInterpolation("constant")
    for frame in (8, 9, 10):
        points = swatch.points + np.array([0, 0.002 * (frame - 8), 0], np.float32)
        curves.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(points.astype(np.float32)), frame)
    stage.Save()
    return path


@pytest.mark.parametrize("suffix", [".png", ".exr"])
def test_render_writes_a_picture(cloth, tmp_path, suffix):
    output = tmp_path / f"cloth{suffix}"
    result = run("render", cloth, "-o", output, *SMALL, "--yarn", "silk-1", "--material", "silk", "--shading", "simple")
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    assert output.stat().st_size > 1000
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cloth.bcc", output.name]


def test_the_options_of_render_count(cloth, tmp_path):
    pictures = set()
    for number, options in enumerate(
        [[], ["--yarn", "rayon-1"], ["--material", "silk"], ["--shading", "simple"], ["--yarn-radius", "0.0005"],
         ["--direction=-1,0,0"], ["--samples", "2"], ["--samples", "2", "--filter", "box"],
         ["--samples", "2", "--filter-width", "4"],
         ["--transport-photons", "0"]]
    ):  # fmt: skip
        output = tmp_path / f"{number}.png"
        assert run("render", cloth, "-o", output, *SMALL, *options).returncode == 0
        pictures.add(output.read_bytes())
    assert len(pictures) == 10


def test_a_picture_on_one_thread_is_the_same(cloth, tmp_path):
    for number, options in enumerate([[], ["-t", "1"], ["--threads", "2"]]):
        result = run("render", cloth, "-o", tmp_path / f"{number}.png", *SMALL, *options)
        assert (result.returncode, result.stderr) == (0, "")
    assert len({(tmp_path / f"{number}.png").read_bytes() for number in range(3)}) == 1


def test_a_smooth_picture_stops_early(cloth, tmp_path):
    for name, options in (("a", ["--samples", "4096", "--noise-threshold", "1"]), ("b", ["--samples", "16"])):
        assert run("render", cloth, "-o", tmp_path / f"{name}.png", "--size", "64x48", *options).returncode == 0
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_picture_stops_when_its_time_is_over(cloth, tmp_path):
    """All of its samples would take an hour."""
    options = ["--size", "640x480", "--samples", "100000", "--time-limit", "0.1"]
    assert run("render", cloth, "-o", tmp_path / "a.png", *options).returncode == 0
    assert (tmp_path / "a.png").exists()


def test_further_passes_on_request(cloth, tmp_path):
    openexr = pytest.importorskip("OpenEXR")
    output = tmp_path / "a.exr"
    assert run("render", cloth, "-o", output, *SMALL, "--passes", "position,crypto_object").returncode == 0
    with openexr.File(str(output), separate_channels=True) as file:
        assert {"position.X", "CryptoObject00.R"} <= file.channels().keys() and "shadow" not in file.channels()
    result = run("render", cloth, "-o", tmp_path / "a.png", *SMALL, "--passes", "position")
    assert result.returncode == 1 and "--passes needs an .exr" in result.stderr


@pytest.mark.parametrize(
    ("pattern", "frame", "name"),
    [
        ("a.####.png", 7, "a.0007.png"),
        ("a.####.png", -5, "a.-0005.png"),
        ("a.#.png", 1_000_000, "a.1000000.png"),
        ("a.#.png", 1_000_001, "a.1000001.png"),
        ("a.###.png", 24.25, "a.024.25.png"),
        ("a.##.png", -0.5, "a.-00.5.png"),
    ],
)
def test_names_of_frames(tmp_path, pattern, frame, name):
    from lisle.cli.render import numbered

    assert numbered(tmp_path / pattern, frame) == tmp_path / name


def test_frames_of_an_animation(moving, tmp_path):
    (tmp_path / "out").mkdir()
    result = run("render", moving, "-o", tmp_path / "out" / "cloth.####.png", *SMALL, "--frames", "8-10")
    assert (result.returncode, result.stderr) == (0, "")
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == ["cloth.0008.png", "cloth.0009.png", "cloth.0010.png"]
    assert run("render", moving, "-o", tmp_path / "alone.png", *SMALL, "--frame", "9").returncode == 0
    alone, *sequence = (
        path.read_bytes() for path in [tmp_path / "alone.png", *(tmp_path / "out" / name for name in names)]
    )
    assert sequence[1] == alone
    assert len(set(sequence)) == 3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["missing.bcc", "-o", "cloth.png"], ["missing.bcc"]),
        (["cloth.bcc", "-o", "cloth.jpg"], ["cloth.jpg", ".png"]),
        (["cloth.bcc", "-o", "missing/cloth.png"], ["missing"]),
        (["cloth.bcc", "-o", "cloth.png", "--adapter", "abacus"], ["abacus"]),
        (["cloth.bcc", "-o", "cloth.png", "--frame", "3"], ["frame"]),
        (["cloth.bcc", "-o", "cloth.png", "--frames", "1-3"], ["####"]),
    ],
)
def test_failures_are_one_line_and_leave_nothing(cloth, arguments, words):
    result = run("render", *arguments, cwd=cloth.parent)
    assert result.returncode == 1
    assert result.stdout == ""
    assert result.stderr.startswith("lisle: error: ")
    assert result.stderr.count("\n") == 1
    for word in words:
        assert word in result.stderr
    assert [path.name for path in cloth.parent.iterdir()] == ["cloth.bcc"]


def test_a_frame_beyond_the_animation_fails_before_anything_is_drawn(moving, tmp_path):
    result = run("render", moving, "-o", tmp_path / "cloth.##.png", *SMALL, "--frames", "9-11")
    assert result.returncode == 1
    assert "frame 11" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["moving.usdc"]


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["weave"],
        ["render"],
        ["render", "cloth.bcc"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--size", "640"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--size", "0x48"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--samples", "0"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--yarn", "tweed"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--yarn-radius", "-1"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--yarn-radius", "nan"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--direction", "0,0,0"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--frames", "9-1"],
        ["render", "cloth.bcc", "-o", "cloth.exr", "--passes", "vector"],
        ["render", "cloth.bcc", "-o", "cloth.exr", "--passes", "positions"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--filter", "tent"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--filter-width", "0"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--noise-threshold", "-1"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--time-limit", "nan"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--transport-photons", "-1"],
        ["render", "cloth.bcc", "-o", "cloth.png", "-t", "0"],
        ["render", "cloth.bcc", "-o", "cloth.png", "--frames", "1-9", "--frame", "1"],
    ],
)
def test_command_lines_without_sense(cloth, arguments):
    result = run(*arguments, cwd=cloth.parent)
    assert result.returncode == 2
    assert "usage:" in result.stderr
    assert [path.name for path in cloth.parent.iterdir()] == ["cloth.bcc"]


def test_info(cloth, swatch):
    facts = json.loads(run("info", cloth, "--json").stdout)
    assert (facts["curves"], facts["closed"], facts["points"]) == (6, 0, len(swatch.points))
    assert facts["length"] == pytest.approx(swatch.length, rel=1e-5)
    assert facts["frames"] is None
    text = run("info", cloth)
    assert text.returncode == 0
    assert "6 curves (0 closed)" in text.stdout
    assert run("info", cloth.parent / "missing.bcc").returncode == 1


def test_info_of_an_animation(moving):
    assert json.loads(run("info", moving, "--json").stdout)["frames"] == [8, 10]
    assert "8 to 10" in run("info", moving).stdout


def test_devices(renderer):
    devices = json.loads(run("devices", "--json").stdout)
    assert renderer.adapter.name in [device["name"] for device in devices]
    assert renderer.adapter.name in run("devices").stdout


@pytest.mark.parametrize("form", [[], ["--json"]])
def test_no_devices(tmp_path, form):
    # Drivers as the loader knows them by its older name and its newer one.
    drivers = dict.fromkeys(("VK_ICD_FILENAMES", "VK_DRIVER_FILES"), str(tmp_path / "none.json"))
    result = run("devices", *form, env={**os.environ, **drivers})
    assert result.returncode == 1
    assert "no graphics adapter answers" in result.stderr
    assert (json.loads(result.stdout) == []) if form else (not result.stdout)


def test_version():
    assert run("--version").stdout.strip() == f"lisle {lisle.__version__}"


def test_the_console_script():
    result = subprocess.run(["lisle", "--version"], capture_output=True, text=True, check=True)
    assert lisle.__version__ in result.stdout
