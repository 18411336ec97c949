"""Blender in a window on a virtual X display, driven from outside and looked at pixel by pixel."""

import json
import re
import shutil
import struct
import subprocess
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
SIZE = (800, 600)
TIMEOUT_S = 120


class Display:
    """An X server without a screen: its pixels lie in a file."""

    def __init__(self, folder, size=SIZE):
        self._folder, self.size = folder, size
        command = ["Xvfb", "-displayfd", "1", "-screen", "0", f"{size[0]}x{size[1]}x24", "-fbdir", str(folder)]
        self._server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.name = f":{self._server.stdout.readline().strip()}"

    @staticmethod
    def problem():
        """Why there can be none, or None."""
        return None if shutil.which("Xvfb") else "no `Xvfb` on PATH"

    def pixels(self):
        """(h, w, 3) uint8, top row first."""
        data = (self._folder / "Xvfb_screen0").read_bytes()
        # The header of X window dumps: sizes are big-endian, of the colour map 12 bytes an entry.
        header, _, _, _, width, height = struct.unpack_from(">6I", data)
        bytes_per_line, colors = struct.unpack_from(">I", data, 48)[0], struct.unpack_from(">I", data, 76)[0]
        start = header + 12 * colors
        rows = np.frombuffer(data, np.uint8, height * bytes_per_line, start).reshape(height, bytes_per_line)
        return rows[:, : 4 * width].reshape(height, width, 4)[:, :, 2::-1]

    def close(self):
        self._server.terminate()
        self._server.wait()


class Ended(RuntimeError):
    """Blender has ended by itself."""


class Window:
    """A Blender with `blend` open; leaves by `close`. `options` are further ones of its command line."""

    def __init__(self, program, display, blend, folder, backend, options=()):
        self._options = options
        self._program, self._blend, self._folders, self.display, self.backend = program, blend, folder, display, backend
        self._opened = 0
        self.open()

    def open(self):
        """Starts Blender, another one if it has ended."""
        self._folder, self._count, self._begun = self._folders / str(self._opened), 0, 0
        self._folder.mkdir()
        self._opened += 1
        environment = self._program.environment | {"DISPLAY": self.display.name}
        size = map(str, self.display.size)
        command = [
            self._program.path,
            *self._options,
            "--gpu-backend",
            self.backend,
            "-p",
            "0",
            "0",
            *size,
            self._blend,
        ]
        command += ["--python", HERE / "driver.py", "--", self._folder]
        self.log = self._folder / "log.txt"
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                list(map(str, command)), stdout=log, stderr=subprocess.STDOUT, env=environment
            )
        self.do((HERE / "prelude.py").read_text())

    def do(self, code, timeout_s=TIMEOUT_S):
        """Executes code in Blender's main thread and returns its variable `answer`."""
        answer = self._send(code)
        end = time.monotonic() + timeout_s
        while not answer.exists():
            if self.process.poll() is not None:
                raise Ended(f"Blender ended with {self.process.returncode}:\n{self.last_words()}")
            if time.monotonic() > end:
                raise TimeoutError(f"no answer after {timeout_s} s:\n{self.last_words()}")
            time.sleep(0.005)
        answer = json.loads(answer.read_text())
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer["answer"]

    def last_words(self):
        """The end of what Blender has printed, and where it crashed."""
        said = self.log.read_text(errors="replace")
        reports = [Path(path) for path in re.findall(r"^Writing: (.*\.crash\.txt)$", said, re.MULTILINE)]
        return said[-2000:] + "".join(report.read_text(errors="replace") for report in reports if report.exists())

    def _send(self, code):
        """Hands over a command, whole or not at all; returns the path where its answer will be."""
        command = self._folder / "command.partial"
        command.write_text(code)
        command.rename(self._folder / f"{self._count}.py")
        self._count += 1
        return self._folder / f"{self._count - 1}.json"

    def begin(self):
        """From here on, `news` begins."""
        self._begun = self.log.stat().st_size

    def news(self):
        """What Blender has printed since `begin`."""
        return self.log.read_bytes()[self._begun :].decode(errors="replace")

    def until(self, code, timeout_s=TIMEOUT_S):
        """Executes code again and again until its `answer` is true; returns it."""
        end = time.monotonic() + timeout_s
        while time.monotonic() < end:
            answer = self.do(code)
            if answer:
                return answer
            time.sleep(0.02)
        raise TimeoutError(f"not true after {timeout_s} s: {code}\n{self.last_words()}")

    def close(self):
        """Quits as a user does; returns the exit code."""
        if self.process.poll() is None:
            self._send("bpy.ops.wm.quit_blender()")
            try:
                self.process.wait(20)
            except subprocess.TimeoutExpired:
                self.process.kill()
        return self.process.wait()
