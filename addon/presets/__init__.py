# SPDX-License-Identifier: GPL-3.0-or-later
"""The names of the measured yarns and fibers, as Blender shows them.

The numbers live in the native module and nowhere else; `tests/blender/test_presets.py` holds the two lists together.
The numbers at the end are stored in .blend files: never renumber.
"""

_MEASURED = (
    ("cotton-1", "Cotton 1", "White cotton, three plies"),
    ("cotton-2", "Cotton 2", "Loose cotton, three plies"),
    ("rayon-1", "Rayon 1", "Thick rayon, two plies with many fibers"),
    ("rayon-2", "Rayon 2", "Thin rayon, two plies"),
    ("rayon-3", "Rayon 3", "Thick rayon with wide flyaways"),
    ("rayon-4", "Rayon 4", "Thick rayon with an even density"),
    ("silk-1", "Silk 1", "Fine silk, three plies"),
    ("silk-2", "Silk 2", "Fine silk, three loose plies"),
    ("polyester-1", "Polyester 1", "Polyester, two plies"),
)
_FITTED = (
    ("fleece", "Fleece", "Blue fleece"),
    ("gabardine", "Gabardine", "Red gabardine"),
    ("silk", "Silk", "Silk with a red sheen"),
    ("cotton", "Cotton", "White cotton"),
)

YARN_ITEMS = tuple((name, label, note, number) for number, (name, label, note) in enumerate(_MEASURED))
"""Items of an EnumProperty: the yarns of Zhao et al. 2016, table 2."""

FIBER_ITEMS = tuple((name, label, note, number) for number, (name, label, note) in enumerate(_MEASURED + _FITTED))
"""Items of an EnumProperty: fibers of Zhao et al. 2016, table 3, and of Khungurn et al. 2015."""

DEFAULT_YARN = "cotton-1"
DEFAULT_FIBER = "cotton-1"
"""What an object without any setting is made of."""
