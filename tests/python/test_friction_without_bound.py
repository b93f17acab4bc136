"""Coulomb(inf) is the limit of ever larger coefficients where sticking would have to be pulled: it slides, unpressed.

Then the force acts along the surface alone, whatever it needs to be for what touches to stay there, and the centre of
mass moves across the surface as if nothing touched: its height is a parabola, and the tilt is what that makes of it.
"""

import math

import numpy as np
import pytest
import rbdyn as rb

G = 9.8125
LENGTH, THICK, RADIUS = 0.3, 0.1, 0.05
INERTIA = (LENGTH**2 + THICK**2) / 12
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


def start_of(seed):
    rng = np.random.default_rng(seed)
    slope, angle = rng.uniform(-0.3, 0.3), rng.uniform(-0.6, 0.6)
    return slope, angle, rng.uniform(-2, 2, 2), rng.uniform(-2, 2)


def dropped(seed, mu, *, is_rod, restitution=0.0):
    """A rod with balls at its ends, or a box, above a slope."""
    slope, angle, velocity, rate = start_of(seed)
    scene = rb.Scene(gravity=[G * math.sin(slope), -G * math.cos(slope), 0])
    body = scene.add(
        rb.shapes.box(1.0, [LENGTH, THICK if is_rod else 2 * THICK, THICK]),
        rb.Planar([1, 0, 0], [0, 1, 0]),
        position=[0, 0.5],
        angle=angle,
        velocity=velocity,
        rate=rate,
    )
    ends = (-LENGTH / 2, LENGTH / 2)
    parts = [body.sphere(RADIUS, [x, 0, 0]) for x in ends]
    if not is_rod:
        parts = [body.point([x, y, 0]) for x in ends for y in (-THICK, THICK)]
    floor = rb.Plane([0, 1, 0])
    return scene, body, [scene.contact(p, floor, friction=rb.Coulomb(mu), restitution=restitution) for p in parts]


def root(f, low, high):
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if f(low) * f(middle) <= 0 else (middle, high)
    return 0.5 * (low + high)


def by_hand(seed):
    """The times at which the ends of the rod come down, and where it lies then."""
    slope, angle, (vx, vy), rate = start_of(seed)
    gx, gy, half = G * math.sin(slope), G * math.cos(slope), LENGTH / 2
    height = lambda t: 0.5 + vy * t - gy * t * t / 2 - half * abs(math.sin(angle + rate * t)) - RADIUS  # noqa: E731
    t0 = next(t for t in np.arange(0.0, 2.0, 1e-3) if height(t) < 0)
    t0 = root(height, t0 - 1e-3, t0)
    tilt = angle + rate * t0
    side = -1.0 if math.sin(tilt) > 0 else 1.0  # the end that is low
    x, y = vx * t0 + gx * t0**2 / 2, 0.5 + vy * t0 - gy * t0**2 / 2
    # the impact stops what touches
    arm = np.array([side * half * math.cos(tilt), side * half * math.sin(tilt) - RADIUS])
    v = np.array([vx + gx * t0, vy - gy * t0])
    lever = np.array([-arm[1], arm[0]])
    impulse = np.linalg.solve(np.eye(2) + np.outer(lever, lever) / INERTIA, -(v + rate * lever))
    v, rate = v + impulse, rate + lever @ impulse / INERTIA
    # then it falls: y = RADIUS - side half sin(tilt)
    fall = lambda t: y + v[1] * t - gy * t * t / 2  # noqa: E731
    end = root(lambda t: fall(t) - RADIUS, 1e-9, next(t for t in np.arange(0.0, 1.0, 1e-3) if fall(t) < RADIUS))

    def pull(t):
        sine = (RADIUS - fall(t)) / (side * half)
        cosine = math.sqrt(1 - sine * sine)
        turn = -(v[1] - gy * t) / (side * half * cosine)
        bend = (gy / (side * half) + turn * turn * sine) / cosine
        return INERTIA * bend / fall(t)  # of the force at the floor about the centre

    times = 0.5 * end * (1 + NODES)
    x += v[0] * end + gx * end**2 / 2 + 0.5 * end * WEIGHTS @ [(end - t) * pull(t) for t in times]
    return t0, t0 + end, x


