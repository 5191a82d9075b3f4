"""Files are what they say: read back, verified, certified."""

import json
import os
import shutil
import stat
import sys

import numpy as np
import pytest

import tilescope

EXACT = {
    "csv": "csv", "npy": "npy", "ply": "ply-binary", "json": "json", "geojson": "geojson", "xyz": "xyz", "txt": "psa-text", "dat": "utk-text",
    "bin": "utk-binary", "svg": "svg",
}  # fmt: skip


@pytest.mark.parametrize("extension", EXACT)
def test_a_set_comes_back_to_the_bit_with_its_certificate(small, extension, tmp_path):
    path = tmp_path / f"set.{extension}"
    assert small.save(path).valid
    back = tilescope.read(path)
    assert back.digest == small.digest
    assert (back.radius, back.domain, back.method) == (small.radius, small.domain, "kdrt")
    assert back.parameters == small.parameters
    assert back.certificate["valid"]
    assert back.certificate["file_format"] == EXACT[extension]
    assert tilescope.verify(path).passed
    kept = back.provenance is not None
    assert kept == (extension in ("ply", "json"))
    if kept:
        assert np.array_equal(back.provenance, small.provenance)


def test_an_npy_file_is_numpys(small, tmp_path):
    small.save(tmp_path / "set.npy")
    assert np.array_equal(np.load(tmp_path / "set.npy"), small.points)
    small.save(tmp_path / "single.npy", precision="f32")
    assert np.load(tmp_path / "single.npy").dtype == np.float32


def test_the_certificate_in_memory_is_that_of_the_file(small, tmp_path):
    small.save(tmp_path / "set.npy")
    beside = json.loads((tmp_path / "set.npy.certificate.json").read_text())
    assert small.certificate == beside
    assert beside["positions_digest"] == small.digest
    assert beside["parameters"]["seed"] == 7


def test_what_is_altered_is_found(small, tmp_path):
    path = tmp_path / "set.csv"
    small.save(path)
    lines = path.read_text().splitlines()
    path.write_text("\n".join(lines[:-1]) + "\n")
    report = tilescope.verify(path)
    assert not report.passed
    assert not report.valid
    assert any(difference.startswith("positions_digest") for difference in report.differences)
    assert any(difference.startswith("count") for difference in report.differences)


def test_a_certificate_that_is_not_true_is_found(small, tmp_path):
    path = tmp_path / "set.npy"
    small.save(path)
    beside = tmp_path / "set.npy.certificate.json"
    beside.write_text(beside.read_text().replace('"gaps": 0', '"gaps": 3'))
    report = tilescope.verify(path)
    assert report.valid
    assert not report.passed
    assert report.differences[0].startswith("gaps")


def restated(path, **fields):
    """Has the certificate beside a file say something else."""
    beside = path.with_name(f"{path.name}.certificate.json")
    beside.write_text(json.dumps(json.loads(beside.read_text()) | fields))


FALSE = [
    {"gaps": 3}, {"conflicts": 1}, {"valid": False}, {"count": 7}, {"min_distance": 0.03}, {"covering_radius": 0.01},
    {"radius": 0.03}, {"precision": "f32"}, {"positions_digest": "blake3:0"}, {"digest": "blake3:0"},
    {"parameters": {"width": 2.0}},
]  # fmt: skip


@pytest.mark.parametrize("fields", FALSE, ids=lambda fields: next(iter(fields)))
def test_a_set_whose_certificate_is_not_true_is_not_read(fields, small, tmp_path):
    path = tmp_path / "set.npy"
    small.save(path)
    assert tilescope.read(path).method == "kdrt"
    restated(path, **fields)
    for call in (
        lambda: tilescope.read(path),
        lambda: tilescope.read(path, 0.02),
        lambda: tilescope.analyze(path),
        lambda: tilescope.sample(radius=0.01, pattern=path),
        lambda: tilescope.combine(LAYOUT, folder=tmp_path),
    ):
        with pytest.raises(ValueError, match=r"set\.npy: its certificate is not true: .*certificate=False") as error:
            call()
        assert next(iter(fields)) in str(error.value)


LAYOUT = {"version": 1, "radius": 0.05, "columns": [0.6], "rows": [0.6], "pieces": [{"file": "set.npy"}]}


