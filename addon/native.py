# SPDX-License-Identifier: GPL-3.0-or-later
"""The native module `lisle`, or a clear reason why it is not there.

The extension registers without it, so that panels can say what is wrong instead of Blender hiding the add-on.
"""

import importlib
import sys

import bpy

from .core.errors import NativeError
from .core.threads import asked_for

_ADVICE = (
    "The extension's wheel is missing or was built for another system. "
    "Install the Lisle package for this platform, and restart Blender"
)


def module():
    """The imported `lisle` module. Raises NativeError with advice where it cannot be had."""
    is_new = "lisle" not in sys.modules
    try:
        lisle = importlib.import_module("lisle")
    except Exception as error:  # a broken shared library raises OSError, a panicking initialiser anything
        raise NativeError(f"The native module 'lisle' cannot be loaded ({error}). {_ADVICE}") from error
    # Before any work: threads can be set no more then. The arguments of a program that imports bpy are not Blender's.
    if is_new and not bpy.app.module:
        count = asked_for(sys.argv)
        if count is not None:
            lisle.set_threads(count)
    return lisle


def problem():
    """Why the native module cannot be used, for a panel; None if all is well."""
    try:
        module()
    except NativeError as error:
        return str(error)
    return None


def native_yarns(lisle, curves, name):
    """`lisle.Yarns` of CurveArrays; `name` is what its errors call them."""
    return lisle.Yarns(
        curves.points,
        curves.offsets,
        closed=curves.closed,
        basis=curves.basis,
        radii=curves.radii,
        nurbs_order=curves.nurbs_order,
        nurbs_weights=curves.nurbs_weights,
        nurbs_knots_mode=curves.nurbs_knots_mode,
        length_coordinates=curves.length_coordinates,
        name=name,
    )
