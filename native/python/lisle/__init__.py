"""Fiber-level cloth from yarn curves.

Lengths are metres (or the file's unit, where it has none), right-handed, Z up; colours are scene-linear Rec.709.

>>> import lisle
>>> yarns = lisle.load("glove.bcc")
>>> camera = lisle.Camera.fit(yarns, direction=(0, -1, 0.3), size=(1280, 960))
>>> image = lisle.Renderer().render(yarns, camera=camera, lights=[lisle.Sun(direction=(-1, 1, -2), strength=3.0)])
>>> image.save("glove.png")
"""

from ._native import Adapter, Yarns, __version__, adapters, set_threads, threads
from .camera import Camera
from .environment import Environment
from .errors import Cancelled, DeviceError, Error, InputError
from .fabric import MeshKnit, knit_on_mesh, knit_sleeve, knit_swatch, knit_tube, sweater, woven_swatch
from .image import FURTHER_PASSES, Image
from .lights import Area, Gaussian, Light, Point, Spot, Sun
from .loading import load
from .material import Material
from .mesh import Mesh, Texture
from .reference import Fibers, Reference, fibers
from .renderer import Renderer
from .scene import Object, Scene
from .yarn import Yarn

__all__ = [
    "FURTHER_PASSES",
    "Adapter",
    "Area",
    "Camera",
    "Cancelled",
    "DeviceError",
    "Environment",
    "Error",
    "Fibers",
    "Gaussian",
    "Image",
    "InputError",
    "Light",
    "Material",
    "Mesh",
    "MeshKnit",
    "Object",
    "Point",
    "Reference",
    "Renderer",
    "Scene",
    "Spot",
    "Sun",
    "Texture",
    "Yarn",
    "Yarns",
    "__version__",
    "adapters",
    "fibers",
    "knit_on_mesh",
    "knit_sleeve",
    "knit_swatch",
    "knit_tube",
    "load",
    "set_threads",
    "sweater",
    "threads",
    "woven_swatch",
]