def test_points_beside_the_certificate_of_others_do_not_become_theirs(small, tmp_path):
    small.save(tmp_path / "a.npy")
    tilescope.sample(radius=0.02, seed=8).save(tmp_path / "b.npy")
    shutil.copy(tmp_path / "b.npy", tmp_path / "a.npy")
    with pytest.raises(ValueError, match="its certificate is not true: digest"):
        tilescope.read(tmp_path / "a.npy")

    bare = tilescope.read(tmp_path / "a.npy", 0.02, certificate=False)
    assert (bare.method, bare.parameters, bare.levels, bare.summary) == ("unknown", {}, (), None)
    assert np.array_equal(bare.points, np.load(tmp_path / "b.npy"))
    bare.save(tmp_path / "e.ply")
    assert tilescope.verify(tmp_path / "e.ply").passed
    stated = tilescope.read(tmp_path / "e.ply").certificate
    assert (stated["method"], stated["parameters"]) == ("unknown", {})


@pytest.mark.parametrize("extension", ["ply", "json"])
def test_without_the_certificate_the_positions_alone_are_read(extension, small, tmp_path):
    path = tmp_path / f"set.{extension}"
    small.save(path)
    assert tilescope.read(path).provenance is not None
    bare = tilescope.read(path, certificate=False)
    assert (bare.method, bare.radius, bare.provenance, bare.digest) == ("unknown", None, None, small.digest)
    # What lies beside it may be no certificate at all.
    (tmp_path / f"set.{extension}.certificate.json").write_text("{")
    assert tilescope.read(path, certificate=False).digest == small.digest
    with pytest.raises(ValueError, match="certificate.json is not readable"):
        tilescope.read(path)
    with pytest.raises(TypeError, match="certificate is 'no'; it must be True or False"):
        tilescope.read(path, certificate="no")


def test_what_a_certificate_says_of_another_domain_or_radius_is_left_out(small, tmp_path):
    path = tmp_path / "set.npy"
    small.save(path)
    for given in ({"radius": 0.03}, {"width": 1.5}, {"boundary": "bounded"}):
        other = tilescope.read(path, **given)
        assert (other.method, other.parameters, other.levels) == ("unknown", {}, ())
    assert tilescope.read(path, 0.02, width=1, boundary="periodic").method == "kdrt"


def test_a_report_is_called_valid_only_if_all_of_it_is_true(small, holed, tmp_path):
    path = tmp_path / "set.npy"
    small.save(path)
    assert repr(tilescope.verify(path)).startswith("<Report: valid, 17")
    restated(path, gaps=3)
    report = tilescope.verify(path)
    assert report.valid
    assert not report.passed
    assert repr(report).startswith("<Report: CERTIFICATE NOT TRUE, 17")
    np.save(path, holed.points)
    report = tilescope.verify(path)
    assert repr(report).startswith("<Report: NOT VALID, CERTIFICATE NOT TRUE, 17")
    assert repr(holed.verify()).startswith("<Report: NOT VALID, 17")
    for one in (report, holed.verify()):
        assert "valid" not in repr(one)


def test_reading_passes_progress_on_and_can_be_stopped(tmp_path):
    class Enough(Exception):
        pass

    def stop(name, done, total):
        raise Enough

    tilescope.sample(100_000).save(tmp_path / "set.npy")
    with pytest.raises(Enough):
        tilescope.read(tmp_path / "set.npy", progress=stop)


def test_an_invalid_set_is_saved_with_a_warning(holed, tmp_path):
    with pytest.warns(UserWarning, match="the written set is not maximal"):
        report = holed.save(tmp_path / "holed.npy")
    assert not report.valid
    assert not tilescope.read(tmp_path / "holed.npy").certificate["valid"]


def test_rounding_is_told(tmp_path):
    large = tilescope.sample(100_000)
    with pytest.warns(UserWarning, match="pairs in conflict, made by rounding"):
        large.save(tmp_path / "large.rps")


def test_a_file_without_a_certificate(small, tmp_path):
    path = tmp_path / "set.csv"
    assert small.save(path, verify=False) is None
    assert os.listdir(tmp_path) == ["set.csv"]
    back = tilescope.read(path)
    assert (back.radius, back.domain) == (None, (1.0, 1.0, "periodic"))
    assert tilescope.read(path, 0.02).verify().valid
    assert tilescope.verify(path, 0.02).valid
    with pytest.raises(ValueError, match="the set has no certificate; give radius"):
        tilescope.verify(path)
    with pytest.raises(ValueError, match="the radius of the set is not known"):
        back.verify()
    with pytest.raises(ValueError, match="the radius of the set is not known"):
        back.save(tmp_path / "again.csv")


