"""A radius that varies and shapes: the sets of the command line, their verdicts, their files and pictures."""

import copy
import importlib.util
import json
import math
import os
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import tilescope

PROGRAM = os.environ.get("TILESCOPE")
needs_program = pytest.mark.skipif(PROGRAM is None, reason="TILESCOPE names no program")
X0, Y0 = 500_000.0, 5_400_000.0
PARK = {
    "type": "Polygon",
    "coordinates": [
        [[X0, Y0], [X0 + 60, Y0 + 5], [X0 + 45, Y0 + 40], [X0 + 5, Y0 + 30], [X0, Y0]],
        [[X0 + 20, Y0 + 10], [X0 + 35, Y0 + 12], [X0 + 30, Y0 + 25], [X0 + 20, Y0 + 10]],
    ],
}


def ramp(x, y):
    return 0.01 + 0.04 * x + 0.0 * y


def photo(rows=40, columns=60):
    """Grey values of 16 bits, the row of the lowest y first."""
    y, x = np.mgrid[0:rows, 0:columns]
    return (65_535 * (0.1 + 0.8 * x / columns * y / rows)).astype(np.uint16)


def island(size=40):
    y, x = np.mgrid[0:size, 0:size] - (size - 1) / 2
    return x**2 + y**2 < (0.45 * size) ** 2


def saved_png(path, grey):
    """Writes an image, whose rows begin at the top."""
    Image.fromarray(np.flipud(grey)).save(path)
    return path


def run(*words, code=0):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def slope() -> tilescope.PointSet:
    return tilescope.sample(radius=ramp, seed=3)


@pytest.fixture(scope="module")
def trees() -> tilescope.PointSet:
    return tilescope.sample(radius=1.5, shape=PARK)


@needs_program
def test_sets_are_those_of_the_command_line(slope, trees, tmp_path):
    (tmp_path / "park.geojson").write_text(json.dumps(PARK))
    grey = saved_png(tmp_path / "grey.png", photo())
    mask = saved_png(tmp_path / "mask.png", island().astype(np.uint8) * 255)
    density = {"density": 65_535 - photo()}
    for made, words in [
        (slope, ["--radius-expression", "0.01 + 0.04*x + 0.0*y", "--seed", 3]),
        (tilescope.sample(radius_expression="0.01 + 0.04*x", seed=3), ["--radius-expression", "0.01 + 0.04*x", "--seed", 3]),
        (tilescope.sample(700, radius=ramp), ["--radius-expression", "0.01 + 0.04*x + 0.0*y", "--count", 700]),
        (
            tilescope.sample(radius=lambda x, y: 0.02 + 0.01 * y, width=2, boundary="periodic"),
            ["--radius-expression", "0.02 + 0.01*y", "--width", 2, "--boundary", "periodic"],
        ),
        (tilescope.sample(radius=0.01, **density), ["--density-image", grey, "--radius", 0.01]),
        (tilescope.sample(800, **density), ["--density-image", grey, "--count", 800]),
        (tilescope.sample(800, density=grey), ["--density-image", grey, "--count", 800]),
        (tilescope.sample(radius=0.03, mask=island()), ["--mask", mask, "--radius", 0.03]),
        (
            tilescope.sample(radius=lambda x, y: 0.02 + 0.03 * y, mask=mask, seed=5),
            ["--mask", mask, "--radius-expression", "0.02 + 0.03*y", "--seed", 5],
        ),
        (trees, ["--shape", tmp_path / "park.geojson", "--radius", 1.5]),
        (
            tilescope.sample(radius=lambda x, y: 1 + 0.05 * (x - X0), shape=PARK),
            ["--shape", tmp_path / "park.geojson", "--radius-expression", f"1 + 0.05 * (x - {X0})"],
        ),
        (
            tilescope.sample(radius=1.5, shape=PARK, extent=(X0 + 10, Y0, X0 + 40, Y0 + 30)),
            ["--shape", tmp_path / "park.geojson", "--radius", 1.5, "--origin", X0 + 10, Y0, "--width", 30, "--height", 30],
        ),
    ]:
        made_there = json.loads(run("sample", *words, "--json"))
        assert (made_there["positions_digest"], made_there["count"]) == (made.digest, len(made)), words
        assert made.verify().valid


