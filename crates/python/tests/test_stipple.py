"""Stipples: the dots of the command line, verified as a prefix, saved, drawn, and refused."""

import copy
import importlib
import json
import os
import pickle
import subprocess

import numpy as np
import pytest
from PIL import Image

import tilescope

PROGRAM = os.environ.get("TILESCOPE")
needs_program = pytest.mark.skipif(PROGRAM is None, reason="TILESCOPE names no program")


def ball(rows=60, columns=90):
    """Grey values from 0 to 255, the highest row first: a ball on white, black in its upper left."""
    y, x = np.mgrid[-1 : 1 : rows * 1j, -1.5 : 1.5 : columns * 1j]
    return np.where(np.hypot(x, y) < 0.9, 255 * np.clip(np.hypot(x + 0.3, y + 0.4) / 1.7, 0, 1), 255).astype(np.uint8)


def colours(opacity=False):
    grey = ball().astype(int)
    channels = [grey, 255 - grey // 2, (3 * grey) % 256]
    if opacity:
        channels.append(np.clip(2 * grey, 60, 255))
    return np.stack(channels, axis=-1).astype(np.uint8)


def run(*words, code=0):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def dots() -> tilescope.Stipple:
    return tilescope.stipple(ball(), dots=900, dot_size="darkness", seed=3)


@needs_program
def test_dots_are_those_of_the_command_line(tmp_path):
    kinds = {
        "grey": ball(),
        "fine": ball().astype(np.uint16) * 256 + np.arange(90, dtype=np.uint16),
        "colours": colours(),
        "glass": colours(opacity=True),
    }
    for name, image in kinds.items():
        path = tmp_path / f"{name}.png"
        Image.fromarray(image).save(path)
        for options, words in [
            ({}, []),
            ({"gamma": 2.2, "contrast": 1.3, "white": 0.1, "seed": 9}, "--gamma 2.2 --contrast 1.3 --white 0.1 --seed 9".split()),
            ({"invert": True, "run_on": True, "width": 3.5}, "--invert --run-on --width 3.5".split()),
        ]:
            there = json.loads(run("stipple", path, "--dots", 500, *words, "--json"))
            for given in (image, Image.open(path), path):
                here = tilescope.stipple(given, dots=500, **options)
                assert (here.digest, here.made, here.runs) == (there["positions_digest"], there["made"], there["runs"]), name
                assert (here.black_radius, here.capped_pixels) == (there["black_radius"], there["capped_pixels"])
                assert here.verify().covering_factor == there["covering_factor"]
    # The control: an image in another order of rows has other dots.
    assert tilescope.stipple(np.flipud(ball()), dots=500).digest != tilescope.stipple(ball(), dots=500).digest


@needs_program
def test_files_go_to_the_command_line_and_come_from_there(tmp_path):
    photo = tmp_path / "photo.png"
    Image.fromarray(ball()).save(photo)
    tilescope.stipple(photo, dots=400, dot_size="darkness", ink="#102030").save(tmp_path / "here.svg")
    words = ["--dots", 400, "--dot-size", "darkness", "--ink", "#102030", "--out", tmp_path / "there.svg"]
    run("stipple", photo, *words)
    assert (tmp_path / "here.svg").read_text() == (tmp_path / "there.svg").read_text()
    said = run("verify", tmp_path / "here.svg", "--density-image", photo)
    assert "prefix         yes" in said and "certificate    true" in said
    assert tilescope.verify(tmp_path / "there.svg", image=photo).passed
    with pytest.raises(ValueError, match=r'a field from photo.png.* or image=pathlib.Path\("photo.png"\) of a stipple'):
        tilescope.verify(tmp_path / "there.svg")
    back = tilescope.read(tmp_path / "there.svg", image=photo)
    assert back.verify().covering_factor > 1 and len(back) == 400


def test_there_are_exactly_as_many_dots_and_they_are_a_prefix(dots):
    assert dots.points.shape == (900, 2) == (len(dots), 2)
    assert dots.made >= 900 and dots.made <= 930 and 1 <= dots.runs <= 4 and dots.capped_pixels == 0
    assert repr(dots).startswith(f"<Stipple: the first 900 of {dots.made} dots, radius ")
    assert repr(dots).endswith(", 90 x 60>") and dots.domain == (90.0, 60.0, "bounded")
    report = dots.verify()
    assert report.valid and report.judges == ("subdivision",) and 1 < report.covering_factor < 1.2
    assert repr(report).startswith("<Report: valid prefix, 900 samples, 0 conflicts, 0 gaps, covering within 1.")
    assert dots.certificate["prefix"] == {"made": dots.made, "kept": 900, "factor": report.covering_factor}
    assert dots.black_radius * 0.99 < dots.radius <= dots.radii.min()
    # The image is upright: dots are denser in the upper left of the ball.
    x, y = (dots.points - [45, 30]).T
    assert ((x < 0) & (y > 0)).sum() > 1.5 * ((x > 0) & (y < 0)).sum()
    # Not one dot lies on white.
    assert (np.hypot(x / 30, y / 30) < 0.95).all()


def spoilt(dots, points):
    """The same stipple with other points."""
    other = copy.copy(dots)
    other._points = np.ascontiguousarray(points)
    return other


def test_what_is_no_prefix_is_found(dots):
    twice = spoilt(dots, [*dots.points.tolist()[:-1], (dots.points[7] + 1e-3).tolist()]).verify()
    assert not twice.valid and twice.conflicts > 0
    # As many dots of one half alone leave places bare of which no factor can be measured.
    half = spoilt(dots, dots.points[np.argsort(dots.points[:, 0])][:450]).verify()
    assert not half.valid and half.gaps > 0 and half.covering_factor is None
    # The whole set is judged as a whole: it does not cover within its radii.
    whole = spoilt(dots, dots.points)
    whole._first_of = None
    assert not whole.verify().valid


def test_each_beginning_is_the_image_with_fewer_dots(dots):
    first = dots.prefix(400)
    assert np.array_equal(first.points, dots.points[:400])
    assert np.array_equal(first.dot_radii, dots.dot_radii[:400])
    assert first.verify().valid and first.verify().covering_factor > dots.verify().covering_factor
    assert first.certificate["prefix"]["kept"] == 400 and dots.certificate["prefix"]["kept"] == 900
    for count in (0, 901):
        with pytest.raises(ValueError, match=f"count is {count}; it must be between 1 and 900"):
            dots.prefix(count)
    with pytest.raises(TypeError, match="integer"):
        dots.prefix(2.5)


def test_dots_are_of_one_size_or_the_larger_the_darker(dots):
    image = tilescope.stipple(ball(), dots=900, seed=3)
    assert len(set(image.dot_radii.tolist())) == 1
    assert (image.paper, image.ink) == ("#ffffff", "#000000")
    assert np.allclose(dots.dot_radii * dots.radii, dots.dot_radii[0] * dots.radii[0])
    assert dots.dot_radii.max() > 2 * dots.dot_radii.min() and not dots.dot_radii.flags.writeable
    assert np.array_equal(image.points, dots.points)
    # As much ink as the image is dark, where dots do not overlap.
    ink = np.pi * (image.dot_radii**2).sum()
    assert ink == pytest.approx((1 - ball() / 255).sum(), rel=0.05)
    given = tilescope.stipple(ball(), dots=900, seed=3, dot_radius=0.25, invert=True, ink="#00ff10")
    assert set(given.dot_radii.tolist()) == {0.25}
    assert (given.paper, given.ink) == ("#000000", "#00ff10")


@pytest.mark.parametrize("name", ["dots.csv", "dots.ply", "dots.npy", "dots.json", "dots.svg"])
def test_files_come_back_with_the_image(dots, name, tmp_path):
    path = tmp_path / name
    assert dots.save(path).valid
    with pytest.raises(ValueError, match="a field from an array.*density=the same array, or image=the same array of a stipple"):
        tilescope.verify(path)
    assert tilescope.verify(path, image=ball()).passed
    back = tilescope.read(path, image=ball())
    assert np.allclose(back.points, dots.points, atol=1e-8) and back.parameters == dots.parameters
    assert back.verify().valid and back.verify().covering_factor == pytest.approx(dots.verify().covering_factor, abs=1e-6)
    # The control: another image is another field.
    other = ball()
    other[30, 45] ^= 64
    report = tilescope.verify(path, image=other)
    assert not report.passed and report.differences
    with pytest.raises(ValueError, match="both density and image are given"):
        tilescope.read(path, density=ball(), image=ball())
    with pytest.raises(ValueError, match="image is that of a stipple, whose certificate states the radius of black"):
        tilescope.verify(dots.points, image=ball())


def test_images_of_pillow_are_what_they_show():
    grey = Image.fromarray(ball())
    expected = tilescope.stipple(ball(), dots=300).digest
    assert tilescope.stipple(grey, dots=300).digest == expected
    assert tilescope.stipple(grey.convert("RGB"), dots=300).digest == expected
    assert tilescope.stipple(grey.convert("RGBA"), dots=300).digest == expected
    assert tilescope.stipple(grey.convert("P"), dots=300).digest == expected
    assert tilescope.stipple(ball() / 255, dots=300).digest == expected
    assert tilescope.stipple((ball() / 255).astype(np.float32), dots=300).digest == expected
    assert tilescope.stipple(ball()[:, :, None].astype(np.uint16) * 257, dots=300).digest == expected
    letters = ball() < 128
    black = Image.fromarray(np.where(letters, 0, 255).astype(np.uint8))
    assert tilescope.stipple(~letters, dots=300).digest == tilescope.stipple(black.convert("1"), dots=300).digest
    with pytest.raises(ValueError, match=r"image has the mode 'CMYK' of Pillow; .* image.convert\('RGB'\)"):
        tilescope.stipple(grey.convert("CMYK"), dots=300)


NAN = np.full((4, 4), 0.5)
NAN[2, 1] = np.nan
REFUSED = [
    ({"image": NAN}, "image is nan in column 1 of row 2; floating-point numbers must be from 0, black, to 1, white"),
    ({"image": np.full((4, 4), 1.5)}, "image is 1.5 in column 0 of row 0"),
    ({"image": np.ones(9, dtype=np.uint8)}, r"image has the shape \(9,\); it must be \(rows, columns\)"),
    ({"image": np.ones((4, 4, 5), dtype=np.uint8)}, r"image has the shape \(4, 4, 5\)"),
    ({"image": np.ones((0, 4), dtype=np.uint8)}, r"image has the shape \(0, 4\); it must have at least one row"),
    ({"image": np.ma.masked_less(ball(), 99)}, "image has masked pixels"),
    ({"image": np.full((30, 30), 255, dtype=np.uint8)}, "the array: no place of the image is darker than white"),
    ({"dots": 0}, "dots is 0; it must be at least 1"),
    ({"dots": -3}, "dots is -3; it must be a whole number from 0"),
    ({"dots": 2_000_000_000_000}, "dots is 2000000000000, which is too many: the least radius is"),
    ({"dots": 40, "image": np.zeros((300, 9), dtype=np.uint8)}, "dots is 40, which is too few: the width is"),
    ({"gamma": 0.01}, "the gamma is 0.01; it must be from 0.1 to 10"),
    ({"contrast": float("nan")}, "the contrast is NaN; it must be from 0 to 100"),
    ({"white": 0.7}, "the white is 0.7; it must be from 0 to 0.5"),
    ({"width": 0}, "width is 0; it must be a finite number above 0"),
    ({"width": float("inf")}, "width is inf; it must be a finite number above 0"),
    ({"dot_radius": -1}, "dot_radius is -1; it must be a finite number above 0"),
    ({"dot_size": "large"}, "dot_size is 'large'; it must be 'constant' or 'darkness'"),
    ({"paper": "red"}, "paper is 'red': a colour is written as #rrggbb"),
    ({"ink": "#12"}, "ink is '#12': a colour is written as #rrggbb"),
]  # fmt: skip


@pytest.mark.parametrize(("arguments", "text"), REFUSED, ids=[text for _, text in REFUSED])
def test_what_cannot_be_drawn_is_refused_with_value_and_limit(arguments, text):
    with pytest.raises(ValueError, match=text):
        tilescope.stipple(**{"image": ball(), "dots": 100} | arguments)


def test_other_types_are_refused(tmp_path):
    for arguments, text in [
        ({"image": ball().astype(np.int32)}, "image has values of the type int32; they must be uint8, uint16 or bool"),
        ({"image": None}, "image has the shape|image has values of the type object"),
        ({"dots": 9.5}, "dots is 9.5; it must be a whole number"),
        ({"gamma": "2"}, "gamma is '2'; it must be a real number"),
        ({"invert": 1}, "invert is 1; it must be True or False"),
        ({"run_on": "yes"}, "run_on is 'yes'; it must be True or False"),
        ({"ink": 7}, "ink is 7; it must be text"),
    ]:
        with pytest.raises((TypeError, ValueError), match=text):
            tilescope.stipple(**{"image": ball(), "dots": 100} | arguments)
    with pytest.raises(FileNotFoundError):
        tilescope.stipple("no-such.png", 100)
    (tmp_path / "text.png").write_text("hello")
    with pytest.raises(ValueError, match="text.png: it is no PNG or JPEG image"):
        tilescope.stipple(tmp_path / "text.png", 100)


def test_copies_are_stipples(dots):
    for other in (copy.copy(dots), copy.deepcopy(dots), pickle.loads(pickle.dumps(dots))):
        assert (other.digest, other.made, other.runs, repr(other)) == (dots.digest, dots.made, dots.runs, repr(dots))
        assert np.array_equal(other.dot_radii, dots.dot_radii) and (other.paper, other.ink) == (dots.paper, dots.ink)
        assert other.verify().covering_factor == dots.verify().covering_factor


def test_pictures_have_a_dot_of_its_size_for_each_sample(dots, tmp_path):
    figure = importlib.import_module("matplotlib.figure").Figure()
    axes = dots.plot(figure.add_subplot())
    assert np.allclose(axes.collections[0].get_widths(), 2 * dots.dot_radii)
    disks = dots.plot(figure.add_subplot(), disks=True)
    assert np.allclose(disks.collections[0].get_widths(), 2 * dots.radii)
    assert dots._repr_png_().startswith(b"\x89PNG")
    dots.draw(tmp_path / "dots.svg")
    assert (tmp_path / "dots.svg").read_text().count("<circle") == 900
    dots.draw(tmp_path / "dots.png", size=180)
    picture = np.asarray(Image.open(tmp_path / "dots.png").convert("L"))
    assert picture.shape == (120, 180)
    # The picture is about as dark as the image in each quarter: large dots overlap where it is dark.
    means = []
    for rows in (slice(0, 60), slice(60, 120)):
        for columns in (slice(0, 90), slice(90, 180)):
            halved = ball()[rows.start // 2 : rows.stop // 2, columns.start // 2 : columns.stop // 2]
            assert abs(picture[rows, columns].mean() - halved.mean()) < 20
            means.append(picture[rows, columns].mean())
    assert np.argmin(means) == 0 and max(means) > means[0] + 20
    # A window shows its part alone: the right edge of the image is white.
    dots.draw(tmp_path / "edge.png", size=32, window=(80, 0, 90, 60))
    assert (np.asarray(Image.open(tmp_path / "edge.png").convert("L")) == 255).all()
    dots.draw(tmp_path / "disks.png", size=180, disks=True)
    assert (tmp_path / "disks.png").read_bytes() != (tmp_path / "dots.png").read_bytes()


def test_progress_is_told_and_its_errors_stop_the_work():
    told = []
    tilescope.stipple(ball(), dots=900, progress=lambda *one: told.append(one))
    assert told and all(done <= total for _, done, total in told)

    def stop(*_):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        tilescope.stipple(ball(600, 900), dots=400_000, progress=stop)
