"""Nested levels: each prefix is what the levels say, in memory, in files and in windows."""

import copy
import json
import math
import subprocess
from dataclasses import asdict

import numpy as np
import pytest
from test_points import PROGRAM, needs_program, options

import tilescope


@pytest.fixture(scope="module")
def nested() -> tilescope.PointSet:
    return tilescope.sample(radius=0.02, levels=5)


def test_each_level_is_a_maximal_set_that_holds_the_one_before(nested):
    assert [level.distance for level in nested.levels] == [0.02 * math.sqrt(2**k) for k in (4, 3, 2, 1, 0)]
    for level in nested.levels:
        assert level.covering == level.distance
        assert tilescope.verify(nested.points[: level.count], level.distance).valid
    assert nested.levels[-1].count == len(nested)
    assert np.bincount(nested.level).tolist() == np.diff([0, *(level.count for level in nested.levels)]).tolist()
    assert (np.diff(nested.level.astype(int)) >= 0).all()


def test_verify_judges_every_level(nested):
    report = nested.verify()
    assert report.valid
    assert [level.count for level in report.levels] == [level.count for level in nested.levels]
    for level in report.levels:
        assert level.valid
        assert level.min_distance >= level.distance
        assert level.covering_radius <= level.covering * (1 + report.covering_tolerance)
    # Another order: the same set, but not the same levels.
    swapped = copy.copy(nested)
    swapped._points = np.ascontiguousarray(nested.points[::-1])
    report = swapped.verify()
    assert (report.conflict_free, report.maximal, report.valid) == (True, True, False)
    assert [level.valid for level in report.levels] == [False] * 4 + [True]


def test_a_prefix_is_what_is_promised(nested):
    first, second = nested.levels[:2]
    for count in (1, first.count - 1, first.count, first.count + 1, len(nested)):
        prefix = nested.prefix(count)
        assert np.array_equal(prefix.points, nested.points[:count])
        assert prefix.verify().valid
        assert tilescope.verify(nested, prefix=count).valid
        assert prefix.levels[-1].count == count
        assert prefix.radius == prefix.levels[-1].distance
    assert nested.prefix(first.count).levels == (first,)
    assert nested.prefix(first.count).verify().maximal
    between = nested.prefix(first.count + 1)
    assert between.levels == (first, tilescope.Level(first.count + 1, second.distance, first.covering))
    assert between.parameters == {"prefix": first.count + 1, "of": nested.parameters}
    assert between.prefix(first.count).levels == (first,)


@pytest.mark.parametrize("order", ["random", "farthest"])
def test_ranks_are_those_of_levels(order):
    nested = tilescope.sample(radius=0.02, levels=4, order_within=order)
    assert (nested.rank.shape, nested.rank.flags.writeable) == ((len(nested),), False)
    assert (np.diff(nested.rank) >= 0).all()
    assert nested.rank.min() >= 0
    assert nested.rank.max() < 1
    for number, level in enumerate(nested.levels):
        assert (nested.rank < 2.0 ** (number - 3)).sum() == level.count
    # Without the last two levels the next one has the ranks up to 1.
    first = nested.prefix(nested.levels[1].count)
    assert np.array_equal(first.rank, nested.rank[: len(first)] * 4)
    assert np.array_equal(nested.prefix(len(nested)).rank, nested.rank)


def test_painted_by_ranks_samples_keep_the_distance_of_the_level_in_use(nested):
    # Up to a quarter of the density, two levels are not in use.
    kept = nested.points[nested.rank < nested.points[:, 0] / 4]
    report = tilescope.verify(kept, 0.04)
    assert (report.conflicts, report.maximal) == (0, False)
    # With all levels in use there are closer ones.
    assert tilescope.verify(nested.points[nested.rank < nested.points[:, 0]], 0.04).conflicts > 0