def test_an_array_has_the_radii_of_pixels():
    halves = np.repeat([[0.01, 0.04]], 20, axis=1).repeat(20, axis=0)
    made = tilescope.sample(radius=halves, width=2)
    assert made.domain == (2.0, 1.0, "bounded")
    left = (made.points[:, 0] < 0.9).sum()
    assert left > 10 * (made.points[:, 0] > 1.1).sum() > 0
    assert sorted({round(r, 4) for r in made.radii.tolist()})[::1][0] == 0.01
    low = tilescope.sample(radius=np.linspace(0.01, 0.05, 30)[:, None].repeat(30, axis=1))
    assert (low.points[:, 1] < 0.5).sum() > 3 * (low.points[:, 1] > 0.5).sum()
    assert tilescope.verify(made.points, halves, width=2).valid


def test_a_density_says_how_many_there_are():
    dense = np.array([[1.0, 4.0]]).repeat(10, axis=1).repeat(20, axis=0)
    made = tilescope.sample(2000, density=dense)
    share = (made.points[:, 0] > 0.5).mean()
    assert abs(len(made) - 2000) <= 20
    assert 0.78 < share < 0.82
    assert made.parameters["density-grid"]["columns"] == 21
    again = tilescope.verify(made.points, made.parameters["density-grid"]["scale"], density=dense)
    assert again.valid
    assert again.judges == ("subdivision",)
    empty = tilescope.sample(500, density=np.array([[0.0, 1.0]]).repeat(10, axis=1).repeat(20, axis=0))
    assert (empty.points[:, 0] > 0.45).mean() > 0.9


def test_each_sample_has_its_radius(slope, trees, small):
    assert slope.radii.shape == (len(slope),)
    assert not slope.radii.flags.writeable
    assert np.abs(slope.radii - ramp(*slope.points.T)).max() < 1e-6
    assert slope.radius == pytest.approx(0.01)
    assert set(trees.radii.tolist()) == {1.5}
    assert (small.radii == small.radius).all()
    assert tilescope.PointSet(small.points).radii is None
    assert repr(slope) == f"<PointSet: {len(slope)} samples, radius 0.01 to 0.05, 1 x 1, bounded>"
    assert repr(trees) == f"<PointSet: {len(trees)} samples, radius 1.5, 60 x 40, bounded, in a shape>"


def test_what_is_not_valid_is_found(slope, trees):
    for made, field in ((slope, {"radius": ramp}), (trees, {"radius": 1.5, "shape": PARK})):
        positions = made.points + made.origin
        assert tilescope.verify(positions, **field).valid
        fewer = tilescope.verify(np.delete(positions, 40, axis=0), **field)
        assert (fewer.valid, fewer.conflicts) == (False, 0)
        assert fewer.gaps > 0
        more = tilescope.verify([*positions.tolist(), (positions[40] + 1e-3).tolist()], **field)
        assert more.conflicts > 0
    denser = tilescope.verify(slope, radius=lambda x, y: 1.1 * ramp(x, y))
    assert denser.conflicts > 0
    with pytest.raises(ValueError, match="lies outside the shape"):
        tilescope.verify(tilescope.sample(radius=0.05, boundary="bounded"), 0.05, mask=island())
    with pytest.raises(ValueError, match="the judge circles knows of no radius that varies"):
        slope.verify(judge="circles")


def test_copies_have_the_field(slope, trees):
    for made in (slope, trees):
        for other in (copy.copy(made), copy.deepcopy(made), pickle.loads(pickle.dumps(made))):
            assert other.verify().valid
            assert np.array_equal(other.radii, made.radii)
            assert (other.digest, other.origin, repr(other)) == (made.digest, made.origin, repr(made))


