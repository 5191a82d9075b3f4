"""The run as a curve: columns of one length, with the numbers of the finished set at the end."""

import math
import re

import numpy as np
import pytest

import tilescope


@pytest.mark.parametrize(
    "arguments",
    [
        {},
        {"boundary": "bounded", "insertion": "uniform"},
        {"variant": "as-printed"},
        {"method": "exact"},
        {"method": "reference"},
        {"levels": 3},
    ],
)
def test_the_last_row_is_what_analyze_says_of_the_set(arguments):
    numbers = ["samples", "density", "conflicts", "gaps", "min_distance_r", "covering_radius_r"]
    run = tilescope.curve(radius=0.04, seed=3, numbers=numbers, **arguments)
    assert list(run) == ["event", "stage", *numbers]
    assert len({len(column) for column in run.values()}) == 1
    assert run["event"].dtype == np.int64 and (np.diff(run["event"]) >= 0).all() and run["event"][0] == 0

    made = tilescope.sample(radius=0.04, seed=3, **arguments)
    measured = tilescope.analyze(made)
    for key in numbers:
        assert math.isclose(run[key][-1], measured[key], rel_tol=2e-6), key
    assert (run["samples"][0], math.isnan(run["gaps"][0])) == (0, True)


PARK = {"type": "Polygon", "coordinates": [[[0, 0], [200, 0], [200, 100], [80, 150], [0, 0]]]}


@pytest.mark.parametrize(
    "arguments",
    [
        {"shape": PARK, "radius": 6},
        {"shape": PARK, "count": 300, "method": "exact"},
        {"radius": lambda x, y: 0.02 + 0.04 * x},
        {"radius_expression": "0.02 + 0.04*(x - 5)", "extent": (5, 0, 6, 1)},
        {"density": np.array([[1.0, 0.3], [0.3, 1.0]]), "count": 300, "boundary": "periodic"},
    ],
)
def test_the_last_row_of_a_field_or_a_shape_is_the_set(arguments):
    run = tilescope.curve(seed=3, **arguments, moments=20)
    assert len(run["samples"]) == 20 and run["samples"][0] == 0
    made = tilescope.sample(seed=3, **arguments)
    assert run["samples"][-1] == len(made)
    assert (run["conflicts"][-1], run["gaps"][-1]) == (0, 0)


def test_only_numbers_that_mean_something_in_a_field_are_followed():
    with pytest.raises(ValueError, match='"covering_radius_r" is not followed where the radius varies'):
        tilescope.curve(radius_expression="0.02 + 0.04*x", numbers=["covering_radius_r"])
    with pytest.raises(ValueError, match="levels is given with shape"):
        tilescope.curve(shape=PARK, radius=1, levels=2)


def test_numbers_do_not_depend_on_where_a_rectangle_lies():
    runs = [tilescope.curve(500, moments=5, **at) for at in [{}, {"origin": (1, 2)}, {"extent": (1, 2, 2, 3)}]]
    assert str(runs[1]) == str(runs[0]) == str(runs[2])


def test_conflicts_come_by_tiling_and_go_by_elimination():
    run = tilescope.curve(radius=0.04, numbers=["conflicts"])
    stages = np.array(run["stage"])
    assert run["conflicts"][stages == "tile"].max() > 0
    assert run["conflicts"][stages == "finish"].tolist() == [0]


def test_moments_are_spread_and_without_numbers_there_is_no_spectrum():
    run = tilescope.curve(500, moments=7)
    assert len(run["event"]) == 7 and "covering_radius_r" in run and "peak" not in run
    assert len(tilescope.curve(500, numbers=["peak"], moments=3)["peak"]) == 3


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"numbers": ["conflict"]}, 'there is no number "conflict"; those that can be had at every moment are samples'),
        ({"numbers": ["mean_sides"]}, "measured of whole sets alone"),
        ({"numbers": []}, "no number is named"),
        ({"moments": 1}, "at least 2 are needed"),
        ({"levels": 3, "method": "reference"}, "levels need 'kdrt'"),
        ({"method": "exact", "order": "index"}, "order is given with method 'exact'"),
        ({"radius": 0.0001}, "at most 2000000"),
    ],
)
def test_what_cannot_be_had_is_refused(arguments, said):
    with pytest.raises(ValueError, match=re.escape(said)):
        tilescope.curve(**({"radius": 0.05} | arguments))


def test_a_text_is_no_list_of_numbers():
    with pytest.raises(TypeError, match="it must be a list of keys"):
        tilescope.curve(radius=0.05, numbers="gaps")
