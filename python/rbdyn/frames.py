"""Frames of curves, as named tuples."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt


class Frenet(NamedTuple):
    """The moving axes of a curve, unit vectors in the world: (3,) each, or (n, 3); binormal = tangent x normal."""

    tangent: npt.NDArray[np.float64]
    normal: npt.NDArray[np.float64]
    binormal: npt.NDArray[np.float64]
