"""GeoParquet: points come back to the bit, as others write them too, and what is no plane set is refused."""

import importlib
import json
import struct

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import tilescope
import tilescope.distributed
from tilescope import _optional


def described(**column):
    """Metadata of GeoParquet with a column of points."""
    return {b"geo": json.dumps({"version": "1.1.0", "primary_column": "place", "columns": {"place": column}}).encode()}


def wkb(points, order="<", kind=1, extra=()):
    head = struct.pack(f"{order}BI", order == "<", kind)
    return [head + struct.pack(f"{order}{2 + len(extra)}d", *point, *extra) for point in points.tolist()]


def written(path, columns, metadata=None):
    pq.write_table(pa.table(columns).replace_schema_metadata(metadata), path)
    return path


def test_a_set_comes_back_to_the_bit(small, tmp_path):
    path = tmp_path / "set.parquet"
    assert small.save(path).valid
    assert [file.name for file in tmp_path.iterdir()] == ["set.parquet"]
    back = tilescope.read(path, 0.02)
    assert (back.digest, back.method, back.radius) == (small.digest, "unknown", 0.02)
    assert tilescope.verify(path, 0.02).passed
    assert tilescope.analyze(path, 0.02)["samples"] == len(small)
    # The first bytes say what a file is, before its name does.
    path.rename(tmp_path / "set.csv")
    assert tilescope.read(tmp_path / "set.csv").digest == small.digest
    small.save(tmp_path / "set", format="geoparquet")
    assert tilescope.read(tmp_path / "set").digest == small.digest
    assert tilescope.sample(radius=0.01, pattern=tilescope.read(tmp_path / "set", 0.02)).verify().valid


def test_others_can_read_it(small, tmp_path):
    small.save(tmp_path / "set.parquet", verify=False)
    table = pq.read_table(tmp_path / "set.parquet")
    assert table.column("geometry").to_pylist() == wkb(small.points)
    geo = json.loads(table.schema.metadata[b"geo"])
    column = geo["columns"][geo["primary_column"]]
    assert (column["encoding"], column["geometry_types"], column["crs"]) == ("WKB", ["Point"], None)
    assert column["bbox"] == [*small.points.min(axis=0), *small.points.max(axis=0)]


def test_the_ways_of_others_to_store_points_are_read(small, tmp_path):
    points, path = small.points, tmp_path / "set.parquet"
    x, y = points.T
    for columns, metadata in [
        ({"x": x, "y": y}, None),
        ({"name": ["a"] * len(x), "y": y, "x": x}, None),
        ({"geometry": wkb(points)}, None),
        ({"place": wkb(points)}, described(encoding="WKB", crs=None)),
        # Without a word on the coordinate system, and within the domain.
        ({"place": wkb(points)}, described(encoding="WKB")),
        ({"place": wkb(points), "x": y, "y": x}, described(encoding="WKB", crs={"type": "ProjectedCRS"})),
        ({"place": wkb(points, order=">")}, described(encoding="WKB", crs=None)),
        ({"place": wkb(points, kind=1001, extra=[0.0])}, described(encoding="WKB", crs=None)),
        ({"place": wkb(points, kind=0x80000001, extra=[0.0])}, described(encoding="WKB", crs=None)),
        ({"place": pa.array(wkb(points), pa.large_binary())}, described(encoding="WKB", crs=None)),
        ({"place": pa.array([{"x": a, "y": b} for a, b in points.tolist()])}, described(encoding="point", crs=None)),
        ({"place": pa.array([{"x": a, "y": b, "z": 0.0} for a, b in points.tolist()])}, described(encoding="point", crs=None)),
    ]:
        assert tilescope.read(written(path, columns, metadata)).digest == small.digest, (list(columns), metadata)
    stored = tilescope.distributed.write(tilescope.Plane(radius=0.02, seed=7), tmp_path / "tiles")
    assert tilescope.read(stored.files[0]).digest == small.digest


