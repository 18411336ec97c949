"""The examples, each in a small picture: they run to their end, and draw yarns that do not run through each other.

Example 5 needs Blender: `tests/blender/test_example.py`.
"""

import os
import runpy
import subprocess
import sys
from pathlib import Path

import lisle
import numpy as np
import pytest
from conftest import REPOSITORY
from test_load import bcc

sys.path.append(str(REPOSITORY / "tests"))
from closest import closest_approach

EXAMPLES = REPOSITORY / "examples"


def nearest(yarns):
    """In radii, of all yarns that are drawn together."""
    curves = [(p, c) for y in yarns for p, c in zip(np.split(y.points, y.offsets[1:-1]), y.closed, strict=True)]
    return closest_approach(curves, float(yarns[0].radii.min()))


@pytest.fixture
def run(renderer, monkeypatch, tmp_path):
    """Runs an example with small pictures of one sample: its files, and the yarns of each picture."""

    def run(name):
        drawn = []

        class Quick:
            def render(self, what, **options):
                scene = isinstance(what, lisle.Scene)
                drawn.append([added.yarns for added in what.objects] if scene else [what])
                quick = {"size": (48, 36), "samples": 1, "transport_photons": 1000, "shadow_resolution": 256}
                return renderer.render(what, **options | quick)

        monkeypatch.setattr(lisle, "Renderer", Quick)
        monkeypatch.setattr(sys, "argv", [name, str(tmp_path)])
        runpy.run_path(str(EXAMPLES / name), run_name="__main__")
        return sorted(path.name for path in tmp_path.iterdir()), drawn

    return run


@pytest.mark.parametrize(
    ("name", "files"),
    [
        ("01_swatch.py", ["swatch.png"]),
        ("02_stretch_and_wave.py", [f"stretch_{frame:04d}.png" for frame in range(24)]),
        ("03_bending_sleeve.py", [f"sleeve_{number:04d}.png" for number in range(3)]),
        ("04_usd.py", ["swatch.usdc", *(f"usd_{frame:04d}.png" for frame in (1, 2, 3))]),
        ("07_readme_pictures.py", [f"{name}.png" for name in ("drape", "near", "middle", "far", "edge")]),
    ],
)
def test_an_example_runs_and_its_yarns_do_not_intersect(run, name, files):
    if name == "04_usd.py":
        pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
    found, drawn = run(name)
    assert found == sorted(files)
    pictures = [file for file in files if file.endswith(".png")]
    assert len(drawn) == len(pictures)
    for file, yarns in list(zip(pictures, drawn, strict=True))[:: 4 if len(drawn) > 4 else 1]:
        distance = nearest(yarns)
        print(file, distance)
        assert distance > 2, f"{file}: centre lines come within {distance:.3f} radii"


def test_yarns_that_intersect_are_noticed(swatch):
    assert 2 < nearest([swatch]) < 2.05
    assert nearest([swatch.with_points(swatch.points * np.float32([1, 1, 0.97]))]) < 2
    assert nearest([swatch, swatch.with_points(swatch.points + np.float32([0.0003, 0, 0]))]) < 1


def test_the_command_line_example_runs(swatch, tmp_path):
    path = tmp_path / "cloth.bcc"
    path.write_bytes(bcc([(curve, False) for curve in np.split(swatch.points, swatch.offsets[1:-1])]))
    quick = ["--size", "64x48", "--samples", "1", "--transport-photons", "0"]
    command = ["bash", EXAMPLES / "06_command_line.sh", path, tmp_path / "out", *quick]
    environment = os.environ | {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    said = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, env=environment)
    assert said.returncode == 0, said.stderr
    assert (tmp_path / "out" / "picture.png").stat().st_size > 0
    assert "yarn radius" in said.stdout
