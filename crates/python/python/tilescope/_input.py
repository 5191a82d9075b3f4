"""Checks of what callers give: values as errors show them, paths of files, arrays of numbers."""

from __future__ import annotations

import os
import re
from typing import Any, TypeAlias, Union

import numpy as np
import numpy.typing as npt

Path: TypeAlias = Union[str, "os.PathLike[str]"]

_LONGEST = 80

# `pathlib` makes one slash of two. A drive of Windows has one letter.
_URL = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:/")

# What a terminal obeys rather than shows, as the command line has it: control characters except line feeds and tabs,
# marks of direction. Python has a surrogate for each byte of a file's name that is not UTF-8, which cannot be written.
_OBEYED = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")

# Numpy's kinds of numbers: boolean, signed, unsigned, floating; objects are converted one by one.
_NUMBERS = "biufO"


def shown(value: object) -> str:
    """Returns a value as an error shows it: 80 characters at most."""
    try:
        text = repr(value)
    except Exception:
        # Python does not write a whole number of more than 4300 digits.
        text = f"<{type(value).__name__}>"
    if len(text) <= _LONGEST:
        return text
    return f"{text[:40]}...{text[-20:]} ({len(text)} characters)"


def shown_text(text: object) -> str:
    """Returns a text as an error shows it within its own: 400 characters at most, none that a terminal would obey."""
    whole = _OBEYED.sub(lambda found: f"\\u{ord(found[0]):04x}", str(text))
    return whole if len(whole) <= 400 else f"{whole[:300]}...{whole[-80:]}"


def local_path(path: Path) -> str:
    """Returns the path of a file or folder of this machine, or raises ``ValueError`` if it is a URL or holds a NUL."""
    text = os.fspath(path)
    if not isinstance(text, str):
        raise TypeError(f"the path is {shown(text)}; it must be text, or an object with a path of text")
    if "\0" in text:
        raise ValueError(f"the path {shown(text)} holds a NUL character, which no file's name can have")
    if _URL.match(text):
        raise ValueError(f"{shown(text)} is a URL; tilescope reads and writes files that have a path on this machine")
    return text


def place(name: str, value: Any) -> tuple[float, float]:
    """Returns a place: two finite numbers, x and y.

    Raises
    ------
    TypeError, ValueError
        If it is anything else.
    """
    array = numbers(name, value)
    if array.shape != (2,) or not np.isfinite(array).all():
        raise ValueError(f"{name} is {shown(value)}; it must be two finite numbers: (x, y)")
    return float(array[0]), float(array[1])


def numbers(name: str, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Returns a copy of an array as numbers.

    Raises
    ------
    TypeError
        If they are complex numbers, texts or dates.
    ValueError
        If some are masked, or rows have different lengths.
    """
    masked = _masked(values)
    if masked:
        raise ValueError(
            f"{name} has {masked} masked values, which are no positions; leave out their rows: "
            "positions[~numpy.ma.getmaskarray(positions).any(axis=1)]"
        )
    array = np.asarray(values)
    if array.dtype.kind == "c":
        raise TypeError(f"{name} has complex numbers; give x and y: numpy.stack([z.real, z.imag], axis=-1)")
    if array.dtype.kind not in _NUMBERS:
        raise TypeError(f"{name} has values of the type {array.dtype}; they must be numbers")
    return np.array(array, dtype=np.float64, order="C")


def _masked(values: Any) -> int:
    """Returns how many values are masked. Numpy leaves masks out without a word, those of rows in a list too."""
    if isinstance(values, (list, tuple)):
        return sum(_masked(row) for row in values if isinstance(row, (list, tuple, np.ma.MaskedArray)))
    return int(np.sum(values.mask)) if isinstance(values, np.ma.MaskedArray) else 0
