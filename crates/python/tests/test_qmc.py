"""The engine passes scipy's own tests of its PoissonDisk, in the plane, and holds where scipy's does not."""

import copy
import inspect
import pickle
import re
import subprocess
import sys
import threading
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import qmc_quad
from scipy.spatial import cKDTree
from scipy.stats.tests import test_qmc as theirs

import tilescope
from tilescope import qmc


def in_the_plane(source: str) -> str:
    """Scipy's tests, which also take other dimensions, with 2 in their place."""
    source = source.replace("d=3", "d=2").replace("PoissonDisk(1,", "PoissonDisk(2,")
    source = source.replace("dimensions = [1, 3, 4]", "dimensions = [2]")
    # Corners of boxes.
    return re.sub(r"(\[-?\d+, -?\d+), -?\d+\]", r"\1]", source)


_NAMES = vars(theirs) | {"qmc": SimpleNamespace(PoissonDisk=qmc.PoissonDisk)}
exec(compile(in_the_plane(inspect.getsource(theirs.TestPoisson)), theirs.__file__, "exec"), _NAMES)


class TestPoisson(_NAMES["TestPoisson"]):
    # Lloyd's relaxation enlarges the smallest distance of samples that are so even only for some seeds. The one of
    # scipy's test of optimizers is such a seed.

    def test_0dim(self):
        with pytest.raises(ValueError, match="d is 0; .* so it must be 2 or 3: scipy.stats.qmc.PoissonDisk has other dim"):
            self.engine(d=0, scramble=False)

    # That bounds have another dimension than three is found before the dimension is looked at.
    test_inconsistent_bounds = theirs.TestPoisson.test_inconsistent_bounds
    # Scipy's own engine is let off from these.
    test_fast_forward = theirs.QMCEngineTests.test_fast_forward
    test_continuing = theirs.QMCEngineTests.test_continuing


def test_scipys_tests_are_of_this_engine_in_the_plane():
    assert TestPoisson.qmce is qmc.PoissonDisk
    source = in_the_plane(inspect.getsource(theirs.TestPoisson))
    assert source.count("d=2") >= 8
    assert not re.search(r"d=[013-9]", source)
    ours, scipys = (
        {name: one.default for name, one in inspect.signature(engine).parameters.items()}
        for engine in (qmc.PoissonDisk, stats.qmc.PoissonDisk)
    )
    assert ours == scipys | {"seed": None}


def closest(samples):
    return cKDTree(samples).query(samples, k=2)[0][:, 1].min()


BOXES = [
    # Corner, sides, radius: the unit square, maps in metres, a narrow strip, boxes of less than six radii.
    ([0, 0], [1, 1], 0.02),
    ([5e5, 4e6], [1000, 1000], 10),
    ([5e5, 4e6], [300, 100], 1),
    ([-4e6, 5e5], [30, 20], 0.125),
    ([5e5, 4e6], [2000, 9], 10),
    ([0, 0], [1, 1], 0.2),
    ([-3, 7], [0.5, 2.5], 0.7),
    ([0, 0], [1, 1], 3),
]


@pytest.mark.parametrize(("corner", "sides", "radius"), BOXES)
@pytest.mark.parametrize("seed", [1, 2])
def test_sets_are_conflict_free_and_maximal_at_any_coordinates(corner, sides, radius, seed):
    corner, sides = np.array(corner), np.array(sides)
    engine = qmc.PoissonDisk(2, radius=radius, rng=seed, l_bounds=corner, u_bounds=corner + sides)
    samples = np.concatenate([engine.random(5), engine.fill_space()])
    assert ((corner < samples) & (samples < corner + sides)).all()
    if len(samples) > 1:
        assert closest(samples) >= radius
    width, height = sides
    report = tilescope.verify(samples - corner, radius, width=width, height=height, boundary="bounded")
    # Differences of such coordinates are exact.
    assert report.valid
    assert engine.num_generated == len(samples)
    assert engine.random(3).shape == engine.fill_space().shape == (0, 2)


