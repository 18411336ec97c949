# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene as interactive views draw it: read when something changes, drawn from any side by the painter's thread."""

import itertools

from ..core.painter import Stopped
from ..export.scene import collect
from ..export.world import DARK, forget_images, read_world
from .assembly import add_objects
from .renderer import drop, renderer
from .rest import RestShapes
from .surfaces import Surfaces

REST_SHAPES = RestShapes()
"""Rest shapes of what views have shown; forgotten with the file."""

SURFACES = Surfaces()
"""Of what views have shown."""

_SHADOW_TEXELS = (256, 512, 1024)
_PHOTONS = (20_000, 20_000, 500_000)
_SKY_DIRECTIONS = (3, 8, 8)
"""By the painter's quality: along one side of a shadow map; of the tables of multiple scattering, whose final ones
take seconds for a material that was never seen before; and in which the sky is seen."""

_numbers = itertools.count()


class Snapshot:
    """What a view layer shows at one moment. Made in Blender's main thread; holds no reference into its data."""

    def __init__(self, lisle, depsgraph, shows):
        scene = depsgraph.scene
        self._lisle = lisle
        self.notes = []
        """What is left out, in sentences."""
        self._not_drawn = []
        self.content = collect(lisle, depsgraph, self.notes.append, shows=shows)
        self._at_rest = REST_SHAPES.known(scene, depsgraph.view_layer, self.content)
        if depsgraph.id_type_updated("IMAGE"):
            forget_images()
        self._world = read_world(lisle, scene.world, self.notes.append)
        self.background = None if scene.render.film_transparent else self._world.ambient
        """Scene-linear colour behind the yarns, None if it is transparent."""
        self._native = None
        self._meshes = []
        settings = scene.lisle
        self.number = next(_numbers)
        """Differs from that of any other snapshot."""
        self.samples = settings.viewport_samples
        self._multiple_scattering = settings.multiple_scattering
        self._settings = {
            "shading": settings.shading,
            "occlusion": settings.occlusion,
            "lod_pixels": settings.lod,
            "transparent": scene.render.film_transparent,
        }

    def shows_the_same_as(self, other):
        """Whether pictures of both are equal."""
        return (
            self._settings == other._settings
            and self._multiple_scattering == other._multiple_scattering
            and self.samples == other.samples
            and self._world.equals(other._world)
            and self.content.equals(other.content)
            and all(
                self._at_rest[key] is other._at_rest[key] or self._at_rest[key].equals(other._at_rest[key])
                for key in self._at_rest
            )
        )

    def left_out(self):
        """All that is left out, in sentences; more may come with the first picture."""
        return [*self.notes, *self._not_drawn]

    def painter(self, camera, lighting=None, alone=False):
        """The `draw` of a core.painter.Task that shows this from a lisle.Camera.

        `lighting` is a list of lights in place of the scene's and its world; `alone` leaves out meshes and what is
        behind everything.
        """
        settings = dict(self._settings)
        if alone:
            settings["transparent"] = True

        def draw(size, region, samples, first_sample, quality, go_on):
            lisle = self._lisle
            try:
                image = renderer(lisle).render(
                    self._scene(camera, lighting, alone),
                    size=size,
                    region=region,
                    samples=samples,
                    first_sample=first_sample,
                    shadow_resolution=_SHADOW_TEXELS[quality],
                    sky_directions=_SKY_DIRECTIONS[quality],
                    transport_photons=_PHOTONS[quality] if self._multiple_scattering else 0,
                    progress=lambda _: go_on(),
                    **settings,
                )
            except lisle.Cancelled as error:
                raise Stopped from error
            except lisle.DeviceError:
                drop()
                raise
            return image["combined"], image["depth"]

        return draw

    def _scene(self, camera, lighting, alone):
        """The lisle.Scene; made at the first call, in the painter's thread."""
        if self._native is None:
            scene = self._lisle.Scene(camera=camera)
            taken = add_objects(self._lisle, scene, self.content, self._at_rest, REST_SHAPES, self._not_drawn.append)
            self._meshes, _ = SURFACES.meshes(self._lisle, self.content.meshes, taken)
            self._native = scene
        self._native.camera = camera
        world = self._world if lighting is None else DARK
        self._native.lights = self.content.lights if lighting is None else lighting
        self._native.ambient, self._native.environment = world.ambient, world.environment
        self._native.meshes = [] if alone else self._meshes
        return self._native
