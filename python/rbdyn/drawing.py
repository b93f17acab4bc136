"""What is seen of a run: its bodies, rails, springs, obstacles, forces and events, at the times of a picture's frames.

Bodies have no shape, only an inertia: they are drawn as what touches others of them, where their contacts say it, else
as the uniform box of the same inertia, or ball. What there is comes from the run's scene as a file has it, how it moves
from the run.
"""

from __future__ import annotations

import bisect
import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rbdyn import _core, outlines
from rbdyn.errors import InvalidInput
from rbdyn.outlines import Outline
from rbdyn.recorded import evaluated
from rbdyn.shown import shown

if TYPE_CHECKING:
    from rbdyn._core import BodyHandle, Curve, Trajectory

Array = npt.NDArray[np.float64]

# frames of one picture, how many are played in a second, and the least time that is played [s]
MOST_FRAMES, FRAMES_A_SECOND, SHORTEST = 600, 25.0, 4.0
# points of a rail, at least, and at most where it winds
POINTS, MOST_POINTS = 200, 4000
# the longest arrow, and what is drawn of planes, relative to the size of all
ARROW, PATCH = 0.25, 0.75
CURVES: dict[str, Any] = {
    "line": _core.Line,
    "circle": _core.Circle,
    "parabola": _core.Parabola,
    "cycloid": _core.Cycloid,
    "helix": _core.Helix,
    "polynomial": _core.Polynomial,
    "spline": _core.Spline,
}


@dataclass
class Solid:
    """A body: positions (n, 3), of the centre of mass of a rigid one, its origins (n, 3) and attitudes (n, 3, 3)."""

    name: str
    positions: Array
    origins: Array
    attitudes: Array | None = None
    outline: Outline | None = None

    def vertices(self, frame: int) -> Array:
        """Of its outline, in the world (m, 3)."""
        assert self.outline is not None and self.attitudes is not None
        return np.asarray(self.origins[frame] + self.outline.vertices @ self.attitudes[frame].T)


@dataclass
class Polyline:
    """A rail or a spring: points (n, m, 3) at n frames, or (1, m, 3) of what is at rest."""

    name: str
    points: Array


@dataclass
class Arrows:
    """Forces of one kind, as vectors (n, 3) [N] from feet (n, 3) [m]."""

    kind: str
    name: str
    feet: Array
    vectors: Array


