"""Sets: their arrays, verdicts, measures, pictures."""

import copy
import dataclasses
import json
import math
import pickle

import numpy as np
import pytest
from matplotlib import pyplot

import tilescope


def test_points_are_one_read_only_array(small):
    points = small.points
    assert points is small.points
    assert (points.shape, points.dtype, points.flags.c_contiguous) == ((len(small), 2), np.float64, True)
    for writing in (points, points[:5], points.base):
        with pytest.raises(ValueError, match="read-only"):
            writing[0] = 0
        with pytest.raises(ValueError, match="WRITEABLE"):
            writing.flags.writeable = True
    with pytest.raises(AttributeError):
        small.points = points
    assert np.asarray(small) is points
    assert np.array(small, dtype=np.float32).dtype == np.float32
    assert not np.shares_memory(np.array(small), points)


def test_given_positions_are_copied():
    given = np.array([[0.25, 0.25], [0.75, 0.75]])
    held = tilescope.PointSet(given, 0.5)
    given[0] = 0.5
    assert held.points[0].tolist() == [0.25, 0.25]
    assert held.points.flags.c_contiguous
    assert tilescope.PointSet(np.asfortranarray(given), 0.5).points.flags.c_contiguous


def test_copies_are_sets_with_the_same_samples(small):
    for again in (pickle.loads(pickle.dumps(small)), copy.deepcopy(small), copy.copy(small)):
        assert (again.digest, again.domain, again.parameters) == (small.digest, small.domain, small.parameters)
        with pytest.raises(ValueError, match="read-only"):
            again.points[0] = 0


def test_a_set_says_what_it_is(small):
    assert (small.radius, small.domain, small.method) == (0.02, (1.0, 1.0, "periodic"), "kdrt")
    assert small.parameters["seed"] == 7
    assert small.parameters["pattern"] == {"side": 100.0, "boundary": "periodic", "seed": 0}
    counts = small.summary
    assert counts["tiled"] - counts["eliminated"] + sum(counts["inserted"]) == len(small)
    assert repr(small) == f"<PointSet: {len(small)} samples, radius 0.02, 1 x 1, periodic>"


def test_provenance_says_which_samples_were_inserted(small):
    block, index, iteration = small.provenance.T
    inserted = iteration > 0
    assert inserted.sum() == sum(small.summary["inserted"]) > 0
    assert (block[inserted] == 2**32 - 1).all()
    assert (block[~inserted] < small.summary["blocks"]).all()
    assert (index[~inserted] < 7000).all()
    sequential = tilescope.sample(radius=0.02, seed=7, engine="sequential")
    assert np.array_equal(sequential.provenance, small.provenance)


@pytest.mark.parametrize("judge", [None, "delaunay", "circles", "both"])
def test_the_judges_tell_good_sets_from_bad_ones(small, holed, crowded, judge):
    assert small.verify(judge=judge).valid
    gap, conflict = holed.verify(judge=judge), crowded.verify(judge=judge)
    assert (gap.valid, gap.conflict_free, gap.maximal) == (False, True, False)
    assert math.dist(gap.worst_gaps[0].center, small.points[0]) < 0.02 < gap.worst_gaps[0].distance
    assert (conflict.valid, conflict.conflict_free, conflict.maximal) == (False, False, True)
    pair = conflict.worst_conflicts[0]
    assert (pair.first, pair.second) == (0, len(small))
    assert pair.distance == pytest.approx(0.001)
    expected = {None: 2, "both": 2}.get(judge, 1)
    assert len(gap.judges) == expected


def test_the_report_has_the_measures(small):
    report = small.verify()
    assert 0.02 <= report.min_distance < 0.0202
    assert 0.019 < report.covering_radius <= 0.02 * (1 + 2**-15)
    assert report.density == pytest.approx(len(small) * 0.02**2)
    assert "valid, " in repr(report)
    single = tilescope.verify([[0.5, 0.5]], 2, boundary="bounded")
    assert (single.min_distance, single.valid) == (math.inf, True)


def test_verify_takes_what_is_given_before_what_the_set_says(small):
    assert not tilescope.verify(small, 0.03).conflict_free
    assert not tilescope.verify(small, 0.01).maximal
    assert not tilescope.verify(small, width=1.5).maximal
    assert tilescope.verify(small).valid


def test_analyze_has_the_numbers_of_the_field(small):
    measures = tilescope.analyze(small)
    assert {"density", "effective_nyquist", "low_power", "bond_order", "star_discrepancy"} < measures.keys()
    assert (measures["samples"], measures["conflicts"], measures["gaps"]) == (len(small), 0, 0)
    assert measures["min_distance_r"] == pytest.approx(small.verify().min_distance / 0.02)
    assert 0.75 < measures["relative_radius"] < 0.8
    assert measures["mean_sides"] == pytest.approx(6)
    noise = np.random.default_rng(1).random((1000, 2))
    random = tilescope.analyze(noise)
    assert random["relative_radius"] < 0.1
    assert random["conflicts"] is None, "without a radius there are none"
    assert random["min_distance_r"] == 1


