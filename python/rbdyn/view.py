"""Motions in space as one HTML file that needs no network, with plotly, which brings its renderer along."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn.destinations import PAGES, place_of
from rbdyn.drawing import FRAMES_A_SECOND, Array, Drawing, drawing_of
from rbdyn.errors import InvalidInput
from rbdyn.plots import COLORS

if TYPE_CHECKING:
    from rbdyn._core import Trajectory

KINDS = {"force": COLORS[2], "reaction": COLORS[1], "contact": COLORS[3]}
SPEEDS = (1.0, 0.25, 0.5, 2.0, 4.0)
# the longest edge of the box that all is in, as the camera takes lengths
STAGE = 1.1
# of numbers that only pictures are made of
DIGITS = 6


def view(
    self: Trajectory,
    path: str | os.PathLike[str] | None = None,
    *,
    fps: float = FRAMES_A_SECOND,
    speed: float | None = None,
) -> Any:
    """
    The motion in space, to be turned, played and scrubbed: one HTML file that needs no network, if `path` is given.

    Shows bodies, rails, springs, what contacts are with, forces, reactions and forces of contacts as arrows of one
    scale, and the events on a line of time. Bodies are drawn as what touches of them, or as the box or ball of their
    inertia.

    fps: frames a second of playing. speed: seconds of motion in one of playing; by default 1, but for what is shorter
    than 4 s or longer than 24 s: it is played in that time. There are at most 600 frames, uniform in time.

    Returns the plotly figure, which notebooks show. Raises ImportError if plotly is missing, InvalidInput for a run
    without length, another suffix than .html or .htm, and where the system refuses.
    """
    try:
        import plotly.graph_objects as graph  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError as error:
        raise ImportError('views need plotly: pip install "rbdyn[view]"') from error
    if path is not None and place_of(path, "view").suffix.lower() not in PAGES:
        raise InvalidInput(
            f"view: {os.fspath(path)!r} is neither .html nor .htm; name one that ends so; .gif and .mp4 are animate()'s"
        )
    drawing = drawing_of(self, "view", fps, speed)
    data, moving = _traces(drawing)
    frames = [
        {
            "name": str(k),
            "data": _moved(drawing, k),
            "traces": moving,
            "layout": {"title": {"text": _title(drawing, k)}},
        }
        for k in range(len(drawing.times))
    ]
    figure = graph.Figure(data=data, layout=_layout(drawing), frames=frames)
    if path is not None:
        text = figure.to_html(include_plotlyjs=True, full_html=True, auto_play=False, post_script=_LET_GO)
        try:
            Path(path).write_text(text, encoding="utf-8")
        except OSError as problem:
            raise InvalidInput(f"view: {os.fspath(path)!r} cannot be written: {problem.strerror}") from None
    return figure


# plotly takes a slider that was dragged for one that still is: it would stand still while the motion is played
_LET_GO = """
const view = document.getElementById("{plot_id}");
view.on("plotly_sliderend", () => requestAnimationFrame(() => {
    for (const slider of view._fullLayout.sliders) slider._dragging = false;
}));
"""


def _traces(drawing: Drawing) -> tuple[list[dict[str, Any]], list[int]]:
    """All traces, as at the first frame, and the indices of those that move: in the order of _moved()."""
    data: list[dict[str, Any]] = []
    for name, outline in drawing.obstacles:
        data.append(
            {
                "type": "mesh3d",
                "name": name,
                **_xyz(outline.vertices),
                **dict(zip("ijk", outline.triangles.T.tolist(), strict=True)),
                "color": "#888888",
                "opacity": 0.25,
                "hoverinfo": "name",
            }
        )
    for i, solid in enumerate(drawing.solids):
        style = {"color": COLORS[i % len(COLORS)], "width": 1}
        data.append({**_line(f"path of {solid.name}", solid.positions, style), "opacity": 0.6})
    data += [
        _line(rail.name, rail.points[0], {"color": "#888888", "width": 4}) for rail in drawing.rails if _rests(rail)
    ]
    names = [event for _, event in drawing.events]
    data.append(
        {
            "type": "scatter",
            "name": "events",
            "x": [time for time, _ in drawing.events],
            "y": [0.0] * len(names),
            "text": names,
            "mode": "markers",
            "marker": {"color": COLORS[1], "symbol": "diamond-tall", "size": 10},
            "hovertemplate": "%{text}<br>t = %{x} s<extra></extra>",
            "showlegend": False,
        }
    )
    first = len(data)
    looks: list[dict[str, Any]] = [
        {
            "type": "scatter3d",
            "name": "bodies",
            "mode": "markers",
            "text": [solid.name for solid in drawing.solids],
            "marker": {
                "size": [3 if solid.outline is not None else 6 for solid in drawing.solids],
                "color": [COLORS[i % len(COLORS)] for i in range(len(drawing.solids))],
            },
            "hovertemplate": "%{text}<br>%{x:.6g}, %{y:.6g}, %{z:.6g} m<extra></extra>",
        }
    ]
    for i, solid in enumerate(drawing.solids):
        if solid.outline is not None:
            looks.append(
                {
                    "type": "mesh3d",
                    "name": solid.name,
                    **dict(zip("ijk", solid.outline.triangles.T.tolist(), strict=True)),
                    "color": COLORS[i % len(COLORS)],
                    "opacity": 0.7,
                    "flatshading": True,
                    "showlegend": True,
                    "hoverinfo": "name",
                }
            )
    looks += [_line(rail.name, None, {"color": "#888888", "width": 4}) for rail in drawing.rails if not _rests(rail)]
    looks += [_line(spring.name, None, {"color": COLORS[4], "width": 5}) for spring in drawing.springs]
    for kind, color in _kinds(drawing).items():
        arrow = _line(_LABELS[kind], None, {"color": color, "width": 5})
        # the tips are marked
        looks.append({**arrow, "mode": "lines+markers", "marker": {"color": color, "symbol": "diamond"}})
    looks.append({"type": "scatter", "name": "now", "mode": "lines", "line": {"color": "#000000"}, "showlegend": False})
    data += [{**look, **now} for look, now in zip(looks, _moved(drawing, 0), strict=True)]
    return data, list(range(first, len(data)))


_LABELS = {"force": "forces", "reaction": "reactions", "contact": "forces of contacts"}


def _kinds(drawing: Drawing) -> dict[str, str]:
    return {kind: color for kind, color in KINDS.items() if any(one.kind == kind for one in drawing.arrows)}


def _moved(drawing: Drawing, frame: int) -> list[dict[str, Any]]:
    """What of the moving traces is new in a frame."""
    places = np.array([solid.positions[frame] for solid in drawing.solids])
    # to all digits: where bodies are is read from a picture
    moved: list[dict[str, Any]] = [{"type": "scatter3d", **_xyz(places, digits=None)}]
    for solid in drawing.solids:
        if solid.outline is not None:
            moved.append({"type": "mesh3d", **_xyz(solid.vertices(frame))})
    for line in [*(rail for rail in drawing.rails if not _rests(rail)), *drawing.springs]:
        moved.append({"type": "scatter3d", **_xyz(line.points[frame])})
    for kind in _kinds(drawing):
        feet, tips = drawing.arrow_tips(kind, frame)
        # foot, tip, and nothing, so that they are not joined
        rows = np.stack([feet, tips, np.full_like(feet, np.nan)], axis=1).reshape(-1, 3)
        moved.append({"type": "scatter3d", **_xyz(rows), "marker": {"size": [0, 4, 0] * len(feet)}})
    now = float(drawing.times[frame])
    moved.append({"type": "scatter", "x": [now, now], "y": [-1, 1]})
    return moved


def _rests(rail: Any) -> bool:
    return len(rail.points) == 1


def _line(name: str, points: Array | None, style: dict[str, Any]) -> dict[str, Any]:
    return {
        "type": "scatter3d",
        "name": name,
        "mode": "lines",
        "line": style,
        "hoverinfo": "name",
        **({} if points is None else _xyz(points)),
    }


def _xyz(points: Array, digits: int | None = DIGITS) -> dict[str, list[float | None]]:
    """Coordinates as lists, with None for what is nowhere."""

    def number(x: float) -> float | None:
        return None if not np.isfinite(x) else x if digits is None else float(f"{x:.{digits}g}")

    return {axis: [number(x) for x in column] for axis, column in zip("xyz", points.T.tolist(), strict=True)}


def _title(drawing: Drawing, frame: int) -> str:
    last = drawing.last_event(frame)
    return f"t = {drawing.times[frame]:.6g} s" + (f"; last event: {last}" if last else "")


def _layout(drawing: Drawing) -> dict[str, Any]:
    flat = drawing.flat_axis()
    eye = {"x": 1.3, "y": -1.6, "z": 0.7}
    up = {"x": 0, "y": 0, "z": 1}
    if flat is not None:
        # a motion in a plane is looked at from before it
        eye = {"x": 0.0, "y": 0.0, "z": 0.0, "xyz"[flat]: (2.0, -2.0, 2.0)[flat]}
        up = {"x": 0, "y": int(flat == 2), "z": int(flat != 2)}
    axes = {
        f"{axis}axis": {"range": [float(low), float(high)], "title": {"text": f"{axis} [m]"}, "autorange": False}
        for axis, low, high in zip("xyz", drawing.low, drawing.high, strict=True)
    }
    spans = (drawing.high - drawing.low) / drawing.size
    ratio = {axis: STAGE * float(span) for axis, span in zip("xyz", spans, strict=True)}
    camera: dict[str, Any] = {"eye": eye, "up": up}
    if flat is not None:
        camera["projection"] = {"type": "orthographic"}
    notes = [f"{drawing.speed:.3g} s of motion a second"]
    if drawing.newton > 0:
        notes.append(f"longest arrow {_longest(drawing):.4g} N")
    return {
        "title": {"text": _title(drawing, 0), "font": {"size": 14}},
        "scene": {"domain": {"y": [0.14, 1]}, "aspectmode": "manual", "aspectratio": ratio, "camera": camera, **axes},
        "xaxis": {"range": [float(drawing.times[0]), float(drawing.times[-1])], "title": {"text": "t [s]"}},
        "yaxis": {"domain": [0.0, 0.06], "visible": False, "range": [-1, 1], "fixedrange": True},
        "margin": {"l": 40, "r": 20, "t": 40, "b": 180},
        "uirevision": "kept",
        "annotations": [
            {
                "text": "; ".join(notes + drawing.notes),
                "showarrow": False,
                "xref": "paper",
                "yref": "paper",
                "x": 0,
                "y": 1.0,
                "xanchor": "left",
            }
        ],
        "updatemenus": [_buttons(drawing)],
        "sliders": [_slider(drawing)],
    }


def _longest(drawing: Drawing) -> float:
    return max(float(np.nanmax(np.linalg.norm(one.vectors, axis=1), initial=0.0)) for one in drawing.arrows)


def _playing(milliseconds: float) -> dict[str, Any]:
    timing = {"duration": milliseconds, "redraw": True}
    return {"mode": "immediate", "fromcurrent": True, "frame": timing, "transition": {"duration": 0}}


def _buttons(drawing: Drawing) -> dict[str, Any]:
    buttons: list[dict[str, Any]] = [
        {
            "label": "play" if factor == 1 else f"x {factor:g}",
            "method": "animate",
            "args": [None, _playing(1000 * drawing.interval / factor)],
        }
        for factor in SPEEDS
    ]
    buttons.insert(1, {"label": "pause", "method": "animate", "args": [[None], _playing(0)]})
    place = {"x": 0, "y": 0, "xanchor": "left", "yanchor": "top", "pad": {"t": 48}}
    return {"type": "buttons", "direction": "right", "showactive": False, "buttons": buttons, **place}


def _slider(drawing: Drawing) -> dict[str, Any]:
    steps = [
        {"label": f"{time:.5g}", "method": "animate", "args": [[str(k)], _playing(0)]}
        for k, time in enumerate(drawing.times)
    ]
    shown = {"prefix": "t = ", "suffix": " s", "visible": True, "xanchor": "right"}
    return {"steps": steps, "currentvalue": shown, "x": 0, "len": 1, "y": 0, "pad": {"t": 86}}
