"""What several tests use."""

import matplotlib
import pytest

import tilescope

matplotlib.use("agg")


@pytest.fixture(scope="session")
def small() -> tilescope.PointSet:
    """A set of about 1700 samples."""
    return tilescope.sample(radius=0.02, seed=7)


@pytest.fixture(scope="session")
def holed(small: tilescope.PointSet) -> tilescope.PointSet:
    """The same set with one sample left out: it has a gap."""
    return tilescope.PointSet(small.points[1:], 0.02)


@pytest.fixture(scope="session")
def crowded(small: tilescope.PointSet) -> tilescope.PointSet:
    """The same set with one sample too many, near another: it has a conflict."""
    points = small.points.tolist()
    return tilescope.PointSet([*points, [points[0][0] + 0.001, points[0][1]]], 0.02)