def test_the_spectrum_tells_blue_noise_from_white(small):
    blue = small.spectrum()
    noise = np.random.default_rng(1).random((len(small), 2))
    white = tilescope.PointSet(noise).spectrum()
    for spectrum in (blue, white):
        assert spectrum.frequencies.shape == spectrum.power.shape == spectrum.anisotropy.shape
        assert spectrum.bands.shape == (len(spectrum.power), 2)
        assert spectrum.picture.ndim == 2
    low = blue.frequencies < 0.5
    assert blue.power[low].mean() < 0.1 < 0.7 < white.power[low].mean() < 1.3
    assert blue.effective_nyquist > 0.5 > white.effective_nyquist
    assert tilescope.sample(radius=0.02, boundary="bounded").spectrum().bands is None
    assert small.spectrum(1).frequencies[-1] < 1.05
    with pytest.raises(ValueError, match="the largest frequency nu is 0"):
        small.spectrum(0)


def test_spectra_are_compared_by_their_numbers(small):
    one, same = small.spectrum(), copy.deepcopy(small.spectrum())
    assert one == same
    partly = np.where(np.arange(len(one.anisotropy)) < 3, np.nan, one.anisotropy)
    assert one != dataclasses.replace(one, anisotropy=partly)
    assert dataclasses.replace(one, anisotropy=partly) == dataclasses.replace(one, anisotropy=partly.copy())
    assert one != tilescope.sample(radius=0.02, seed=8).spectrum()
    assert one != tilescope.sample(radius=0.02, boundary="bounded").spectrum()
    assert one != "a spectrum"
    for field in dataclasses.fields(one):
        assert one != dataclasses.replace(one, **{field.name: None}), field.name


def test_no_pair_is_closer_than_the_radius_in_the_pair_correlation(small):
    distances, g = small.pair_correlation()
    r_max = math.sqrt(2 / (math.sqrt(3) * len(small)))
    closer = distances * r_max < 0.0199
    assert closer.any()
    assert (g[closer] == 0).all()
    assert g[~closer].mean() == pytest.approx(1, abs=0.1)


def png_size(picture: bytes) -> tuple[int, int]:
    assert picture.startswith(b"\x89PNG\r\n\x1a\n")
    return int.from_bytes(picture[16:20], "big"), int.from_bytes(picture[20:24], "big")


def test_notebooks_show_a_picture(small):
    width, height = png_size(small._repr_png_())
    assert width == 800 < height < 850
    large = tilescope.sample(100_000)
    assert png_size(large._repr_png_())[0] == 800
    assert tilescope.PointSet(np.empty((0, 2)))._repr_png_() is None


def test_pictures_are_saved(small, tmp_path):
    small.draw(tmp_path / "a.png", size=300)
    assert png_size((tmp_path / "a.png").read_bytes())[0] == 300
    small.draw(tmp_path / "a.svg", size=300, window=(0, 0, 0.2, 0.2), theme="dark", disks=False)
    small.draw(tmp_path / "b.svg", size=300, window=(0, 0, 0.2, 0.2), theme="dark")
    without, with_disks = ((tmp_path / name).read_text() for name in ("a.svg", "b.svg"))
    assert without.count("<circle") < with_disks.count("<circle")
    for arguments, text in [
        ({"path": "a.jpeg"}, "its extension must be .png or .svg"),
        ({"size": 3}, "size is 3; it must be between 16 and 32768"),
        ({"theme": "blue"}, "theme is 'blue'; it must be 'light' or 'dark'"),
        ({"window": (2, 2, 3, 3)}, r"window is \(2, 2, 3, 3\); it must be"),
    ]:
        with pytest.raises(ValueError, match=text):
            small.draw(**({"path": tmp_path / "c.png"} | arguments))
    assert not (tmp_path / "c.png").exists()


def test_a_picture_does_not_replace_a_set_with_a_certificate(small, tmp_path):
    small.save(tmp_path / "set.svg")
    before = (tmp_path / "set.svg").read_bytes()
    with pytest.raises(ValueError, match="set.svg is a set with a certificate, .*set.svg.certificate.json; give"):
        small.draw(tmp_path / "set.svg")
    assert (tmp_path / "set.svg").read_bytes() == before
    small.draw(tmp_path / "picture.svg")
    small.draw(tmp_path / "picture.svg", size=300)
    with pytest.raises(FileNotFoundError):
        small.draw(tmp_path / "no such folder" / "picture.png")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["picture.svg", "set.svg", "set.svg.certificate.json"]


