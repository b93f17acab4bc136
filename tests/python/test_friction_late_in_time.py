"""Friction is the same whenever a run begins: time is then known to 2^-52 of itself, and no more is lost.

Where a slip ends, and where it begins to turn, u/|u| changes within less time than that. Against closed forms, and
against the same scenes begun at zero.
"""

import math

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

EPSILON = np.finfo(float).eps
G = 9.81


def incline(angle):
    return rb.Scene(gravity=[G * math.sin(angle), 0, -G * math.cos(angle)])


def particle(mu, angle, velocity):
    scene = incline(angle)
    scene.contact(scene.add(rb.Particle(1.0), velocity=velocity), rb.Plane([0, 0, 1]), friction=rb.Coulomb(mu))
    return scene, 1.0


def box(mu, angle, velocity):
    scene = incline(angle)
    body = scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.15]), position=[0, 0, 0.1], velocity=velocity)
    for x, y in [(1, 1), (-1, 1), (-1, -1), (1, -1)]:
        scene.contact(body.point([x, y, -0.1]), rb.Plane([0, 0, 1]), friction=rb.Coulomb(mu))
    return scene, 1.0


def ball(mu, angle, velocity):
    """It rolls; what resists that is mu of its weight, and 2/5 of its mass turns with it."""
    scene, r = incline(angle), 0.1
    body = scene.add(
        rb.RigidBody(1.0, [0.4 * r * r] * 3),
        position=[0, 0, r],
        velocity=velocity,
        angular_velocity=[-velocity[1] / r, velocity[0] / r, 0],
    )
    scene.contact(body.sphere(r), rb.Plane([0, 0, 1]), friction=rb.Coulomb(2.0, rolling=mu * r))
    return scene, 5 / 7


@pytest.mark.parametrize("build", [particle, box, ball])
@pytest.mark.parametrize("late", [0.0, 1e2, 1e4, 1e6])
@pytest.mark.parametrize(
    "mu, ratio, speed, phi",
    [
        (0.26348613830278034, 8.1, 23.2, -1.0877),
        (0.5539146932514059, 11.6, 23.7, 2.7147),
        (0.14044775839024767, 5.8, 0.42, 2.772),
        (0.16500992245907872, 35.2, 0.518, -2.0134),
        (0.3521178394998816, 30.4, 2.54, 2.3665),
        (0.005, 15.0, 1.3, 0.7),
    ],
)
def test_what_is_thrown_across_an_incline_stops_when_it_does(build, late, mu, ratio, speed, phi):
    # friction a along the slip u and weight s down the incline: a |u| + s u_x falls by a^2 - s^2 each second
    angle = math.atan(mu / ratio)
    velocity = [speed * math.cos(phi), speed * math.sin(phi), 0]
    scene, part = build(mu, angle, velocity)
    a, s = part * mu * G * math.cos(angle), part * G * math.sin(angle)
    duration = (a * math.hypot(*velocity) + s * velocity[0]) / (a * a - s * s)
    start, error = late * duration, max(1e-9, 4 * EPSILON * late)
    run = rb.simulate(scene, start=start, until=start + 1.5 * duration, error=error)
    assert {e.kind for e in run.events} == {"stick", "rest"}
    stopped = max(e.time for e in run.events)
    assert abs((stopped - start) - duration) <= (run.error + 4 * EPSILON) * duration + 1.5 * EPSILON * start


def plate(seed):
    """On three feet, sliding and turning."""
    g = np.random.default_rng([3, seed])
    angles = np.array([0, 2.1, 4.2]) + g.uniform(-0.5, 0.5, 3)
    velocity, spin = g.normal(size=2), g.normal() * 3.0
    scene = rb.Scene(gravity=[0, 0, -G])
    body = scene.add(
        rb.RigidBody(1.0, [0.2, 0.2, 0.35]),
        position=[0, 0, 0.1],
        velocity=[*velocity, 0],
        angular_velocity=[0, 0, spin],
    )
    for a in angles:
        scene.contact(body.point([math.cos(a), math.sin(a), -0.1]), rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.3))
    return scene, body


