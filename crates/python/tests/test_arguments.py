"""Wrong arguments raise errors that name the value and the limit."""

import json
import math
import warnings
from pathlib import Path

import numpy as np
import pytest

import tilescope
from tilescope import _tilescope

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
    ({"radius": 0.01, "method": "x"}, "method is 'x'.*expected one of `kdrt`, `exact`, `reference`"),
    ({"radius": 0.01, "engine": "gpu"}, "engine is 'gpu'.*expected one of `auto`, `parallel`, `sequential`"),
    ({"radius": 0.01, "method": "exact", "order": "index"}, "order is given with method 'exact'"),
    ({"radius": 0.01, "method": "exact", "insertion": "uniform"}, "insertion is given with method 'exact'"),
    ({"radius": 0.01, "method": "exact", "search": 2}, "search is given with method 'exact'"),
    ({"radius": 0.01, "method": "exact", "variant": "as-printed"}, "variant is given with method 'exact'"),
    ({"radius": 0.01, "method": "exact", "levels": 2}, "method is 'exact', which makes one set"),
    ({"radius": 0.01, "search": 3}, "search is 3; it must be 4 or 2"),
    ({"radius": 0.01, "search": -1}, "search is -1; it must be 4 or 2"),
    ({"radius": 0.01, "search": 10**30}, "search is 10{30}; it must be 4 or 2"),
    ({"radius": 10**400}, r"radius is 10{39}\.\.\. \(401 characters\); it must be a number up to"),
    ({"radius": 0.01, "width": 10**400}, "width is 10"),
    ({"radius": 0.01, "height": -(10**400)}, "height is -10"),
    ({"radius": 0.01, "leaf": 10**400}, "leaf is 10"),
    ({"radius": 0.01, "pattern_side": 10**400}, "pattern_side is 10"),
    ({"radius": 0.01, "seed": 10**400}, "seed is 10"),
    ({"radius": 0.01, "order": "o" * 100_000}, r"order is 'o{40}\.\.\. \(100000 characters\)'"),
    ({"radius": 0.01, "pattern": "a\0b"}, "holds a NUL character"),
    ({"radius": 0.01, "pattern": "s3://bucket/set.npy"}, "'s3://bucket/set.npy' is a URL"),
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
        {"radius": 0.01, "search": 4.0},
        {"radius": 0.01, "search": "4"},
        {"radius": 1j},
        {"radius": 0.01, "boundary": math.nan},
    ],
    ids=str,
)
def test_sample_refuses_other_types(arguments):
    with pytest.raises(TypeError):
        tilescope.sample(**arguments)


def test_a_number_of_another_type_is_named():
    with pytest.raises(TypeError, match="count is 'many'; it must be a whole number"):
        tilescope.sample("many")
    with pytest.raises(TypeError, match="radius is 'small'; it must be a real number"):
        tilescope.sample(radius="small")


def test_numbers_of_numpy_are_numbers():
    points = tilescope.sample(np.int64(2000), width=np.float32(1), seed=np.uint64(2**64 - 1))
    assert points.verify().valid


def test_the_defaults_are_those_of_the_command_line():
    # What is left out has the defaults of the core, which the command line has as well.
    left_out = _tilescope.RunRequest(
        count=None, radius=0.05, pattern=None, pattern_source=None, levels=None, exactly=None, order_within="random"
    )
    theirs = tilescope.PointSet._made(_tilescope.sample(left_out, "kdrt", "auto", None))
    assert tilescope.sample(radius=0.05).parameters == theirs.parameters
    assert json.loads(_tilescope.Plane(left_out, "kdrt", None).facts())["parameters"] == theirs.parameters
    assert tilescope.Plane(radius=0.05).parameters == theirs.parameters


def test_the_native_module_refuses_a_parameter_that_there_is_not():
    with pytest.raises(TypeError, match="there is no parameter pattern_size"):
        _tilescope.RunRequest(
            count=None, radius=0.05, pattern=None, pattern_source=None, levels=None, exactly=None,
            order_within="random", pattern_size=50,
        )  # fmt: skip


