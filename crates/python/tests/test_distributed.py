"""Planes written tile by tile: every sample once, the same files by every engine, faults found."""

import doctest
import hashlib
import importlib
import itertools
import json
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import psutil
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest

import tilescope
import tilescope.distributed
from tilescope import _optional
from tilescope.distributed import _engines, _tile
from tilescope.distributed._grid import Grid

PAGE = Path(__file__).parents[1] / "distributed.md"
ROWS = 3000
BOUNDARIES = ["periodic", "bounded"]

slow = pytest.mark.skipif(not os.environ.get("TILESCOPE_SLOW"), reason="takes long: tests/run --slow runs it")


def parameters(boundary):
    return {"radius": 0.004, "width": 1.0, "height": 0.7, "boundary": boundary, "seed": 5}


@pytest.fixture(scope="module", params=BOUNDARIES)
def plane(request):
    return tilescope.Plane(**parameters(request.param))


@pytest.fixture(scope="module")
def written(plane, tmp_path_factory):
    """The plane in a folder, which no test changes."""
    return tilescope.distributed.write(plane, tmp_path_factory.mktemp("written") / "set", rows=ROWS)


@pytest.fixture
def copied(written, tmp_path):
    """The same in a folder of the test's own."""
    shutil.copytree(Path(written.files[0]).parent, tmp_path / "set")
    return tilescope.distributed.open(tmp_path / "set")


def positions(file):
    """The positions of a tile, read without Tilescope."""
    points = pq.read_table(file, partitioning=None).column("geometry").combine_chunks()
    return np.stack([points.field("x").to_numpy(), points.field("y").to_numpy()], axis=1)


def states(folder):
    return {file.name: file.stat().st_ino for file in Path(folder).glob("tile-*.parquet")}


def test_the_tiles_hold_the_whole_set_cut_along_half_open_borders(plane, written):
    whole = tilescope.sample(**parameters(plane.domain.boundary)).points
    columns, rows = written.manifest["grid"]
    assert (columns, rows) == (4, 3)
    stated = written.manifest["tiles"]
    found = 0
    for index, file in enumerate(written.files):
        row, column = divmod(index, columns)
        inside = np.ones(len(whole), dtype=bool)
        for axis, place, tiles, side in ((0, column, columns, 1.0), (1, row, rows, 0.7)):
            inside &= whole[:, axis] >= place * (side / tiles)
            if place + 1 < tiles:
                inside &= whole[:, axis] < (place + 1) * (side / tiles)
        assert np.array_equal(positions(file), whole[inside]), file
        low, high = whole[inside].min(axis=0), whole[inside].max(axis=0)
        assert stated[index]["bbox"] == [*low, *high]
        assert stated[index]["count"] == inside.sum()
        digest = hashlib.sha256(whole[inside].astype("<f8").tobytes()).hexdigest()
        assert stated[index]["digest"] == f"sha256:{digest}"
        found += inside.sum()
    assert found == len(whole) == len(written)
    if plane.domain.boundary == "bounded":
        assert (whole.max(axis=0) == [1.0, 0.7]).all(), "no sample lies on the upper border"


def test_the_digest_is_that_of_the_set_in_memory(plane, written):
    digests = b"".join(bytes.fromhex(tile["digest"][7:]) for tile in written.manifest["tiles"])
    assert written.digest == f"sha256:{hashlib.sha256(digests).hexdigest()}"
    whole = tilescope.sample(**parameters(plane.domain.boundary))
    assert tilescope.distributed.digest(whole, rows=ROWS) == written.digest
    assert tilescope.distributed.digest(whole, rows=ROWS * 2) != written.digest
    moved = whole.points.copy()
    moved[77, 0] = np.nextafter(moved[77, 0], 1)
    domain = {"width": 1.0, "height": 0.7, "boundary": plane.domain.boundary}
    assert tilescope.distributed.digest(tilescope.PointSet(moved, 0.004, **domain), rows=ROWS) != written.digest
    with pytest.raises(ValueError, match="the radius of the set is not known"):
        tilescope.distributed.digest(tilescope.PointSet(moved, **domain))


