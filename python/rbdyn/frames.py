"""Frames of curves and of bodies, as named tuples."""

from typing import NamedTuple

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
