"""The points are those that every engine of Tilescope gives, bit for bit."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from blake3 import blake3

import tilescope

ROOT = Path(__file__).parents[3]
R = 2**15

_BASE = {"radius": 0.01}
_BOUNDED = _BASE | {"boundary": "bounded", "width": 1.7, "seed": 2**64 - 1}
# The runs whose digests `tests/tests/it/support/pinned.rs` pins, by its names.
CASES = {
    "default": {"radius": 0.008_36},
    "index": _BASE | {"order": "index"},
    "random": _BASE | {"order": "random"},
    "phase groups": _BASE | {"order": "phase-group"},
    "dihedral": _BASE | {"dihedral": True, "leaf": 6, "pattern_side": 23.5, "pattern_seed": 5},
    "bounded": _BOUNDED,
    "uniform": _BOUNDED | {"insertion": "uniform"},
    "as printed": _BOUNDED | {"variant": "as-printed"},
    "reference": {"radius": 0.008_36, "method": "reference"},
    "exact": {"radius": 0.008_36, "method": "exact"},
}


def pinned() -> dict[str, str]:
    text = (ROOT / "tests/tests/it/support/pinned.rs").read_text()
    return dict(re.findall(r'"([a-z ]+)",\s*"(blake3:[0-9a-f]{64})"', text))


def lattice_digest(points: tilescope.PointSet) -> str:
    """The digest of a set's lattice points, as the pinned ones are made: x and y as 32-bit integers."""
    sides = np.array(points.domain[:2])
    steps = sides / np.round(sides / points.radius * R)
    exact = points.points / steps
    lattice = np.round(exact)
    assert np.abs(exact - lattice).max() < 1e-5
    return f"blake3:{blake3(lattice.astype('<i4').tobytes()).hexdigest()}"


def test_every_pinned_run_is_known_here():
    assert pinned().keys() == CASES.keys()


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("engine", ["auto", "sequential"])
def test_points_have_the_pinned_digests(name, engine):
    assert lattice_digest(tilescope.sample(**CASES[name], engine=engine)) == pinned()[name]


def test_another_seed_has_another_digest():
    points = tilescope.sample(**CASES["default"], seed=2)
    assert lattice_digest(points) != pinned()["default"]


def test_the_digest_is_that_of_the_positions(small):
    assert small.digest == f"blake3:{blake3(small.points.astype('<f8').tobytes()).hexdigest()}"
    assert tilescope.PointSet(small.points[::-1], 0.02).digest != small.digest


def options(arguments: dict[str, object]) -> list[str]:
    """The arguments as the command line takes them."""
    words = []
    for name, value in arguments.items():
        option = f"--{name.replace('_', '-')}"
        words += [option] if value is True else [option, str(value)]
    return words


PROGRAM = os.environ.get("TILESCOPE")


needs_program = pytest.mark.skipif(not PROGRAM, reason="the environment variable TILESCOPE does not name the program")


@needs_program
@pytest.mark.parametrize(
    "arguments",
    [
        *CASES.values(),
        {"count": 5000, "seed": 3},
        {"count": 3000, "method": "reference", "boundary": "bounded", "height": 0.7},
        {"radius": 0.02, "leaf": 80, "search": 2},
        {"count": 3000, "method": "exact", "pattern_side": 30, "pattern_seed": 5, "dihedral": True},
    ],
    ids=str,
)
@pytest.mark.filterwarnings("ignore:.*repeats within")
@pytest.mark.filterwarnings("ignore:the written set")
@pytest.mark.parametrize("extension", ["npy", "ply"])
def test_files_are_those_of_the_command_line(arguments, extension, tmp_path):
    theirs, ours = tmp_path / "theirs", tmp_path / "ours"
    theirs.mkdir()
    ours.mkdir()
    name = f"set.{extension}"
    command = [PROGRAM, "sample", *options(arguments), "--out", theirs / name]
    subprocess.run(command, check=False, capture_output=True)
    tilescope.sample(**arguments).save(ours / name)
    assert (ours / name).read_bytes() == (theirs / name).read_bytes()
    certificate = f"{name}.certificate.json"
    assert json.loads((ours / certificate).read_text()) == json.loads((theirs / certificate).read_text())