@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_a_place_on_a_border_belongs_to_one_tile(boundary):
    grid = Grid.of(tilescope.Domain(0.3, 0.7, boundary), 0.001, 9000)
    assert min(grid.shape) >= 2
    borders = [grid.borders(axis) for axis in (0, 1)]
    if boundary == "periodic":
        # The upper border is the lower one.
        borders = [along[:-1] for along in borders]
    below = [np.nextafter(along[1:], 0) for along in borders]
    places = np.array(list(itertools.product(*(np.concatenate(both) for both in zip(borders, below, strict=True)))))
    owners = np.array([grid.holds(index, places) for index in range(len(grid))])
    assert (owners.sum(axis=0) == 1).all()
    assert np.array_equal(owners.argmax(axis=0), grid.tiles_of(places))
    # A border belongs to the tile above it.
    last = [(len(along) - 1 if boundary == "periodic" else len(along) - 2) for along in borders]
    corners = np.array([(x, y) for y in borders[1] for x in borders[0]])
    columns = np.minimum(np.arange(len(borders[0])), last[0])
    rows = np.minimum(np.arange(len(borders[1])), last[1])
    expected = (rows[:, None] * grid.shape[0] + columns[None, :]).ravel()
    assert np.array_equal(grid.tiles_of(corners), expected)


def test_windows_are_those_of_the_plane(plane, written):
    random = np.random.default_rng(3)
    windows = [(0, 0, 1, 0.7), (0.25, 0, 0.5, 0.7 / 3), (0.3, 0.3, 0.3001, 0.3001), (0.9, 0.6, 1, 0.7)]
    for _ in range(40):
        x, y = random.uniform(-0.2, 0.9), random.uniform(-0.2, 0.6)
        windows.append((x, y, x + random.uniform(0.2, 1), y + random.uniform(0.2, 0.7)))
    if plane.domain.boundary == "periodic":
        windows += [(-0.3, -0.2, 0.7, 0.5), (7.9, -3.1, 8.3, -2.9), (-0.5, 0, 0.5, 0.7), (1, 0.7, 2, 1.4)]
    for window in windows:
        ours, theirs = written.window(*window), plane.window(*window)
        assert np.array_equal(ours, theirs), window
        assert not ours.flags.writeable
    assert len(written.window(0, 0, 1, 0.7)) == len(written)


@pytest.mark.parametrize(
    ("window", "text"),
    [
        ((0.5, 0, 0.4, 0.7), "the window's width runs from 0.5 to 0.4"),
        ((0, 0, 1.5, 0.7), "at most 1 long"),
        ((0, 0, 1, float("nan")), "the window's height .* it must be finite"),
        ((1e9, 0, 1e9 + 0.5, 0.7), "it must begin between -1,000 and 1,000"),
        ((2, 0, 2.5, 0.7), "the window's width runs from 2 to 2.5, which holds no place of the domain's 0 to 1"),
    ],
)
def test_windows_are_refused_as_by_the_plane(window, text, plane, written):
    for one in (plane, written):
        if window[0] == 2 and plane.domain.boundary == "periodic":
            assert len(one.window(*window)) > 1000
        else:
            with pytest.raises(ValueError, match=text):
                one.window(*window)


def test_a_window_reads_only_its_tiles(plane, copied):
    window = (0.3, 0.3, 0.45, 0.4)
    before = copied.window(*window)
    for file in copied.files:
        if file != copied.files[5]:
            os.unlink(file)
    assert np.array_equal(copied.window(*window), before)
    with pytest.raises(FileNotFoundError, match="tile-00000-00000"):
        copied.window(0, 0, 0.1, 0.1)


def test_files_are_geoparquet_with_a_row_group_and_its_box(plane, written):
    for file, tile in zip(written.files, written.manifest["tiles"], strict=True):
        opened = pq.ParquetFile(file)
        assert opened.metadata.num_row_groups == 1
        assert opened.metadata.num_rows == tile["count"]
        geo = json.loads(opened.metadata.metadata[b"geo"])
        assert geo["version"] == "1.1.0"
        column = geo["columns"][geo["primary_column"]]
        assert column["encoding"] == "point"
        assert column["geometry_types"] == ["Point"]
        assert column["crs"] is None
        assert column["bbox"] == tile["bbox"]
        group = opened.metadata.row_group(0)
        statistics = {group.column(at).path_in_schema: group.column(at).statistics for at in range(2)}
        for name, low, high in (("geometry.x", 0, 2), ("geometry.y", 1, 3)):
            assert statistics[name].min == tile["bbox"][low]
            assert statistics[name].max == tile["bbox"][high]


