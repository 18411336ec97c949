"""Runs every test that touches Blender in a process of its own.

`python -m pytest tests/blender` with the Python of any supported `bpy` (4.5, 5.0, 5.2). A test marked
`blender` is run by a child pytest: Blender may crash in it, keeps global state, and is known to hang at exit, so the
child leaves with `os._exit` and reports through a file. Blender then cannot remove its own folder for temporary
files: every child gets a TMPDIR of its own, which the parent removes.

Markers: `blender` uses the stand-in for the native module in `fake_lisle/`, which records what it is given;
`blender("wheel")` uses the real `lisle`, and is skipped where it is not installed.
"""

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

HERE = Path(__file__).parent
REPOSITORY = HERE.parent.parent
REPORT = os.environ.get("LISLE_TEST_REPORT")
"""File that a child writes its outcome to; unset in the parent."""

TIMEOUT_S = 300


def pytest_configure(config):
    config.addinivalue_line("markers", "blender(native='fake'): run in a Blender process of its own")
    sys.path.insert(0, str(HERE))
    if REPORT and os.environ["LISLE_TEST_NATIVE"] == "fake":
        sys.path.insert(0, str(HERE / "fake_lisle"))


def pytest_runtest_protocol(item, nextitem):
    """In the parent, hands a Blender test to a child."""
    marker = item.get_closest_marker("blender")
    if REPORT or marker is None:
        return None
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    outcome, text, duration = _run_child(item, marker.args[0] if marker.args else "fake")
    item.ihook.pytest_runtest_logreport(
        report=pytest.TestReport(
            item.nodeid, item.location, dict.fromkeys(item.keywords, 1), outcome, text, "call", duration=duration
        )
    )
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    return True


def _run_child(item, native):
    """(outcome, longrepr, seconds)."""
    place = (str(item.path), item.location[1] or 0)
    if native == "wheel" and importlib.util.find_spec("lisle") is None:
        return "skipped", (*place, "Skipped: the native module 'lisle' is not installed"), 0.0
    function = item.nodeid.partition("::")[2]
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", f"{item.path}::{function}"]
    with tempfile.TemporaryDirectory(prefix="lisle-test-") as temporary:
        report = Path(temporary) / "outcome.jsonl"
        environment = os.environ | {
            "LISLE_TEST_REPORT": str(report), "LISLE_TEST_NATIVE": native, "TMPDIR": temporary,
        }  # fmt: skip
        try:
            child = subprocess.run(
                command, capture_output=True, text=True, env=environment, timeout=TIMEOUT_S, check=False
            )
        except subprocess.TimeoutExpired as error:
            return "failed", f"no end after {TIMEOUT_S} s\n{error.stdout}", float(TIMEOUT_S)
        lines = report.read_text().splitlines() if report.exists() else []
    phases = [json.loads(line) for line in lines]
    if [phase["when"] for phase in phases] != ["setup", "call", "teardown"]:
        skipped = [phase for phase in phases if phase["outcome"] == "skipped"]
        if not skipped:
            return "failed", f"Blender ended with code {child.returncode}\n{child.stdout}\n{child.stderr}", 0.0
    duration = sum(phase["duration"] for phase in phases)
    for phase in phases:
        if phase["outcome"] == "failed":
            return "failed", child.stdout + child.stderr, duration
        if phase["outcome"] == "skipped":
            return "skipped", (*place, phase["text"]), duration
    return "passed", None, duration


def pytest_runtest_logreport(report):
    if not REPORT:
        return
    text = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr or "")
    line = {"when": report.when, "outcome": report.outcome, "text": text, "duration": report.duration}
    with open(REPORT, "a") as file:
        file.write(json.dumps(line) + "\n")


def pytest_sessionfinish(session, exitstatus):
    session.config.stash[_STATUS] = int(exitstatus)


_STATUS = pytest.StashKey()


def pytest_unconfigure(config):
    if REPORT:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(config.stash.get(_STATUS, 1))


def _load_package(name, folder):
    spec = importlib.util.spec_from_file_location(
        name, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    package = importlib.util.module_from_spec(spec)
    sys.modules[name] = package
    spec.loader.exec_module(package)
    return package


if not REPORT and "lisle_blender" not in sys.modules:
    # The parent reaches the logic alone, as `lisle_blender.core`, under a package without Blender in it.
    bare = importlib.util.module_from_spec(importlib.util.spec_from_loader("lisle_blender", None, is_package=True))
    bare.__path__ = [str(REPOSITORY / "addon")]
    sys.modules["lisle_blender"] = bare


@pytest.fixture
def addon():
    """The registered extension, in an empty scene that it renders."""
    import bpy
    import scenes

    bpy.ops.wm.read_factory_settings(use_empty=True)
    package = _load_package("lisle_blender", REPOSITORY / "addon")
    package.register()
    scenes.prepare(bpy.context.scene)
    return package


@pytest.fixture
def lisle(addon):
    """The native module in use: the stand-in, unless the test asks for the wheel."""
    return importlib.import_module("lisle")


@pytest.fixture
def data():
    """Folder of the animated yarns that are not part of the project."""
    folder = Path(os.environ.get("LISLE_DATA", REPOSITORY.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip("no data: set LISLE_DATA")
    return folder
