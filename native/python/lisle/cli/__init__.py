"""The command line: `lisle render`, `lisle reference`, `lisle fibers`, `lisle info`, `lisle devices`.

Exit codes: 0 only when what was asked for lies on disk or on standard output; 1 with one line on standard error for
what cannot be done; 2 for a command line that makes no sense; 130 when interrupted.
"""

import argparse
import os
import sys
from collections.abc import Sequence

from .. import __version__
from ..errors import Error
from . import devices, fibers, info, reference, render


def parser() -> argparse.ArgumentParser:
    """The grammar of the command line."""
    result = argparse.ArgumentParser(prog="lisle", description="Fiber-level cloth from yarn curves.")
    result.add_argument("--version", action="version", version=f"lisle {__version__}")
    commands = result.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in (render, reference, fibers, info, devices):
        command.add_to(commands)
    return result


def main(argv: Sequence[str] | None = None) -> int:
    """Runs a command line and returns its exit code."""
    arguments = parser().parse_args(argv)
    if "XDG_RUNTIME_DIR" not in os.environ:
        # Without a desktop session, Mesa's layer that picks a GPU by the session's wishes complains on standard error.
        os.environ.setdefault("NODEVICE_SELECT", "1")
    try:
        arguments.run(arguments)
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader of our output is gone; Python must not complain about it again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        print("lisle: interrupted", file=sys.stderr)
        return 130
    except (Error, OSError, MemoryError) as error:
        message = " ".join(str(error).split()) or type(error).__name__
        print(f"lisle: error: {message}", file=sys.stderr)
        return 1
    return 0