def test_lazy_frames_have_all_samples(plane, written):
    frame = written.frame("dask")
    assert frame.npartitions == len(written.files)
    assert list(frame.columns) == ["x", "y"]
    some = frame[(frame.x < 0.3) & (frame.y < 0.3)].compute()
    window = plane.window(0, 0, 0.3, 0.3)
    assert len(some) == len(window)
    assert some.x.sum() == pytest.approx(window[:, 0].sum())
    dataset = written.frame("arrow")
    assert dataset.count_rows() == len(written)
    inside = (pc.field("geometry", "x") < 0.3) & (pc.field("geometry", "y") < 0.3)
    assert dataset.count_rows(filter=inside) == len(window)
    assert type(written.frame()) is type(frame)
    with pytest.raises(ValueError, match="engine is 'spark'; it must be 'dask' or 'arrow'"):
        written.frame("spark")


def test_a_sound_set_has_no_faults(written):
    told = []
    assert written.verify(progress=lambda *progress: told.append(progress)) == []
    assert told[-1] == ("tiles", 12, 12)
    assert ("files", 12, 12) in told
    assert written.verify(positions=False, judge="delaunay") == []


def test_a_tile_with_a_flipped_bit_is_found(copied):
    random = np.random.default_rng(8)
    for _ in range(40):
        file = Path(copied.files[random.integers(len(copied.files))])
        sound = file.read_bytes()
        bit = int(random.integers(8 * len(sound)))
        flipped = bytearray(sound)
        flipped[bit // 8] ^= 1 << bit % 8
        file.write_bytes(flipped)
        assert copied.verify() == [f"{file} has other bytes than were written to it"], bit
        file.write_bytes(sound)
    assert copied.verify() == []


def test_windows_and_frames_refuse_a_damaged_page(copied):
    file = Path(copied.files[0])
    flipped = bytearray(file.read_bytes())
    flipped[len(flipped) // 2] ^= 1
    file.write_bytes(flipped)
    with pytest.raises(ValueError, match="tile-00000-00000.parquet is not a tile, or it is damaged"):
        copied.window(0, 0, 0.1, 0.1)
    copied.window(0.6, 0.5, 0.7, 0.6)
    with pytest.raises(ValueError, match="tile-00000-00000.parquet is not a tile, or it is damaged"):
        copied.frame("dask").x.sum().compute(scheduler="synchronous")
    with pytest.raises(OSError, match="CRC checksum verification failed"):
        copied.frame("arrow").to_table()


def test_missing_and_exchanged_tiles_are_found(copied):
    first, second = copied.files[:2]
    os.replace(first, second)
    assert copied.verify() == [f"{first} is missing", f"{second} has other bytes than were written to it"]


def replaced(stored, index, changed):
    """Has a folder say that a tile has other positions, with digests that agree."""
    folder = Path(stored.files[0]).parent
    manifest = stored.manifest
    facts = {name: manifest[name] for name in ("format", "version", "domain", "radius", "parameters", "grid")}
    grid = Grid(stored.domain, stored.radius, tuple(manifest["grid"]))
    job = _tile.Job(b"", facts, str(folder), grid)
    encoded = _tile._encoded(changed, job.facts_of(index, _tile.digest(changed)))
    Path(stored.files[index]).write_bytes(encoded)
    manifest["tiles"][index] |= {
        "count": len(changed), "digest": _tile.digest(changed), "file_digest": _tile.sha256(encoded),
        "bbox": _tile._bbox(changed),
    }  # fmt: skip
    manifest["count"] = sum(tile["count"] for tile in manifest["tiles"])
    manifest["digest"] = _tile.total_digest([tile["digest"] for tile in manifest["tiles"]])
    (folder / "manifest.json").write_text(json.dumps(manifest))
    return tilescope.distributed.open(folder)


@pytest.mark.parametrize("index", [0, 5])
def test_a_conflict_or_a_gap_in_files_that_agree_is_found(index, copied):
    tile = positions(copied.files[index])
    stored = replaced(copied, index, np.delete(tile, len(tile) // 2, axis=0))
    assert stored.verify(positions=False) == []
    (fault,) = stored.verify()
    assert re.search(rf"{re.escape(stored.files[index])} is not valid: conflicts: 0, gaps: [1-9]", fault)
    near = tile[len(tile) // 2] + 0.001
    stored = replaced(stored, index, np.insert(tile, 7, near, axis=0))
    (fault,) = stored.verify()
    assert fault == f"{stored.files[index]} is not valid: conflicts: {fault.split(': ')[2].split(',')[0]}, gaps: 0"
    assert int(re.search(r"conflicts: (\d+)", fault)[1]) >= 1
    stored = replaced(stored, index, np.concatenate([tile, [[0.9, 0.69]]]))
    (fault,) = stored.verify()
    assert fault == f"{stored.files[index]} has positions outside of its tile"


def test_tiles_that_do_not_fit_together_are_found(plane, copied):
    other = tilescope.Plane(**(parameters(plane.domain.boundary) | {"seed": 6}))
    grid = Grid(copied.domain, copied.radius, tuple(copied.manifest["grid"]))
    stored = replaced(copied, 0, other.window(*grid.bounds(0)))
    assert stored.verify(positions=False) == []
    faulty = [stored.files.index(fault.split(" is not valid")[0]) for fault in stored.verify()]
    across = [3, 8] if plane.domain.boundary == "periodic" else []
    assert set(faulty) >= {0, 1, 4, *across}
    assert not set(faulty) & {2, 6, 10}


def test_a_tile_that_is_not_valid_is_not_written(plane, tmp_path, monkeypatch):
    class Holed:
        def window(self, *window, progress):
            found = plane.window(*window)
            return np.delete(found, np.argmin(np.abs(found - [0.4, 0.35]).sum(axis=1)), axis=0)

    monkeypatch.setattr(_tile, "_plane", lambda pickled: Holed())
    with pytest.raises(ValueError, match=r"tile-\d+-\d+.parquet is not written.*0 conflicts and [1-9]\d* gaps"):
        tilescope.distributed.write(plane, tmp_path / "set", rows=ROWS)
    assert len(states(tmp_path / "set")) < 12


class Interrupted(Exception):
    pass


def test_finished_tiles_are_kept_and_the_others_made(plane, written, tmp_path, monkeypatch):
    # With many cores all tiles would be finished before the first of them is reported.
    monkeypatch.setattr(_engines, "_cores", lambda: 2)
    folder = tmp_path / "set"

    def stop(name, done, total):
        assert (name, total) == ("tiles", 12)
        if done == 4:
            raise Interrupted

    with pytest.raises(Interrupted):
        tilescope.distributed.write(plane, folder, rows=ROWS, progress=stop)
    before = states(folder)
    assert 4 <= len(before) < 12
    with pytest.raises(ValueError, match=f"it has {len(before)} of 12 tiles; write it again to complete it"):
        tilescope.distributed.open(folder)
    (folder / "tile-00000-00000.parquet.1234.partial").write_bytes(b"left by a lost worker")
    damaged, foreign = sorted(before)[:2]
    (folder / damaged).write_bytes((folder / damaged).read_bytes()[:-100])
    shutil.copy(written.files[-1], folder / foreign)
    stored = tilescope.distributed.write(plane, folder, rows=ROWS)
    assert stored.manifest == written.manifest
    assert stored.verify() == []
    after = states(folder)
    assert len(after) == 12
    for name, state in before.items():
        assert (after[name] == state) == (name not in (damaged, foreign)), name
    assert sorted(os.listdir(folder)) == ["manifest.json", *sorted(after)]
    # A set that is complete is checked, and stays.
    text = (folder / "manifest.json").read_text()
    os.unlink(stored.files[3])
    tilescope.distributed.write(plane, folder, rows=ROWS)
    again = states(folder)
    assert [name for name in after if again[name] != after[name]] in ([], [Path(stored.files[3]).name])
    assert (folder / "manifest.json").read_text() == text


def test_ctrl_c_keeps_finished_tiles(tmp_path):
    code = f"""
        import os, signal
        import tilescope.distributed
        signal.signal(signal.SIGINT, signal.default_int_handler)
        tilescope.distributed._engines._cores = lambda: 2
        def press(name, done, total):
            if done == 2:
                os.kill(os.getpid(), signal.SIGINT)
        plane = tilescope.Plane(radius=0.001)
        try:
            tilescope.distributed.write(plane, {str(tmp_path / "set")!r}, rows=50_000, progress=press)
        except KeyboardInterrupt:
            print("stopped")
    """
    command = [sys.executable, "-c", textwrap.dedent(code)]
    outcome = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert (outcome.returncode, outcome.stdout) == (0, "stopped\n"), outcome.stderr
    finished = states(tmp_path / "set")
    assert 2 <= len(finished) < 16
    assert set(os.listdir(tmp_path / "set")) == {"manifest.json", *finished}
    assert len(tilescope.distributed.write(tilescope.Plane(radius=0.001), tmp_path / "set", rows=50_000).files) == 16
    assert finished.items() <= states(tmp_path / "set").items()


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"seed": 6}, "parameters.seed is 5 there, and 6 here"),
        ({"radius": 0.0041}, "radius is 0.004 there, and 0.0041 here"),
        ({"pattern_seed": 3}, "parameters.pattern.seed is 0 there, and 3 here"),
        ({"width": 1.2}, r"domain is \[1.0, 0.7, '\w+'\] there, and \[1.2, 0.7, '\w+'\] here"),
        ({"rows": 2000}, r"grid is \[4, 3\] there, and \[\d, \d\] here"),
    ],
)
def test_a_folder_with_another_set_is_refused(arguments, text, plane, copied):
    rows = arguments.get("rows", ROWS)
    given = {name: value for name, value in arguments.items() if name != "rows"}
    other = tilescope.Plane(**(parameters(plane.domain.boundary) | given))
    folder = Path(copied.files[0]).parent
    with pytest.raises(ValueError, match=f"{folder} has another set: {text}"):
        tilescope.distributed.write(other, folder, rows=rows)
    assert copied.verify(positions=False) == []


def test_other_folders_are_refused(written, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(FileExistsError, match="is not empty, and has no manifest.json"):
        tilescope.distributed.write(tilescope.Plane(radius=0.01), tmp_path)
    with pytest.raises(FileNotFoundError, match="manifest.json"):
        tilescope.distributed.open(tmp_path)
    path = tmp_path / "manifest.json"
    for change, text in [
        (lambda manifest: manifest.clear(), "is not a manifest, or it is damaged"),
        (lambda manifest: manifest.update(version=2), "has the format .*2.*; this version reads"),
        (lambda manifest: manifest.update(count=7), "its count is not that of its tiles"),
        (lambda manifest: manifest["tiles"].pop(), "its tiles are not those of its grid"),
        (lambda manifest: manifest["tiles"][0].update(digest=manifest["digest"]), "its digest is not that of"),
        (lambda manifest: manifest.pop("radius"), "cannot be used: 'radius'"),
        (lambda manifest: manifest.update(grid=[3000, 3000]), r"12 are listed, and 3000 x 3000 are 9000000"),
        (lambda manifest: manifest.update(grid=[10**30, 10**30]), "its tiles are not those of its grid"),
        (lambda manifest: manifest.update(grid=[10**9, 10**9], complete=False, tiles=[]), f"it has 0 of {10**18} tiles"),
        (lambda manifest: manifest.update(grid=[12]), "grid has 1 values; it must have 2"),
        (lambda manifest: manifest.update(grid=[4.0, 3]), "grid has 4.0, where a whole number above 0 must be"),
        (lambda manifest: manifest.update(grid=[-4, -3]), "grid has -4, where a whole number above 0 must be"),
        (lambda manifest: manifest.update(complete="yes"), "complete has 'yes', where true or false must be"),
        (lambda manifest: manifest.update(complete=1), "complete has 1, where true or false must be"),
        (lambda manifest: manifest.update(complete=None), "complete has None, where true or false must be"),
        (lambda manifest: manifest.update(count="all"), "count has 'all', where a whole number must be"),
        (lambda manifest: manifest.update(radius="small"), "radius has 'small', where a finite number above 0 must be"),
        (lambda manifest: manifest.update(radius=float("nan")), "radius has nan, where"),
        (lambda manifest: manifest.update(domain=[1, 0.7, "open"]), "domain has 'open', where"),
        (lambda manifest: manifest.update(parameters=[]), r"parameters has \[\], where an object must be"),
        (lambda manifest: manifest.update(digest=7), "digest has 7, where text must be"),
        (lambda manifest: manifest.update(tiles="x" * 100_000), r"tiles is 'x{39}\.\.\..*; it must be a list"),
        (lambda manifest: manifest["tiles"].__setitem__(0, 7), "a tile has 7, where an object must be"),
        (lambda manifest: manifest["tiles"][0].update(count=True), "a tile's count has True, where a whole number"),
        (lambda manifest: manifest["tiles"][0].update(bbox=[1]), "a tile's bbox has 1 values; it must have 4"),
        (lambda manifest: manifest["tiles"][0].update(file=None), "a tile's file has None, where text must be"),
        (lambda manifest: manifest["tiles"][0].pop("digest"), "cannot be used: 'digest'"),
    ]:
        manifest = written.manifest
        change(manifest)
        path.write_text(json.dumps(manifest))
        with pytest.raises(ValueError, match=text) as error:
            tilescope.distributed.open(tmp_path)
        assert len(str(error.value)) < 1000
        # To write there would be to go on with such a folder.
        with pytest.raises((ValueError, FileExistsError)):
            tilescope.distributed.write(tilescope.Plane(radius=0.01), tmp_path)
    path.write_text("{")
    with pytest.raises(ValueError, match="is not a manifest"):
        tilescope.distributed.open(tmp_path)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"rows": 999}, "rows is 999; it must be between 1000 and 50000000"),
        ({"rows": 10**9}, "rows is 1000000000; it must be between"),
        ({"engine": "spark"}, "engine is 'spark'; it must be 'local', 'dask' or 'ray'"),
        ({"retries": -1}, "retries is -1; it must be at least 0"),
        ({"judge": "me"}, "judge is 'me'"),
    ],
)
def test_wrong_arguments_are_refused(arguments, text, tmp_path):
    with pytest.raises(ValueError, match=text):
        tilescope.distributed.write(tilescope.Plane(radius=0.01), tmp_path / "set", **arguments)


