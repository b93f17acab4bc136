"""Random beads on rails that only push, against their laws written again: arc length, speed and one multiplier.

In the plane of the rail, with the unit tangent e along growing u and the unit normal n to the side that pushes,
    m v' = F.e - mu_d N sign(v),   N = m v^2 (r''.n)/|r'|^2 - F.n >= 0
on the rail, m r'' = F in flight; at a landing the speed across the rail is lost, along it mu_d times as much, as far
as there is. Integrated by SciPy's DOP853.

    python tests/random/one_sided.py [count] [first seed]
"""

import math
import sys
from dataclasses import dataclass

import numpy as np
import rbdyn as rb
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize_scalar

TIGHT = dict(method="DOP853", rtol=1e-12, atol=1e-13)


@dataclass
class Shape:
    """A plane curve: u -> r, r', r'' in its plane, where a place is on it, and how far above it a place is."""

    name: str
    point: object
    parameter: object  # of a place near the curve
    gap: object  # sign and zeros of the height of a place over the curve, to the left of e
    domain: tuple = (-math.inf, math.inf)


def line(angle):
    e = np.array([math.cos(angle), math.sin(angle)])
    left = np.array([-e[1], e[0]])
    return Shape("line", lambda u: (u * e, e, 0 * e), lambda p: p @ e, lambda p: p @ left)


def circle(radius):
    def point(u):
        c, s = math.cos(u), math.sin(u)
        return radius * np.array([c, s]), radius * np.array([-s, c]), -radius * np.array([c, s])

    # the left of a circle that turns to the left is inside
    return Shape("circle", point, lambda p: math.atan2(p[1], p[0]), lambda p: radius - math.hypot(*p))


def graph(name, f, slope, bend):
    def point(u):
        return np.array([u, f(u)]), np.array([1.0, slope(u)]), np.array([0.0, bend(u)])

    return Shape(name, point, lambda p: p[0], lambda p: p[1] - f(p[0]))


@dataclass
class Case:
    shape: Shape
    side: float  # the rail pushes to the left of growing u: 1, to the right: -1
    force: object  # t, r, v -> F in the plane
    mass: float
    friction: object  # (mu_static, mu_dynamic), or None
    u: float
    v: float


