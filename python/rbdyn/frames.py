"""What belongs together, as named tuples: (3,) each, or (n, 3), unless a tuple says otherwise; world axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


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
