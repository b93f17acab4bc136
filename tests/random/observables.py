"""Every observable of scenes at random against finite differences and the laws of motion written again.

    python tests/random/observables.py [count] [seed]

A scene has up to three bodies on any joint, with loads, springs, friction, rails that move, let go or only push, and
forces with jumps. Asked of its run: that every velocity is the slope of its position, every acceleration that of its
velocity, m a = F + reaction, I alpha + omega x I omega = torques, dT/dt = power, energies, momenta, work = integral of
the power, frames against each other, Euler angles against the path of the attitude; inside of the motion and on both
sides of every event; and that what a run keeps has no influence on it. Slopes are of fifth order and say how good they
are. Prints what disagrees, and how much was compared.
"""

from __future__ import annotations

import sys
import warnings
from collections import Counter

import numpy as np
import rbdyn as rb
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

H = 1e-3  # s, of slopes; times of the scenes are of the order of one
TOLERANCE = 3e-6  # of the largest size of a quantity, for what is compared with a slope: H^4 of motions of some rad/s
ROUNDING = 1e-9  # for what is compared with formulas at one state, a thousand times the error of the runs
ERROR = 1e-12


def cross(a, b):
    return np.cross(a, b)


# --- loads: as the library gets them, and written again ---


class Load:
    """A load; force(t, r, v) again, world axes, and whether it jumps where sign_of(t, r, v) = 0."""

    jump = None  # (argument, largest size) of a force with a sign in it

    def __init__(self, load, force=None, torque=None, at=None, potential=None):
        self.load, self.force, self.torque, self.at, self.potential = load, force, torque, at, potential


def random_load(rng, rigid, hinge):
    """A load for a particle or a rigid body, drawn at random."""
    vector = rng.normal(size=3)
    at = rng.normal(size=3) * 0.3 if rigid and rng.random() < 0.5 else None
    kinds = ["constant", "wave", "drag", "quadratic", "lorentz", "potential", "sign", "where", "field", "nested"]
    if rigid:
        kinds += ["body force", "torque", "body torque", "own torque", "dry torque"]
    if hinge:
        kinds += ["torsion", "torsion"]
    kind = str(rng.choice(kinds))
    c = float(rng.uniform(0.1, 1.0))
    if kind == "constant":
        return Load(rb.Force(vector), lambda t, r, v: vector, at=at, potential=lambda r: vector @ r)
    if kind == "wave":
        return Load(rb.Force(lambda t, r, v: vector * np.sin(3 * t)), lambda t, r, v: vector * np.sin(3 * t), at=at)
    if kind == "drag":
        return Load(rb.Drag(linear=c), lambda t, r, v: -c * v, at=at)
    if kind == "quadratic":
        return Load(rb.Drag(c / 4, c / 4), lambda t, r, v: -c / 4 * (1 + np.linalg.norm(v)) * v, at=at)
    if kind == "lorentz":
        return Load(rb.Lorentz(c, vector), lambda t, r, v: c * cross(v, vector), at=at)
    if kind == "potential":
        law = rb.Potential(lambda r: -c * (r[0] ** 2 + 2 * r[1] ** 2) - 0.1 * r[2] ** 4)
        return Load(
            law,
            lambda t, r, v: np.array([-2 * c * r[0], -4 * c * r[1], -0.4 * r[2] ** 3]),
            at=at,
            potential=lambda r: -c * (r[0] ** 2 + 2 * r[1] ** 2) - 0.1 * r[2] ** 4,
        )
    if kind == "field":
        return Load(
            rb.Force(lambda t, r, v: [c * np.cos(r[1]), -c * r[0] * r[2], c * np.exp(-(r[0] ** 2))]),
            lambda t, r, v: np.array([c * np.cos(r[1]), -c * r[0] * r[2], c * np.exp(-(r[0] ** 2))]),
            at=at,
        )
    if kind in ("sign", "nested"):
        k = int(rng.integers(3))
        c *= 8  # enough to hold some of them
        unit = np.eye(3)[k]
        if kind == "sign":
            law = rb.Force(lambda t, r, v: [-c * np.sign(v[k]) * float(i == k) for i in range(3)])
        else:
            law = rb.Force(
                lambda t, r, v: [
                    np.where(v[k] > 0, -c * np.sign(v[k]), c * np.sign(-v[k])) * float(i == k) for i in range(3)
                ]
            )
        load = Load(law, lambda t, r, v: -c * np.sign(v[k]) * unit, at=at)
        load.jump = (lambda t, r, v: v[k], c)
        return load
    if kind == "where":
        k = int(rng.integers(3))
        load = Load(
            rb.Force(lambda t, r, v: [np.where(r[k] > 0.05, c, -2 * c) * x for x in vector]),
            lambda t, r, v: (c if r[k] > 0.05 else -2 * c) * vector,
            at=at,
        )
        load.jump = (lambda t, r, v: r[k] - 0.05, 2 * c * np.linalg.norm(vector))
        return load
    if kind == "body force":
        load = Load(rb.Force(vector, frame="body"), at=at)
        load.force = lambda t, r, v, R: R @ vector
        return load
    if kind == "torque":
        return Load(rb.Torque(vector, frame="world"), torque=lambda t, R, w: vector)
    if kind == "body torque":
        return Load(rb.Torque(vector), torque=lambda t, R, w: R @ vector)
    if kind == "own torque":
        return Load(
            rb.Torque(lambda t, R, w: -c * w + np.cos(2 * t) * vector),
            torque=lambda t, R, w: R @ (-c * w + np.cos(2 * t) * vector),
        )
    if kind == "dry torque":
        k = int(rng.integers(3))
        unit = np.eye(3)[k]
        load = Load(
            rb.Torque(lambda t, R, w: [-c * np.sign(w[k]) * float(i == k) for i in range(3)]),
            torque=lambda t, R, w: R @ (-c * np.sign(w[k]) * unit),
        )
        load.jump = (lambda t, R, w: w[k], c)
        return load
    rest, damping = float(rng.normal()), float(rng.choice([0.0, c]))
    load = Load(rb.TorsionSpring(3 * c, rest, damping))
    load.torsion = (3 * c, rest, damping)
    return load


