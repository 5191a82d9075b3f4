"""Wrong arguments raise errors that name the value and the limit."""

import inspect
import math
import re
from pathlib import Path

import numpy as np
import pytest

import tilescope

SAMPLE = [
    ({}, "neither count nor radius"),
    ({"count": 100, "radius": 0.1}, "both count and radius"),
    ({"radius": -1}, "the radius is -1; it must be a finite number above 0"),
    ({"radius": math.nan}, "the radius is NaN"),
    ({"radius": 0.01, "width": -2}, "the width is -2; it must be a number between"),
    ({"radius": 0.5}, "2 r long; it must be at least"),
    ({"radius": 1e-9}, "it must be at most"),
    ({"radius": 2e-5}, "at most 2e8"),
    ({"count": 10**9}, "at most 2e8"),
    ({"count": 3}, "3 samples were asked for; with these sides it must be between"),
    ({"count": -3}, "count is -3; it must be a whole number from 0 to 18446744073709551615"),
    ({"count": 10**30}, "count is 10{30}; it must be a whole number"),
    ({"radius": 0.01, "seed": -1}, "seed is -1; it must be a whole number from 0 to"),
    ({"radius": 0.01, "seed": 2**64}, f"seed is {2**64}; it must be"),
    ({"radius": 0.01, "pattern_seed": -1}, "pattern_seed is -1"),
    ({"radius": 0.01, "leaf": 5}, "the leaf is 5 r; it must be a finite number of at least 6 r"),
    ({"radius": 0.01, "pattern_side": 9}, "the pattern's side is 9 r; it must be between 10 r and 2,000 r"),
    ({"radius": 0.01, "boundary": "torus"}, "boundary is 'torus'.*expected `periodic` or `bounded`"),
    ({"radius": 0.01, "order": "best"}, "order is 'best'.*`index`, `random`, `own-block-first`, `phase-group`"),
    ({"radius": 0.01, "insertion": "any"}, "insertion is 'any'.*expected `circumcentre` or `uniform`"),
    ({"radius": 0.01, "variant": "x"}, "variant is 'x'.*expected `staged` or `as-printed`"),
    ({"radius": 0.01, "method": "x"}, "method is 'x'.*expected `kdrt` or `reference`"),
    ({"radius": 0.01, "engine": "gpu"}, "engine is 'gpu'.*expected one of `auto`, `parallel`, `sequential`"),
    ({"radius": 0.01, "search": 3}, "search is 3; it must be 4 or 2"),
    ({"radius": 0.01, "variant": "as-printed", "insertion": "uniform"}, "uniform insertion needs the staged variant"),
    ({"radius": 0.01, "variant": "as-printed", "engine": "parallel"}, "needs the sequential engine"),
]  # fmt: skip


@pytest.mark.parametrize(("arguments", "text"), SAMPLE, ids=[str(arguments) for arguments, _ in SAMPLE])
def test_sample_refuses(arguments, text):
    with pytest.raises(ValueError, match=text):
        tilescope.sample(**arguments)


@pytest.mark.parametrize(
    "arguments",
    [
        {"count": 100.0},
        {"count": "100"},
        {"radius": "0.1"},
        {"radius": 0.01, "seed": 1.5},
        {"radius": 0.01, "boundary": 1},
        {"radius": 0.01, "dihedral": "yes"},
        {"radius": 0.01, "order": None},
        {"radius": 0.01, "progress": 1},
        {"radius": 0.01, "no_such_argument": 1},
        {"radius": 0.01, "pattern": 7},
    ],
    ids=str,
)
def test_sample_refuses_other_types(arguments):
    with pytest.raises(TypeError):
        tilescope.sample(**arguments)


def test_a_number_of_another_type_is_named():
    with pytest.raises(TypeError, match="count is 'many'; it must be a whole number"):
        tilescope.sample("many")
    # Python adds notes to exceptions from 3.11 on.
    with pytest.raises(TypeError, match="real number, not str(\nwhile processing 'radius')?"):
        tilescope.sample(radius="small")


def test_numbers_of_numpy_are_numbers():
    points = tilescope.sample(np.int64(2000), width=np.float32(1), seed=np.uint64(2**64 - 1))
    assert points.verify().valid


