# SPDX-License-Identifier: GPL-3.0-or-later
"""The names of the measured yarns and fibers, as Blender shows them.

The numbers live in the native module and nowhere else; `tests/blender/test_presets.py` holds the two lists together.
The numbers at the end are stored in .blend files: never renumber.
"""

YARN_ITEMS = (
    ("cotton-1", "Cotton 1", "Three plies, soft, with many fibers", 0),
    ("cotton-2", "Cotton 2", "Three plies, thin, with few fibers", 1),
    ("rayon-1", "Rayon 1", "Two thick plies with many fibers", 2),
    ("rayon-2", "Rayon 2", "Two thin plies", 3),
    ("rayon-3", "Rayon 3", "Two thick plies with wide flyaways", 4),
    ("rayon-4", "Rayon 4", "Two thick plies of even density", 5),
    ("silk-1", "Silk 1", "Three fine plies", 6),
    ("silk-2", "Silk 2", "Three loose plies", 7),
    ("polyester-1", "Polyester 1", "Two thin plies with few fibers", 8),
)
"""Items of an EnumProperty: the yarns of Zhao et al. 2016, table 2."""

FIBER_ITEMS = (
    ("cotton-1", "Cotton 1", "White", 0),
    ("cotton-2", "Cotton 2", "Orange", 1),
    ("rayon-1", "Rayon 1", "Light blue", 2),
    ("rayon-2", "Rayon 2", "Sky blue", 3),
    ("rayon-3", "Rayon 3", "Black", 4),
    ("rayon-4", "Rayon 4", "Cream", 5),
    ("silk-1", "Silk 1", "Pink", 6),
    ("silk-2", "Silk 2", "Teal", 7),
    ("polyester-1", "Polyester 1", "Yellow", 8),
    ("fleece", "Fleece", "Blue, matte", 9),
    ("gabardine", "Gabardine", "Red, with a dull sheen", 10),
    ("silk", "Silk", "Grey with a strong red sheen", 11),
    ("cotton", "Cotton", "White with a strong sheen", 12),
)
"""Items of an EnumProperty: fibers of Zhao et al. 2016, table 3, and of Khungurn et al. 2015."""

DEFAULT_YARN = "cotton-1"
DEFAULT_FIBER = "cotton-1"
"""What an object without any setting is made of."""


def number_of(name, items):
    """What is stored of a preset."""
    return next(item[3] for item in items if item[0] == name)
