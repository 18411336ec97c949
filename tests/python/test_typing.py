"""The annotations are right: the package against mypy, the stubs against the extension module."""

import subprocess
import sys

import pytest
from conftest import REPOSITORY

pytest.importorskip("mypy", reason="mypy is not installed")


def run(*command, cwd):
    result = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, check=False, cwd=cwd)
    assert result.returncode == 0, result.stdout + result.stderr


def test_the_package_is_typed():
    run("mypy", cwd=REPOSITORY)


def test_the_stubs_agree_with_the_module(tmp_path):
    run("mypy.stubtest", "lisle._native", cwd=tmp_path)


USE = """
import lisle
import numpy as np

yarns: lisle.Yarns = lisle.load("glove.bcc")
lights: list[lisle.Light] = [lisle.Sun(direction=(-1, 1, -2)), lisle.Gaussian(direction=(0, 0, -1), sharpness=5.0)]
image = lisle.Renderer().render(yarns, lights=lights, progress=print)
pixels: np.ndarray = image["combined"]
lisle.Gaussian(direction="down")
"""


def test_a_script_sees_the_types(tmp_path):
    (tmp_path / "use.py").write_text(USE)
    command = [sys.executable, "-m", "mypy", "--strict", "use.py"]
    result = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert "use.py:9: error" in result.stdout
    assert result.stdout.count("error:") == 1, result.stdout
