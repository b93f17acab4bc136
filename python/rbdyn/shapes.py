"""Rigid bodies by their shape: uniform density, centred on the centre of mass but the cone, in body axes.

Masses [kg], lengths [m], positive; directions of any length. Each raises InvalidInput for numbers that make no shape.
"""

from rbdyn._core import (
    box,
    cone,
    cylinder,
    disc,
    ellipsoid,
    points,
    ring,
    rod,
    shell,
    solid,
    sphere,
)

__all__ = [
    "box",
    "cone",
    "cylinder",
    "disc",
    "ellipsoid",
    "points",
    "ring",
    "rod",
    "shell",
    "solid",
    "sphere",
]
