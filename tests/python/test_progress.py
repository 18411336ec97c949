"""Long calls: progress, cancelling, exceptions, the GIL, Ctrl-C."""

import signal
import subprocess
import sys
import threading
import time

import lisle
import pytest


def test_progress_rises_to_one(draw):
    fractions = []
    draw(samples=4, progress=fractions.append)
    assert fractions == sorted(fractions)
    assert len(set(fractions)) >= 4
    assert 0 <= fractions[0] < fractions[-1] == 1


def test_the_callback_is_called_from_the_calling_thread(draw):
    threads = set()
    draw(progress=lambda _: threads.add(threading.get_ident()) or None)
    assert threads == {threading.get_ident()}


def test_false_cancels(draw):
    seen = []

    def stop(fraction):
        seen.append(fraction)
        return len(seen) < 2

    with pytest.raises(lisle.Cancelled):
        draw(samples=8, progress=stop)
    assert len(seen) == 2
    assert draw()["alpha"].max() > 0.5


def test_none_goes_on(draw):
    assert draw(samples=2, progress=lambda _: None)["alpha"].max() > 0.5


def test_an_exception_in_the_callback_comes_through(draw):
    class Interruption(Exception):
        pass

    error = Interruption("enough")
    calls = []

    def fail(fraction):
        calls.append(fraction)
        raise error

    with pytest.raises(Interruption) as caught:
        draw(samples=8, progress=fail)
    assert caught.value is error
    assert len(calls) == 1


def test_rendering_from_a_callback_is_refused_instead_of_hanging(draw):
    with pytest.raises(lisle.InputError, match="progress callback"):
        draw(progress=lambda _: draw() and None)
    assert draw()["alpha"].max() > 0.5


def test_other_threads_run_meanwhile(draw):
    """A thread that only needs the GIL makes progress while samples are drawn.

    Two calls of the callback may follow each other at once.
    """
    ticks, between, running = [0], [], True

    def tick():
        while running:
            ticks[0] += 1
            time.sleep(1e-4)

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        draw(samples=6, size=(400, 300), progress=lambda _: between.append(ticks[0]))
    finally:
        running = False
        thread.join()
    assert between[-1] > between[0]


def test_two_threads_share_a_renderer(draw):
    expected = draw(samples=2)["combined"].tobytes()
    results = []
    threads = [threading.Thread(target=lambda: results.append(draw(samples=2)["combined"].tobytes())) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120)
    assert results == [expected] * 3


ENDLESS = """
import signal
import lisle
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where a shell has put the tests in the background
swatch = lisle.knit_swatch(courses=6, wales=6)
renderer = lisle.Renderer()
print("ready", flush=True)
try:
    renderer.render(swatch, samples=1_000_000, size=(96, 72), lights=[lisle.Sun(direction=(0, 1, -1))])
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT for a child process")
def test_ctrl_c_ends_a_render():
    child = subprocess.Popen([sys.executable, "-c", ENDLESS], stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout.readline() == "ready\n"
        time.sleep(0.5)
        child.send_signal(signal.SIGINT)
        assert child.communicate(timeout=60)[0] == "interrupted\n"
    finally:
        child.kill()
        child.wait()
    assert child.returncode == 0