@pytest.mark.parametrize(("corner", "sides", "radius"), [([0, 0, 0], [1, 1, 1], 0.1), ([5e5, 4e6, -9], [70, 50, 41], 10)])
def test_sets_in_space_are_conflict_free_and_maximal(corner, sides, radius):
    corner, sides = np.array(corner), np.array(sides)
    engine = qmc.PoissonDisk(3, radius=radius, rng=1, l_bounds=corner, u_bounds=corner + sides)
    samples = np.concatenate([engine.random(5), engine.fill_space()])
    assert ((corner < samples) & (samples < corner + sides)).all()
    assert closest(samples) >= radius
    offsets = np.clip(samples - corner, 0, sides)
    assert tilescope.verify_solid(offsets, radius, size=tuple(sides), boundary="bounded").valid
    assert engine.random(3).shape == engine.fill_space().shape == (0, 3)
    # Control: without its first sample the set has a gap.
    assert not tilescope.verify_solid(offsets[1:], radius, size=tuple(sides), boundary="bounded").maximal
    again = qmc.PoissonDisk(3, radius=radius, rng=1, l_bounds=corner, u_bounds=corner + sides)
    assert np.array_equal(again.random(7), samples[:7])
    assert copy.deepcopy(again).random(2).shape == (2, 3)


def test_scipys_engine_has_conflicts_at_large_coordinates_and_gaps():
    corner = np.array([5e5, 4e6])
    engine = stats.qmc.PoissonDisk(2, radius=20, rng=1, l_bounds=corner, u_bounds=corner + 1000)
    samples = engine.fill_space()
    assert closest(samples) < 20
    assert not tilescope.verify(samples - corner, 20, width=1000, height=1000, boundary="bounded").maximal


def test_the_sequence_goes_on_and_its_prefixes_are_spread_evenly():
    engine = qmc.PoissonDisk(2, radius=0.02, rng=3)
    parts = [engine.random(count) for count in (1, 0, 100, 400)]
    first = np.concatenate(parts)
    whole = qmc.PoissonDisk(2, radius=0.02, rng=3).fill_space()
    assert np.array_equal(first, whole[:501])
    # Random samples: about 2.6 as far.
    alone = tilescope.verify(first, 0.02, boundary="bounded").covering_radius
    assert alone < 2.2 * np.sqrt(1 / (np.pi * 501))
    assert closest(first) > 1.2 * 0.02


def test_seeds_come_from_the_generator():
    def samples(**given):
        return qmc.PoissonDisk(2, **given).random(10)

    assert np.array_equal(samples(rng=5), samples(rng=np.random.default_rng(5)))
    assert np.array_equal(samples(seed=5), samples(seed=5))
    assert not np.array_equal(samples(rng=5), samples(rng=6))
    assert not np.array_equal(samples(), samples())
    generator = np.random.default_rng(1)
    assert not np.array_equal(samples(rng=generator), samples(rng=generator))
    assert np.array_equal(samples(seed=np.random.RandomState(7)), samples(seed=np.random.RandomState(7)))
    with pytest.raises(TypeError):
        samples(rng=1, seed=1)


def test_engines_are_copied_with_their_place_in_the_sequence():
    engine = qmc.PoissonDisk(2, rng=1)
    engine.random(20)
    for again in (pickle.loads(pickle.dumps(engine)), copy.deepcopy(engine)):
        assert np.array_equal(again.random(20), copy.deepcopy(engine).random(20))


def test_scipy_integrates_with_it():
    value = qmc_quad(lambda x: x[0] * x[1], [0, 0], [1, 1], n_points=250, qrng=qmc.PoissonDisk(2, rng=1)).integral
    assert value == pytest.approx(0.25, abs=0.01)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"d": 4}, "d is 4; tilescope.qmc.PoissonDisk samples the plane and space"),
        ({"d": 3, "radius": 0.26}, "a side of the box is 3.846 radii long; in space at least 4.001"),
        ({"d": 3, "radius": 0}, "the radius is 0; it must be a finite number above 0"),
        ({"d": 2, "radius": 0}, "the radius is 0; it must be a finite number above 0"),
        ({"d": 2, "u_bounds": [np.inf, 1]}, "not supported"),
        ({"d": 2, "u_bounds": [0, 1]}, "Bounds are not consistent"),
        ({"d": 2, "optimization": "none"}, "not a valid optimization"),
    ],
)
def test_wrong_arguments_are_refused(arguments, text):
    with pytest.raises(ValueError, match=text):
        qmc.PoissonDisk(**arguments)


@pytest.mark.parametrize("method", ["random", "fast_forward"])
def test_wrong_counts_are_refused(method):
    engine = qmc.PoissonDisk(2, radius=0.05, rng=1)
    first = engine.random(10)
    for count in (-1, -(10**400)):
        with pytest.raises(ValueError, match="n is -1.*; it must be at least 0"):
            getattr(engine, method)(count)
    for count in (2.5, 2.0, np.inf, "2", None, 1j):
        with pytest.raises(TypeError, match="n is .*; it must be a whole number"):
            getattr(engine, method)(count)
    # The sequence is where it was.
    assert engine.num_generated == 10
    rest = engine.fill_space()
    assert np.array_equal(np.concatenate([first, rest]), qmc.PoissonDisk(2, radius=0.05, rng=1).fill_space())
    # More than there are is no fault.
    assert len(getattr(engine.reset(), method)(10**400) if method == "random" else rest) > 0