def test_exactly_so_many_samples():
    for order in ("random", "farthest"):
        exact = tilescope.sample(levels=4, exactly=3000, order_within=order)
        assert len(exact) == 3000
        report = exact.verify()
        assert (report.valid, report.conflict_free, report.maximal) == (True, True, False)
        assert report.covering_radius < 1.42 * exact.radius
        assert (exact.parameters["exactly"], exact.parameters["order_within"]) == (3000, order)


def test_by_distance_every_prefix_covers_better():
    drawn, ordered = (tilescope.sample(radius=0.02, levels=3, order_within=order) for order in ("random", "farthest"))
    assert sorted(map(tuple, drawn.points)) == sorted(map(tuple, ordered.points))
    count = drawn.levels[0].count // 3
    assert ordered.prefix(count).verify().covering_radius < 0.8 * drawn.prefix(count).verify().covering_radius


def test_sets_without_levels_have_none(small):
    assert (small.levels, small.level, small.rank, small.verify().levels) == ((), None, None, ())
    with pytest.raises(ValueError, match="the set has no levels"):
        small.prefix(10)
    with pytest.raises(ValueError, match="the set has no levels"):
        tilescope.verify(small.points, prefix=10)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"radius": 0.02, "levels": 0}, "0 levels"),
        ({"radius": 0.02, "levels": 12}, "12 levels"),
        ({"radius": 0.02, "levels": 11}, "11 levels"),
        ({"radius": 0.02, "levels": -1}, "levels is -1; it must be a whole number"),
        ({"count": 1000, "levels": 3}, "count is given with levels; give exactly, or radius"),
        ({"radius": 0.02, "exactly": 100}, "exactly is given without levels"),
        ({"radius": 0.02, "levels": 3, "exactly": 100}, "both exactly and radius are given"),
        ({"levels": 3}, "neither count nor radius is given"),
        ({"levels": 3, "exactly": -1}, "exactly is -1; it must be a whole number"),
        ({"levels": 1, "exactly": 500}, "exactly 500 samples need at least 2 levels"),
        ({"levels": 3, "exactly": 10**10}, "10,000,000,000 samples were asked for"),
        ({"radius": 0.02, "order_within": "farthest"}, "order_within is given without levels"),
        ({"radius": 0.02, "levels": 3, "order_within": "best"}, "order_within is 'best'.*`random` or `farthest`"),
        ({"radius": 0.02, "levels": 3, "method": "reference"}, "method is 'reference', which makes one set"),
        ({"radius": 0.02, "levels": 3, "search": 2}, "the search"),
    ],
    ids=str,
)
def test_levels_that_cannot_be_are_refused(arguments, text):
    with pytest.raises(ValueError, match=text):
        tilescope.sample(**arguments)


def test_a_pattern_is_refused(small):
    with pytest.raises(ValueError, match="pattern is given with levels"):
        tilescope.sample(radius=0.01, levels=2, pattern=small)


def test_prefixes_that_cannot_be_are_refused(nested):
    for count in (0, len(nested) + 1):
        with pytest.raises(ValueError, match=f"count is {count}; it must be between 1 and {len(nested)}"):
            nested.prefix(count)
    with pytest.raises(ValueError, match="both prefix and radius are given"):
        tilescope.verify(nested, 0.02, prefix=10)


@pytest.mark.parametrize("extension", ["npy", "csv", "json", "ply"])
def test_files_keep_levels(nested, extension, tmp_path):
    path = tmp_path / f"set.{extension}"
    report = nested.save(path)
    assert report.valid
    assert len(report.levels) == 5
    back = tilescope.read(path)
    assert (back.digest, back.levels, back.parameters) == (nested.digest, nested.levels, nested.parameters)
    assert tilescope.verify(path).passed
    assert tilescope.verify(path).levels == report.levels
    assert tilescope.verify(path, prefix=200).valid
    if extension == "csv":
        levels, ranks = np.loadtxt(path, delimiter=",", skiprows=1)[:, 2:].T
        assert np.array_equal(levels, nested.level)
        assert np.array_equal(ranks, nested.rank)
    if extension in ("csv", "ply"):
        assert np.array_equal(back.rank, nested.rank)
        assert not back.rank.flags.writeable
        assert back.save(tmp_path / f"again.{extension}").valid
        assert (tmp_path / f"again.{extension}").read_bytes() == path.read_bytes()
    else:
        assert back.rank is None
    with pytest.raises(ValueError, match="nested levels cannot be shuffled"):
        nested.save(path, shuffle=1)


