"""Bodies that strike each other by turns, without end in a finite time and at last in none: they go on together.
Against the same laws in 60 digits.
"""

import itertools
from decimal import Decimal, getcontext

import numpy as np
import pytest
import rbdyn as rb

G = 9.81
NOTHING = Decimal("1e-30")


class Column:
    """Points above each other on a floor: each flight by its quadratic, each impact by Newton's law for all that touch.

    Speeds and flights below 1e-30 are none."""

    def __init__(self, masses, gaps, speeds, e):
        self.mass, self.gap = [Decimal(m) for m in masses], [Decimal(g) for g in gaps]
        self.v, self.e, self.t = [Decimal(v) for v in speeds], Decimal(e), Decimal(0)
        self.closed = [g == 0 and self.rate(k) == 0 for k, g in enumerate(self.gap)]
        self.rests = []  # when contacts have come to rest, and which

    def close(self, k):
        if not self.closed[k]:
            self.rests.append((float(self.t), k))
        self.closed[k] = True

    def rate(self, k):
        return self.v[k] - (self.v[k - 1] if k else 0)

    def acceleration(self, k):
        return Decimal(0) if all(self.closed[: k + 1]) and self.v[k] == 0 else -Decimal(G)

    def flight(self, k):
        """How long until contact k strikes."""
        g, u = self.gap[k], self.rate(k)
        w = self.acceleration(k) - (self.acceleration(k - 1) if k else 0)
        if self.closed[k]:
            return Decimal("Infinity")
        if g == 0 and u < 0:
            return Decimal(0)
        if w == 0:
            return -g / u if u < 0 else Decimal("Infinity")
        return (u + (u * u - 2 * g * w).sqrt()) / -w

    def move(self, time):
        a = [self.acceleration(k) for k in range(len(self.v))]
        for k in range(len(self.v)):
            if not self.closed[k]:
                self.gap[k] += self.rate(k) * time + (a[k] - (a[k - 1] if k else 0)) * time * time / 2
        self.v = [v + a[k] * time for k, v in enumerate(self.v)]
        self.t += time

    def strike(self, struck):
        """0 <= P, u+ + e u- >= 0, one of each pair zero, of all that touch, by trying."""
        touch = [k for k in range(len(self.v)) if self.closed[k] or k in struck]
        before = {k: self.rate(k) for k in touch}
        for count in range(len(touch), 0, -1):
            for push in itertools.combinations(touch, count):
                after = self.pushed(push, {k: -self.e * before[k] if before[k] < 0 else Decimal(0) for k in push})
                if after is None:
                    continue
                v, impulses = after
                rates = {k: v[k] - (v[k - 1] if k else 0) for k in touch}
                lack = min(rates[k] + (self.e * before[k] if before[k] < 0 else 0) for k in touch)
                if min(impulses) >= -(NOTHING**2) and lack >= -NOTHING:
                    self.v = v
                    for k in touch:
                        self.gap[k] = Decimal(0)
                        if abs(rates[k]) < NOTHING:
                            self.close(k)
                            self.v[k] = self.v[k - 1] if k else Decimal(0)
                        else:
                            self.closed[k] = False
                    return
        raise AssertionError("no impulses")

    def pushed(self, push, wanted):
        """Velocities after impulses that give contacts the rates wanted."""
        n = len(push)
        inverse = [1 / m for m in self.mass]
        rows = []
        for k in push:
            row = []
            for j in push:
                own = (inverse[k] if j == k else 0) - (inverse[k] if j == k + 1 else 0)
                below = (inverse[k - 1] if k and j == k else 0) - (inverse[k - 1] if k and j == k - 1 else 0)
                row.append(Decimal(own) + Decimal(below))
            rows.append([*row, wanted[k] - self.rate(k)])
        for i in range(n):
            for r in range(n):
                if r != i:
                    part = rows[r][i] / rows[i][i]
                    rows[r] = [a - part * b for a, b in zip(rows[r], rows[i], strict=True)]
        impulses = [rows[i][n] / rows[i][i] for i in range(n)]
        v = list(self.v)
        for k, p in zip(push, impulses, strict=True):
            v[k] += p * inverse[k]
            if k:
                v[k - 1] -= p * inverse[k - 1]
        return v, impulses

    def run(self, until):
        """Goes on to a time."""
        until = Decimal(until)
        while self.t < until:
            times = [self.flight(k) for k in range(len(self.v))]
            first = min(times)
            if self.t + first >= until:
                return self.move(until - self.t)
            self.move(first)
            struck = [k for k, time in enumerate(times) if time - first <= NOTHING * NOTHING]
            # bounces that take no time are the last ones
            rests = [k for k in struck if abs(self.rate(k)) < NOTHING]
            for k in rests:
                self.gap[k] = Decimal(0)
                self.close(k)
                self.v[k] = self.v[k - 1] if k else Decimal(0)
            if len(rests) < len(struck):
                self.strike(struck)

    def heights(self):
        return [float(sum(self.gap[: k + 1])) for k in range(len(self.gap))]


