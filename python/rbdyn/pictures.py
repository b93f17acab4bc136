"""Gives runs their pictures: plot(), view(), animate(), plot_path() and phase_portrait() of Trajectory."""

from __future__ import annotations

import inspect

from rbdyn._core import Trajectory
from rbdyn.animation import animate
from rbdyn.motion_plots import plot
from rbdyn.portraits import phase_portrait, plot_path
from rbdyn.view import view


def give() -> None:
    """Makes them methods of runs, with the names that messages and pickles call them by."""
    for method in (animate, phase_portrait, plot, plot_path, view):
        method.__doc__ = inspect.cleandoc(method.__doc__ or "")
        method.__qualname__ = f"Trajectory.{method.__name__}"
        setattr(Trajectory, method.__name__, method)