# --- bodies ---


def random_curve(rng):
    """A curve and a parameter to start at."""
    kind = int(rng.integers(8))
    if kind == 0:
        return rb.Line(rng.normal(size=3), point=rng.normal(size=3)), 0.3
    if kind == 1:
        return rb.Circle(0.7, start=[0, 0, -1], toward=[1, 0, 0]), float(rng.uniform(-2, 2))
    if kind == 2:
        return rb.Parabola(0.8, x=[1, 0, 0], y=[0, 0, 1]), float(rng.uniform(-1, 1))
    if kind == 3:
        return rb.Cycloid(0.5, x=[1, 0, 0], y=[0, 0, 1]), float(rng.uniform(-1, 1))
    if kind == 4:
        return rb.Helix(0.6, 0.9, start=[1, 0, 0], toward=[0, 1, 0]), float(rng.uniform(-1, 1))
    if kind == 5:
        return rb.Polynomial([[0, 0, 0], [1, 0.2, 0], [0, 0.3, 0.5], [0, 0.1, 0.1]]), float(rng.uniform(-0.5, 0.5))
    if kind == 6:
        points = [[0, 0, 0.6], [0.7, 0.1, 0], [1.2, 0.6, -0.2], [2.0, 0.8, 0.3], [2.5, 0.2, 0.8]]
        return rb.Spline(points), 1.7
    return rb.Curve(lambda u: [u, np.sin(u), 0.2 * u**2], domain=(-6, 6)), float(rng.uniform(-1, 1))


