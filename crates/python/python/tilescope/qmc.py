"""Poisson-disk sampling with the interface of :mod:`scipy.stats.qmc`, which it needs.

Examples
--------
>>> from tilescope import qmc
>>> engine = qmc.PoissonDisk(2, radius=0.05, rng=1)
>>> engine.random(100).shape, engine.random(100).shape
((100, 2), (100, 2))
>>> len(engine.fill_space())
101
"""

from __future__ import annotations

import operator
import threading
from typing import Any, Literal, SupportsIndex

import numpy as np
import numpy.typing as npt

import tilescope
from tilescope import _tilescope
from tilescope._input import numbers, shown

try:
    from scipy.spatial import cKDTree  # type: ignore[import-untyped]
    from scipy.stats import qmc  # type: ignore[import-untyped]
except ImportError as error:
    raise ImportError("tilescope.qmc needs scipy: pip install scipy") from error

__all__ = ["PoissonDisk"]

# The shortest side of a box for `tilescope.sample`, in radii: 6, and room for rounding.
_SHORTEST_SIDE = 6.001

# The shortest side of a box in space, in radii: 4, and room for rounding.
_SHORTEST_SIDE_IN_SPACE = 4.001

_MOST_LEVELS = 3

# The widest spacing of the floating-point numbers at the bounds, in radii: rounding to wider ones would leave places
# farther than a radius from all samples.
_WIDEST_SPACING = 1e-5


def __dir__() -> list[str]:
    return sorted([*__all__, "__doc__", "__name__"])


