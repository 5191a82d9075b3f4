"""A plane in a folder: its manifest, its windows, its verdict."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterable
from contextlib import closing
from importlib.util import find_spec
from pathlib import Path as Folder
from typing import Any, Literal

import numpy as np

from tilescope import Domain
from tilescope._input import Path, local_path, shown, shown_text
from tilescope._optional import module
from tilescope._point_set import Judge, Window
from tilescope._progress import Progress, ProgressFunction, following
from tilescope.distributed import _engines as engines
from tilescope.distributed._engines import Engine
from tilescope.distributed._grid import Grid, Positions
from tilescope.distributed._tile import FORMAT, VERSION, Job, Tile, fault_of, read, total_digest

MANIFEST = "manifest.json"
# What the manifest says of the set, and every file of a tile again.
FACTS = ("format", "version", "domain", "radius", "parameters", "grid")


def read_manifest(folder: Folder) -> dict[str, Any]:
    """Returns what a manifest says, each value of its type, or raises ``ValueError`` if it is none.

    A manifest that is complete lists as many tiles as its grid has; another one may list none.
    """
    path = folder / MANIFEST
    text = path.read_text(encoding="utf-8")

    try:
        manifest = json.loads(text)
        named = (manifest["format"], manifest["version"])
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise ValueError(f"{path} is not a manifest, or it is damaged: {shown_text(error)}") from error

    if named != (FORMAT, VERSION):
        raise ValueError(f"{path} has the format {shown(named)}; this version reads {(FORMAT, VERSION)}")

    try:
        _check_types(manifest)
    except (ValueError, KeyError) as error:
        raise ValueError(f"{path} cannot be used: {shown_text(error)}") from error

    return manifest  # type: ignore[no-any-return]


def _check_types(manifest: dict[str, Any]) -> None:
    """Raises ``ValueError`` for a value of another type, or a list of another length, than manifests have."""
    width, height, boundary = _listed("domain", manifest["domain"], 3)
    for name, number in (("domain", width), ("domain", height), ("radius", manifest["radius"])):
        _check(name, number, _is_length(number), "a finite number above 0")
    _check("domain", boundary, boundary in ("periodic", "bounded"), "'periodic' or 'bounded'")
    _check("parameters", manifest["parameters"], isinstance(manifest["parameters"], dict), "an object")
    columns, rows = _listed("grid", manifest["grid"], 2)
    for number in (columns, rows):
        _check("grid", number, _is_whole(number) and number > 0, "a whole number above 0")
    complete, tiles = manifest["complete"], manifest["tiles"]
    _check("complete", complete, isinstance(complete, bool), "true or false")

    # The grid is a claim, which may be of any size; the tiles are there.
    if not isinstance(tiles, list):
        raise ValueError(f"tiles is {shown(tiles)}; it must be a list")
    if (complete or tiles) and len(tiles) != columns * rows:
        raise ValueError(
            f"its tiles are not those of its grid: {len(tiles)} are listed, and {columns} x {rows} are {columns * rows}"
        )

    for tile in tiles:
        _check("a tile", tile, isinstance(tile, dict), "an object")
        for name in ("file", "digest", "file_digest"):
            _check(f"a tile's {name}", tile[name], isinstance(tile[name], str), "text")
        _check("a tile's count", tile["count"], _is_whole(tile["count"]) and tile["count"] >= 0, "a whole number")
        for number in _listed("a tile's bbox", tile["bbox"], 4):
            _check("a tile's bbox", number, _is_number(number), "a finite number")

    if complete:
        _check("count", manifest["count"], _is_whole(manifest["count"]), "a whole number")
        _check("digest", manifest["digest"], isinstance(manifest["digest"], str), "text")


def _check(name: str, value: Any, is_right: bool, wanted: str) -> None:
    if not is_right:
        raise ValueError(f"{name} has {shown(value)}, where {wanted} must be")


def _listed(name: str, value: Any, length: int) -> list[Any]:
    if not isinstance(value, list):
        raise ValueError(f"{name} is {shown(value)}; it must be a list")
    if len(value) != length:
        raise ValueError(f"{name} has {len(value)} values; it must have {length}")
    return value


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_number(value: Any) -> bool:
    return _is_whole(value) or (isinstance(value, float) and math.isfinite(value))


def _is_length(value: Any) -> bool:
    return _is_number(value) and value > 0


class StoredPlane:
    """A plane in a folder, tile by tile; :func:`open` and :func:`write` return one.

    Nothing is kept in memory but the manifest.
    """

    __slots__ = ("_folder", "_grid", "_manifest", "_tiles")

    def __init__(self, path: Path) -> None:
        self._folder = Folder(local_path(path)).resolve()
        self._manifest = manifest = read_manifest(self._folder)
        try:
            width, height, boundary = manifest["domain"]
            columns, rows = manifest["grid"]
            self._grid = Grid(Domain(width, height, boundary), manifest["radius"], (columns, rows))

            if not manifest["complete"]:
                # By the files that are there, of which there are fewer than a grid may claim.
                there = sum(self._grid.has_file(name) for name in os.listdir(self._folder))
                raise ValueError(f"it has {there} of {columns * rows} tiles; write it again to complete it")

            # The manifest says some things twice: it is refused where it contradicts itself.
            self._tiles = [Tile(**tile) for tile in manifest["tiles"]]
            if [tile.file for tile in self._tiles] != [self._grid.file(at) for at in range(len(self._grid))]:
                raise ValueError("its tiles are not those of its grid")
            if manifest["count"] != sum(tile.count for tile in self._tiles):
                raise ValueError("its count is not that of its tiles")
            if manifest["digest"] != total_digest([tile.digest for tile in self._tiles]):
                raise ValueError("its digest is not that of its tiles' digests")
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"{self._folder / MANIFEST} cannot be used: {shown_text(error)}") from error

    @property
    def domain(self) -> Domain:
        """Width, height and boundary of the domain."""
        return self._grid.domain

    @property
    def radius(self) -> float:
        """The Poisson-disk radius."""
        return self._grid.radius

    @property
    def parameters(self) -> dict[str, Any]:
        """Every parameter of the plane by its name."""
        return self.manifest["parameters"]  # type: ignore[no-any-return]

    @property
    def digest(self) -> str:
        """The digest of all positions. It depends on the plane and on `rows` alone, not on who made the set."""
        return self._manifest["digest"]  # type: ignore[no-any-return]

    @property
    def manifest(self) -> dict[str, Any]:
        """What ``manifest.json`` says."""
        return json.loads(json.dumps(self._manifest))  # type: ignore[no-any-return]

    @property
    def files(self) -> list[str]:
        """The files of the tiles, row by row."""
        return [str(self._folder / tile.file) for tile in self._tiles]

    def __len__(self) -> int:
        return int(self._manifest["count"])

    def __repr__(self) -> str:
        (width, height, boundary), (columns, rows) = self.domain, self._grid.shape
        return (
            f"<StoredPlane: {len(self)} samples in {columns} x {rows} tiles, radius {self.radius:.6g}, "
            f"{width:g} x {height:g}, {boundary}>"
        )

    def window(self, x0: float, y0: float, x1: float, y1: float) -> Positions:
        """Returns the samples with ``x0 <= x < x1`` and ``y0 <= y < y1``, as :meth:`tilescope.Plane.window` does.

        Only the tiles that the window reaches into are read.

        Returns
        -------
        numpy.ndarray of shape (N, 2)
            The positions, in the sequence of the whole set; read-only.

        Raises
        ------
        ValueError
            If the window is one that a plane refuses, or a file is damaged.
        OSError
            If a file cannot be read.
        """
        found = self._samples((x0, y0, x1, y1))
        found = found[self._grid.lattice().sequence(found)]
        found.flags.writeable = False
        return found

    def _samples(self, window: Window) -> Positions:
        """Returns the samples in a window, tile by tile."""
        lattice = self._grid.lattice()
        spans = lattice.spans(window)
        found = [np.empty((0, 2))]
        for index in lattice.tiles(spans):
            tile, _ = read(os.path.join(self._folder, self._tiles[index].file))
            found.append(tile[lattice.inside(tile, spans)])
        return np.concatenate(found)

    def frame(self, engine: Literal["dask", "arrow"] | None = None) -> Any:
        """Returns a lazy frame of all samples.

        Parameters
        ----------
        engine : {'dask', 'arrow'}, optional
            A frame of Dask with the columns ``x`` and ``y`` and a partition for each tile, or a
            dataset of pyarrow with the column ``geometry``, a structure of both. If not given,
            Dask where it is installed.

        Examples
        --------
        >>> stored = tilescope.distributed.write(tilescope.Plane(radius=0.01), folder / "frame", rows=2000)
        >>> len(stored.frame()) == len(stored)
        True
        """
        if engine is None:
            engine = "dask" if find_spec("dask") and find_spec("pandas") else "arrow"
        if engine == "dask":
            frames = module("dask.dataframe", "dask")
            return frames.from_map(_frame_of, self.files, meta=_frame(np.empty((0, 2))))
        if engine == "arrow":
            dataset = module("pyarrow.dataset", "parquet")
            options = dataset.ParquetFragmentScanOptions(page_checksum_verification=True)
            return dataset.dataset(self.files, format=dataset.ParquetFileFormat(default_fragment_scan_options=options))
        raise ValueError(f"engine is {shown(engine)}; it must be 'dask' or 'arrow'")

    def verify(
        self,
        *,
        positions: bool = True,
        engine: Engine = "local",
        judge: Judge | None = None,
        progress: Progress = False,
    ) -> list[str]:
        """Returns what is wrong with the set, by its files alone: nothing, if it is sound.

        Each file must have the bytes that were written, as the manifest's digest states them, and
        the positions, count and box that the manifest says; every position must lie in its tile.
        If all files are sound, each tile is judged with the samples that other files have around
        it: no two samples of the set are closer than the radius, and no place is uncovered.

        Parameters
        ----------
        positions : bool
            Whether to judge.
        engine, judge, progress
            As in :func:`write`.

        Returns
        -------
        list of str
            A text for each tile with a fault, which names its file.
        """
        engines.check(engine)
        job = Job(b"", {name: self._manifest[name] for name in FACTS}, str(self._folder), self._grid, judge)
        with following(progress) as told:
            faults = self._faults("files", engine, fault_of, job, enumerate(self._tiles), told)
            if positions and not faults:
                faults = self._faults("tiles", engine, _verdict, (self, judge), range(len(self._tiles)), told)
        return faults

    def _faults(
        self,
        name: str,
        engine: Engine,
        task: Callable[[Any, Any, ProgressFunction | None], tuple[int, str | None]],
        shared: Any,
        items: Iterable[Any],
        told: ProgressFunction | None,
    ) -> list[str]:
        """Returns the faults that a task finds, in the order of tiles."""
        found = {}
        with closing(engines.outcomes(engine, task, shared, items, 0)) as outcomes:
            for done, (index, fault) in enumerate(outcomes, start=1):
                if fault is not None:
                    found[index] = fault
                if told is not None:
                    told(name, done, len(self._tiles))
        return [found[index] for index in sorted(found)]


def _verdict(
    shared: tuple[StoredPlane, Judge | None], index: int, progress: ProgressFunction | None
) -> tuple[int, str | None]:
    """Judges a tile by the files."""
    stored, judge = shared
    grid = stored._grid
    bounds = grid.bounds(index)
    conflicts, gaps = grid.judge(stored._samples(grid.surroundings(bounds)), bounds, judge, progress)
    if not conflicts and not gaps:
        return index, None
    return index, f"{stored.files[index]} is not valid: conflicts: {conflicts}, gaps: {gaps}"


def _frame(positions: Positions) -> Any:
    return module("pandas", "dask").DataFrame({"x": positions[:, 0], "y": positions[:, 1]})


def _frame_of(file: str) -> Any:
    return _frame(read(file)[0])
