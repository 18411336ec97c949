# SPDX-License-Identifier: GPL-3.0-or-later
"""Which curves are yarn: those that do not serve another object as its path, its profile or its guide."""

import bpy

_CONSTRAINTS = {"FOLLOW_PATH", "CLAMP_TO", "SPLINE_IK"}


class Guides:
    """Tells yarn from other curves. Made for one reading of a scene."""

    def __init__(self):
        self._uses = None

    def is_yarn(self, obj):
        """Whether an object's curves are drawn as yarn."""
        choice = obj.original.lisle.is_yarn
        return choice == "ALWAYS" or (choice == "AUTO" and self.use_of(obj) is None)

    def use_of(self, obj):
        """What a legacy curve object serves as, in words; None if it serves as nothing."""
        if obj.type != "CURVE":
            return None
        if obj.field is not None and obj.field.type == "GUIDE":
            return "it guides particles"
        if self._uses is None:
            self._uses = _uses()
        return self._uses.get(obj.original)


def _uses():
    """By curve object: what it serves as, of all that other objects of this file make of curves."""
    curves = {obj for obj in bpy.data.objects if obj.type == "CURVE"}
    uses = {}
    for users in bpy.data.user_map(subset=curves).values() if curves else ():
        for user in users:
            if isinstance(user, bpy.types.Object):
                _note_object(user, uses)
            elif isinstance(user, bpy.types.Curve):
                _note_data(user, uses)
    return uses


def _note_object(user, uses):
    name = user.name
    bones = user.pose.bones if user.pose is not None else ()
    for constraint in (*user.constraints, *(each for bone in bones for each in bone.constraints)):
        if constraint.type in _CONSTRAINTS and constraint.target is not None:
            uses[constraint.target] = f"'{name}' follows it"
    for modifier in user.modifiers:
        if modifier.type == "CURVE" and modifier.object is not None:
            uses[modifier.object] = f"'{name}' is bent along it"
        elif modifier.type == "ARRAY" and modifier.fit_type == "FIT_CURVE" and modifier.curve is not None:
            uses[modifier.curve] = f"the array of '{name}' is as long as it"
    parent = user.parent
    if parent is not None and parent.type == "CURVE" and user.parent_type == "OBJECT" and _moves_children(parent.data):
        uses[parent] = f"'{name}' follows it"


def _moves_children(curve):
    """Whether children travel along a curve: where its time runs."""
    animation = curve.animation_data
    return curve.use_path and animation is not None and (animation.action is not None or len(animation.drivers) > 0)


def _note_data(user, uses):
    for role in ("bevel_object", "taper_object"):
        profile = getattr(user, role, None)
        if profile is not None:
            uses[profile] = f"'{user.name}' has it as {'a profile' if role == 'bevel_object' else 'a taper'}"
    along = getattr(user, "follow_curve", None)
    if along is not None:
        uses[along] = f"the text '{user.name}' runs along it"