def test_a_set_of_a_wide_domain_in_units_of_its_width(tmp_path):
    wide = tilescope.sample(radius=0.05, width=2.0)
    wide.save(tmp_path / "certified.txt")
    wide.save(tmp_path / "bare.txt", verify=False)
    assert tilescope.read(tmp_path / "certified.txt").digest == wide.digest
    bare = tilescope.read(tmp_path / "bare.txt", 0.05, width=2.0)
    assert bare.digest == wide.digest
    assert tilescope.verify(tmp_path / "bare.txt", 0.05, width=2.0).valid
    assert tilescope.verify(tmp_path / "certified.txt", boundary="bounded").domain == (2.0, 1.0, "bounded")


def test_a_shuffled_file_has_the_same_samples_in_another_order(small, tmp_path):
    small.save(tmp_path / "set.npy", shuffle=5)
    shuffled = np.load(tmp_path / "set.npy")
    assert not np.array_equal(shuffled, small.points)
    assert sorted(map(tuple, shuffled)) == sorted(map(tuple, small.points))
    assert tilescope.verify(tmp_path / "set.npy").passed


def test_files_that_cannot_be_are_refused(small, tmp_path):
    with pytest.raises(FileNotFoundError) as error:
        tilescope.read(tmp_path / "none.npy")
    assert error.value.filename == str(tmp_path / "none.npy")
    assert error.value.strerror == "No such file or directory"
    with pytest.raises(FileNotFoundError):
        small.save(tmp_path / "no such folder" / "set.npy")
    with pytest.raises(ValueError, match=r"the extension names no format \(known: csv, .*svg\); give format"):
        small.save(tmp_path / "set.jpeg")
    with pytest.raises(ValueError, match='no file format is called "jpeg"'):
        small.save(tmp_path / "set", format="jpeg")
    with pytest.raises(ValueError, match="precision is 'f16'.*`f32` or `f64`"):
        small.save(tmp_path / "set.npy", precision="f16")
    with pytest.raises(ValueError, match="shuffle is -1"):
        small.save(tmp_path / "set.npy", shuffle=-1)
    (tmp_path / "text.csv").write_text("x,y\n1,two\n")
    with pytest.raises(ValueError, match="two"):
        tilescope.read(tmp_path / "text.csv")
    assert sorted(os.listdir(tmp_path)) == ["text.csv"]


def test_a_file_that_cannot_be_replaced_stays(small, tmp_path):
    (tmp_path / "set.npy").mkdir()
    with pytest.raises(ValueError, match="this is a folder|this is a directory"):
        small.save(tmp_path / "set.npy")
    assert stat.S_ISDIR((tmp_path / "set.npy").stat().st_mode)


ORIGIN = (500_000.0, 5_400_000.0)


@pytest.fixture
def trees():
    return tilescope.sample(radius=2, width=100, height=80, origin=ORIGIN)


def test_a_set_is_stored_at_its_origin_and_keeps_it(trees, tmp_path):
    assert np.array_equal(trees.points, tilescope.sample(radius=2, width=100, height=80).points)
    path = tmp_path / "trees.csv"
    assert trees.save(path).valid
    stated = json.loads((tmp_path / "trees.csv.certificate.json").read_text())
    assert (stated["format_version"], stated["origin"]) == (2, list(ORIGIN))
    stored = np.loadtxt(path, delimiter=",", skiprows=1, usecols=(0, 1))
    assert np.allclose(stored - ORIGIN, trees.points, rtol=0, atol=1e-8)
    assert tilescope.verify(path).passed
    assert trees.certificate["origin"] == list(ORIGIN)

    back = tilescope.read(path)
    assert (back.origin, back.method, back.domain) == (ORIGIN, "kdrt", trees.domain)
    back.save(tmp_path / "again.npy")
    assert np.array_equal(np.load(tmp_path / "again.npy"), stored)
    assert tilescope.verify(tmp_path / "again.npy").passed
    assert tilescope.read(tmp_path / "again.npy").origin == ORIGIN


def test_a_set_without_an_origin_has_a_certificate_of_version_1(small, trees, tmp_path):
    for name, one, origin in (("small.npy", small, None), ("trees.npy", trees, (0, 0))):
        one.save(tmp_path / name, origin=origin)
        stated = json.loads((tmp_path / f"{name}.certificate.json").read_text())
        assert stated["format_version"] == 1
        assert "origin" not in stated
        assert np.array_equal(np.load(tmp_path / name), one.points)
        assert tilescope.read(tmp_path / name).origin == (0.0, 0.0)


