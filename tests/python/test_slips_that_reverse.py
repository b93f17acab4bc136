"""Slips that come to zero and go on, at once the other way or beside it: a force larger than friction swings them.

Along a line a slip u has u' = A sin(w t) - D sign(u) and stays at zero where |A sin(w t)| <= S: in closed form from one
zero to the next, with the normal force as the rounded vectors give it, in extended precision. Beside a line it passes
its zero as near as 1e-14 of its speed, and turns there by half a turn: integrated by SciPy in a time stretched by |u|,
in which nothing is quick.
"""

import functools

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp

R = np.longdouble


def zero(f, a, b):
    """Where f changes its sign."""
    side = f(a) > 0
    for _ in range(100):
        middle = (a + b) / 2
        if (f(middle) > 0) == side:
            a = middle
        else:
            b = middle
    return b


class Line:
    """u' = (A - s m L) sin(w t) - s m N, s the sign of u: the load along the way is A sin(w t), that which lifts
    L sin(w t), all over the mass that slips, and held while |A sin(w t)| <= k (N - L sin(w t))."""

    def __init__(self, a, lift, n, k, m, w, u):
        self.a, self.lift, self.n, self.k, self.m, self.w, self.u = (R(x) for x in (a, lift, n, k, m, w, u))

    def speed(self, s, t0, u0, t):
        b, d = self.a + s * self.m * self.lift, s * self.m * self.n
        return u0 + b / self.w * (np.cos(self.w * t0) - np.cos(self.w * t)) - d * (t - t0)

    def gone(self, s, t0, u0, t):
        b, d, w = self.a + s * self.m * self.lift, s * self.m * self.n, self.w
        steady = (u0 + b / w * np.cos(w * t0) - d * (t - t0) / 2) * (t - t0)
        return steady - b / w**2 * (np.sin(w * t) - np.sin(w * t0))

    def beyond(self, t):
        """How far the load is from what holds it."""
        return abs(self.a * np.sin(self.w * t)) - self.k * (self.n - self.lift * np.sin(self.w * t))

    def until(self, end):
        """(kind, time) of what happens, u at the end, and how far it has slipped."""
        t, u, way, told = R(0), self.u, R(0), []
        h, s = 2 * np.pi / self.w / 400, np.sign(self.u)
        while True:
            if s == 0:
                x = t
                while x < end and self.beyond(x + h) < 0:
                    x += h
                t = zero(self.beyond, x, x + h) if x < end else end
                if t >= end:
                    return told, R(0), way
                told.append(("slip", t))
                s = np.sign(np.sin(self.w * t))
            speed = functools.partial(self.speed, s, t, u)
            x = t + h * R(1e-6)
            while x < end and speed(x + h) * s > 0:
                x += h
            there = zero(speed, x, x + h) if x < end else end
            if there >= end:
                return told, speed(R(end)), way + self.gone(s, t, u, R(end))
            way += self.gone(s, t, u, there)
            t, u = there, R(0)
            sticks = self.beyond(t) <= 0
            s = R(0) if sticks else np.sign(np.sin(self.w * t))
            told.append(("stick" if sticks else "reverse", t))


def dot(a, b):
    return sum(R(x) * R(y) for x, y in zip(a, b, strict=True))


class Drawn:
    """A plane turned at random, a direction along it, and a load of 1.1 to 300 times what friction holds."""

    def __init__(self, seed, most=2.5):
        draw = np.random.default_rng(seed)
        n = draw.normal(size=3)
        self.n = n / np.linalg.norm(n)
        e = np.cross(self.n, draw.normal(size=3))
        self.e = e / np.linalg.norm(e)
        self.m = draw.uniform(0.03, 0.8)
        self.k = self.m * draw.choice([1, 1.2, 2.0])
        self.g = 10 ** draw.uniform(0, 1.3)
        self.part = 10 ** draw.uniform(0.05, most)  # of what friction holds
        self.w = 10 ** draw.uniform(-3, 2)
        self.place = draw.normal(size=3) * 10 ** draw.uniform(-1, 7) * draw.integers(0, 2)
        self.mass = 10 ** draw.uniform(-9, 9)
        self.start = draw.choice([0, 1]) * draw.uniform(-1, 1)  # of A / w
        self.end = 2 * np.pi / self.w * draw.uniform(0.5, 6)

    def scene(self):
        return rb.Scene(gravity=-self.g * self.n)

    def plane(self, at=None):
        return rb.Plane(self.n, self.place if at is None else at)

    @property
    def friction(self):
        return rb.Coulomb(self.k, self.m)

    def load(self, force):
        w = self.w
        return rb.Force(lambda t, r, v: [f * np.sin(w * t) for f in force])

    def truth(self, force, mass, by=1, u=0.0):
        """`by`: how much more than its mass alone friction changes the slip by."""
        n = [R(x) / np.sqrt(dot(self.n, self.n)) for x in self.n]
        lift = dot(force, n) / R(mass)
        along = [R(f) / R(mass) - lift * x for f, x in zip(force, n, strict=True)]
        weight = -dot(-self.g * self.n, n)
        return Line(np.sqrt(dot(along, along)), lift, weight, by * R(self.k), by * R(self.m), self.w, u).until(self.end)