def column(draw):
    """A smooth column of balls, all centred, of which some lie on each other as it starts, or fall together."""
    n, e, a = int(draw.integers(2, 5)), float(draw.choice([0.05, 0.1, 0.3, 0.6])), 0.125
    masses = [float(10 ** draw.uniform(-1, 1)) for _ in range(n)]
    lying = int(draw.integers(1, n))
    gaps, speeds = [0.0] * lying, [0.0] * lying
    for _ in range(lying, n):
        touches = draw.integers(4) == 0
        gaps.append(0.0 if touches else float(np.round(draw.uniform(0, 0.5) * 2**20) / 2**20))
        speeds.append(speeds[-1] if touches else float(draw.uniform(-2, 0)))
    scene, balls, touch, y = rb.Scene(gravity=[0, -G, 0]), [], [], 0.0
    for k in range(n):
        y += a + gaps[k]
        ball = scene.add(
            rb.shapes.sphere(masses[k], a), rb.Planar([1, 0, 0], [0, 1, 0]), position=[0, y], velocity=[0, speeds[k]]
        )
        below = balls[-1].sphere(a) if k else rb.Plane([0, 1, 0])
        touch.append(scene.contact(ball.sphere(a), below, restitution=e))
        balls.append(ball)
        y += a
    return scene, balls, touch, Column(masses, gaps, speeds, e), a


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_a_smooth_column_of_balls_collapses_as_the_laws_of_its_impacts_say(first):
    getcontext().prec = 60
    ends = 0
    for seed in range(first, first + 20):
        scene, balls, touch, exact, a = column(np.random.default_rng(seed))
        run = rb.simulate(scene, 1.5)
        for t in np.linspace(0, 1.5, 16)[1:]:
            exact.run(float(t))
            for k, (ball, height) in enumerate(zip(balls, exact.heights(), strict=True)):
                assert abs(run[ball].position(t)[1] - (2 * k + 1) * a - height) < 1e-9, (seed, t)
        # what has come to rest in one has in the other
        assert [run[c].state(1.5) != "open" for c in touch] == exact.closed, seed
        ends += sum(event.kind == "accumulation" for event in run.events)
    assert ends > 10


@pytest.mark.parametrize("seed", [9, 10, 14, 35, 46])
def test_bounces_of_three_balls_end_when_they_do(seed):
    """Balls that are dropped one above the other strike each other by turns some hundred times, ever sooner. One that
    has just left its floor is low yet when the next two strike, and is not struck with them."""
    getcontext().prec = 60
    draw = np.random.default_rng(seed)
    e, a = float(draw.uniform(0.3, 0.95)), 0.125
    masses = [float(10 ** draw.uniform(-1, 1)) for _ in range(3)]
    gaps = [float(np.round(draw.uniform(0, 0.5) * 2**20) / 2**20) for _ in range(3)]
    scene, balls, touch, y = rb.Scene(gravity=[0, -G, 0]), [], [], 0.0
    for k in range(3):
        y += a + gaps[k]
        ball = scene.add(rb.shapes.sphere(masses[k], a), rb.Planar([1, 0, 0], [0, 1, 0]), position=[0, y])
        below = balls[-1].sphere(a) if k else rb.Plane([0, 1, 0])
        touch.append(scene.contact(ball.sphere(a), below, restitution=e))
        balls.append(ball)
        y += a
    exact = Column(masses, gaps, [0.0] * 3, e)
    exact.run(1.5)
    run = rb.simulate(scene, 1.5, rtol=1e-12)
    told = [(event.time, touch.index(event.subject)) for event in run.events if event.kind == "accumulation"]
    assert told
    for time, _ in told:
        assert min(abs(time - rest) for rest, _ in exact.rests) <= 1e-11 * time
    assert [run[c].state(1.5) != "open" for c in touch] == exact.closed


