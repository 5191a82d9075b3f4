"""Sets in space: arrays of shape (N, 3), verified, saved, and refused by name."""

import importlib
import json
import os
import pickle
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import plyfile
import pytest
from matplotlib import pyplot
from scipy.spatial import Delaunay, cKDTree

import tilescope

PROGRAM = os.environ.get("TILESCOPE")


@pytest.fixture(scope="module")
def balls():
    return tilescope.sample(size=(5, 6, 7), radius=1, seed=3)


@pytest.mark.parametrize("boundary", ["periodic", "bounded"])
def test_sets_are_made_and_verified(boundary):
    balls = tilescope.sample(size=(5, 6, 7), radius=1, boundary=boundary)
    assert balls.points.shape == (len(balls), 3) and not balls.points.flags.writeable
    assert (balls.size, balls.radius, balls.boundary, balls.made) == ((5, 6, 7), 1, boundary, None)
    report = balls.verify()
    assert report.valid and report.judges == ("subdivision", "circles")
    for judge in ("subdivision", "circles", "both"):
        assert balls.verify(judge=judge).valid
    # The smallest distance, by numpy alone.
    apart = np.abs(balls.points[:, None] - balls.points[None])
    if boundary == "periodic":
        apart = np.minimum(apart, np.array(balls.size) - apart)
    distances = np.sqrt((apart**2).sum(axis=-1))[~np.eye(len(balls), dtype=bool)]
    assert report.min_distance == pytest.approx(distances.min(), rel=1e-12)


def test_planted_faults_are_seen(balls):
    fewer = tilescope.SolidSet(balls.points[1:], 1, balls.size)
    report = fewer.verify()
    assert report.conflict_free and not report.maximal and report.worst_gaps
    beside = balls.points[:1] + np.where(balls.points[:1] < 2.5, 0.3, -0.3)
    more = tilescope.SolidSet(np.vstack([balls.points, beside]), 1, balls.size)
    report = more.verify()
    assert report.maximal and not report.conflict_free


def judged_by_scipy(points, size):
    """The smallest distance of points in a periodic box, and how far the farthest place is from all of them, by scipy alone.

    The farthest places are vertices of the Voronoi diagram: centres of the spheres around tetrahedra of Delaunay's
    triangulation. Of points and images the tetrahedra of centres in the box are those of the torus, as long as their spheres
    reach no farther than the images, which is 2.
    """
    size = np.array(size)
    steps = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 1, 3)
    images = (points + steps * size).reshape(-1, 3)
    images = images[((images >= -2) & (images < size + 2)).all(axis=1)]

    corners = images[Delaunay(images).simplices]
    first, edges = corners[:, 0], corners[:, 1:] - corners[:, :1]
    # Flat ones have no centre. At the hull qhull makes some; their neighbours have those of the box.
    solid = np.abs(np.linalg.det(edges)) > 1e-9
    first, edges = first[solid], edges[solid]
    # The centre is as far from each end of an edge: 2 e . c = e . e, from the first corner on.
    to_centre = np.linalg.solve(2 * edges, (edges**2).sum(axis=-1)[..., None])[..., 0]
    centres = first + to_centre
    inside = ((centres >= 0) & (centres < size)).all(axis=1)

    nearest = cKDTree(points, boxsize=size).query(points, k=2)[0][:, 1]
    return nearest.min(), np.linalg.norm(to_centre[inside], axis=1).max()


@pytest.mark.parametrize("seed", range(20))
def test_scipy_finds_sets_valid_and_planted_faults(seed):
    size = (6, 7, 8) if seed else (14, 15, 16)
    balls = tilescope.sample(size=size, radius=1, seed=seed)
    report = balls.verify()
    least, farthest = judged_by_scipy(balls.points, size)
    assert least > 1 and farthest <= 1 + 2**-15
    assert least == pytest.approx(report.min_distance, rel=1e-12)
    assert farthest == pytest.approx(report.covering_radius, rel=1e-8)

    # Controls: a place that only one sample covers is bare without it, and a sample that moves to another is too near.
    _, bare = judged_by_scipy(balls.points[1:], size)
    assert bare > 1 + 2**-15
    moved = balls.points.copy()
    nearest = cKDTree(moved, boxsize=size).query(moved[0], k=2)[1][1]
    way = moved[nearest] - moved[0]
    way -= np.round(way / size) * size
    moved[0] = np.mod(moved[0] + 0.5 * way, size)
    near, _ = judged_by_scipy(moved, size)
    assert near < 1


