"""Runs in Blender's main thread what the test asks for: `-- FOLDER`, in which commands and answers are files.

A command `N.py` is executed with `bpy` in a namespace that lasts; its variable `answer` goes to `N.json`, or its trace.
"""

import json
import sys
import traceback
from pathlib import Path

import bpy

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
PERIOD_S = 0.02

namespace = {"bpy": bpy}
number = 0


def poll():
    global number
    command = FOLDER / f"{number}.py"
    if command.exists():
        namespace["answer"] = None
        try:
            exec(compile(command.read_text(), str(command), "exec"), namespace)
            answer = {"answer": namespace["answer"]}
        except BaseException:
            answer = {"error": traceback.format_exc()}
        partial = FOLDER / f"{number}.partial"
        partial.write_text(json.dumps(answer))
        partial.rename(FOLDER / f"{number}.json")
        number += 1
    return PERIOD_S


bpy.app.timers.register(poll, persistent=True)
