"""Contacts that open where their force comes to zero, without an impulse, against closed forms.

With a force m g - k t the contact opens at t0 = m g / k, and from there on the gap is k (t - t0)^3 / (6 m): neither it
nor its first two derivatives tell which way it goes, and each of them is computed as a difference of large terms.
"""

import math
from itertools import pairwise

import numpy as np
import pytest
import rbdyn as rb


def direction(rng, horizontal=False):
    n = np.array([0.0, 0.0, 1.0]) if horizontal else rng.normal(size=3)
    return n / np.linalg.norm(n)


def kinds(run):
    return [event.kind for event in run.events]


@pytest.mark.parametrize("options", [{}, {"rtol": 1e-9}])
@pytest.mark.parametrize("friction", [None, 0.02, 0.3, math.inf])
@pytest.mark.parametrize("horizontal", [True, False])
def test_what_a_growing_force_lifts_leaves_once(horizontal, friction, options):
    for seed in range(25):
        rng = np.random.default_rng(seed)
        n = direction(rng, horizontal)
        # of grains, and of mountains on moons
        m, length = 10.0 ** rng.uniform(-6, 6), 10.0 ** rng.uniform(-3, 6)
        g, turn = 10.0 ** rng.uniform(-4, 2), rng.uniform(0.1, 10)
        k = m * g / (turn * math.sqrt(length / g))
        t0 = m * g / k
        scene = rb.Scene(gravity=-g * n)
        ball = seed % 2 == 0
        body = rb.shapes.sphere(m, length) if ball else rb.Particle(m)
        b = scene.add(body, position=length * n if ball else [0, 0, 0])
        contact = scene.contact(
            b.sphere(length) if ball else b, rb.Plane(n), friction=None if friction is None else rb.Coulomb(friction)
        )
        scene.apply(rb.Force(lambda t, *_, k=k, n=n: [k * t * n[0], k * t * n[1], k * t * n[2]]), b)
        run = rb.simulate(scene, until=1.5 * t0, **options)
        assert kinds(run) == ["detach"], (seed, kinds(run))
        assert math.isclose(run.events[0].time, t0, rel_tol=1e-14 if not options else 1e-12)
        exact = k * (0.5 * t0) ** 3 / (6 * m)
        assert math.isclose(run[contact].gap(run.end), exact, rel_tol=1e-9), seed


@pytest.mark.parametrize("decades", [-8, -6, -4, -2])
def test_what_is_lifted_for_a_moment_comes_back_once(decades):
    # N = k s^2 - d, s = t - 1: the gap is k (s + a)^3 (3 a - s) / 12 with a = sqrt(d / k)
    for part in (1.0, 2.0, 3.3, 5.0, 7.7):
        d = part * 10.0**decades
        a = math.sqrt(d / 2)
        scene = rb.Scene(gravity=[0, 0, -10])
        b = scene.add(rb.Particle(1.0))
        scene.contact(b, rb.Plane([0, 0, 1]))
        scene.apply(rb.Force(lambda t, *_, d=d: [0, 0, 10 - 2 * (t - 1) ** 2 + d]), b)
        run = rb.simulate(scene, until=2.5)
        assert kinds(run) == ["detach", "land", "rest"], d
        # the time of a zero of k s^2 - d is known to the rounding of forces over its slope
        known = 1e-14 / (4 * a) * 10
        assert abs(run.events[0].time - (1 - a)) < known
        assert abs(run.events[1].time - (1 + 3 * a)) < 10 * known


def test_a_hinged_rod_that_a_growing_torque_lifts_leaves_once():
    m, d, inertia, g, k = 2.0, 0.5, 0.2, 10.0, 4.0
    for angle in (0.0, 0.3, -0.3):
        scene = rb.Scene(gravity=[0, -g, 0])
        rod = scene.add(rb.RigidBody(m, [0.01, inertia, inertia], com=[d, 0, 0]), rb.Revolute([0, 0, 1]), angle=angle)
        scene.contact(rod.point([1, 0, 0]), rb.Plane([0, 1, 0], [0, math.sin(angle), 0]))
        scene.apply(rb.JointTorque(lambda t, q, w: k * t), rod)
        t0 = m * g * d * math.cos(angle) / k
        run = rb.simulate(scene, until=1.3 * t0, error=1e-9)
        assert kinds(run) == ["detach"]
        assert math.isclose(run.events[0].time, t0, rel_tol=1e-13)


