"""A radius that varies and shapes: what callers give, checked, as the native module takes it."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from typing import Any, TypeAlias, Union

import numpy as np
import numpy.typing as npt

from tilescope._image import image_of
from tilescope._input import Path, local_path, numbers, shown

RadiusFunction: TypeAlias = Callable[[npt.NDArray[np.float64], npt.NDArray[np.float64]], npt.ArrayLike]
"""Called with arrays of x and y, it returns the radii there."""

Radius: TypeAlias = Union[float, npt.NDArray[Any], RadiusFunction, "os.PathLike[str]"]
"""A number; an array of rows, the lowest y first; a function; to judge a set, also the path of the image it was made from."""

Pixels: TypeAlias = Union[npt.NDArray[Any], Path]
"""An array of rows, the lowest y first, or the path of a PNG image, whose rows begin at the top."""

# Numpy's whole numbers whose largest value stands for 1, as in images, and what makes 16 bits of them.
_GREY = {"uint8": 257, "uint16": 1}
_WHITE = 0xFFFF


class Field:
    """What is said of a radius that varies and of a shape. The native module reads its attributes."""

    __slots__ = ("density", "expression", "function", "image", "mask", "picture", "planar", "radii", "radius", "shape")

    def __init__(
        self, radius: Any, expression: str | None, density: Any, mask: Any, shape: Any, planar: bool, image: Any
    ) -> None:
        self.radius: object = None
        self.function: Callable[..., npt.NDArray[np.float64]] | None = None
        self.radii: npt.NDArray[np.float64] | None = None
        self.image: str | None = None
        if callable(radius):
            self.function = _at_nodes(radius)
        elif isinstance(radius, os.PathLike):
            self.image = local_path(radius)
        elif is_array(radius):
            self.radii = _table("radius", radius)
        else:
            self.radius = radius
        self.expression = expression
        self.picture = None if image is None else image_of(image)
        self.density = None if density is None else _density(density)
        self.mask = None if mask is None else _mask(mask)
        self.shape = None if shape is None else _geojson(shape)
        self.planar = planar or _is_projected(shape)
        self._check()

    def _check(self) -> None:
        """Refuses two fields, two shapes, and what is about none."""
        names = self._names()
        fields = [name for name in names if name not in ("mask", "shape")]
        for kind, given in (("the radius at each place", fields), ("what to cover", [*names][len(fields) :])):
            if len(given) > 1:
                raise ValueError(f"both {given[0]} and {given[1]} are given, and each says {kind}; give one")
        if self.expression is not None and not isinstance(self.expression, str):
            raise TypeError(f"radius_expression is {shown(self.expression)}; it must be text, such as '0.01 + 0.02*x'")
        if self.expression is not None and self.radius is not None:
            raise ValueError("both radius and radius_expression are given; give one")
        if self.planar and self.shape is None:
            raise ValueError("planar is given without shape, whose coordinates it is about")

    def _names(self) -> list[str]:
        is_field = self.function is not None or self.radii is not None or self.image is not None
        given = {
            "radius": is_field, "radius_expression": self.expression is not None, "density": self.density is not None,
            "image": self.picture is not None,
            "mask": self.mask is not None, "shape": self.shape is not None,
        }  # fmt: skip
        return [name for name, is_given in given.items() if is_given]

    @property
    def name(self) -> str:
        """The first argument of a field or a shape that is given."""
        return self._names()[0]

    @property
    def has_one_radius(self) -> bool:
        """Whether nothing makes the radius vary, so that there is a shape or a mask alone."""
        return self.name in ("mask", "shape")


def is_array(value: object) -> bool:
    """Returns whether a value is an array or a list, rather than one number."""
    return isinstance(value, (list, tuple)) or getattr(value, "ndim", 0) > 0


def field_of(
    radius: Any, expression: str | None = None, density: Any = None, mask: Any = None, shape: Any = None,
    planar: bool = False, image: Any = None,
) -> Field | None:
    """Returns what is said of a field and a shape; ``None`` if nothing is, so that the set has one radius in a rectangle."""
    is_plain = not (callable(radius) or isinstance(radius, os.PathLike) or is_array(radius))
    if is_plain and all(one is None for one in (expression, density, mask, shape, image)) and not planar:
        return None
    return Field(radius, expression, density, mask, shape, planar, image)


def _table(name: str, values: Any) -> npt.NDArray[np.float64]:
    table = numbers(name, values)
    if table.ndim != 2 or table.size == 0:
        raise ValueError(f"{name} has the shape {table.shape}; it must be (rows, columns), the row of the lowest y first")
    return table


def _at_nodes(function: RadiusFunction) -> Callable[..., npt.NDArray[np.float64]]:
    """Returns a function from the x of columns and the y of rows to an array of radii."""

    def radii(xs: npt.NDArray[np.float64], ys: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        x, y = np.meshgrid(xs, ys)
        found = numbers("the result of radius", function(x, y))
        if found.shape not in ((), x.shape):
            raise ValueError(
                f"radius returned the shape {found.shape} for {x.shape}, the places of all nodes; it must return a radius "
                "for each: numpy.vectorize makes such a function of one for single numbers"
            )
        return np.ascontiguousarray(np.broadcast_to(found, x.shape))

    return radii


def _density(density: Any) -> npt.NDArray[Any] | str:
    """Returns the grey values of a density in whole numbers, where white is none; other numbers as they are."""
    if isinstance(density, (str, os.PathLike)):
        return local_path(density)
    array = np.asarray(density)
    if array.dtype.name in _GREY:
        table = array.astype(np.uint16) * np.uint16(_GREY[array.dtype.name])
        _table("density", table)
        return np.ascontiguousarray(_WHITE - table)
    return _table("density", density)


def _mask(mask: Any) -> npt.NDArray[np.uint16] | str:
    if isinstance(mask, (str, os.PathLike)):
        return local_path(mask)
    array = np.asarray(mask)
    if array.dtype != np.bool_:
        raise TypeError(f"mask has values of the type {array.dtype}; they must be True or False: mask > 0, say")
    if array.ndim != 2 or array.size == 0:
        raise ValueError(f"mask has the shape {array.shape}; it must be (rows, columns), the row of the lowest y first")
    return np.ascontiguousarray(array.astype(np.uint16) * np.uint16(_WHITE))


def _geojson(shape: Any) -> tuple[str, bytes]:
    """Returns the name of a file, or nothing, and GeoJSON."""
    # Geometries of shapely, series and frames of GeoPandas.
    described = getattr(shape, "__geo_interface__", shape)
    if isinstance(described, dict):
        # The box around no shapes has corners that are no numbers, and no box is needed.
        shapes = {key: value for key, value in described.items() if key != "bbox"}
        try:
            return "", json.dumps(shapes, allow_nan=False).encode()
        except TypeError as error:
            raise TypeError(f"shape is no GeoJSON: {error}") from error
        except ValueError as error:
            raise ValueError("shape has a coordinate that is not finite") from error
    if isinstance(described, str) and described.lstrip().startswith("{"):
        return "", described.encode()
    if isinstance(described, (str, os.PathLike)):
        name = local_path(described)
        with open(name, "rb") as file:
            return os.path.basename(name), file.read()
    raise TypeError(
        f"shape is {shown(shape)}; it must be a geometry of shapely, a frame of GeoPandas, GeoJSON as a dict or text, or the "
        "path of a file of it"
    )


def _is_projected(shape: Any) -> bool:
    """Returns whether a shape states a projected coordinate system, and refuses longitudes and latitudes."""
    system = getattr(shape, "crs", None)
    if getattr(system, "is_geographic", False):
        raise ValueError(
            "shape has longitudes and latitudes, in which distances are no distances; project it first: "
            "shape.to_crs(shape.estimate_utm_crs())"
        )
    return bool(getattr(system, "is_projected", False))


def place_of(extent: Any) -> tuple[float, float, float, float]:
    """Returns width, height and lower corner of an extent: ``(x0, y0, x1, y1)``."""
    corners = numbers("extent", extent)
    if corners.shape != (4,) or not np.isfinite(corners).all():
        raise ValueError(f"extent is {shown(extent)}; it must be four finite numbers: (x0, y0, x1, y1)")
    x0, y0, x1, y1 = corners.tolist()
    if not (x0 < x1 and y0 < y1):
        raise ValueError(f"extent is {shown(extent)}; it must be (x0, y0, x1, y1) with x0 < x1 and y0 < y1")
    return x1 - x0, y1 - y0, x0, y0
