"""Figures of runs and prices, with matplotlib."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn._core import BodyHandle
from rbdyn.destinations import write_figure
from rbdyn.errors import InvalidInput

if TYPE_CHECKING:
    from rbdyn._core import CostRow, Price, Trajectory

# Okabe and Ito: told apart by every kind of colour vision, in print too
COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKERS = "osD^vP*"
# points of a curve: more than a figure has pixels across
POINTS = 2000
# where errors of zero are drawn
LEAST_ERROR = 1e-17


def plot_price(price: Price, path: str | os.PathLike[str] | None = None) -> Any:
    """The work-precision diagram: seconds over achieved error, a line an engine, dashed for the whole call.

    The errors of the times of events stand apart, in axes of their own, where there are events.
    """
    figure_class = _figure_class()
    panels = [("error of the motion, relative", "motion_error")]
    if any(row.events_expected for row in price):
        panels.append(("error of the times of events, relative", "event_error"))
    figure = figure_class(figsize=(6.4 if len(panels) == 1 else 9.6, 5.0), layout="constrained")
    all_axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    engines = list(dict.fromkeys(row.engine for row in price))
    for axes, (label, name) in zip(all_axes, panels, strict=True):

        def curve(rows: list[CostRow], seconds: str, name: str = name) -> tuple[list[float], list[float]]:
            return [max(getattr(row, name), LEAST_ERROR) for row in rows], [getattr(row, seconds) for row in rows]

        front = [row for row in price.front() if np.isfinite(row.error)]
        axes.loglog(*curve(front, "seconds"), color="0.85", linewidth=7, solid_capstyle="round", label="cheapest")
        for i, engine in enumerate(engines):
            # a row that missed an event has no place among those that did not
            rows = [row for row in price if row.engine == engine and row.has_all_events and np.isfinite(row.error)]
            rows.sort(key=lambda row: -row.tolerance)
            is_automatic = engine == price.automatic
            style: dict[str, Any] = {"color": COLORS[i % len(COLORS)], "marker": MARKERS[i % len(MARKERS)]}
            axes.loglog(
                *curve(rows, "seconds"),
                **style,
                markersize=5,
                linewidth=2.4 if is_automatic else 1.3,
                label=f"{engine} (auto)" if is_automatic and engine != "auto" else engine,
            )
            called = [row for row in rows if np.isfinite(row.total)]
            axes.loglog(
                *curve(called, "total"), **style, markersize=2.5, linewidth=1.0, linestyle="--", label="_whole call"
            )
        axes.set_xlabel(label)
        axes.invert_xaxis()
        _tidy(axes)
    all_axes[0].set_ylabel("processor time [s]; dashed: simulate() with error=")
    if len(price):
        handles, labels = all_axes[0].get_legend_handles_labels()
        # outside the axes, so that it covers nothing
        figure.legend(handles, labels, frameon=False, ncols=3, loc="outside lower center")
    write_figure(figure, path, "Price.plot", dpi=150)
    return figure


def plot_motion(run: Trajectory, path: str | os.PathLike[str] | None = None, handle: BodyHandle | None = None) -> Any:
    """Where the body is, how fast, what holds it, and the energies, over time; events are marked."""
    figure_class = _figure_class()
    handle = run.bodies[0] if handle is None else handle
    if not isinstance(handle, BodyHandle):
        raise InvalidInput(f'Trajectory.plot: "{handle.name}" is not a body; use the handle that add() returned')
    motion = run[handle]
    # an event has two points at its time, for what jumps there
    jumps = np.unique([event.time for event in run.events])
    after = np.unique(np.concatenate([np.linspace(run.start, run.end, POINTS), jumps]))
    places = np.searchsorted(after, jumps)
    times = np.insert(after, places, jumps)

    def sampled(quantity: Any) -> Any:
        return np.insert(quantity(after), places, quantity(jumps, side="before"), axis=0)

    panels: list[tuple[str, dict[str, Any]]] = []
    if "parameter" in motion.quantities:
        reaction = sampled(motion.reaction_frenet)
        panels.append(("parameter u", {"": sampled(motion.parameter)}))
        panels.append(("speed [m/s]", {"": sampled(motion.speed)}))
        names = ["tangent", "normal", "binormal"]
        panels.append(("reaction [N]", {name: reaction[:, i] for i, name in enumerate(names)}))
    elif "rate" in motion.quantities:
        names = ["angle [rad]", "rate [rad/s]"] if "angle" in motion.quantities else ["displacement [m]", "rate [m/s]"]
        panels.append((names[0], {"": sampled(getattr(motion, names[0].split()[0]))}))
        panels.append((names[1], {"": sampled(motion.rate)}))
        reaction = sampled(motion.reaction)
        panels.append(("reaction [N]", {name: reaction[:, i] for i, name in enumerate("xyz")}))
    elif "quaternion" in motion.quantities:
        position, angles = sampled(motion.center_of_mass), sampled(motion.euler_angles)
        omega = sampled(motion.angular_velocity)
        panels.append(("centre of mass [m]", {name: position[:, i] for i, name in enumerate("xyz")}))
        panels.append(("angles [rad]", {name: angles[:, i] for i, name in enumerate(["theta", "psi", "phi"])}))
        panels.append(("ang. velocity, body [rad/s]", {str(i + 1): omega[:, i] for i in range(3)}))
    else:
        position, velocity = sampled(motion.position), sampled(motion.velocity)
        panels.append(("position [m]", {name: position[:, i] for i, name in enumerate("xyz")}))
        panels.append(("velocity [m/s]", {name: velocity[:, i] for i, name in enumerate("xyz")}))
    energies = {"T": sampled(run.kinetic_energy), "V": sampled(run.potential_energy), "T + V": sampled(run.energy)}
    panels.append(("energy [J]", energies))

    figure = figure_class(figsize=(7.2, 1.9 * len(panels)), layout="constrained")
    rows = figure.subplots(len(panels), sharex=True)
    marks = [event.time for event in run.events if event.subject is None or event.subject == handle]
    for axes, (label, lines) in zip(rows, panels, strict=True):
        for mark in marks:
            axes.axvline(mark, color="0.75", linewidth=0.8, zorder=0)
        for i, (name, values) in enumerate(lines.items()):
            axes.plot(times, values, color=COLORS[i], linewidth=1.3, label=name or None)
        axes.set_ylabel(label)
        _tidy(axes)
        if len(lines) > 1:
            axes.legend(frameon=False, ncols=len(lines), fontsize="small", loc="upper right")
    title = handle.name + (" (grey: its events)" if marks else "")
    rows[0].set_title(title, loc="left", fontsize="medium")
    rows[-1].set_xlabel("time [s]")
    figure.align_ylabels()
    write_figure(figure, path, "Trajectory.plot", "a body comes after it, as in plot(None, handle)", dpi=150)
    return figure


def _figure_class() -> Any:
    try:
        # not pyplot: no window, no global list of figures
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError('figures need matplotlib: pip install "rbdyn[plot]"') from error
    return Figure


def _tidy(axes: Any) -> None:
    axes.grid(True, color="0.92", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
