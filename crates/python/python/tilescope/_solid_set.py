"""Sets in space: positions with their box and radius, and what can be done with them."""

from __future__ import annotations

import json
import math
import warnings
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, SupportsIndex

import numpy as np
import numpy.typing as npt

from tilescope import _tilescope
from tilescope._input import Path, local_path, numbers, shown
from tilescope._optional import module
from tilescope._progress import Progress, following
from tilescope._report import Conflict

Boundary = Literal["periodic", "bounded"]
SolidJudge = Literal["subdivision", "circles", "both"]


class SolidSlice(NamedTuple):
    """The disks in which a plane meets the balls of a set: a place of it is covered exactly if it lies in one of them."""

    middles: npt.NDArray[np.float64]
    """Middles of the disks, of shape (M, 2): the two coordinates in the plane, in the order x, y, z."""
    radii: npt.NDArray[np.float64]
    """The radius of each disk, by Pythagoras; a ball that only touches the plane has a disk of radius 0."""
    depths: npt.NDArray[np.float64]
    """How far each sample lies above the plane; below it, less than 0."""
    indices: npt.NDArray[np.intp]
    """The rows of the samples in ``points``."""


class SolidGap(NamedTuple):
    """A place that is too far from all samples."""

    center: tuple[float, float, float]
    """The place."""
    distance: float
    """How far it is from there to the nearest sample."""


@dataclass(frozen=True, repr=False)
class SolidReport:
    """What the verifier found out about a set in space. Lengths are in the unit of the samples.

    Two judges, which share no search, decide: one cuts the box into cubes, one looks at the circles in which two spheres
    meet. Neither shares code with the sampler.
    """

    valid: bool
    """Whether the set is both conflict-free and maximal; of a beginning, conflict-free and covering within its factor."""
    conflict_free: bool
    """Whether no two samples are closer than the radius."""
    maximal: bool
    """Whether no sample could be added: no place is farther than ``(1 + covering_tolerance) * radius`` from all."""
    count: int
    """Number of samples."""
    radius: float
    """The radius that was asked about."""
    size: tuple[float, float, float]
    """Width, height and depth of the box that was asked about."""
    boundary: str
    """``'periodic'`` or ``'bounded'``."""
    min_distance: float
    """Smallest distance between two samples; infinite for one sample of a bounded box."""
    covering_radius: float
    """Largest distance from a place of the box to its nearest sample."""
    covering_tolerance: float
    """Relative tolerance of maximality, 2**-15; of a beginning, that of its factor."""
    covering_factor: float | None
    """Of the first samples of a larger set, the factor of the radius within which they cover."""
    conflicts: int
    """Pairs in conflict, counted up to a million."""
    worst_conflicts: tuple[Conflict, ...]
    """The closest of them, at most 16."""
    gaps: int
    """Cubes, or circles, in which a place is uncovered. One hole usually has several."""
    worst_gaps: tuple[SolidGap, ...]
    """The deepest uncovered places, at most 16, deepest first; none is nearer than the radius to a deeper one."""
    density: float
    """``count * radius**3 / volume``."""
    relative_radius: float
    """``min_distance`` over that of as many samples in the densest packing of balls."""
    judges: tuple[str, ...]
    """Who judged: ``'subdivision'`` (cubes), ``'circles'``, or both, which agree."""
    differences: tuple[str, ...] = ()
    """Statements of a file's certificate that do not hold; empty for a set in memory."""

    @property
    def passed(self) -> bool:
        """Whether the set is valid and every statement of its certificate, if it has one, is true."""
        return self.valid and not self.differences

    def __repr__(self) -> str:
        verdict = "valid" if self.valid else "NOT VALID"
        if self.differences:
            verdict += ", CERTIFICATE NOT TRUE"
        r = self.radius
        return (
            f"<SolidReport: {verdict}, {self.count} samples, {self.conflicts} conflicts, {self.gaps} gaps, "
            f"smallest distance {self.min_distance / r:.6f} r, covering radius {self.covering_radius / r:.6f} r>"
        )