@pytest.mark.parametrize("seed", range(8))
def test_a_ball_that_bounces_on_a_column_that_lies_still_comes_to_rest_alone(seed):
    """Its impacts press those below, whose rates are rounding: none of them opens, or comes to rest."""
    draw = np.random.default_rng(seed)
    scene, balls, a = rb.Scene(gravity=[0, -G, 0]), [], 0.125
    for k in range(4):
        ball = scene.add(
            rb.shapes.sphere(10 ** draw.uniform(-1, 1), a),
            rb.Planar([1, 0, 0], [0, 1, 0]),
            position=[0, (2 * k + 1) * a + (draw.uniform(0.1, 0.3) if k == 3 else 0.0)],
        )
        touch = scene.contact(ball.sphere(a), balls[-1].sphere(a) if k else rb.Plane([0, 1, 0]), restitution=0.6)
        balls.append(ball)
    run = rb.simulate(scene, 2.5)
    limits = [event for event in run.events if event.kind == "accumulation"]
    assert all(event.subject == touch for event in run.events if event.kind in ("accumulation", "detach"))
    assert len(limits) <= 1 and (limits or any(event.kind == "land" for event in run.events))


@pytest.mark.parametrize("e", [0.5, 0.9])
def test_a_box_that_is_dropped_flat_on_its_four_corners_bears_alike_on_all_of_them(e):
    """Each corner takes a quarter of every impact, m sqrt(2 g h) (1 + e) e^n, until (1 + e) / (1 - e) times the first
    flight."""
    m, h = 2.0, 0.5
    scene = rb.Scene(gravity=[0, 0, -G])
    box = scene.add(rb.shapes.box(m, [0.37, 0.259, 0.21]), position=[0.1, 0.2, 0.105 + h])
    corners = [
        scene.contact(box.point([x, y, -0.105]), rb.Plane([0, 0, 1]), restitution=e)
        for x in (-0.185, 0.185)
        for y in (-0.1295, 0.1295)
    ]
    first = (2 * h / G) ** 0.5
    run = rb.simulate(scene, 1.2 * first * (1 + e) / (1 - e))
    (limit,) = (event for event in run.events if event.kind == "accumulation")
    assert abs(limit.time - first * (1 + e) / (1 - e)) < 1e-12 * limit.time
    for corner in corners:
        impacts = [event for event in run.events if event.kind == "impact" and event.subject == corner]
        for n, event in enumerate(impacts[:20]):
            assert event.impulse[2] == pytest.approx(m * G * first * (1 + e) * e**n / 4, rel=1e-9)
    assert np.abs(run[box].angular_velocity(run.end)).max() < 1e-14 * G * first / 0.1


def mixed_column(draw):
    """Smooth boxes, each on its two lower corners, and on them balls, all centred: of them boxes move as points do."""
    n, e, a = int(draw.integers(3, 6)), float(draw.uniform(0.0, 0.9)), 0.125
    boxes = int(draw.integers(1, n + 1))
    masses = [float(10 ** draw.uniform(-1, 1)) for _ in range(n)]
    gaps, speeds = [float(draw.uniform(0.1, 1.0))], [float(draw.uniform(-2, 2))]
    for _ in range(1, n):
        touches = draw.integers(2) == 0
        gaps.append(0.0 if touches else float(draw.uniform(0, 0.5)))
        speeds.append(speeds[-1] if touches else float(draw.uniform(-2, 1)))
    scene, bodies, y, middles = rb.Scene(gravity=[0, -G, 0]), [], 0.0, []
    for k in range(n):
        y += a + gaps[k]
        shape = rb.shapes.box(masses[k], [0.3, 2 * a, 0.2]) if k < boxes else rb.shapes.sphere(masses[k], a)
        body = scene.add(shape, rb.Planar([1, 0, 0], [0, 1, 0]), position=[0, y], velocity=[0, speeds[k]])
        below = rb.Plane([0, 1, 0])
        if k:
            below = bodies[-1].plane([0, 1, 0], [0, a, 0]) if k <= boxes else bodies[-1].sphere(a)
        for part in [body.point([x, -a, 0]) for x in (-0.15, 0.15)] if k < boxes else [body.sphere(a)]:
            scene.contact(part, below, restitution=e)
        bodies.append(body)
        middles.append((2 * k + 1) * a)
        y += a
    return scene, bodies, middles, Column(masses, gaps, speeds, e)


@pytest.mark.parametrize("seed", [2, 5, 14, 16, 20, 26, 31, 35, 36, 43, 46, 48, 57])
def test_boxes_and_balls_that_fall_along_touching_go_on_as_points_do(seed):
    """Nothing presses them together as they fall: what rounding makes of their forces is none beside their weight."""
    getcontext().prec = 60
    scene, bodies, middles, exact = mixed_column(np.random.default_rng(seed))
    run = rb.simulate(scene, 1.0)
    for t in (0.25, 0.5, 0.75, 1.0):
        exact.run(t)
        for body, middle, height in zip(bodies, middles, exact.heights(), strict=True):
            assert abs(run[body].position(t)[1] - middle - height) < 1e-9
            assert abs(run[body].angle(t)) < 1e-9
