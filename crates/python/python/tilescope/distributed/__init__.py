"""Sets larger than a machine: a plane written tile by tile, by this machine, by Dask or by Ray.

A window of a plane needs nothing of its neighbours, so that tiles can be made anywhere, in any order, and again.
:func:`write` makes them, has each judged with its surroundings where it is made, and writes a folder of
GeoParquet files with a manifest. :func:`open` reads such a folder.

It needs pyarrow; ``pip install 'tilescope[parquet]'``, ``'tilescope[dask]'`` or ``'tilescope[ray]'`` brings what each
engine needs.

Examples
--------
>>> import tilescope.distributed
>>> plane = tilescope.Plane(radius=0.002)
>>> stored = tilescope.distributed.write(plane, folder / "set", rows=50_000)
>>> stored
<StoredPlane: 175... samples in 2 x 2 tiles, radius 0.002, 1 x 1, periodic>
>>> import numpy as np
>>> np.array_equal(stored.window(0.4, 0.4, 0.6, 0.6), plane.window(0.4, 0.4, 0.6, 0.6))
True
"""

from __future__ import annotations

import json
import operator
import pickle
from contextlib import closing
from dataclasses import asdict
from pathlib import Path as Folder
from typing import Any, SupportsIndex

from tilescope import Domain, Plane, PointSet, __version__
from tilescope._input import Path, local_path, shown
from tilescope._optional import module
from tilescope._point_set import Judge
from tilescope._progress import Progress, following
from tilescope.distributed import _engines, _tile
from tilescope.distributed._engines import Engine
from tilescope.distributed._grid import Grid
from tilescope.distributed._stored import MANIFEST, StoredPlane, read_manifest

__all__ = ["StoredPlane", "digest", "open", "write"]

_LEAST_ROWS, _MOST_ROWS = 1000, 50_000_000


def __dir__() -> list[str]:
    return sorted([*__all__, "__doc__", "__name__"])


def write(
    plane: Plane,
    path: Path,
    *,
    engine: Engine = "local",
    rows: SupportsIndex = 2_000_000,
    judge: Judge | None = None,
    retries: SupportsIndex = 3,
    progress: Progress = False,
) -> StoredPlane:
    """Writes all samples of a plane to a folder, tile by tile.

    The domain is cut into tiles; each sample belongs to one of them, also where it lies on a
    border. Every tile is judged with the samples around it, written under a temporary name, read
    back and compared, and only then gets its name. Positions, and so the digests in the manifest,
    do not depend on the engine, on the number of workers, or on what failed meanwhile.

    If the folder has some tiles of the same set, because an earlier call was interrupted, those
    whose files are sound are kept.

    Parameters
    ----------
    plane : Plane
        The plane.
    path : path-like
        A folder, which is made if it does not exist. All workers must see it under this path.
    engine : {'local', 'dask', 'ray'}
        What makes the tiles: the threads of this process; the workers of the current Dask client,
        or of a cluster on this machine if there is none; the Ray cluster that ``ray.init`` joined,
        or one on this machine.
    rows : int
        About the most rows that a tile has, and thus a row group of Parquet: a row is a sample.
        From 1000 to 5e7. Making a tile takes about 200 bytes a row in each worker's thread.
    judge : {'delaunay', 'circles', 'both'}, optional
        Who judges. If not given, both do up to 2**20 samples with the halo, and covered circles for more.
    retries : int
        How often a tile is tried again whose file cannot be written; by Ray, also one whose worker
        is lost. Dask has a setting for lost workers, ``distributed.scheduler.allowed-failures``.
    progress : bool or callable
        Whether to show a bar, or what to call with the work's name, the number of finished tiles,
        and that of all tiles.

    Returns
    -------
    StoredPlane
        The set in the folder.

    Raises
    ------
    ValueError
        If an argument is wrong, the plane has nested levels, a tile is not valid, or the folder has
        another set; the text names the difference.
    FileExistsError
        If the folder has other files, and no set.
    OSError
        If a file cannot be written.
    KeyboardInterrupt
        After Ctrl-C. Finished tiles stay, and the same call goes on with the others.
    """
    if not isinstance(plane, Plane):
        raise TypeError(f"plane is {shown(plane)}; it must be a tilescope.Plane")
    if plane.parameters.get("levels") is not None:
        raise ValueError("the plane has nested levels; a folder keeps neither their order nor their radii")

    retries = operator.index(retries)
    if retries < 0:
        raise ValueError(f"retries is {shown(retries)}; it must be at least 0")

    _engines.check(engine)
    module("pyarrow.parquet", "parquet")

    grid = _grid(plane.domain, plane.radius, rows)
    # Through JSON and back, so that the facts are equal to those of a manifest that was read.
    facts = json.loads(
        json.dumps(
            {
                "format": _tile.FORMAT,
                "version": _tile.VERSION,
                "domain": plane.domain,
                "radius": plane.radius,
                "parameters": plane.parameters,
                "grid": grid.shape,
            }
        )
    )

    # A manifest of KDRT states no method. The two methods have other parameters, so that no folder goes on with the other one.
    method = {} if plane.method == "kdrt" else {"method": plane.method}

    folder = Folder(local_path(path)).resolve()
    folder.mkdir(parents=True, exist_ok=True)

    known: list[str | None] = [None] * len(grid)
    if (folder / MANIFEST).exists():
        before = read_manifest(folder)
        if (difference := _difference(before, facts)) is not None:
            raise ValueError(f"{folder} has another set: {difference}")
        # Of an interrupted call the manifest lists no tiles yet.
        for index, tile in enumerate(before["tiles"]):
            known[index] = tile["file_digest"]
    elif any(file.suffix != _tile.PARTIAL for file in folder.iterdir()):
        # Without a manifest, only leftovers of tiles may be there: anything else is not this program's to overwrite.
        raise FileExistsError(f"{folder} is not empty, and has no {MANIFEST}: give another folder")
    else:
        _save(folder, facts | method | {"complete": False, "tiles": []})

    job = _tile.Job(pickle.dumps(plane), facts, str(folder), grid, judge)
    made: dict[int, _tile.Tile] = {}
    outcomes = _engines.outcomes(engine, _tile.make, job, enumerate(known), retries)

    with following(progress) as told, closing(outcomes):
        for index, tile in outcomes:
            made[index] = tile
            if told is not None:
                told("tiles", len(made), len(grid))

    tiles = [made[index] for index in range(len(grid))]
    result = {
        "complete": True,
        "count": sum(tile.count for tile in tiles),
        "digest": _tile.total_digest([tile.digest for tile in tiles]),
        "tiles": [asdict(tile) for tile in tiles],
        "made_by": f"tilescope {__version__}",
    }

    _save(folder, facts | method | result)
    for left in folder.glob(f"*{_tile.PARTIAL}"):
        # A lost worker left it, or a worker that was given up is about to rename it.
        left.unlink(missing_ok=True)
    return open(folder)


