"""The file of a tile: GeoParquet with one row group."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import pickle
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from tilescope import Plane, PointSet
from tilescope._optional import module
from tilescope._point_set import Judge
from tilescope._progress import ProgressFunction
from tilescope.distributed._grid import Grid, Positions

FORMAT = "tilescope-tiles"
VERSION = 1
# The key of Tilescope's facts in the metadata of a file.
_KEY = b"tilescope"
# How the names of files end that are being written.
PARTIAL = ".partial"


@dataclass(frozen=True)
class Tile:
    """What the manifest says of a tile."""

    file: str
    count: int
    bbox: list[float]
    digest: str
    file_digest: str


def sha256(data: Any) -> str:
    """Returns a digest as text."""
    return f"sha256:{hashlib.sha256(data).hexdigest()}"


def digest(positions: Positions) -> str:
    """Returns the digest of positions: of x and y of each in turn, as little-endian float64."""
    return sha256(np.ascontiguousarray(positions, dtype="<f8"))


def total_digest(digests: list[str]) -> str:
    """Returns the digest of all tiles: of their digests, 32 bytes each, in the order of their numbers."""
    return sha256(b"".join(bytes.fromhex(one.partition(":")[2]) for one in digests))


def _bbox(positions: Positions) -> list[float]:
    # numpy is several times slower along both axes at once.
    x, y = positions.T
    return [float(x.min()), float(y.min()), float(x.max()), float(y.max())]


def _encoded(positions: Positions, facts: dict[str, Any]) -> bytes:
    """Returns the bytes of a file."""
    arrow, parquet = module("pyarrow", "parquet"), module("pyarrow.parquet", "parquet")

    x, y = (np.ascontiguousarray(positions[:, axis]) for axis in (0, 1))
    coordinate = [arrow.field(name, arrow.float64(), nullable=False) for name in "xy"]
    points = arrow.StructArray.from_arrays([arrow.array(x), arrow.array(y)], fields=coordinate)

    geometry = {
        "encoding": "point", "geometry_types": ["Point"], "crs": None, "edges": "planar", "bbox": _bbox(positions),
    }  # fmt: skip
    geo = {"version": "1.1.0", "primary_column": "geometry", "columns": {"geometry": geometry}}
    schema = arrow.schema(
        [arrow.field("geometry", points.type, nullable=False)],
        metadata={b"geo": json.dumps(geo).encode(), _KEY: json.dumps(facts).encode()},
    )

    sink = arrow.BufferOutputStream()
    parquet.write_table(
        arrow.Table.from_arrays([points], schema=schema), sink, row_group_size=len(positions), use_dictionary=False,
        compression="zstd", compression_level=1, use_byte_stream_split=True, write_page_checksum=True,
    )  # fmt: skip

    encoded: bytes = sink.getvalue().to_pybytes()
    return encoded


def read(path: str, data: bytes | None = None) -> tuple[Positions, dict[str, Any]]:
    """Returns the positions and Tilescope's facts of a file, or of its bytes. Raises ``ValueError`` if it is damaged."""
    arrow, parquet = module("pyarrow", "parquet"), module("pyarrow.parquet", "parquet")
    if data is None:
        with open(path, "rb") as file:
            data = file.read()

    try:
        opened = parquet.ParquetFile(arrow.BufferReader(data), page_checksum_verification=True)
        points = opened.read(use_threads=False).column("geometry").combine_chunks()
        positions = np.empty((len(points), 2))
        for axis in (0, 1):
            positions[:, axis] = points.field(axis).to_numpy(zero_copy_only=False)
        return positions, json.loads(opened.schema_arrow.metadata[_KEY])
    except Exception as error:
        # A damaged file raises what it happens to lead to.
        raise ValueError(f"{path} is not a tile, or it is damaged: {error}") from error


