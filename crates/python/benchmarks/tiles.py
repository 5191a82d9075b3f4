"""How fast planes are written tile by tile, and checked: the numbers of `distributed.md`.

Rates a core are samples by seconds of the processor, so that a busy machine does not matter; rates of an engine are
samples by seconds of a clock. It needs `pip install 'tilescope[dask,ray]'` and 1 GB in the folder for temporary files.
"""

import argparse
import pickle
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import tilescope
import tilescope.distributed
from tilescope.distributed import _tile
from tilescope.distributed._grid import Grid

# The largest plane: 65,000 radii wide and high.
LARGEST = 1 / 65_000


def rate_of_a_core(folder: Path, rows: int) -> str:
    """Makes six tiles of the largest plane with one thread, after a first one that is not counted."""
    tilescope.set_threads(1)
    plane = tilescope.Plane(radius=LARGEST)
    grid = Grid.of(plane.domain, plane.radius, rows)
    job = _tile.Job(pickle.dumps(plane), {}, str(folder), grid)
    made, seconds, size = 0, 0.0, 0
    for part in range(7):
        index = round(part * 0.618 % 1 * (len(grid) - 1))
        began = time.process_time()
        _, tile = _tile.make(job, (index, None), None)
        if part > 0:
            seconds += time.process_time() - began
            made += tile.count
            size += (folder / tile.file).stat().st_size
    return f"{made // 6:,} samples a tile: {made / seconds:,.0f} samples/s and core, {size / made:.2f} bytes a sample"


def timed(name: str, count: int, work: Callable[[], object]) -> None:
    """Prints rates of some work on `count` samples."""
    began, processor = time.perf_counter(), time.process_time()
    work()
    elapsed, processor = time.perf_counter() - began, time.process_time() - processor
    print(f"{name}: {count / elapsed:,.0f} samples/s; {processor / count * 1e9:.0f} ns of this process a sample")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--radius", type=float, default=1.866e-4, help="of the set that engines write")
    radius = parser.parse_args().radius
    plane = tilescope.Plane(radius=radius, seed=11)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        stored = tilescope.distributed.write(plane, folder / "local")
        print(stored)
        timed("verify, files alone", len(stored), lambda: stored.verify(positions=False))
        timed("verify", len(stored), stored.verify)
        for engine in ("local", "dask", "ray"):
            write = tilescope.distributed.write
            timed(engine, len(stored), lambda engine=engine: write(plane, folder / f"new-{engine}", engine=engine))
        for rows in (500_000, 2_000_000, 8_000_000):
            (folder / str(rows)).mkdir()
            print(rate_of_a_core(folder / str(rows), rows))