def test_a_pattern_that_is_not_maximal_is_refused(holed, crowded):
    with pytest.raises(ValueError, match="the set is not maximal: no sample covers"):
        tilescope.sample(radius=0.01, pattern=holed)
    with pytest.raises(ValueError, match="the set is not conflict-free"):
        tilescope.sample(radius=0.01, pattern=crowded)
    with pytest.raises(ValueError, match="the radius of the set is not known; give radius"):
        tilescope.sample(radius=0.01, pattern=tilescope.PointSet(holed.points))


def test_exact_tiling_takes_a_pattern_whose_darts_can_be_thrown_again(small, tmp_path):
    reference = {"radius": 0.05, "method": "reference", "seed": 7}
    pattern = tilescope.sample(**reference)
    arguments = {"radius": 0.02, "leaf": 8, "method": "exact"}
    made = tilescope.sample(**arguments, pattern=pattern)
    assert made.verify().valid
    assert made.parameters["pattern"]["seed"] == 7
    assert made.parameters["pattern_samples"] == len(pattern)
    assert np.array_equal(tilescope.Plane(**arguments, pattern=pattern).window(0, 0, 1, 1), made.points)
    # The pattern that is made for this side and seed has other darts.
    other = tilescope.sample(**arguments, pattern_side=20, pattern_seed=7)
    assert not np.array_equal(other.points, made.points)

    pattern.save(tmp_path / "pattern.npy")
    assert np.array_equal(tilescope.sample(**arguments, pattern=tmp_path / "pattern.npy").points, made.points)

    # Controls: sets of which the darts are not known.
    with pytest.raises(ValueError, match='pattern: .* a set by "kdrt"'):
        tilescope.sample(**arguments, pattern=small)
    with pytest.raises(ValueError, match="pattern: the pattern's domain is bounded"):
        tilescope.sample(**arguments, pattern=tilescope.sample(**reference, boundary="bounded"))
    with pytest.raises(ValueError, match="pattern: the pattern's domain is 1.1 x 1"):
        tilescope.sample(**arguments, pattern=tilescope.sample(**reference, width=1.1))
    with pytest.raises(ValueError, match="pattern is given with method 'exact', whose curve"):
        tilescope.curve(**arguments, pattern=pattern)


def test_exact_planes_need_a_radius_and_one_level():
    with pytest.raises(ValueError, match="count is given with method 'exact'"):
        tilescope.Plane(2000, method="exact")
    with pytest.raises(ValueError, match="method is 'exact', which makes one set"):
        tilescope.Plane(radius=0.02, method="exact", levels=2)
    with pytest.raises(ValueError, match="method is 'reference', which makes whole sets"):
        tilescope.Plane(radius=0.02, method="reference")
    with pytest.raises(ValueError, match="order is given with method 'exact'"):
        tilescope.Plane(radius=0.02, method="exact", order="index")


def test_a_pattern_that_repeats_within_blocks_is_warned_of():
    with pytest.warns(UserWarning, match="pattern_side=162 would avoid that"):
        tilescope.sample(radius=0.005, leaf=80)
    with pytest.warns(UserWarning, match="the pattern of 50 r repeats .* pattern_side=62 would avoid that"):
        tilescope.sample(radius=0.01, method="exact", pattern_side=50)
    # Negative controls: the pattern of exact tiling has 200 r, and darts need none.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tilescope.sample(radius=0.005, leaf=80, method="exact")
        tilescope.sample(radius=0.005, leaf=80, method="reference")