@dataclass
class Drawing:
    """What is seen, at `times` (n,) [s]; `interval` is the time from frame to frame as it is played [s]."""

    times: Array
    interval: float
    solids: list[Solid] = field(default_factory=list)
    rails: list[Polyline] = field(default_factory=list)
    springs: list[Polyline] = field(default_factory=list)
    obstacles: list[tuple[str, Outline]] = field(default_factory=list)
    arrows: list[Arrows] = field(default_factory=list)
    events: list[tuple[float, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    low: Array = field(default_factory=lambda: np.zeros(3))
    high: Array = field(default_factory=lambda: np.ones(3))
    newton: float = 0.0  # the length at which 1 N is drawn [m]

    @property
    def size(self) -> float:
        """The longest edge of the box that all is in [m]."""
        return float((self.high - self.low).max())

    @property
    def speed(self) -> float:
        """Seconds of motion in a second of playing."""
        return float((self.times[1] - self.times[0]) / self.interval)

    def arrow_tips(self, kind: str, frame: int) -> tuple[Array, Array]:
        """Feet and tips (k, 3) [m] of the arrows of a kind."""
        chosen = [one for one in self.arrows if one.kind == kind]
        feet = np.array([one.feet[frame] for one in chosen]).reshape(-1, 3)
        vectors = np.array([one.vectors[frame] for one in chosen]).reshape(-1, 3)
        return feet, feet + self.newton * vectors

    def last_event(self, frame: int) -> str:
        """What happened last before a frame, or at it; empty if nothing has."""
        past = bisect.bisect_right(self.events, self.times[frame], key=lambda event: event[0])
        return self.events[past - 1][1] if past else ""

    def flat_axis(self) -> int | None:
        """The axis of the world that all motion is across: the one to look along."""
        spans = np.ptp(np.vstack([one.positions for one in self.solids]), axis=0)
        axis = int(np.argmin(spans))
        return axis if spans[axis] <= 1e-9 * spans.max() and np.sum(spans > 1e-9 * spans.max()) == 2 else None


def drawing_of(run: Trajectory, what: str, fps: float, speed: float | None) -> Drawing:
    """All that is seen of a run, at uniform times. Raises InvalidInput in the name of `what`."""
    times, interval = frames_of(run, what, fps, speed)
    try:
        run[run.bodies[0]].position(times)
    except InvalidInput as problem:
        # what says so names a time, and no way out
        raise InvalidInput(f'{what}: {problem}; a run of keep="end" has no pictures, one of keep="all" has') from None
    drawing = Drawing(times, interval)
    try:
        scene = run.__getstate__()[0]
        contents = json.loads(scene.__getstate__()[0])
    except TypeError:
        scene, contents = None, {}
        drawing.notes.append("a function of the scene is called back: only where the bodies are is known")
    _Reader(run, scene, contents, drawing).read()
    drawing.events = [(event.time, f"{event.kind}: {event.name}" if event.name else event.kind) for event in run.events]
    _measure(drawing)
    return drawing


def frames_of(run: Trajectory, what: str, fps: float, speed: float | None) -> tuple[Array, float]:
    """Times (n,) of the frames [s], and the time between two as they are played [s]."""
    for name, number in (("fps", fps), ("speed", speed)):
        if number is not None and not (isinstance(number, (int, float)) and 0 < number < np.inf):
            raise InvalidInput(f"{what}: {name} is {shown(number)}; it is a positive number")
    span = run.end - run.start
    if not span > 0:
        raise InvalidInput(f"{what}: the run has no length, its end is its start, {run.start:g} s; run it for a while")
    # long motions are shown quicker, and short ones slower, than they are
    longest = MOST_FRAMES / FRAMES_A_SECOND
    playing = span / speed if speed else min(max(span, SHORTEST), longest)
    count = int(min(max(round(playing * fps) + 1, 2), MOST_FRAMES))
    return np.linspace(run.start, run.end, count), playing / (count - 1)


class _Reader:
    """Finds in a scene's file what is to be seen."""

    def __init__(self, run: Trajectory, scene: Any, contents: dict[str, Any], drawing: Drawing) -> None:
        self.run, self.scene, self.drawing, self.times = run, scene, drawing, drawing.times
        self.parameters = [float(one["value"]) for one in contents.get("parameters", [])]
        self.contents = self.plain(contents)
        self.handles: dict[str, BodyHandle] = {handle.name: handle for handle in run.bodies}

    def plain(self, value: Any) -> Any:
        """Numbers in place of references to parameters and of words."""
        if isinstance(value, dict):
            if set(value) == {"parameter"} and isinstance(value["parameter"], int):
                return self.parameters[value["parameter"]]
            return {key: self.plain(one) for key, one in value.items()}
        if isinstance(value, list):
            return [self.plain(one) for one in value]
        return float(value) if value in ("inf", "-inf") else value

    def read(self) -> None:
        bodies = self.contents.get("bodies", [{} for _ in self.run.bodies])
        for handle, body in zip(self.run.bodies, bodies, strict=True):
            self.add_body(handle, body)
        for number, coupling in enumerate(self.contents.get("couplings", []), start=1):
            if coupling["kind"] == "spring":
                ends = [self.place(coupling[end]) for end in "ab"]
                self.drawing.springs.append(Polyline(f"spring {number}", np.stack(ends, axis=1)))
        for i, contact in enumerate(self.contents.get("contacts", [])):
            self.add_contact(contact, self.scene.contacts[i])
        for i, constraint in enumerate(self.contents.get("constraints", [])):
            handle = self.scene.constraints[i]
            force = self.run[handle].force(self.times)
            self.drawing.arrows.append(Arrows("reaction", handle.name, self.place(constraint["a"]), force))
        for solid, body in zip(self.drawing.solids, bodies, strict=True):
            if solid.outline is None and body.get("body", {}).get("kind") == "rigid body":
                solid.outline = outlines.of_inertia(_rigid_body(body["body"]))

    def add_body(self, handle: BodyHandle, body: dict[str, Any]) -> None:
        motion, times = self.run[handle], self.times
        origins = motion.position(times)
        if "quaternion" in motion.quantities:
            center = motion.center_of_mass(times)
            solid = Solid(handle.name, center, origins, motion.rotation_matrix(times))
        else:
            solid = Solid(handle.name, origins, origins)
        self.drawing.solids.append(solid)
        joint = body.get("joint", {})
        if "force" in motion.quantities:
            self.drawing.arrows.append(Arrows("force", handle.name, solid.positions, motion.force(times)))
        if "reaction" in motion.quantities:
            feet = solid.origins
            if "point" in joint and solid.attitudes is not None:
                feet = motion.point(joint["point"], times)[0]
            self.drawing.arrows.append(Arrows("reaction", handle.name, feet, motion.reaction(times)))
        if joint.get("kind") == "rail":
            self.add_rail(handle, joint)

    def add_rail(self, handle: BodyHandle, joint: dict[str, Any]) -> None:
        curve = joint["curve"]
        own = curve["kind"] == "curve"
        made = None if own else _curve(curve)
        first, last = made.domain if made is not None else curve.get("domain", (-np.inf, np.inf))
        along = self.run[handle].parameter(self.times)
        along = along[np.isfinite(along)]
        if not np.isfinite([first, last]).all() and len(along):
            # one without ends: as far as the body goes, and a bit further
            margin = max(0.1 * float(np.ptp(along)), 0.1)
            first, last = max(first, along.min() - margin), min(last, along.max() + margin)
        if made is not None and made.closed:
            # all of it, however far the body goes
            first, last = 0.0, len(made.points) if isinstance(made, _core.Spline) else 2 * np.pi
        turns = (last - first) / (2 * np.pi) if curve["kind"] in ("helix", "cycloid") else 1.0
        u = np.linspace(first, last, int(min(max(POINTS * turns, POINTS), MOST_POINTS)))
        points = made.position(u) if made is not None else evaluated(curve["function"], self.parameters, u)
        placed = points[None]
        if "motion" in joint:
            frame = evaluated(joint["motion"], self.parameters, self.times)
            placed = points @ frame[:, :9].reshape(-1, 3, 3).transpose(0, 2, 1) + frame[:, None, 9:]
        self.drawing.rails.append(Polyline(f"rail of {handle.name}", placed))

    def add_contact(self, contact: dict[str, Any], handle: Any) -> None:
        a, b = contact["a"], contact["b"]
        feet = self.place(a, a.get("center", [0.0, 0.0, 0.0]))
        if a["kind"] == "body sphere" and b["kind"] == "plane":
            feet = feet - a["radius"] * np.asarray(b["normal"]) / np.linalg.norm(b["normal"])
        self.drawing.arrows.append(Arrows("contact", handle.name, feet, self.run[handle].force(self.times)))
        for end in (a, b):
            if "body" in end:
                self.add_part(end)
        if b["kind"] == "sphere":
            outline = outlines.ellipsoid(np.full(3, b["radius"]), b.get("center", (0, 0, 0)), around=32, up=16)
            self.drawing.obstacles.append((handle.name, outline))
        elif b["kind"] == "plane":
            # as large as the scene, which is not known yet: a square of the half edge 1
            outline = outlines.patch(1.0, b["normal"], b.get("point", (0, 0, 0)))
            if all(not _is_same(outline, other) for _, other in self.drawing.obstacles):
                self.drawing.obstacles.append((handle.name, outline))

    def add_part(self, end: dict[str, Any]) -> None:
        """What of a body touches."""
        center = end.get("center", (0.0, 0.0, 0.0))
        if end["kind"] == "body sphere":
            part = outlines.ellipsoid(np.full(3, end["radius"]), center)
        elif end["kind"] == "body disc":
            part = outlines.disc(end["radius"], end["normal"], center)
        elif end["kind"] == "body ellipsoid":
            part = outlines.ellipsoid(end["semi_axes"], center, _matrix(end.get("attitude")))
        else:
            return
        solid = next(one for one in self.drawing.solids if one.name == end["body"])
        if solid.attitudes is not None:
            solid.outline = part if solid.outline is None else solid.outline + part

    def place(self, end: dict[str, Any], default: Any = None) -> Array:
        """Where an end is, in the world (n, 3)."""
        if "body" not in end:
            return np.broadcast_to(np.asarray(end["point"], float), (len(self.times), 3))
        motion = self.run[self.handles[end["body"]]]
        point = end.get("point", default)
        if "quaternion" not in motion.quantities:
            return motion.position(self.times)
        return motion.center_of_mass(self.times) if point is None else motion.point(point, self.times)[0]


def _rigid_body(body: dict[str, Any]) -> _core.RigidBody:
    inertia = [[one[0] if isinstance(one, list) else one for one in row] for row in body["inertia"]]
    com = [one[0] if isinstance(one, list) else one for one in body.get("com", [0.0, 0.0, 0.0])]
    mass = body["mass"][0] if isinstance(body["mass"], list) else body["mass"]
    return _core.RigidBody(mass, inertia, com=com, inertia_about=body.get("inertia_about", "com"))


def _curve(curve: dict[str, Any]) -> Curve:
    given = {name: value for name, value in curve.items() if name != "kind"}
    if "slopes" in given:
        given["slopes"] = {int(index): slope for index, slope in dict(given["slopes"]).items()}
    if "domain" in given:
        given["domain"] = tuple(given["domain"])
    made: Curve = CURVES[curve["kind"]](**given)
    return made


def _matrix(attitude: Any) -> Array | None:
    """A rotation matrix of a quaternion [w, x, y, z] or of Euler's angles, as files have attitudes."""
    if attitude is None:
        return None
    if isinstance(attitude, dict):
        angles = _core.EulerAngles(**{name: attitude.get(name, 0.0) for name in ("theta", "psi", "phi")})
        return np.asarray(angles.rotation_matrix)
    w, x, y, z = np.asarray(attitude, float) / np.linalg.norm(attitude)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + 2 * w * cross + 2 * cross @ cross)


def _is_same(a: Outline, b: Outline) -> bool:
    return a.vertices.shape == b.vertices.shape and np.array_equal(a.vertices, b.vertices)


def _measure(drawing: Drawing) -> None:
    """The box that all is in, the planes as large as it, and the scale of the arrows."""
    seen = [solid.positions for solid in drawing.solids]
    for solid in drawing.solids:
        if solid.outline is not None:
            seen += [solid.vertices(frame) for frame in range(0, len(drawing.times), 1 + len(drawing.times) // 50)]
    seen += [line.points.reshape(-1, 3) for line in [*drawing.rails, *drawing.springs]]
    seen += [outline.vertices for _, outline in drawing.obstacles if len(outline.vertices) != 4]
    points = np.vstack(seen)
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        raise InvalidInput("a picture: no body is at a finite place; look at run.status")
    low, high = points.min(axis=0), points.max(axis=0)
    half = PATCH * float((high - low).max() or 1.0)
    middle = (low + high) / 2
    for _, outline in drawing.obstacles:
        if len(outline.vertices) == 4:
            center = outline.vertices.mean(axis=0)
            normal = np.cross(outline.vertices[1] - outline.vertices[0], outline.vertices[3] - outline.vertices[0])
            normal /= np.linalg.norm(normal)
            below = middle - normal * (normal @ (middle - center))
            outline.vertices = below + half * (outline.vertices - center)
            low, high = np.minimum(low, below), np.maximum(high, below)
    largest = max(
        (float(np.nanmax(np.linalg.norm(one.vectors, axis=1), initial=0.0)) for one in drawing.arrows), default=0
    )
    size = float((high - low).max() or 1.0)
    drawing.newton = ARROW * size / largest if 0 < largest < np.inf else 0.0
    margin = 0.5 * max(size, 1e-300) * 0.1
    drawing.low, drawing.high = low - margin, high + margin
