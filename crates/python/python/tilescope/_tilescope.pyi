"""The native module: typed functions over arrays. What they do stands in the package."""

from typing import Any, Protocol, SupportsIndex

import numpy as np
import numpy.typing as npt

from tilescope._field import Field
from tilescope._point_set import Boundary, PointSet, Window
from tilescope._progress import ProgressFunction
from tilescope._report import Level
from tilescope._stipple import Arguments

# Positions, where each sample came from, and facts as JSON.
MadeSet = tuple[npt.NDArray[np.float64], npt.NDArray[np.uint32] | None, npt.NDArray[np.float64] | None, str]

# How dots are drawn: paper, ink, whether their areas follow the darkness, and the radius of a dot or, if they do, its product
# with the radius of the sample.
DrawingFields = tuple[tuple[int, int, int], tuple[int, int, int], bool, float]

# Positions in space, and facts as JSON.
MadeSolid = tuple[npt.NDArray[np.float64], npt.NDArray[np.uint32] | None, npt.NDArray[np.uint32] | None, str]

class _Given(Protocol):
    radius: Any
    width: float | None
    height: float | None
    boundary: Any
    origin: tuple[float, float] | None

class Ground:
    @staticmethod
    def stored(text: str) -> Ground: ...
    def domain(self) -> tuple[float, float, Boundary]: ...
    def origin(self) -> tuple[float, float]: ...
    def least(self) -> float: ...
    def greatest(self) -> float: ...
    def varies(self) -> bool: ...
    def has_shape(self) -> bool: ...
    def radii(self, points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]: ...

class RunRequest:
    def __new__(
        cls,
        *,
        count: SupportsIndex | None,
        radius: float | None,
        pattern: PointSet | None,
        pattern_source: str | None,
        levels: SupportsIndex | None,
        exactly: SupportsIndex | None,
        order_within: str,
        **parameters: object,
    ) -> RunRequest: ...
    def repeating_pattern(self, is_exact: bool) -> tuple[float, float] | None: ...

class Plane:
    def __new__(cls, request: RunRequest, method: str, progress: ProgressFunction | None) -> Plane: ...
    def facts(self) -> str: ...
    def window(
        self, rectangle: Window, progress: ProgressFunction | None
    ) -> tuple[npt.NDArray[np.float64], list[int], npt.NDArray[np.float64] | None]: ...
    def verify(self, rectangle: Window, progress: ProgressFunction | None) -> tuple[int, int]: ...

class FieldPlane:
    def __new__(cls, given: _Given, field: Field, seed: SupportsIndex, blocks: RunRequest | None) -> FieldPlane: ...
    def facts(self) -> str: ...
    def window(self, corners: Window, progress: ProgressFunction | None) -> npt.NDArray[np.float64]: ...
    def verify(self, corners: Window, progress: ProgressFunction | None) -> tuple[int, int]: ...

class Space:
    def __new__(cls, radius: float, seed: SupportsIndex) -> Space: ...
    def window(self, corners: tuple[float, float, float, float, float, float], progress: ProgressFunction | None) -> npt.NDArray[np.float64]: ...
    def verify(self, corners: tuple[float, float, float, float, float, float], progress: ProgressFunction | None) -> tuple[int, int]: ...

