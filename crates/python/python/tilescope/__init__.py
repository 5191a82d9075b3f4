"""Maximal Poisson-disk sets: exact, verified, certified.
A set is *conflict-free* if no two samples are closer than the radius, and *maximal* if no place of
the domain is farther than the radius from all samples. :func:`sample` makes sets that are both, at
millions of samples a second; equal parameters give equal points, bit for bit, on every machine and
by the command line too. :class:`Plane` gives windows of sets that are never made as a whole,
:class:`FieldPlane` those of fields and shapes, and :class:`Space` those of sets in space.
:func:`verify`, which does not know the sampler, judges any set.

Examples
--------
>>> import tilescope
>>> points = tilescope.sample(radius=0.02, seed=7)
>>> points
<PointSet: 1770 samples, radius 0.02, 1 x 1, periodic>
>>> points.points.shape
(1770, 2)
>>> points.verify().valid
True
"""

from __future__ import annotations

import inspect
import json
import os
import warnings
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, Literal, SupportsIndex, overload

import numpy as np
import numpy.typing as npt

from tilescope import _optional, _parquet, _tilescope
from tilescope._field import Field, Pixels, Radius, field_of, place_of
from tilescope._image import Image, image_of
from tilescope._input import Path, local_path, numbers, place, shown, shown_text
from tilescope._point_set import Boundary, Format, Judge, PointSet
from tilescope._progress import Progress, following
from tilescope._report import Conflict, Domain, Gap, Level, LevelReport, Report, report_of
from tilescope._solid_set import SolidGap, SolidJudge, SolidReport, SolidSet, SolidSlice, sides, solid_report_of
from tilescope._space import Space
from tilescope._spectrum import Spectrum
from tilescope._stipple import Arguments, Stipple

if TYPE_CHECKING:
    from tilescope._widget import Widget

__all__ = [
    "Conflict",
    "Domain",
    "FieldPlane",
    "Gap",
    "Level",
    "LevelReport",
    "Plane",
    "PointSet",
    "Report",
    "SolidGap",
    "SolidReport",
    "SolidSet",
    "SolidSlice",
    "Space",
    "Spectrum",
    "Stipple",
    "analyze",
    "combine",
    "curve",
    "read",
    "read_solid",
    "sample",
    "set_threads",
    "stipple",
    "verify",
    "verify_solid",
    "widget",
]
__version__ = version("tilescope")


def __dir__() -> list[str]:
    """Returns the public names, with those modules of the package that are imported."""
    return sorted({*__all__, "__doc__", "__name__", "__version__"} | {"distributed", "qmc"} & globals().keys())


_Order = Literal["index", "random", "own-block-first", "phase-group"]
_Insertion = Literal["circumcentre", "uniform"]
_Variant = Literal["staged", "as-printed"]


