"""Figures of what of bodies changes with time, with matplotlib."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rbdyn._core import BodyHandle
from rbdyn.destinations import write_figure
from rbdyn.errors import InvalidInput
from rbdyn.plots import COLORS, POINTS, _figure_class, _tidy
from rbdyn.sample import AXES, QUANTITIES, axes_of
from rbdyn.shown import shown

if TYPE_CHECKING:
    from rbdyn._core import Trajectory

BODY_AFTER = "a body comes after it, as in plot(None, handle)"
ENERGIES = {"kinetic_energy": "T", "potential_energy": "V", "energy": "T + V"}
# bodies side by side; the next ones are below
COLUMNS = 3
# what is drawn of a body of which nothing is asked for, by a quantity that its kind has, and how it is labelled
USUAL: dict[str, dict[str, str]] = {
    "parameter": {"parameter": "parameter u", "speed": "speed [m/s]", "reaction_frenet": "reaction [N]"},
    "angle": {"angle": "angle [rad]", "rate": "rate [rad/s]", "reaction": "reaction [N]"},
    "displacement": {"displacement": "displacement [m]", "rate": "rate [m/s]", "reaction": "reaction [N]"},
    "quaternion": {
        "center_of_mass": "centre of mass [m]",
        "euler_angles": "angles [rad]",
        "angular_velocity": "ang. velocity, body [rad/s]",
    },
    "position": {"position": "position [m]", "velocity": "velocity [m/s]"},
}
Values = npt.NDArray[np.float64]


def plot(
    self: Trajectory,
    path: str | os.PathLike[str] | None = None,
    handle: BodyHandle | str | Iterable[BodyHandle | str] | None = None,
    quantities: str | Iterable[str] | None = None,
) -> Any:
    """
    A figure of the motion over time with its events: of all bodies, of `handle`, or of several, by handles or names.

    Drawn are where each is, how fast, what holds it, and the energies of all; or `quantities`, by the names that
    run[handle].quantities has, and "energy", "kinetic_energy", "potential_energy". Written to `path`, if given.
    Returns the matplotlib figure.

    Raises ImportError if matplotlib is missing, InvalidInput for what is no body or no quantity of any.
    """
    figure_class = _figure_class()
    handles = _bodies(self, handle)
    asked = None if quantities is None else [quantities] if isinstance(quantities, str) else list(quantities)
    labels = {one: _labels(self, one, asked) for one in handles}
    energies = [name for name in ENERGIES if asked is None or name in asked]
    for name in asked or []:
        if name not in ENERGIES and not any(name in labels[one] for one in handles):
            there = dict.fromkeys(
                name for one in handles for name in self[one].quantities if name in QUANTITIES or name == "rate"
            )
            raise InvalidInput(
                f"Trajectory.plot: there is no quantity {shown(name)}; there are {', '.join([*there, *ENERGIES])}"
            )
    drawn = [one for one in handles if labels[one]]

    curves = _Curves(self)
    bands = [drawn[i : i + COLUMNS] for i in range(0, len(drawn), COLUMNS)]
    heights = [max(len(labels[one]) for one in band) for band in bands]
    columns, count = min(max(len(drawn), 1), COLUMNS), sum(heights) + bool(energies)
    if not count:
        raise InvalidInput("Trajectory.plot: there is nothing to draw; name a quantity, or give no quantities")
    figure = figure_class(figsize=(7.2 if columns == 1 else 4.8 * columns, 1.9 * count), layout="constrained")
    grid = figure.add_gridspec(count, columns)
    below: list[Any] = []
    first: Any = None
    row = 0
    for band, height in zip(bands, heights, strict=True):
        for column, one in enumerate(band):
            marks = curves.marks(one)
            for i, (name, label) in enumerate(labels[one].items()):
                axes = figure.add_subplot(grid[row + i, column], sharex=first)
                first = first or axes
                _draw(axes, label, curves.of(one, name), curves.times, marks)
                if i == 0:
                    axes.set_title(one.name + (" (grey: its events)" if marks else ""), loc="left", fontsize="medium")
            below.append(axes)
        row += height
    if energies:
        axes = figure.add_subplot(grid[row, :], sharex=first)
        lines = {ENERGIES[name]: curves.sampled(getattr(self, name)) for name in energies}
        _draw(axes, "energy [J]", lines, curves.times, curves.marks(*handles))
        below = [axes]
    for axes in below:
        axes.set_xlabel("time [s]")
    figure.align_ylabels()
    write_figure(figure, path, "Trajectory.plot", BODY_AFTER, dpi=150)
    return figure


class _Curves:
    """Values at uniform times and at those of events, which have two points each, for what jumps there."""

    def __init__(self, run: Trajectory) -> None:
        self._run = run
        self._jumps = np.unique([event.time for event in run.events])
        self._after = np.unique(np.concatenate([np.linspace(run.start, run.end, POINTS), self._jumps]))
        self._places = np.searchsorted(self._after, self._jumps)
        self.times: Values = np.insert(self._after, self._places, self._jumps)

    def sampled(self, quantity: Any) -> Any:
        return np.insert(quantity(self._after), self._places, quantity(self._jumps, side="before"), axis=0)

    def of(self, handle: BodyHandle, name: str) -> dict[str, Values]:
        """By the names of its components."""
        values = self.sampled(getattr(self._run[handle], name))
        names = [AXES[axis] for axis in axes_of(name, values)]
        if name in ("angular_velocity", "angular_acceleration"):  # along axes of the body
            names = [["1", "2", "3"]]
        return {
            " ".join(label[i] for label, i in zip(names, index, strict=True)): values[(slice(None), *index)]
            for index in np.ndindex(*values.shape[1:])
        }

    def marks(self, *handles: BodyHandle) -> list[float]:
        return [event.time for event in self._run.events if event.subject is None or event.subject in handles]


def _bodies(run: Trajectory, asked: Any) -> list[BodyHandle]:
    if asked is None:
        return list(run.bodies)
    several = [asked] if isinstance(asked, str) or not isinstance(asked, Iterable) else list(asked)
    named = {body.name: body for body in run.bodies}
    found = []
    for one in several:
        body = named.get(one) if isinstance(one, str) else one
        if not isinstance(body, BodyHandle):
            name = getattr(one, "name", one)
            raise InvalidInput(
                f'Trajectory.plot: "{name}" is not a body; use the handle that add() returned, or its name'
            )
        found.append(body)
    return found


def _labels(run: Trajectory, body: BodyHandle, asked: list[str] | None) -> dict[str, str]:
    """Of what is drawn of a body, by the names of quantities."""
    there = run[body].quantities
    if asked is None:
        return next(usual for name, usual in USUAL.items() if name in there)
    usual: Mapping[str, str] = next((usual for name, usual in USUAL.items() if name in there), {})
    labels = {}
    for name in asked:
        if name in there and (name in QUANTITIES or name in usual):
            unit = QUANTITIES.get(name, ("", ""))[0]
            words = name.replace("_", " ")
            labels[name] = usual.get(name) or (f"{words} [{unit}]" if unit not in ("", "1") else words)
    return labels


def _draw(axes: Any, label: str, lines: dict[str, Values], times: Values, marks: list[float]) -> None:
    for mark in marks:
        axes.axvline(mark, color="0.75", linewidth=0.8, zorder=0)
    # what changes most is drawn first: it hides nothing that is slower
    travelled = {name: float(np.abs(np.diff(values)).sum()) for name, values in lines.items()}
    depth = {name: 2.0 + 0.01 * i for i, name in enumerate(sorted(lines, key=lambda name: -travelled[name]))}
    for i, (name, values) in enumerate(lines.items()):
        color = COLORS[i % len(COLORS)]
        axes.plot(times, values, color=color, linewidth=1.3, label=name or None, zorder=depth[name])
    axes.set_ylabel(label)
    _tidy(axes)
    if len(lines) > 1:
        # above the axes, where it covers no curve
        axes.legend(
            frameon=False, ncols=len(lines), fontsize="small", loc="lower right", bbox_to_anchor=(1, 1), borderpad=0
        )
