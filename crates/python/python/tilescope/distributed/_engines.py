"""What carries out one task a tile: threads of this process, Dask or Ray."""

from __future__ import annotations

import math
import os
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from importlib import import_module
from itertools import islice
from typing import Any, Literal, TypeAlias, TypeVar

from tilescope import set_threads
from tilescope._input import shown
from tilescope._optional import module
from tilescope._progress import ProgressFunction

# Seconds after which the threads of a cluster are counted again.
_PERIOD = 1.0

Engine: TypeAlias = Literal["local", "dask", "ray"]
Item = TypeVar("Item")
Outcome = TypeVar("Outcome")
Shared = TypeVar("Shared")
# A task gets what all tasks share, its item, and a function that it calls now and then, which may raise.
Task: TypeAlias = Callable[[Shared, Item, "ProgressFunction | None"], Outcome]


def check(engine: str) -> None:
    """Raises ``ValueError`` if there is no such engine, and ``ImportError`` if it is not installed."""
    if engine not in ("local", "dask", "ray"):
        raise ValueError(f"engine is {shown(engine)}; it must be 'local', 'dask' or 'ray'")
    if engine != "local":
        module("distributed" if engine == "dask" else engine, engine)


def outcomes(
    engine: Engine, task: Task[Shared, Item, Outcome], shared: Shared, items: Iterable[Item], retries: int
) -> Generator[Outcome, None, None]:
    """Carries out a task on each item, and returns what they return, in the order in which they end.

    A task that raises ``OSError`` is tried `retries` times more, by Dask one that raises anything.
    Items are taken as tasks end, so that their number does not matter.
    """
    carry_out = {"local": _local, "dask": _dask, "ray": _ray}[engine]
    return carry_out(task, shared, iter(items), retries)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _Stopped(Exception):
    """A task was stopped because its result is not wanted any more."""


def _local(
    task: Task[Shared, Item, Outcome], shared: Shared, items: Iterator[Item], retries: int
) -> Generator[Outcome, None, None]:
    stopped = threading.Event()

    def look(name: str, done: int, total: int) -> None:
        # Called now and then by the native module, which ends with what this raises.
        if stopped.is_set():
            raise _Stopped

    def tried(item: Item) -> Outcome:
        for _ in range(retries):
            try:
                return task(shared, item, look)
            except OSError:
                look("", 0, 0)
        return task(shared, item, look)

    with ThreadPoolExecutor(_cores()) as pool:
        waiting: set[Future[Outcome]] = set()
        try:
            while True:
                # One task more than there are cores, so that none waits while the caller takes a result.
                waiting |= {pool.submit(tried, item) for item in islice(items, _cores() + 1 - len(waiting))}
                if not waiting:
                    return
                ended, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                for future in ended:
                    yield future.result()
        finally:
            stopped.set()
            for future in waiting:
                future.cancel()


def _use_threads(threads: int, caller: int) -> None:
    """Has a worker's process compute with as many threads as it has tasks at a time. The caller's stays as it is."""
    global _threads
    if threads != _threads and os.getpid() != caller:
        set_threads(threads)
        _threads = threads


_threads: int | None = None


def _on_dask(task: Task[Shared, Item, Outcome], shared: Shared, item: Item, caller: int) -> Outcome:
    worker = import_module("distributed").get_worker()
    _use_threads(worker.state.nthreads, caller)
    return task(shared, item, None)


def _itself(shared: Shared) -> Shared:
    return shared


def _dask(
    task: Task[Shared, Item, Outcome], shared: Shared, items: Iterator[Item], retries: int
) -> Generator[Outcome, None, None]:
    distributed = module("distributed", "dask")

    cluster = None
    try:
        client = distributed.get_client()
    except ValueError:
        cluster = distributed.LocalCluster(n_workers=_cores(), threads_per_worker=1, dashboard_address=None)
        client = distributed.Client(cluster, set_as_default=False)

    waiting: set[Any] = set()
    try:
        # What a lost worker held of it is made again, unlike data that is scattered.
        common = client.submit(_itself, shared, pure=False)
        threads, counted = 0, -math.inf

        def submitted() -> list[Any]:
            nonlocal threads, counted
            if time.monotonic() - counted > _PERIOD:
                threads, counted = sum(client.nthreads().values()), time.monotonic()
            # Two tasks for each thread and two more keep all threads at work between two looks.
            new = [
                client.submit(_on_dask, task, common, item, os.getpid(), pure=False, retries=retries)
                for item in islice(items, max(2 * threads + 2 - len(waiting), 0))
            ]
            waiting.update(new)
            return new

        ended = distributed.as_completed(submitted(), loop=client.loop, with_results=True)
        for future, outcome in ended:
            waiting.discard(future)
            ended.update(submitted())
            yield outcome
    finally:
        client.cancel(list(waiting))
        # A cluster of the caller stays.
        if cluster is not None:
            client.close()
            cluster.close()


def _on_ray(task: Task[Shared, Item, Outcome], shared: Shared, item: Item, caller: int) -> Outcome:
    _use_threads(1, caller)
    return task(shared, item, None)


def _ray(
    task: Task[Shared, Item, Outcome], shared: Shared, items: Iterator[Item], retries: int
) -> Generator[Outcome, None, None]:
    ray = module("ray", "ray")
    started = not ray.is_initialized()
    if started:
        ray.init(include_dashboard=False, log_to_driver=False, configure_logging=False)

    waiting: list[Any] = []
    try:
        common = ray.put(shared)
        remote = ray.remote(num_cpus=1, max_retries=retries, retry_exceptions=[OSError])(_on_ray)
        while True:
            most = 2 * int(ray.cluster_resources().get("CPU", 1)) + 2
            waiting += [
                remote.remote(task, common, item, os.getpid()) for item in islice(items, max(most - len(waiting), 0))
            ]
            if not waiting:
                return

            (ended, *_), waiting = ray.wait(waiting)
            try:
                outcome = ray.get(ended)
            except ray.exceptions.RayTaskError as error:
                # Ray raises what the task raised within an exception of its own, with a long text.
                raise (error.cause if isinstance(error.cause, Exception) else error) from None
            yield outcome
    finally:
        for reference in waiting:
            ray.cancel(reference)
        if started:
            ray.shutdown()