@overload
def sample(
    count: SupportsIndex | None = None,
    *,
    size: tuple[float, float, float],
    radius: float | None = None,
    boundary: Boundary | None = None,
    seed: SupportsIndex = 1,
    exactly: SupportsIndex | None = None,
    method: Literal["reference"] | None = None,
    progress: Progress = False,
) -> SolidSet: ...
@overload
def sample(
    count: SupportsIndex | None = None,
    *,
    size: None = None,
    radius: Radius | None = None,
    radius_expression: str | None = None,
    density: Pixels | None = None,
    mask: Pixels | None = None,
    shape: Any = None,
    planar: bool = False,
    extent: tuple[float, float, float, float] | None = None,
    width: float | None = None,
    height: float | None = None,
    boundary: Boundary | None = None,
    seed: SupportsIndex = 1,
    leaf: float = 30.0,
    pattern_side: float | None = None,
    pattern_boundary: Boundary = "periodic",
    pattern_seed: SupportsIndex | None = None,
    pattern: PointSet | Path | None = None,
    dihedral: bool = False,
    order: _Order = "own-block-first",
    insertion: _Insertion = "circumcentre",
    search: Literal[4, 2] = 4,
    variant: _Variant = "staged",
    levels: SupportsIndex | None = None,
    exactly: SupportsIndex | None = None,
    order_within: Literal["random", "farthest"] = "random",
    origin: tuple[float, float] | None = None,
    method: Literal["kdrt", "exact", "reference"] | None = None,
    engine: Literal["auto", "parallel", "sequential"] = "auto",
    progress: Progress = False,
) -> PointSet: ...
def sample(
    count: SupportsIndex | None = None,
    *,
    size: tuple[float, float, float] | None = None,
    radius: Radius | None = None,
    radius_expression: str | None = None,
    density: Pixels | None = None,
    mask: Pixels | None = None,
    shape: Any = None,
    planar: bool = False,
    extent: tuple[float, float, float, float] | None = None,
    width: float | None = None,
    height: float | None = None,
    boundary: Boundary | None = None,
    seed: SupportsIndex = 1,
    leaf: float = 30.0,
    pattern_side: float | None = None,
    pattern_boundary: Boundary = "periodic",
    pattern_seed: SupportsIndex | None = None,
    pattern: PointSet | Path | None = None,
    dihedral: bool = False,
    order: _Order = "own-block-first",
    insertion: _Insertion = "circumcentre",
    search: Literal[4, 2] = 4,
    variant: _Variant = "staged",
    levels: SupportsIndex | None = None,
    exactly: SupportsIndex | None = None,
    order_within: Literal["random", "farthest"] = "random",
    origin: tuple[float, float] | None = None,
    method: Literal["kdrt", "exact", "reference"] | None = None,
    engine: Literal["auto", "parallel", "sequential"] = "auto",
    progress: Progress = False,
) -> PointSet | SolidSet:
    """Makes a maximal Poisson-disk set.

    Names, defaults and points are those of ``tilescope sample``. Give `count`, `radius`, or `levels`
    with `exactly`. The radius may vary, and the set may cover a shape: no two samples of radii a and b are
    then within 2ab / (a + b) of each other, and each place, with its own radius, is that near to a sample.

    With `size` the set is one in space, of balls in a box.

    Parameters
    ----------
    count : int, optional
        Choose the radius so that about as many samples result, to within 1%.
    size : (width, height, depth), optional
        The three sides of a box, each of at least 4 radii. The reference sampler makes a set in space, from `radius`, `count`
        or `exactly` (the first so many samples of a set, which cover within a factor of the radius that
        :meth:`SolidSet.verify` measures), `boundary` and `seed`; other arguments are refused.
    radius : float, array_like of shape (rows, columns) or callable, optional
        The smallest distance between two samples, and the largest from any place to its nearest
        sample. An array has the radii of the pixels that fill the domain, with the lowest y in the first row;
        between them it is bilinear. A function is called once, with two arrays of x and y, the places where
        ``tilescope sample --radius-expression`` evaluates a formula, and returns an array of radii. With
        `count` arrays and functions are scaled. The largest radius is at most 64 times the smallest.
    radius_expression : str, optional
        The radius as a formula of x and y, such as ``'0.006 + 0.024*x'``. The certificate states it, so that the
        set can be judged without being given it again.
    density : array_like of shape (rows, columns) or path-like, optional
        How dense samples are: numbers from 0, of which only ratios count if `count` is given; with `radius`
        that is the radius where the density is 1. Of whole numbers (uint8, uint16) the largest of the type stands
        for 1. Of a PNG image it is the darkness. The radius is at most 64 times the smallest, also where the density is 0:
        `mask` leaves places out.
    mask : array_like of bool, of shape (rows, columns), or path-like, optional
        Cover only these pixels, or the opaque pixels of a PNG image.
    shape : geometry, optional
        Cover only polygons: of shapely or GeoPandas, or GeoJSON as a dict, as text or by its path. Without
        `extent`, sides and `origin` the domain is the rectangle around them.
    planar : bool
        Take the corners of `shape` as positions in a plane, though they may be longitudes and latitudes: all lie
        within 180 and 90. A projected coordinate system that GeoPandas states says the same.
    extent : (x0, y0, x1, y1), optional
        The corners of the domain, in the place of `width`, `height` and `origin`.
    width, height : float, optional
        The domain, in the unit of the radius. If not given, 1, or as follows from the shape, or from the pixels, which are
        squares.
    boundary : {'periodic', 'bounded'}, optional
        Opposite sides are joined, or the border is closed and covered. If not given, it is periodic, and bounded for a radius
        that varies and for a shape.
    seed : int
        Seed of every draw: any 64-bit number.
    leaf : float
        Shortest edge of a building block, in radii: at least 6.
    pattern_side, pattern_boundary, pattern_seed
        Side in radii, boundary and seed of the small set that blocks take their samples from. If they are
        not given, the side is 100 and the seed is 0; with method 'exact', see there.
    pattern : PointSet or path-like, optional
        Take the samples from this set instead: it must be conflict-free and maximal.
    dihedral : bool
        Take them from the pattern's 8 rotations and mirror images.
    order : {'own-block-first', 'index', 'random', 'phase-group'}
        Order of elimination.
    insertion : {'circumcentre', 'uniform'}
        Fill gaps at uncovered circumcentres, or uniformly. Seams stay denser with either.
    search : {4, 2}
        How far detectors look for gaps, in radii: 4 is proven, 2 is an experiment that leaves gaps.
    variant : {'staged', 'as-printed'}
        Staged, or the paper's Algorithm 4 as it is printed.
    levels : int, optional
        Make so many nested sets, at most 11, each with all samples of the one before and maximal for a
        radius smaller by the root of 2; the last has `radius`. The samples of the first come first, so
        that every prefix of the set is evenly spread. Order, insertion, search, variant and the
        pattern's boundary must be the defaults; the pattern cannot be given. Long blocks are advisable:
        a leaf of ten of the first set's radii.
    exactly : int, optional
        Keep exactly so many samples: the first of `levels` whose last set has as many or a few more.
        There is no maximal set of exactly so many samples in general: of these, every place is within
        1.42 radii.
    order_within : {'random', 'farthest'}
        How the samples that a level adds follow each other: as drawn, or each the one that is farthest
        all before it.
    origin : (x, y), optional
        Where files are to hold the lower corner of the domain, for sets at map coordinates. It does not change
        :attr:`PointSet.points`; :meth:`PointSet.save` adds it to what it writes. Shapes and functions are in these coordinates.
    method : {'kdrt', 'exact', 'reference'}, optional
        If not given, tiling, and dart throwing for a radius that varies, which allows nothing else, and for shapes, which
        allow also exact tiling. Randomized tiling; exact tiling; or dart throwing (Ebeida et al. 2012), which uses only radius or
        count, sides, boundary and seed. Exact tiling clips all darts with their arrival order, so that seams
        have no bias: sets are distributed as those by dart throwing, but for the pattern that all blocks
        share. Averages over N samples from a pattern of k vary about as those of N k / (N + k) independent
        ones. So the pattern's seed is `seed`, and its side 200 up to 28,000 samples and 400 above, unless they are
        given; ``parameters["pattern_samples"]`` says how many samples it has, and
        ``parameters["samples_per_pattern_sample"]`` how often each is used. Order, insertion, search
        and variant must be the defaults, and `levels` cannot be given; a `pattern` must be a set by dart
        throwing in a periodic square, whose darts are thrown again from its seed: positions must be equal, or
        equal as a file stores them, rounded to 32 bits for instance. The pattern's tables take 4.1 MB for a
        side of 200, 16.2 MB for 400 and 404 MB for 2,000. Below some 300,000 samples dart throwing takes less
        time.
    engine : {'auto', 'parallel', 'sequential'}
        What computes. It does not change the points.
    progress : bool or callable
        Whether to show a bar of tqdm, or what to call with the stage, what is done and all there is
        to do.

    Returns
    -------
    PointSet or SolidSet
        The set, of at most 2e8 samples. :attr:`PointSet.levels` says what holds for nested levels. With `size` a
        :class:`SolidSet`, whose points have the shape (N, 3).

    Raises
    ------
    ValueError
        If an argument is wrong; the text names the value and the limit.
    KeyboardInterrupt
        Within a fraction of a second after Ctrl-C.

    Examples
    --------
    >>> points = tilescope.sample(5000, boundary="bounded", seed=3)
    >>> abs(len(points) - 5000) <= 50
    True
    >>> exact = tilescope.sample(levels=4, exactly=5000, order_within="farthest")
    >>> len(exact), exact.verify().valid
    (5000, True)
    >>> ramp = tilescope.sample(radius=lambda x, y: 0.01 + 0.04 * x)
    >>> ramp
    <PointSet: ... samples, radius 0.01 to 0.05, 1 x 1, bounded>
    >>> ramp.radii.shape == (len(ramp),), ramp.verify().valid
    (True, True)
    >>> park = {"type": "Polygon", "coordinates": [[[0, 0], [200, 0], [200, 100], [80, 150], [0, 0]]]}
    >>> trees = tilescope.sample(500, shape=park)
    >>> abs(len(trees) - 500) <= 5, trees.verify().valid
    (True, True)
    >>> balls = tilescope.sample(size=(10, 10, 10), radius=1)
    >>> balls.points.shape == (len(balls), 3), balls.verify().valid
    (True, True)
    >>> tilescope.sample(radius=-1)
    Traceback (most recent call last):
        ...
    ValueError: the radius is -1; it must be a finite number above 0
    """
    if size is not None:
        _refuse_planar(
            radius_expression=radius_expression, density=density, mask=mask, shape=shape, planar=planar, extent=extent,
            width=width, height=height, leaf=leaf, pattern_side=pattern_side, pattern_boundary=pattern_boundary,
            pattern_seed=pattern_seed, pattern=pattern, dihedral=dihedral, order=order, insertion=insertion, search=search,
            variant=variant, levels=levels, order_within=order_within, origin=origin, method=method, engine=engine,
        )  # fmt: skip
        ends = "periodic" if boundary is None else boundary
        with following(progress) as told:
            return SolidSet._made(_tilescope.sample_solid(sides(size), radius, count, exactly, ends, seed, told))
    width, height, at = _corner(extent, width, height, origin)
    field = field_of(radius, radius_expression, density, mask, shape, planar)
    if field is not None:
        request = _blocks_in(
            field, method, seed, leaf=leaf, pattern_side=pattern_side, pattern_boundary=pattern_boundary,
            pattern_seed=pattern_seed, dihedral=dihedral, pattern=pattern, order=order, insertion=insertion, search=search,
            variant=variant, levels=levels, exactly=exactly, order_within=order_within, engine=engine,
        )  # fmt: skip
        given = _Given(None, width, height, boundary, at)
        with following(progress) as told:
            return PointSet._made(*_tilescope.sample_field(given, field, count, seed, request, told))
    method = "kdrt" if method is None else method
    width, height = 1.0 if width is None else width, 1.0 if height is None else height
    boundary = "periodic" if boundary is None else boundary
    request = _request(
        count=count, radius=radius, width=width, height=height, boundary=boundary, seed=seed, leaf=leaf,
        pattern_side=pattern_side, pattern_boundary=pattern_boundary, pattern_seed=pattern_seed, pattern=pattern,
        dihedral=dihedral, order=order, insertion=insertion, search=search, variant=variant, levels=levels,
        exactly=exactly, order_within=order_within,
    )  # fmt: skip
    repeating = request.repeating_pattern(method == "exact")
    if repeating is not None and method != "reference":
        own, needed = repeating
        warnings.warn(
            f"the pattern of {own:g} r repeats within the largest blocks, which spectra show; "
            f"pattern_side={needed:g} would avoid that",
            stacklevel=2,
        )
    with following(progress) as told:
        made = PointSet._made(_tilescope.sample(request, method, engine, told))
    made._origin = (0.0, 0.0) if at is None else at
    return made


