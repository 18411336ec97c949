"""A stand-in for the native module: same names, same checks of form, a picture of dots.

It records what it is given in `scenes` and fails where `fail` says so. A dot's colour is its rest length, so that
a wrong rest shape shows in the picture.
"""

from types import SimpleNamespace

import numpy as np

scenes = []
"""Every (Scene, render arguments) that was drawn."""

fail = {}
"""Name of a call ('Yarns', 'render', 'reference') → exception that it raises."""


class Error(Exception):
    pass


class InputError(Error):
    pass


class DeviceError(Error):
    pass


class Cancelled(Error):
    pass


def _fail(name):
    if name in fail:
        raise fail[name]


def _refuse_infinite(name, points):
    finite = np.isfinite(points).all(axis=1)
    if not finite.all():
        raise InputError(f"{name}: point {int(np.argmin(finite))} is not finite")


class Yarns:
    def __init__(
        self, points, offsets, closed=None, basis=None, radii=None, *, nurbs_order=None, nurbs_weights=None,
        nurbs_knots_mode=None, yarn_radius=None, length_coordinates=None, name="",
    ):  # fmt: skip
        _fail("Yarns")
        self.points = np.array(points, np.float32)
        self.offsets = np.array(offsets, np.uint32)
        curves = len(self.offsets) - 1
        assert self.points.shape == (self.offsets[-1], 3), "points"
        assert closed.shape == basis.shape == (curves,) and radii.shape == (len(self.points),)
        _refuse_infinite(name, self.points)
        self.closed, self.basis, self.radii, self.name = closed, basis, radii, name
        self.nurbs_order, self.nurbs_weights, self.nurbs_knots_mode = nurbs_order, nurbs_weights, nurbs_knots_mode
        self.rest_points = self.points
        if length_coordinates is None:
            steps = np.linalg.norm(np.diff(self.points, axis=0, prepend=self.points[:1]), axis=1)
            steps[self.offsets[:-1]] = 0
            total = np.cumsum(steps)
            length_coordinates = total - np.repeat(total[self.offsets[:-1]], np.diff(self.offsets.astype(int)))
        self.length_coordinates = np.array(length_coordinates, np.float32)

    def with_points(self, points):
        _fail("Yarns")
        _refuse_infinite(self.name, points)
        moved = object.__new__(Yarns)
        moved.__dict__.update(self.__dict__)
        moved.points = np.array(points, np.float32)
        assert moved.points.shape == self.points.shape
        return moved


class _Values:
    """Subclasses say which FIELDS and PRESETS there are."""

    def __init__(self, **values):
        self.__dict__.update(values)

    def __eq__(self, other):
        return self.__dict__ == other.__dict__

    @classmethod
    def presets(cls):
        return list(cls.PRESETS)

    @classmethod
    def preset(cls, name):
        if name not in cls.PRESETS:
            raise InputError(f"no preset '{name}'")
        return cls(name=name, **cls.FIELDS)

    def replace(self, **values):
        unknown = set(values) - set(self.FIELDS)
        assert not unknown, unknown
        return type(self)(**(self.__dict__ | values))


_MEASURED = (
    "cotton-1", "cotton-2", "rayon-1", "rayon-2", "rayon-3", "rayon-4", "silk-1", "silk-2", "polyester-1",
)  # fmt: skip


class Yarn(_Values):
    PRESETS = _MEASURED
    FIELDS = dict.fromkeys(
        ("loop_r_max", "hair_r_min", "hair_r_span", "hair_z_span", "hair_theta_span"), (0.02, 0.01)
    ) | {
        "plies": 3, "fibers_per_ply": 75, "ply_twist": 0.453, "fiber_twist": -0.369, "ply_radius": 0.038,
        "ellipse_long": 0.026, "ellipse_short": 0.02, "fiber_radius": 0.002, "density_beta": 0.148,
        "density_epsilon": 0.0, "r_min": 0.8, "migration_rate": 1.1, "loop_density": 22.17, "hair_density": 33.77,
    }  # fmt: skip


