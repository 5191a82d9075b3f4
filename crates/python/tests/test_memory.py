"""What there is no memory for raises `MemoryError`, and the interpreter goes on."""

import subprocess
import sys
import textwrap

import pytest

resource = pytest.importorskip("resource", reason="the system has no limits of memory")

# Calls that take more memory than the process may have, by the number of samples that `points` or a file has.
CALLS = {
    "sample": (0, "tilescope.sample(10**8)"),
    "sequential": (0, "tilescope.sample(10**8, engine='sequential')"),
    "reference": (0, "tilescope.sample(10**8, method='reference')"),
    "exact": (0, "tilescope.sample(10**8, method='exact')"),
    "levels": (0, "tilescope.sample(radius=1e-4, levels=4)"),
    "window": (0, "tilescope.Plane(radius=2e-5).window(0, 0, 0.3, 0.3)"),
    "window of levels": (0, "tilescope.Plane(radius=2e-5, levels=2).window(0, 0, 0.3, 0.3)"),
    "is_valid": (0, "tilescope.Plane(radius=2e-5).is_valid(0, 0, 0.3, 0.3)"),
    "combine": (0, "tilescope.combine(LAYOUT)"),
    "verify": (10_000_000, "points.verify(judge='delaunay')"),
    "analyze": (10_000_000, "tilescope.analyze(points)"),
    "spectrum": (10_000_000, "points.spectrum()"),
    "pair_correlation": (10_000_000, "points.pair_correlation()"),
    "save": (10_000_000, "points.save(folder + '/new.npy')"),
    "certificate": (10_000_000, "points.certificate"),
    "draw": (10_000, "points.draw(folder + '/new.png', size=16_000)"),
    "draw as SVG": (10_000_000, "points.draw(folder + '/new.svg')"),
    "read": (10_000_000, "tilescope.read(folder + '/set.npy')"),
    "verify a file": (2_090_000, "tilescope.verify(folder + '/set.npy', 0.001, judge='delaunay')"),
    "a set of positions": (0, "tilescope.PointSet(np.broadcast_to(0.5, (10**8, 2)))"),
}


def outcome_of(call, samples, folder, spare):
    """What a call says in a process that may have so many bytes more than it has."""
    code = f"""
        import resource
        import numpy as np
        import tilescope

        LAYOUT = {{"version": 1, "radius": 1e-4, "columns": [1], "rows": [1], "pieces": [{{"seed": 1}}]}}
        folder = {str(folder)!r}
        tilescope.set_threads(2)
        points = tilescope.sample(radius=0.05)
        points.verify()
        if {samples}:
            side = round({samples} ** 0.5)
            lattice = (np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2) + 0.5) / side
            points = tilescope.PointSet(lattice, 1 / side)
            if {"set.npy" in call}:
                np.save(folder + "/set.npy", lattice)
            del lattice
        with open("/proc/self/statm") as file:
            used = int(file.read().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + {spare}, resource.RLIM_INFINITY))
        try:
            {call}
            print("done")
        except MemoryError as error:
            print("MemoryError:", error)
        # The interpreter, and the package, go on.
        assert tilescope.sample(radius=0.02).verify().valid
    """
    command = [sys.executable, "-c", textwrap.dedent(code)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


@pytest.mark.skipif(sys.platform != "linux", reason="the process's size is asked for as Linux tells it")
@pytest.mark.parametrize("name", CALLS)
def test_a_call_that_there_is_no_memory_for_raises(name, tmp_path):
    samples, call = CALLS[name]
    outcome = outcome_of(call, samples, tmp_path, 200_000_000)
    assert outcome.returncode == 0, outcome.stderr
    assert outcome.stdout.startswith("MemoryError: "), outcome.stdout
    assert {path.name for path in tmp_path.iterdir()} <= {"set.npy"}


@pytest.mark.skipif(sys.platform != "linux", reason="the process's size is asked for as Linux tells it")
def test_a_call_that_there_is_memory_for_does_not():
    outcome = outcome_of("tilescope.sample(10**6).verify()", 0, "", 200_000_000)
    assert (outcome.returncode, outcome.stdout) == (0, "done\n"), outcome.stderr