def test_the_defaults_are_those_of_the_command_line():
    source = (Path(__file__).parents[2] / "cli/src/parameters.rs").read_text()
    theirs = re.findall(r'default_value(?:_t)? = "?([a-z0-9.-]+)"?.*\)\]\s*pub (\w+):', source)
    assert len(theirs) >= 10
    windows = [(value, name) for value, name in theirs if name != "variant"]
    for function, of_function in ((tilescope.sample, theirs), (tilescope.Plane, windows)):
        ours = {name: one.default for name, one in inspect.signature(function).parameters.items()}
        for value, name in of_function:
            same = ours[name] == value if isinstance(ours[name], str) else ours[name] == float(value)
            assert same, (name, value, ours[name])


def test_a_pattern_that_is_not_maximal_is_refused(holed, crowded):
    with pytest.raises(ValueError, match="the set is not maximal: no sample covers"):
        tilescope.sample(radius=0.01, pattern=holed)
    with pytest.raises(ValueError, match="the set is not conflict-free"):
        tilescope.sample(radius=0.01, pattern=crowded)
    with pytest.raises(ValueError, match="the radius of the set is not known; give radius"):
        tilescope.sample(radius=0.01, pattern=tilescope.PointSet(holed.points))


def test_a_pattern_that_repeats_within_blocks_is_warned_of():
    with pytest.warns(UserWarning, match="pattern_side=162 would avoid that"):
        tilescope.sample(radius=0.005, leaf=80)


@pytest.mark.parametrize(
    ("window", "text"),
    [
        ((0.5, 0, 0.4, 1), "the window's width runs from 0.5 to 0.4"),
        ((0, 0, 1.5, 1), "at most 1 long"),
        ((0, 0, math.nan, 1), "it must be finite"),
        ((1e9, 0, 1e9 + 0.5, 1), "it must begin between -1000 and 1000"),
        ((2, 0, 2.5, 1), "holds no place of the domain's 0 to 1"),
    ],
)
def test_a_plane_refuses_windows(window, text):
    plane = tilescope.Plane(radius=0.01, boundary="bounded")
    with pytest.raises(ValueError, match=text):
        plane.window(*window)
    with pytest.raises(ValueError, match=text):
        plane.is_valid(*window)


def test_a_plane_refuses_windows_of_too_many_samples():
    with pytest.raises(ValueError, match="samples lie in the window; it may have 2e8"):
        tilescope.Plane(radius=2e-5).window(0, 0, 1, 1)


@pytest.mark.parametrize(
    ("points", "arguments", "text"),
    [
        ([], {}, r"points has the shape \(0,\); it must be \(N, 2\)"),
        ([[1, 2, 3]], {}, r"points has the shape \(1, 3\); it must be \(N, 2\)"),
        (np.empty((0, 2)), {}, "the set is empty"),
        ([[0.5, math.nan]], {}, "sample 0 at .* is not finite"),
        ([[0.5, 0.5], [0.5, 1.5]], {}, "sample 1 at .* lies outside the region"),
        ([[1.0, 0.5]], {}, "in a periodic region the upper side is the lower one"),
        ([[0.5, 0.5]], {"radius": 0}, "the radius is 0; it must be a finite number above 0"),
        ([[0.5, 0.5]], {"radius": None}, "the radius of the set is not known; give radius"),
        ([[0.5, 0.5]], {"width": 0}, "the region 0 x 1 is not supported: extents must lie between"),
        ([[0.5, 0.5]], {"boundary": "open"}, "boundary is 'open'"),
        ([[0.5, 0.5]], {"judge": "me"}, "judge is 'me'.*`delaunay`"),
    ],
)
def test_verify_refuses(points, arguments, text):
    with pytest.raises(ValueError, match=text):
        tilescope.verify(points, **({"radius": 0.1} | arguments))


def test_verify_refuses_other_types():
    for points in ["no such file", None, [["a", "b"]]]:
        with pytest.raises((TypeError, ValueError, FileNotFoundError)):
            tilescope.verify(points, 0.1)
    with pytest.raises(TypeError):
        tilescope.verify([[0.5, 0.5]], "large")


@pytest.mark.parametrize("threads", [0, 1025])
def test_a_number_of_threads_is_limited(threads):
    with pytest.raises(ValueError, match=f"threads is {threads}; it must be between 1 and 1024"):
        tilescope.set_threads(threads)
