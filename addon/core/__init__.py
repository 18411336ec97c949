# SPDX-License-Identifier: GPL-3.0-or-later
"""Logic of the extension that needs neither Blender nor the native module: numpy in, numpy out.

Nothing here imports `bpy`, `lisle` or another part of the extension.
"""
