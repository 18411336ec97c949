"""A real `blender`, with the built extension installed in settings of its own."""

import os
import shutil
import subprocess
from pathlib import Path

OLDEST = (4, 5)
TIMEOUT_S = 300


def find():
    """Path of the program on PATH, or the reason why there is none to test with."""
    path = shutil.which("blender")
    if path is None:
        return None, "no `blender` on PATH"
    said = subprocess.run([path, "--version"], capture_output=True, text=True, check=False, timeout=TIMEOUT_S).stdout
    words = said.split()
    try:
        release = tuple(int(number) for number in words[1].split(".")[:2])
    except (IndexError, ValueError):
        return None, f"`blender --version` says {said!r}"
    if release < OLDEST:
        return None, f"`blender` on PATH is {words[1]}, older than {OLDEST[0]}.{OLDEST[1]}"
    return path, None


class Program:
    """Starts Blender; `folder` takes its settings and temporary files."""

    def __init__(self, path, folder):
        self.path = path
        self.environment = os.environ | {"BLENDER_USER_RESOURCES": str(folder / "settings"), "TMPDIR": str(folder)}
        self.environment.pop("PYTHONPATH", None)
        (folder / "settings").mkdir()

    def run(self, *arguments):
        """The finished process, with what it said in `stdout`."""
        return subprocess.run(
            [self.path, *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            timeout=TIMEOUT_S,
            env=self.environment,
        )

    def install(self, archive):
        """Installs and enables an extension from a file."""
        done = self.run("--command", "extension", "install-file", "--repo", "user_default", "--enable", archive)
        if done.returncode != 0:
            raise RuntimeError(f"installing {archive} ended with {done.returncode}:\n{done.stdout}")

    def script(self, path, *arguments):
        """Runs a script in the background. Raises RuntimeError with what Blender said where it fails."""
        done = self.run("--background", "--python-exit-code", 1, "--python", Path(path).absolute(), "--", *arguments)
        if done.returncode != 0:
            raise RuntimeError(f"{path} ended with {done.returncode}:\n{done.stdout}")
