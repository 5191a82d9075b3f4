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

# Calls that would take many seconds.
LONG = {
    "sample": "tilescope.sample(150_000_000)",
    "sequential": "tilescope.sample(20_000_000, engine='sequential')",
    "reference": "tilescope.sample(20_000_000, method='reference')",
    "exact": "tilescope.sample(60_000_000, method='exact')",
    "pattern": "tilescope.sample(radius=0.001, pattern_side=2000, pattern_seed=4)",
    "levels": "tilescope.sample(radius=2e-4, levels=6, order_within='farthest')",
    "window": "tilescope.Plane(radius=2e-5).window(0, 0, 0.3, 0.3)",
    "window of levels": "tilescope.Plane(radius=2e-5, levels=2).window(0, 0, 0.1, 0.1)",
    "verify": "points.verify(judge='delaunay')",
    "save": "points.save(folder + '/set.npy', judge='delaunay')",
    "analyze": "tilescope.analyze(points)",
    "combine": "tilescope.combine({'version': 1, 'radius': 2e-4, 'columns': [1], 'rows': [1],"
    " 'pieces': [{'seed': 1, 'method': 'reference'}]})",
}


@pytest.mark.parametrize("name", LONG)
def test_ctrl_c_stops_a_long_call_and_the_next_one_works(name, tmp_path):
    code = f"""
        import os, sys, time, threading, signal
        import tilescope
        # A shell has the programs that it starts in the background ignore Ctrl-C, and their children inherit that.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        folder = {str(tmp_path)!r}
        if {"points" in LONG[name]}:
            points = tilescope.sample(4_000_000)
        def press():
            time.sleep(0.7)
            global pressed
            pressed = time.perf_counter(), time.process_time()
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=press).start()
        try:
            {LONG[name]}
        except KeyboardInterrupt:
            ended = time.perf_counter(), time.process_time()
        else:
            sys.exit("it ended before Ctrl-C")
        assert tilescope.sample(2000).verify().valid
        print(*[end - begin for begin, end in zip(pressed, ended)], *os.listdir(folder))
    """
    outcome = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=120, check=False
    )
    assert outcome.returncode == 0, outcome.stderr
    waited, computed, *left = outcome.stdout.split()
    # A clock counts what other programs do, and the processor's time counts every thread.
    assert min(float(waited), float(computed)) < 1.5
    assert left == [], "nothing half-written stays"


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


def test_what_progress_raises_stops_the_call():
    class Enough(Exception):
        pass

    def stop(name, done, total):
        raise Enough

    began = time.perf_counter()
    with pytest.raises(Enough):
        tilescope.sample(150_000_000, progress=stop)
    assert time.perf_counter() - began < 5


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