class Rig:
    """A scene with what the test knows of it."""

    def __init__(self, seed):
        self.rng = rng = np.random.default_rng(seed)
        self.gravity = np.array([0, 0, -9.81]) if rng.random() < 0.6 else rng.normal(size=3) * rng.integers(0, 2)
        self.scene = rb.Scene(gravity=self.gravity)
        self.bodies, self.loads, self.springs = [], [], []
        for _ in range(int(rng.choice([1, 1, 2, 3]))):
            self.add_body()
        for index, body in enumerate(self.bodies):
            for _ in range(int(rng.choice([0, 1, 1, 2]))):
                load = random_load(rng, body["rigid"], body["joint"] == "revolute")
                load.body, load.handle = (
                    index,
                    self.scene.apply(load.load, body["handle"], **({} if load.at is None else {"at": load.at})),
                )
                self.loads.append(load)
        for index, body in enumerate(self.bodies):
            if rng.random() < 0.45:
                self.add_spring(index, body)

    def add_spring(self, index, body):
        rng = self.rng
        other = int(rng.integers(len(self.bodies)))
        place = rng.normal(size=3) * 0.3 if body["rigid"] else np.zeros(3)
        a = body["handle"].point(place) if body["rigid"] else body["handle"]
        k, rest, damping = rng.uniform(1, 20), rng.choice([0.0, 0.4]), rng.choice([0.0, 0.5])
        anchor = rng.normal(size=3) * 2
        if other == index:
            b, end = anchor, (None, anchor)
        else:
            b, end = self.bodies[other]["handle"], (other, None)
        law = rb.Spring(k, rest, damping)
        handle = self.scene.connect(law, a, b)
        self.springs.append({"handle": handle, "a": (index, place), "b": end, "law": (k, rest, damping)})

    def add_body(self):
        rng, name = self.rng, f"body {len(self.bodies) + 1}"
        joint = str(rng.choice(["free", "rail", "rail", "rail", "body", "ball", "revolute", "prismatic"]))
        if joint in ("free", "rail"):
            mass = float(rng.uniform(0.3, 2))
            body = {"mass": mass, "rigid": False, "joint": joint}
            if joint == "free":
                handle = self.scene.add(
                    rb.Particle(mass), name=name, position=rng.normal(size=3), velocity=rng.normal(size=3)
                )
            else:
                handle = self.add_bead(body, mass, name)
        else:
            moments = rng.uniform(0.5, 1.0, size=3)
            if rng.random() < 0.3:
                moments[1] = moments[0]
            mass, com = float(rng.uniform(0.5, 2)), rng.normal(size=3) * 0.2 * rng.integers(0, 2)
            law = rb.RigidBody(mass, moments, com=com)
            body = {"mass": mass, "rigid": True, "joint": joint, "com": com, "inertia": np.diag(moments)}
            axis = rng.normal(size=3)
            if rng.random() < 0.4:
                axis = np.eye(3)[int(rng.integers(3))]
            at, point = rng.normal(size=3), rng.normal(size=3) * 0.3
            start = {}
            if joint in ("body", "ball"):
                if rng.random() < 0.7:
                    start["attitude"] = rb.EulerAngles(*rng.normal(size=3))
                start["angular_velocity"] = rng.normal(size=3) * 2
            if joint == "body":
                law_joint = rb.Free()
                start |= {"position": rng.normal(size=3), "velocity": rng.normal(size=3)}
            elif joint == "ball":
                law_joint = rb.Spherical(at=at, point=point)
            elif joint == "revolute":
                law_joint = rb.Revolute(axis, at=at, point=point)
                start = {"angle": float(rng.normal()), "rate": float(rng.normal())}
            else:
                law_joint = rb.Prismatic(axis, at=at, point=point)
                start = {"displacement": float(rng.normal()), "rate": float(rng.normal())}
            body |= {"axis": axis / np.linalg.norm(axis), "at": at, "point": point}
            handle = self.scene.add(law, law_joint, name=name, **start)
        self.bodies.append(body | {"handle": handle, "name": name})

    def add_bead(self, body, mass, name):
        rng = self.rng
        curve, u = random_curve(rng)
        options = {}
        moves = rng.random() < 0.3
        one_sided = not moves and rng.random() < 0.25 and isinstance(curve, (rb.Circle, rb.Parabola, rb.Cycloid))
        if one_sided:
            options["side"] = str(rng.choice(["+", "-"]))
        if rng.random() < 0.45:
            static = float(rng.uniform(0.1, 0.6))
            options["friction"] = rb.Coulomb(static, static * float(rng.uniform(0.5, 1)))
            drive = float(rng.choice([0.0, 0.0, 0.6]))
            if drive and rng.random() < 0.5:
                options["drive"] = lambda t: drive * np.cos(2 * t)
                body["drive"] = lambda t: drive * np.cos(2 * t)
            elif drive:
                options["drive"] = drive
                body["drive"] = lambda t: drive
        if moves:
            axis, rate = rng.normal(size=3), float(rng.normal())
            axis /= np.linalg.norm(axis)
            shift = rng.normal(size=3) * 0.3
            k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
            if rng.random() < 0.3:
                rate = 0.0

            def matrix(t):
                s, c = np.sin(rate * t), np.cos(rate * t)
                return [[float(i == j) + s * k[i, j] + (1 - c) * (k @ k)[i, j] for j in range(3)] for i in range(3)]

            options["motion"] = lambda t: (np.array([x * np.sin(2 * t) for x in shift]), np.array(matrix(t)))
            body["motion"] = lambda t: (shift * np.sin(2 * t), np.array(matrix(t), dtype=float))
        begin, end = curve.domain
        if np.isfinite([begin, end]).all() and not curve.closed:
            options["ends"] = "release" if not moves else "stop"
        elif not moves and not one_sided and not curve.closed and rng.random() < 0.0:
            options["ends"] = "release"
        if rng.random() < 0.35 and not moves and not one_sided:
            # a short piece, so that the bead leaves it
            curve = rb.Curve(lambda s: [s, 0.3 * s**2, 0.5 * np.sin(s)], domain=(-0.8, 0.9))
            u, options["ends"] = 0.0, "release"
        rail = rb.Rail(curve, **options)
        body |= {"curve": curve, "friction": options.get("friction"), "moves": moves}
        return self.scene.add(rb.Particle(mass), rail, name=name, parameter=u, speed=float(rng.normal() * 2))


# --- the laws again ---


def place(body, t):
    """Displacement and rotation of a rail at a time."""
    return body["motion"](t) if "motion" in body else (np.zeros(3), np.eye(3))


class Check:
    """Compares, counts, and remembers what disagreed."""

    def __init__(self):
        self.compared, self.wrong, self.notes = Counter(), Counter(), []
        self.skipped = 0

    def __call__(self, name, got, want, scale, tolerance, slack=0.0, note=""):
        self.compared[name] += 1
        got, want = np.asarray(got, float), np.asarray(want, float)
        off = float(np.max(np.abs(got - want))) if got.size else 0.0
        if not off <= tolerance * scale + slack:
            self.wrong[name] += 1
            self.notes.append(f"{name}: {got} for {want}, off {off:.2g} of {scale:.2g} {note}")
            return False
        return True


