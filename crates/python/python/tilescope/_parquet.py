"""Sets in GeoParquet: points in WKB or in a native encoding, or two columns of numbers."""

from __future__ import annotations

import json
import os
import struct
from typing import Any

import numpy as np
import numpy.typing as npt

from tilescope._input import shown, shown_text
from tilescope._optional import module

FORMAT = "geoparquet"

_EXTENSIONS = (".parquet", ".geoparquet")
_MAGIC = b"PAR1"

# A point of two dimensions in WKB, least significant byte first: 21 bytes.
_POINT = np.dtype([("order", "u1"), ("kind", "<u4"), ("x", "<f8"), ("y", "<f8")])
_SHAPES = {
    2: "LineString", 3: "Polygon", 4: "MultiPoint", 5: "MultiLineString", 6: "MultiPolygon", 7: "GeometryCollection",
}  # fmt: skip


def is_to_write(path: str, format: str | None) -> bool:
    """Returns whether a set is to be written as GeoParquet: by the format given, or else by the file's extension."""
    if format is not None:
        return format == FORMAT
    return os.path.splitext(path)[1].lower() in _EXTENSIONS


def is_to_read(path: str, format: str | None) -> bool:
    """Returns whether a file is to be read as GeoParquet: by the format given, or else by the file's first bytes."""
    if format is not None:
        return format == FORMAT
    try:
        with open(path, "rb") as file:
            return file.read(len(_MAGIC)) == _MAGIC
    except OSError:
        # What reads other formats says what is wrong.
        return False


def encoded(positions: npt.NDArray[np.float64], further: dict[str, npt.NDArray[Any]] | None = None) -> bytes:
    """Returns the bytes of a file with the column ``geometry`` of points in WKB, without a coordinate system, and with
    further columns by their names."""
    arrow, parquet = module("pyarrow", "parquet"), module("pyarrow.parquet", "parquet")

    points = np.empty(len(positions), dtype=_POINT)
    points["order"], points["kind"] = 1, 1
    points["x"], points["y"] = positions.T

    # Offsets of 64 bits, for sets of more than a hundred million points.
    offsets = np.arange(len(positions) + 1, dtype=np.int64) * _POINT.itemsize
    buffers = [None, arrow.py_buffer(offsets), arrow.py_buffer(points.tobytes())]
    column = arrow.Array.from_buffers(arrow.large_binary(), len(positions), buffers)

    described: dict[str, Any] = {"encoding": "WKB", "geometry_types": ["Point"], "crs": None, "edges": "planar"}
    if len(positions):
        described["bbox"] = [*positions.min(axis=0).tolist(), *positions.max(axis=0).tolist()]
    geo = {"version": "1.1.0", "primary_column": "geometry", "columns": {"geometry": described}}
    columns = {"geometry": column} | {name: arrow.array(values) for name, values in (further or {}).items()}
    fields = [arrow.field(name, one.type, nullable=False) for name, one in columns.items()]
    schema = arrow.schema(fields, metadata={b"geo": json.dumps(geo).encode()})

    sink = arrow.BufferOutputStream()
    table = arrow.Table.from_arrays([*columns.values()], schema=schema)
    parquet.write_table(table, sink, compression="zstd", write_page_checksum=True)
    data: bytes = sink.getvalue().to_pybytes()

    if not np.array_equal(_decoded("the file", arrow.BufferReader(data))[0], positions):
        raise OSError("GeoParquet that was read back does not hold what was written")
    return data


def read(path: str, sides: tuple[float, float]) -> npt.NDArray[np.float64]:
    """Returns the positions of a file, which are to lie in a domain with these sides.

    Raises
    ------
    ValueError
        If it is damaged, has no points, points in space, or longitudes and latitudes.
    """
    name = shown_text(path)
    positions, system = _decoded(name, path)

    is_geographic = isinstance(system, dict) and "Geographic" in str(system.get("type"))
    if system == "absent" and len(positions):
        # Those are longitudes and latitudes by the standard; many files of plane positions do not say so.
        low, high = positions.min(axis=0), positions.max(axis=0)
        in_degrees = bool((np.maximum(-low, high) <= [180, 90]).all())
        is_geographic = in_degrees and bool((low < 0).any() or (high > sides).any())

    if is_geographic:
        raise ValueError(
            f"{name} has longitudes and latitudes, in which distances are no distances; project them first, with "
            "GeoPandas: frame.to_crs(frame.estimate_utm_crs())"
        )
    return positions


