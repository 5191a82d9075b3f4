"""Long calls: Ctrl-C stops them, other threads run meanwhile, progress is passed on."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import tilescope

# Calls, with numbers to which their work is proportional: those of a long call. Where a stage is named, Ctrl-C is
# pressed when the call reports that stage, and else after half a second.
LONG = {
    "sample": ("tilescope.sample({})", 150_000_000),
    "sequential": ("tilescope.sample({}, engine='sequential')", 20_000_000),
    "reference": ("tilescope.sample({}, method='reference')", 20_000_000),
    "exact": ("tilescope.sample({}, method='exact')", 60_000_000),
    "pattern": ("tilescope.sample(radius=0.02, pattern_side={} ** 0.5, pattern_seed=4)", 4_000_000),
    "levels": ("tilescope.sample(radius={} ** -0.5, levels=6, order_within='farthest')", 25_000_000),
    "stipple": ("tilescope.stipple(numpy.full((1500, 1500), 99, dtype='uint8'), {})", 4_000_000),
    "window": ("tilescope.Plane(radius=2e-5).window(0, 0, 0.3, 1e-3 * {})", 300),
    "window of levels": ("tilescope.Plane(radius=2e-5, levels=2).window(0, 0, 0.1, 1e-3 * {})", 100),
    "verify": ("points({}).verify(judge='delaunay')", 4_000_000),
    "save": ("points({}).save(folder + '/set.npy', judge='delaunay')", 4_000_000),
    "analyze": ("tilescope.analyze(points({}))", 4_000_000),
    "combine": (
        "tilescope.combine(dict(version=1, radius={} ** -0.5, columns=[1], rows=[1],"
        " pieces=[dict(seed=1, method='reference')]))",
        25_000_000,
    ),
    "progress": ("tilescope.sample({}, progress=press)", 150_000_000),
    "elimination": ("tilescope.sample({}, engine='sequential', progress=press)", 10_000_000, "eliminate"),
    "exact windows": ("tilescope.sample({}, method='exact', progress=press)", 6_000_000, "regions"),
}

# Python's own hash function does not look for signals before it has ended.
NEVER_LOOKS = ("hashlib.pbkdf2_hmac('sha256', b'', b'', {})", 5_000_000)


def hundredths_after_ctrl_c(call, folder, delay):
    """How much a long call still computes after Ctrl-C, in hundredths of the call, and which files it leaves behind.

    What is compared is the work of one process, in seconds of processor of all its threads: a hundredth of the call by
    itself, and what follows Ctrl-C. A slow machine makes both longer, and what other programs do is not counted. Where
    calls look, at most six hundredths followed; a quarter of the call is the limit, and one that does not look has all
    the rest.
    """
    text, whole, *stage = call
    code = f"""
        import functools, hashlib, numpy, os, signal, sys, threading, time
        import tilescope

        # A shell has the programs that it starts in the background ignore Ctrl-C, and their children inherit that.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        folder = {str(folder)!r}
        points = functools.cache(tilescope.sample)
        {"points(4_000_000); points(40_000)" if "points" in text else ""}

        def press(*told):
            pass

        before = time.process_time()
        {text.format(whole // 100)}
        hundredth = time.process_time() - before
        for name in os.listdir(folder):
            os.remove(folder + "/" + name)

        def press(*told):
            if {stage} and told[0] not in {stage}:
                return
            global pressed
            pressed = time.process_time()
            os.kill(os.getpid(), signal.SIGINT)

        if {"press" not in text}:
            threading.Timer({delay}, press).start()
        try:
            {text.format(whole)}
        except KeyboardInterrupt:
            ended = time.process_time()
        else:
            sys.exit("it ended before Ctrl-C")
        assert tilescope.sample(2000).verify().valid
        print((ended - pressed) / hundredth, *os.listdir(folder))
    """
    outcome = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=600, check=False
    )
    assert outcome.returncode == 0, outcome.stderr
    after, *left = outcome.stdout.split()
    return float(after), left


@pytest.mark.parametrize("name", LONG)
def test_ctrl_c_stops_a_long_call_and_the_next_one_works(name, tmp_path):
    after, left = hundredths_after_ctrl_c(LONG[name], tmp_path, 0.5)
    assert after < 25
    assert left == [], "nothing half-written stays"


def test_a_call_that_does_not_look_for_ctrl_c_is_found(tmp_path):
    after, _ = hundredths_after_ctrl_c(NEVER_LOOKS, tmp_path, 0.05)
    assert after > 25


def test_other_threads_run_meanwhile():
    counted = 0
    ended = False

    def count():
        nonlocal counted
        while not ended:
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    tilescope.sample(1_000_000, engine="sequential")
    during, ended = counted, True
    thread.join()
    assert during >= 5


def test_calls_from_several_threads_at_once(small):
    found = []
    threads = [threading.Thread(target=lambda: found.append(tilescope.sample(radius=0.02, seed=7))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert {one.digest for one in found} == {small.digest}
    assert len(found) == 8


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
@pytest.mark.filterwarnings("ignore:This process")
def test_the_child_of_a_fork_computes_too(small):
    child = os.fork()
    if child == 0:
        same = tilescope.sample(radius=0.02, seed=7).digest == small.digest
        os._exit(0 if same else 1)
    deadline = time.monotonic() + 60
    while (ended := os.waitpid(child, os.WNOHANG)) == (0, 0) and time.monotonic() < deadline:
        time.sleep(0.01)
    if ended == (0, 0):
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    assert ended == (child, 0)


def test_progress_is_passed_to_a_function():
    told = []
    tilescope.sample(2_000_000, progress=lambda *progress: told.append(progress))
    assert told
    for name, done, total in told:
        assert isinstance(name, str)
        assert 0 <= done <= total
    assert told[-1][1] == told[-1][2]
    told.clear()
    tilescope.sample(200_000).verify(progress=lambda *progress: told.append(progress))
    assert told[-1][0] == "verify"


def test_what_progress_raises_is_raised_by_the_call():
    class Enough(Exception):
        pass

    def stop(name, done, total):
        raise Enough

    with pytest.raises(Enough):
        tilescope.sample(150_000_000, progress=stop)


def test_progress_shows_a_bar(capsys):
    tilescope.sample(2_000_000, progress=True)
    assert "%|" in capsys.readouterr().err
    tilescope.sample(2000)
    assert capsys.readouterr().err == ""


def test_large_sets_do_not_say_where_samples_came_from_and_are_the_same():
    large = tilescope.sample(1_500_000)
    assert large.provenance is None
    plane = tilescope.Plane(radius=large.radius)
    x, y = large.points.T
    inside = (x < 0.01) & (y < 0.01)
    assert np.array_equal(plane.window(0, 0, 0.01, 0.01), large.points[inside])
