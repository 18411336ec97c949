# SPDX-License-Identifier: GPL-3.0-or-later
"""Yarn at rest: the shape on which its length is measured, from the reference frame.

A frame's picture must not depend on the frames drawn before it. So the rest shape is never what happened to be
drawn first: if the job is not at the reference frame, the scene is evaluated there, once per job, and back again.
"""

import bpy

from ..core.errors import RestShapeError
from ..export.scene import collect
from ..native import native_yarns


class RestShapes:
    """Rest shapes by scene, view layer, reference frame and geometry."""

    def __init__(self):
        self._curves = {}
        self._yarns = {}

    def clear(self):
        self._curves.clear()
        self._yarns.clear()

    def find(self, lisle, engine, depsgraph, content):
        """CurveArrays at rest by geometry key, for all of `content`, which was collected at the present frame.

        Evaluates other frames where it has to. References into `depsgraph` from before are invalid afterwards.
        """
        scene = depsgraph.scene
        frame, subframe = scene.frame_current, scene.frame_subframe
        view = (scene.name_full, depsgraph.view_layer.name)
        at_rest, missing = {}, {}
        for geometry in content.geometries.values():
            place = (*view, geometry.reference_frame, geometry.key)
            if geometry.remeasure:
                at_rest[geometry.key] = geometry.curves
                continue
            if geometry.reference_frame == frame and subframe == 0.0:
                self._curves[place] = geometry.curves
            if place in self._curves:
                at_rest[geometry.key] = self._curves[place]
            else:
                missing.setdefault(geometry.reference_frame, []).append(geometry)
        try:
            for reference_frame, geometries in missing.items():
                engine.frame_set(reference_frame, 0.0)
                names = {geometry.key[0] for geometry in geometries}
                found = collect(lisle, depsgraph, lambda _: None, only=names).geometries
                for geometry in geometries:
                    if geometry.key not in found:
                        raise RestShapeError(
                            geometry.object_name,
                            frame,
                            reference_frame,
                            "it shows no such curves at its reference frame",
                        )
                    curves = found[geometry.key].curves
                    self._curves[(*view, reference_frame, geometry.key)] = curves
                    at_rest[geometry.key] = curves
        finally:
            if missing:
                engine.frame_set(frame, subframe)
        for geometry in content.geometries.values():
            difference = geometry.curves.difference_from_rest(at_rest[geometry.key])
            if difference is not None:
                raise RestShapeError(geometry.object_name, frame, geometry.reference_frame, difference)
        return at_rest

    def known(self, scene, view_layer, content):
        """As `find`, for interactive views: no other frame is evaluated. Until the reference frame has been shown, the
        shape seen first counts as the one at rest; so does a new one whose points do not correspond to it.
        """
        self._forget_removed()
        frame, subframe = scene.frame_current, scene.frame_subframe
        at_rest = {}
        for geometry in content.geometries.values():
            place = (scene.name_full, view_layer.name, geometry.reference_frame, geometry.key)
            rest = self._curves.get(place)
            is_reference = geometry.reference_frame == frame and subframe == 0.0
            if is_reference or rest is None or geometry.curves.difference_from_rest(rest) is not None:
                self._curves[place] = geometry.curves
            at_rest[geometry.key] = geometry.curves if geometry.remeasure else self._curves[place]
        return at_rest

    def _forget_removed(self):
        """Drops what belongs to objects that are no more; a long session makes and removes many."""
        names = {obj.name_full for obj in bpy.data.objects}
        for place in [place for place in self._curves if place[-1][0] not in names]:
            del self._curves[place]
        # The painter's thread may add yarns meanwhile: list() is one step to it.
        for key in [key for key in list(self._yarns) if key[0] not in names]:
            self._yarns.pop(key, None)

    def yarns(self, lisle, key, current, at_rest):
        """`lisle.Yarns` at rest as `at_rest` and placed as `current`; the measured part is kept for the next frame."""
        rest = current.at_rest(at_rest)
        digest = rest.digest()
        kept = self._yarns.get(key)
        if kept is None or kept[0] != digest:
            kept = digest, native_yarns(lisle, rest, key[0])
            self._yarns[key] = kept
        return kept[1] if at_rest is current else kept[1].with_points(current.points)
