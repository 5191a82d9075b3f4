"""The verifier's report on a set."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any, NamedTuple


class Domain(NamedTuple):
    """The rectangle that a set fills, with one corner at the origin."""

    width: float
    """Its extent along x, in the unit of the samples."""
    height: float
    """Its extent along y."""
    boundary: str
    """``'periodic'``: opposite sides are joined; ``'bounded'``: the border is closed and must be covered."""


class Conflict(NamedTuple):
    """A pair of samples closer than the radius."""

    first: int
    """Index of a sample."""
    second: int
    """Index of the other one; the same where a sample is too close to its own copy in a periodic domain."""
    distance: float
    """How far apart they are, around the torus if the domain is periodic."""


class Gap(NamedTuple):
    """The centre of an empty circle larger than the radius."""

    center: tuple[float, float]
    """A place of the domain."""
    distance: float
    """How far it is from there to the nearest sample."""
    kind: str
    """``'voronoi-vertex'``, ``'border'`` or ``'corner'``."""


@dataclass(frozen=True)
class Level:
    """What is to hold for the first samples of a set with nested levels."""

    count: int
    """How many samples."""
    distance: float
    """No two of them are closer than this."""
    covering: float | None
    """No place of the domain is farther than this from all of them; ``None`` if they hold no whole level."""


@dataclass(frozen=True)
class LevelReport:
    """What the verifier found out about the first samples of a set with nested levels."""

    count: int
    """How many samples."""
    distance: float
    """No two of them are to be closer than this."""
    covering: float | None
    """No place is to be farther from them than this, but for the tolerance; ``None`` where that is not promised."""
    min_distance: float
    """Smallest distance between two of them; infinite for one sample of a bounded domain."""
    covering_radius: float
    """Largest distance from a place of the domain to the nearest of them."""
    valid: bool
    """Whether distance and covering are as promised."""


@dataclass(frozen=True, repr=False)
class Report:
    """What the verifier found out about a set. Lengths are in the unit of the samples.

    Two judges, which share no search, decide: one triangulates, one looks at the circle around each
    sample. Neither knows the sampler.
    """

    valid: bool
    """Whether the set is both conflict-free and maximal; with nested levels, whether each level is as promised; of a
    stipple, whether it is conflict-free and covers within `covering_factor`."""
    conflict_free: bool
    """Whether no two samples are closer than the radius."""
    maximal: bool
    """Whether no sample could be added: no place is farther than ``(1 + covering_tolerance) * radius`` from all."""
    count: int
    """Number of samples."""
    radius: float
    """The radius that was asked about."""
    domain: Domain
    """The domain that was asked about."""
    min_distance: float
    """Smallest distance between two samples; infinite for one sample of a bounded domain."""
    covering_radius: float
    """Largest distance from a place of the domain to its nearest sample; infinite in a field or a shape, where it is not
    measured."""
    covering_tolerance: float
    """Relative tolerance of maximality, 2**-15: one unit of the sampler's lattice."""
    conflicts: int
    """Pairs in conflict, counted up to a million."""
    worst_conflicts: tuple[Conflict, ...]
    """The closest of them, at most 16."""
    gaps: int
    """Places that are centres of too large an empty circle. One hole usually has several."""
    worst_gaps: tuple[Gap, ...]
    """The largest of those circles, at most 16."""
    density: float
    """``count * radius**2 / area``."""
    relative_radius: float
    """``min_distance`` over that of the densest packing of as many samples."""
    judges: tuple[str, ...]
    """Who judged: ``'delaunay'``, ``'circles'``, or both, which agree; of a field or a shape ``'subdivision'``."""
    covering_factor: float | None = None
    """Of a stipple, the least factor of its radius within which every place is near a dot, as it was measured."""
    levels: tuple[LevelReport, ...] = ()
    """The nested levels, if the set has any: of each, what was found of all samples to its end."""
    differences: tuple[str, ...] = ()
    """Statements of a file's certificate that do not hold; empty for a set in memory."""

    @property
    def passed(self) -> bool:
        """Whether the set is valid and every statement of its certificate, if it has one, is true."""
        return self.valid and not self.differences

    def __repr__(self) -> str:
        if self.passed:
            verdict = "valid"
        elif self.valid:
            verdict = "CERTIFICATE NOT TRUE"
        else:
            verdict = "NOT VALID, CERTIFICATE NOT TRUE" if self.differences else "NOT VALID"
        r = self.radius
        if self.covering_factor is not None:
            return (
                f"<Report: {verdict} prefix, {self.count} samples, {self.conflicts} conflicts, {self.gaps} gaps, "
                f"covering within {self.covering_factor:.6f} of the radius>"
            )
        counts = f"<Report: {verdict}, {self.count} samples, {self.conflicts} conflicts, {self.gaps} gaps"
        # In a field or a shape squares find out whether places are covered, and not how far they are from samples.
        if self.judges == ("subdivision",):
            return f"{counts}, by subdivision>"
        return (
            f"{counts}, smallest distance {self.min_distance / r:.6f} r, covering radius {self.covering_radius / r:.6f} r>"
        )


def _level_of(found: dict[str, Any]) -> LevelReport:
    return LevelReport(**found | {"min_distance": math.inf if found["min_distance"] is None else found["min_distance"]})


def report_of(found: dict[str, Any], differences: list[str] | None = None) -> Report:
    """Returns the report that the native module gave."""
    region = found["region"]
    same = (
        "valid", "conflict_free", "maximal", "count", "radius", "min_distance", "covering_radius", "covering_tolerance",
        "conflicts", "gaps", "density", "relative_radius",
    )  # fmt: skip

    # JSON has no infinity.
    fields: dict[str, Any] = {name: math.inf if found[name] is None else found[name] for name in same}

    return Report(
        domain=Domain(region["width"], region["height"], region["boundary"]),
        worst_conflicts=tuple(Conflict(**one) for one in found["worst_conflicts"]),
        worst_gaps=tuple(
            Gap((one["center"][0], one["center"][1]), one["distance"], one["kind"]) for one in found["worst_gaps"]
        ),
        judges=tuple(found["judges"]),
        covering_factor=found["covering_factor"],
        levels=tuple(_level_of(level) for level in found["levels"]),
        differences=tuple(differences or ()),
        **fields,
    )


def report_of_json(text: str) -> Report:
    """Returns the report that the native module gave as JSON."""
    return report_of(json.loads(text))
