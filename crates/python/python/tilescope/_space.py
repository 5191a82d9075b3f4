"""Space without end: windows of a set of balls that is never made as a whole."""

from __future__ import annotations

from typing import Any, SupportsIndex

import numpy as np
import numpy.typing as npt

from tilescope import _tilescope
from tilescope._progress import Progress, following


class Space:
    """Space without end, filled by one set of balls, from which any window can be computed alone.

    Windows agree: a sample of one lies in every other one that contains its place, to the bit, on every machine and for
    any number of threads. A space can be pickled, so that tasks of Dask or Ray make its windows block by block. Away from
    its sides, ``tilescope.sample(size=..., radius=..., seed=...)`` has the same samples.

    Parameters
    ----------
    radius : float
        No two samples are within it of each other, and no place is farther than ``(1 + 2**-15) * radius`` from all samples.
    seed : int
        The seed of all random draws.

    Examples
    --------
    >>> space = tilescope.Space(radius=1, seed=7)
    >>> window = space.window(-3, 50, 0, 2, 55, 5)
    >>> 60 < len(window) < 120
    True
    >>> part = space.window(-1, 50, 0, 2, 52, 5)
    >>> bool((part[:, None] == window).all(axis=2).any(axis=1).all())
    True
    >>> space.is_valid(-3, 50, 0, 2, 55, 5)
    True
    """

    __slots__ = ("_radius", "_seed", "_space")

    def __init__(self, *, radius: float, seed: SupportsIndex = 1) -> None:
        self._space = _tilescope.Space(radius, seed)
        self._radius, self._seed = float(radius), int(seed)

    def __reduce__(self) -> tuple[Any, ...]:
        """Returns what :mod:`copy` and :mod:`pickle` make the same space from."""
        return _space_of, (self._radius, self._seed)

    @property
    def radius(self) -> float:
        """The Poisson-disk radius."""
        return self._radius

    @property
    def seed(self) -> int:
        """The seed of all random draws."""
        return self._seed

    def window(
        self, x0: float, y0: float, z0: float, x1: float, y1: float, z1: float, *, progress: Progress = False
    ) -> npt.NDArray[np.float64]:
        """Returns the samples with ``x0 <= x < x1``, ``y0 <= y < y1`` and ``z0 <= z < z1``.

        Parameters
        ----------
        x0, y0, z0, x1, y1, z1 : float
            The corners, at most 65,280 radii from the origin on each axis.
        progress
            As in :func:`sample`.

        Returns
        -------
        numpy.ndarray of shape (N, 3)
            The positions, in the order in which they arrived in the space; read-only.

        Raises
        ------
        ValueError
            If the window is empty, too far from the origin, or has more than 2e8 samples.
        """
        with following(progress) as told:
            return self._space.window((x0, y0, z0, x1, y1, z1), told)

    def is_valid(
        self, x0: float, y0: float, z0: float, x1: float, y1: float, z1: float, *, progress: Progress = False
    ) -> bool:
        """Returns whether a window has no conflict and no gap, judged by the samples in it and around it."""
        with following(progress) as told:
            conflicts, gaps = self._space.verify((x0, y0, z0, x1, y1, z1), told)
        return conflicts == gaps == 0

    def __repr__(self) -> str:
        return f"<Space: radius {self.radius:.6g}, seed {self.seed}>"


def _space_of(radius: float, seed: int) -> Space:
    return Space(radius=radius, seed=seed)