@needs_program
def test_combinations_are_those_of_the_command_line(tmp_path):
    layout = ROOT / "assets/layouts/nine.json"
    subprocess.run([PROGRAM, "combine", layout, "--out", tmp_path / "theirs.ply"], check=True, capture_output=True)
    tilescope.combine(layout).save(tmp_path / "ours.ply")
    assert (tmp_path / "ours.ply").read_bytes() == (tmp_path / "theirs.ply").read_bytes()
    stated = [tilescope.read(tmp_path / name).parameters for name in ("ours.ply", "theirs.ply")]
    assert stated[0] == stated[1]


@needs_program
@pytest.mark.parametrize("boundary", ["periodic", "bounded"])
def test_measures_are_those_of_the_command_line(boundary, tmp_path):
    points = tilescope.sample(radius=0.02, boundary=boundary)
    points.save(tmp_path / "set.npy")
    printed = subprocess.run([PROGRAM, "analyze", tmp_path / "set.npy", "--json"], check=True, capture_output=True)
    (found,) = json.loads(printed.stdout)["files"]
    assert tilescope.analyze(points) == {name: found[name] for name in tilescope.analyze(points)}


@pytest.mark.parametrize("method", ["kdrt", "exact"])
@pytest.mark.parametrize("boundary", ["periodic", "bounded"])
def test_a_window_has_the_samples_that_the_whole_set_has_there(boundary, method):
    arguments = {"radius": 0.004, "boundary": boundary, "seed": 5, "method": method}
    whole = tilescope.sample(**arguments).points
    plane = tilescope.Plane(**arguments)
    for x0, y0, x1, y1 in [(0.1, 0.2, 0.4, 0.35), (0, 0, 0.01, 0.01), (0.9, 0.95, 1, 1)]:
        x, y = whole.T
        inside = (x0 <= x) & (x < x1) & (y0 <= y) & (y < y1)
        if boundary == "bounded":
            inside = (x0 <= x) & ((x < x1) | (x1 == 1)) & (y0 <= y) & ((y < y1) | (y1 == 1))
        assert np.array_equal(plane.window(x0, y0, x1, y1), whole[inside])
        assert plane.is_valid(x0, y0, x1, y1)


def test_a_window_beyond_the_border_of_a_periodic_plane_repeats_it():
    plane = tilescope.Plane(radius=0.01)
    assert np.array_equal(plane.window(3.25, -2, 3.5, -1.75), plane.window(0.25, 0, 0.5, 0.25))


@needs_program
def test_an_exact_window_is_that_of_the_command_line(tmp_path):
    plane = tilescope.Plane(radius=0.002, seed=3, method="exact")
    arguments = ["--radius", "0.002", "--seed", "3", "--method", "exact", "--window", "0.2", "0.3", "0.5", "0.4"]
    subprocess.run([PROGRAM, "sample", *arguments, "--out", tmp_path / "window.npy"], check=True, capture_output=True)
    assert np.array_equal(np.load(tmp_path / "window.npy"), plane.window(0.2, 0.3, 0.5, 0.4))
    # Control: the other method has other samples there.
    other = tilescope.Plane(radius=0.002, seed=3).window(0.2, 0.3, 0.5, 0.4)
    assert not np.array_equal(other, plane.window(0.2, 0.3, 0.5, 0.4))


def test_a_window_of_a_set_with_gaps_is_not_valid():
    plane = tilescope.Plane(radius=0.002, search=2)
    assert not plane.is_valid(0, 0, 1, 1)


def test_the_number_of_threads_changes_nothing(small):
    code = (
        "import sys, tilescope; tilescope.set_threads(int(sys.argv[1]));"
        "print(tilescope.sample(radius=0.02, seed=7).digest)"
    )
    digests = [subprocess.check_output([sys.executable, "-c", code, threads], text=True).strip() for threads in "13"]
    assert digests == [small.digest] * 2


def test_a_pattern_may_be_a_set_or_a_file(small, tmp_path):
    small.save(tmp_path / "pattern.npy")
    by_set = tilescope.sample(radius=0.01, pattern=small)
    by_file = tilescope.sample(radius=0.01, pattern=tmp_path / "pattern.npy")
    assert by_set.digest == by_file.digest != tilescope.sample(radius=0.01).digest
    assert by_set.verify().valid
    assert by_file.parameters["pattern"]["file"] == "pattern.npy"
    assert by_set.parameters["pattern"] == {"positions_digest": small.digest}