@pytest.mark.parametrize("seed", [0, 1, 2, 4, 5, 6, 9, 11, 13, 14])
def test_what_would_have_to_be_pulled_slides_and_falls_freely(seed):
    scene, body, ends = dropped(seed, math.inf, is_rod=True)
    run = rb.simulate(scene, 1.0, error=1e-11)
    first, second, place = by_hand(seed)
    touch = next(end for end in ends if end == run.events[0].subject)
    assert abs(run.events[0].time - first) < 1e-12
    lands = run.events.times("land")
    assert abs(lands[1] - second) <= max(run.error, 1e-12) * second
    assert abs(run[body].position(lands[1])[0] - place) < 1e-11
    middle = 0.5 * (first + second)
    force = run[touch].force(middle)
    assert run[touch].state(middle) == "slides" and force[0] * run[touch].slip(middle)[0] < 0
    assert abs(force[1]) < 1e-13 * abs(force[0]) and abs(run[touch].gap(middle)) < 1e-14
    assert {run[end].state(run.end) for end in ends} == {"sticks"}


@pytest.mark.parametrize("restitution", [0.0, 0.5])
@pytest.mark.parametrize("is_rod", [False, True])
def test_friction_without_bound_is_the_limit_of_large_friction(is_rod, restitution):
    ran = 0
    for seed in range(12):
        motions = []
        for mu in (math.inf, 1e9):
            scene, body, _ = dropped(seed, mu, is_rod=is_rod, restitution=restitution)
            try:
                motions.append((rb.simulate(scene, 1.0, max_steps=20000), body))
            except rb.AccuracyError:  # said to be unknown
                break
        if len(motions) < 2:
            continue
        (run, body), (near, other) = motions
        ran += 1
        assert np.abs(run[body].position(1.0) - near[other].position(1.0)).max() < 1e-6
        assert abs(run[body].angle(1.0) - near[other].angle(1.0)) < 1e-6
    assert ran >= 10


def test_a_plate_in_space_drags_the_foot_that_it_comes_down_on():
    """The foot would have to be pulled to stick: it slides, unpressed, until the next one lands."""
    landed = []
    for mu in (math.inf, 1e10, 1e8):
        scene = rb.Scene(gravity=[0, 0, -9.81])
        a, b, h = 0.5221406442071022, 0.6949129451272993, 0.08447054027319553
        tilt = np.array([-0.007022033568558819, -0.1916230725399971, 0.0])
        angle = np.linalg.norm(tilt)
        x, y, z = tilt / angle
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        attitude = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
        feet = [np.array([p * a, q * b, -h]) for p in (-1, 1) for q in (-1, 1)]
        com = [0.04881430520002745, -0.20280928884773092, 0.0]
        body = rb.RigidBody(1.0, 4 / 12 * np.array([b * b + h * h, a * a + h * h, a * a + b * b]), com=com)
        height = 0.5 - min((attitude @ foot)[2] for foot in feet)
        plate = scene.add(body, position=[0.1, -0.2, height], velocity=[0, 2.4387058312696266, -2.0], attitude=attitude)
        for foot in feet:
            scene.contact(plate.point(foot), rb.Plane([0, 0, 1]), friction=rb.Coulomb(mu))
        run = rb.simulate(scene, 0.25)
        landed.append([*run.events.times("land")[:2], *run[plate].position(0.25)])
    assert landed[0][1] - landed[0][0] > 1e-3
    np.testing.assert_allclose(landed[1:], [landed[0]] * 2, rtol=0, atol=1e-6)