class Material(_Values):
    PRESETS = (*_MEASURED, "fleece", "gabardine", "silk", "cotton")
    FIELDS = dict.fromkeys(("color_r", "color_tt", "diffuse", "specular"), (0.9, 0.8, 0.7)) | {
        "beta_r_deg": 1.0, "beta_tt_deg": 27.0, "gamma_tt_deg": 38.0, "diffuse_weight": 0.1, "specular_beta_deg": 5.0,
    }  # fmt: skip


class Camera:
    def __init__(
        self, world_from_camera, clip_from_camera, size, aperture_radius=0.0, focus_distance=1.0, blades=0,
        rotation_rad=0.0, ratio=1.0,
    ):  # fmt: skip
        self.world_from_camera, self.clip_from_camera, self.size = world_from_camera, clip_from_camera, size
        self.aperture_radius, self.focus_distance = aperture_radius, focus_distance
        self.blades, self.rotation_rad, self.ratio = blades, rotation_rad, ratio
        for matrix in (world_from_camera, clip_from_camera):
            assert matrix.shape == (4, 4) and matrix.dtype == np.float64


class _Light:
    def __init__(self, **values):
        self.__dict__.update(values)


class Sun(_Light):
    pass


class Point(_Light):
    pass


class Spot(_Light):
    pass


class Area(_Light):
    pass


class Environment:
    def __init__(self, image, rotation=0.0, strength=1.0):
        _fail("Environment")
        if isinstance(image, np.ndarray):
            assert image.dtype == np.float32 and image.ndim == 3 and image.shape[2] == 3
            image = SimpleNamespace(texels=image.copy(), size=image.shape[1::-1])
        self.image, self.world_from_environment, self.strength = image, np.array(rotation), strength
        assert self.world_from_environment.shape in ((), (3, 3))


class Texture:
    def __init__(self, codes):
        assert codes.dtype == np.uint8 and codes.ndim == 3 and codes.shape[2] == 3
        self.codes = codes.copy()


class Mesh:
    def __init__(
        self, positions, triangles, normals=None, *, base_color, uvs, texture, kind, name, material_name,
        material_index,
    ):  # fmt: skip
        assert positions.shape[1:] == triangles.shape[1:] == (3,) and positions.dtype == np.float32
        assert normals is None or normals.shape == (*triangles.shape, 3)
        assert kind in ("shaded", "shadow-catcher", "holdout") and len(base_color) == 3
        self.positions, self.corners, self.normals = positions, triangles, normals
        self.triangles, self.base_color, self.kind, self.name = object(), base_color, kind, name
        self.material_name, self.material_index = material_name, material_index
        assert uvs is None or uvs.shape == (*triangles.shape[:1], 3, 2)
        assert texture is None or uvs is not None
        self.uvs, self.texture = uvs, texture

    def at(self, transform, object_id, name, object_index):
        placed = object.__new__(Mesh)
        placed.__dict__.update(self.__dict__, world_from_object=transform, object_id=object_id, name=name)
        placed.object_index = object_index
        assert transform.shape == (4, 4)
        return placed


class Entry:
    def __init__(self, yarns, yarn, material, transform, object_id, name, labels, holdout):
        assert transform.shape == (4, 4) and transform.dtype == np.float64
        assert 0 < object_id < 2**32
        self.yarns, self.yarn, self.material = yarns, yarn, material
        self.transform, self.object_id, self.name = transform, object_id, name
        self.object_index, self.material_name, self.material_index = labels
        self.holdout = holdout


class Scene:
    def __init__(self, camera, lights=(), ambient=(0, 0, 0), environment=None):
        self.camera, self.lights, self.ambient, self.entries = camera, list(lights), ambient, []
        self.environment, self.meshes = environment, []

    def add(
        self, yarns, *, yarn, material, transform, object_id, name, object_index, material_name, material_index,
        holdout,
    ):  # fmt: skip
        labels = object_index, material_name, material_index
        self.entries.append(Entry(yarns, yarn, material, transform, object_id, name, labels, holdout))