@pytest.mark.parametrize("name", ["set.csv", "set.ply", "set.npy", "set.json", "set.geojson"])
def test_files_come_back_and_functions_must_be_given_again(slope, name, tmp_path):
    path = tmp_path / name
    assert slope.save(path).valid
    assert path.with_name(f"{name}.certificate.json").exists()
    for call in (tilescope.read, tilescope.verify):
        with pytest.raises(ValueError, match="a field from an array or a function, .*: radius=the same array or function"):
            call(path)
        with pytest.raises(ValueError, match="width is that of the certificate"):
            call(path, ramp, width=1)
    back = tilescope.read(path, ramp)
    assert (back.digest, back.method, back.domain) == (slope.digest, "reference", slope.domain)
    assert np.array_equal(back.radii, slope.radii)
    assert back.verify().valid
    assert tilescope.verify(path, ramp).passed
    assert tilescope.verify(path, radius_expression="0.01 + 0.04*x + 0*y").passed
    report = tilescope.verify(path, lambda x, y: 1.01 * ramp(x, y))
    assert not report.passed
    assert report.differences[0].startswith("radius: ")
    with pytest.raises(ValueError, match="its certificate is not true: radius"):
        tilescope.read(path, lambda x, y: 1.01 * ramp(x, y))
    assert tilescope.read(path, certificate=False).digest == slope.digest


def test_formulas_and_polygons_are_in_the_certificate(trees, tmp_path):
    assert trees.save(tmp_path / "trees.csv").valid
    back = tilescope.read(tmp_path / "trees.csv")
    assert (back.origin, back.verify().valid, repr(back)) == ((X0, Y0), True, repr(trees))
    assert np.abs(back.points - trees.points).max() < 1e-8
    assert tilescope.verify(tmp_path / "trees.csv").passed
    assert "shape" not in back.parameters
    formula = tilescope.sample(radius_expression="0.03 + 0.02*y", mask=island())
    formula.save(tmp_path / "formula.npy")
    with pytest.raises(ValueError, match="a mask from an array, which must be given to judge the set: mask=the same array"):
        tilescope.read(tmp_path / "formula.npy")
    assert tilescope.read(tmp_path / "formula.npy", mask=island()).verify().valid
    with pytest.raises(ValueError, match="outside the shape|shape: the certificate states a mask"):
        tilescope.read(tmp_path / "formula.npy", mask=np.pad(island(38), 1))
    with pytest.raises(ValueError, match=r"origin is \(0.0, 0.0\), but the set's field or shape lies at"):
        trees.save(tmp_path / "moved.csv", origin=(0, 0))
    with pytest.raises(ValueError, match="varies or it covers a shape, which analyze does not"):
        tilescope.analyze(tmp_path / "trees.csv")
    with pytest.raises(ValueError, match="varies or it covers a shape, which a pattern"):
        tilescope.sample(radius=0.05, pattern=trees)
    # Positions of others, in the coordinates of the shape.
    np.savetxt(tmp_path / "theirs.csv", trees.points + trees.origin, delimiter=",", header="x,y", comments="", fmt="%.17g")
    assert tilescope.verify(tmp_path / "theirs.csv", 1.5, shape=PARK).valid
    theirs = tilescope.read(tmp_path / "theirs.csv", 1.5, shape=PARK)
    assert (theirs.origin, theirs.verify().valid) == ((X0, Y0), True)


@needs_program
def test_files_go_to_the_command_line_and_come_from_there(trees, tmp_path):
    grey = saved_png(tmp_path / "grey.png", photo())
    made = tilescope.sample(800, density=65_535 - photo())
    made.save(tmp_path / "made.csv")
    # An image with the same pixels stands for the array.
    assert "certificate    true" in run("verify", tmp_path / "made.csv", "--density-image", grey)
    trees.save(tmp_path / "trees.ply")
    assert "certificate    true" in run("verify", tmp_path / "trees.ply")
    path = tmp_path / "theirs.csv"
    run("sample", "--radius-image", grey, "--radius", "0.01..0.05", "--out", path)
    with pytest.raises(ValueError, match=r"a field from grey.png.*: radius=pathlib.Path\(\"grey.png\"\)"):
        tilescope.read(path)
    back = tilescope.read(path, grey)
    assert back.verify().valid
    assert np.abs(back.radii - np.genfromtxt(path, delimiter=",", skip_header=1)[:, 2]).max() == 0
    with pytest.raises(ValueError, match="which is for sets whose certificate states the radii"):
        tilescope.sample(radius=grey)
    run("sample", "--density-image", grey, "--count", 500, "--out", tmp_path / "stipple.npy")
    assert tilescope.verify(tmp_path / "stipple.npy", density=grey).passed
    assert tilescope.verify(tmp_path / "stipple.npy", density=65_535 - photo()).passed


