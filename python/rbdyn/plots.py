"""Figures of prices, and what all figures share, with matplotlib."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn.destinations import write_figure

if TYPE_CHECKING:
    from rbdyn._core import CostRow, Price

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