def test_numbers_of_samples_are_met():
    assert abs(len(tilescope.sample(1000, size=(1, 1, 1))) - 1000) <= 10
    exact = tilescope.sample(size=(1, 1, 1), exactly=777)
    report = exact.verify()
    assert len(exact) == 777 < exact.made
    assert report.valid and not report.maximal and 1 <= report.covering_factor < 1.6


def test_plots_show_all_samples_in_their_box(balls):
    ax = balls.plot()
    x, y, z = ax.collections[0]._offsets3d
    assert np.array_equal(np.column_stack([x, y, z]), balls.points)
    assert (ax.get_xlim(), ax.get_ylim(), ax.get_zlim()) == ((0, 5), (0, 6), (0, 7))
    assert balls.plot(ax) is ax
    pyplot.close("all")
    with pytest.raises(TypeError, match="three dimensions"):
        balls.plot(pyplot.gca())
    pyplot.close("all")


@pytest.mark.parametrize("name", ["set.ply", "set.npy", "set.csv", "set.xyz", "set.bin", "set.dat"])
def test_files_are_saved_and_verified(balls, name, tmp_path):
    path = tmp_path / name
    assert balls.save(path).valid
    assert tilescope.verify_solid(path).passed
    again = tilescope.read_solid(path)
    assert np.allclose(again.points, balls.points, rtol=0, atol=1e-12)
    assert (again.size, again.radius, again.method) == (balls.size, balls.radius, "reference")
    with pytest.raises(ValueError, match="third side"):
        tilescope.verify(path)
    with pytest.raises(ValueError, match="third side"):
        tilescope.read(path)
    # The control: a certificate of another set is not true.
    beside = tmp_path / f"{name}.certificate.json"
    stated = json.loads(beside.read_text())
    beside.write_text(json.dumps({**stated, "count": stated["count"] + 1}))
    assert not tilescope.verify_solid(path).passed


@pytest.mark.parametrize("name", ["set.ply", "set.csv"])
def test_files_say_when_each_sample_arrived(balls, name, tmp_path):
    assert np.array_equal(balls.arrival, np.arange(len(balls))) and not balls.level.flags.writeable
    assert balls.level[0] == 0 < balls.level[-1] <= 15 and (np.diff(balls.level.astype(int)) >= 0).all()

    # Columns stay with their samples when these are shuffled.
    balls.save(tmp_path / name, shuffle=5)
    again = tilescope.read_solid(tmp_path / name)
    assert not np.array_equal(again.arrival, balls.arrival)
    assert np.array_equal(again.points, balls.points[again.arrival])
    assert np.array_equal(again.level, balls.level[again.arrival])
    # And so they do in a file of a set that was read.
    again.save(tmp_path / f"again-{name}")
    assert (tmp_path / f"again-{name}").read_bytes() == (tmp_path / name).read_bytes()

    if name == "set.ply":
        read = plyfile.PlyData.read(tmp_path / name)["vertex"]
        assert [kind for _, kind in read.data.dtype.descr] == ["<f8", "<f8", "<f8", "<i4", "<i4"]
        columns = [read["arrival"], read["level"]]
    else:
        table = np.genfromtxt(tmp_path / name, delimiter=",", names=True)
        assert table.dtype.names == ("x", "y", "z", "arrival", "level")
        columns = [table["arrival"], table["level"]]
    assert np.array_equal(columns, [again.arrival, again.level])


def test_sets_of_others_have_no_arrival(balls, tmp_path):
    bare = tilescope.SolidSet(balls.points, 1, balls.size)
    assert bare.arrival is None and bare.level is None
    bare.save(tmp_path / "bare.csv")
    assert tilescope.read_solid(tmp_path / "bare.csv").level is None
    # Nor have files without columns, of which the program says so where it prints.
    balls.save(tmp_path / "set.npy")
    assert tilescope.read_solid(tmp_path / "set.npy").arrival is None


def read_by_plyfile(path):
    vertices = plyfile.PlyData.read(path)["vertex"]
    return np.column_stack([vertices["x"], vertices["y"], vertices["z"]])


def read_by_open3d(path):
    return np.asarray(importlib.import_module("open3d").io.read_point_cloud(str(path)).points)


def read_by_pyvista(path):
    return np.asarray(importlib.import_module("pyvista").read(path).points)


