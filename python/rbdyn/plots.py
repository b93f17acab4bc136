"""Figures of runs and prices, with matplotlib."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn._core import BodyHandle
from rbdyn.errors import InvalidInput

if TYPE_CHECKING:
    from rbdyn._core import Price, Trajectory

# Okabe and Ito: told apart by every kind of colour vision, in print too
COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKERS = "osD^vP*"
# points of a curve: more than a figure has pixels across
POINTS = 2000


def plot_price(price: Price, path: str | os.PathLike[str] | None = None) -> Any:
    """The work-precision diagram: seconds over achieved error, a line an engine."""
    figure_class = _figure_class()
    figure = figure_class(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.add_subplot()
    engines = list(dict.fromkeys(row.engine for row in price))
    for i, engine in enumerate(engines):
        # a row whose events differ from those of the most accurate run has no finite error
        rows = [row for row in price if row.engine == engine and np.isfinite(row.error) and row.error > 0]
        rows.sort(key=lambda row: row.tolerance)
        axes.loglog(
            [row.error for row in rows],
            [row.seconds for row in rows],
            color=COLORS[i % len(COLORS)],
            marker=MARKERS[i % len(MARKERS)],
            markersize=5,
            label=engine,
        )
    axes.set_xlabel("achieved error, relative")
    axes.set_ylabel("time [s]")
    axes.invert_xaxis()
    _tidy(axes)
    if engines:
        axes.legend(frameon=False)
    if path is not None:
        figure.savefig(path, dpi=150)
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
    if path is not None:
        figure.savefig(path, dpi=150)
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
