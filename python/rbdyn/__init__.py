"""Dynamics of points and rigid bodies."""

from rbdyn._core import __version__

__all__ = ["__version__"]
