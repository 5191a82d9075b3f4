"""A set in a cell of a notebook: its run in the page's player, or its points alone."""

from __future__ import annotations

import gzip
import hashlib
import operator
import os
import re
from pathlib import Path
from typing import Any, Final, SupportsIndex
from urllib.parse import urlencode, urlsplit

import anywidget
import numpy as np
import traitlets

from tilescope import _tilescope
from tilescope._input import shown
from tilescope._point_set import PointSet

# A page keeps the events of runs up to so many samples, and makes patterns up to such a side in radii (web/README.md).
_MAX_PLAYED: Final = 200_000
_MAX_PATTERN_SIDE: Final = 500
# Of larger sets a corner is sent: the points of a cell come through the notebook's connection, eight bytes each.
_MAX_POINTS: Final = 200_000
_MIN_HEIGHT: Final = 120
_MAX_HEIGHT: Final = 4_000

# The page in a release wheel; `crates/python/page` puts it there.
_PAGE: Final = Path(__file__).parent / "page"
# What the player loads. Pictures belong to the first page and to the pages of lessons.
_LOADED: Final = (".js", ".css", ".wasm", ".txt", ".json")
# The player has the list of a run's stages, and refuses others with a note.
_STAGE: Final = re.compile(r"[a-z]+(-[a-z0-9]+)*")

# Parameters by the keys of a link; those of the pattern have keys of their own.
_KEYS: Final = (
    "seed", "width", "height", "radius", "boundary", "leaf", "order", "insertion", "search", "variant", "dihedral",
)  # fmt: skip
_PATTERN_KEYS: Final = {"side": "pattern", "boundary": "pattern-boundary", "seed": "pattern-seed"}


def link_of(made: PointSet) -> str:
    """Returns the link to the run that made a set.

    Raises
    ------
    ValueError
        If no run that the player shows has made the set; the text says why.
    """
    parameters = made.parameters
    if made.method == "unknown":
        raise ValueError("a set of unknown origin has no run to play")
    if made.method not in ("kdrt", "exact"):
        raise ValueError(f"the method '{made.method}' has no run to play")
    if made.levels or "levels" in parameters:
        raise ValueError("of nested levels the player and the set number the samples differently")
    pattern = parameters.get("pattern")
    if not isinstance(pattern, dict) or set(pattern) != set(_PATTERN_KEYS):
        raise ValueError("a link cannot hold a pattern of its own")
    if pattern["side"] > _MAX_PATTERN_SIDE:
        side = pattern["side"]
        raise ValueError(f"the pattern has a side of {side:g} r; a browser makes patterns of at most {_MAX_PATTERN_SIDE} r")
    if len(made) > _MAX_PLAYED:
        raise ValueError(f"the set has {len(made)} samples; the events of at most {_MAX_PLAYED} are kept in a browser")

    stated: dict[str, Any] = {key: parameters[key] for key in _KEYS if key in parameters}
    stated |= {_PATTERN_KEYS[name]: value for name, value in pattern.items()}
    if made.method == "exact":
        stated["method"] = "exact"
    # Python's shortest text of a float reads back as the same float, and links have "yes" and "no".
    texts = {key: ("no", "yes")[value] if isinstance(value, bool) else str(value) for key, value in stated.items()}
    return "v=1&" + urlencode(texts)


def page_files(folder: Path) -> dict[str, bytes]:
    """Returns the files that the player loads, by name, compressed by gzip, with ``index.html`` among them.

    Raises
    ------
    FileNotFoundError
        If the folder holds no built page.
    """
    index = folder / "index.html"
    if not index.is_file():
        raise FileNotFoundError(f"{folder} holds no page: web/build makes one in web/dist")
    files = {"index.html": gzip.compress(index.read_bytes(), mtime=0)}
    for packed in sorted(folder.glob("*.gz")):
        if Path(packed.stem).suffix in _LOADED:
            files[packed.stem] = packed.read_bytes()
    return files


def _is_address(text: str) -> bool:
    return urlsplit(text).scheme in ("http", "https")


