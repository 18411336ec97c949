"""One case: pictures by both, and their measures."""

import dataclasses
from dataclasses import dataclass
from itertools import product
from typing import Any

import lisle
import measures
import models
import numpy as np
from measures import Picture


@dataclass(frozen=True)
class Case:
    """Something to look at."""

    model: str
    yarn: str
    material: str
    light: str
    view: str

    def __str__(self) -> str:
        return " ".join(dataclasses.astuple(self))


def everything(available: tuple[str, ...]) -> list[Case]:
    """The whole product."""
    return [
        Case(*each) for each in product(available, lisle.Yarn.presets(), models.MATERIALS, models.LIGHTS, models.VIEWS)
    ]


def few(available: tuple[str, ...]) -> list[Case]:
    """Each value of each property at least once, others at their usual one."""
    cases = [Case(model, "cotton-1", "light", "front", view) for model in available for view in models.VIEWS]
    cases += [
        Case("knit", "cotton-1", material, light, "middle") for material in models.MATERIALS for light in models.LIGHTS
    ]
    cases += [Case("straight", yarn, "light", "front", "middle") for yarn in lisle.Yarn.presets()]
    return list(dict.fromkeys(cases))


@dataclass(frozen=True)
class Pair:
    """A picture beside its reference."""

    reference: Picture
    test: Picture
    covered: np.ndarray
    flip_map: np.ndarray
    mean_error: float
    mean_noise: float
    rmse: float
    rmse_noise: float
    flip: float
    flip_noise: float


@dataclass(frozen=True)
class Result:
    """Of a case."""

    case: Case
    single: Pair
    multiple: Pair
    coverage: float
    """Mean coverage against the reference's, relative difference."""
    detail: float
    """Mean colour with levels of detail against that with every fiber, by the renderer alone."""
    every_fiber: float
    """Mean error of single scattering with every fiber drawn."""
    every_fiber_flip: float
    """FLIP of the same: what core fibers are not to blame for."""
    fine_tables: float
    """The same with tables of self-shadow and occlusion four times as fine."""
    fine_shadows: float | None
    """The same with a shadow map four times as fine; none under a sky or where nothing casts shadows on another."""
    table_occlusion: float | None
    """The same with the table of occlusion; only under a sky."""


def colour(image: lisle.Image) -> Picture:
    """Premultiplied colours."""
    return image["combined"][..., :3].astype(np.float64)


def pair(rendered: list[lisle.Image], reference: lisle.Image) -> Pair:
    """Measures of the mean of two pictures with samples of their own, whose difference tells their noise."""
    first, second = (colour(image) for image in rendered)
    test = 0.5 * (first + second)
    expected = colour(reference)
    variance = reference["variance"].astype(np.float64)
    covered = (reference["alpha"] > 0) | (rendered[0]["alpha"] > 0)
    flip, flip_map = measures.flip(test, expected, covered)
    own = 0.5 * measures.mean_error(first, second)
    return Pair(
        expected,
        test,
        covered,
        flip_map,
        measures.mean_error(test, expected),
        float(np.hypot(measures.mean_noise(variance, expected), own)),
        measures.rmse(test, expected),
        measures.rmse_noise(variance, expected),
        flip,
        measures.flip_noise(variance, expected, covered),
    )


def compare(renderer: lisle.Renderer, case: Case, yarns: lisle.Yarns, samples: int) -> Result:
    """Draws a case with both, each with so many samples."""
    material = lisle.Material.preset(models.MATERIALS[case.material])
    yarn = lisle.Yarn.preset(case.yarn)

    def scene() -> lisle.Scene:
        return models.scene(yarns, yarn, material, case.view, case.light)

    def draw(**options: Any) -> lisle.Image:
        return renderer.render(scene(), **{"samples": samples // 2, "transport_photons": 0, **options})

    def twice(**options: Any) -> list[lisle.Image]:
        many = models.RENDERER_SAMPLES[case.view] * samples // 2
        return [draw(seed=seed, samples=many, **options) for seed in (0, 1)]

    rendered = twice()
    all_orders = [draw(seed=seed, transport_photons=500_000) for seed in (0, 1)]
    full = sum(colour(image) for image in twice(lod_pixels=0)) / 2
    single = lisle.Reference().render(scene(), bounces=1, samples=models.REFERENCE_SAMPLES[case.view] * samples)
    multiple = lisle.Reference().render(scene(), samples=samples, seed=1)
    alpha = 0.5 * sum(float(image["alpha"].mean(dtype=np.float64)) for image in rendered)
    expected = colour(single)

    def error(**options: Any) -> float:
        return measures.mean_error(colour(draw(lod_pixels=0, **options)), expected)

    shadowed = case.light in models.SUNS and case.model != "straight"
    once = pair(rendered, single)
    return Result(
        case,
        once,
        pair(all_orders, multiple),
        alpha / float(single["alpha"].mean(dtype=np.float64)) - 1,
        measures.mean_error(sum(colour(image) for image in rendered) / 2, full),
        measures.mean_error(full, expected),
        measures.flip(full, expected, once.covered)[0],
        error(table_resolution=4),
        error(shadow_resolution=8192) if shadowed else None,
        error(occlusion="table") if case.light == "sky" else None,
    )


ANGLES_DEG = (0, 15, 30, 60, 90, 120, 150)


def hot_spot(renderer: lisle.Renderer, samples: int) -> list[tuple[int, float, float, float, float]]:
    """A straight yarn, every fiber drawn, under suns that turn about it from behind the camera.

    No level of detail, no core fiber and no other yarn: what is wrong is scattering or self-shadow. One fiber alone
    has no self-shadow.

    Returns:
        Angle between the ways to the sun and to the camera in degrees, mean error of a yarn and its noise, and the
        same of one fiber.
    """
    yarns = models.lone()
    yarn = lisle.Yarn.preset("cotton-1").replace(loop_density=0.0, hair_density=0.0)
    one = yarn.replace(plies=1, fibers_per_ply=1)
    material = lisle.Material.preset(models.MATERIALS["light"])
    rows = []
    for angle in ANGLES_DEG:
        a = np.radians(angle)
        found = []
        for each, factor in ((yarn, 1), (one, 4)):
            scene = models.scene(yarns, each, material, "near", models.sun((0.0, -np.sin(a), -np.cos(a))))
            reference = lisle.Reference().render(scene, bounces=1, samples=factor * samples)
            rendered = renderer.render(scene, samples=samples, lod_pixels=0, transport_photons=0)
            expected = colour(reference)
            found.append(measures.mean_error(colour(rendered), expected))
            found.append(measures.mean_noise(reference["variance"], expected))
        rows.append((angle, *found))
    return rows