def stipple(
    image: Image,
    dots: SupportsIndex,
    *,
    gamma: float = 1.0,
    contrast: float = 1.0,
    invert: bool = False,
    white: float = 1 / 64,
    run_on: bool = False,
    width: float | None = None,
    seed: SupportsIndex = 1,
    dot_size: Literal["constant", "darkness"] = "constant",
    dot_radius: float | None = None,
    paper: str | None = None,
    ink: str | None = None,
    progress: Progress = False,
) -> Stipple:
    """Draws an image in dots, as dense as it is dark, exactly as many as are asked for.

    Names, defaults and dots are those of ``tilescope stipple``. No radius gives a maximal set of exactly so many dots. So a
    set of a few more is made, and its first dots by arrival are the stipple, verified and certified as that.

    Parameters
    ----------
    image : array_like of shape (rows, columns) or (rows, columns, channels), or path-like
        The image, with the highest row first, as images are stored: uint8, uint16, bool, or floating-point numbers from 0,
        black, to 1, white. It has one channel of grey, two with opacity, three of red, green and blue, or four with opacity.
        Colours become grey by their luminance (Rec. 709), and transparent pixels lie before white. An image of Pillow is
        taken as it is: ``PIL.ImageOps.exif_transpose`` turns one upright. A path is that of a PNG or JPEG file.
    dots : int
        How many dots: at least 1. A dot needs pixels: the least radius is at least 1/32 of one.
    gamma : float
        Raise the light of pixels to this power, from 0.1 to 10: 2.2 gives dots by the light that a screen sends.
    contrast : float
        Multiply differences from half grey by this, from 0 to 100, before `gamma`.
    invert : bool
        Dots where the image is light. Paper is then black and ink white, unless they are given.
    white : float
        No dots where the image is lighter than this share of black, from 0 to 0.5. With 0 no place is left out.
    run_on : bool
        Make dots beyond the frame, too, and drop them: at a border there are a few more dots otherwise.
    width : float, optional
        The width of the image in the unit of positions and radii. If not given, its columns.
    seed : int
        Seed of the dots: any 64-bit number.
    dot_size : {'constant', 'darkness'}
        In pictures, dots of one size, or the larger the darker.
    dot_radius : float, optional
        Radius of a dot where the image is black, in the unit of positions. If not given, such that all dots together have
        as much ink as the image is dark.
    paper, ink : str, optional
        Colours of pictures: ``'#rrggbb'``, ``'black'`` or ``'white'``.
    progress : bool or callable
        As in :func:`sample`. Each set that is made begins anew.

    Returns
    -------
    Stipple
        The dots, as a set whose radius varies.

    Raises
    ------
    ValueError
        If an argument is wrong, a value of the image is no light, no place is dark, or there are too few pixels for as many
        dots; the text names the value and the limit.
    TypeError
        If the image has values of another type.
    OSError
        If the file cannot be read.
    KeyboardInterrupt
        Within a fraction of a second after Ctrl-C.

    Examples
    --------
    >>> y, x = np.mgrid[-1:1:90j, -1:1:90j]
    >>> ball = np.where(np.hypot(x, y) < 0.9, np.hypot(x + 0.3, y + 0.3) / 2, 1.0)
    >>> dots = tilescope.stipple(ball, dots=2000, dot_size="darkness")
    >>> len(dots), dots.verify().valid, dots.verify().covering_factor < 1.2
    (2000, True, True)
    >>> dots.save(folder / "ball.svg").valid
    True
    >>> tilescope.verify(folder / "ball.svg", image=ball).passed
    True
    """
    arguments = Arguments(
        dot_size, dots=dots, gamma=gamma, contrast=contrast, invert=invert, white=white, run_on=run_on, width=width, seed=seed,
        dot_radius=dot_radius, paper=paper, ink=ink,
    )  # fmt: skip
    with following(progress) as told:
        return Stipple._stippled(*_tilescope.stipple(image_of(image), arguments, told))


def _refuse_planar(**given: Any) -> None:
    """Raises ``ValueError`` for arguments of planar sets."""
    parameters = inspect.signature(sample).parameters
    for argument, value in given.items():
        if argument == "method" and value == "reference":
            continue
        if value is not parameters[argument].default and value != parameters[argument].default:
            raise ValueError(
                f"{argument} is given with size, which makes a set in space by the reference sampler; leave {argument} out"
            )


def _refuse_tiling(name: str, why: str, **given: Any) -> None:
    """Raises ``ValueError`` for arguments of other ways to make a set. ``why`` says why ``name`` has none of them."""
    parameters = inspect.signature(sample).parameters
    for argument, value in given.items():
        if argument == "method" and value == "reference":
            continue
        if value is not parameters[argument].default and value != parameters[argument].default:
            raise ValueError(f"{argument} is given with {name}, {why}; leave {argument} out")


# Arguments of tilings that exact tiling of a shape takes, too.
_OF_BLOCKS = ("leaf", "pattern_side", "pattern_boundary", "pattern_seed", "dihedral")


def _blocks_in(
    field: Field, method: str | None, seed: SupportsIndex, **tiling: Any
) -> _tilescope.RunRequest | None:
    """Returns the blocks that tile a shape exactly, or nothing where the reference sampler makes the set of a field.

    Raises ``ValueError`` for arguments of ``tiling`` that have no meaning there.
    """
    blocks = {argument: tiling.pop(argument) for argument in _OF_BLOCKS}

    # A pattern has one radius, so that exact tiling covers shapes alone.
    if method == "exact" and field.has_one_radius:
        _refuse_tiling(field.name, "which exact tiling covers without it", **tiling)
        # Blocks and patterns have their lengths in radii, so that any radius serves to check them.
        return _request(
            count=None, radius=0.01, seed=seed, **blocks, pattern=None, levels=None, exactly=None, order_within="random"
        )

    why = "which needs the reference sampler, whose darts need no pattern"
    # Exact tiling would take the arguments of blocks, and none of the others.
    unless = ", unless method is 'exact'" if field.has_one_radius else ""
    _refuse_tiling(field.name, f"{why}{unless}", method=method, **blocks)
    _refuse_tiling(field.name, why, **tiling)
    return None