def analyze(set: PointSet, progress: ProgressFunction | None) -> dict[str, float | None]: ...
def certify(set: PointSet, progress: ProgressFunction | None) -> str: ...
def check(
    path: str,
    given: _Given,
    field: Field | None,
    format_name: str | None,
    set: SupportsIndex | None,
    judge: str | None,
    progress: ProgressFunction | None,
) -> str: ...
def check_file_in_space(
    path: str,
    size: tuple[float, float, float] | None,
    boundary: str | None,
    radius: float | None,
    format_name: str | None,
    judge: str | None,
    progress: ProgressFunction | None,
) -> str: ...
def check_domain(radius: float | None, width: float, height: float, boundary: str) -> None: ...
def combine(layout: str, folder: str, sets: dict[str, PointSet], progress: ProgressFunction | None) -> MadeSet: ...
def curve(
    request: RunRequest,
    method: str,
    numbers: list[str] | None,
    moments: SupportsIndex | None,
    progress: ProgressFunction | None,
) -> dict[str, Any]: ...
def curve_field(
    ground: tuple[_Given, Field],
    count: SupportsIndex | None,
    seed: SupportsIndex,
    blocks: RunRequest | None,
    asked: tuple[list[str] | None, SupportsIndex | None],
    progress: ProgressFunction | None,
) -> dict[str, Any]: ...
def digest(set: PointSet) -> str: ...
def draw(
    set: PointSet,
    *,
    caption: str,
    svg: bool,
    size: SupportsIndex,
    window: Window | None,
    disks: bool,
    theme: str,
    progress: ProgressFunction | None,
) -> bytes: ...
def draw_dots(
    set: PointSet,
    radii: npt.NDArray[np.float64],
    *,
    svg: bool,
    size: SupportsIndex,
    window: Window | None,
    progress: ProgressFunction | None,
) -> bytes: ...
def ground_of(given: _Given, field: Field) -> Ground: ...
def is_in_space(path: str) -> bool: ...
def named_by_content(path: str) -> str: ...
def pair_correlation(set: PointSet, progress: ProgressFunction | None) -> npt.NDArray[np.float64]: ...
def prefix(levels: tuple[Level, ...], count: SupportsIndex) -> tuple[int, float, float | None]: ...
def read(
    path: str,
    given: _Given,
    field: Field | None,
    format_name: str | None,
    set: SupportsIndex | None,
    certificate: bool,
    progress: ProgressFunction | None,
) -> tuple[MadeSet, Ground | None]: ...
def read_file_in_space(
    path: str,
    size: tuple[float, float, float] | None,
    boundary: str | None,
    radius: float | None,
    format_name: str | None,
) -> MadeSolid: ...
def recorded_numbers(set: PointSet, progress: ProgressFunction | None) -> npt.NDArray[np.uint32]: ...
def sample(request: RunRequest, method: str, engine: str, progress: ProgressFunction | None) -> MadeSet: ...
def sample_field(
    given: _Given,
    field: Field,
    count: SupportsIndex | None,
    seed: SupportsIndex,
    blocks: RunRequest | None,
    progress: ProgressFunction | None,
) -> tuple[MadeSet, Ground]: ...
def save(
    set: PointSet,
    path: str,
    *,
    format_name: str | None,
    precision: str,
    shuffle: SupportsIndex | None,
    origin: tuple[float, float] | None,
    verify: bool,
    judge: str | None,
    progress: ProgressFunction | None,
) -> str: ...
def sample_solid(
    size: tuple[float, float, float],
    radius: Any,
    count: SupportsIndex | None,
    exactly: SupportsIndex | None,
    boundary: str,
    seed: SupportsIndex,
    progress: ProgressFunction | None,
) -> MadeSolid: ...
def save_solid(
    points: npt.NDArray[np.float64],
    facts: str,
    path: str,
    *,
    arrival: npt.NDArray[np.uint32] | None,
    level: npt.NDArray[np.uint32] | None,
    format_name: str | None,
    precision: str,
    shuffle: SupportsIndex | None,
    verify: bool,
    judge: str | None,
    progress: ProgressFunction | None,
) -> str: ...
def set_threads(threads: SupportsIndex) -> None: ...
def spectrum(set: PointSet, nu: float | None, progress: ProgressFunction | None) -> dict[str, Any]: ...
def stipple(
    image: npt.NDArray[np.uint16] | str, arguments: Arguments, progress: ProgressFunction | None
) -> tuple[MadeSet, Ground, tuple[int, float, int, DrawingFields]]: ...
def verify(set: PointSet, judge: str | None, progress: ProgressFunction | None) -> str: ...
def verify_window(
    set: PointSet, window: Window, judge: str | None, progress: ProgressFunction | None
) -> tuple[int, int]: ...
def write_file(path: str, data: bytes) -> None: ...
def verify_solid(
    points: npt.NDArray[np.float64], facts: str, judge: str | None, progress: ProgressFunction | None
) -> str: ...