def agrees(run, told, times=None):
    """Events of the contact, in order, to what is told."""
    events = [e for e in (run.events if times is None else times) if e.kind in ("stick", "slip", "reverse")]
    assert [e.kind for e in events] == [kind for kind, _ in told]
    for event, (_, t) in zip(events, told, strict=True):
        assert abs(R(event.time) - t) <= 2 * run.error * t


# with 11, 15, 27, 56 and 59 rounding beside the line took the slip for one that turns, and passed by its zero
@pytest.mark.parametrize("seed", [*range(12), 15, 27, 56, 59])
def test_a_particle_on_a_plane_in_space_goes_straight_back(seed):
    d = Drawn(seed)
    force = d.mass * (d.part * d.k * d.g) * d.e
    speed = d.start * d.part * d.k * d.g / d.w
    scene = d.scene()
    ball = scene.add(rb.Particle(d.mass), position=d.place, velocity=speed * d.e)
    scene.contact(ball, d.plane(), friction=d.friction)
    scene.apply(d.load(force), ball)
    run = rb.simulate(scene, d.end, error=1e-9)
    told, u, way = d.truth(force, d.mass, u=speed)
    agrees(run, told)
    at = np.linspace(0, run.end, 200)
    fastest = max(np.linalg.norm(run[ball].velocity(t)) for t in at)
    far = np.ptp([(run[ball].position(t) - d.place) @ d.e for t in at])
    assert abs(run[ball].velocity(run.end) @ d.e - u) <= 2 * run.error * fastest
    rounding = 1e-15 * np.linalg.norm(d.place)
    assert abs((run[ball].position(run.end) - d.place) @ d.e - way) <= 2 * run.error * far + rounding


@pytest.mark.parametrize("seed", range(8))
def test_a_particle_on_a_plate_that_is_shaken_goes_straight_back(seed):
    """The plate follows b sin(w t) along the way: u' = b w^2 sin(w t) - m g sign(u), u = -b w at first."""
    d = Drawn(seed)
    a = d.part * d.k * d.g
    b, w = a / d.w**2, d.w
    scene = d.scene()
    plate = scene.add(rb.RigidBody(1.0, [1.0, 1.0, 1.0]), rb.Prismatic(d.e, motion=lambda t: b * np.sin(w * t)))
    ball = scene.add(rb.Particle(d.mass), position=[0, 0, 0])
    scene.contact(ball, plate.plane(d.n), friction=d.friction)
    run = rb.simulate(scene, d.end, error=1e-9)
    told, u, _ = d.truth(a * d.e, 1.0, u=-b * w)
    agrees(run, told)
    plated = b * w * np.cos(w * run.end)
    assert abs(run[ball].velocity(run.end) @ d.e - plated - u) <= 4 * run.error * b * w


@pytest.mark.parametrize("seed", range(8))
def test_a_sphere_that_slips_goes_straight_back_while_friction_spins_it(seed):
    """u = v - r omega: a force m g of friction on its rim changes it by 7/2 m g."""
    d = Drawn(seed)
    force = d.mass * 3.5 * d.part * d.k * d.g * d.e
    r = d.part * d.k * d.g / d.w**2 / 8
    scene = d.scene()
    ball = scene.add(rb.shapes.sphere(d.mass, r), position=r * d.n)
    scene.contact(ball.sphere(r), d.plane([0, 0, 0]), friction=d.friction)
    scene.apply(d.load(force), ball)
    run = rb.simulate(scene, d.end, error=1e-9)
    told, u, _ = d.truth(force, d.mass, by=R(7) / 2)
    agrees(run, told)
    slip = run[ball].velocity(run.end) @ d.e - r * run[ball].angular_velocity_world(run.end) @ np.cross(d.n, d.e)
    fastest = max(np.linalg.norm(run[ball].velocity(t)) for t in np.linspace(0, run.end, 200))
    assert abs(slip - u) <= 4 * run.error * fastest


