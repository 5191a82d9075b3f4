"""The spectrum of a set."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, repr=False, eq=False)
class Spectrum:
    """The power of a set at each frequency, as the field's diagrams show it.

    The power is 1 at every frequency for independent random samples. Frequencies are relative:
    ``nu = |k| / sqrt(N)``, with ``k`` in cycles along the side of a square domain of ``N`` samples.
    """

    frequencies: npt.NDArray[np.float64]
    """``nu`` of each ring of frequencies, rising."""
    power: npt.NDArray[np.float64]
    """Mean power of each ring."""
    anisotropy: npt.NDArray[np.float64]
    """How much the power varies within each ring, in decibels: 0 without a preferred direction; NaN
    where a ring has too few frequencies."""
    bands: npt.NDArray[np.float64] | None
    """Ends of the interval that holds each ring's true mean power with probability 0.95, shape
    ``(rings, 2)``. ``None`` for a bounded domain."""
    picture: npt.NDArray[np.float64]
    """The periodogram on at most 121 x 121 cells, row by row from the lowest; zero frequency in the middle."""
    picture_reach: tuple[float, float]
    """Half of the picture's extent along x and y, as ``nu``."""
    effective_nyquist: float | None
    """The largest frequency below which the mean power stays under 0.1; 1 for a square lattice.
    ``None`` for a set too small for it."""
    oscillation: float | None
    """How strongly the power oscillates about 1 beyond the first frequency where it is nearly 1."""

    def plot(self, ax: Any = None) -> Any:
        """Draws power over frequency with matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; the current axes if not given.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.
        """
        ax = axes(ax)
        if self.bands is not None:
            ax.fill_between(self.frequencies, *self.bands.T, alpha=0.25, linewidth=0)
        ax.plot(self.frequencies, self.power)
        ax.axhline(1, color="gray", linewidth=0.8, linestyle="--")
        ax.set(xlabel=r"frequency $\nu = |k| / \sqrt{N}$", ylabel=r"power $P(\nu)$", xlim=(0, None), ylim=(0, None))
        return ax

    def __eq__(self, other: object) -> bool:
        """Returns whether another spectrum has the same numbers. NaN counts as equal to NaN."""
        if not isinstance(other, Spectrum):
            return NotImplemented
        return all(_same(getattr(self, field.name), getattr(other, field.name)) for field in fields(self))

    def __repr__(self) -> str:
        return f"<Spectrum: {len(self.frequencies)} rings up to nu = {self.frequencies[-1]:.3f}>"


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return type(one) is type(other) and np.array_equal(one, other, equal_nan=True)
    return bool(one == other)


def axes(ax: Any) -> Any:
    """Returns axes to draw in."""
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("plots need matplotlib: pip install matplotlib") from error
    return pyplot.gca()
