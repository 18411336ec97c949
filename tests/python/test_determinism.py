"""Same input, same adapter: the same bits, in any process, alone or within a sequence."""

import hashlib
import subprocess
import sys

import lisle
import numpy as np
from conftest import REPOSITORY

OTHER_PROCESS = """
import sys
sys.path.insert(0, sys.argv[1])
from test_determinism import digest, frame
print(digest(frame(3)))
"""


def digest(image):
    return hashlib.sha256(b"".join(np.ascontiguousarray(image[name]).tobytes() for name in image)).hexdigest()


def frame(number, yarns=None, renderer=None):
    """A frame of an animation: the swatch sways."""
    yarns = yarns or lisle.knit_swatch(courses=6, wales=6)
    points = yarns.rest_points.astype(np.float64)
    points[:, 1] += 0.004 * np.sin(200 * points[:, 0] + 0.7 * number)
    camera = lisle.Camera.fit(yarns, size=(96, 72))
    lights = [lisle.Sun(direction=(-1, 1, -2), strength=3.0)]
    renderer = renderer or lisle.Renderer()
    return renderer.render(yarns.with_points(points), camera=camera, lights=lights, samples=2)


def test_a_frame_is_the_same_alone_in_a_sequence_and_in_another_process(renderer, swatch):
    sequence = [digest(frame(number, swatch, renderer)) for number in range(1, 5)]
    assert len(set(sequence)) == 4
    assert digest(frame(3)) == sequence[2]
    child = subprocess.run(
        [sys.executable, "-c", OTHER_PROCESS, str(REPOSITORY / "tests" / "python")],
        capture_output=True,
        text=True,
        check=True,
    )
    assert child.stdout.strip() == sequence[2]