def _corner(
    extent: tuple[float, float, float, float] | None,
    width: float | None,
    height: float | None,
    origin: tuple[float, float] | None,
) -> tuple[float | None, float | None, tuple[float, float] | None]:
    """Returns width, height and lower corner as they are given, or as ``extent`` says them."""
    if extent is not None:
        if not (width is None and height is None and origin is None):
            raise ValueError("extent is given with width, height or origin, which it says; leave these out")
        width, height, *corner = place_of(extent)
        origin = (corner[0], corner[1])
    # A wrong one is found before the set is made.
    return width, height, None if origin is None else place("origin", origin)


def curve(
    count: SupportsIndex | None = None,
    *,
    radius: Radius | None = None,
    radius_expression: str | None = None,
    density: Pixels | None = None,
    mask: Pixels | None = None,
    shape: Any = None,
    planar: bool = False,
    extent: tuple[float, float, float, float] | None = None,
    width: float | None = None,
    height: float | None = None,
    boundary: Boundary | None = None,
    seed: SupportsIndex = 1,
    leaf: float = 30.0,
    pattern_side: float | None = None,
    pattern_boundary: Boundary = "periodic",
    pattern_seed: SupportsIndex | None = None,
    pattern: PointSet | Path | None = None,
    dihedral: bool = False,
    order: _Order = "own-block-first",
    insertion: _Insertion = "circumcentre",
    search: Literal[4, 2] = 4,
    variant: _Variant = "staged",
    levels: SupportsIndex | None = None,
    exactly: SupportsIndex | None = None,
    order_within: Literal["random", "farthest"] = "random",
    origin: tuple[float, float] | None = None,
    method: Literal["kdrt", "exact", "reference"] | None = None,
    numbers: Iterable[str] | None = None,
    moments: SupportsIndex | None = None,
    progress: Progress = False,
) -> dict[str, Any]:
    """Follows numbers of a run from its first event to its last.

    The run is that of :func:`sample` with the same arguments, and the numbers are those of
    :func:`analyze`, of the samples that are there at a moment: tiled or inserted, and not eliminated. In a
    shape numbers are by the area inside, and where the radius varies there are samples, conflicts, gaps and
    the density, in which each place counts by its own radius.

    Parameters
    ----------
    numbers : iterable of str, optional
        Keys of numbers, such as ``"conflicts"`` and ``"gaps"``; all that need no spectrum, if none are
        given. An unknown one is refused with the list of those that there are.
    moments : int, optional
        At so many moments, evenly spread among the changes of the samples; at every change, if it is not
        given, and at 1000 moments if a number needs the spectrum.

    Returns
    -------
    dict
        Columns by their names, all of one length: ``"event"``, how many events have happened, as an array
        of integers; ``"stage"``, a list of names; and an array for each number, with NaN where it is not
        defined.

    Examples
    --------
    Tiling makes conflicts, and elimination leaves gaps, which insertion fills:

    >>> run = tilescope.curve(radius=0.05, numbers=["conflicts", "gaps"])
    >>> bool((run["conflicts"] > 0).any()), float(run["conflicts"][-1]), float(run["gaps"][-1])
    (True, 0.0, 0.0)
    >>> run["stage"][0], run["stage"][-1]
    ('pattern', 'finish')

    Darts cover a shape little by little, without conflicts:

    >>> park = {"type": "Polygon", "coordinates": [[[0, 0], [200, 0], [200, 100], [80, 150], [0, 0]]]}
    >>> run = tilescope.curve(shape=park, radius=8, numbers=["density", "gaps"], moments=5)
    >>> [round(float(density), 1) for density in run["density"]], float(run["gaps"][-1])
    ([0.0, ..., 0.7], 0.0)
    """
    if isinstance(numbers, str):
        raise TypeError(f"numbers is the text {numbers!r}; it must be a list of keys")
    keys = None if numbers is None else list(numbers)
    width, height, at = _corner(extent, width, height, origin)
    field = field_of(radius, radius_expression, density, mask, shape, planar)
    if field is not None:
        request = _blocks_in(
            field, method, seed, leaf=leaf, pattern_side=pattern_side, pattern_boundary=pattern_boundary,
            pattern_seed=pattern_seed, dihedral=dihedral, pattern=pattern, order=order, insertion=insertion, search=search,
            variant=variant, levels=levels, exactly=exactly, order_within=order_within,
        )  # fmt: skip
        ground = (_Given(None, width, height, boundary, at), field)
        with following(progress) as told:
            return _tilescope.curve_field(ground, count, seed, request, (keys, moments), told)
    method = "kdrt" if method is None else method
    width, height = 1.0 if width is None else width, 1.0 if height is None else height
    boundary = "periodic" if boundary is None else boundary
    request = _request(
        count=count, radius=radius, width=width, height=height, boundary=boundary, seed=seed, leaf=leaf,
        pattern_side=pattern_side, pattern_boundary=pattern_boundary, pattern_seed=pattern_seed, pattern=pattern,
        dihedral=dihedral, order=order, insertion=insertion, search=search, variant=variant, levels=levels,
        exactly=exactly, order_within=order_within,
    )  # fmt: skip
    with following(progress) as told:
        return _tilescope.curve(request, method, keys, moments, told)


# Arguments that go with the method where they are not given.
_CHOSEN = ("pattern_side", "pattern_seed")


def _request(*, pattern: PointSet | Path | None, **arguments: Any) -> _tilescope.RunRequest:
    source = None
    if pattern is not None and not isinstance(pattern, PointSet):
        source = _tilescope.named_by_content(local_path(pattern))
        pattern = read(pattern)
    chosen = {name: value for name, value in arguments.items() if value is not None or name not in _CHOSEN}
    return _tilescope.RunRequest(pattern=pattern, pattern_source=source, **chosen)


