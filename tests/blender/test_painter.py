"""The thread that draws views: what is shown is always the view that was asked for, and it ends when it is told to."""

import gc
import threading
import time
import weakref

import numpy as np
import pytest
from lisle_blender.core.painter import Painter, Stopped, Task

SIZE = (640, 400)


class Scene:
    """Stands in for a scene: every pixel holds its place in the view, and the samples it was drawn with."""

    def __init__(self, seconds_a_call=0.0):
        self.calls = []
        self.seconds = seconds_a_call
        self.gate = threading.Event()
        self.gate.set()

    def draw(self, size, region, samples, first_sample, quality, go_on):
        self.calls.append((size, region, samples, first_sample))
        end = time.monotonic() + self.seconds
        while not self.gate.is_set() or time.monotonic() < end:
            if not go_on():
                raise Stopped
            time.sleep(0.001)
        x0, y0, x1, y1 = region
        x = (np.arange(x0, x1) + 0.5) / size[0]
        y = (np.arange(y0, y1)[::-1] + 0.5) / size[1]  # top row first
        combined = np.zeros((y1 - y0, x1 - x0, 4), np.float32)
        combined[..., 0], combined[..., 1] = x, y[:, None]
        combined[..., 2] = np.mean(np.arange(first_sample, first_sample + samples))
        return combined, np.full(combined.shape[:2], first_sample, np.float32)

    def task(self, key, samples=8, size=SIZE, region=None):
        return Task(key, size, region or (0, 0, *size), samples, self.draw)


@pytest.fixture
def painter():
    painter = Painter()
    yield painter
    painter.stop()


def finished(painter, name, seconds=20):
    end = time.monotonic() + seconds
    while painter.busy():
        assert time.monotonic() < end, "it never ends"
        time.sleep(0.002)
    return painter.picture(name)


def expected_places(region, size):
    x0, y0, x1, y1 = region
    x = (np.arange(x0, x1) + 0.5) / size[0]
    y = (np.arange(y0, y1) + 0.5) / size[1]
    return np.stack(np.broadcast_arrays(x, y[:, None]), axis=-1)


@pytest.mark.parametrize("region", [(0, 0, *SIZE), (100, 30, 555, 377), (3, 4, 5, 5)])
def test_a_finished_picture_is_whole_and_the_mean_of_its_samples(painter, region):
    scene = Scene()
    painter.show("a", scene.task("k", samples=21, region=region))
    picture = finished(painter, "a")
    assert picture.samples == 21 and picture.region == region
    np.testing.assert_allclose(picture.combined[..., :2], expected_places(region, SIZE), atol=1e-6)
    np.testing.assert_allclose(picture.combined[..., 2], 10, rtol=1e-5)
    np.testing.assert_array_equal(picture.depth, 0)  # of the first sample
    assert painter.news() == []


def test_the_draft_comes_first_and_covers_the_region(painter):
    class OneByOne(Scene):
        def draw(self, *call):
            drawn = super().draw(*call)
            if len(self.calls) == 1:
                self.gate.clear()
            return drawn

    scene = OneByOne()
    scene.gate.clear()
    painter.show("a", scene.task("k", region=(101, 33, 640, 400)))
    assert painter.picture("a") is None and painter.news() == []
    scene.gate.set()
    draft = painter.picture("a", 10)
    assert draft.samples == 0 and painter.news() == [], "the thread waits at the gate"
    size, region, samples, _ = scene.calls[0]
    assert size[0] < SIZE[0] / 2 and samples == 1
    share = np.array([*size, *size]) / [*SIZE, *SIZE]
    np.testing.assert_allclose(draft.region, np.array(region) / share)
    assert draft.region[0] <= 101 and draft.region[1] <= 33 and draft.region[2:] == (640, 400)
    scene.gate.set()
    while painter.busy():
        time.sleep(0.002)
    assert painter.news() == ["a"]
    assert painter.picture("a").samples == 8 and painter.news() == []


def test_drafts_go_where_they_are_not_needed_and_come_back(painter):
    def has_draft(scene, key):
        scene.calls.clear()
        painter.show("a", scene.task(key, samples=1))
        finished(painter, "a")
        return scene.calls[0][0] != SIZE

    quick, slow = Scene(), Scene(0.25)
    assert has_draft(quick, 0)
    assert not any([has_draft(quick, key) for key in range(1, 9)][-3:])
    assert [has_draft(slow, key) for key in (10, 11, 12)] == [False, True, True]


def test_a_view_is_never_shown_with_another_views_picture(painter):
    scene = Scene(0.002)
    random = np.random.default_rng(0)
    for key in range(60):
        painter.show("a", scene.task(key))
        picture = painter.picture("a", random.choice([0, 0.01, 0.1]))
        assert picture is None or picture.key == key
        time.sleep(random.uniform(0, 0.01))
    assert finished(painter, "a").key == 59