REFUSED = [
    ({"radius": np.zeros((3, 3))}, r"the radius is 0 at \(0, 0\); it must be above 0"),
    ({"radius": lambda x, y: 0.3 * x}, r"the radius is 0 at \(0, 0\)"),
    ({"radius": lambda x, y: 0.001 + x}, "1001.0 times as much; at most"),
    ({"radius": lambda x, y: x[0]}, r"radius returned the shape \(1025,\) for \(1025, 1025\)"),
    ({"radius": np.full(3, 0.1)}, r"radius has the shape \(3,\); it must be \(rows, columns\)"),
    ({"radius": np.full((3, 4), 0.1), "width": 1, "height": 1}, "4 x 3 pixels do not fit a domain of 1 x 1"),
    ({"radius": np.full((3, 4), 0.1), "mask": island()}, "one image has 4 x 3 pixels and the other 40 x 40"),
    ({"radius": ramp, "density": np.ones((3, 3))}, "both radius and density are given, and each says the radius"),
    ({"radius": 0.1, "mask": island(), "shape": PARK}, "both mask and shape are given, and each says what to cover"),
    ({"radius": 0.1, "radius_expression": "0.1"}, "both radius and radius_expression are given"),
    ({"radius_expression": "0.1*"}, "the expression cannot be read at character"),
    ({"count": 100, "radius": 0.1, "mask": island()}, "both count and radius are given"),
    ({"mask": island()}, "a shape or a mask is given without count or radius"),
    ({"density": np.ones((3, 3))}, "density is given without count or radius"),
    ({"count": 9, "density": np.zeros((3, 3))}, "the density is 0 everywhere"),
    ({"count": 9, "density": [[1, -2]]}, "the density is -2 in column 1 of row 0"),
    ({"radius": ramp, "method": "kdrt"}, "method is given with radius, which needs the reference sampler"),
    ({"radius": ramp, "leaf": 20}, "leaf is given with radius"),
    ({"radius": ramp, "method": "exact"}, "method is given with radius"),
    ({"radius": 0.1, "shape": PARK, "leaf": 20}, "leaf is given with shape"),
    ({"radius": 0.1, "shape": PARK, "method": "exact", "order": "random"}, "order is given with shape"),
    ({"radius": 0.1, "shape": PARK, "method": "exact", "leaf": 2}, "the leaf is 2"),
    ({"radius": 0.1, "mask": island(), "levels": 2}, "levels is given with mask"),
    ({"radius": 0.1, "shape": PARK, "engine": "parallel"}, "engine is given with shape"),
    ({"radius": 0.1, "extent": (0, 0, 1, 1), "width": 2}, "extent is given with width, height or origin"),
    ({"radius": 0.1, "extent": (0, 0, 0, 1)}, r"extent is \(0, 0, 0, 1\); it must be"),
    ({"radius": 0.1, "planar": True}, "planar is given without shape"),
    ({"radius": 0.01, "shape": {"type": "Point", "coordinates": [1, 2]}}, "shape: GeoJSON Point has no area"),
    ({"radius": 0.01, "shape": '{"type": "Polygon", "coordinates": [[[8, 47], [9, 47], [8, 48]]]}'}, "planar=True takes them"),
]  # fmt: skip


@pytest.mark.parametrize("shape", [{"shape": PARK}, {"mask": island()}], ids=["polygon", "mask"])
def test_shapes_are_tiled_exactly(shape):
    radius = 0.02 if "mask" in shape else 1
    blocks = {"method": "exact", "leaf": 8, "pattern_side": 40}
    tiled = tilescope.sample(radius=radius, **shape, **blocks)
    assert tiled.verify().valid and tiled.method == "exact"
    assert tiled.parameters["leaf"] == 8 and tiled.parameters["pattern"]["side"] == 40
    thrown = tilescope.sample(radius=radius, **shape)
    assert thrown.method == "reference" and not np.array_equal(tiled.points, thrown.points)
    # Control: one sample less. Positions in an array are at the shape's coordinates.
    corner = (X0, Y0) if "shape" in shape else (0, 0)
    assert not tilescope.verify(tiled.points[1:] + corner, radius, **shape).valid