CENTRAL = np.array([1, -8, 0, 8, -1]) / 12
FORWARD = np.array([-25, 48, -36, 16, -3]) / 12


def slope(f, t, side):
    """f'(t) and its doubt; side: 0 in the middle, +1 after t, -1 before it."""
    results = []
    for h in (H, H / 2):
        if side == 0:
            values = [f(t + k * h) for k in (-2, -1, 0, 1, 2)]
            results.append(sum(c * v for c, v in zip(CENTRAL, values, strict=False)) / h)
        else:
            first = f(t, side="after" if side > 0 else "before")
            values = [first] + [f(t + side * k * h) for k in (1, 2, 3, 4)]
            results.append(side * sum(c * v for c, v in zip(FORWARD, values, strict=False)) / h)
    return results[1], np.max(np.abs(np.asarray(results[1]) - np.asarray(results[0])))


class Motions:
    """A run, asked at a time on a side of it."""

    def __init__(self, rig, run, check, tag):
        self.rig, self.run, self.check, self.tag = rig, run, check, tag
        events = [e.time for e in run.events]
        self.edges = np.unique([run.start, *events, run.end])

    def far(self, t, side):
        """Whether no event is so near that a slope would cross it."""
        if side == 0:
            return np.min(np.abs(self.edges - t)) > 2.5 * H
        others = self.edges[np.abs(self.edges - t) > 0]
        ahead = others[(others - t) * side > 0]
        return len(ahead) > 0 and np.min(np.abs(ahead - t)) > 4.5 * H

    def ask(self, f, t, side):
        return f(t, side="before") if side < 0 else f(t)

    def slope_is(self, name, value, f, t, side, size=0.0):
        """Whether a value is the slope of f."""
        want, doubt = slope(f, t, side)
        scale = max(np.max(np.abs(want)), size, np.max(np.abs(self.ask(f, t, side))), 1e-3)
        if doubt > 1e-4 * scale:
            self.check.skipped += 1
            return want, False
        self.check(name, value, want, scale, TOLERANCE, 4 * doubt, f"at {t} side {side} {self.tag}")
        return want, True

    def near(self, name, got, want, scale, t, side, slack=0.0):
        self.check(name, got, want, max(scale, 1e-3), ROUNDING, slack, f"at {t} side {side} {self.tag}")

    # ends of springs, points of loads

    def point(self, index, where, t, side):
        body = self.rig.bodies[index]
        m = self.run[body["handle"]]
        if body["rigid"]:
            p = m.point(where, t, side="before" if side < 0 else "after")
            return np.array(p[0]), np.array(p[1])
        return self.ask(m.position, t, side), self.ask(m.velocity, t, side)

    def spring(self, s, t, side):
        ra, va = self.point(*s["a"], t, side)
        if s["b"][0] is None:
            rb_, vb = s["b"][1], np.zeros(3)
        else:
            other = self.rig.bodies[s["b"][0]]
            rb_, vb = self.point(s["b"][0], other.get("com", np.zeros(3)), t, side)
        k, rest, damping = s["law"]
        d, v = ra - rb_, va - vb
        length = np.linalg.norm(d)
        return ra, rb_, length, -(k * (length - rest) + damping * d @ v / length) * d / length, d, v

    def jumps(self, load, t, side):
        """Whether a force with a sign in it is on its edge, where the state does not say what it is."""
        if load.jump is None:
            return False
        body = self.rig.bodies[load.body]
        if load.torque is not None:
            m = self.run[body["handle"]]
            argument = load.jump[0](t, None, self.ask(m.angular_velocity, t, side))
        else:
            r, v = self.point(load.body, load.at if load.at is not None else body.get("com", np.zeros(3)), t, side)
            argument = load.jump[0](t, r, v)
        return abs(argument) < 1e-7

    def exerted(self, index, t, side):
        """Force, moment about the centre of mass, and of how much of them a jump may be; all loads again."""
        rig, body = self.rig, self.rig.bodies[index]
        m = self.run[body["handle"]]
        center = self.ask(m.center_of_mass if body["rigid"] else m.position, t, side)
        force, moment, loose = body["mass"] * rig.gravity, np.zeros(3), False
        for load in rig.loads:
            if load.body != index:
                continue
            loose = loose or self.jumps(load, t, side)
            if hasattr(load, "torsion"):
                k, rest, damping = load.torsion
                size = -(k * (self.ask(m.angle, t, side) - rest) + damping * self.ask(m.rate, t, side))
                moment = moment + size * body["axis"]
            elif load.torque is not None:
                moment = moment + load.torque(
                    t, self.ask(m.rotation_matrix, t, side), self.ask(m.angular_velocity, t, side)
                )
            else:
                where = load.at if load.at is not None else body.get("com", np.zeros(3))
                r, v = self.point(index, where, t, side)
                if load.force.__code__.co_argcount == 4:
                    f = load.force(t, r, v, self.ask(m.rotation_matrix, t, side))
                else:
                    f = load.force(t, r, v)
                force = force + f
                moment = moment + cross(r - center, f)
        for s in rig.springs:
            if index not in (s["a"][0], s["b"][0]):
                continue
            ra, rb_, _, f, _, _ = self.spring(s, t, side)
            if s["a"][0] == index:
                force, moment = force + f, moment + cross(ra - center, f)
            if s["b"][0] == index:
                force, moment = force - f, moment - cross(rb_ - center, f)
        return force, moment, loose

    # one body

    def body(self, index, t, side):
        body = self.rig.bodies[index]
        m, near = self.run[body["handle"]], self.near
        ask = lambda name: self.ask(getattr(m, name), t, side)  # noqa: E731
        force, moment, loose = self.exerted(index, t, side)
        size = max(np.linalg.norm(force), 1.0)
        r, v, a = ask("position"), ask("velocity"), ask("acceleration")
        self.slope_is("velocity", v, m.position, t, side)
        a_again, good = self.slope_is("acceleration", a, m.velocity, t, side, size / body["mass"])
        if not loose:
            near("force", ask("force"), force, size, t, side)
        if not body["rigid"]:
            reaction = np.zeros(3)
            if body["joint"] == "rail":
                reaction = ask("reaction")
                self.rail(index, t, side, reaction, size)
            near("m a = F + reaction", body["mass"] * a, ask("force") + reaction, size, t, side)
            if good and not loose:
                self.check(
                    "reaction",
                    reaction,
                    body["mass"] * a_again - force,
                    size + np.linalg.norm(reaction),
                    TOLERANCE,
                    1e-6,
                    f"at {t} side {side} {self.tag}",
                )
            return
        mass, inertia = body["mass"], body["inertia"]
        R, w = ask("rotation_matrix"), ask("angular_velocity")
        alpha = ask("angular_acceleration")
        g, vg, ag = ask("center_of_mass"), ask("center_of_mass_velocity"), ask("center_of_mass_acceleration")
        q = ask("quaternion")
        near("quaternion", Rotation.from_quat(q[[1, 2, 3, 0]]).as_matrix(), R, 1, t, side)
        near("R orthogonal", R @ R.T, np.eye(3), 1, t, side)
        near("centre of mass", g, r + R @ body["com"], 1 + np.linalg.norm(r), t, side)
        near("poisson vector", ask("poisson_vector"), R[2], 1, t, side)
        w_world = ask("angular_velocity_world")
        near("angular velocity in the world", w_world, R @ w, 1 + np.linalg.norm(w), t, side)
        turning, doubt = slope(m.rotation_matrix, t, side)
        spin = turning @ R.T
        self.check(
            "angular velocity",
            w_world,
            [spin[2, 1], spin[0, 2], spin[1, 0]],
            1 + np.linalg.norm(w),
            TOLERANCE,
            4 * doubt,
            self.tag,
        )
        torques = np.linalg.norm(moment) + size
        self.slope_is("angular acceleration", alpha, m.angular_velocity, t, side, torques)
        self.slope_is("centre velocity", vg, m.center_of_mass, t, side)
        self.slope_is("centre acceleration", ag, m.center_of_mass_velocity, t, side, size / mass)
        angles = ask("euler_angles")
        near("euler angles", Rotation.from_euler("ZXZ", angles[[1, 0, 2]]).as_matrix(), R, 1, t, side)
        if abs(np.sin(angles[0])) > 0.2:
            self.slope_is("euler rates", ask("euler_rates"), m.euler_angles, t, side, np.linalg.norm(w))
        where = np.array([0.3, -0.2, 0.5])
        p, vp = self.point(index, where, t, side)
        near("point", p, r + R @ where, 1 + np.linalg.norm(r), t, side)
        near("velocity of a point", vp, v + R @ cross(w, where), 1 + np.linalg.norm(v) + np.linalg.norm(w), t, side)
        if np.linalg.norm(w) > 1e-3:
            pole, direction = m.instantaneous_axis(t, side="before" if side < 0 else "after")
            along = vg + cross(w_world, pole - g)
            far = np.linalg.norm(vg) + 1
            near("instantaneous axis", cross(along, w_world) / np.linalg.norm(w), np.zeros(3), far, t, side)
            near("nearest point of the axis", (pole - g) @ direction, 0, far / np.linalg.norm(w), t, side)
        # the laws, with what the run reports and with what the slopes say
        reaction, about, torque = np.zeros(3), g, np.zeros(3)
        if body["joint"] != "body":
            reaction, torque = ask("reaction"), ask("reaction_torque")
            about = r + R @ body["point"]
        near("m a_G = F + reaction", mass * ag, ask("force") + reaction, size + np.linalg.norm(reaction), t, side)
        spun = R @ (inertia @ alpha + cross(w, inertia @ w))
        if not loose:
            near(
                "I alpha + w x I w = torques",
                spun,
                moment + torque + cross(about - g, reaction),
                torques + np.linalg.norm(reaction) + np.linalg.norm(torque) + np.linalg.norm(spun),
                t,
                side,
            )
        if body["joint"] == "revolute":
            near("hinge", R, Rotation.from_rotvec(ask("angle") * body["axis"]).as_matrix(), 1, t, side)
            near("rate", ask("rate") * body["axis"], w_world, 1 + np.linalg.norm(w), t, side)
            near("torque about the axis", torque @ body["axis"], 0, torques + np.linalg.norm(torque), t, side)
        if body["joint"] == "prismatic":
            near("slide", about, body["at"] + ask("displacement") * body["axis"], 1 + np.linalg.norm(r), t, side)
            near("rate of a slide", ask("rate") * body["axis"], v, 1 + np.linalg.norm(v), t, side)
            near("reaction along the axis", reaction @ body["axis"], 0, size + np.linalg.norm(reaction), t, side)
        if body["joint"] in ("ball", "revolute"):
            near("held point", about, body["at"], 1 + np.linalg.norm(r), t, side)
        if body["joint"] == "ball":
            near("torque of a ball joint", torque, np.zeros(3), 1, t, side)

    def rail(self, index, t, side, reaction, size):
        body = self.rig.bodies[index]
        m, curve = self.run[body["handle"]], self.rig.bodies[index]["curve"]
        u, speed = self.ask(m.parameter, t, side), self.ask(m.speed, t, side)
        shift, turn = place(body, t)
        r = self.ask(m.position, t, side)
        self.slope_is("speed", speed, m.arc_length, t, side)
        frenet = self.ask(m.reaction_frenet, t, side)
        f = curve.frenet(u)
        frame = np.array([f.tangent, f.normal, f.binormal]) @ turn.T
        big = size + np.linalg.norm(reaction)
        self.near("reaction along Frenet's axes", frenet, frame @ reaction, big, t, side)
        # a little further on, where one that has just left is off its rail
        later = t + 4 * side * H
        moved, turned = place(body, later)
        flies = np.linalg.norm(turned @ curve.position(m.parameter(later)) + moved - m.position(later)) > 1e-10
        tangential = self.ask(m.tangential_force, t, side)
        if flies:
            self.near("nothing along a rail that is left", [speed, tangential], [0, 0], 1, t, side)
            return
        self.near("position on the rail", r, turn @ curve.position(u) + shift, 1 + np.linalg.norm(r), t, side)
        self.near("tangential force", tangential, self.ask(m.force, t, side) @ frame[0], big, t, side)
        along, across = reaction @ frame[0], np.hypot(reaction @ frame[1], reaction @ frame[2])
        if body["friction"] is None:
            self.near("smooth", along, 0, big, t, side)
            return
        slip = speed - body.get("drive", lambda t: 0.0)(t)
        friction = body["friction"]
        loose = any(self.jumps(load, t, side) for load in self.rig.loads if load.body == index)
        if abs(slip) > 1e-6 and not loose:
            self.near("dynamic friction", along, -np.sign(slip) * friction.mu_dynamic * across, big, t, side)
        elif slip == 0.0 and not loose:
            self.check("static friction", max(abs(along) - friction.mu_static * across, 0.0), 0.0, big, 1e-8)

    # the system

    def system(self, t, side):
        rig, run, near = self.rig, self.run, self.near
        which = "before" if side < 0 else "after"
        kinetic, momentum, spin = 0.0, np.zeros(3), np.zeros(3)
        pole, mass, center, moving = np.array([0.3, -1.0, 0.7]), 0.0, np.zeros(3), np.zeros(3)
        potential, size, power_size = 0.0, 1.0, 1.0
        for body in rig.bodies:
            m, k = run[body["handle"]], body["mass"]
            rigid = body["rigid"]
            g = self.ask(m.center_of_mass if rigid else m.position, t, side)
            v = self.ask(m.center_of_mass_velocity if rigid else m.velocity, t, side)
            kinetic += 0.5 * k * v @ v
            momentum = momentum + k * v
            spin = spin + cross(g - pole, k * v)
            if rigid:
                w, R = self.ask(m.angular_velocity, t, side), self.ask(m.rotation_matrix, t, side)
                kinetic += 0.5 * w @ body["inertia"] @ w
                spin = spin + R @ body["inertia"] @ w
            mass, center, moving = mass + k, center + k * g, moving + k * v
            potential += k * rig.gravity @ g
            size += abs(k * rig.gravity @ g) + k * v @ v + k * np.linalg.norm(g) ** 2
            power_size += np.linalg.norm(self.ask(m.force, t, side)) * np.linalg.norm(v) + kinetic
        for s in rig.springs:
            _, _, length, f, _, v = self.spring(s, t, side)
            k, rest, _ = s["law"]
            potential -= 0.5 * k * (length - rest) ** 2
            size += 0.5 * k * length**2 + k * length
            m = run[s["handle"]]
            near("length of a spring", self.ask(m.length, t, side), length, 1 + length, t, side)
            near("force of a spring", self.ask(m.force, t, side), f, np.linalg.norm(f) + k, t, side)
            near(
                "power of a spring",
                run.power(t, of=s["handle"], side=which),
                f @ v,
                (np.linalg.norm(f) + k) * (1 + np.linalg.norm(v)),
                t,
                side,
            )
        rail_work = False
        for load in rig.loads:
            body = rig.bodies[load.body]
            m = run[body["handle"]]
            got = run.power(t, of=load.handle, side=which)
            if hasattr(load, "torsion"):
                k, rest, damping = load.torsion
                turned, rate = self.ask(m.angle, t, side) - rest, self.ask(m.rate, t, side)
                want = -(k * turned + damping * rate) * rate
                potential -= 0.5 * k * turned**2
                scale = abs(k * turned * rate) + damping * rate**2 + k
                size += k * turned**2
            elif load.torque is not None:
                R, w = self.ask(m.rotation_matrix, t, side), self.ask(m.angular_velocity, t, side)
                torque = load.torque(t, R, w)
                want, scale = torque @ (R @ w), np.linalg.norm(torque) * np.linalg.norm(w)
            else:
                r, v = self.point(load.body, load.at if load.at is not None else body.get("com", np.zeros(3)), t, side)
                R = self.ask(m.rotation_matrix, t, side) if body["rigid"] else None
                f = load.force(t, r, v, R) if load.force.__code__.co_argcount == 4 else load.force(t, r, v)
                want, scale = f @ v, np.linalg.norm(f) * np.linalg.norm(v)
                if load.potential is not None:
                    potential += load.potential(r)
                    size += abs(load.potential(r))
                elif body["joint"] == "rail":
                    rail_work = True
            if not self.jumps(load, t, side):
                near("power of a load", got, want, scale + 1, t, side)
        near("kinetic energy", run.kinetic_energy(t, side=which), kinetic, size, t, side)
        near("momentum", run.momentum(t, side=which), momentum, size, t, side)
        near("angular momentum", run.angular_momentum(t, pole=pole, side=which), spin, size, t, side)
        near("centre of mass of all", run.center_of_mass(t, side=which), center / mass, size, t, side)
        near("velocity of it", run.center_of_mass_velocity(t, side=which), moving / mass, size, t, side)
        if not rail_work:
            near("potential", run.potential(t, side=which), potential, size, t, side)
            near("energy", run.energy(t, side=which), kinetic - potential, size, t, side)
        self.slope_is("power", run.power(t, side=which), run.kinetic_energy, t, side, power_size)

    def works(self, t0, t1):
        """Work against the integral of the power, piece by piece."""
        run = self.run
        edges = [t0, *[e for e in self.edges if t0 < e < t1], t1]

        def by_quadrature(of):
            total, size = 0.0, 1.0
            for a, b in zip(edges, edges[1:], strict=False):
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    part, _ = quad(lambda t: float(run.power(t, of=of)), a, b, epsabs=1e-10, epsrel=1e-9, limit=200)
                total, size = total + part, size + abs(part)
            return total, size

        want, size = by_quadrature(None)
        size += run.kinetic_energy(t0) + run.kinetic_energy(t1)
        self.check("work", run.work(t0, t1), want, size, 1e-7, 0, f"{t0} {t1} {self.tag}")
        self.check("work backwards", run.work(t1, t0), -run.work(t0, t1), size, 1e-13)
        for part in [*self.rig.loads, *self.rig.springs]:
            handle = part["handle"] if isinstance(part, dict) else part.handle
            want, size = by_quadrature(handle)
            self.check("work of a load", run.work(t0, t1, of=handle), want, size, 1e-7, 0, f"{t0} {t1} {self.tag}")

    def angles(self, index, until):
        """Euler angles against the path of the quaternion, in steps that lose no turn."""
        m = self.run[self.rig.bodies[index]["handle"]]
        t = np.linspace(self.run.start, until, 101)
        for _ in range(40):
            q, w = m.quaternion(t), np.linalg.norm(m.angular_velocity(t), axis=1)
            for k in range(1, len(q)):  # one of the two signs goes on
                if q[k] @ q[k - 1] < 0:
                    q[k] = -q[k]
            u, f = q[:, 0] + 1j * q[:, 3], q[:, 1] + 1j * q[:, 2]
            least = np.minimum(np.abs(u), np.abs(f))
            step = np.diff(t) * np.maximum(w[1:], w[:-1]) * 0.6
            coarse = step > 0.5 * np.minimum(least[1:], least[:-1])
            if not coarse.any() or len(t) > 20000:
                break
            t = np.sort(np.concatenate([t, 0.5 * (t[1:] + t[:-1])[coarse]]))
        if least[1:].min() < 1e-8 or len(t) > 20000:
            return
        s, r = np.unwrap(np.angle(u)), np.unwrap(np.angle(f))
        got = m.euler_angles(t)
        first = 1 if least[0] < 1e-8 else 0
        s, r, got = s[first:] - s[first], r[first:] - r[first], got[first:] - got[first]
        self.check("turns of euler angles", got[:, 1:], np.stack([s + r, s - r], axis=1), 1, 1e-6, 0, self.tag)


