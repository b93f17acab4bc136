"""What belongs together, as named tuples: (3,) each, or (n, 3), unless a tuple says otherwise; world axes."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rbdyn.shown import shown

if TYPE_CHECKING:
    import numpy.typing as npt


# --- what tuples of arrays are asked: Python's own would ask whether an array is true ---


def _is(part: npt.NDArray[np.float64], value: Any) -> bool:
    return part is value or bool(np.array_equal(part, value))


def _equal(self: tuple[Any, ...], other: object) -> Any:
    """Whether all of their numbers are equal."""
    if not isinstance(other, tuple):
        return NotImplemented
    return len(self) == len(other) and all(map(_is, self, other))


def _unequal(self: tuple[Any, ...], other: object) -> Any:
    return not _equal(self, other) if isinstance(other, tuple) else NotImplemented


def _contains(self: tuple[Any, ...], value: object) -> bool:
    return any(_is(part, value) for part in self)


def _count(self: tuple[Any, ...], value: Any) -> int:
    """How many of the fields have the numbers of value."""
    return sum(_is(part, value) for part in self)


def _index(self: Any, value: Any, start: int = 0, stop: int = sys.maxsize) -> int:
    """The place of the first field that has the numbers of value. Raises ValueError if there is none."""
    for place in range(len(self))[start:stop]:
        if _is(self[place], value):
            return place
    raise ValueError(f"{type(self).__name__}.index: {shown(value)} is none of {', '.join(self._fields)}")


class Frenet(NamedTuple):
    """The moving axes of a curve, unit vectors in the world: (3,) each, or (n, 3); binormal = tangent x normal."""

    tangent: npt.NDArray[np.float64]
    normal: npt.NDArray[np.float64]
    binormal: npt.NDArray[np.float64]


class PrincipalAxes(NamedTuple):
    """Principal moments of a body, (3,) [kg m^2], and the unit vectors they belong to, columns of (3, 3)."""

    moments: npt.NDArray[np.float64]
    axes: npt.NDArray[np.float64]


class Imbalance(NamedTuple):
    """What a body asks of the bearings of an axis fixed in it, body axes: (3,) [kg m] and (3,) [kg m^2]."""

    offset: npt.NDArray[np.float64]
    couple: npt.NDArray[np.float64]


class Axis(NamedTuple):
    """An axis in the world: a point of it [m], and its direction."""

    point: npt.NDArray[np.float64]
    direction: npt.NDArray[np.float64]


class PointMotion(NamedTuple):
    """Position [m] and velocity [m/s] of a point."""

    position: npt.NDArray[np.float64]
    velocity: npt.NDArray[np.float64]


for _kind in (Frenet, PrincipalAxes, Imbalance, Axis, PointMotion):
    _own: Any = _kind
    _own.__eq__, _own.__ne__, _own.__hash__ = _equal, _unequal, None
    _own.__contains__, _own.count, _own.index = _contains, _count, _index
