"""The checker that was written from the certificate's documentation agrees with the program, and finds changes."""

import importlib.util
import json
import os
import pathlib
import random
import subprocess
import sys

import blake3
import numpy as np
import pytest

import tilescope

PATH = pathlib.Path(__file__).parents[3] / "assets/check_certificate.py"
SPEC = importlib.util.spec_from_file_location("check_certificate", PATH)
checker = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(checker)

SLOW = bool(os.environ.get("TILESCOPE_SLOW"))


def false_fields(path):
    return checker.check(*checker.read(str(path)))


def set_of(seed):
    """Sets of many kinds: sides, borders, methods, types of numbers, origins."""
    draw = random.Random(seed)
    return tilescope.sample(
        radius=draw.choice([0.06, 0.08, 0.099]),
        width=draw.choice([1.0, 1.3]),
        seed=seed,
        boundary=draw.choice(["periodic", "bounded"]),
        method=draw.choice(["kdrt", "reference"]),
        **({"origin": (1e4, -250.5)} if seed % 4 == 1 else {}),
    )


def test_the_digest_is_blake3():
    for length in [0, 1, 63, 64, 65, 1023, 1024, 1025, 2048, 3073, 7 * 1024, 31 * 1024 + 5]:
        data = bytes(i * 7 % 251 for i in range(length))
        assert checker.blake3(data) == "blake3:" + blake3.blake3(data).hexdigest(), length


@pytest.mark.filterwarnings("ignore:the written set")
def test_what_the_program_certifies_is_true(tmp_path):
    kinds = set()
    for seed in range(200 if SLOW else 40):
        path = tmp_path / random.Random(seed).choice(["set.csv", "set.npy"])
        points = set_of(seed)
        precision = "f32" if path.suffix == ".npy" and seed % 4 == 0 else "f64"
        valid = points.save(path, precision=precision).valid
        assert false_fields(path) == [], seed
        if seed < 20:
            assert checker.main(str(path)) == (0 if valid else 1), seed
        kinds.add((path.suffix, precision, points.domain.boundary, points.method, points.origin != (0, 0)))
    assert len(kinds) > 15


def change_point(data, stated):
    lines = data.decode().splitlines()
    x, y = lines[5].split(",")[:2]
    lines[5] = f"{float(x) * 0.5!r},{y}"
    return "\n".join(lines).encode() + b"\n", stated


def drop_point(data, stated):
    lines = data.decode().splitlines()
    return "\n".join(lines[:-1]).encode() + b"\n", stated


def with_digests(change):
    """The same, by somebody who makes the digests and the count again."""

    def changed(data, stated):
        data, stated = change(data, stated)
        points = np.loadtxt(data.decode().splitlines()[1:], delimiter=",", ndmin=2)
        again = {"count": len(points), "digest": checker.blake3(data)}
        return data, {**stated, **again, "positions_digest": checker.blake3(points.tobytes())}

    return changed


def with_field(name, change):
    return lambda data, stated: (data, {**stated, name: change(stated[name])})


TAMPERED = {
    "a moved point": (change_point, {"digest", "positions_digest"}),
    "a dropped point": (drop_point, {"digest", "positions_digest", "count"}),
    "a moved point, new digests": (with_digests(change_point), {"covering_radius"}),
    "a dropped point, new digests": (with_digests(drop_point), {"covering_radius", "density"}),
    "a blank at the end": (lambda data, stated: (data + b"\n", stated), {"digest"}),
    "radius": (with_field("radius", lambda r: r * 1.001), {"density", "parameters.radius"}),
    "min_distance": (with_field("min_distance", lambda d: d * (1 + 1e-8)), {"min_distance"}),
    "covering_radius": (with_field("covering_radius", lambda d: d * (1 - 1e-8)), {"covering_radius"}),
    "region": (with_field("region", lambda region: {**region, "height": 1.01}), {"parameters.height"}),
    "valid": (with_field("valid", lambda valid: not valid), {"valid"}),
}


@pytest.mark.parametrize("name", TAMPERED)
def test_what_is_changed_is_found_by_its_name(name, tmp_path):
    change, expected = TAMPERED[name]
    # One of each boundary.
    for seed in range(5 if SLOW else 2):
        path, beside = tmp_path / "set.csv", tmp_path / "set.csv.certificate.json"
        tilescope.sample(radius=0.05, seed=seed, boundary=["periodic", "bounded"][seed % 2]).save(path)
        data, stated = change(path.read_bytes(), json.loads(beside.read_text()))
        path.write_bytes(data)
        beside.write_text(json.dumps(stated))
        assert expected <= set(false_fields(path)), seed
    assert checker.main(str(path)) == 1


def test_what_it_cannot_judge_is_refused_by_name(tmp_path):
    path = tmp_path / "levels.csv"
    tilescope.sample(radius=0.05, levels=2).save(path)
    run = subprocess.run([sys.executable, PATH, path], capture_output=True, text=True, check=False)
    assert (run.returncode, "`levels`" in run.stdout) == (2, True), run.stdout

    path = tmp_path / "set.csv"
    tilescope.sample(radius=0.05).save(path)
    beside = tmp_path / "set.csv.certificate.json"
    text = beside.read_text()
    for changed, word in [
        (text.replace('"valid"', '"verdict"'), "fields"),
        (text.replace("{", '{"count": 3,', 1), "twice"),
        (text.replace('"format_version": 1', '"format_version": 3'), "version"),
        (text[:-9], "not judged"),
    ]:
        beside.write_text(changed)
        run = subprocess.run([sys.executable, PATH, path], capture_output=True, text=True, check=False)
        assert (run.returncode, word in run.stdout) == (2, True), run.stdout


@pytest.mark.filterwarnings("ignore:the written set")
def test_conflicts_and_gaps_are_seen_as_such(holed, crowded, tmp_path):
    for points, name in [(holed, "gaps"), (crowded, "conflicts")]:
        path, beside = tmp_path / "set.csv", tmp_path / "set.csv.certificate.json"
        assert not points.save(path).valid
        assert false_fields(path) == []
        assert checker.main(str(path)) == 1

        # The control: the same set, called free of them.
        beside.write_text(json.dumps({**json.loads(beside.read_text()), name: 0, "valid": True}))
        assert name in false_fields(path)


@pytest.mark.parametrize("suffix", [".csv", ".npy"])
def test_sets_in_space_are_refused_by_name(tmp_path, capsys, suffix):
    path = tmp_path / ("balls" + suffix)
    tilescope.sample(size=(6, 6, 6), radius=1).save(path)
    assert checker.main(str(path)) == 2
    assert "the set is one in space" in capsys.readouterr().out