def _grid(domain: Domain, radius: float, rows: SupportsIndex) -> Grid:
    rows = operator.index(rows)
    if not _LEAST_ROWS <= rows <= _MOST_ROWS:
        raise ValueError(f"rows is {shown(rows)}; it must be between {_LEAST_ROWS} and {_MOST_ROWS}")
    return Grid.of(domain, radius, rows)


def _save(folder: Folder, manifest: dict[str, Any]) -> None:
    text = json.dumps(manifest, indent=1) + "\n"
    with _tile.partial_file(str(folder / MANIFEST), text.encode()) as partial:
        _tile.replace(partial, str(folder / MANIFEST))


def _difference(stated: Any, wanted: Any, name: str = "") -> str | None:
    """Returns the first value of `wanted` that is another one in `stated`, in words."""
    if isinstance(stated, dict) and isinstance(wanted, dict):
        for key, value in wanted.items():
            found = _difference(stated.get(key), value, f"{name}.{key}" if name else key)
            if found is not None:
                return found
        return None
    return None if stated == wanted else f"{name} is {shown(stated)} there, and {shown(wanted)} here"


def open(path: Path) -> StoredPlane:
    """Opens a folder that :func:`write` has made. Only the manifest is read.

    Raises
    ------
    FileNotFoundError
        If there is no manifest.
    ValueError
        If the set is not complete, or the manifest contradicts itself.
    """
    return StoredPlane(path)


def digest(points: PointSet, *, rows: SupportsIndex = 2_000_000) -> str:
    """Returns the digest that a set in memory would have if :func:`write` had written it with so many `rows`.

    Examples
    --------
    >>> plane = tilescope.Plane(radius=0.004, seed=5)
    >>> stored = tilescope.distributed.write(plane, folder / "digest", rows=10_000)
    >>> stored.digest == tilescope.distributed.digest(tilescope.sample(radius=0.004, seed=5), rows=10_000)
    True
    """
    if points.radius is None:
        raise ValueError("the radius of the set is not known, and tiles are cut by it")
    return _tile.set_digest(points, _grid(points.domain, points.radius, rows))