def test_what_slides_leaves_with_the_force_that_slows_it():
    # v' = -mu (g - k t / m): the slip goes on, and ends with N
    for seed in range(20):
        rng = np.random.default_rng(seed)
        m, g, k, mu = rng.uniform(0.1, 5), rng.uniform(1, 20), rng.uniform(1, 10), 0.3
        t0 = m * g / k
        along = rng.normal(size=2)
        fast = 2 * mu * g * t0
        scene = rb.Scene(gravity=[0, 0, -g])
        b = scene.add(rb.Particle(m), position=[0, 0, 0], velocity=[*(fast * along / np.linalg.norm(along)), 0])
        scene.contact(b, rb.Plane([0, 0, 1]), friction=rb.Coulomb(mu))
        scene.apply(rb.Force(lambda t, *_, k=k: [0, 0, k * t]), b)
        run = rb.simulate(scene, until=1.2 * t0)
        assert kinds(run) == ["detach"], seed
        assert math.isclose(run.events[0].time, t0, rel_tol=1e-13)
        assert math.isclose(np.linalg.norm(run[b].velocity(run.end)[:2]), fast - mu * g * t0 / 2, rel_tol=1e-12)


@pytest.mark.parametrize("friction", [None, rb.Coulomb(0.4)])
def test_two_feet_lift_off_at_once(friction):
    for seed in range(10):
        rng = np.random.default_rng(seed)
        m, g, k = rng.uniform(0.1, 10, 3)
        t0 = m * g / k
        scene = rb.Scene(gravity=[0, 0, -g])
        box = scene.add(rb.RigidBody(m, [m, m, m]), rb.Planar([1, 0, 0], [0, 0, 1]), position=[0, 0.5])
        for side in (-1, 1):
            scene.contact(box.point([side, 0, -0.5]), rb.Plane([0, 0, 1]), friction=friction)
        scene.apply(rb.Force(lambda t, *_, k=k: [0, 0, k * t]), box)
        run = rb.simulate(scene, until=1.4 * t0)
        assert kinds(run) == ["detach", "detach"], seed
        assert math.isclose(run[box].position(run.end)[2] - 0.5, k * (0.4 * t0) ** 3 / (6 * m), rel_tol=1e-9)


def test_a_force_that_only_touches_zero_pushes_on():
    # released at the height of its centre in a bowl, N = 3 m g cos(angle) is zero where the particle turns
    for g in (9.81, 1.62, 3.7):
        for radius in (0.3, 1.0, 2.0):
            scene = rb.Scene(gravity=[0, 0, -g])
            b = scene.add(rb.Particle(1.0), position=[radius, 0, 0])
            scene.contact(b, rb.Sphere([0, 0, 0], radius, inside=True))
            quarter = 1.8540746773013719 * math.sqrt(radius / g)  # K(1/sqrt 2)
            run = rb.simulate(scene, until=9 * quarter)
            assert kinds(run) == []
            assert abs(run[b].position(8 * quarter)[0] - radius) < 1e-9 * radius


@pytest.mark.parametrize("friction", [None, rb.Coulomb(0.3)])
@pytest.mark.parametrize("e", [0.99, 0.997])
def test_bounces_that_lose_little_have_their_limit(e, friction):
    scene = rb.Scene(gravity=[0, 0, -10])
    b = scene.add(rb.Particle(1.0), position=[0, 0, 1])
    scene.contact(b, rb.Plane([0, 0, 1]), restitution=e, friction=friction)
    limit = math.sqrt(0.2) * (1 + 2 * e / (1 - e))
    run = rb.simulate(scene, until=1.2 * limit, rtol=1e-12)
    assert run.events[-1].kind == "accumulation"
    assert math.isclose(run.events[-1].time, limit, rel_tol=1e-12)


@pytest.mark.parametrize("friction", [None, rb.Coulomb(0.5)])
@pytest.mark.parametrize("options", [{}, {"rtol": 1e-9}])
def test_a_stack_at_rest_stays_to_the_bit(friction, options):
    radius = 0.1
    for masses in ([1, 2, 3, 4], [0.1, 0.7, 0.3, 0.9]):
        scene = rb.Scene(gravity=[0, 0, -9.81])
        heights = [radius + 2 * radius * i for i in range(4)]
        balls = [
            scene.add(rb.shapes.sphere(m, radius), position=[0, 0, z]) for m, z in zip(masses, heights, strict=True)
        ]
        contacts = [scene.contact(balls[0].sphere(radius), rb.Plane([0, 0, 1]), friction=friction)]
        for below, above in pairwise(balls):
            contacts.append(scene.contact(above.sphere(radius), below.sphere(radius), friction=friction))
        run = rb.simulate(scene, until=1e6, **options)
        assert not run.events
        for ball, z in zip(balls, heights, strict=True):
            assert abs(run[ball].position(1e6)[2] - z) < 1e-15
        weight = 0.0
        for mass, contact in zip(reversed(masses), reversed(contacts), strict=True):
            weight += 9.81 * mass
            assert math.isclose(run[contact].force(1e6)[2], weight, rel_tol=1e-13)
