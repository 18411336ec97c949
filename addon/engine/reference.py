# SPDX-License-Identifier: GPL-3.0-or-later
"""Final pictures by the path tracer, from the same scene as the renderer's."""


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