@pytest.mark.parametrize("start", [10.0, 100.0, 1e3, 1e4])
@pytest.mark.parametrize("seed", [5, 13, 22, 31, 40, 48])
def test_plates_on_three_feet_begin_to_turn_at_any_time(seed, start):
    # their feet leave the lines they began along within the rounding of the time
    scene, body = plate(seed)
    first = rb.simulate(scene, 0.5, error=1e-8)
    later = rb.simulate(scene, start=start, until=start + 0.5, error=1e-8)
    assert [e.kind for e in later.events] == [e.kind for e in first.events]
    for t in (0.1, 0.3, 0.5):
        off = later[body].velocity(start + t) - first[body].velocity(t)
        assert np.linalg.norm(off) <= 2 * (first.error + later.error) + 64 * EPSILON * start * G


def sledge(seed, start):
    """On three feet, turning, pushed to and fro."""
    g = np.random.default_rng([4, seed])
    velocity, spin, mu = g.normal(size=2), g.normal(), g.choice([0.1, 0.3, 0.8])
    size, pace = g.uniform(1, 5), g.uniform(2, 8)
    scene = rb.Scene(gravity=[0, 0, -G])
    body = scene.add(
        rb.RigidBody(1.3, [0.15, 0.18, 0.2]),
        position=[0, 0, 0.2],
        velocity=[*velocity, 0],
        angular_velocity=[0, 0, spin],
    )
    for a in (0, 2.1, 4.2):
        foot = body.point([0.8 * math.cos(a), 0.8 * math.sin(a), -0.2])
        scene.contact(foot, rb.Plane([0, 0, 1]), friction=rb.Coulomb(1.3 * mu, mu))
    scene.apply(rb.Force(lambda t, r, v: size * np.sin(pace * (t - start)) * np.array([1.0, 0.3, 0.0])), body)
    return scene, body


def events_are_alike(scene_at, start, length, error):
    """Of a scene that begins at 0 and, with its functions of time moved along, at `start`."""
    first, later = (rb.simulate(scene_at(t), start=t, until=t + length, error=error) for t in (0.0, start))
    assert [e.kind for e in later.events] == [e.kind for e in first.events]
    for a, b in zip(first.events, later.events, strict=True):
        assert abs((b.time - start) - a.time) <= 2 * (first.error + later.error) + 16 * EPSILON * start


@pytest.mark.parametrize("start", [1e3, 1e5])
@pytest.mark.parametrize("seed", range(12))
def test_sledges_that_are_pushed_to_and_fro_move_alike_at_any_time(seed, start):
    events_are_alike(lambda t: sledge(seed, t)[0], start, 1.0, 1e-7)


def on_a_shaken_table(seed, start):
    g = np.random.default_rng([6, seed])
    pace, size, mu, velocity = g.uniform(2, 6), g.uniform(0.05, 0.3), g.uniform(0.1, 0.5), g.normal(size=2)
    scene = rb.Scene(gravity=[0, 0, -G])
    shaken = rb.Prismatic([1, 0, 0], motion=lambda t: size * np.sin(pace * (t - start)))
    table = scene.add(rb.RigidBody(1.0, [1.0] * 3), shaken)
    body = scene.add(rb.Particle(1.0), velocity=[velocity[0] + size * pace, velocity[1], 0])
    scene.contact(body, table.plane([0, 0, 1]), friction=rb.Coulomb(1.1 * mu, mu))
    return scene, body


@pytest.mark.parametrize("seed, start", [(13, 1e4), (6, 1e4), (13, 1e5), (3, 1e5)])
def test_what_comes_to_rest_on_a_shaken_table_does_so_at_any_time(seed, start):
    events_are_alike(lambda t: on_a_shaken_table(seed, t)[0], start, 2.0, 1e-8)


def ball_on_a_table(size, pace, start, r, velocity, spin, friction):
    """A ball on a table that is moved by size sin(pace (t - start)) along x."""
    scene = rb.Scene(gravity=[0, 0, -G])
    shaken = rb.Prismatic([1, 0, 0], motion=lambda t: size * np.sin(pace * (t - start)))
    table = scene.add(rb.RigidBody(1.0, [1.0] * 3), shaken)
    body = scene.add(rb.RigidBody(1.0, [0.4 * r * r] * 3), position=[0, 0, r], velocity=velocity, angular_velocity=spin)
    scene.contact(body.sphere(r), table.plane([0, 0, 1]), friction=friction)
    return scene, body