def test_a_new_view_does_not_wait_for_the_refinement_of_others(painter):
    scene = Scene(0.02)
    painter.show("a", scene.task("a", samples=10_000))
    assert painter.picture("a", 10) is not None
    time.sleep(0.2)
    for name in "bcd":
        start = time.monotonic()
        painter.show(name, scene.task(name, samples=10_000))
        assert painter.picture(name, 10) is not None
        assert time.monotonic() - start < 0.2
    painter.show("a", scene.task("a2", samples=10_000))
    assert painter.picture("a", 10).key == "a2"


def test_views_of_one_redraw_wait_together_no_longer_than_one(painter):
    scene = Scene()
    scene.gate.clear()
    for name in "abcd":
        painter.show(name, scene.task(name))

    def redraw(names):
        start = time.monotonic()
        for name in names:
            assert painter.picture(name, 0.2) is None
        return time.monotonic() - start

    for _ in range(2):
        assert 0.2 <= redraw("abcd") < 0.35
    assert redraw("aa") >= 0.4, "each redraw of one view has all its time"
    time.sleep(0.5)
    assert redraw("b") >= 0.2


def test_views_improve_side_by_side(painter):
    scene = Scene()
    for name in "ab":
        painter.show(name, scene.task(name, samples=300))
    assert finished(painter, "a").samples == finished(painter, "b").samples == 300


def test_the_same_key_draws_nothing_again(painter):
    scene = Scene()
    painter.show("a", scene.task("k"))
    picture = finished(painter, "a")
    calls = len(scene.calls)
    painter.show("a", scene.task("k"))
    assert not painter.busy() and painter.picture("a") is picture and len(scene.calls) == calls


def test_an_error_is_raised_where_the_picture_would_be_and_goes_with_the_next_view(painter):
    def fail(*_):
        raise ValueError("broken")

    painter.show("a", Task("k", SIZE, (0, 0, *SIZE), 8, fail))
    with pytest.raises(ValueError, match="broken"):
        painter.picture("a", 10)
    assert not painter.busy() and painter.news() == []
    painter.show("a", Scene().task("l"))
    assert finished(painter, "a").samples == 8


def test_it_pauses_and_stops_within_a_call(painter):
    scene = Scene(0.05)
    painter.show("a", scene.task("k", samples=10_000))
    painter.picture("a", 10)
    painter.pause()
    time.sleep(0.1)
    calls = len(scene.calls)
    time.sleep(0.2)
    assert len(scene.calls) == calls
    painter.show("b", scene.task("b"))
    start = time.monotonic()
    assert painter.picture("b", 10) is None and time.monotonic() - start < 1
    painter.close("b")
    painter.pause(False)
    time.sleep(0.3)
    assert len(scene.calls) > calls
    start = time.monotonic()
    painter.stop()
    assert time.monotonic() - start < 0.3
    assert not painter.busy() and painter.picture("a") is None
    painter.show("a", scene.task("l", samples=1))
    assert finished(painter, "a").key == "l"


def test_an_idle_painter_takes_no_processor_time(painter):
    painter.show("a", Scene().task("k"))
    finished(painter, "a")
    begin = time.process_time()
    time.sleep(0.5)
    assert time.process_time() - begin < 0.02


def test_a_closed_view_is_drawn_no_more(painter):
    scene = Scene(0.01)
    painter.show("a", scene.task("k", samples=10_000))
    painter.picture("a", 10)
    painter.close("a")
    time.sleep(0.1)
    calls = len(scene.calls)
    time.sleep(0.1)
    assert len(scene.calls) == calls and painter.picture("a") is None and not painter.busy()


@pytest.mark.parametrize("how", ["close", "stop"])
@pytest.mark.parametrize("fails", [False, True])
def test_what_a_closed_view_held_is_freed_at_once(painter, how, fails):
    """Not when the garbage collector comes round to it: it counts objects, not their bytes."""
    scene = Scene(0.01)

    def draw(*arguments):
        if fails and arguments[3] > 0:
            raise ValueError("broken")
        return scene.draw(*arguments)

    gc.collect()
    gc.disable()
    try:
        painter.show("a", Task("k", SIZE, (0, 0, *SIZE), 10_000, draw))
        held = weakref.ref(draw), weakref.ref(painter.picture("a", 10))
        del draw
        time.sleep(0.3)
        assert held[0]() is not None
        painter.close("a") if how == "close" else painter.stop()
        end = time.monotonic() + 20
        while any(reference() is not None for reference in held):
            assert time.monotonic() < end, "held by a cycle"
            time.sleep(0.01)
    finally:
        gc.enable()
