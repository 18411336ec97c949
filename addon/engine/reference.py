# SPDX-License-Identifier: GPL-3.0-or-later
"""Final pictures by the path tracer, from the same scene as the renderer's."""


def draw(lisle, what, settings, **options):
    """The lisle.Image of a lisle.Scene, or of a list of them over the shutter; `options` go to `Reference.render`."""
    return lisle.Reference().render(
        what,
        samples=settings.reference_samples,
        bounces=settings.reference_bounces or None,
        shading=settings.shading,
        seed=settings.seed,
        **options,
    )
