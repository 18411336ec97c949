"""What the tests of the package share. They need a graphics adapter; a software one (Mesa's lavapipe) does."""

import os
from pathlib import Path

import lisle
import numpy as np
import pytest

REPOSITORY = Path(__file__).parents[2]
DATA = Path(os.environ.get("LISLE_DATA", REPOSITORY.parent / "shared" / "data"))

SIZE = (96, 72)
"""Of most pictures here, pixels."""


@pytest.fixture(scope="session")
def renderer():
    return lisle.Renderer()


@pytest.fixture(scope="session")
def swatch():
    return lisle.knit_swatch(courses=6, wales=6)


@pytest.fixture(scope="session")
def camera(swatch):
    return lisle.Camera.fit(swatch, size=SIZE)


@pytest.fixture(scope="session")
def draw(renderer, swatch, camera):
    """Renders the swatch, small and quick unless told otherwise."""

    def draw(what=swatch, **options):
        if isinstance(what, lisle.Yarns):
            options = {"camera": camera, "lights": [lisle.Sun(direction=(-1, 1, -2), strength=3.0)]} | options
        return renderer.render(what, **{"samples": 1, **options})

    return draw


@pytest.fixture(scope="session")
def data():
    """The folder with real yarns."""
    if not DATA.is_dir():
        pytest.skip("no data")
    return DATA


def line(count=5, step=0.1):
    """Points along X."""
    points = np.zeros((count, 3), np.float32)
    points[:, 0] = step * np.arange(count)
    return points
