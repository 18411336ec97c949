# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's light settings, brought to powers in watts."""

import math


def unnormalized_factor(kind, radius_m=0.0, area_m2=0.0, angle_rad=0.0):
    """What a light's strength is multiplied by if its 'Normalize' is off (then it is a radiance, not a power).

    `kind` is Blender's light type, `area_m2` the emitting area of an area light in world space.
    """
    if kind == "AREA":
        return area_m2
    if kind == "SUN":
        return math.pi * math.sin(angle_rad / 2) ** 2 if angle_rad > 0 else 1.0
    return 4 * math.pi * radius_m**2 if radius_m > 0 else 4.0


def area_m2(size_m, is_disk):
    """Area of a rectangle of that size, or of the ellipse in it."""
    return size_m[0] * size_m[1] * (math.pi / 4 if is_disk else 1.0)