@pytest.mark.parametrize(
    ("window", "text"),
    [
        ((0.5, 0, 0.4, 1), "the window's width runs from 0.5 to 0.4"),
        ((0, 0, 1.5, 1), "at most 1 long"),
        ((0, 0, math.nan, 1), "it must be finite"),
        ((1e9, 0, 1e9 + 0.5, 1), "it must begin between -1,000 and 1,000"),
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


def test_numbers_that_do_not_fit_are_wrong_values(small, tmp_path):
    huge = 10**400
    for call in (
        lambda: tilescope.set_threads(-1),
        lambda: tilescope.set_threads(huge),
        lambda: tilescope.verify([[0.5, 0.5]], huge),
        lambda: tilescope.verify([[0.5, 0.5]], 0.1, width=huge),
        lambda: tilescope.PointSet([[0.5, 0.5]], 0.1, height=huge),
        lambda: tilescope.read(tmp_path / "set.npy", huge),
        lambda: tilescope.Plane(radius=0.01).window(0, 0, huge, 1),
        lambda: small.draw(tmp_path / "a.png", size=-1),
        lambda: small.draw(tmp_path / "a.png", size=huge),
        lambda: small.draw(tmp_path / "a.png", window=(0, 0, huge, 1)),
        lambda: small.spectrum(huge),
        lambda: small.save(tmp_path / "a.npy", shuffle=huge),
        lambda: tilescope.sample(radius=0.05, levels=2).prefix(huge),
    ):
        with pytest.raises(ValueError) as error:
            call()
        assert len(str(error.value)) < 300


def test_long_values_are_not_shown_whole(small, tmp_path):
    long = "x" * 100_000
    for call in (
        lambda: tilescope.sample(radius=0.01, boundary=long),
        lambda: tilescope.sample(long),
        lambda: tilescope.sample(radius=long),
        lambda: tilescope.sample(radius=0.01, progress=long),
        lambda: small.save(tmp_path / "set.npy", format=long),
        lambda: small.save(tmp_path / "set.npy", precision=long),
        lambda: small.save(tmp_path / f"set.{long}"),
        lambda: small.draw(tmp_path / long),
        lambda: small.draw(tmp_path / "a.png", theme=long),
        lambda: small.verify(judge=long),
        lambda: tilescope.read(tmp_path / "set.npy", format=long),
        lambda: tilescope.combine({"version": 1, long: 1}),
        lambda: tilescope.combine({"version": long}),
    ):
        with pytest.raises((TypeError, ValueError)) as error:
            call()
        assert len(str(error.value)) < 1500


@pytest.mark.parametrize("name", [math.nan, 7, b"npy"])
def test_a_format_is_a_name(name, small, tmp_path):
    small.save(tmp_path / "set.npy")
    for call in (
        lambda: tilescope.read(tmp_path / "set.npy", format=name),
        lambda: tilescope.verify(tmp_path / "set.npy", format=name),
        lambda: small.save(tmp_path / "again.npy", format=name),
    ):
        with pytest.raises(TypeError):
            call()
    with pytest.raises(ValueError, match="format is .*, but points is an array or a set, which is no file"):
        tilescope.verify(small, format=name)


def test_one_of_the_sets_of_a_file_is_chosen(small, tmp_path):
    other = tilescope.sample(radius=0.02, seed=8)
    parts = []
    for one in (small, other):
        one.save(tmp_path / "one.dat", verify=False)
        parts.append((tmp_path / "one.dat").read_text().rstrip("\n"))
    (tmp_path / "both.dat").write_text("\n#\n".join(parts) + "\n")
    both = tmp_path / "both.dat"
    for index, one in enumerate((small, other)):
        assert tilescope.read(both, 0.02, set=index).digest == one.digest
        assert tilescope.verify(both, 0.02, set=np.int64(index)).count == len(one)
        assert tilescope.analyze(both, 0.02, set=index)["samples"] == len(one)
    for call in (tilescope.read, tilescope.verify, tilescope.analyze):
        with pytest.raises(ValueError, match="the file holds 2 sets, 0 to 1, and"):
            call(both, 0.02)
        with pytest.raises(ValueError, match="the file holds 2 sets, 0 to 1, and"):
            call(both, 0.02, set=2)
        with pytest.raises(ValueError, match="set is -1; it must be a whole number from 0"):
            call(both, 0.02, set=-1)
        with pytest.raises(TypeError, match="set is 1.5; it must be a whole number"):
            call(both, 0.02, set=1.5)
    for call in (tilescope.verify, tilescope.analyze):
        with pytest.raises(ValueError, match="set is 0, but points is an array or a set, which is no file"):
            call(small, set=0)


PATHS = ["s3://bucket/set.npy", "https://example.org/set.npy", Path("gs://bucket/set.npy"), "file:///tmp/set.npy"]


@pytest.mark.parametrize("path", PATHS, ids=str)
def test_addresses_are_no_files(path, small, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for call in (
        lambda: tilescope.read(path),
        lambda: tilescope.verify(path, 0.02),
        lambda: tilescope.verify(path, prefix=3),
        lambda: tilescope.analyze(path),
        lambda: tilescope.combine(path),
        lambda: tilescope.combine({"pieces": []}, folder=path),
        lambda: small.save(path),
        lambda: small.draw(f"{path}.png"),
    ):
        with pytest.raises(ValueError, match="is a URL; tilescope reads and writes files that have a path"):
            call()
    assert list(tmp_path.iterdir()) == []
    # A folder may be called so.
    Path("s3:").mkdir()
    small.save("./s3:/set.npy")
    assert tilescope.read(Path.cwd() / "s3:/set.npy").digest == small.digest


def test_a_path_with_a_nul_is_refused(small):
    for call in (
        lambda: tilescope.read("a\0b.npy"),
        lambda: tilescope.verify("a\0b.npy", 0.1),
        lambda: small.save("a\0b.npy"),
        lambda: small.draw("a\0b.png"),
        lambda: tilescope.combine("a\0b.json"),
    ):
        with pytest.raises(ValueError, match="holds a NUL character"):
            call()
    with pytest.raises(ValueError, match="nul|NUL"):
        tilescope.combine(
            {"version": 1, "radius": 0.05, "columns": [1], "rows": [1], "pieces": [{"file": "a\0b.npy", "radius": 0.05}]}
        )
    with pytest.raises(TypeError, match="it must be text"):
        tilescope.read(b"set.npy")


def masked_rows(points):
    """A masked array of which one sample, and of another one a coordinate, is masked."""
    mask = np.zeros(points.shape, dtype=bool)
    mask[0] = mask[3, 1] = True
    return np.ma.masked_array(points, mask=mask)


def test_masked_values_are_no_positions(small):
    masked = masked_rows(small.points)
    for given in (masked, list(masked), tuple(masked), [*small.points[:3], masked[3]]):
        for call in (
            lambda given=given: tilescope.verify(given, 0.02),
            lambda given=given: tilescope.analyze(given),
            lambda given=given: tilescope.PointSet(given),
        ):
            with pytest.raises(ValueError, match=r"points has [13] masked values.*leave out their rows"):
                call()
    # What the error advises does.
    left = masked[~np.ma.getmaskarray(masked).any(axis=1)]
    assert len(tilescope.PointSet(left)) == len(small) - 2
    # Nothing of these is masked.
    assert tilescope.verify(np.ma.masked_array(small.points), 0.02).valid
    assert tilescope.verify(np.ma.masked_array(small.points, mask=np.zeros(small.points.shape)), 0.02).valid


@pytest.mark.parametrize(
    ("points", "text"),
    [
        (np.array([[0.5, 0.5 + 1j]]), "points has complex numbers; give x and y"),
        ([[0.5, 1j]], "points has complex numbers"),
        (np.array([0.1 + 0.2j, 0.5 + 0.6j]), "points has complex numbers"),
        (np.array([["0.5", "0.5"]]), "points has values of the type <U3; they must be numbers"),
        (np.array([["2020-01-01", "2020-01-02"]], dtype="datetime64[D]"), "they must be numbers"),
        (np.array([[0.5, 0.5 + 1j]], dtype=object), "complex"),
    ],
    ids=str,
)
@pytest.mark.filterwarnings("error")
def test_what_is_no_real_number_is_refused(points, text):
    with pytest.raises(TypeError, match=text):
        tilescope.verify(points, 0.1)


def test_numbers_of_every_real_type_are_positions():
    for kind in ("?", "i1", "u8", "f2", "f4", ">f8", "O"):
        given = np.array([[0, 1], [1, 0]], dtype=kind)
        assert tilescope.PointSet(given).points.tolist() == [[0, 1], [1, 0]]
