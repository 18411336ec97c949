"""Memory of the process while pictures are drawn."""

import resource
import sys
from pathlib import Path

import lisle
import pytest

MIB = 2**20


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_samples_leave_nothing_behind():
    def resident_mib():
        return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / MIB

    yarns = lisle.knit_swatch(courses=4, wales=4)
    renderer = lisle.Renderer()
    camera = lisle.Camera.fit(yarns, size=(64, 48))
    for _ in range(3):
        renderer.render(yarns, camera=camera, samples=8, ambient=(1, 1, 1))
    before = resident_mib()
    for _ in range(25):
        renderer.render(yarns, camera=camera, samples=8, ambient=(1, 1, 1))
    assert resident_mib() - before < 20