def test_numbers_of_numpy_are_counts():
    engine = qmc.PoissonDisk(2, radius=0.05, rng=1)
    assert len(engine.random(np.int64(3))) == 3
    assert engine.fast_forward(np.uint8(2)).num_generated == 5


def test_threads_share_a_sequence():
    whole = qmc.PoissonDisk(2, radius=0.01, rng=1).fill_space()
    shared = qmc.PoissonDisk(2, radius=0.01, rng=1)
    start, taken = threading.Barrier(8), []

    def take():
        start.wait()
        for _ in range(50):
            taken.append(shared.random(7))
            shared.fast_forward(1)

    threads = [threading.Thread(target=take) for _ in range(8)]
    switch = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    finally:
        sys.setswitchinterval(switch)
    assert shared.num_generated == 8 * 50 * 8
    # Each thread has pieces of the sequence, and no sample is given twice.
    at = {tuple(sample): index for index, sample in enumerate(whole.tolist())}
    found = [[at[tuple(sample)] for sample in piece.tolist()] for piece in taken]
    assert all(piece == list(range(piece[0], piece[0] + 7)) for piece in found)
    assert len({index for piece in found for index in piece}) == 8 * 50 * 7


@pytest.mark.parametrize(
    ("corner", "side", "radius"),
    [(1e12, 100, 10), (-1e12, 100, 10), (5e5, 1e-3, 1e-6), (0, 1e12, 1e-6)],
)
def test_bounds_where_rounding_would_leave_places_uncovered_are_refused(corner, side, radius):
    bounds = {"l_bounds": [corner, 0], "u_bounds": [corner + side, 1]}
    with pytest.raises(ValueError, match=r"floating-point numbers are .* apart, more than 1e-05 of the radius") as error:
        qmc.PoissonDisk(2, radius=radius, **bounds)
    least, low, high = re.search(r"at least (\S+), or bounds within (\S+) and (\S+)$", str(error.value)).groups()
    # What the error advises does, and less does not.
    qmc.PoissonDisk(2, radius=float(least), **bounds)
    with pytest.raises(ValueError, match="apart"):
        qmc.PoissonDisk(2, radius=0.4 * float(least), **bounds)
    qmc.PoissonDisk(2, radius=radius, l_bounds=[float(low), 0], u_bounds=[float(high), 1])
    with pytest.raises(ValueError, match="apart"):
        qmc.PoissonDisk(2, radius=radius, u_bounds=[2.1 * float(high)] * 2)


def test_as_far_as_the_engine_goes_the_box_is_covered():
    # The largest spacing that is not refused: 2**-17 of the radius, a little less than 1e-5.
    corner, radius = np.array([2.0**40, -(2.0**40)]), 2.0**5
    assert np.spacing(corner[0]) * 2**17 == radius
    upper = corner + [1000, 900]
    engine = qmc.PoissonDisk(2, radius=radius, rng=1, l_bounds=corner, u_bounds=upper)
    samples = engine.fill_space()
    assert closest(samples) >= radius
    report = tilescope.verify(samples - corner, radius, width=1000, height=900, boundary="bounded")
    assert report.conflicts == 0
    assert report.covering_radius <= radius * (1 + 2.0**-15) + 8 * np.spacing(corner[0])


@pytest.mark.parametrize(
    ("bounds", "error"), [(np.ma.masked_array([0, 0], [1, 0]), ValueError), ([0, 1j], TypeError), (["0", "0"], TypeError)]
)
def test_bounds_are_real_numbers(bounds, error):
    with pytest.raises(error, match="l_bounds has"):
        qmc.PoissonDisk(2, l_bounds=bounds)


def test_samples_are_limited():
    with pytest.raises(ValueError, match="at most 2e8"):
        qmc.PoissonDisk(2, radius=2e-5).random(1)


def test_without_scipy_the_error_says_so():
    code = "import sys; sys.modules['scipy'] = None; import tilescope; import tilescope.qmc"
    outcome = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert outcome.stderr.endswith("ImportError: tilescope.qmc needs scipy: pip install scipy\n")
