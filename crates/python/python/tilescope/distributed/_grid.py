"""The tiles of a domain: their borders, their samples, and the verdict on one of them."""

from __future__ import annotations

import functools
import math
import operator
import re
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tilescope import Domain, PointSet, _tilescope
from tilescope._point_set import Judge, Window
from tilescope._progress import ProgressFunction

Positions = npt.NDArray[np.float64]

# Lattice units in a radius; domains have fewer than twice as many radii.
_UNITS = 1 << 15
# Samples in a squared radius, as the limits of windows count them.
_DENSITY = 0.696
_MOST_SAMPLES = 2e8
_MOST_SIDES = 1000
# How far around a tile samples are taken to judge it, in radii. 2 would suffice.
_HALO = 4


@dataclass(frozen=True)
class Grid:
    """The tiles that a domain is cut into: ``shape`` of them along x and y.

    Tiles are numbered row by row, from the lower left one. Two neighbours have the same number as
    their border, and it belongs to the upper or right one of them.
    """

    domain: Domain
    radius: float
    shape: tuple[int, int]

    @classmethod
    def of(cls, domain: Domain, radius: float, rows: int) -> Grid:
        """Returns nearly square tiles that have about `rows` samples at most."""
        side = radius * math.sqrt(rows / _DENSITY)
        return cls(domain, radius, (math.ceil(domain.width / side), math.ceil(domain.height / side)))

    @property
    def sides(self) -> tuple[float, float]:
        """Width and height of the domain."""
        return self.domain.width, self.domain.height

    def __len__(self) -> int:
        return self.shape[0] * self.shape[1]

    def place(self, index: int) -> tuple[int, int]:
        """Returns the column and the row of a tile."""
        row, column = divmod(index, self.shape[0])
        return column, row

    def file(self, index: int) -> str:
        """Returns the name of a tile's file."""
        column, row = self.place(index)
        return f"tile-{row:05}-{column:05}.parquet"

    def has_file(self, name: str) -> bool:
        """Returns whether a name is that of a tile's file."""
        found = re.fullmatch(r"tile-(\d{5,10})-(\d{5,10})\.parquet", name)
        if found is None:
            return False
        row, column = map(int, found.groups())
        return column < self.shape[0] and row < self.shape[1] and name == self.file(row * self.shape[0] + column)

    def borders(self, axis: int) -> Positions:
        """Returns where tiles begin along an axis, and where the last one ends."""
        side, tiles = self.sides[axis], self.shape[axis]
        return np.array([*(tile * (side / tiles) for tile in range(tiles)), side])

    def bounds(self, index: int) -> Window:
        """Returns the corners of a tile."""
        column, row = self.place(index)
        x, y = self.borders(0), self.borders(1)
        return float(x[column]), float(y[row]), float(x[column + 1]), float(y[row + 1])

    def tiles_of(self, positions: Positions) -> npt.NDArray[np.int64]:
        """Returns the number of the tile that each position lies in."""
        column, row = (np.searchsorted(self.borders(axis)[1:-1], positions[:, axis], side="right") for axis in (0, 1))
        return row * self.shape[0] + column

    def holds(self, index: int, positions: Positions) -> npt.NDArray[np.bool_]:
        """Returns which positions lie in a tile. The border of a bounded domain belongs to the tiles along it."""
        inside = np.ones(len(positions), dtype=bool)
        bounds = self.bounds(index)
        for axis in (0, 1):
            low, high, along = bounds[axis], bounds[axis + 2], positions[:, axis]
            inside &= (low <= along) & ((along < high) | (high == self.sides[axis]))
        return inside

    def surroundings(self, bounds: Window) -> Window:
        """Returns the window from which a tile is judged: the tile with a halo, as far as the domain reaches."""
        halo = _HALO * self.radius
        low, high = list(bounds[:2]), list(bounds[2:])
        for axis in (0, 1):
            side = self.sides[axis]
            low[axis], high[axis] = low[axis] - halo, high[axis] + halo
            if self.domain.boundary == "bounded":
                low[axis], high[axis] = max(low[axis], 0.0), min(high[axis], side)
            elif high[axis] - low[axis] >= side:
                low[axis], high[axis] = 0.0, side
        return low[0], low[1], high[0], high[1]

    def judge(
        self, near: Positions, bounds: Window, judge: Judge | None, progress: ProgressFunction | None
    ) -> tuple[int, int]:
        """Returns how many conflicts and gaps a tile has, by its samples and those around it.

        The verifier judges positions from the lower corner of the surroundings. Rounding moves them
        by at most 2**-36 radii; two samples of the lattice are 2**-31 radii farther apart than they must be.
        """
        halo, sides = _HALO * self.radius, self.sides
        low, high = [at - halo for at in bounds[:2]], [at + halo for at in bounds[2:]]
        if self.domain.boundary == "bounded":
            low = [max(at, 0.0) for at in low]
            high = [min(at, side) for at, side in zip(high, sides, strict=True)]

        size = [end - start for start, end in zip(low, high, strict=True)]
        cut = near - low

        if self.domain.boundary == "periodic":
            for axis, side in enumerate(sides):
                along = cut[:, axis]
                # Samples beyond a seam are moved to where the surroundings reach over it.
                along[along < 0] += side
                along[along >= side] -= side
                if size[axis] > side:
                    # Surroundings that are longer than the domain have samples twice.
                    again = cut.copy()
                    again[:, axis] += side
                    cut = np.concatenate([cut, again])
            cut = cut[(cut <= size).all(axis=1)]

        places = PointSet(cut, self.radius, width=size[0], height=size[1], boundary="bounded")
        x0, y0, x1, y1 = bounds
        window = (x0 - low[0], y0 - low[1], x1 - low[0], y1 - low[1])

        return _tilescope.verify_window(places, window, judge, progress)

    def lattice(self) -> Lattice:
        """Returns the lattice of the domain."""
        return Lattice(self)


