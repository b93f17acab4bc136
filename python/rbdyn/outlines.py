"""Surfaces of bodies and obstacles as triangles, for pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from rbdyn._core import RigidBody

Array = npt.NDArray[np.float64]

# moments that are equal to this are those of a ball
EQUAL = 1e-9
# the least edge of a box, relative to its longest: plates and rods are seen
THINNEST = 0.02


@dataclass
class Outline:
    """A surface: vertices (n, 3) [m], and triangles (m, 3) of their indices."""

    vertices: Array
    triangles: npt.NDArray[np.int64]

    def __add__(self, other: Outline) -> Outline:
        """Both."""
        moved = other.triangles + len(self.vertices)
        return Outline(np.vstack([self.vertices, other.vertices]), np.vstack([self.triangles, moved]))


def ellipsoid(semi_axes: Any, center: Any = (0, 0, 0), axes: Any = None, around: int = 16, up: int = 8) -> Outline:
    """An ellipsoid; the columns of axes (3, 3) are its own."""
    latitudes = np.linspace(-np.pi / 2, np.pi / 2, up + 1)[1:-1]
    longitudes = np.arange(around) * 2 * np.pi / around
    ring = np.stack([np.cos(longitudes), np.sin(longitudes)], axis=-1)
    rows = [np.column_stack([ring * np.cos(one), np.full(around, np.sin(one))]) for one in latitudes]
    unit = np.vstack([[0, 0, -1], *rows, [0, 0, 1]])
    top = len(unit) - 1
    triangles = []
    for i in range(around):
        j = (i + 1) % around
        triangles += [[0, 1 + j, 1 + i], [top, top - around + i, top - around + j]]
        for row in range(up - 2):
            low = 1 + row * around
            triangles += [[low + i, low + j, low + around + i], [low + j, low + around + j, low + around + i]]
    return _placed(unit * np.asarray(semi_axes, float), triangles, center, axes)


def box(size: Any, center: Any = (0, 0, 0), axes: Any = None) -> Outline:
    """A box of the edges size (3,); the columns of axes (3, 3) are their directions."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = [half for a, b, c, d in faces for half in ([a, b, c], [a, c, d])]
    return _placed(corners * np.asarray(size, float), triangles, center, axes)


def disc(radius: float, normal: Any, center: Any = (0, 0, 0), around: int = 24) -> Outline:
    """A disc without thickness."""
    angles = np.arange(around) * 2 * np.pi / around
    rim = radius * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(around)])
    triangles = [[0, 1 + i, 1 + (i + 1) % around] for i in range(around)]
    return _placed(np.vstack([np.zeros(3), rim]), triangles, center, across(normal))


def patch(half: float, normal: Any, center: Any) -> Outline:
    """A square of a plane, of the edge 2 half."""
    corners = half * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)
    return _placed(corners, [[0, 1, 2], [0, 2, 3]], center, across(normal))


def of_inertia(body: RigidBody) -> Outline:
    """The uniform box of the same mass, centre of mass and principal moments, a ball where these are equal.

    Of a box of edges a, b, c: I1 = m/12 (b^2 + c^2), and so on, so a^2 = 6/m (I2 + I3 - I1); of a ball I = 2/5 m r^2. A
    rod or a plate has edges of zero: they are drawn thin.
    """
    moments, axes = np.linalg.eigh(np.asarray(body.inertia()))
    if moments[2] - moments[0] <= EQUAL * moments[2]:
        return ellipsoid(np.full(3, np.sqrt(2.5 * moments.mean() / body.mass)), body.com)
    squares = 6 / body.mass * (moments.sum() - 2 * moments)
    edges = np.sqrt(np.maximum(squares, 0.0))
    return box(np.maximum(edges, THINNEST * edges.max()), body.com, axes)


def across(normal: Any) -> Array:
    """Axes (3, 3) in columns, the last along the normal."""
    third = np.asarray(normal, float) / np.linalg.norm(normal)
    first = np.cross(third, np.eye(3)[np.argmin(abs(third))])
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(third, first), third])


def _placed(vertices: Array, triangles: Any, center: Any, axes: Any) -> Outline:
    turned = vertices if axes is None else vertices @ np.asarray(axes, float).T
    return Outline(turned + np.asarray(center, float), np.array(triangles))
