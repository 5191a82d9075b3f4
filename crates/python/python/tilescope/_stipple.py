"""Stipples: dots as dense as an image is dark."""

from __future__ import annotations

import operator
from typing import Any, Literal, SupportsIndex

import numpy as np
import numpy.typing as npt

from tilescope import _tilescope
from tilescope._input import Path, shown
from tilescope._point_set import PointSet, Window
from tilescope._progress import Progress, following
from tilescope._spectrum import axes

# The width of a picture in a notebook, in pixels.
_NOTEBOOK = 800


class Stipple(PointSet):
    """Dots as dense as an image is dark, exactly as many as were asked for. :func:`tilescope.stipple` returns one.

    The dots are the first of a set of a few more, in the sequence of their arrival: each beginning of them is the image with
    fewer dots. :meth:`verify` judges them as such a beginning. No two dots are near each other, and every place is within
    :attr:`Report.covering_factor` times its radius of a dot. What is saved is certified as that. Positions begin at the lower
    left corner of the image, with y upwards.

    Examples
    --------
    >>> import numpy as np, tilescope
    >>> ramp = np.linspace(0, 255, 120).astype(np.uint8)[None, :].repeat(80, axis=0)
    >>> dots = tilescope.stipple(ramp, dots=1000)
    >>> dots
    <Stipple: the first 1000 of ... dots, radius ... to ..., 120 x 80>
    >>> bool((dots.points[:, 0] < 60).mean() > 0.7)
    True
    """

    __slots__ = ("_black", "_capped", "_runs")

    _black: float
    _capped: int
    _runs: int

    @classmethod
    def _stippled(
        cls, parts: _tilescope.MadeSet, ground: _tilescope.Ground, found: tuple[int, float, int, _tilescope.DrawingFields]
    ) -> Stipple:
        made = cls.__new__(cls)
        made._take(parts, ground)
        made._runs, made._black, made._capped, made._drawing = found
        return made

    @property
    def made(self) -> int:
        """How many dots were made, of which the set has the first ones."""
        return len(self) if self._first_of is None else self._first_of

    @property
    def runs(self) -> int:
        """How many sets were made until one had as many dots, and few more."""
        return self._runs

    @property
    def black_radius(self) -> float:
        """The radius where the image is black."""
        return self._black

    @property
    def capped_pixels(self) -> int:
        """How many pixels with dots are too light for the largest radius, at most 64 times the least, and have that radius.

        Dots are denser there than the image is dark.
        """
        return self._capped

    @property
    def dot_radii(self) -> npt.NDArray[np.float64]:
        """How large each dot is in pictures: a read-only array of shape ``(N,)`` of radii, in the unit of the positions.

        All are equal unless ``dot_size`` is ``'darkness'``. Then they are the larger the darker the image is.
        """
        _, _, by_darkness, number = self._look()
        if not by_darkness:
            return np.broadcast_to(number, len(self))
        radii = number / np.asarray(self.radii)
        radii.flags.writeable = False
        return radii

    @property
    def paper(self) -> str:
        """The colour of the paper in pictures, as ``'#rrggbb'``."""
        return _hex(self._look()[0])

    @property
    def ink(self) -> str:
        """The colour of the dots in pictures, as ``'#rrggbb'``."""
        return _hex(self._look()[1])

    def _look(self) -> _tilescope.DrawingFields:
        # A stipple has a look from the time when it is made.
        assert self._drawing is not None
        return self._drawing

    def prefix(self, count: SupportsIndex) -> Stipple:
        """Returns the first dots, as a stipple: the image with fewer dots, of the same size each.

        Parameters
        ----------
        count : int
            How many dots.

        Raises
        ------
        ValueError
            If the stipple has fewer.

        Examples
        --------
        >>> dots = tilescope.stipple(np.full((60, 60), 100, dtype=np.uint8), dots=500)
        >>> fewer = dots.prefix(200)
        >>> len(fewer), fewer.verify().valid
        (200, True)
        """
        wanted = operator.index(count)
        if not 1 <= wanted <= len(self):
            raise ValueError(f"count is {shown(wanted)}; it must be between 1 and {len(self)}, the number of dots")
        first = Stipple.__new__(Stipple)
        first.__setstate__((None, {name: getattr(self, name) for name in (*PointSet.__slots__, *Stipple.__slots__)}))
        first._points = self._points[:wanted]
        # It is that of all dots.
        first._certificate = None
        return first

    def plot(self, ax: Any = None, *, disks: bool | None = None) -> Any:
        """Draws the dots with matplotlib, in ink on paper.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; the current axes if not given.
        disks : bool, optional
            Whether to draw disks of the radii of samples around points, as for other sets, in place of dots.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.
        """
        if disks:
            return super().plot(ax, disks=True)
        from matplotlib.collections import EllipseCollection

        ax = axes(ax)
        width, height, _ = self.domain
        sides = 2 * self.dot_radii
        dots = EllipseCollection(
            sides, sides, np.zeros(len(self)), units="xy", offsets=self.points, offset_transform=ax.transData,
            facecolor=self.ink, linewidth=0,
        )  # fmt: skip
        ax.add_collection(dots)
        ax.set(xlim=(0, width), ylim=(0, height), aspect="equal", facecolor=self.paper)
        return ax

    def draw(
        self,
        path: Path,
        *,
        size: SupportsIndex = 1600,
        window: Window | None = None,
        disks: bool = False,
        theme: Literal["light", "dark"] = "light",
        progress: Progress = False,
    ) -> None:
        """Saves a picture of the dots in ink on paper, as ``tilescope stipple`` does. It needs no matplotlib.

        It has no certificate: :meth:`save` writes an SVG file that is a picture and a certified set at once. A file of that
        name stays as it is if anything fails.

        Parameters
        ----------
        path : path-like
            The picture: ``.png`` or ``.svg``.
        size : int
            Its width in pixels, from 16 to 32768.
        window : (x0, y0, x1, y1), optional
            The part of the image to draw.
        disks : bool
            Whether to draw disks of the radii of samples around points, as for other sets, in place of dots.
        theme : {'light', 'dark'}
            The colours of a picture of disks.
        progress
            As in :meth:`verify`.

        Raises
        ------
        ValueError
            If an argument is wrong, or the file is a set with a certificate.
        OSError
            If the file cannot be written.
        """
        super().draw(path, size=size, window=window, disks=disks, theme=theme, progress=progress)

    def _picture(
        self,
        *,
        svg: bool,
        size: SupportsIndex,
        window: Window | None,
        disks: bool,
        theme: str,
        part: str = "",
        progress: Progress = False,
    ) -> bytes:
        if disks:
            return super()._picture(
                svg=svg, size=size, window=window, disks=True, theme=theme, part=part, progress=progress
            )
        with following(progress) as told:
            radii = np.ascontiguousarray(self.dot_radii)
            return _tilescope.draw_dots(self, radii, svg=svg, size=size, window=window, progress=told)

    def _repr_png_(self) -> bytes | None:
        """Returns the picture that notebooks show."""
        return self._picture(svg=False, size=_NOTEBOOK, window=None, disks=False, theme="light")

    def __repr__(self) -> str:
        width, height, _ = self.domain
        return (
            f"<Stipple: the first {len(self)} of {self.made} dots, radius {self._radius_text()}, {width:g} x {height:g}>"
        )


def _hex(color: tuple[int, int, int]) -> str:
    return "#{:02x}{:02x}{:02x}".format(*color)


class Arguments:
    """What a stipple is made with beside its image. The native module reads its attributes."""

    __slots__ = (
        "by_darkness", "contrast", "dot_radius", "dots", "gamma", "ink", "invert", "paper", "run_on", "seed", "white", "width",
    )  # fmt: skip

    def __init__(self, dot_size: str, **given: Any) -> None:
        if dot_size not in ("constant", "darkness"):
            raise ValueError(f"dot_size is {shown(dot_size)}; it must be 'constant' or 'darkness'")
        self.by_darkness = dot_size == "darkness"
        for name in ("invert", "run_on"):
            if not isinstance(given[name], (bool, np.bool_)):
                raise TypeError(f"{name} is {shown(given[name])}; it must be True or False")
            given[name] = bool(given[name])
        for name in ("paper", "ink"):
            if not (given[name] is None or isinstance(given[name], str)):
                raise TypeError(f"{name} is {shown(given[name])}; it must be text: '#rrggbb', 'black' or 'white'")
        for name, value in given.items():
            setattr(self, name, value)
