"""Figures of where bodies go, and of the rate of a coordinate over it, with matplotlib."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rbdyn._core import BodyHandle
from rbdyn.destinations import write_figure
from rbdyn.errors import InvalidInput
from rbdyn.plots import COLORS, POINTS, _figure_class, _tidy
from rbdyn.shown import shown

if TYPE_CHECKING:
    from rbdyn._core import Trajectory

BODY_AFTER = "a body comes after it, as in phase_portrait(None, handle)"
# a coordinate, its rate, and how they are labelled, in the order in which they are looked for
PORTRAITS = (
    ("parameter", "speed", "parameter u", "speed [m/s]"),
    ("angle", "rate", "angle [rad]", "rate [rad/s]"),
    ("displacement", "rate", "displacement [m]", "rate [m/s]"),
)


def plot_path(self: Trajectory, path: str | os.PathLike[str] | None = None, *, plane: str | None = None) -> Any:
    """
    A figure of where the bodies go, in space, or in a plane of the world, "xy", "xz" and so on.

    Of a rigid body, where its centre of mass goes; a dot is where each ends. Axes are equal. Written to `path`, if
    given. Returns the matplotlib figure.

    Raises ImportError if matplotlib is missing, InvalidInput for what is no plane.
    """
    figure_class = _figure_class()
    if plane is not None and (not isinstance(plane, str) or len(plane) != 2 or len(set(plane) & set("xyz")) != 2):
        raise InvalidInput(f'plot_path: plane is {shown(plane)}; it is two of "x", "y" and "z", or None for space')
    columns = ["xyz".index(axis) for axis in plane or "xyz"]
    figure = figure_class(figsize=(6.4, 5.6), layout="constrained")
    axes = figure.add_subplot(projection=None if plane else "3d")
    times = np.linspace(self.start, self.end, POINTS)
    for i, handle in enumerate(self.bodies):
        motion = self[handle]
        is_rigid = "center_of_mass" in motion.quantities
        places = (motion.center_of_mass if is_rigid else motion.position)(times)[:, columns].T
        axes.plot(*places, color=COLORS[i % len(COLORS)], linewidth=1.3, label=handle.name)
        axes.plot(*places[:, -1:], "o", color=COLORS[i % len(COLORS)], markersize=5)
    axes.set(**{f"{on}label": f"{'xyz'[k]} [m]" for on, k in zip("xyz", columns, strict=False)})
    if plane:
        axes.set_aspect("equal", adjustable="datalim")
        _tidy(axes)
    else:
        axes.set_aspect("equal")
    axes.legend(frameon=False, fontsize="small")
    write_figure(figure, path, "plot_path", dpi=150)
    return figure


def phase_portrait(
    self: Trajectory, path: str | os.PathLike[str] | None = None, handle: BodyHandle | None = None
) -> Any:
    """
    A figure of the rate of a body's coordinate over it: on a rail speed over parameter, on a hinge or a slide over what
    it has turned or moved by.

    handle: the first body that has one by default. The line is broken where the rate jumps, as at an impact; a dot is
    where it ends. Written to `path`, if given. Returns the matplotlib figure.

    Raises ImportError if matplotlib is missing, InvalidInput for what has no such coordinate.
    """
    figure_class = _figure_class()
    if handle is not None and not isinstance(handle, BodyHandle):
        raise InvalidInput(f"phase_portrait: {shown(handle)} is not a body; use the handle that add() returned")
    for one in self.bodies if handle is None else [handle]:
        motion = self[one]
        for coordinate, rate, *labels in PORTRAITS:
            if coordinate in motion.quantities and rate in motion.quantities:
                across, up = _broken(self, getattr(motion, coordinate), getattr(motion, rate))
                figure = figure_class(figsize=(6.4, 5.0), layout="constrained")
                axes = figure.subplots()
                axes.plot(across, up, color=COLORS[0], linewidth=1.3)
                axes.plot(across[-1:], up[-1:], "o", color=COLORS[0], markersize=5)
                axes.set(xlabel=labels[0], ylabel=labels[1])
                axes.set_title(one.name, loc="left", fontsize="medium")
                _tidy(axes)
                write_figure(figure, path, "phase_portrait", BODY_AFTER, dpi=150)
                return figure
    whose = "no body of this run is" if handle is None else f'"{handle.name}" is not'
    raise InvalidInput(f"phase_portrait: {whose} on a rail, a hinge or a slide; plot_path() shows where it goes")


def _broken(run: Trajectory, *quantities: Any) -> list[npt.NDArray[np.float64]]:
    """Quantities over time, from both sides of each event, with nothing between: what jumps is not joined."""
    jumps = np.unique([event.time for event in run.events if run.start < event.time < run.end])
    times = np.unique(np.concatenate([np.linspace(run.start, run.end, POINTS), jumps]))
    places = np.searchsorted(times, jumps)
    sides = [(quantity(times), quantity(jumps, side="before")) for quantity in quantities]
    breaks = np.zeros(len(jumps), dtype=bool)
    for after, before in sides:
        breaks |= np.abs(after[places] - before) > 1e-9 * np.abs(after).max(initial=0.0)
    return [
        np.insert(
            after,
            np.repeat(places[breaks], 2),
            np.column_stack([before[breaks], np.full(breaks.sum(), np.nan)]).ravel(),
        )
        for after, before in sides
    ]