def test_a_picture_says_how_far_it_is_and_can_be_stopped(tmp_path):
    class Enough(Exception):
        pass

    large = tilescope.sample(200_000)
    told = []
    large.draw(tmp_path / "a.png", size=3000, progress=lambda *progress: told.append(progress))
    drawing = {done for name, done, total in told if name == "draw" and 0 < done < total}
    assert drawing, told

    def stop(name, done, total):
        if name == "draw":
            raise Enough

    with pytest.raises(Enough):
        large.draw(tmp_path / "b.png", size=3000, progress=stop)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


@pytest.mark.parametrize("boundary", ["periodic", "bounded"])
def test_a_picture_of_a_part_has_the_disks_that_reach_into_it(boundary, tmp_path):
    points = tilescope.sample(radius=0.02, boundary=boundary)
    shifts = [(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)] if boundary == "periodic" else [(0, 0)]
    copies = np.concatenate([points.points + shift for shift in shifts])
    for x0, y0, x1, y1 in [(0, 0, 0.2, 0.2), (0.4, 0.5, 0.6, 0.55), (0.9, -0.1, 1.1, 0.1)]:
        points.draw(tmp_path / "part.svg", window=(x0, y0, x1, y1))
        low, high = np.array([x0, y0]) - 0.02, np.array([x1, y1]) + 0.02
        seen = ((low <= copies) & (copies <= high)).all(axis=1).sum()
        # Each has a disk and a dot.
        assert (tmp_path / "part.svg").read_text().count("<circle") == 2 * seen > 0


def test_plots_hold_the_set(small):
    figure, (left, right) = pyplot.subplots(1, 2)
    assert small.plot(left, disks=True) is left
    scatter = left.collections[-1]
    assert np.array_equal(scatter.get_offsets(), small.points)
    assert len(left.collections) == 2
    spectrum = small.spectrum()
    spectrum.plot(right)
    assert np.array_equal(right.lines[0].get_ydata(), spectrum.power)
    figure.canvas.draw()
    assert tilescope.sample(5000).plot() is pyplot.gca()
    pyplot.close("all")


LAYOUT = {"version": 1, "radius": 0.02, "columns": [0.5, 0.5], "rows": [1]}


def test_sets_are_combined_and_far_from_seams_left_alone(small):
    other = tilescope.sample(radius=0.01, seed=9, method="reference")
    glued = tilescope.combine(LAYOUT | {"pieces": [{"file": small}, {"file": other, "offset": [0.25, 0]}]})
    assert glued.verify().valid
    assert glued.method == "combined"
    x, y = small.points.T
    kept = small.points[(x > 0.1) & (x < 0.4) & (y > 0.1) & (y < 0.9)]
    found = {tuple(point) for point in np.round(glued.points, 9).tolist()}
    assert all(tuple(point) in found for point in np.round(kept, 9).tolist())
    stated = glued.parameters["layout"]["pieces"]
    assert stated[0]["positions_digest"] == small.digest


def test_a_layout_may_be_a_file_beside_its_sets(small, tmp_path):
    small.save(tmp_path / "a.csv")
    layout = LAYOUT | {"pieces": [{"file": "a.csv"}, {"seed": 4}]}
    (tmp_path / "layout.json").write_text(json.dumps(layout))
    by_file = tilescope.combine(tmp_path / "layout.json")
    by_mapping = tilescope.combine(layout, folder=tmp_path)
    in_memory = tilescope.combine(LAYOUT | {"pieces": [{"file": small}, {"seed": 4}]})
    assert by_file.digest == by_mapping.digest == in_memory.digest
    assert by_file.verify().valid


def test_layouts_that_cannot_be_are_refused(small, holed):
    for layout, text in [
        (LAYOUT | {"pieces": [{"seed": 1}]}, "pieces"),
        (LAYOUT | {"version": 2, "pieces": []}, "version"),
        (LAYOUT | {"pieces": [{"file": small}, {"file": holed}]}, r"pieces\[1\]: the set is not maximal"),
        (LAYOUT | {"pieces": [{"file": small}, {}]}, r"pieces\[1\]"),
    ]:
        with pytest.raises(ValueError, match=text):
            tilescope.combine(layout)
    with pytest.raises(FileNotFoundError):
        tilescope.combine("no such layout.json")
    with pytest.raises(FileNotFoundError):
        tilescope.combine(LAYOUT | {"pieces": [{"file": "no such set.csv"}, {"seed": 1}]})


def test_exact_tiling_says_what_pattern_it_took():
    made = tilescope.sample(1000, method="exact", seed=5)
    assert (made.method, made.verify().valid, abs(len(made) - 1000) <= 10) == ("exact", True, True)
    pattern = made.parameters["pattern"]
    assert (pattern["side"], pattern["seed"], made.parameters["pattern_samples"] > 27_000) == (200, 5, True)
    given = tilescope.sample(1000, method="exact", seed=5, pattern_side=50, pattern_seed=0)
    assert (given.parameters["pattern"]["side"], given.parameters["pattern"]["seed"]) == (50, 0)
    assert not {"order", "insertion", "search", "variant"} & given.parameters.keys()
