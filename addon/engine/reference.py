# SPDX-License-Identifier: GPL-3.0-or-later
"""Final pictures by the path tracer, from the same scene as the renderer's."""


def material_of(settings):
    """How a fiber's lisle.Material changes for the path tracer.

    The diffuse part stands for light that is scattered between fibers; where paths do that, it would count twice.
    """
    if settings.shading != "physical" or settings.reference_bounces == 1:
        return lambda material: material
    return lambda material: material.replace(diffuse_weight=0.0)


def draw(lisle, scene, settings, **options):
    """The lisle.Image of a lisle.Scene; `options` go to `lisle.Reference.render`."""
    return lisle.Reference().render(
        scene,
        samples=settings.reference_samples,
        bounces=settings.reference_bounces or None,
        shading=settings.shading,
        seed=settings.seed,
        **options,
    )