@pytest.mark.parametrize(("arguments", "text"), REFUSED, ids=[text for _, text in REFUSED])
def test_what_cannot_be_made_is_refused_with_value_and_limit(arguments, text):
    with pytest.raises(ValueError, match=text):
        tilescope.sample(**arguments)


def test_other_types_are_refused():
    for arguments, text in [
        ({"radius": 0.1, "mask": np.ones((3, 3))}, "mask has values of the type float64; they must be True or False"),
        ({"radius": 0.1, "shape": 7}, "shape is 7; it must be a geometry"),
        ({"radius_expression": 0.1}, "radius_expression is 0.1; it must be text"),
        ({"radius": np.full((3, 3), 1j)}, "radius has complex numbers"),
        ({"radius": lambda x, y: "a"}, "the result of radius has values of the type"),
    ]:
        with pytest.raises(TypeError, match=text):
            tilescope.sample(**arguments)
    with pytest.raises(ZeroDivisionError):
        tilescope.sample(radius=lambda x, y: 1 / 0)
    with pytest.raises(FileNotFoundError):
        tilescope.sample(radius=0.1, shape="no-such.geojson")
    with pytest.raises(FileNotFoundError):
        tilescope.sample(radius=0.1, mask="no-such.png")


def test_shapes_come_in_every_form(trees, tmp_path):
    path = tmp_path / "park.geojson"
    path.write_text(json.dumps(PARK))

    class Geometry:
        __geo_interface__ = {"type": "Polygon", "coordinates": tuple(map(tuple, PARK["coordinates"]))}

    for shape in (json.dumps(PARK), path, str(path), Geometry(), {"type": "Feature", "geometry": PARK, "properties": {}}):
        made = tilescope.sample(radius=1.5, shape=shape)
        assert made.digest == trees.digest
        assert ("shape" in made.parameters) == (shape in (path, str(path)))
    town = {"type": "Polygon", "coordinates": [[[8, 47], [9, 47], [8, 48]]]}
    assert tilescope.sample(radius=0.1, shape=town, planar=True).verify().valid

    class Frame:
        def __init__(self, geographic):
            self.__geo_interface__ = town
            self.crs = type("System", (), {"is_geographic": geographic, "is_projected": not geographic})

    assert tilescope.sample(radius=0.1, shape=Frame(geographic=False)).verify().valid
    with pytest.raises(ValueError, match="longitudes and latitudes.*estimate_utm_crs"):
        tilescope.sample(radius=0.1, shape=Frame(geographic=True))


@pytest.mark.skipif(importlib.util.find_spec("shapely") is None, reason="shapely is not installed")
def test_geometries_of_shapely_are_shapes(trees):
    shapely = importlib.import_module("shapely.geometry")
    assert tilescope.sample(radius=1.5, shape=shapely.shape(PARK)).digest == trees.digest


@pytest.mark.skipif(importlib.util.find_spec("geopandas") is None, reason="geopandas is not installed")
def test_frames_of_geopandas_are_shapes(trees, tmp_path):
    geopandas = importlib.import_module("geopandas")
    frame = geopandas.GeoDataFrame.from_features([{"type": "Feature", "geometry": PARK, "properties": {}}], crs=32632)
    assert tilescope.sample(radius=1.5, shape=frame).digest == trees.digest
    trees.save(tmp_path / "trees.parquet")
    assert len(geopandas.read_parquet(tmp_path / "trees.parquet")) == len(trees)