def ball_on_a_shaken_table(seed, start):
    """It slides, and begins to roll."""
    g = np.random.default_rng([77, seed])
    size, pace, r, mu = g.uniform(0.02, 0.2), g.uniform(2, 8), g.uniform(0.05, 0.3), g.uniform(0.1, 0.6)
    v, spin = g.normal(size=2), g.normal(size=3)
    scene, body = ball_on_a_table(size, pace, start, r, [v[0] + size * pace, v[1], 0], spin, rb.Coulomb(mu))
    return scene, body, (size, pace, mu, v + r * np.array([-spin[1], spin[0]]))


@pytest.mark.parametrize("start", [0.0, 1e2, 1e4])
@pytest.mark.parametrize("seed", range(12))
def test_what_slides_on_a_shaken_table_begins_to_roll_when_it_does(seed, start):
    """Its slip u falls by 7/2 mu g u/|u| and by what the table gains. What holds the table feels u/|u|, too, which is
    known no better than u is where that ends: 32 of 60 such scenes were refused, two of 12 from t = 0 on."""
    scene, body, (size, pace, mu, u) = ball_on_a_shaken_table(seed, start)

    def rate(t, u):
        return -3.5 * mu * G * u / np.linalg.norm(u) + [size * pace**2 * np.sin(pace * t), 0]

    ends = solve_ivp(
        rate, (0, 2), u, method="DOP853", rtol=1e-11, atol=1e-13, events=stopped(lambda t, u: np.linalg.norm(u) - 1e-5)
    )
    slope = np.linalg.norm(rate(ends.t[-1], ends.y[:, -1]))
    run = rb.simulate(scene, start=start, until=start + 2.0, error=1e-9)
    assert run.error <= 1e-9
    first = run.events[0]
    assert first.kind == "stick"
    # what is left of the slip takes some 1e-5 / slope, but for how far it is from its line then
    assert first.time - start == pytest.approx(ends.t[-1] + 1e-5 / slope, abs=3e-6 / slope)
    same, still, _ = ball_on_a_shaken_table(seed, 0.0)
    wanted = rb.simulate(same, 2.0, rtol=1e-13)
    for t in (0.5, 1.0, 2.0):
        off = run[body].velocity(start + t) - wanted[still].velocity(t)
        assert np.linalg.norm(off) <= 1e-9 * np.linalg.norm(wanted[still].velocity(0.0)) + 64 * EPSILON * start


def stopped(event):
    event.terminal = True
    return event


@pytest.mark.parametrize("start", [0.0, 1e2, 1e3, 1e4, 1e5])
@pytest.mark.parametrize("seed", range(8))
def test_a_ball_on_a_shaken_table_rolls_to_and_fro_against_its_resistance(seed, start):
    """On a table with the acceleration A it rolls with (-A -+ c g / r) 5/7 against it. Where it turns round its rate is
    known to the rounding of the time, and went on switching (10 of 12 begun at 1e4 s)."""
    g = np.random.default_rng([78, seed])
    size, pace, r = g.uniform(0.02, 0.2), g.uniform(2, 8), g.uniform(0.05, 0.3)
    push = size * pace**2
    resists = g.uniform(0.1, 0.4) * push  # c g / r
    friction = rb.Coulomb(max(0.1, push / G), rolling=resists * r / G)
    scene, body = ball_on_a_table(size, pace, start, r, [size * pace, 0, 0], [0, 0, 0], friction)
    until = 8.0 / pace
    run = rb.simulate(scene, start=start, until=start + until, error=1e-8)
    begins = math.asin(resists / push) / pace
    times, way = [begins], 1.0
    while True:
        since = times[-1]

        def speed(t, since=since, way=way):
            return size * pace * (math.cos(pace * since) - math.cos(pace * t)) - way * resists * (t - since)

        after = np.linspace(since, until, 4001)[1:]
        turned = np.nonzero([way * speed(t) < 0 for t in after])[0]
        turned = turned[turned > 2]
        if turned.size == 0:
            break
        times.append(brentq(speed, after[turned[0] - 1], after[turned[0]], xtol=1e-15))
        way = -way
        assert abs(push * math.sin(pace * times[-1])) > resists
    assert [e.kind for e in run.events] == ["slip"] + ["reverse"] * (len(times) - 1)
    assert len(times) > 1
    for e, t in zip(run.events, times, strict=True):
        assert abs(e.time - start - t) <= 2e-8 * t + 8 * EPSILON * start