class Lattice:
    """The whole numbers that samples have on the lattice of a domain, which decide about windows and order."""

    def __init__(self, grid: Grid) -> None:
        self._grid = grid
        self._units = []
        for side in grid.sides:
            units = math.floor(side / grid.radius * _UNITS)
            while side / units * _UNITS < grid.radius:
                units -= 1
            self._units.append(units)

    def _first(self, axis: int, position: float) -> int:
        """Returns the first number whose position is not below `position`."""
        unit = self._grid.sides[axis] / self._units[axis]
        first = math.floor(position / unit)
        # The quotient is rounded differently than positions are.
        while first * unit < position:
            first += 1
        while (first - 1) * unit >= position:
            first -= 1
        return first

    def _spans(self, axis: int, low: float, high: float) -> list[tuple[int, int]]:
        """Returns the numbers of a window along an axis, from and up to, in the domain."""
        side, units, bounded = self._grid.sides[axis], self._units[axis], self._grid.domain.boundary == "bounded"
        name = ("width", "height")[axis]
        if not (math.isfinite(low) and math.isfinite(high) and 0 < high - low <= side):
            raise ValueError(
                f"the window's {name} runs from {low:g} to {high:g}; it must be finite, above 0 and at most "
                f"{side:g} long"
            )

        limit = _MOST_SIDES * side
        if abs(low) > limit:
            raise ValueError(f"the window's {name} begins at {low:,.12g}; it must begin between {-limit:,.12g} and {limit:,.12g}")

        start, end = self._first(axis, low), self._first(axis, high)
        if bounded:
            start, end = max(start, 0), units + 1 if high >= side else end

        if start >= end:
            raise ValueError(
                f"the window's {name} runs from {low:g} to {high:g}, which holds no place of the domain's 0 to {side:g}"
            )

        if bounded:
            return [(start, end)]

        # A window over the seam of a periodic domain is two spans, one at each end of the domain.
        end, shift = min(end, start + units), start // units * units
        start, end = start - shift, end - shift
        return [span for span in ((0, end - units), (start, min(end, units))) if span[0] < span[1]]

    def spans(self, window: Window) -> list[list[tuple[int, int]]]:
        """Returns the numbers of a window along both axes, or raises ``ValueError`` as windows of planes do."""
        x0, y0, x1, y1 = map(float, window)
        spans = [self._spans(0, x0, x1), self._spans(1, y0, y1)]
        across, up = (sum(end - start for start, end in along) / _UNITS for along in spans)
        if across * up * _DENSITY > _MOST_SAMPLES:
            raise ValueError(
                f"about {across * up * _DENSITY:.3e} samples lie in the window; it may have {_MOST_SAMPLES:.0e}: "
                "choose a smaller one"
            )
        return spans

    def tiles(self, spans: list[list[tuple[int, int]]]) -> list[int]:
        """Returns the tiles that a window reaches into."""
        found = []
        # By the samples' numbers, since a border rounded another way would give a sample to the neighbour.
        for axis in (0, 1):
            starts = [self._first(axis, float(border)) for border in self._grid.borders(axis)[:-1]]
            ends = [*starts[1:], self._units[axis] + 1]
            found.append(
                [
                    tile
                    for tile, (start, end) in enumerate(zip(starts, ends, strict=True))
                    if any(low < end and start < high for low, high in spans[axis])
                ]
            )
        return [row * self._grid.shape[0] + column for row in found[1] for column in found[0]]

    def inside(self, positions: Positions, spans: list[list[tuple[int, int]]]) -> npt.NDArray[np.bool_]:
        """Returns which samples lie in a window. Positions ascend with their numbers, so that they can be compared."""
        inside = np.ones(len(positions), dtype=bool)
        for axis, (side, units) in enumerate(zip(self._grid.sides, self._units, strict=True)):
            along, unit = positions[:, axis], side / units
            parts = [
                (min(low * unit, side) <= along) & (along < (min(high * unit, side) if high <= units else math.inf))
                for low, high in spans[axis]
            ]
            inside &= functools.reduce(operator.or_, parts)
        return inside

    def sequence(self, positions: Positions) -> npt.NDArray[np.intp]:
        """Returns the order of samples in the whole set: by squares of side r, row by row, and in them by y and x."""
        numbers = np.rint(positions / (np.array(self._grid.sides) / self._units)).astype(np.int64)
        (i, j), bits = numbers.T, _UNITS.bit_length() - 1
        squares = (j >> bits) << bits + 1 | i >> bits
        # One number for each sample: the square's row and column, then y and x within it.
        return np.argsort(squares << 2 * bits | (j & _UNITS - 1) << bits | i & _UNITS - 1, kind="stable")