def test_geojson_and_geoparquet_have_places_and_radii(slope, trees, tmp_path):
    slope.save(tmp_path / "slope.geojson")
    features = json.loads((tmp_path / "slope.geojson").read_text())["features"]
    assert [one["properties"]["radius"] for one in features] == slope.radii.tolist()
    assert [one["geometry"]["coordinates"] for one in features] == slope.points.tolist()
    trees.save(tmp_path / "trees.geojson")
    features = json.loads((tmp_path / "trees.geojson").read_text())["features"]
    assert features[0]["properties"] == {}
    assert features[0]["geometry"]["coordinates"] == (trees.points + trees.origin)[0].tolist()
    parquet = pytest.importorskip("pyarrow.parquet")
    slope.save(tmp_path / "slope.parquet")
    assert parquet.read_table(tmp_path / "slope.parquet").column("radius").to_pylist() == slope.radii.tolist()
    assert tilescope.verify(tmp_path / "slope.parquet", ramp).valid
    assert trees.save(tmp_path / "trees.parquet").valid
    back = tilescope.read(tmp_path / "trees.parquet", 1.5, shape=PARK)
    assert (back.origin, back.verify().valid) == ((X0, Y0), True)
    assert "radius" not in parquet.read_table(tmp_path / "trees.parquet").column_names


def test_pictures_have_a_disk_of_its_own_radius_for_each_sample(slope, trees, tmp_path):
    figure = importlib.import_module("matplotlib.figure").Figure()
    axes = slope.plot(figure.add_subplot(), disks=True)
    assert np.allclose(axes.collections[0].get_widths(), 2 * slope.radii)
    slope.draw(tmp_path / "slope.svg")
    text = (tmp_path / "slope.svg").read_text()
    assert "r = 0.01 to 0.05" in text
    assert slope._repr_png_().startswith(b"\x89PNG")
    trees.draw(tmp_path / "trees.png", size=400)
    assert Path(tmp_path / "trees.png").stat().st_size > 1000


@pytest.mark.parametrize(
    ("given", "corners"),
    [
        ({"radius": ramp}, (0.2, 0.3, 0.7, 0.75)),
        ({"radius_expression": "0.03 + 0.02*y", "boundary": "periodic", "width": 1, "height": 1}, (0.1, 0.2, 0.6, 0.9)),
        ({"radius": 1.5, "shape": PARK}, (3, 2, 41, 27)),
    ],
)
def test_windows_of_fields_and_shapes_are_parts_of_the_whole(given, corners):
    whole = tilescope.sample(seed=4, **given)
    plane = tilescope.FieldPlane(seed=4, **given)
    assert (plane.origin, plane.domain) == (whole.origin, whole.domain)
    x0, y0, x1, y1 = corners
    x, y = whole.points.T
    inside = (x >= x0) & (x < x1) & (y >= y0) & (y < y1)
    part = plane.window(*corners)
    assert len(part) > 30 and np.array_equal(part, whole.points[inside]) and not part.flags.writeable
    assert plane.is_valid(*corners) and plane.parameters == whole.parameters
    assert not np.array_equal(tilescope.FieldPlane(seed=5, **given).window(*corners), part)


def test_impossible_windows_of_fields_are_refused():
    plane = tilescope.FieldPlane(radius_expression="0.01 + 0.01*x")
    with pytest.raises(ValueError, match="holds no place of the domain, 1 x 1 from 0 0 on"):
        plane.window(2, 0, 2.5, 1)
    with pytest.raises(ValueError, match="the window's width"):
        plane.window(0, 0, 1.5, 1)
    with pytest.raises(ValueError, match="may have 2e8"):
        tilescope.FieldPlane(radius_expression="4e-5 + 1e-9*x").window(0, 0, 1, 1)
    with pytest.raises(ValueError, match=r"tilescope\.Plane has such windows"):
        tilescope.FieldPlane(radius=0.1)


def test_shapes_without_places_are_refused_in_words():
    empty = {"type": "FeatureCollection", "features": [], "bbox": [math.nan] * 4}
    with pytest.raises(ValueError, match="polygon"):
        tilescope.sample(radius=2, shape=empty)
    corners = [[0, 0], [900, 0], [900, math.inf], [0, 0]]
    with pytest.raises(ValueError, match="a coordinate that is not finite"):
        tilescope.sample(radius=2, shape={"type": "Polygon", "coordinates": [corners]})


def test_the_report_of_a_field_says_nothing_that_was_not_measured():
    made = tilescope.sample(radius=lambda x, y: 0.04 + 0.04 * x)
    assert repr(made.verify()) == f"<Report: valid, {len(made)} samples, 0 conflicts, 0 gaps, by subdivision>"