@pytest.mark.parametrize(
    ("columns", "metadata", "text"),
    [
        ({"lon": [1.0], "lat": [2.0]}, None, r"has the columns \['lon', 'lat'\]; it must have 'x' and 'y'"),
        ({"x": [0.5, None], "y": [0.5, 0.5]}, None, "1 rows without a value in the column 'x'"),
        ({"x": ["0.5"], "y": [0.5]}, None, "values of the type string in the column 'x'; they must be numbers"),
        ({"geometry": ["POINT (0 0)"]}, None, "the type string in the column 'geometry'; it must be points"),
        ({"geometry": [b"\1\3\0\0\0\0\0\0\0"]}, None, "has a Polygon in row 0; only points can be read"),
        ({"geometry": [b"\1\1\0\0\0"]}, None, "has no point in row 0"),
        ({"geometry": [b""]}, None, "has no point in row 0"),
        ({"geometry": wkb(np.array([[0.5, 0.5]]), kind=1001, extra=[3.0])}, None, "points in space, whose z is not 0"),
        ({"place": pa.array([{"x": 0.5, "y": 0.5, "z": 1.0}])}, described(encoding="point", crs=None), "points in space"),
        (
            {"place": wkb(np.array([[0.5, 0.5]]))},
            described(encoding="WKB", crs={"type": "GeographicCRS"}),
            "has longitudes and latitudes.*project them first",
        ),
        ({"place": wkb(np.array([[11.5, 48.1]]))}, described(encoding="WKB"), "has longitudes and latitudes"),
    ],
)
def test_what_is_no_plane_set_is_refused(columns, metadata, text, tmp_path):
    written(tmp_path / "set.parquet", columns, metadata)
    for call in (tilescope.read, tilescope.analyze, lambda path: tilescope.verify(path, 0.1)):
        with pytest.raises(ValueError, match=text):
            call(tmp_path / "set.parquet")


def test_map_coordinates_without_a_system_are_read(tmp_path):
    # Beyond 180 and 90 they are no degrees.
    written(tmp_path / "set.parquet", {"place": wkb(np.array([[500.0, 700.0]]))}, described(encoding="WKB"))
    assert tilescope.read(tmp_path / "set.parquet", width=1000, height=1000).points.tolist() == [[500, 700]]


def test_damaged_files_are_refused(small, tmp_path):
    small.save(tmp_path / "set.parquet")
    data = (tmp_path / "set.parquet").read_bytes()
    for damaged in (data[:100], data[:-100], b"PAR1", data[:2000] + bytes([data[2000] ^ 1]) + data[2001:]):
        (tmp_path / "damaged.parquet").write_bytes(damaged)
        with pytest.raises(ValueError, match="damaged"):
            tilescope.read(tmp_path / "damaged.parquet")


def test_what_geoparquet_cannot_hold_is_refused(small, holed, tmp_path):
    for arguments in ({"precision": "f32"}, {"shuffle": 3}):
        with pytest.raises(ValueError, match="GeoParquet is written with precision 'f64' and without shuffle"):
            small.save(tmp_path / "set.parquet", **arguments)
    with pytest.raises(ValueError, match="the radius of the set is not known"):
        tilescope.PointSet(small.points).save(tmp_path / "set.parquet")
    assert list(tmp_path.iterdir()) == []
    with pytest.warns(UserWarning, match="the written set is not maximal"):
        assert not holed.save(tmp_path / "holed.parquet").valid


def test_without_pyarrow_the_error_says_so(small, tmp_path, monkeypatch):
    small.save(tmp_path / "set.parquet")

    def found(name):
        if name.split(".")[0] == "pyarrow":
            raise ImportError(name)
        return importlib.import_module(name)

    monkeypatch.setattr(_optional, "import_module", found)
    for call in (lambda: tilescope.read(tmp_path / "set.parquet"), lambda: small.save(tmp_path / "b.parquet")):
        with pytest.raises(ImportError, match=r"needs pyarrow.*: pip install 'tilescope\[parquet\]'"):
            call()
    assert not (tmp_path / "b.parquet").exists()


def test_a_stipple_is_judged_as_the_first_dots_of_a_few_more(tmp_path):
    ramp = np.linspace(0, 255, 60).astype(np.uint8)[None, :].repeat(60, axis=0)
    dots = tilescope.stipple(ramp, dots=300)
    assert dots.made > 300
    report = dots.save(tmp_path / "dots.parquet")
    assert report.valid and report.covering_factor == dots.verify().covering_factor
