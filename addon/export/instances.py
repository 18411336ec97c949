# SPDX-License-Identifier: GPL-3.0-or-later
"""What tells instances of an object apart."""


def instancer_of(instance):
    """Part of the identity of an entry of `depsgraph.object_instances`: the same in every frame and process."""
    return (instance.parent.name_full, *instance.persistent_id) if instance.is_instance else ()