@pytest.mark.parametrize("path", ["s3://bucket/set", Path("s3://bucket/set"), "gs://bucket/set", "file:///tmp/set"])
def test_addresses_are_no_folders(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match="is a URL"):
        tilescope.distributed.write(tilescope.Plane(radius=0.01), path)
    with pytest.raises(ValueError, match="is a URL"):
        tilescope.distributed.open(path)
    assert list(tmp_path.iterdir()) == []


def test_nested_levels_are_refused(tmp_path):
    plane = tilescope.Plane(radius=0.01)
    plane._parameters = json.dumps(plane.parameters | {"levels": 3})
    with pytest.raises(ValueError, match="the plane has nested levels"):
        tilescope.distributed.write(plane, tmp_path / "set")


@pytest.mark.parametrize("arguments", [{"rows": 1e6}, {"retries": 1.0}, {"rows": "many"}, {"retries": None}, {"progress": 1}])
def test_arguments_of_other_types_are_refused(arguments, tmp_path):
    with pytest.raises(TypeError):
        tilescope.distributed.write(tilescope.Plane(radius=0.01), tmp_path / "set", **arguments)
    with pytest.raises(TypeError, match="must be a tilescope.Plane"):
        tilescope.distributed.write(tilescope.sample(radius=0.02), tmp_path / "set")