@pytest.mark.parametrize("seed", range(8))
def test_two_particles_on_a_rod_go_straight_back_together(seed):
    d = Drawn(seed)
    other = 0.5 * d.mass
    length = d.part * d.k * d.g / d.w**2 / 8
    # on each in proportion to its mass: pushed from behind they do not stay in line
    size = d.part * d.k * d.g
    scene = d.scene()
    balls = [scene.add(rb.Particle(m), position=x * d.e) for m, x in ((d.mass, 0.0), (other, length))]
    touches = [scene.contact(ball, d.plane([0, 0, 0]), friction=rb.Coulomb(d.m)) for ball in balls]
    scene.constrain(rb.Rod(length), *balls)
    for ball, m in zip(balls, (d.mass, other), strict=True):
        scene.apply(d.load(m * size * d.e), ball)
    run = rb.simulate(scene, d.end, error=1e-9)
    d.k = d.m
    told, u, _ = d.truth(size * d.e, 1.0)
    for contact in touches:
        agrees(run, told, [e for e in run.events if e.subject == contact])
    fastest = max(np.linalg.norm(run[balls[1]].velocity(t)) for t in np.linspace(0, run.end, 200))
    assert abs(run[balls[1]].velocity(run.end) @ d.e - u) <= 4 * run.error * fastest


def beside(a, friction, w, across, late, u, end):
    """Velocity and way of u' = (a sin(w t), across a sin(w t + late)) - friction u / |u|, by ds = dt / |u|."""

    def rate(_, y):
        size = np.hypot(y[0], y[1])
        return [
            size * a * np.sin(w * y[4]) - friction * y[0],
            size * across * a * np.sin(w * y[4] + late) - friction * y[1],
            size * y[0],
            size * y[1],
            size,
        ]

    over = lambda _, y: y[4] - end  # noqa: E731
    over.terminal = True
    small = a / w * 1e-13
    least = [small * across, small * across, small / w, small / w, 1e-14 / w]
    found = solve_ivp(rate, (0, 1e300), [*u, 0, 0, 0], method="DOP853", rtol=1e-13, atol=least, events=over)
    return found.y_events[0][0]


def goes_straight_back(a, friction, w, u, end):
    """Whether the force is more than friction wherever what moves along one line, at u from t = 0 on, comes to rest."""
    t, side = np.linspace(0.0, end, 20001), np.sign(u)
    start = 0.0
    while True:
        later = t[t > start]
        v = u + a / w * (np.cos(w * start) - np.cos(w * later)) - side * friction * (later - start)
        turned = np.flatnonzero(side * v <= 0.0)
        if not turned.size:
            return True
        start, u, side = later[turned[0]], 0.0, -side
        if not -side * a * np.sin(w * start) < -1.2 * friction:
            return False


@pytest.mark.parametrize("power", range(-14, -2))
@pytest.mark.parametrize("seed", range(2))
def test_a_slip_that_passes_beside_its_zero_turns_round_there(seed, power):
    d = Drawn(100 * seed - power)
    draw = np.random.default_rng([seed, -power])
    d.w, c = 3.0, np.cross(d.n, d.e)
    while True:
        d.part = 10 ** draw.uniform(0.4, 2)
        across, late = 10.0**power * draw.uniform(1, 10), draw.uniform(0, 6)
        d.end = 2 * np.pi / 3.0 * draw.uniform(1.2, 3)
        a = d.part * d.m * d.g
        u = np.array([draw.uniform(-1, 1), 0.3 * across]) * a / d.w
        # what comes to rest while the force is less than friction stays for a while, and is none of these
        if goes_straight_back(a, d.m * d.g, d.w, u[0], d.end):
            break
    scene = d.scene()
    ball = scene.add(rb.Particle(d.mass), position=[0, 0, 0], velocity=u[0] * d.e + u[1] * c)
    scene.contact(ball, d.plane([0, 0, 0]), friction=rb.Coulomb(d.m))
    f, w = d.mass * a, d.w
    scene.apply(
        rb.Force(
            lambda t, r, v: [
                f * (x * np.sin(w * t) + across * y * np.sin(w * t + late)) for x, y in zip(d.e, c, strict=True)
            ]
        ),
        ball,
    )
    run = rb.simulate(scene, d.end, error=1e-9)
    truth = beside(a, d.m * d.g, w, across, late, u, d.end)
    at = np.linspace(0, run.end, 200)
    fastest = max(np.linalg.norm(run[ball].velocity(t)) for t in at)
    far = np.linalg.norm(np.ptp([run[ball].position(t) for t in at], axis=0))
    off = run[ball].velocity(run.end) - truth[0] * d.e - truth[1] * c
    assert np.linalg.norm(off) <= (2 * run.error + 3e-12) * fastest
    off = run[ball].position(run.end) - truth[2] * d.e - truth[3] * c
    assert np.linalg.norm(off) <= (2 * run.error + 3e-12) * far
