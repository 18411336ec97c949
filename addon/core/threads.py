# SPDX-License-Identifier: GPL-3.0-or-later
"""Threads that Blender's command line asks for."""

import itertools


def asked_for(arguments):
    """The number after `-t` or `--threads` among Blender's arguments, None without one; 0 stands for all."""
    for option, value in itertools.pairwise(arguments[1:]):
        if option == "--":
            return None
        if option in {"-t", "--threads"}:
            return int(value) or None if value.isdecimal() else None
    return None