@pytest.mark.parametrize(
    ("engine", "missing", "extra"),
    [("local", "pyarrow", "parquet"), ("dask", "distributed", "dask"), ("ray", "ray", "ray")],
)
def test_a_missing_package_is_named(engine, missing, extra, tmp_path, monkeypatch):
    def found(name):
        if name.split(".")[0] == missing:
            raise ImportError(name)
        return importlib.import_module(name)

    monkeypatch.setattr(_optional, "import_module", found)
    with pytest.raises(ImportError, match=rf"needs {missing}.*: pip install 'tilescope\[{extra}\]'"):
        tilescope.distributed.write(tilescope.Plane(radius=0.01), tmp_path / "set", engine=engine)


def test_packages_are_imported_when_they_are_needed():
    code = "import sys, tilescope.distributed; print({'pyarrow', 'dask', 'distributed', 'ray'} & set(sys.modules))"
    outcome = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert outcome.stdout == "set()\n"


def test_a_file_that_cannot_be_written_is_tried_again(written, plane, tmp_path, monkeypatch):
    refused = []

    def refuse(source, target):
        name = os.path.basename(target)
        if name.startswith("tile") and refused.count(name) < 2:
            refused.append(name)
            raise OSError(28, "No space left on device")
        return replace(source, target)

    replace = os.replace
    monkeypatch.setattr(_tile.os, "replace", refuse)
    with pytest.raises(OSError, match="No space left"):
        tilescope.distributed.write(plane, tmp_path / "set", rows=ROWS, retries=1)
    assert not list((tmp_path / "set").glob("*.partial"))
    refused.clear()
    stored = tilescope.distributed.write(plane, tmp_path / "set", rows=ROWS, retries=2)
    assert stored.digest == written.digest
    assert len(refused) >= 2