TURN = 2 * np.longdouble(math.pi) + np.longdouble(2.4492935982947064e-16)


def drive(size, pace, phase, start, is_plain):
    """size sin(pace (t - start) + phase), as it stands or as size sin(pace t + c)."""
    if not is_plain:
        return lambda t: size * np.sin(pace * (t - start) + phase)
    c = phase - np.longdouble(pace) * np.longdouble(start)
    c = float(c - TURN * np.round(c / TURN))
    return lambda t: size * np.sin(pace * t + c)


def on_a_driven_table(seed, start, is_plain, turns, feet):
    """A particle, or what stands on three feet, on a table that slides or turns to and fro."""
    g = np.random.default_rng([6, seed])
    pace, size, mu, velocity = g.uniform(2, 6), g.uniform(0.05, 0.3), g.uniform(0.1, 0.5), g.normal(size=2)
    motion = drive(size, pace, g.uniform(0, 6), start, is_plain)
    scene = rb.Scene(gravity=[0, 0, -G])
    joint = rb.Revolute([0, 0, 1], motion=motion) if turns else rb.Prismatic([1, 0, 0], motion=motion)
    table = scene.add(rb.RigidBody(1.0, [1.0] * 3), joint)
    friction = rb.Coulomb(1.1 * mu, mu)
    if feet:
        spin = [0, 0, 1.0]
        body = scene.add(
            rb.RigidBody(1.0, [0.01] * 3), position=[0.3, 0, 0.02], velocity=[*velocity, 0], angular_velocity=spin
        )
        for x, y in [(0.1, 0.1), (-0.1, 0.1), (0, -0.1)]:
            scene.contact(body.point([x, y, -0.02]), table.plane([0, 0, 1]), friction=friction)
    else:
        body = scene.add(rb.Particle(1.0), position=[0.3, 0, 0], velocity=[*velocity, 0])
        scene.contact(body, table.plane([0, 0, 1]), friction=friction)
    return scene


@pytest.mark.parametrize("feet", [False, True])
@pytest.mark.parametrize("turns", [False, True])
@pytest.mark.parametrize("start", [1e3, 1e5])
@pytest.mark.parametrize("seed", range(6))
def test_rests_on_driven_tables_are_told_however_their_time_is_written(seed, start, turns, feet):
    """The table's velocity is known to the rounding of the time times its acceleration, and what turns with it turns
    that: before a first impact that was not seen, and where the drive was written as sin(w t + c) 31 of these 48 lacked
    a rest."""

    def events(at, is_plain):
        scene = on_a_driven_table(seed, at, is_plain, turns, feet)
        run = rb.simulate(scene, start=at, until=at + 2.0, error=1e-8)
        return [(e.kind, e.time - at) for e in run.events]

    first = events(0.0, False)
    for is_plain in (False, True):
        told = events(start, is_plain)
        assert [kind for kind, _ in told] == [kind for kind, _ in first]
        assert [t for _, t in told] == pytest.approx([t for _, t in first], rel=4e-8, abs=64 * EPSILON * start)


@pytest.mark.parametrize("is_plain", [False, True])
@pytest.mark.parametrize("start", [0.0, 1e3, 1e5])
def test_what_creeps_on_a_driven_table_is_not_told_at_rest(start, is_plain):
    """A ball that no longer slips on a table that goes to and fro rolls on, however slowly. It sticks after 6e-5 s, of
    which the nearest double at 1e5 s tells 1e-7."""
    scene = rb.Scene(gravity=[0, 0, -G])
    motion = drive(1e-3, 3.0, 0.5 * math.pi, start, is_plain)
    table = scene.add(rb.RigidBody(1.0, [1.0] * 3), rb.Prismatic([1, 0, 0], motion=motion))
    r = 0.1
    body = scene.add(rb.RigidBody(1.0, [0.4 * r * r] * 3), position=[0, 0, r], velocity=[1e-3, 0, 0])
    scene.contact(body.sphere(r), table.plane([0, 0, 1]), friction=rb.Coulomb(0.5))
    run = rb.simulate(scene, start=start, until=start + 1.0, error=1e-6)
    assert [e.kind for e in run.events] == ["stick"]