def simulate(rig, check, **options):
    try:
        return rb.simulate(rig.scene, 3.0, error=ERROR, max_steps=20000, **options)
    except (rb.AccuracyError, rb.IntegrationError):
        check.skipped += 1
        return None


def compare_scene(seed, check, times=4):
    """All checks of the scene of a seed."""
    rig = Rig(seed)
    run = simulate(rig, check)
    if run is None or run.end - run.start < 20 * H:
        return False
    look = Motions(rig, run, check, f"(seed {seed})")
    rng = np.random.default_rng(seed + 1)
    inside = [(float(t), 0) for t in rng.uniform(run.start, run.end, size=times)]
    sides = [(e.time, side) for e in run.events[:6] for side in (-1, 1)]
    for t, side in inside + sides:
        if not look.far(t, side):
            continue
        for index in range(len(rig.bodies)):
            look.body(index, t, side)
        look.system(t, side)
    t0, t1 = sorted(rng.uniform(run.start, run.end, size=2))
    look.works(float(t0), float(t1))
    for index, body in enumerate(rig.bodies):
        if body["rigid"]:
            look.angles(index, run.end)
    keeps(rig, run, check, sorted(float(t) for t in rng.uniform(run.start, run.end, size=3)), seed)
    return True


def keeps(rig, run, check, times, seed):
    """A run that keeps times, or its end, says there what one that keeps all says, or refuses."""
    for keep in (times, "end"):
        try:
            other = rb.simulate(rig.scene, 3.0, error=ERROR, max_steps=20000, keep=keep)
        except (rb.AccuracyError, rb.IntegrationError):
            check.skipped += 1
            continue
        for t in times if keep == times else [other.end]:
            if min((abs(e.time - t) for e in run.events), default=1.0) < 1e-9:
                continue
            for body in rig.bodies:
                a, b = run[body["handle"]], other[body["handle"]]
                for name in a.quantities:
                    x, y = getattr(a, name)(t), getattr(b, name)(t)
                    if isinstance(x, tuple):
                        x, y = np.concatenate(x), np.concatenate(y)
                    x, y = np.asarray(x), np.asarray(y)
                    if name == "euler_rates" and not np.isfinite(x).all():
                        continue
                    if name == "euler_rates" and keep == "end":
                        # angles without a path are those with theta >= 0
                        x[0] *= np.sign(np.sin(a.euler_angles(t)[0])) * np.sign(np.sin(b.euler_angles(t)[0]))
                    if name == "euler_angles" and keep == "end":
                        y = Rotation.from_euler("ZXZ", y[[1, 0, 2]]).as_matrix()
                        x = Rotation.from_euler("ZXZ", x[[1, 0, 2]]).as_matrix()
                    scale = 1 + np.max(np.abs(x))
                    if name.startswith("reaction") or name.endswith("acceleration") or name == "euler_rates":
                        scale *= 100  # what the error of the state is multiplied by
                    check(f"keep: {name}", y, x, scale, 1e-7, 0, f"keep {keep} at {t} (seed {seed})")
        ends = (times[0], times[-1]) if keep == times else (other.start, other.end)
        for handle in [None, *[x.handle for x in rig.loads], *[s["handle"] for s in rig.springs]]:
            try:
                got = other.work(*ends, of=handle)
            except rb.InvalidInput:
                check.compared["work refused"] += 1
                continue
            check(
                "keep: work",
                got,
                run.work(*ends, of=handle),
                1 + run.kinetic_energy(ends[1]) + abs(got),
                1e-7,
                0,
                f"keep {keep} (seed {seed})",
            )


def main(count=1000, seed=0, quiet=False):
    check, done = Check(), 0
    for k in range(count):
        done += compare_scene(seed + k, check)
    if not quiet:
        for note in check.notes[:60]:
            print(note)
        print(dict(check.wrong))
        print(
            f"{done} scenes of {count}, {sum(check.compared.values())} comparisons of {len(check.compared)} kinds, "
            f"{sum(check.wrong.values())} disagree; {check.skipped} left out"
        )
    return check


if __name__ == "__main__":
    sys.exit(bool(main(*map(int, sys.argv[1:])).wrong))