@pytest.mark.parametrize(
    ("program", "read", "digits"),
    [
        ("plyfile", read_by_plyfile, 0),
        ("open3d", read_by_open3d, 0),
        # VTK reads doubles as floats.
        ("pyvista", read_by_pyvista, 1e-7),
    ],
)
def test_programs_of_others_read_ply(program, read, digits, tmp_path):
    # One that is installed may lack a library of the system. The reason to skip names it.
    pytest.importorskip(program, exc_type=ImportError)
    # With a radius of 1 positions have few digits, which floats would hold, too.
    balls = tilescope.sample(size=(0.5, 0.6, 0.7), radius=0.1, seed=3)
    path = tmp_path / "set.ply"
    balls.save(path)
    found = read(path)
    assert found.shape == balls.points.shape
    assert np.abs(found - balls.points).max() <= digits
    # The control: another set is not read for this one.
    another = tilescope.sample(size=(0.5, 0.6, 0.7), radius=0.1, seed=4).points
    rows = min(len(found), len(another))
    assert np.abs(found[:rows] - another[:rows]).max() > 0.1


def test_pyvista_gets_all_samples(balls):
    pyvista = pytest.importorskip("pyvista", exc_type=ImportError)
    mesh = balls.to_pyvista()
    assert np.array_equal(mesh.points, balls.points)
    assert np.array_equal(mesh.point_data["order"], balls.arrival)
    assert np.array_equal(mesh.point_data["level"], balls.level)
    assert list(mesh.field_data["size"]) == [5, 6, 7] and list(mesh.field_data["radius"]) == [1]
    # Balls of half the radius are spheres around the samples.
    ball = pyvista.Sphere(radius=balls.radius / 2)
    glyphs = mesh.glyph(orient=False, scale=False, geom=ball)
    assert glyphs.n_points == len(balls) * ball.n_points


def test_a_mesh_has_the_order_of_arrival_and_not_that_of_the_file(balls, monkeypatch, tmp_path):
    def bare(points):
        return SimpleNamespace(points=points, point_data={}, field_data={})

    monkeypatch.setitem(sys.modules, "pyvista", SimpleNamespace(PolyData=bare))
    balls.save(tmp_path / "set.ply", shuffle=5)
    mesh = tilescope.read_solid(tmp_path / "set.ply").to_pyvista()
    order = mesh.point_data["order"]
    assert np.array_equal(mesh.points, balls.points[order])
    assert np.array_equal(mesh.point_data["level"], balls.level[order])
    # The control: the file has another order.
    assert not np.array_equal(mesh.points, balls.points)

    # Positions from elsewhere have nothing but their rows.
    others = tilescope.SolidSet(balls.points, 1, balls.size).to_pyvista().point_data
    assert list(others) == ["order"] and np.array_equal(others["order"], np.arange(len(balls)))


def test_without_pyvista_the_error_says_how_to_install_it(balls, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(ImportError, match=r"tilescope\[pyvista\]"):
        balls.to_pyvista()


@pytest.mark.parametrize("boundary", ["periodic", "bounded"])
def test_a_plane_meets_the_balls_that_pythagoras_says(boundary):
    balls = tilescope.sample(size=(5, 6, 7), radius=1, boundary=boundary, seed=3)
    for name, place in [("x", 2.5), ("y", 0), ("z", 6.9)]:
        axis = "xyz".index(name)
        disks = balls.slice(**{name: place})
        others = [other for other in range(3) if other != axis]
        assert np.array_equal(disks.middles, balls.points[disks.indices][:, others])
        assert np.allclose(disks.radii**2 + disks.depths**2, 1, rtol=0, atol=1e-12)
        # A place of the plane is covered exactly if it lies in a disk. Of a maximal set every place is.
        apart = np.abs(balls.points[:, axis] - place)
        if boundary == "periodic":
            apart = np.minimum(apart, balls.size[axis] - apart)
        assert np.array_equal(disks.indices, np.flatnonzero(apart <= 1)) and len(disks.indices) > 20


def test_planes_that_are_none_are_refused(balls):
    for planes in [{}, {"x": 1, "z": 1}]:
        with pytest.raises(ValueError, match="give one of x, y and z"):
            balls.slice(**planes)
    for place in (7.1, -0.1, float("nan")):
        with pytest.raises(ValueError, match=r"z is .*; the plane must lie in the box, from 0 to 7"):
            balls.slice(z=place)
    with pytest.raises(TypeError, match="z has values of the type <U3; they must be numbers"):
        balls.slice(z="2.5")
    with pytest.raises(ValueError, match=r"x is \[1, 2\]; it must be one number"):
        balls.slice(x=[1, 2])


@pytest.mark.skipif(not PROGRAM, reason="TILESCOPE names no program")
@pytest.mark.parametrize("plane", ["x=2.5", "y=6", "z=0.25"])
def test_planes_are_those_of_the_command_line(balls, plane, tmp_path):
    balls.save(tmp_path / "set.ply")
    command = [PROGRAM, "convert", tmp_path / "set.ply", tmp_path / "disks.csv", "--slice", plane]
    subprocess.run(command, check=True, capture_output=True)
    name, place = plane.split("=")
    disks = balls.slice(**{name: float(place)})
    theirs = np.loadtxt(tmp_path / "disks.csv", delimiter=",", skiprows=1)
    assert np.array_equal(np.column_stack([disks.middles, disks.radii, disks.depths]), theirs)


def test_arrays_are_shaped_n_by_3(balls, tmp_path):
    balls.save(tmp_path / "set.npy")
    assert np.array_equal(np.load(tmp_path / "set.npy"), balls.points)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"radius": 1, "size": (5, 5)}, "it must be three numbers"),
        ({"radius": 1, "size": (5, 5, 0)}, "its sides must be finite and above 0"),
        ({"radius": 2, "size": (5, 5, 5)}, "2.5 r long; it must be at least 4 r"),
        ({"size": (5, 5, 5)}, "give one of radius, count and exactly"),
        ({"radius": 1, "count": 9, "size": (5, 5, 5)}, "give one of radius, count and exactly"),
        ({"radius": 1, "size": (5, 5, 5), "method": "kdrt"}, "method is given with size"),
        ({"radius": 1, "size": (5, 5, 5), "leaf": 20}, "leaf is given with size"),
        ({"radius": 1, "size": (5, 5, 5), "width": 2}, "width is given with size"),
        ({"radius": 1, "size": (5, 5, 5), "levels": 2}, "levels is given with size"),
        ({"radius": 1e-4, "size": (1, 1, 1)}, "cubes of side r; it must hold at most"),
    ],
)
def test_what_makes_no_set_in_space_is_refused(arguments, text):
    with pytest.raises(ValueError, match=text):
        tilescope.sample(**arguments)


