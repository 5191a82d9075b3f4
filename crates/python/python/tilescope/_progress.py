"""Progress of long calls: a bar of tqdm, or a function of the caller."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any, TypeAlias, Union

from tilescope._input import shown

ProgressFunction: TypeAlias = Callable[[str, int, int], object]
"""Called with the name of the work, what is done, and all there is to do."""

Progress: TypeAlias = Union[bool, ProgressFunction]
"""``True`` shows a bar, ``False`` shows nothing, a function is called."""


@contextmanager
def following(progress: Progress) -> Iterator[ProgressFunction | None]:
    """Returns the function that progress is passed to, and closes its bar."""
    if callable(progress):
        yield progress
    elif not isinstance(progress, bool):
        raise TypeError(f"progress is {shown(progress)}; it must be True, False or a function")
    elif progress:
        bar = _Bar()
        try:
            yield bar
        finally:
            bar.close()
    else:
        yield None


class _Bar:
    def __init__(self) -> None:
        try:
            tqdm: Any = import_module("tqdm.auto")
        except ImportError as error:
            raise ImportError("progress=True needs tqdm: pip install tqdm") from error
        self._bar = tqdm.tqdm(total=0, leave=False)

    def __call__(self, name: str, done: int, total: int) -> None:
        self._bar.set_description(name, refresh=False)
        self._bar.total = total
        self._bar.n = done
        self._bar.refresh()

    def close(self) -> None:
        self._bar.close()
