"""The runner itself: what a test in Blender leaves behind."""

import os
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.blender
def test_blender_keeps_its_temporary_files_in_the_folder_that_goes_with_the_test(tmp_path):
    import bpy

    folder = Path(os.environ["TMPDIR"])
    assert folder.name.startswith("lisle-test-")
    assert Path(bpy.app.tempdir).is_relative_to(folder) and tmp_path.is_relative_to(folder)


def test_nothing_is_left_of_a_test_in_blender(tmp_path):
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    name = test_blender_keeps_its_temporary_files_in_the_folder_that_goes_with_the_test.__name__
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", f"{__file__}::{name}"]
    result = subprocess.run(command, capture_output=True, text=True, env=environment, check=False, timeout=200)
    assert result.returncode == 0, result.stdout
    left = [path.name for path in tmp_path.iterdir()]
    assert all(name.startswith("pytest-of-") for name in left), left