def test_files_in_the_making_do_not_follow_links(plane, tmp_path, monkeypatch):
    # Names that can be foretold, to which somebody has put links to another's file.
    monkeypatch.setattr(_tile.uuid, "uuid4", lambda: SimpleNamespace(hex="known"))
    (tmp_path / "precious").write_text("mine")
    folder = tmp_path / "set"
    folder.mkdir()
    for name in ("manifest.json.partial", "manifest.json.known.partial"):
        (folder / name).symlink_to(tmp_path / "precious")
    with pytest.raises(FileExistsError):
        tilescope.distributed.write(plane, folder, rows=ROWS)
    assert (tmp_path / "precious").read_text() == "mine"


def test_files_are_written_through_to_the_device(plane, tmp_path, monkeypatch):
    synced = []
    fsync = os.fsync
    monkeypatch.setattr(_tile.os, "fsync", lambda file: (synced.append(os.fstat(file).st_ino), fsync(file)))
    stored = tilescope.distributed.write(plane, tmp_path / "set", rows=ROWS)
    wanted = [*stored.files, tmp_path / "set/manifest.json", tmp_path / "set"]
    assert {os.stat(path).st_ino for path in wanted} <= set(synced)


def test_planes_are_pickled_by_what_they_are_made_from(small, tmp_path):
    small.save(tmp_path / "pattern.npy")
    planes = [
        tilescope.Plane(20_000, seed=2**63, boundary="bounded", dihedral=True, order="index"),
        tilescope.Plane(radius=0.01, pattern=small, width=0.9),
        tilescope.Plane(radius=0.01, pattern=tmp_path / "pattern.npy", insertion="uniform"),
        tilescope.Plane(radius=0.01, method="exact", leaf=12),
    ]
    os.unlink(tmp_path / "pattern.npy")
    for plane in planes:
        same = pickle.loads(pickle.dumps(plane))
        assert (same.parameters, same.domain, same.radius) == (plane.parameters, plane.domain, plane.radius)
        assert np.array_equal(same.window(0.2, 0.2, 0.7, 0.6), plane.window(0.2, 0.2, 0.7, 0.6))