def test_sets_of_others_need_radius_and_box(balls, tmp_path):
    with pytest.raises(ValueError, match="give radius and size"):
        tilescope.verify_solid(balls.points)
    with pytest.raises(ValueError, match=r"it must be \(N, 3\)"):
        tilescope.SolidSet([[0.5, 0.5]], 1, (5, 5, 5))
    with pytest.raises(ValueError, match="judges planar sets alone"):
        balls.verify(judge="delaunay")
    with pytest.raises(ValueError, match="holds no third coordinate"):
        balls.save(tmp_path / "set.svg")


def test_windows_of_space_agree_and_are_valid():
    space = tilescope.Space(radius=0.5, seed=9)
    whole = space.window(-2, 10, 0, 2, 13, 2.5)
    assert whole.shape[1] == 3 and not whole.flags.writeable
    x, y, z = whole.T
    inside = (x >= -1) & (x < 1.5) & (y < 12) & (z >= 0.5)
    part = space.window(-1, 10, 0.5, 1.5, 12, 2.5)
    assert len(part) > 30 and np.array_equal(part, whole[inside])
    assert space.is_valid(-1, 10, 0.5, 1.5, 12, 2.5)
    # As a task of Dask has it.
    again = pickle.loads(pickle.dumps(space))
    assert np.array_equal(again.window(-1, 10, 0.5, 1.5, 12, 2.5), part) and repr(again) == repr(space)
    assert not np.array_equal(tilescope.Space(radius=0.5, seed=8).window(-1, 10, 0.5, 1.5, 12, 2.5), part)


@pytest.mark.parametrize(
    ("corners", "text"),
    [
        ((0, 0, 0, 1, 0, 1), "the window's height runs from 0 to 0"),
        ((0, 0, 0, 1, 1, 1e6), "depth reaches 1,000,000; it must lie between -32,640 and 32,640"),
        ((0, 0, 0, 1e4, 1e4, 1e4), "samples lie in the window and within 2 r of it; there may be 2e8"),
        # It is thin, and what is judged with it is not.
        ((0, 0, 0, 2e4, 2e4, 1e-3), "about 4.69"),
        ((0, 0, 0, 1, 1, float("nan")), "the window's depth"),
    ],
)
def test_impossible_windows_of_space_are_refused(corners, text):
    with pytest.raises(ValueError, match=text):
        tilescope.Space(radius=0.5).window(*corners)


def test_impossible_spaces_are_refused():
    with pytest.raises(ValueError, match="the radius is 0; it must be a finite number above 0"):
        tilescope.Space(radius=0)
    with pytest.raises(TypeError, match="seed is 'a'; it must be a whole number"):
        tilescope.Space(radius=1, seed="a")
