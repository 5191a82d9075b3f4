"""Images that callers give: pixels as the native module takes them, or the path of a file."""

from __future__ import annotations

import os
from typing import Any, TypeAlias, Union

import numpy as np
import numpy.typing as npt

from tilescope._input import Path, local_path, shown

Image: TypeAlias = Union[npt.NDArray[Any], Path, Any]
"""An array of rows from the top, what numpy makes one of, such as an image of Pillow, or the path of a PNG or JPEG file."""

_WHITE = 0xFFFF

# Numpy's types whose largest value is white, and what makes 16 bits of them.
_WHOLE = {"bool": _WHITE, "uint8": 257, "uint16": 1}

# Pillow's modes whose arrays hold grey or colours, with or without opacity. Arrays of other modes hold places in a palette,
# inks, or light and colour apart, and would be taken for something else.
_MODES = ("1", "L", "LA", "RGB", "RGBA", "I;16", "I;16B", "I;16L", "F")


def image_of(image: Image) -> npt.NDArray[np.uint16] | str:
    """Returns the pixels of an image, of shape (rows, columns, channels) and 16 bits, or the path of a file."""
    if isinstance(image, (str, os.PathLike)):
        return local_path(image)
    mode = getattr(image, "mode", None)
    if isinstance(mode, str) and hasattr(image, "convert"):
        if mode in ("P", "PA"):
            image = image.convert("RGBA")
        elif mode not in _MODES:
            raise ValueError(
                f"image has the mode {shown(mode)} of Pillow; it must be one of {', '.join(_MODES)} or P: image.convert('RGB')"
            )
    # Numpy leaves masks out without a word.
    if isinstance(image, np.ma.MaskedArray) and np.ma.is_masked(image):
        raise ValueError("image has masked pixels; give their opacity, as a fourth channel of 0, or fill them: image.filled(255)")

    array = np.asarray(image)
    if array.ndim not in (2, 3) or (array.ndim == 3 and not 1 <= array.shape[2] <= 4):
        raise ValueError(
            f"image has the shape {array.shape}; it must be (rows, columns), or (rows, columns, channels) with one channel of "
            "grey, two with opacity, three of red, green and blue, or four with opacity"
        )
    if array.size == 0:
        raise ValueError(f"image has the shape {array.shape}; it must have at least one row and one column")
    pixels = _words(array)
    return np.ascontiguousarray(pixels if pixels.ndim == 3 else pixels[:, :, None])


def _words(array: npt.NDArray[Any]) -> npt.NDArray[np.uint16]:
    """Returns values of 16 bits."""
    name = array.dtype.name
    if name in _WHOLE:
        return array.astype(np.uint16) * np.uint16(_WHOLE[name])
    if array.dtype.kind != "f":
        raise TypeError(
            f"image has values of the type {array.dtype}; they must be uint8, uint16 or bool, whose largest value is white, or "
            "floating-point numbers from 0, black, to 1, white"
        )
    # Written so that a value that is no number is found, too, which no comparison holds for.
    wrong = np.argwhere(~((array >= 0) & (array <= 1)))
    if len(wrong):
        at = tuple(wrong[0].tolist())
        raise ValueError(
            f"image is {array[at]!s} in column {at[1]} of row {at[0]}; floating-point numbers must be from 0, black, to 1, white"
        )
    return np.rint(array.astype(np.float64) * _WHITE).astype(np.uint16)