def _decoded(path: str, source: Any) -> tuple[npt.NDArray[np.float64], Any]:
    """Returns positions and their coordinate system: ``'absent'`` if nothing is said of it, ``None`` if there is none."""
    parquet = module("pyarrow.parquet", "parquet")
    try:
        file = parquet.ParquetFile(source, page_checksum_verification=True)
        geo = json.loads((file.schema_arrow.metadata or {}).get(b"geo", b"null"))
    except Exception as error:
        # A damaged file raises what it happens to lead to.
        raise ValueError(f"{path} is not a Parquet file, or it is damaged: {shown_text(error)}") from error

    names = file.schema_arrow.names
    if isinstance(geo, dict) and geo.get("primary_column") in names:
        name = geo["primary_column"]
        described = geo.get("columns", {}).get(name, {})
        return _points(path, name, _column(path, file, name)), described.get("crs", "absent")

    if {"x", "y"} <= set(names):
        both = [_numbers(path, name, _column(path, file, name)) for name in ("x", "y")]
        return np.stack(both, axis=1), None

    if "geometry" in names:
        return _points(path, "geometry", _column(path, file, "geometry")), None

    raise ValueError(f"{path} has the columns {shown(names)}; it must have 'x' and 'y', or 'geometry' with points")


def _column(path: str, file: Any, name: str) -> Any:
    try:
        column = file.read(columns=[name]).column(name).combine_chunks()
    except Exception as error:
        raise ValueError(f"{path} is damaged: {shown_text(error)}") from error
    if column.null_count:
        raise ValueError(f"{path} has {column.null_count} rows without a value in the column {shown(name)}")
    return column


def _numbers(path: str, name: str, column: Any) -> npt.NDArray[np.float64]:
    types = module("pyarrow", "parquet").types
    if not (types.is_floating(column.type) or types.is_integer(column.type)):
        raise ValueError(
            f"{path} has values of the type {shown_text(column.type)} in the column {shown(name)}; they must be numbers"
        )
    if column.null_count:
        raise ValueError(f"{path} has {column.null_count} rows without a value in the column {shown(name)}")
    return np.asarray(column.to_numpy(zero_copy_only=False), dtype=np.float64)


def _points(path: str, name: str, column: Any) -> npt.NDArray[np.float64]:
    """Returns the positions in a column of points, in any encoding that GeoParquet has for them."""
    types = module("pyarrow", "parquet").types
    if types.is_binary(column.type) or types.is_large_binary(column.type):
        return _of_wkb(path, column.to_pylist())
    if types.is_struct(column.type):
        parts = {field.name: column.field(at) for at, field in enumerate(column.type)}
        if {"x", "y"} <= parts.keys():
            for part in parts.keys() - {"x", "y"}:
                _check_plane(path, _numbers(path, part, parts[part]))
            return np.stack([_numbers(path, part, parts[part]) for part in ("x", "y")], axis=1)
    raise ValueError(
        f"{path} has the type {shown_text(column.type)} in the column {shown(name)}; it must be points: WKB, or a "
        "structure of x and y"
    )


def _check_plane(path: str, heights: npt.NDArray[np.float64]) -> None:
    if heights.any():
        raise ValueError(f"{path} has points in space, whose z is not 0; only points of the plane can be read")


def _of_wkb(path: str, values: list[bytes]) -> npt.NDArray[np.float64]:
    if all(len(value) == _POINT.itemsize for value in values):
        points = np.frombuffer(b"".join(values), dtype=_POINT)
        if (points["order"] == 1).all() and (points["kind"] == 1).all():
            return np.stack([points["x"], points["y"]], axis=1)
    places = np.array([_of_one(path, row, value) for row, value in enumerate(values)]).reshape(-1, 3)
    _check_plane(path, places[:, 2])
    return places[:, :2]


def _of_one(path: str, row: int, value: bytes) -> tuple[float, float, float]:
    """Returns a point in WKB, in any order of bytes, with z and a number of its system as some programs add them."""
    try:
        order = "<" if value[0] == 1 else ">"
        (kind,) = struct.unpack_from(f"{order}I", value, 1)
        start = 9 if kind & 0x2000_0000 else 5
        has_z = bool(kind & 0x8000_0000) or (kind & 0xFFFF) // 1000 == 1
        shape = (kind & 0xFFFF) % 1000
        if shape != 1:
            raise ValueError(f"{path} has a {_SHAPES.get(shape, 'shape')} in row {row}; only points can be read")
        place = struct.unpack_from(f"{order}{3 if has_z else 2}d", value, start)
    except (struct.error, IndexError) as error:
        raise ValueError(f"{path} has no point in row {row}: {shown_text(error)}") from error
    return (place[0], place[1], place[2] if has_z else 0.0)