def test_a_plane_of_exact_tiling_is_written_tile_by_tile(tmp_path):
    arguments = {"radius": 0.008, "seed": 5, "method": "exact"}
    stored = tilescope.distributed.write(tilescope.Plane(**arguments), tmp_path / "set", rows=ROWS)
    assert len(stored.files) > 1 and stored.verify() == []
    assert stored.manifest["method"] == "exact"
    assert np.array_equal(stored.window(0, 0, 1, 1), tilescope.sample(**arguments).points)
    # Control: the folder does not go on with a plane of the other method.
    with pytest.raises(ValueError, match="has another set"):
        tilescope.distributed.write(tilescope.Plane(radius=0.008, seed=5), tmp_path / "set", rows=ROWS)


def test_a_plane_of_one_tile_is_its_own_neighbour(tmp_path):
    for boundary in BOUNDARIES:
        plane = tilescope.Plane(radius=0.02, boundary=boundary)
        stored = tilescope.distributed.write(plane, tmp_path / boundary)
        assert stored.manifest["grid"] == [1, 1]
        assert stored.verify() == []
        assert np.array_equal(stored.window(0, 0, 1, 1), tilescope.sample(radius=0.02, boundary=boundary).points)


def kill(process):
    """Kills a process, and waits until it is gone."""
    found = psutil.Process(process)
    os.kill(process, signal.SIGKILL)
    deadline = time.monotonic() + 30
    while found.is_running() and found.status() != psutil.STATUS_ZOMBIE:
        assert time.monotonic() < deadline, "the process does not end"
        time.sleep(0.01)


