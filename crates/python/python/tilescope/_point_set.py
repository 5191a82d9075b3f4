"""Point sets: positions with their domain and radius, and what can be done with them."""

from __future__ import annotations

import json
import math
import operator
import os
import warnings
from typing import Any, Literal, SupportsIndex, TypeAlias

import numpy as np
import numpy.typing as npt

from tilescope import _parquet, _tilescope
from tilescope._input import Path, local_path, numbers, place, shown
from tilescope._progress import Progress, following
from tilescope._report import Domain, Level, Report, report_of, report_of_json
from tilescope._spectrum import Spectrum, axes

Boundary: TypeAlias = Literal["periodic", "bounded"]
Judge: TypeAlias = Literal["delaunay", "circles", "both"]
Format: TypeAlias = Literal[
    "csv", "psa-text", "psa-rps", "utk-text", "utk-binary", "npy", "ply-ascii", "ply-binary", "xyz", "json", "geojson",
    "svg", "geoparquet",
]
Window: TypeAlias = tuple[float, float, float, float]

# Samples of a picture in a notebook: more would be too small to see.
_SHOWN = 2500


class PointSet:
    """Positions with their domain and radius.

    :func:`tilescope.sample`, :func:`tilescope.read` and :func:`tilescope.combine` return one.
    Positions from elsewhere become one here, and can then be verified, measured, drawn and saved.

    Parameters
    ----------
    points : array_like of shape (N, 2)
        Positions; they are copied.
    radius : float, optional
        The Poisson-disk radius, in the unit of the positions. What needs it raises ``ValueError``
        if it is not given.
    width, height : float
        The domain, which has one corner at the origin.
    boundary : {'periodic', 'bounded'}
        How the domain ends.

    Raises
    ------
    ValueError
        If the array has another shape or masked values, or no set can have the domain.
    TypeError
        If the array has complex numbers, texts or dates.

    Examples
    --------
    >>> import numpy as np, tilescope
    >>> lattice = np.stack(np.meshgrid(np.arange(8), np.arange(8)), axis=-1).reshape(-1, 2) / 8
    >>> tilescope.PointSet(lattice, radius=1 / 8).verify().valid
    True
    """

    __slots__ = (
        "_certificate", "_domain", "_drawing", "_first_of", "_ground", "_levels", "_method", "_origin", "_parameters", "_points", "_provenance", "_radius",
        "_ranks", "_summary",
    )  # fmt: skip

    def __init__(
        self,
        points: npt.ArrayLike,
        radius: float | None = None,
        *,
        width: float = 1.0,
        height: float = 1.0,
        boundary: Boundary = "periodic",
    ) -> None:
        copy = numbers("points", points)
        if copy.ndim != 2 or copy.shape[1] != 2:
            raise ValueError(f"points has the shape {copy.shape}; it must be (N, 2)")
        copy.flags.writeable = False
        _tilescope.check_domain(radius, width, height, boundary)
        self._points = copy
        self._radius = None if radius is None else float(radius)
        self._domain = Domain(float(width), float(height), boundary)
        self._origin = (0.0, 0.0)
        self._ground: _tilescope.Ground | None = None
        self._levels: tuple[Level, ...] = ()
        self._ranks: npt.NDArray[np.float64] | None = None
        self._provenance: npt.NDArray[np.uint32] | None = None
        self._method = "unknown"
        self._parameters = "{}"
        self._summary: dict[str, Any] | None = None
        # How many samples were made, if the set is the first of those.
        self._first_of: int | None = None
        # How samples are drawn as dots, if the set is a stipple.
        self._drawing: _tilescope.DrawingFields | None = None
        self._certificate: str | None = None

    @classmethod
    def _made(cls, parts: _tilescope.MadeSet, ground: _tilescope.Ground | None = None) -> PointSet:
        """Returns a set that the native module made, whose arrays are read-only."""
        made = cls.__new__(cls)
        made._take(parts, ground)
        return made

    def _take(self, parts: _tilescope.MadeSet, ground: _tilescope.Ground | None) -> None:
        """Takes over a set that the native module made."""
        points, provenance, ranks, facts = parts
        known = json.loads(facts)
        self._ground = ground
        self._points, self._provenance, self._ranks = points, provenance, ranks
        self._radius = known["radius"]
        self._domain = Domain(*known["domain"])
        x, y = known.get("origin", (0.0, 0.0))
        self._origin = (x, y)
        self._levels = tuple(Level(*level) for level in known["levels"])
        self._method = known["method"]
        self._parameters = json.dumps(known["parameters"])
        self._summary = known["summary"]
        self._first_of = known.get("made")
        self._drawing = None
        stated = known.get("certificate")
        self._certificate = None if stated is None else json.dumps(stated)

    @classmethod
    def _on(cls, points: npt.ArrayLike, ground: _tilescope.Ground) -> PointSet:
        """Returns positions in a domain as a set whose radius varies or that covers a shape."""
        width, height, boundary = ground.domain()
        made = cls(points, ground.least(), width=width, height=height, boundary=boundary)
        made._ground, made._origin = ground, ground.origin()
        return made

    def __setstate__(self, state: tuple[None, dict[str, Any]]) -> None:
        """Takes over a copy, by :mod:`copy` or :mod:`pickle`, whose arrays are read-only as well."""
        for name, value in state[1].items():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
            setattr(self, name, value)

    @property
    def points(self) -> npt.NDArray[np.float64]:
        """The positions: a read-only array of shape ``(N, 2)``, always the same one."""
        return self._points

    @property
    def radius(self) -> float | None:
        """The Poisson-disk radius, if it is known; where it varies, the least one."""
        return self._radius

    @property
    def radii(self) -> npt.NDArray[np.float64] | None:
        """The radius of each sample: a read-only array of shape ``(N,)``. ``None`` if the radius is not known.

        Examples
        --------
        >>> ramp = tilescope.sample(radius_expression="0.02 + 0.03*x")
        >>> bool((abs(ramp.radii - (0.02 + 0.03 * ramp.points[:, 0])) < 1e-5).all())
        True
        """
        if self._ground is not None:
            radii = self._ground.radii(self._points)
            if len(radii) == len(self):
                return radii
        if self._radius is None:
            return None
        return np.broadcast_to(self._radius, len(self))

    @property
    def domain(self) -> Domain:
        """Width, height and boundary of the domain."""
        return self._domain

    @property
    def origin(self) -> tuple[float, float]:
        """Where files hold the lower corner of the domain: :attr:`points` are positions relative to it.

        It is what ``sample`` or ``read`` was given or, of a set that was read, what its certificate states; else 0, 0.

        Examples
        --------
        >>> trees = tilescope.sample(radius=2, width=100, height=80, origin=(500_000, 5_400_000))
        >>> trees.origin, bool((trees.points < 100).all())
        ((500000.0, 5400000.0), True)
        """
        return self._origin

    @property
    def method(self) -> str:
        """How the set was made: ``'kdrt'``, ``'exact'``, ``'reference'``, ``'combined'``, or what a certificate states."""
        return self._method

    @property
    def parameters(self) -> dict[str, Any]:
        """Every parameter of the method by its name, as certificates state them."""
        parameters: dict[str, Any] = json.loads(self._parameters)
        return parameters

    @property
    def levels(self) -> tuple[Level, ...]:
        """The nested levels, if the set was made with ``levels``: what holds for all samples to the end of each.

        Examples
        --------
        >>> points = tilescope.sample(radius=0.02, levels=3)
        >>> [level.count for level in points.levels]
        [438, 837, 1724]
        >>> points.levels[0].covering == 2 * points.radius
        True
        """
        return self._levels

    @property
    def level(self) -> npt.NDArray[np.uint32] | None:
        """The level that adds each sample, from 0: an array of shape ``(N,)``. ``None`` if there are no levels."""
        if not self._levels:
            return None
        counts = np.diff([0, *(level.count for level in self._levels)])
        return np.repeat(np.arange(len(counts), dtype=np.uint32), counts)

    @property
    def rank(self) -> npt.NDArray[np.float64] | None:
        """The rank of each sample of nested levels, a number in [0, 1): a read-only array of shape ``(N,)``.

        The samples with ranks below t are evenly spread for every t, and about so large a share of all. Of levels 0 to J
        those of level j are the ones below 2**(j - J). Where t is painted, no two are closer than the radius of
        the finest level in use. A sample has the same rank in every window of a :class:`Plane`. ``None`` if there are no
        levels, or if the set was read from a file without ranks.

        Examples
        --------
        A density that grows from left to right, without a new set:

        >>> points = tilescope.sample(radius=0.01, levels=6)
        >>> kept = points.points[points.rank < points.points[:, 0]]
        >>> 0.48 < len(kept) / len(points) < 0.52
        True

        Below a constant the samples are the first ones, which :meth:`prefix` takes with what holds for them:

        >>> points.prefix((points.rank < 0.3).sum()).verify().valid
        True
        """
        return self._ranks

    def prefix(self, count: SupportsIndex) -> PointSet:
        """Returns the first samples of a set with nested levels, as a set with the levels that they hold.

        Its radius is the largest that is promised for their distances. What is promised, and verified, of
        their covering radius is in :attr:`levels`. If it does without the last levels, its ranks go up to 1 again.

        Parameters
        ----------
        count : int
            How many samples.

        Raises
        ------
        ValueError
            If the set has no levels, or fewer samples.

        Examples
        --------
        >>> points = tilescope.sample(radius=0.02, levels=3)
        >>> points.prefix(1000).verify().valid
        True
        """
        if not self._levels:
            raise ValueError("the set has no levels, which say what holds for its first samples")
        most = min(len(self), self._levels[-1].count)
        count = operator.index(count)
        if not 1 <= count <= most:
            raise ValueError(f"count is {shown(count)}; it must be between 1 and {most}, the number of samples")
        last = Level(*_tilescope.prefix(self._levels, count))
        first = PointSet(
            self._points[:count], last.distance, width=self._domain.width, height=self._domain.height,
            boundary=self._domain.boundary,  # type: ignore[arg-type]
        )  # fmt: skip
        first._levels = (*(level for level in self._levels if level.count < count), last)
        if self._ranks is not None and self._radius is not None:
            # The threshold of the last level that is left, a power of two, becomes 1.
            thresholds = 2.0 ** round(2 * math.log2(last.distance / self._radius))
            first._ranks = self._ranks[:count] * thresholds
            first._ranks.flags.writeable = False
        first._origin = self._origin
        first._method = self._method
        first._parameters = json.dumps({"prefix": count, "of": self.parameters})
        return first

    @property
    def summary(self) -> dict[str, Any] | None:
        """Counts of the run that made the set: blocks, tiled, dropped, eliminated, and inserted by iteration."""
        return None if self._summary is None else dict(self._summary)

    @property
    def provenance(self) -> npt.NDArray[np.uint32] | None:
        """Where each sample came from: block, index in the pattern, iteration.

        An array of shape ``(N, 3)``. 2**32 - 1 stands for the block and the index of a sample that
        was inserted, iteration 0 for one that was not. ``None`` for sets expected to have more than
        a million samples, and where it is not known. Files ``.ply`` and ``.json`` keep it.
        """
        return self._provenance

    @property
    def digest(self) -> str:
        """The BLAKE3 digest of the positions. Two sets have the same one if they agree to the bit and in order."""
        return _tilescope.digest(self)

    @property
    def certificate(self) -> dict[str, Any]:
        """What is known of the set and was verified: parameters, domain, radius, verdict, measures, digests.

        Of a set that was read from a file with a certificate, it is that certificate, as the file
        states it; :func:`tilescope.verify` says of a file whether it is true. Of other sets, it is
        the certificate of a ``.npy`` file of the set, verified when it is first asked for.
        """
        if self._certificate is None:
            self._certificate = _tilescope.certify(self, None)
        stated: dict[str, Any] = json.loads(self._certificate)
        return stated

    def verify(self, *, judge: Judge | None = None, progress: Progress = False) -> Report:
        """Returns the verifier's report: whether the set is conflict-free and maximal for its radius.

        Of a set with nested levels each level is judged as well, and the set is valid if all are as
        :attr:`levels` says.

        Parameters
        ----------
        judge : {'delaunay', 'circles', 'both'}, optional
            Who judges. If not given, both do up to 2**20 samples, and covered circles for more. Where the radius varies
            or there is a shape, ``'subdivision'`` judges alone: squares are cut until each is seen to be covered.
        progress : bool or callable
            Whether to show a bar, or what to call with the work's name, what is done and all there
            is to do.

        Examples
        --------
        >>> tilescope.sample(2000).verify()
        <Report: valid, ... samples, 0 conflicts, 0 gaps, smallest distance 1.00... r, covering radius ... r>
        """
        with following(progress) as told:
            return report_of_json(_tilescope.verify(self, judge, told))

    def save(
        self,
        path: Path,
        *,
        format: Format | None = None,
        precision: Literal["f32", "f64"] = "f64",
        shuffle: SupportsIndex | None = None,
        origin: tuple[float, float] | None = None,
        verify: bool = True,
        judge: Judge | None = None,
        progress: Progress = False,
    ) -> Report | None:
        """Writes the set to a file, with a certificate beside it.

        The file is read back and verified before it gets its name; a file of that name stays as it
        is if anything fails. An invalid set is written all the same, with a warning, and its
        certificate says so.

        Parameters
        ----------
        path : path-like
            The file. Its extension gives the format: ``.npy``, ``.csv``, ``.ply``, ``.json``,
            ``.txt`` and ``.rps`` of psa, ``.dat`` and ``.bin`` of UTK, ``.xyz``, ``.svg``, ``.geojson``; with pyarrow
            ``.parquet``, which is GeoParquet with positions in f64 and has no certificate. Where the radius varies, CSV, PLY,
            GeoJSON and GeoParquet have the radius of each sample as well, and of nested levels its level and its rank.
        format : str, optional
            The format, if the extension does not give it.
        precision : {'f64', 'f32'}
            Number type, for formats that leave the choice. Rounding to f32 makes conflicts in large
            sets.
        shuffle : int, optional
            Seed of an order to write the samples in, so that the first ones are spread evenly. A set
            with nested levels keeps its order.
        origin : (x, y), optional
            Where the file holds the lower corner of the domain, which is added to positions. If not given, the set's
            :attr:`origin`; ``(0, 0)`` leaves that out. The certificate states it, and earlier versions refuse the
            file.
        verify : bool
            Whether to verify and to certify.
        judge, progress
            As in :meth:`verify`.

        Returns
        -------
        Report or None
            The report on what the file holds, if it was verified.

        Raises
        ------
        OSError
            If the file cannot be written.
        ValueError
            If the format is not known, or cannot hold the set, or nested levels are to be shuffled; if numbers around
            the origin are so far apart that rounding would spoil the set.

        Examples
        --------
        >>> tilescope.sample(2000).save(folder / "set.npy").valid
        True
        >>> tilescope.verify(folder / "set.npy").passed
        True
        """
        name = local_path(path)
        origin = self._origin if origin is None else place("origin", origin)
        if self._ground is not None and origin != self._origin:
            raise ValueError(
                f"origin is {shown(origin)}, but the set's field or shape lies at {shown(self._origin)}; leave it out"
            )
        if _parquet.is_to_write(name, format):
            # No certificate would state it, so that the file would be read as one of another domain.
            if origin != (0.0, 0.0) and self._ground is None:
                raise ValueError(
                    f"the origin is {shown(origin)}, but GeoParquet has no certificate that states it; "
                    "give origin=(0, 0), or another format"
                )
            if precision != "f64" or shuffle is not None:
                raise ValueError("GeoParquet is written with precision 'f64' and without shuffle")
            return self._save_parquet(name, origin, verify, judge, progress)
        with following(progress) as told:
            outcome = json.loads(
                _tilescope.save(
                    self, name, format_name=format, precision=precision, shuffle=shuffle, origin=origin,
                    verify=verify, judge=judge, progress=told,
                )
            )  # fmt: skip
        for warning in outcome["warnings"]:
            # That a format does not keep where samples came from is no fault.
            if not warning.startswith("note: "):
                warnings.warn(warning, stacklevel=2)
        return None if outcome["report"] is None else report_of(outcome["report"])

    def _save_parquet(
        self, path: str, origin: tuple[float, float], verify: bool, judge: Judge | None, progress: Progress
    ) -> Report | None:
        stored = self._points + origin
        # As for other formats the verdict is on what is stored: far from 0 positions are rounded.
        held = self if self._ground is None else PointSet._on(stored - origin, self._ground)
        # The first dots of a few more are judged as that, as they are in other formats.
        held._first_of = self._first_of
        report = held.verify(judge=judge, progress=progress) if verify else None
        varies = self._ground is not None and self._ground.varies()
        columns = {"level": self.level, "rank": self.rank, "radius": self.radii if varies else None}
        known = {name: column for name, column in columns.items() if column is not None}
        _tilescope.write_file(path, _parquet.encoded(stored, known))
        if report is not None and report.conflicts:
            warnings.warn(f"the written set has {report.conflicts} pairs in conflict", stacklevel=3)
        if report is not None and report.gaps:
            warnings.warn(f"the written set is not maximal: {report.gaps} places are uncovered", stacklevel=3)
        return report

    def spectrum(self, nu: float | None = None, *, progress: Progress = False) -> Spectrum:
        """Returns the spectrum: power over frequency.

        Parameters
        ----------
        nu : float, optional
            The largest relative frequency. If not given, 2.5, or 1023 cycles along a side where
            that is less.
        progress
            As in :meth:`verify`.

        Examples
        --------
        >>> spectrum = tilescope.sample(2000).spectrum()
        >>> bool(spectrum.power[spectrum.frequencies < 0.5].max() < 0.2)
        True
        """
        with following(progress) as told:
            return Spectrum(**_tilescope.spectrum(self, nu, told))

    def pair_correlation(
        self, *, progress: Progress = False
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Returns distances and g there: how many pairs are so far apart, relative to independent random samples.

        Distances are in units of ``r_max``, the smallest distance in the densest packing of as many
        samples.

        Examples
        --------
        >>> distances, g = tilescope.sample(2000).pair_correlation()
        >>> float(g[distances < 0.6].max())
        0.0
        """
        with following(progress) as told:
            distances, g = _tilescope.pair_correlation(self, told).T
        return distances, g

    def plot(self, ax: Any = None, *, disks: bool | None = None) -> Any:
        """Draws the set with matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; the current axes if not given.
        disks : bool, optional
            Whether to draw the disks. If not given, they are drawn around up to a thousand samples.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.
        """
        ax = axes(ax)
        count = len(self)
        width, height, _ = self.domain
        if self.radius is not None and (count <= 1000 if disks is None else disks):
            from matplotlib.collections import EllipseCollection

            sides = 2 * np.asarray(self.radii)
            circles = EllipseCollection(
                sides, sides, np.zeros(count), units="xy", offsets=self.points, offset_transform=ax.transData,
                facecolor=(0.2, 0.4, 0.8, 0.04), edgecolor=(0.2, 0.4, 0.8, 0.3), linewidth=0.5,
            )  # fmt: skip
            ax.add_collection(circles)
        # About as wide as a third of the distance to the nearest neighbour.
        inches = ax.get_window_extent().width / ax.figure.dpi
        size = 72 * inches / max(width, height) * np.sqrt(width * height / max(count, 1)) / 3
        ax.scatter(*self.points.T, s=float(np.clip(size, 0.5, 8)) ** 2, linewidths=0)
        ax.set(xlim=(0, width), ylim=(0, height), aspect="equal")
        return ax

    def draw(
        self,
        path: Path,
        *,
        size: SupportsIndex = 1600,
        window: Window | None = None,
        disks: bool = True,
        theme: Literal["light", "dark"] = "light",
        progress: Progress = False,
    ) -> None:
        """Saves a picture, as ``tilescope draw`` does. It needs no matplotlib.

        Of a set of millions of samples give a window: the whole takes long. A file of that name stays as it is
        if anything fails.

        Parameters
        ----------
        path : path-like
            The picture: ``.png`` or ``.svg``.
        size : int
            Its width in pixels, from 16 to 32768.
        window : (x0, y0, x1, y1), optional
            The part of the domain to draw.
        disks : bool
            Whether to draw the disks, where they are large enough to see.
        theme : {'light', 'dark'}
            Its colours.
        progress
            As in :meth:`verify`.

        Raises
        ------
        ValueError
            If an argument is wrong, or the file is a set with a certificate.
        OSError
            If the file cannot be written.
        """
        name = local_path(path)
        extension = os.path.splitext(name)[1].lower()
        if extension not in (".png", ".svg"):
            raise ValueError(f"the picture is called {shown(name)}; its extension must be .png or .svg")
        picture = self._picture(
            svg=extension == ".svg", size=size, window=window, disks=disks, theme=theme, progress=progress
        )
        _tilescope.write_file(name, picture)

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
        radius = "" if self.radius is None else f", r = {self._radius_text()}"
        caption = f"{len(self)} samples{radius}{part}"
        with following(progress) as told:
            return _tilescope.draw(
                self, caption=caption, svg=svg, size=size, window=window, disks=disks, theme=theme, progress=told
            )

    def _repr_png_(self) -> bytes | None:
        """Returns the picture that notebooks show."""
        count = len(self)
        if count == 0:
            return None
        width, height, _ = self.domain
        window, part = None, ""
        if count > _SHOWN:
            # As much of a corner as holds so many samples, no longer than the domain.
            side = (width * height * _SHOWN / count) ** 0.5
            window, part = (0.0, 0.0, min(side, width), min(side, height)), "; a corner"
        return self._picture(svg=False, size=800, window=window, disks=True, theme="light", part=part)

    def __len__(self) -> int:
        return len(self._points)

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        """Returns the positions: a set can be given where numpy takes an array."""
        array = self._points if dtype is None else self._points.astype(dtype, copy=False)
        return array.copy() if copy else array

    def __repr__(self) -> str:
        width, height, boundary = self.domain
        shape = ", in a shape" if self._ground is not None and self._ground.has_shape() else ""
        return f"<PointSet: {len(self)} samples, radius {self._radius_text()}, {width:g} x {height:g}, {boundary}{shape}>"

    def _radius_text(self) -> str:
        if self._ground is not None and self._ground.varies():
            return f"{self._ground.least():.4g} to {self._ground.greatest():.4g}"
        return "unknown" if self.radius is None else f"{self.radius:.6g}"