class PoissonDisk(qmc.QMCEngine):  # type: ignore[misc]
    """Poisson-disk sampling of a box in the plane or in space, in place of :class:`scipy.stats.qmc.PoissonDisk`.

    No two samples are closer than `radius`, at any coordinates. After :meth:`fill_space` no sample could be
    added: no place of the box is farther than ``(1 + 2**-15) * radius``, and eight times the spacing of
    floating-point numbers at the bounds, from all samples. All samples lie between the bounds.

    The samples are one sequence, whose first ones are spread evenly, however many they are:
    :meth:`random` continues it. It is made as a whole when its first sample is asked for. The sequence is
    that of ``tilescope.sample(..., boundary="bounded", levels=K, order_within="farthest")``, with as many
    levels as the box has room for, at most 3; in a box with a side shorter than 6 radii it is one of darts.
    In space it is the order of arrival in ``tilescope.sample(size=..., boundary="bounded")``.
    Threads may share an engine: each sample is given to one of them.

    Parameters
    ----------
    d : int
        Dimension: 2 or 3. Scipy's engine has others. In space sides have at least 4.001 radii.
    radius : float
        The smallest distance between two samples.
    hypersphere : {'volume', 'surface'}, optional
    ncandidates : int
        Scipy's ways of searching, which have no effect: no place is missed.
    optimization : {None, 'random-cd', 'lloyd'}, optional
        Whether scipy is to move the samples afterwards. They may then be closer than `radius`. Lloyd's
        relaxation seldom spreads the first samples more evenly than they are.
    rng : numpy.random.Generator or int, optional
        Where the seed is drawn from. Equal generators give equal samples on every machine.
    l_bounds, u_bounds : array_like of shape (d,)
        Corners of the box; those of the unit square or cube if they are not given.
    seed : int or numpy.random.RandomState, optional
        Scipy's former name of `rng`.

    Raises
    ------
    ValueError
        If an argument is wrong, or floating-point numbers at the bounds are more than 1e-5 radii apart. That
        the box is longer than 65532 radii, or would have more than 2e8 samples, is found when the first sample is
        asked for.

    Examples
    --------
    >>> corner = np.array([500_000, 4_000_000])
    >>> engine = PoissonDisk(2, radius=10, rng=1, l_bounds=corner, u_bounds=corner + 1000)
    >>> samples = engine.fill_space()
    >>> tilescope.verify(samples - corner, 10, width=1000, height=1000, boundary="bounded").valid
    True
    """

    def __init__(
        self,
        d: int,
        *,
        radius: float = 0.05,
        hypersphere: Literal["volume", "surface"] = "volume",
        ncandidates: int = 30,
        optimization: Literal["random-cd", "lloyd"] | None = None,
        rng: Any = None,
        l_bounds: npt.ArrayLike | None = None,
        u_bounds: npt.ArrayLike | None = None,
        seed: Any = None,
    ) -> None:
        given = {name: value for name, value in (("rng", rng), ("seed", seed)) if value is not None}
        super().__init__(d, optimization=optimization, **given)

        if hypersphere not in ("volume", "surface"):
            raise ValueError(
                f"{shown(hypersphere)} is not a valid hypersphere sampling method. It must be 'volume' or 'surface'"
            )

        lower = numbers("l_bounds", 0.0 if l_bounds is None else l_bounds)
        upper = numbers("u_bounds", 1.0 if u_bounds is None else u_bounds)
        try:
            lower, upper = np.broadcast_to(lower, d), np.broadcast_to(upper, d)
        except ValueError as error:
            raise ValueError(
                "'l_bounds' and 'u_bounds' must be broadcastable and respect the sample dimension"
            ) from error
        if not np.all(lower < upper):
            raise ValueError("Bounds are not consistent 'l_bounds' < 'u_bounds'")

        if d not in (2, 3):
            raise ValueError(
                f"d is {d}; tilescope.qmc.PoissonDisk samples the plane and space, so it must be 2 or 3: "
                "scipy.stats.qmc.PoissonDisk has other dimensions"
            )

        width, height, *depths = (upper - lower).tolist()
        _tilescope.check_domain(radius, width, height, "bounded")
        shortest = min(width, height, *depths)
        if depths and shortest < _SHORTEST_SIDE_IN_SPACE * radius:
            raise ValueError(
                f"a side of the box is {shortest / radius:.4g} radii long; in space at least {_SHORTEST_SIDE_IN_SPACE} are "
                "needed: choose a smaller radius"
            )
        _check_spacing(float(np.abs([lower, upper]).max()), radius)

        self.radius = radius
        self.l_bounds, self.u_bounds = lower, upper

        # Scipy's qmc_quad makes its engines from these.
        self._init_quad = {
            "d": d, "radius": radius, "hypersphere": hypersphere, "ncandidates": ncandidates,
            "optimization": optimization,
        }  # fmt: skip
        self._sequence: npt.NDArray[np.float64] | None = None

        # Methods call each other.
        self._lock = threading.RLock()

    def __getstate__(self) -> dict[str, Any]:
        """Returns what a copy is made from. It has a lock of its own."""
        with self._lock:
            return {name: value for name, value in self.__dict__.items() if name != "_lock"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _lock=threading.RLock())

    def _samples(self) -> npt.NDArray[np.float64]:
        """Returns the whole sequence."""
        if self._sequence is None:
            draw = getattr(self.rng, "integers", None) or self.rng.randint
            seed = int(draw(2**63, dtype=np.int64))

            lower, upper = self.l_bounds, self.u_bounds
            sides = upper - lower
            # Rounding a sum, and moving it off a bound, changes a coordinate by less than two of its last digits.
            radius = self.radius + 4 * np.spacing(np.abs([lower, upper]).max())

            room = sides.min() / (_SHORTEST_SIDE * radius)
            if len(sides) == 3:
                x, y, z = sides.tolist()
                offsets = tilescope.sample(radius=radius, size=(x, y, z), boundary="bounded", seed=seed).points
            # Too narrow for tiles: KDRT needs a domain of several radii.
            elif room < 1:
                offsets = _samples_of_narrow_box(sides, radius, np.random.default_rng(seed))
            else:
                width, height = sides.tolist()
                offsets = tilescope.sample(
                    radius=radius, width=width, height=height, boundary="bounded", seed=seed,
                    levels=min(_MOST_LEVELS, 1 + int(2 * np.log2(room))), order_within="farthest",
                ).points  # fmt: skip

            self._sequence = np.clip(offsets + lower, np.nextafter(lower, upper), np.nextafter(upper, lower))
        return self._sequence

    def random(self, n: SupportsIndex = 1, *, workers: int = 1) -> npt.NDArray[np.float64]:
        """Returns the next `n` samples of the sequence, or as many as there are left.

        Parameters
        ----------
        n : int
            How many.
        workers : int, optional
            Has no effect.

        Returns
        -------
        numpy.ndarray of shape (n, d)
            The samples.

        Raises
        ------
        TypeError
            If `n` is no whole number.
        ValueError
            If it is below 0.
        """
        count = _count(n)
        with self._lock:
            left = len(self._samples()) - self.num_generated
            if min(count, left) == 0:
                return np.empty((0, self.d))
            sample: npt.NDArray[np.float64] = super().random(min(count, left), workers=workers)
            return sample

    def _random(self, n: int = 1, *, workers: int = 1) -> npt.NDArray[np.float64]:
        return self._samples()[self.num_generated : self.num_generated + n].copy()

    def fill_space(self) -> npt.NDArray[np.float64]:
        """Returns the rest of the sequence: with the samples returned before, no other fits in between.

        Returns
        -------
        numpy.ndarray of shape (n, d)
            The samples.
        """
        with self._lock:
            return self.random(len(self._samples()) - self.num_generated)

    def reset(self) -> PoissonDisk:
        """Goes back to the first sample.

        Returns
        -------
        PoissonDisk
            The engine.
        """
        with self._lock:
            super().reset()
        return self

    def fast_forward(self, n: SupportsIndex) -> PoissonDisk:
        """Passes over `n` samples, or as many as there are left.

        Returns
        -------
        PoissonDisk
            The engine.

        Raises
        ------
        TypeError
            If `n` is no whole number.
        ValueError
            If it is below 0: a sequence goes forwards; :meth:`reset` goes back to its beginning.
        """
        count = _count(n)
        with self._lock:
            self.num_generated += min(count, len(self._samples()) - self.num_generated)
        return self