@pytest.mark.parametrize(
    ("fields", "refusal"),
    [
        ({"depth": 1.0}, "has a third side"),
        ({"prefix": {"made": 0, "kept": 1, "factor": 1}}, "`prefix` is .*: from 1 to `made` points are kept"),
        ({"judges": ["subdivision"]}, "version 2 needs an origin, or another part that version 1 lacks"),
        (
            {"shape": {"kind": "polygon", "rings": [[[0, 0], [1, 0], [0, 1]]]}, "covering_radius": None},
            "lies outside the shape",
        ),
        ({"foo": 1}, "has the part `foo`, which this version does not know"),
    ],
    ids=["depth", "prefix", "judge", "shape", "unknown"],
)
def test_a_part_that_cannot_be_judged_is_not_passed_over(fields, refusal, small, tmp_path):
    path = tmp_path / "set.npy"
    small.save(path)
    restated(path, format_version=2, **fields)
    for call in (tilescope.read, tilescope.verify, tilescope.analyze):
        with pytest.raises(ValueError, match=refusal):
            call(path)
    assert tilescope.read(path, certificate=False).method == "unknown"


def test_an_origin_that_is_given_is_that_of_a_file_without_a_certificate(trees, tmp_path):
    path = tmp_path / "alone.csv"
    trees.save(path, verify=False)
    given = {"radius": 2, "width": 100, "height": 80, "origin": ORIGIN}
    assert tilescope.verify(path, **given).valid
    assert tilescope.analyze(path, **given)["conflicts"] == 0
    back = tilescope.read(path, **given)
    assert back.origin == ORIGIN
    assert np.allclose(back.points, trees.points, rtol=0, atol=1e-8)
    assert back.verify().valid
    with pytest.raises(ValueError, match="outside"):
        tilescope.verify(path, 2, width=100, height=80)


def test_an_origin_other_than_the_certificates_is_refused(trees, tmp_path):
    path = tmp_path / "trees.npy"
    trees.save(path)
    assert tilescope.read(path, origin=ORIGIN).method == "kdrt"
    with pytest.raises(ValueError, match="outside|origin: the certificate states 500000 5400000"):
        tilescope.read(path, origin=(499_999.0, 5_400_000.0))


def test_origins_that_would_spoil_a_set_are_refused(small, trees, tmp_path):
    with pytest.raises(ValueError, match=r"at the origin 0 2000000000 .* apart, more than 0.00001"):
        small.save(tmp_path / "far.npy", origin=(0, 2e9))
    with pytest.raises(ValueError, match="begins at 0 0"):
        trees.save(tmp_path / "trees.rps")
    with pytest.raises(ValueError, match="GeoParquet has no certificate"):
        trees.save(tmp_path / "trees.parquet")
    assert os.listdir(tmp_path) == []
    for wrong in ((1, 2, 3), (1, float("nan")), 5):
        with pytest.raises(ValueError, match="it must be two finite numbers"):
            tilescope.sample(radius=0.1, origin=wrong)
    with pytest.raises(TypeError, match="they must be numbers"):
        small.save(tmp_path / "set.npy", origin=("a", "b"))
    with pytest.raises(ValueError, match="origin is .* which is no file"):
        tilescope.verify(small, origin=ORIGIN)


def test_what_terminals_obey_is_shown_as_an_escape(small, tmp_path):
    path = tmp_path / "a\x1b[2Jb.npy"
    small.save(path)
    restated(path, gaps=3)
    with pytest.raises(ValueError, match=r"a\\u001b\[2Jb\.npy: its certificate is not true") as error:
        tilescope.read(path)
    assert "\x1b" not in str(error.value)
    (tmp_path / "text.csv").write_text("x,y\n1,\x1b[2Jtwo\n")
    with pytest.raises(ValueError, match="two") as error:
        tilescope.read(tmp_path / "text.csv")
    assert "\x1b" not in str(error.value)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
def test_a_name_that_is_not_utf_8_says_so(small, tmp_path):
    small.save(tmp_path / "set.npy")
    name = os.fsdecode(b"s\xffet.npy")
    for end in ("", ".certificate.json"):
        os.rename(tmp_path / f"set.npy{end}", tmp_path / f"{name}{end}")
    stated = tilescope.sample(radius=0.05, pattern=tmp_path / name).parameters["pattern"]
    assert stated["file"] == "(not UTF-8) s\ufffdet.npy"