class Plane:
    """The plane of a run, from which any window can be computed alone.

    A window has exactly the samples that the whole set has there, and costs only its own area: the
    set may have three thousand million samples. A periodic plane repeats without end. A plane can be
    pickled; :mod:`tilescope.distributed` writes all of it, tile by tile.

    Parameters are those of :func:`sample`. With ``method="exact"`` windows are those of an exact tiling, which needs a `radius`: to
    find that of a count, the whole set would have to be made. With `levels` a window has the samples of nested levels, the
    first level's first, in the order of the whole set, and each with the rank that it has there.

    Examples
    --------
    A window of a set of two thousand million samples:

    >>> plane = tilescope.Plane(radius=2e-5)
    >>> 1650 < len(plane.window(0.5, 0.5, 0.501, 0.501)) < 1850
    True
    >>> plane.is_valid(0.5, 0.5, 0.501, 0.501)
    True

    The same without bias at seams:

    >>> exact = tilescope.Plane(radius=2e-5, method="exact")
    >>> exact.is_valid(0.5, 0.5, 0.501, 0.501)
    True
    """

    __slots__ = ("_arguments", "_domain", "_method", "_parameters", "_plane", "_radius")

    def __init__(
        self,
        count: SupportsIndex | None = None,
        *,
        radius: float | None = None,
        width: float = 1.0,
        height: float = 1.0,
        boundary: Boundary = "periodic",
        seed: SupportsIndex = 1,
        leaf: float = 30.0,
        pattern_side: float | None = None,
        pattern_boundary: Boundary = "periodic",
        pattern_seed: SupportsIndex | None = None,
        pattern: PointSet | Path | None = None,
        dihedral: bool = False,
        order: _Order = "own-block-first",
        insertion: _Insertion = "circumcentre",
        search: Literal[4, 2] = 4,
        levels: SupportsIndex | None = None,
        method: Literal["kdrt", "exact"] = "kdrt",
        progress: Progress = False,
    ) -> None:
        # All arguments, before there are other variables.
        arguments: dict[str, Any] = {name: value for name, value in locals().items() if name != "self"}
        request = _request(
            count=count, radius=radius, width=width, height=height, boundary=boundary, seed=seed, leaf=leaf,
            pattern_side=pattern_side, pattern_boundary=pattern_boundary, pattern_seed=pattern_seed, pattern=pattern,
            dihedral=dihedral, order=order, insertion=insertion, search=search, variant="staged",
            levels=levels, exactly=None, order_within="random",
        )  # fmt: skip
        with following(progress) as told:
            self._plane = _tilescope.Plane(request, method, told)
        facts = json.loads(self._plane.facts())
        self._domain, self._radius = Domain(*facts["domain"]), float(facts["radius"])
        self._parameters = json.dumps(facts["parameters"])
        # A copy in another process does not search for the radius, and cannot read the file of a pattern.
        if pattern is not None and not isinstance(pattern, PointSet):
            pattern = read(pattern)
        self._method = method
        self._arguments = arguments | {"count": None, "radius": self._radius, "pattern": pattern, "progress": False}

    def __reduce__(self) -> tuple[Any, ...]:
        """Returns what :mod:`copy` and :mod:`pickle` make the same plane from."""
        return _plane_of, (self._arguments, self._parameters)

    @property
    def domain(self) -> Domain:
        """Width, height and boundary of the whole set's domain."""
        return self._domain

    @property
    def radius(self) -> float:
        """The Poisson-disk radius."""
        return self._radius

    @property
    def method(self) -> Literal["kdrt", "exact"]:
        """The name of the method, as :attr:`PointSet.method` has it."""
        return self._method

    @property
    def parameters(self) -> dict[str, Any]:
        """Every parameter by its name."""
        parameters: dict[str, Any] = json.loads(self._parameters)
        return parameters

    def window(
        self, x0: float, y0: float, x1: float, y1: float, *, progress: Progress = False
    ) -> npt.NDArray[np.float64]:
        """Returns the samples with ``x0 <= x < x1`` and ``y0 <= y < y1``.

        In a periodic domain the window may cross the border or lie beyond it; positions are those
        in the domain. In a bounded one a window that reaches the upper border includes it.

        Parameters
        ----------
        x0, y0, x1, y1 : float
            The corners.
        progress
            As in :func:`sample`.

        Returns
        -------
        numpy.ndarray of shape (N, 2)
            The positions, in the sequence of the whole set; read-only.

        Raises
        ------
        ValueError
            If the window is empty, larger than the domain, far from it, or has more than 2e8
            samples.
        """
        with following(progress) as told:
            return self._plane.window((x0, y0, x1, y1), told)[0]

    def window_levels(
        self, x0: float, y0: float, x1: float, y1: float, *, progress: Progress = False
    ) -> list[npt.NDArray[np.float64]]:
        """Returns the samples of a window, as :meth:`window` does, in one array for each level that adds them.

        Examples
        --------
        >>> plane = tilescope.Plane(radius=1e-3, levels=3)
        >>> [len(added) for added in plane.window_levels(0.5, 0.5, 0.6, 0.6)]
        [1756, 1642, 3523]
        """
        with following(progress) as told:
            samples, ends, _ = self._plane.window((x0, y0, x1, y1), told)
        return np.split(samples, ends[:-1])

    def window_ranks(
        self, x0: float, y0: float, x1: float, y1: float, *, progress: Progress = False
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Returns the samples of a window, as :meth:`window` does, and the rank of each, as :attr:`PointSet.rank` has it.

        Raises
        ------
        ValueError
            As :meth:`window`, and if the plane has no levels.

        Examples
        --------
        >>> plane = tilescope.Plane(radius=1e-3, levels=6)
        >>> points, rank = plane.window_ranks(0.5, 0.5, 0.6, 0.6)
        >>> painted = points[rank < (points[:, 0] - 0.5) / 0.1]
        >>> 0.47 < len(painted) / len(points) < 0.53
        True
        """
        with following(progress) as told:
            samples, _, ranks = self._plane.window((x0, y0, x1, y1), told)
        if ranks is None:
            raise ValueError("the plane has no levels, whose samples have ranks; give levels")
        return samples, ranks

    def is_valid(self, x0: float, y0: float, x1: float, y1: float, *, progress: Progress = False) -> bool:
        """Returns whether a window has no conflict and no gap, at any level, judged by the samples in it and around it."""
        with following(progress) as told:
            conflicts, gaps = self._plane.verify((x0, y0, x1, y1), told)
        return conflicts == gaps == 0

    def __repr__(self) -> str:
        width, height, boundary = self.domain
        return f"<Plane: radius {self.radius:.6g}, {width:g} x {height:g}, {boundary}>"


def _plane_of(arguments: dict[str, Any], parameters: str) -> Plane:
    plane = Plane(**arguments)
    plane._parameters = parameters
    return plane


class FieldPlane:
    """A set whose radius varies, or that covers a shape, from which any window can be computed alone.

    A window has exactly the samples that the whole set has there, and costs only its own area: the set of
    ``tilescope.sample`` with the same arguments, which is not made.

    Parameters are those of :func:`sample` for a radius that varies and for shapes, but for `count`: which scale of the
    radii gives so many samples is known of the whole set alone.

    Examples
    --------
    >>> plane = tilescope.FieldPlane(radius_expression="1e-4 + 2e-4*x", seed=3)
    >>> part = plane.window(0.5, 0.5, 0.52, 0.52)
    >>> 5_500 < len(part) < 8_500, plane.is_valid(0.5, 0.5, 0.52, 0.52)
    (True, True)
    >>> whole = tilescope.sample(radius_expression="0.02 + 0.02*x", seed=3).points
    >>> inside = (whole >= 0.25).all(axis=1) & (whole < 0.75).all(axis=1)
    >>> plane = tilescope.FieldPlane(radius_expression="0.02 + 0.02*x", seed=3)
    >>> bool((plane.window(0.25, 0.25, 0.75, 0.75) == whole[inside]).all())
    True
    """

    __slots__ = ("_domain", "_origin", "_parameters", "_plane", "_radius")

    def __init__(
        self,
        *,
        radius: Radius | None = None,
        radius_expression: str | None = None,
        density: Pixels | None = None,
        mask: Pixels | None = None,
        shape: Any = None,
        planar: bool = False,
        extent: tuple[float, float, float, float] | None = None,
        width: float | None = None,
        height: float | None = None,
        boundary: Boundary | None = None,
        seed: SupportsIndex = 1,
        origin: tuple[float, float] | None = None,
    ) -> None:
        if extent is not None:
            if not (width is None and height is None and origin is None):
                raise ValueError("extent is given with width, height or origin, which it says; leave these out")
            width, height, *corner = place_of(extent)
            origin = (corner[0], corner[1])
        at = None if origin is None else place("origin", origin)
        field = field_of(radius, radius_expression, density, mask, shape, planar)
        if field is None:
            raise ValueError("nothing makes the radius vary, and no shape is given: tilescope.Plane has such windows")
        given = _Given(None, width, height, boundary, at)
        self._plane = _tilescope.FieldPlane(given, field, seed, None)
        facts = json.loads(self._plane.facts())
        self._domain = Domain(*facts["domain"])
        self._radius: tuple[float, float] = (facts["radius"][0], facts["radius"][1])
        self._origin: tuple[float, float] = (facts["origin"][0], facts["origin"][1])
        self._parameters = json.dumps(facts["parameters"])

    @property
    def domain(self) -> Domain:
        """Width, height and boundary of the whole set's domain."""
        return self._domain

    @property
    def radius(self) -> tuple[float, float]:
        """The least and the greatest radius."""
        return self._radius

    @property
    def origin(self) -> tuple[float, float]:
        """Where the lower corner of the domain lies, which corners of windows and positions are counted from."""
        return self._origin

    @property
    def parameters(self) -> dict[str, Any]:
        """Every parameter by its name."""
        parameters: dict[str, Any] = json.loads(self._parameters)
        return parameters

    def window(
        self, x0: float, y0: float, x1: float, y1: float, *, progress: Progress = False
    ) -> npt.NDArray[np.float64]:
        """Returns the samples with ``x0 <= x < x1`` and ``y0 <= y < y1``, counted from the domain's lower corner.

        In a periodic domain the window may cross the border or lie beyond it; positions are those
        in the domain. In a bounded one a window that reaches the upper border includes it.

        Parameters
        ----------
        x0, y0, x1, y1 : float
            The corners.
        progress
            As in :func:`sample`.

        Returns
        -------
        numpy.ndarray of shape (N, 2)
            The positions, in the sequence of the whole set; read-only.

        Raises
        ------
        ValueError
            If the window is empty, larger than the domain, far from it, or has more than 2e8 samples.
        """
        with following(progress) as told:
            return self._plane.window((x0, y0, x1, y1), told)

    def is_valid(self, x0: float, y0: float, x1: float, y1: float, *, progress: Progress = False) -> bool:
        """Returns whether the places of a window are covered, and no sample in it is in conflict with any."""
        with following(progress) as told:
            conflicts, gaps = self._plane.verify((x0, y0, x1, y1), told)
        return conflicts == gaps == 0

    def __repr__(self) -> str:
        (least, greatest), (width, height, boundary) = self.radius, self.domain
        return f"<FieldPlane: radius {least:.6g} to {greatest:.6g}, {width:g} x {height:g}, {boundary}>"


def verify(
    points: PointSet | Path | npt.ArrayLike,
    radius: Radius | None = None,
    *,
    radius_expression: str | None = None,
    density: Pixels | None = None,
    mask: Pixels | None = None,
    shape: Any = None,
    planar: bool = False,
    image: Image | None = None,
    width: float | None = None,
    height: float | None = None,
    boundary: Boundary | None = None,
    format: Format | None = None,
    set: SupportsIndex | None = None,
    origin: tuple[float, float] | None = None,
    judge: Judge | None = None,
    prefix: SupportsIndex | None = None,
    progress: Progress = False,
) -> Report:
    """Judges whether a set is conflict-free and maximal, whoever made it.

    Parameters
    ----------
    points : array_like of shape (N, 2), path-like or PointSet
        Positions, or the file of a set. Of a file the certificate is compared as well, and nested levels
        that it states are judged.
    radius, radius_expression, density, mask, shape, planar, optional
        The radius and the shape, as in :func:`sample`. A radius must be given unless the set, or a certificate, has one.
        Of a file, arrays, functions and images must be given again, which its certificate states by their digests;
        formulas and polygons need not. An image that stands for radii is given as ``radius=pathlib.Path('grey.png')``.
        Positions in an array are in the coordinates of the shape.
    image : array_like or path-like, optional
        Of a file of a stipple, the image that it was made from, as it was given to :func:`stipple`.
    width, height, boundary, optional
        The domain. If not given, that of the set or its certificate, and else the periodic unit
        square, or what :func:`sample` has for a field or a shape.
    format : str, optional
        Format of a file, if neither its extension nor its content says it.
    set : int, optional
        Which set of a file that holds several, from 0.
    origin : (x, y), optional
        Where a file, or an array with a field or a shape, holds the lower corner of the domain. If not given, where the
        certificate states, and else 0, 0, or the corner of the shape.
    prefix : int, optional
        Judge only so many samples, the first, of a set with nested levels.
    judge, progress
        As in :meth:`PointSet.verify`.

    Returns
    -------
    Report
        The verdict, with measures and witnesses. A bad set is a report, not an error.

    Raises
    ------
    ValueError
        If there is no set to judge: it is empty, a position is not finite or outside of the domain,
        the radius is missing.
    OSError
        If a file cannot be read.

    Examples
    --------
    >>> tilescope.verify([[0.25, 0.25], [0.75, 0.75]], radius=0.5).valid
    True
    >>> report = tilescope.verify([[0.25, 0.25], [0.3, 0.25]], radius=0.5)
    >>> report.conflicts, report.maximal
    (1, False)
    """
    if isinstance(points, (str, os.PathLike)) and _is_in_space(points, format):
        raise ValueError(
            f"{shown_text(local_path(points))} has a third side by its certificate; tilescope.verify_solid judges it"
        )
    field = field_of(radius, radius_expression, density, mask, shape, planar, image)
    if field is not None and prefix is not None:
        raise ValueError(f"{field.name} is given with prefix, which is for nested levels: they have one radius")
    if not isinstance(points, (str, os.PathLike)):
        # Positions are in the coordinates of a shape, which lie somewhere.
        is_placed = field is not None and not isinstance(points, PointSet)
        _check_no_file(format, set, None if is_placed else origin)
        if field is not None:
            placed = _set_on(points, field, _Given(None, width, height, boundary, origin))
            return placed.verify(judge=judge, progress=progress)
    if field is not None:
        radius = None
    if prefix is not None:
        if radius is not None:
            raise ValueError(
                f"both prefix and radius are given; the levels say the radius of the first {shown(prefix)} samples"
            )
        if isinstance(points, (str, os.PathLike)):
            points = read(
                points, width=width, height=height, boundary=boundary, format=format, set=set, origin=origin
            )
        else:
            points = _set_of(points, None, width, height, boundary)
        return points.prefix(prefix).verify(judge=judge, progress=progress)
    if isinstance(points, (str, os.PathLike)) and _parquet.is_to_read(local_path(points), format):
        points = _read(points, radius, field, width, height, boundary, format, set, origin)
    if isinstance(points, (str, os.PathLike)):
        given = _Given(radius, width, height, boundary, origin)
        with following(progress) as told:
            found = json.loads(_tilescope.check(local_path(points), given, field, format, set, judge, told))
        return report_of(found["report"], found["differences"])
    return _set_of(points, radius, width, height, boundary).verify(judge=judge, progress=progress)


def verify_solid(
    points: SolidSet | Path | npt.ArrayLike,
    radius: float | None = None,
    *,
    size: tuple[float, float, float] | None = None,
    boundary: Boundary | None = None,
    format: Format | None = None,
    judge: SolidJudge | None = None,
    progress: Progress = False,
) -> SolidReport:
    """Judges whether a set in space is conflict-free and maximal, whoever made it.

    Parameters
    ----------
    points : array_like of shape (N, 3), path-like or SolidSet
        Positions, or the file of a set. Of a file the certificate is compared as well.
    radius, size, boundary, optional
        The radius and the box. If not given, those of the set or of the certificate of a file; positions in an array need
        radius and size, and are periodic if nothing else is said.
    format : str, optional
        Format of a file, if neither its extension nor its content says it.
    judge, progress
        As in :meth:`SolidSet.verify`.

    Returns
    -------
    SolidReport
        The verdict. A bad set is a report, not an error.

    Raises
    ------
    ValueError
        If there is no set to judge: it is empty, a position is not finite or outside of the box, radius or size are missing.
    OSError
        If a file cannot be read.

    Examples
    --------
    >>> import numpy as np
    >>> corners = np.stack(np.meshgrid(*[np.arange(4.0)] * 3), axis=-1).reshape(-1, 3)
    >>> tilescope.verify_solid(corners, 0.9, size=(4, 4, 4)).valid
    True
    >>> tilescope.verify_solid(corners, 0.8, size=(4, 4, 4)).maximal
    False
    """
    if isinstance(points, (str, os.PathLike)):
        box = None if size is None else sides(size)
        with following(progress) as told:
            text = _tilescope.check_file_in_space(local_path(points), box, boundary, radius, format, judge, told)
        found = json.loads(text)
        return solid_report_of(found["report"], found["differences"])
    if isinstance(points, SolidSet):
        if radius is None and size is None and boundary is None:
            return points.verify(judge=judge, progress=progress)
        radius = points.radius if radius is None else radius
        size = points.size if size is None else size
        boundary = points.boundary if boundary is None else boundary  # type: ignore[assignment]
        points = points.points
    if radius is None or size is None:
        raise ValueError("positions in space have no radius and no box of their own; give radius and size")
    one = SolidSet(points, radius, size, "periodic" if boundary is None else boundary)
    return one.verify(judge=judge, progress=progress)


def _is_in_space(path: Path, format: Format | None) -> bool:
    name = local_path(path)
    return not _parquet.is_to_read(name, format) and _tilescope.is_in_space(name)


def _check_no_file(format: object, set: object, origin: object) -> None:
    """Raises ``ValueError`` for arguments that are about a file, where an array or a set is given."""
    for name, value in (("format", format), ("set", set), ("origin", origin)):
        if value is not None:
            raise ValueError(f"{name} is {shown(value)}, but points is an array or a set, which is no file")


class _Given:
    """What the caller says of a file's set."""

    def __init__(
        self,
        radius: Any,
        width: float | None,
        height: float | None,
        boundary: Boundary | None,
        origin: tuple[float, float] | None,
    ) -> None:
        self.radius, self.width, self.height, self.boundary = radius, width, height, boundary
        self.origin = None if origin is None else place("origin", origin)


def _set_on(points: PointSet | npt.ArrayLike, field: Field, given: _Given) -> PointSet:
    """Returns positions as a set with a field or a shape."""
    if isinstance(points, PointSet):
        own = points.domain
        given.width = own.width if given.width is None else given.width
        given.height = own.height if given.height is None else given.height
        given.boundary = given.boundary or own.boundary  # type: ignore[assignment]
        given.origin = points.origin
        return PointSet._on(points.points, _tilescope.ground_of(given, field))
    ground = _tilescope.ground_of(given, field)
    return PointSet._on(numbers("points", points) - ground.origin(), ground)


def _set_of(
    points: PointSet | npt.ArrayLike,
    radius: Any,
    width: float | None,
    height: float | None,
    boundary: Boundary | None,
) -> PointSet:
    if isinstance(points, PointSet):
        if (radius, width, height, boundary) == (None, None, None, None):
            return points
        # A set brings its domain and its radius; arguments take their place.
        own = points.domain
        radius = points.radius if radius is None else radius
        width = own.width if width is None else width
        height = own.height if height is None else height
        boundary = own.boundary if boundary is None else boundary  # type: ignore[assignment]

    return PointSet(
        points,
        radius,
        width=1.0 if width is None else width,
        height=1.0 if height is None else height,
        boundary="periodic" if boundary is None else boundary,
    )


def analyze(
    points: PointSet | Path | npt.ArrayLike,
    radius: float | None = None,
    *,
    width: float | None = None,
    height: float | None = None,
    boundary: Boundary | None = None,
    format: Format | None = None,
    set: SupportsIndex | None = None,
    origin: tuple[float, float] | None = None,
    progress: Progress = False,
) -> dict[str, float | None]:
    """Measures a set: distances, blue noise, order, discrepancy.

    Parameters are those of :func:`verify`. Without a radius the smallest distance between two
    samples stands for it.

    Returns
    -------
    dict
        The numbers of ``tilescope analyze`` by its names; ``None`` where one is not defined.
        :meth:`PointSet.spectrum` and :meth:`PointSet.pair_correlation` have the curves.

    Examples
    --------
    >>> measures = tilescope.analyze(tilescope.sample(2000))
    >>> 0.69 < measures["density"] < 0.71
    True
    >>> measures["conflicts"], measures["gaps"]
    (0.0, 0.0)
    """
    if isinstance(points, (str, os.PathLike)):
        points = read(
            points, radius, width=width, height=height, boundary=boundary, format=format, set=set, origin=origin
        )
    else:
        _check_no_file(format, set, origin)
        points = _set_of(points, radius, width, height, boundary)
    with following(progress) as told:
        return _tilescope.analyze(points, told)


def read(
    path: Path,
    radius: Radius | None = None,
    *,
    radius_expression: str | None = None,
    density: Pixels | None = None,
    mask: Pixels | None = None,
    shape: Any = None,
    planar: bool = False,
    image: Image | None = None,
    width: float | None = None,
    height: float | None = None,
    boundary: Boundary | None = None,
    format: Format | None = None,
    set: SupportsIndex | None = None,
    origin: tuple[float, float] | None = None,
    certificate: bool = True,
    progress: Progress = False,
) -> PointSet:
    """Reads a set from a file of any format that Tilescope writes, and with pyarrow from GeoParquet.

    If the file has a certificate, its set is judged and every statement of the certificate compared, as
    :func:`verify` does. What the certificate says of a domain or a radius other than those given is left out.

    Parameters
    ----------
    path : path-like
        The file.
    radius, width, height, boundary, optional
        Of the set. If not given, the certificate beside the file says them; without one, the domain
        is the periodic unit square and the radius is not known.
    radius_expression, density, mask, shape, planar, optional
        With `radius` the field and the shape of the set, as in :func:`verify`.
    image : array_like or path-like, optional
        Of a stipple, the image that it was made from, as it was given to :func:`stipple`.
    format : str, optional
        The format, if neither the extension nor the content says it.
    set : int, optional
        Which set of a file that holds several, from 0. Files of UTK may.
    origin : (x, y), optional
        Where the file holds the lower corner of the domain, which is subtracted from its positions. If not given, where
        the certificate states, which refuses another, and else 0, 0. The set keeps it: :attr:`PointSet.origin`.
    certificate : bool
        Whether to look at a certificate. Without it the positions alone are read: the method of the set is
        ``'unknown'``, and what is saved of it says so.
    progress
        As in :func:`sample`.

    Returns
    -------
    PointSet
        The set, as it stands in the file. It need not be valid, if its certificate says so.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it is not a point set, or its certificate is not true; the text says where.
    """
    if not isinstance(certificate, bool):
        raise TypeError(f"certificate is {shown(certificate)}; it must be True or False")
    field = field_of(radius, radius_expression, density, mask, shape, planar, image)
    radius = radius if field is None else None
    return _read(path, radius, field, width, height, boundary, format, set, origin, certificate, progress)


def _read(
    path: Path,
    radius: Any,
    field: Field | None,
    width: float | None,
    height: float | None,
    boundary: Boundary | None,
    format: Format | None,
    set: SupportsIndex | None,
    origin: tuple[float, float] | None,
    certificate: bool = True,
    progress: Progress = False,
) -> PointSet:
    name = local_path(path)

    # pyarrow reads GeoParquet; everything else is read by the native module, with its certificate.
    if _parquet.is_to_read(name, format):
        if set is not None:
            raise ValueError(f"set is {shown(set)}, but {shown_text(name)} is GeoParquet, which holds one set")
        if origin is not None:
            raise ValueError(
                f"origin is {shown(origin)}, but {shown_text(name)} is GeoParquet, of which no certificate states an "
                "origin; subtract it from the positions"
            )

        sides = (1.0 if width is None else width, 1.0 if height is None else height)
        if field is not None:
            return _set_on(_parquet.read(name, sides), field, _Given(None, width, height, boundary, None))
        return _set_of(_parquet.read(name, sides), radius, width, height, boundary)

    given = _Given(radius, width, height, boundary, origin)
    with following(progress) as told:
        return PointSet._made(*_tilescope.read(name, given, field, format, set, certificate, told))


def read_solid(
    path: Path,
    radius: float | None = None,
    *,
    size: tuple[float, float, float] | None = None,
    boundary: Boundary | None = None,
    format: Format | None = None,
) -> SolidSet:
    """Reads a set in space from a file, whose certificate is compared with it.

    Parameters
    ----------
    path : path-like
        The file: ``.ply``, ``.npy`` of shape (N, 3), ``.csv``, ``.xyz``, ``.bin`` or ``.dat`` of UTK.
    radius, size, boundary, optional
        Of the set. If not given, the certificate beside the file says them.
    format : str, optional
        The format, if neither the extension nor the content says it.

    Returns
    -------
    SolidSet
        The set, as it stands in the file. It is not judged.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it holds no set in space, its certificate is not true, or nothing says its radius or its box.
    """
    box = None if size is None else sides(size)
    return SolidSet._made(_tilescope.read_file_in_space(local_path(path), box, boundary, radius, format))


def combine(layout: Path | Mapping[str, Any], *, folder: Path = "", progress: Progress = False) -> PointSet:
    """Glues sets into one, as a layout of rectangles places them (section 4.2 of the paper).

    Near the seams samples are eliminated and inserted, so that the result is conflict-free and
    maximal; all others stay as they are.

    Parameters
    ----------
    layout : mapping or path-like
        The layout, as ``tilescope combine --help`` describes it, or the JSON file that has it. In a
        mapping a piece may have a :class:`PointSet` in place of a file's name.
    folder : path-like
        Where files of a mapping are; those of a layout in a file are beside it.
    progress
        As in :func:`sample`.

    Returns
    -------
    PointSet
        The set.

    Raises
    ------
    ValueError
        If the rectangles do not fill the domain, or a set is not conflict-free and maximal.

    Examples
    --------
    >>> halves = tilescope.sample(500, seed=1), tilescope.sample(radius=0.04, seed=2, boundary="bounded")
    >>> glued = tilescope.combine({
    ...     "version": 1, "radius": 0.02, "columns": [0.5, 0.5], "rows": [0.5],
    ...     "pieces": [{"file": one} for one in halves],
    ... })
    >>> glued.verify().valid
    True
    """
    sets: dict[str, PointSet] = {}
    if isinstance(layout, Mapping):
        # Sets in memory get names in the place of files, so that the rest is a layout like any other.
        described = dict(layout)
        described["pieces"] = [dict(piece) for piece in layout.get("pieces", [])]
        for index, piece in enumerate(described["pieces"]):
            if isinstance(piece.get("file"), PointSet):
                name = f"<set {index}>"
                sets[name] = piece["file"]
                piece["file"] = name

        text = json.dumps(described)
    else:
        name = local_path(layout)
        with open(name, encoding="utf-8") as file:
            text = file.read()
        folder = os.path.dirname(name)

    with following(progress) as told:
        return PointSet._made(_tilescope.combine(text, local_path(folder), sets, told))


def set_threads(threads: SupportsIndex) -> None:
    """Sets how many threads compute, from 1 to 1024. If it is never called, there are as many as there are cores."""
    _tilescope.set_threads(threads)


def widget(made: PointSet, *, address: str | os.PathLike[str] | None = None, height: SupportsIndex = 480) -> Widget:
    """Shows a set in a cell of a notebook, with the run that made it in a player.

    It is a widget of `anywidget <https://anywidget.dev>`_, for JupyterLab, Jupyter Notebook and
    what else shows such widgets. The player comes from the installed package and needs no network.
    Its moment and its selection go both ways: ``cursor``, ``moment`` and ``selected`` follow what is
    done in the cell, and setting them moves the player; ``observe`` calls a function when they
    change. ``play()`` and ``pause()`` let time run and stop it.

    Sets that no run of at most 200,000 samples has made are shown as points, of which a click
    selects one; ``note`` says why. So are sets where the notebook allows no frame.

    Parameters
    ----------
    made : PointSet
        The set.
    address : str or path-like, optional
        Where the page is served (``'https://...'``, ``'http://127.0.0.1:8080/'``), or the folder that
        ``web/build`` has made. If not given, the page of the installed package, which release wheels have.
    height : int
        The height in pixels, from 120 to 4000.

    Returns
    -------
    Widget
        A widget, which a cell shows as its last value.

    Raises
    ------
    ImportError
        If anywidget is not installed.
    FileNotFoundError
        If the folder has no page.
    TypeError
        If it is no set in the plane.

    Examples
    --------
    >>> w = tilescope.widget(tilescope.sample(radius=0.02))  # doctest: +SKIP
    >>> w.moment = "eliminate"  # doctest: +SKIP
    """
    if not isinstance(made, PointSet):
        raise TypeError(f"the set is of the type {type(made).__name__}; it must be a PointSet")
    _optional.module("anywidget", "widget")
    from tilescope._widget import Widget

    return Widget(made, address=address, height=height)