def solid_report_of(found: dict[str, Any], differences: list[str] | None = None) -> SolidReport:
    """Returns the report that the native module gave."""
    region = found["region"]
    same = (
        "valid", "conflict_free", "maximal", "count", "radius", "covering_radius", "covering_tolerance",
        "covering_factor", "conflicts", "gaps", "density",
    )  # fmt: skip
    # JSON has no infinity.
    lengths: dict[str, Any] = {
        name: math.inf if found[name] is None else found[name] for name in ("min_distance", "relative_radius")
    }
    return SolidReport(
        size=(region["width"], region["height"], region["depth"]),
        boundary=region["boundary"],
        worst_conflicts=tuple(Conflict(**one) for one in found["worst_conflicts"]),
        worst_gaps=tuple(SolidGap(tuple(one["center"]), one["distance"]) for one in found["worst_gaps"]),
        judges=tuple(found["judges"]),
        differences=tuple(differences or ()),
        **{name: found[name] for name in same},
        **lengths,
    )


def sides(size: Any) -> tuple[float, float, float]:
    """Returns the three sides of a box, or raises ``ValueError`` if they are others than three numbers above 0."""
    array = numbers("size", size)
    if array.shape != (3,):
        raise ValueError(f"size is {shown(size)}; it must be three numbers: (width, height, depth)")
    if not (np.isfinite(array).all() and (array > 0).all()):
        raise ValueError(f"size is {shown(size)}; its sides must be finite and above 0")
    return float(array[0]), float(array[1]), float(array[2])


