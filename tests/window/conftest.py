"""Runs against a real `blender` ≥ 4.5 on PATH, and says so where there is none.

`LISLE_PACKAGE` is the extension's archive for this platform.
"""

import os
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import program  # noqa: E402


@pytest.fixture(scope="session")
def blender(tmp_path_factory):
    """A `program.Program` in which the extension is installed and enabled."""
    path, reason = program.find()
    if path is None:
        pytest.skip(reason)
    package = os.environ.get("LISLE_PACKAGE")
    if not package:
        pytest.skip("no package: set LISLE_PACKAGE to the built extension")
    blender = program.Program(path, tmp_path_factory.mktemp("blender"))
    blender.install(Path(package).absolute())
    return blender