class Widget(anywidget.AnyWidget):
    """What :func:`tilescope.widget` returns: a set in a cell, with its moment and its selection.

    Attributes
    ----------
    cursor : int or None
        The number of events that have happened at the moment shown. Set it to go there. ``None``
        before the player has reported it, and without a player.
    moment : str
        The stage of that moment: ``'tile'``, ``'eliminate'``, ``'iterate-1'``, ``'finish'`` and so
        on. Set it to go to the end of a stage.
    selected : int or None
        The row of :attr:`PointSet.points` whose sample is selected. ``None`` if none is, or one that
        is not in the result. Set it to select.
    events : int
        The number of events of the run; 0 until the player has reported it.
    sentence : str
        What happened last, in words.
    note : str
        Why the points are shown alone, or what the player refused; else empty.
    height : int
        The height of the cell's content in pixels, from 120 to 4000.
    """

    _esm = Path(__file__).parent / "_widget.js"

    cursor: Any = traitlets.Int(None, allow_none=True, min=0).tag(sync=True)
    moment: Any = traitlets.Unicode("finish").tag(sync=True)
    selected: Any = traitlets.Int(None, allow_none=True).tag(sync=True)
    events: Any = traitlets.Int(0).tag(sync=True)
    sentence: Any = traitlets.Unicode("").tag(sync=True)
    note: Any = traitlets.Unicode("").tag(sync=True)
    height: Any = traitlets.Int(480, min=_MIN_HEIGHT, max=_MAX_HEIGHT).tag(sync=True)

    # The link to the run; empty if the points are shown alone.
    _link: Any = traitlets.Unicode("").tag(sync=True)
    # Where the page is served; empty if its files come by messages. They are known by the name of their version.
    _address: Any = traitlets.Unicode("").tag(sync=True)
    _page: Any = traitlets.Unicode("").tag(sync=True)
    # The digest that the player's run must have, so that its samples are those of the set.
    _digest: Any = traitlets.Unicode("").tag(sync=True)
    # The selected sample by the player's number.
    _picked: Any = traitlets.Int(None, allow_none=True).tag(sync=True)
    # Positions as pairs of 32-bit floats, relative to the window, with their rows and the window's size.
    _points: Any = traitlets.Bytes(b"").tag(sync=True)
    _rows: Any = traitlets.Bytes(b"").tag(sync=True)
    _window: Any = traitlets.List([1.0, 1.0]).tag(sync=True)

    def __init__(self, made: PointSet, *, address: str | os.PathLike[str] | None, height: SupportsIndex) -> None:
        count = len(made)
        # The player's number of each row's sample, and back; without a player neither is asked.
        self._numbers: list[int] = []
        self._row_of: dict[int, int] = {}
        self._files: dict[str, bytes] = {}
        self._count = count

        state: dict[str, Any] = {"height": operator.index(height), **_canvas(made)}
        try:
            state |= self._player(made, address)
        except (ValueError, FileNotFoundError) as error:
            # Points can be shown of any set. Only an address that its caller gave must not be left out in silence.
            if address is not None and isinstance(error, FileNotFoundError):
                raise
            corner = len(state["_rows"]) // 4
            part = "" if corner == count else f" This is a corner with {corner} of them."
            state["note"] = f"The points alone: {error}.{part}"
        super().__init__(**state)
        self.on_msg(self._answer)

    def _player(self, made: PointSet, address: str | os.PathLike[str] | None) -> dict[str, str]:
        """Returns the state with which the player shows the run of a set."""
        link = link_of(made)
        numbers = _tilescope.recorded_numbers(made, None)
        where: dict[str, str] = {}
        if address is not None and _is_address(os.fspath(address)):
            where["_address"] = os.fspath(address)
        else:
            if address is None and not _PAGE.is_dir():
                raise FileNotFoundError(
                    "this installation holds no player; web/build makes one: give its folder, or where it is served, as address"
                )
            self._files = page_files(_PAGE if address is None else Path(address))
            # The page names its files after their content, so that its first file tells versions apart.
            where["_page"] = hashlib.sha256(self._files["index.html"]).hexdigest()[:16]

        self._numbers = numbers.tolist()
        self._row_of = {number: row for row, number in enumerate(self._numbers)}
        return {"_link": link, "_digest": made.digest, **where}

    def play(self, speed: float | None = None) -> None:
        """Plays the run from its moment on, at a speed relative to the usual one, or at that of before."""
        self._ask({"do": "play"} | ({} if speed is None else {"speed": float(speed)}))

    def pause(self) -> None:
        """Stops playing at the moment that is shown."""
        self._ask({"do": "pause"})

    def _ask(self, request: dict[str, Any]) -> None:
        if not self._link:
            raise ValueError(f"there is no player. {self.note}")
        self.send({"kind": "ask", "request": request})

    def _answer(self, _: Any, content: Any, __: Any) -> None:
        """Sends the page's files to a view that asks for them. Views of one page of the notebook share them."""
        if content.get("kind") == "page":
            self.send({"kind": "page", "version": self._page, "names": list(self._files)}, list(self._files.values()))

    @traitlets.validate("selected")
    def _check_selected(self, proposal: Any) -> int | None:
        row: int | None = proposal["value"]
        if row is not None and not 0 <= row < self._count:
            raise traitlets.TraitError(f"selected is {shown(row)}; it must be None or a row from 0 to {self._count - 1}")
        return row

    @traitlets.validate("moment")
    def _check_moment(self, proposal: Any) -> str:
        name: str = proposal["value"]
        if not _STAGE.fullmatch(name):
            raise traitlets.TraitError(
                f"moment is {shown(name)}; it must be the name of a stage, such as tile, eliminate, iterate-1 or finish"
            )
        return name

    @traitlets.validate("cursor")
    def _check_cursor(self, proposal: Any) -> int | None:
        event: int | None = proposal["value"]
        # The number of events is known once the player has made the run.
        if event is not None and self.events and event > self.events:
            raise traitlets.TraitError(f"cursor is {event}; the run has {self.events} events")
        return event

    @traitlets.observe("_picked")
    def _take_picked(self, _: Any) -> None:
        # An eliminated sample has a number and no row.
        self.selected = self._row_of.get(self._picked)

    @traitlets.observe("selected")
    def _show_selected(self, _: Any) -> None:
        # With no row selected an eliminated sample may be: the player keeps it.
        if self._numbers and self.selected != self._row_of.get(self._picked):
            self._picked = None if self.selected is None else self._numbers[self.selected]


def _canvas(made: PointSet) -> dict[str, Any]:
    """Returns the state with which a canvas shows the points of a set, or of its lower corner if there are many."""
    points = made.points
    width, height, _ = made.domain
    rows = np.arange(len(points), dtype="<u4")
    if len(points) > _MAX_POINTS:
        part = (_MAX_POINTS / len(points)) ** 0.5
        width, height = width * part, height * part
        rows = np.flatnonzero((points[:, 0] < width) & (points[:, 1] < height)).astype("<u4")
    return {
        # Rounded: on a canvas no pixel is so small.
        "_points": points[rows].astype("<f4").tobytes(),
        "_rows": rows.tobytes(),
        "_window": [width, height],
    }
