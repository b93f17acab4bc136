"""Motions as GIF or MP4, with matplotlib."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn.destinations import place_of
from rbdyn.drawing import FRAMES_A_SECOND, Drawing, drawing_of
from rbdyn.errors import InvalidInput
from rbdyn.plots import COLORS

if TYPE_CHECKING:
    from rbdyn._core import Trajectory

KINDS = {"force": COLORS[2], "reaction": COLORS[1], "contact": COLORS[3]}


def animate(
    self: Trajectory, path: str | os.PathLike[str], *, fps: float = FRAMES_A_SECOND, speed: float | None = None
) -> None:
    """
    Writes the motion as pictures that follow each other, a .gif, or an .mp4, which needs ffmpeg.

    fps: frames a second of playing. speed: seconds of motion in one of playing; by default 1, but for what is shorter
    than 4 s or longer than 24 s: it is played in that time. There are at most 600 frames, uniform in time. Bodies are
    drawn as what touches of them, or as the box or ball of their inertia.

    Raises ImportError if matplotlib is missing, InvalidInput for another suffix, a run without length, and where the
    system refuses.
    """
    try:
        from matplotlib.animation import FFMpegWriter, PillowWriter
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError('animations need matplotlib: pip install "rbdyn[plot]"') from error
    writers: dict[str, Any] = {".gif": PillowWriter, ".mp4": FFMpegWriter}
    writer_class = writers.get(place_of(path, "animate").suffix.lower())
    if writer_class is None:
        raise InvalidInput(f"animate: {os.fspath(path)!r} is neither .gif nor .mp4; name one that ends so")
    if not writer_class.isAvailable():
        raise InvalidInput(f"animate: {os.fspath(path)!r} needs ffmpeg, which is not installed; write a .gif")
    drawing = drawing_of(self, "animate", fps, speed)
    figure = Figure(figsize=(6.4, 5.6), layout="constrained")
    stage = _Stage(figure, drawing)
    writer = writer_class(fps=1 / drawing.interval)
    try:
        with writer.saving(figure, os.fspath(path), dpi=80):
            for frame in range(len(drawing.times)):
                stage.show(frame)
                writer.grab_frame()
    except OSError as problem:
        raise InvalidInput(f"animate: {os.fspath(path)!r} cannot be written: {problem.strerror or problem}") from None


class _Stage:
    """The axes of an animation, and what moves in them."""

    def __init__(self, figure: Any, drawing: Drawing) -> None:
        from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # type: ignore[import-untyped,unused-ignore]

        self.drawing = drawing
        self.axes = axes = figure.add_subplot(projection="3d")
        half = drawing.size / 2
        middle = (drawing.low + drawing.high) / 2
        axes.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
        axes.set(zlim=(middle[2] - half, middle[2] + half), xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
        axes.set_box_aspect((1, 1, 1))
        flat = drawing.flat_axis()
        if flat is not None:
            # a motion in a plane is looked at from before it
            axes.set_proj_type("ortho")
            axes.view_init(elev=90 if flat == 2 else 0, azim=(0, -90, -90)[flat])
        for _, outline in drawing.obstacles:
            faces = outline.vertices[outline.triangles]
            axes.add_collection3d(Poly3DCollection(faces, facecolor="0.6", alpha=0.2))
        self.lines = [*drawing.rails, *drawing.springs]
        colors = ["0.5"] * len(drawing.rails) + [COLORS[4]] * len(drawing.springs)
        self.drawn = [axes.plot([], [], [], color=color, linewidth=1.2)[0] for color in colors]
        self.dots, self.meshes = [], []
        for i, solid in enumerate(drawing.solids):
            color = COLORS[i % len(COLORS)]
            axes.plot(*solid.positions.T, color=color, linewidth=0.5, alpha=0.5)
            self.dots.append(axes.plot([], [], [], "o", color=color, markersize=6 if solid.outline is None else 2)[0])
            mesh = None
            if solid.outline is not None:
                mesh = Poly3DCollection([np.zeros((3, 3))], facecolor=color, edgecolor="0.2", linewidth=0.2, alpha=0.6)
                axes.add_collection3d(mesh)
            self.meshes.append(mesh)
        self.arrows = {}
        for kind, color in KINDS.items():
            self.arrows[kind] = axes.add_collection3d(Line3DCollection([np.zeros((2, 3))], color=color, linewidth=1.6))

    def show(self, frame: int) -> None:
        """Moves everything to a frame."""
        drawing = self.drawing
        for line, drawn in zip(self.lines, self.drawn, strict=True):
            drawn.set_data_3d(*line.points[min(frame, len(line.points) - 1)].T)
        for solid, dot, mesh in zip(drawing.solids, self.dots, self.meshes, strict=True):
            dot.set_data_3d(*solid.positions[frame : frame + 1].T)
            if mesh is not None and solid.outline is not None:
                mesh.set_verts(solid.vertices(frame)[solid.outline.triangles])
        for kind, collection in self.arrows.items():
            feet, tips = drawing.arrow_tips(kind, frame)
            kept = np.isfinite(tips).all(axis=1)
            collection.set_segments(np.stack([feet[kept], tips[kept]], axis=1))
        last = drawing.last_event(frame)
        title = f"t = {drawing.times[frame]:.6g} s" + (f"; last event: {last}" if last else "")
        self.axes.set_title(title, fontsize="small")