def test_a_set_that_was_cut_is_saved_without_a_warning(tmp_path):
    exact = tilescope.sample(levels=3, exactly=1000)
    assert exact.save(tmp_path / "set.csv").valid
    assert tilescope.verify(tmp_path / "set.csv").passed
    certificate = exact.certificate
    assert not certificate["valid"], "it is not maximal for its radius"
    assert all(level["valid"] for level in certificate["levels"])


def test_a_file_with_another_order_is_found(nested, tmp_path):
    path = tmp_path / "set.npy"
    nested.save(path)
    np.save(path, nested.points[::-1])
    report = tilescope.verify(path)
    assert not report.valid
    assert any(difference.startswith("positions_digest") for difference in report.differences)
    np.save(path, nested.points[:-1])
    assert not tilescope.verify(path).valid


@needs_program
@pytest.mark.parametrize(
    "arguments",
    [
        {"radius": 0.01, "levels": 5},
        {"radius": 0.01, "levels": 3, "seed": 4, "boundary": "bounded", "width": 1.3, "order_within": "farthest"},
        {"exactly": 2000, "levels": 4},
        {"exactly": 700, "levels": 2, "order_within": "farthest", "dihedral": True},
    ],
    ids=str,
)
@pytest.mark.parametrize("extension", ["npy", "csv"])
def test_files_of_levels_are_those_of_the_command_line(arguments, extension, tmp_path):
    names = [f"{who}.{extension}" for who in ("theirs", "ours")]
    command = [PROGRAM, "sample", *options(arguments), "--out", tmp_path / names[0], "--json"]
    printed = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    points = tilescope.sample(**arguments)
    report = points.save(tmp_path / names[1])
    assert (tmp_path / names[0]).read_bytes() == (tmp_path / names[1]).read_bytes()
    certificates = [json.loads((tmp_path / f"{name}.certificate.json").read_text()) for name in names]
    for certificate in certificates:
        del certificate["file"]
    assert certificates[0] == certificates[1]
    assert [asdict(level) for level in report.levels] == printed["levels"]
    count = len(points) // 3
    command = [PROGRAM, "verify", tmp_path / names[1], "--prefix", str(count), "--json"]
    printed = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    assert tilescope.verify(tmp_path / names[0], prefix=count).levels[-1] == tilescope.LevelReport(**printed)


@pytest.mark.parametrize("boundary", ["periodic", "bounded"])
def test_windows_have_the_levels_of_the_whole(boundary):
    arguments = {"radius": 0.004, "boundary": boundary, "seed": 5, "levels": 3}
    whole = tilescope.sample(**arguments)
    plane = tilescope.Plane(**arguments)
    assert plane.parameters == whole.parameters
    low, high = np.array([0.1, 0.2]), np.array([0.3, 0.35])
    inside = ((low <= whole.points) & (whole.points < high)).all(axis=1)
    assert np.array_equal(plane.window(*low, *high), whole.points[inside])
    for number, added in enumerate(plane.window_levels(*low, *high)):
        assert np.array_equal(added, whole.points[inside & (whole.level == number)])
    points, ranks = plane.window_ranks(*low, *high)
    assert np.array_equal(points, whole.points[inside])
    assert np.array_equal(ranks, whole.rank[inside])
    assert plane.is_valid(*low, *high)


def test_a_plane_without_levels_has_one():
    plane = tilescope.Plane(radius=0.01)
    (only,) = plane.window_levels(0.1, 0.1, 0.2, 0.2)
    assert np.array_equal(only, plane.window(0.1, 0.1, 0.2, 0.2))
    with pytest.raises(ValueError, match="the plane has no levels"):
        plane.window_ranks(0.1, 0.1, 0.2, 0.2)