class SolidSet:
    """Positions in space with their box and radius.

    :func:`tilescope.sample` with `size` and :func:`tilescope.read_solid` return one. Positions from elsewhere become one
    here, and can then be verified and saved.

    Parameters
    ----------
    points : array_like of shape (N, 3)
        Positions; they are copied.
    radius : float
        No two samples are to be closer, and no place of the box farther from all of them.
    size : (width, height, depth)
        The box, which has one corner at the origin.
    boundary : {'periodic', 'bounded'}
        How the box ends.

    Raises
    ------
    ValueError
        If the array has another shape or masked values, or sides or radius are no numbers above 0.

    Examples
    --------
    >>> import tilescope
    >>> balls = tilescope.sample(size=(6, 6, 6), radius=1)
    >>> balls.points.shape == (len(balls), 3), balls.verify().valid
    (True, True)
    """

    def __init__(
        self,
        points: npt.ArrayLike,
        radius: float,
        size: tuple[float, float, float],
        boundary: Boundary = "periodic",
    ) -> None:
        array = numbers("points", points)
        if array.ndim != 2 or array.shape[1] != 3:
            raise ValueError(f"points have the shape {array.shape}; it must be (N, 3)")
        if boundary not in ("periodic", "bounded"):
            raise ValueError(f"boundary is {shown(boundary)}; it must be 'periodic' or 'bounded'")
        if not (math.isfinite(radius) and radius > 0):
            raise ValueError(f"the radius is {shown(radius)}; it must be a finite number above 0")
        array.setflags(write=False)
        width, height, depth = sides(size)
        region = {"width": width, "height": height, "depth": depth, "boundary": boundary}
        self._points = array
        self._arrival: npt.NDArray[np.uint32] | None = None
        self._level: npt.NDArray[np.uint32] | None = None
        self._facts: dict[str, Any] = {
            "method": "unknown", "parameters": {}, "region": region, "radius": float(radius), "made": None,
        }  # fmt: skip

    @classmethod
    def _made(cls, made: _tilescope.MadeSolid) -> SolidSet:
        one = cls.__new__(cls)
        one._points, one._arrival, one._level, facts = made
        one._facts = json.loads(facts)
        return one

    @property
    def points(self) -> npt.NDArray[np.float64]:
        """Positions, of shape (N, 3), in the order of their arrival if the set was made here. It cannot be written to."""
        return self._points

    @property
    def arrival(self) -> npt.NDArray[np.uint32] | None:
        """The place of each sample in the order of arrival, from 0: a read-only array of shape ``(N,)``.

        ``None`` of positions from elsewhere, and of a file that does not say it; PLY and CSV do.
        """
        return self._arrival

    @property
    def level(self) -> npt.NDArray[np.uint32] | None:
        """The level at which each sample arrived, from 0 to 15: a read-only array of shape ``(N,)``.

        It says how often the cubes were halved into which darts were thrown: the later a sample, the smaller the hole that it
        fills. ``None`` as of :attr:`arrival`.

        Examples
        --------
        >>> import tilescope
        >>> balls = tilescope.sample(size=(6, 6, 6), radius=1)
        >>> early = balls.points[balls.level == 0]
        >>> 0 < len(early) < len(balls), bool((balls.level[1:] >= balls.level[:-1]).all())
        (True, True)
        """
        return self._level

    @property
    def radius(self) -> float:
        """The radius."""
        return float(self._facts["radius"])

    @property
    def size(self) -> tuple[float, float, float]:
        """Width, height and depth of the box."""
        region = self._facts["region"]
        return region["width"], region["height"], region["depth"]

    @property
    def boundary(self) -> str:
        """``'periodic'`` or ``'bounded'``."""
        return str(self._facts["region"]["boundary"])

    @property
    def method(self) -> str:
        """How the set was made, as its certificate names it."""
        return str(self._facts["method"])

    @property
    def parameters(self) -> dict[str, Any]:
        """The parameters that make the set again."""
        return dict(self._facts["parameters"])

    @property
    def made(self) -> int | None:
        """How many samples were made, of which these are the first; ``None`` of a whole set."""
        made = self._facts["made"]
        return None if made is None else int(made)

    def __len__(self) -> int:
        return len(self._points)

    def __repr__(self) -> str:
        width, height, depth = self.size
        return (
            f"<SolidSet: {len(self)} samples, radius {self.radius:g}, {width:g} x {height:g} x {depth:g}, {self.boundary}>"
        )

    def verify(self, *, judge: SolidJudge | None = None, progress: Progress = False) -> SolidReport:
        """Judges whether the set is conflict-free and maximal.

        Parameters
        ----------
        judge : {'subdivision', 'circles', 'both'}, optional
            Cubes, covered circles, or both, which must agree: both for up to a million samples, if it is not given.
        progress : bool or callable
            As in :func:`tilescope.sample`.

        Returns
        -------
        SolidReport
            The verdict. A bad set is a report, not an error.

        Raises
        ------
        ValueError
            If there is no set to judge: it is empty, a position is not finite or outside of the box.
        """
        with following(progress) as told:
            found = _tilescope.verify_solid(self._points, json.dumps(self._facts), judge, told)
        return solid_report_of(json.loads(found))

    def slice(self, *, x: float | None = None, y: float | None = None, z: float | None = None) -> SolidSlice:
        """Returns the disks in which a plane meets the balls of the radius, as ``tilescope convert --slice`` writes them.

        Parameters
        ----------
        x, y, z : float
            Where the plane meets an axis at right angles: one of them is given.

        Returns
        -------
        SolidSlice
            Middles, radii and depths of the disks, in the order of the samples.

        Raises
        ------
        ValueError
            If not exactly one of `x`, `y` and `z` is given, or the plane lies beyond the box.
        TypeError
            If what is given is no number.

        Examples
        --------
        >>> import tilescope
        >>> disks = tilescope.sample(size=(6, 6, 6), radius=1).slice(z=2.5)
        >>> disks.middles.shape == (len(disks.radii), 2), bool((disks.radii <= 1).all())
        (True, True)
        """
        given = [(axis, place) for axis, place in enumerate((x, y, z)) if place is not None]
        if len(given) != 1:
            raise ValueError("give one of x, y and z")
        axis, asked = given[0]
        name, side = "xyz"[axis], self.size[axis]
        array = numbers(name, asked)
        if array.shape != ():
            raise ValueError(f"{name} is {shown(asked)}; it must be one number")
        place = float(array)
        # A plane beyond the box would still meet the balls that reach out of it, and look like one inside.
        if not 0 <= place <= side:
            raise ValueError(f"{name} is {shown(place)}; the plane must lie in the box, from 0 to {side:g}")

        depths = self._points[:, axis] - place
        if self.boundary == "periodic":
            # Of the images of a ball the nearest counts: in a box that verifies no other one meets the plane. Halves are
            # rounded away from 0, as the program does, where numpy rounds them to even numbers.
            turns = depths / side
            depths = depths - np.copysign(np.floor(np.abs(turns) + 0.5), turns) * side
        indices = np.flatnonzero(np.abs(depths) <= self.radius)
        depths = depths[indices]
        return SolidSlice(
            np.delete(self._points[indices], axis, axis=1),
            np.sqrt(self.radius * self.radius - depths * depths),
            depths,
            indices,
        )

    def _ages(self) -> npt.NDArray[Any]:
        """Returns a number of each sample by which they are sorted from early to late: their rows if nothing else is known."""
        return np.arange(len(self)) if self._arrival is None else self._arrival

    def to_pyvista(self) -> Any:
        """Returns the samples as a mesh of pyvista, for its plots and for VTK.

        Balls of half the radius never overlap:
        ``balls.to_pyvista().glyph(orient=False, scale=False, geom=pyvista.Sphere(radius=balls.radius / 2)).plot()``.

        Returns
        -------
        pyvista.PolyData
            The samples as points. Its point data has ``order``, which is :attr:`arrival` or else their rows, and ``level``
            if that is known; its field data has ``radius`` and ``size``.

        Raises
        ------
        ImportError
            If there is no pyvista.
        """
        mesh = module("pyvista", "pyvista").PolyData(self._points.copy())
        mesh.point_data["order"] = self._ages()
        if self._level is not None:
            mesh.point_data["level"] = self._level
        mesh.field_data["radius"] = [self.radius]
        mesh.field_data["size"] = list(self.size)
        return mesh

    def plot(self, ax: Any = None) -> Any:
        """Draws the samples with matplotlib, as dots in their box, coloured from early to late.

        Without :attr:`arrival` their order counts as that of arrival.

        ``tilescope draw --orbit`` draws them as balls, cut open at a corner, and :meth:`to_pyvista` gives them to pyvista.

        Parameters
        ----------
        ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
            Where to draw; axes of a new figure if not given.

        Returns
        -------
        mpl_toolkits.mplot3d.axes3d.Axes3D
            The axes.

        Raises
        ------
        ImportError
            If there is no matplotlib.
        TypeError
            If the axes are not of three dimensions.
        """
        if ax is None:
            try:
                from matplotlib import pyplot
            except ImportError as error:
                raise ImportError("plots need matplotlib: pip install matplotlib") from error
            ax = pyplot.figure().add_subplot(projection="3d")
        elif not hasattr(ax, "set_zlim"):
            raise TypeError("the axes are not of three dimensions: projection='3d' makes such")
        ax.scatter(*self._points.T, c=self._ages(), cmap="cividis", s=12, linewidths=0)
        width, height, depth = self.size
        ax.set(xlim=(0, width), ylim=(0, height), zlim=(0, depth), xlabel="x", ylabel="y", zlabel="z")
        ax.set_box_aspect(self.size)
        return ax

    def save(
        self,
        path: Path,
        *,
        format: str | None = None,
        precision: Literal["f32", "f64"] = "f64",
        shuffle: SupportsIndex | None = None,
        verify: bool = True,
        judge: SolidJudge | None = None,
        progress: Progress = False,
    ) -> SolidReport | None:
        """Writes the set to a file, with a certificate beside it.

        The file is read back and verified before it gets its name. An invalid set is written all the same, with a warning.

        Parameters
        ----------
        path : path-like
            The file. Its extension gives the format: ``.ply``, ``.npy`` of shape (N, 3), ``.csv``, ``.xyz``, ``.bin`` and
            ``.dat`` of UTK. PLY and CSV also have columns ``arrival`` and ``level``, if the set has these.
        format, precision, shuffle, verify, judge, progress
            As in :meth:`tilescope.PointSet.save`.

        Returns
        -------
        SolidReport or None
            The report on what the file holds, if it was verified.

        Raises
        ------
        OSError
            If the file cannot be written.
        ValueError
            If the format is not known, or holds no third coordinate.
        """
        with following(progress) as told:
            text = _tilescope.save_solid(
                self._points, json.dumps(self._facts), local_path(path), arrival=self._arrival, level=self._level,
                format_name=format, precision=precision, shuffle=shuffle, verify=verify, judge=judge, progress=told,
            )  # fmt: skip
        found = json.loads(text)
        for warning in found["warnings"]:
            # That a format does not keep when samples arrived is no fault.
            if not warning.startswith("note: "):
                warnings.warn(warning, stacklevel=2)
        return None if found["report"] is None else solid_report_of(found["report"])
