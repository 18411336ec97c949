# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's evaluated scene to arrays and native objects.

Everything here runs on the thread that Blender calls, and copies what it reads: nothing keeps a reference into
the dependency graph. Imports `core` and `bpy`, never `engine`, `overlay`, `tools` or `ui`.
"""