@dataclass(frozen=True)
class Job:
    """What all tiles of a set have in common."""

    # Pickled, so that each process makes it once. Files are checked without it.
    plane: bytes
    # What every file says of the set.
    facts: dict[str, Any]
    folder: str
    grid: Grid
    judge: Judge | None = None

    def path(self, index: int) -> str:
        """Returns the file of a tile."""
        return os.path.join(self.folder, self.grid.file(index))

    def facts_of(self, index: int, digest: str) -> dict[str, Any]:
        """Returns what the file of a tile says."""
        return self.facts | {"tile": list(self.grid.place(index)), "digest": digest}

    def tile(self, index: int, path: str, data: bytes, file_digest: str) -> Tile:
        """Returns what the manifest is to say of a file with these bytes, or raises ``ValueError`` if it is not this
        tile."""
        positions, facts = read(path, data)
        found = digest(positions)
        if facts != self.facts_of(index, found):
            raise ValueError(f"{path} is another tile, or its positions are not those that were written")
        if not self.grid.holds(index, positions).all():
            raise ValueError(f"{path} has positions outside of its tile")
        return Tile(self.grid.file(index), len(positions), _bbox(positions), found, file_digest)


@functools.lru_cache(maxsize=1)
def _plane(pickled: bytes) -> Plane:
    plane: Plane = pickle.loads(pickled)
    return plane


def _content(path: str) -> bytes:
    with open(path, "rb") as file:
        return file.read()


@contextmanager
def partial_file(path: str, data: bytes) -> Iterator[str]:
    """Writes a new file beside `path`, through to the device, and returns its name. It is removed if it still has it."""
    partial = f"{path}.{uuid.uuid4().hex}{PARTIAL}"
    try:
        # A link that somebody else has put there is not followed.
        with open(partial, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        yield partial
    finally:
        if os.path.exists(partial):
            os.unlink(partial)


def replace(partial: str, path: str) -> None:
    """Gives a file its name, which it has after a power cut, too."""
    os.replace(partial, path)
    if os.name == "posix":
        folder = os.open(os.path.dirname(path), os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def make(job: Job, item: tuple[int, str | None], progress: ProgressFunction | None) -> tuple[int, Tile]:
    """Makes, verifies and writes a tile, unless its file is there and sound.

    An item is the number of a tile, and the digest of its file, if that is known.
    """
    index, known = item
    grid, path = job.grid, job.path(index)

    try:
        data = _content(path)
        file_digest = sha256(data)
        if known in (None, file_digest):
            return index, job.tile(index, path, data, file_digest)
    except (FileNotFoundError, ValueError):
        # It is not there, or was damaged: it is made again.
        pass

    plane, bounds = _plane(job.plane), grid.bounds(index)
    near = plane.window(*grid.surroundings(bounds), progress=progress or False)
    samples = near[grid.holds(index, near)]

    conflicts, gaps = grid.judge(near, bounds, job.judge, progress)
    if conflicts or gaps:
        raise ValueError(f"{path} is not written: the tile is not valid, with {conflicts} conflicts and {gaps} gaps")

    made = digest(samples)
    encoded = _encoded(samples, job.facts_of(index, made))
    with partial_file(path, encoded) as partial:
        # Read back from the disk, as the digest in the manifest is to be that of the bytes that are there.
        data = _content(partial)
        written = job.tile(index, partial, data, sha256(data))
        if data != encoded or written.digest != made:
            raise OSError(f"{partial} does not hold what was written to it")
        replace(partial, path)

    return index, written


def fault_of(job: Job, item: tuple[int, Tile], progress: ProgressFunction | None) -> tuple[int, str | None]:
    """Returns what is wrong with the file of a tile, if anything is."""
    index, stated = item
    path = job.path(index)
    try:
        data = _content(path)
        if sha256(data) != stated.file_digest:
            return index, f"{path} has other bytes than were written to it"
        found = job.tile(index, path, data, stated.file_digest)
    except FileNotFoundError:
        return index, f"{path} is missing"
    except ValueError as error:
        return index, str(error)
    return index, None if found == stated else f"{path} is not what the manifest says of it"


def set_digest(points: PointSet, grid: Grid) -> str:
    """Returns the digest of a set in memory, cut into tiles."""
    tiles = grid.tiles_of(points.points)
    order = np.argsort(tiles, kind="stable")
    ends = np.searchsorted(tiles[order], np.arange(1, len(grid)))
    return total_digest([digest(part) for part in np.split(points.points[order], ends)])
