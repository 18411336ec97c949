# SPDX-License-Identifier: GPL-3.0-or-later
"""Fibers of yarns that were read before, made away from Blender's data: by a thread of its own, or by the caller."""

import threading

import numpy as np

from ..core.errors import Cancelled, LisleError, SceneError


class FiberWork(threading.Thread):
    """`start` has a thread do it, `run` does it at once; then there is a `result`."""

    def __init__(self, lisle, pieces, camera, detail, most_points):
        """`pieces` are (Placement, lisle.Yarns, (lisle.Yarn, lisle.Material)); a lisle.Camera makes fewer fibers, of
        `detail` pixels at least; `most_points` are millions."""
        super().__init__(name="Lisle fibers", daemon=True)
        self._lisle, self._pieces, self._camera = lisle, pieces, camera
        self._detail, self._most_points = detail, most_points
        self._stopping = False
        self._made = self._error = None
        self.share = 0.0
        """How much is done."""

    def stop(self):
        """Ends it soon; the result is Cancelled then."""
        self._stopping = True

    def result(self):
        """[(Placement, lisle.Fibers, lisle.Material)]. Raises LisleError if they could not be made."""
        if self._error is not None:
            raise self._error
        return self._made

    def run(self):
        try:
            self._made = self._make()
        except self._lisle.Cancelled:
            self._error = Cancelled()
        except self._lisle.Error as error:
            self._error = LisleError(str(error))
        except Exception as error:  # raised where the result is asked for
            self._error = error

    def _make(self):
        made, points = [], 0
        for number, (placement, yarns, (yarn, material)) in enumerate(self._pieces):

            def progress(share, number=number):
                self.share = (number + share) / len(self._pieces)
                return not self._stopping

            fibers = self._lisle.fibers(
                yarns,
                yarn,
                object_id=placement.identity,
                camera=None if self._camera is None else self._seen_from(placement.world_from_object),
                lod_pixels=self._detail,
                progress=progress,
            )
            points += len(fibers.points)
            if points > 1_000_000 * self._most_points:
                raise SceneError(f"More than {self._most_points} million points: raise Most Points, or use a camera")
            made.append((placement, fibers, material))
        return made

    def _seen_from(self, world_from_object):
        """The camera in an object's space, where its fibers are made."""
        camera = self._camera
        world_from_camera = np.linalg.solve(world_from_object, camera.world_from_camera)
        return self._lisle.Camera.from_matrices(world_from_camera, camera.clip_from_camera, camera.size)