FURTHER_PASSES = {
    "position": 3, "uv": 2, "vector": 4, "object_index": 1, "material_index": 1, "crypto_object": 12,
    "crypto_material": 12, "diffuse": 3, "specular": 3, "transmission": 3, "scattered": 3, "ambient": 3, "shadow": 1,
    "albedo": 3, "denoising_normal": 3,
}  # fmt: skip


class Image(dict):
    def cryptomatte_metadata(self, layer_prefix=""):
        layers = {"crypto_object": "CryptoObject", "crypto_material": "CryptoMaterial"}
        return {f"cryptomatte/{name}": layer_prefix + layer for name, layer in layers.items() if name in self}


def set_threads(count):
    assert count > 0
    return True


class Renderer:
    adapter = SimpleNamespace(name="a stand-in, no GPU")
    _NAME = "render"

    def render(self, what, *, size, samples, region, transparent, progress, passes=(), **settings):
        scene = what[len(what) // 2] if isinstance(what, list) else what
        scenes.append(
            (what, {"size": size, "samples": samples, "region": region, "transparent": transparent} | settings)
        )
        _fail(self._NAME)
        if not progress(0.5):
            raise Cancelled("cancelled")
        width, height = size
        image = {
            "combined": np.zeros((height, width, 4), np.float32),
            "depth": np.full((height, width), 1e10, np.float32),
            "alpha": np.zeros((height, width), np.float32),
            "normal": np.zeros((height, width, 3), np.float32),
            "tangent": np.zeros((height, width, 3), np.float32),
            "object_id": np.zeros((height, width), np.uint32),
        }
        if not transparent:
            image["combined"][:] = (*scene.ambient, 1)
        camera_from_world = np.linalg.inv(scene.camera.world_from_camera)
        for entry in scene.entries:
            homogeneous = np.c_[entry.yarns.points.astype(np.float64), np.ones(len(entry.yarns.points))]
            in_camera = homogeneous @ (camera_from_world @ entry.transform).T
            clip = in_camera @ scene.camera.clip_from_camera.T
            ndc = clip[:, :2] / clip[:, 3:]
            x = np.floor((ndc[:, 0] * 0.5 + 0.5) * width).astype(int)
            row = np.floor((0.5 - ndc[:, 1] * 0.5) * height).astype(int)
            seen = (x >= 0) & (x < width) & (row >= 0) & (row < height) & (clip[:, 3] > 0)
            x, row = x[seen], row[seen]
            lengths = entry.yarns.length_coordinates[seen]
            image["combined"][row, x] = np.stack(
                (lengths, lengths * 0.5, np.ones_like(lengths), np.ones_like(lengths)), 1
            )
            image["depth"][row, x] = -in_camera[seen, 2]
            image["alpha"][row, x] = 1
            image["normal"][row, x] = (0, 0, 1)
            image["tangent"][row, x] = (1, 0, 0)
            image["object_id"][row, x] = entry.object_id
        if region is not None:
            x0, y0, x1, y1 = region
            image = {name: picture[height - y1 : height - y0, x0:x1] for name, picture in image.items()}
        height, width = image["depth"].shape
        for name in passes:
            channels = FURTHER_PASSES[name]
            image[name] = np.full((height, width, channels)[: 2 if channels == 1 else 3], 0.5, np.float32)
        return Image(image)


class Reference(Renderer):
    _NAME = "reference"

    def render(self, what, *, bounces, **options):
        assert bounces is None or bounces > 0
        unknown = set(options) - {"size", "samples", "region", "transparent", "progress", "shading", "seed"}
        assert not unknown, unknown
        return super().render(what, bounces=bounces, **options)