def laws(case, until):
    """Events (kind, time) and where the bead is in the end; nothing if too close to call."""
    t, mode = 0.0, None
    events = []
    close = 1e-6

    def frame(u):
        r, first, second = case.shape.point(u)
        size = np.hypot(*first)
        e = first / size
        return r, e, case.side * np.array([-e[1], e[0]]), second, size

    def pressing(t, u, v):
        r, e, n, second, size = frame(u)
        return case.mass * v * v * (second @ n) / size**2 - case.force(t, r, v * e) @ n

    def pull(t, u, v):
        r, e, *_ = frame(u)
        return case.force(t, r, v * e) @ e

    def settled(t, u):
        """What a bead at rest does: 0 sticks, 1 or -1 slips; none if too close to call."""
        needs, limit = pull(t, u, 0.0), case.friction[0] * pressing(t, u, 0.0)
        if abs(abs(needs) - limit) < close * (abs(needs) + abs(limit)):
            return None
        return 0 if abs(needs) < limit else int(np.sign(needs))

    def begin(t, u, v):
        if abs(pressing(t, u, v)) < close:
            return None
        if pressing(t, u, v) < 0.0:
            return "fly"
        if case.friction is None:
            return 1
        return int(np.sign(v)) if abs(v) > close else settled(t, u) if v == 0.0 else None

    u, v = case.u, case.v
    place, velocity = None, None
    mode = begin(t, u, v)
    if mode == "fly":
        r, e, *_ = frame(u)
        place, velocity = r, v * e
    while mode is not None and t < until and len(events) < 30:
        if mode == "fly":
            start = t

            def rates(t, y):
                return np.concatenate([y[2:], case.force(t, y[:2], y[2:]) / case.mass])

            flown = solve_ivp(rates, (t, until), np.concatenate([place, velocity]), dense_output=True, **TIGHT)
            times = np.linspace(t, until, 4001)
            gaps = np.array([case.side * case.shape.gap(flown.sol(x)[:2]) for x in times])
            # beside the ends of its curve there is no rail
            low, high = case.shape.domain
            if any(not low < flown.sol(x)[0] < high for x in times[:: len(times) // 400]):
                return None
            # what has just left grows away from the rail
            below = [k for k in range(1, len(times)) if gaps[k] < 0.0]

            def gap(x, path=flown.sol):
                return case.side * case.shape.gap(path(x)[:2])

            # what comes back along the curve it left touches it: whether that is a landing is too close to call
            for k in range(20, min(below[0] + 1 if below else len(times), len(times) - 1)):
                if gaps[k - 1] >= gaps[k] <= gaps[k + 1] and gaps[k] < 1e-4:
                    turn = minimize_scalar(
                        gap, bounds=times[[k - 1, k + 1]], method="bounded", options={"xatol": 1e-12}
                    )
                    if abs(turn.fun) < close * 1e-2:
                        return None
            if not below:
                t, y = until, flown.sol(until)
                place, velocity = y[:2], y[2:]
                break
            k = below[0]
            if k < 3:
                return None
            hit = brentq(gap, times[k - 1], times[k], xtol=1e-14)
            y = flown.sol(hit)
            t, place, velocity = hit, y[:2], y[2:]
            if t - start < 1e-3:
                return None
            u = case.shape.parameter(place)
            v = float(velocity @ frame(u)[1])
            events.append(("land", t))
            if case.friction is not None:
                # Coulomb's law of the impulses
                most = case.friction[1] * abs(velocity @ frame(u)[2])
                if abs(v) < close or abs(abs(v) - most) < close:
                    return None
                v -= math.copysign(min(abs(v), most), v)
            mode = begin(t, u, v)
            if mode == "fly":
                r, e, *_ = frame(u)
                place, velocity = r, v * e
                events.append(("detach", t))
            continue
        if mode == 0:
            times = np.linspace(t, until, 2001)

            def margin(t, u=u):
                return case.friction[0] * pressing(t, u, 0.0) - abs(pull(t, u, 0.0))

            found = [k for k in range(1, len(times)) if margin(times[k]) < 0.0]
            if not found:
                t = until
                break
            t = brentq(margin, times[found[0] - 1], times[found[0]], xtol=1e-14)
            mode = int(np.sign(pull(t, u, 0.0)))
            v = 0.0
            events.append(("slip", t))
            if pressing(t, u, 0.0) < close:
                return None
            continue

        def rates(t, y, sign=mode):
            u, v = y
            r, e, n, second, size = frame(u)
            f = case.force(t, r, v * e)
            along = f @ e
            if case.friction is not None:
                along -= case.friction[1] * sign * (case.mass * v * v * (second @ n) / size**2 - f @ n)
            return [v / size, along / case.mass]

        def leaves(t, y):
            return pressing(t, *y)

        def stops(t, y, sign=mode):
            return sign * y[1] + (1e-300 if y[1] == 0.0 else 0.0)

        leaves.terminal, leaves.direction = True, -1
        stops.terminal, stops.direction = True, -1
        watched = [leaves] if case.friction is None else [leaves, stops]
        # a start from rest is no stop: a short way on by hand
        if case.friction is not None and v == 0.0:
            h = 1e-6
            slope = rates(t, [u, 0.0])[1]
            size = frame(u)[4]
            u, v, t = u + 0.5 * slope * h * h / size, slope * h, t + h
            if t >= until:
                break
        ran = solve_ivp(rates, (t, until), [u, v], events=watched, max_step=0.05, **TIGHT)
        t, (u, v) = ran.t[-1], ran.y[:, -1]
        if ran.status != 1:
            break
        if len(ran.t_events[0]):
            events.append(("detach", t))
            r, e, *_ = frame(u)
            place, velocity, mode = r, v * e, "fly"
            continue
        v = 0.0
        now = settled(t, u)
        if now is None:
            return None
        events.append(("stick" if now == 0 else "reverse", t))
        mode = now
    if mode is None:
        return None
    return events, place if mode == "fly" else case.shape.point(u)[0]


def turned(rng, kind):
    """Axes of the plane in the world: any for curves that know their plane, a plane of the world's for others."""
    if kind != "own":
        q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        return q[:, 0], q[:, 1], q[:, 2]
    axes = np.eye(3)[rng.permutation(3)] * rng.choice([-1.0, 1.0], size=(3, 1))
    return axes[0], axes[1], axes[2]


def random_case(seed):
    """A scene of the library's, and the same for the laws above."""
    rng = np.random.default_rng(seed)
    kind = rng.choice(["line", "circle", "parabola", "own", "spline", "polynomial"])
    x, y, _ = turned(rng, kind)
    origin = rng.normal(size=3) if kind in ("line", "circle", "parabola") else np.zeros(3)

    def world(p):
        return p[0] * x + p[1] * y

    if kind == "line":
        angle = rng.uniform(-math.pi, math.pi)
        shape = line(angle)
        curve = rb.Line(world([math.cos(angle), math.sin(angle)]), point=origin)
        u = rng.uniform(-2, 2)
    elif kind == "circle":
        radius = rng.uniform(0.3, 3)
        shape = circle(radius)
        curve = rb.Circle(radius, x, y, center=origin)
        u = rng.uniform(-math.pi, math.pi)
    elif kind == "parabola":
        a = rng.uniform(-1.5, 1.5)
        shape = graph(kind, lambda u: a * u * u, lambda u: 2 * a * u, lambda u: 2 * a)
        curve = rb.Parabola(a, x, y, vertex=origin)
        u = rng.uniform(-2, 2)
    elif kind == "own":
        a, k, c = rng.uniform(-1, 1), rng.uniform(0.3, 2), rng.uniform(-0.3, 0.3)
        shape = graph(
            kind,
            lambda u: a * np.sin(k * u) + c * u * u,
            lambda u: a * k * np.cos(k * u) + 2 * c * u,
            lambda u: -a * k * k * np.sin(k * u) + 2 * c,
        )
        curve = rb.Curve(lambda u: [u * x[i] + (a * np.sin(k * u) + c * u**2) * y[i] for i in range(3)])
        u = rng.uniform(-2, 2)
    elif kind == "polynomial":
        c = rng.uniform(-0.5, 0.5, size=4)
        p = np.polynomial.Polynomial(c)
        shape = graph(kind, p, p.deriv(), p.deriv(2))
        curve = rb.Polynomial([world([1.0 if n == 1 else 0.0, c[n]]) for n in range(4)])
        u = rng.uniform(-2, 2)
    else:
        heights = rng.uniform(-1, 1, size=12)
        s = CubicSpline(np.arange(12.0), heights, bc_type="not-a-knot")
        shape = graph(kind, lambda u: float(s(u)), lambda u: float(s(u, 1)), lambda u: float(s(u, 2)))
        shape.domain = (0.0, 11.0)
        curve = rb.Spline([world([float(n), h]) for n, h in enumerate(heights)])
        u = rng.uniform(4, 7)
    first, second = shape.point(u)[1:]
    left = np.array([-first[1], first[0]]) / np.hypot(*first)
    bend = second @ left
    word = str(rng.choice(["+", "-"]))
    pushes = 1.0 if word == "+" else -1.0
    up = None
    if kind == "line" or rng.random() < 0.5 or abs(bend) < 1e-3:
        toward = rng.normal(size=2)
        if abs(toward @ left) < 0.05 * np.hypot(*toward):
            toward = left
        up = world(toward) * rng.uniform(0.1, 10)
        if kind != "line":
            up = up + rng.normal() * np.cross(x, y)
        side = pushes * (1.0 if toward @ left > 0 else -1.0)
    else:
        side = pushes * (1.0 if bend > 0 else -1.0)
    mass = rng.uniform(0.2, 3)
    friction = None
    if rng.random() < 0.6:
        dynamic = rng.uniform(0.05, 0.8)
        friction = (dynamic * rng.uniform(1.0, 1.8), dynamic)
    # more often than not towards the rail
    gravity = rng.normal(size=2) * 4 - side * left * rng.uniform(-3, 15)
    stiffness, anchor = (0.0, np.zeros(2)) if rng.random() < 0.6 else (rng.uniform(0, 12), rng.normal(size=2) * 2)
    strength, frequency = (0.0, 1.0) if rng.random() < 0.6 else (rng.uniform(0, 12), rng.uniform(0.5, 6))
    push = rng.normal(size=2)
    v = 0.0 if rng.random() < 0.3 else rng.normal() * 3

    def force(t, r, _):
        return mass * gravity - stiffness * (r - anchor) + strength * math.sin(frequency * t + 0.3) * push

    case = Case(shape, side, force, mass, friction, u, v)
    scene = rb.Scene(gravity=world(gravity))
    coulomb = None if friction is None else rb.Coulomb(*friction)
    rail = rb.Rail(curve, side=word, up=up, friction=coulomb, ends="stop")
    bead = scene.add(rb.Particle(mass), rail, parameter=u, speed=v)
    if stiffness:
        scene.connect(rb.Spring(stiffness), bead, origin + world(anchor))
    if strength:
        along = world(push) * strength
        scene.apply(rb.Force(lambda t, r, v: np.sin(frequency * t + 0.3) * along), bead)

    def local(p):
        d = np.asarray(p) - origin
        return np.array([d @ x, d @ y])

    return case, scene, bead, rail, local, side * world(left)


KINDS = {"detach", "land", "slip", "stick", "reverse"}


def check(seed, until=2.0, error=1e-9):
    """Nothing, or what is wrong; "skip" where the laws are too close to call."""
    case, scene, bead, rail, local, normal = random_case(seed)
    if not np.allclose(rail.push_direction(case.u), normal, rtol=0, atol=1e-9):
        return f"pushes along {rail.push_direction(case.u)}, not {normal}"
    truth = laws(case, until)
    if truth is None:
        return "skip"
    events, place = truth
    try:
        run = rb.simulate(scene, until, error=error)
    except rb.AccuracyError as failed:
        return f"AccuracyError: {failed}"
    except rb.IntegrationError as failed:
        return f"IntegrationError: {failed}"
    if run.status != "reached end":
        return "skip" if case.shape.name == "spline" else run.status
    found = [(e.kind, e.time) for e in run.events if e.kind in KINDS]
    # those of one instant are listed in the order of their kinds
    events = sorted(events, key=lambda e: (round(e[1], 9), e[0]))
    if [k for k, _ in found] != [k for k, _ in events]:
        return f"events {found}, not {events}"
    size = 1.0 + abs(place).max()
    late = max([abs(a[1] - b[1]) for a, b in zip(found, events, strict=True)], default=0.0)
    off = abs(local(run[bead].position(until)) - place).max()
    if late > 1e-5 or off > 1e-5 * size:
        return f"late by {late}, off by {off}: {found}, {events}"
    return None


if __name__ == "__main__":
    count, first = (int(a) for a in (sys.argv[1:] + ["300", "0"][len(sys.argv) - 1 :]))
    skipped = wrong = 0
    kinds = {}
    for seed in range(first, first + count):
        what = check(seed)
        skipped += what == "skip"
        if what and what != "skip":
            wrong += 1
            print(seed, random_case(seed)[0].shape.name, what)
    print(f"{count} scenes, {skipped} too close to call, {wrong} wrong")