def _count(n: SupportsIndex) -> int:
    try:
        count = operator.index(n)
    except TypeError as error:
        raise TypeError(f"n is {shown(n)}; it must be a whole number") from error
    if count < 0:
        raise ValueError(f"n is {shown(n)}; it must be at least 0")
    return count


def _check_spacing(farthest: float, radius: float) -> None:
    """Raises ``ValueError`` if positions at such a coordinate would be rounded too much for such a radius."""
    spacing = float(np.spacing(farthest))
    if spacing > _WIDEST_SPACING * radius:
        # Both are given with a hundredth to spare, for three digits of them are shown.
        reach = 0.99 * 2.0 ** np.floor(np.log2(_WIDEST_SPACING * radius) + 53)
        raise ValueError(
            f"at the bounds, which reach to {farthest:g}, floating-point numbers are {spacing:.3g} apart, more than "
            f"{_WIDEST_SPACING:g} of the radius, {radius:g}: rounded to them, samples would leave places uncovered; give "
            f"a radius of at least {1.01 * spacing / _WIDEST_SPACING:.3g}, or bounds within -{reach:.3g} and {reach:.3g}"
        )


# Rounds of darts, each with more darts than samples fit into the box, before gaps are searched for.
_ROUNDS = 12

# Gaps are searched for on circles that are larger by this, so that no rounding puts a sample closer than the radius.
_ENLARGED = 1 + 2.0**-40


def _samples_of_narrow_box(
    sides: npt.NDArray[np.float64], radius: float, rng: np.random.Generator
) -> npt.NDArray[np.float64]:
    """Returns a maximal set of a box: darts, then samples at corners of gaps, in random order, while there are any."""
    samples = np.empty((0, 2))
    darts = int(np.prod(sides / radius + 1)) + 1
    turn = 0

    while True:
        turn += 1
        places = rng.random((darts, 2)) * sides
        # Darts hardly ever hit the last gaps; the corners of these lie in them.
        if turn > _ROUNDS:
            places = rng.permutation(_corners_of_gaps(samples, sides, radius))
            if len(places) == 0:
                return samples

        if len(samples) > 0:
            places = places[cKDTree(samples).query(places)[0] > radius]
        if len(places) == 0:
            continue

        chosen: list[int] = []
        covered = np.zeros(len(places), dtype=bool)
        for index, near in enumerate(cKDTree(places).query_ball_point(places, radius)):
            if not covered[index]:
                chosen.append(index)
                covered[near] = True

        samples = np.concatenate([samples, places[chosen]])


def _corners_of_gaps(
    samples: npt.NDArray[np.float64], sides: npt.NDArray[np.float64], radius: float
) -> npt.NDArray[np.float64]:
    """Returns the uncovered places among the corners of the box and the crossings of circles with it and with each other.

    Every gap has such a corner: its outer border is made of arcs that bend inwards, and of pieces of the box.
    """
    enlarged = radius * _ENLARGED
    tree = cKDTree(samples)
    found = [np.array([[x, y] for x in (0.0, sides[0]) for y in (0.0, sides[1])])]

    # The two places where the circles of a pair cross, on the line across its middle.
    one, other = samples[tree.query_pairs(2 * enlarged, output_type="ndarray").T]
    middle, half = (one + other) / 2, (other - one) / 2
    away = np.sqrt(np.maximum(enlarged**2 / (half**2).sum(axis=1) - 1, 0))[:, None] * half[:, ::-1] * [-1, 1]
    found += [middle + away, middle - away]

    # Where circles cross the sides of the box.
    for axis in (0, 1):
        for line in (0.0, sides[axis]):
            square = enlarged**2 - (samples[:, axis] - line) ** 2
            near = samples[square >= 0]
            along = np.sqrt(square[square >= 0])
            for sign in (-1, 1):
                place = near.copy()
                place[:, axis] = line
                place[:, 1 - axis] += sign * along
                found.append(place)

    places = np.concatenate(found)
    places = places[((places >= 0) & (places <= sides)).all(axis=1)]
    uncovered: npt.NDArray[np.float64] = places[tree.query(places)[0] > radius]
    return uncovered