@slow
@pytest.mark.filterwarnings("default")
def test_twenty_million_samples_on_dask_though_a_worker_is_killed(tmp_path):
    from distributed import Client, LocalCluster

    arguments = {"radius": 1.866e-4, "seed": 11}
    plane = tilescope.Plane(**arguments)
    killed = {}
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        processes = client.run(os.getpid)
        assert len(processes) == 2

        def kill_a_worker(name, done, total):
            if done == 3:
                tasks = client.processing()
                worker = max(tasks, key=lambda address: len(tasks[address]))
                kill(processes[worker])
                killed.update(process=processes[worker], tasks=len(tasks[worker]), outstanding=total - done)

        stored = tilescope.distributed.write(plane, tmp_path / "dask", engine="dask", progress=kill_a_worker)
        client.wait_for_workers(2)
        assert killed["process"] not in client.run(os.getpid).values()
        assert stored.verify(positions=False, engine="dask") == []
    assert killed["tasks"] >= 1
    assert killed["outstanding"] == len(stored.files) - 3 > 10
    assert len(stored) > 19_900_000
    single = tilescope.distributed.write(plane, tmp_path / "local")
    assert stored.manifest == single.manifest
    shutil.rmtree(tmp_path / "local")
    shutil.rmtree(tmp_path / "dask")
    assert stored.digest == tilescope.distributed.digest(tilescope.sample(**arguments))


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("engine", ["dask", "ray"])
def test_a_cluster_is_started_where_there_is_none(engine, tmp_path):
    plane = tilescope.Plane(**parameters("bounded"))
    single = tilescope.distributed.write(plane, tmp_path / "local", rows=ROWS)
    stored = tilescope.distributed.write(plane, tmp_path / engine, engine=engine, rows=ROWS)
    assert stored.manifest == single.manifest


@slow
@pytest.mark.filterwarnings("default")
def test_two_million_samples_on_ray_though_a_worker_is_killed(tmp_path):
    import ray

    arguments = {"radius": 5.9e-4, "seed": 12, "boundary": "bounded"}
    plane = tilescope.Plane(**arguments)
    killed = []

    def kill_a_worker(name, done, total):
        if done >= 3 and not killed and done < total - 2:
            # Ray gives a worker the name of its task while it has one.
            children = psutil.Process().children(recursive=True)
            busy = [child for child in children if "_on_ray" in " ".join(child.cmdline())]
            if busy:
                kill(busy[0].pid)
                killed.append(total - done)

    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, configure_logging=False)
    try:
        stored = tilescope.distributed.write(plane, tmp_path / "ray", engine="ray", rows=50_000, progress=kill_a_worker)
        with pytest.raises(ValueError, match="judge is 'me'"):
            tilescope.distributed.write(plane, tmp_path / "refused", engine="ray", rows=50_000, judge="me")
    finally:
        ray.shutdown()
    assert len(killed) == 1
    assert len(stored) > 1_980_000
    single = tilescope.distributed.write(plane, tmp_path / "local", rows=50_000)
    assert stored.manifest == single.manifest
    assert stored.digest == tilescope.distributed.digest(tilescope.sample(**arguments), rows=50_000)


def test_examples_of_docstrings_and_of_the_page_run(tmp_path, monkeypatch):
    attempted = 0
    for name in ("tilescope.distributed", "tilescope.distributed._stored"):
        outcome = doctest.testmod(
            importlib.import_module(name),
            extraglobs={"tilescope": tilescope, "folder": tmp_path},
            optionflags=doctest.ELLIPSIS,
        )
        assert outcome.failed == 0, name
        attempted += outcome.attempted
    assert attempted >= 10
    (tmp_path / "page").mkdir()
    monkeypatch.chdir(tmp_path / "page")
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert len(blocks) >= 2
    names = {}
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), names)
