"""What has one freedom comes to rest in all its joints and contacts at one instant. There it goes straight back, or
rests, where friction of all of them together holds it: one choice of many, so that it breaks away when none is left.
Against all bodies apart (one_freedom_by_hand.py), and statics scanned."""

import math

import numpy as np
import pytest
import rbdyn as rb
from one_freedom_by_hand import Mechanism, g
from scipy.optimize import fsolve, minimize


def bar(mass, length):
    inertia = mass * length**2 / 12
    return rb.RigidBody(mass, [inertia / 2, inertia / 2, inertia], com=[length / 2, 0, 0])


def rough(mu, **more):
    return {"friction": rb.Coulomb(mu), **more} if mu else {}


def two_bars(lengths, masses, mu, radii, angles, rates, torque=None):
    """On pins one and two, the tip on a floor; mu of both pins and of the floor."""
    scene = rb.Scene(gravity=[0, -g, 0])
    first = scene.add(
        bar(masses[0], lengths[0]),
        rb.Revolute([0, 0, 1], **rough(mu[0], pin_radius=radii[0])),
        angle=angles[0],
        rate=rates[0],
    )
    second = scene.add(
        bar(masses[1], lengths[1]),
        rb.Revolute([0, 0, 1], at=[lengths[0], 0, 0], **rough(mu[1], pin_radius=radii[1])),
        parent=first,
        angle=angles[1] - angles[0],
        rate=rates[1] - rates[0],
    )
    height = sum(length * math.sin(a) for length, a in zip(lengths, angles, strict=True))
    floor = rb.Plane([0, 1, 0], [0, height, 0])
    touch = scene.contact(second.point([lengths[1], 0, 0]), floor, **rough(mu[2]))
    if torque:
        scene.apply(rb.JointTorque(torque), first)
    return scene, first, second, touch


def most_used(lengths, masses, mu, radii, angles, torque):
    """At rest: the least, over all forces of the floor within its cone, of what part of their limits pins need."""
    (ca, sa), (cb, sb) = ((math.cos(a), math.sin(a)) for a in angles)
    weights = np.array(masses) * g

    def parts(at):
        normal = abs(at[1]) * weights.sum()
        tip = np.array([mu[2] * math.sin(at[0]) * normal, normal])
        second = np.array([-tip[0], weights[1] - normal])
        first = second + [0, weights[0]]
        on_second = -lengths[1] / 2 * (cb * (tip - second)[1] - sb * (tip - second)[0])
        on_first = on_second + lengths[0] / 2 * (ca * (first + second)[1] - sa * (first + second)[0]) - torque
        torques, loads = np.abs([on_first, on_second]), np.linalg.norm([first, second], axis=1)
        return (torques / (np.array(mu[:2]) * radii * loads)).max()

    starts = [(a, n) for a in np.linspace(-1.57, 1.57, 15) for n in np.linspace(0.001, 3, 60)]
    at = min(starts, key=parts)
    for _ in range(4):
        at = minimize(parts, at, method="Nelder-Mead", options={"xatol": 1e-13, "fatol": 1e-13, "maxiter": 4000}).x
    return parts(at)


def drawn(seed):
    """Two bars at rest, and a torque that grows from the one that needs no friction."""
    rng = np.random.default_rng([41, seed])
    unit = (1.0, 1e-3, 1e3)[seed % 3]
    lengths, masses = rng.uniform(0.5, 1.5, 2) * unit, rng.uniform(0.5, 3, 2)
    mu, radii = rng.uniform(0.1, 0.5, 3), rng.uniform(0.02, 0.08, 2) * unit
    angles = np.array([rng.uniform(-2.4, -0.7), rng.uniform(-2.4, -0.7)])
    none = g * lengths[0] * math.cos(angles[0]) * (masses[0] + masses[1]) / 2
    grows = rng.choice([-1, 1]) * 0.2 * g * lengths[0] * masses.sum()
    return lengths, masses, mu, radii, angles, none, grows


@pytest.mark.parametrize(("seed", "until"), [(0, 0.4), (1, 0.2), (3, 0.2), (4, 0.4), (5, 0.8), (6, 0.9), (8, 0.8)])
def test_two_bars_at_rest_break_away_where_no_forces_hold_them(seed, until):
    """Pins and the floor share a load: the floor's friction comes to its edge first, and the pins hold on. The floor
    was said to slip alone, at nothing, and what moved away then, too early, was refused or went on switching."""
    lengths, masses, mu, radii, angles, none, grows = drawn(seed)
    scene, first, second, touch = two_bars(lengths, masses, mu, radii, angles, [0, 0], lambda t, q, w: none + grows * t)
    run = rb.simulate(scene, until, error=1e-9)
    at = run.events[0].time
    assert [event.kind for event in list(run.events)[:3]] == ["slip"] * 3 and run.events[2].time == at
    used = [most_used(lengths, masses, mu, radii, angles, none + grows * at * (1 + d)) for d in (-1e-8, 1e-8)]
    assert used[0] < 1 < used[1]
    assert abs(run[first].angle(at * 0.999) - angles[0]) < 1e-15


def test_two_bars_stop_where_all_frictions_together_hold_them():
    """Neither the floor nor the pins hold them alone, and they do not go back: it was refused as inconsistent."""
    lengths, masses = (0.9529147771307798, 1.3839895894469705), (2.730165896297853, 2.1492528869688527)
    mu = (0.26936208488582514, 0.44811274383602556, 0.2923576813129945)
    radii = (0.06190024093142316, 0.052720633668749024)
    angles, rates = (-1.7165117974279105, -2.781555508132872), (0.0004867914602230474, -5.200079302790581e-05)
    scene, first, second, touch = two_bars(lengths, masses, mu, radii, angles, rates)
    run = rb.simulate(scene, 1.0, error=1e-9)
    # from another integration, DOP853 at 1e-13
    assert run.events.times("stick") == pytest.approx(0.007978524358496, rel=1e-9)
    stopped = np.array([run[first].angle(1.0), run[first].angle(1.0) + run[second].angle(1.0)])
    assert stopped == pytest.approx([-1.71650986, -2.78155572], abs=1e-8)
    assert run[first].rate(1.0) == run[second].rate(1.0) == 0
    assert 0.8 < most_used(lengths, masses, mu, radii, stopped, 0.0) < 0.9
    assert most_used(lengths, masses, (*mu[:2], 1e-9), radii, stopped, 0.0) > 1


def slider_crank(seed):
    """A crank, a rod and a block on a line; pins on both ends of the crank and the line are rough."""
    rng = np.random.default_rng([43, seed])
    unit = (1.0, 1e-3, 1e3)[seed % 3]
    pace = math.sqrt(unit)
    lengths, masses = np.array([rng.uniform(0.5, 0.8), rng.uniform(1, 1.5)]) * unit, rng.uniform(0.5, 3, 3)
    mu, radii = rng.uniform(0.1, 0.4, 3), rng.uniform(0.02, 0.08, 2) * unit
    a, rate = rng.uniform(-3, 3), rng.uniform(1, 3) / pace
    level = rng.uniform(-0.2, 0.2) * unit
    b = math.asin((level - lengths[0] * math.sin(a)) / lengths[1])
    rates = rate, -lengths[0] * math.cos(a) * rate / (lengths[1] * math.cos(b))
    most = masses[0] * g * lengths[0] * rng.uniform(0.5, 1.5)

    def torque(t):
        return most * np.sin(2.1 * t / pace + seed)

    x = lengths[0] * math.cos(a) + lengths[1] * math.cos(b)
    speed = -lengths[0] * math.sin(a) * rates[0] - lengths[1] * math.sin(b) * rates[1]
    scene = rb.Scene(gravity=[0, -g, 0])
    crank = scene.add(
        bar(masses[0], lengths[0]), rb.Revolute([0, 0, 1], **rough(mu[0], pin_radius=radii[0])), angle=a, rate=rate
    )
    rod = scene.add(
        bar(masses[1], lengths[1]),
        rb.Revolute([0, 0, 1], at=[lengths[0], 0, 0], **rough(mu[1], pin_radius=radii[1])),
        parent=crank,
        angle=b - a,
        rate=rates[1] - rates[0],
    )
    line = rb.Prismatic([1, 0, 0], at=[0, level, 0], **rough(mu[2]))
    block = scene.add(rb.RigidBody(masses[2], [unit**2] * 3), line, displacement=x, rate=speed)
    scene.constrain(rb.Ball(), rod.point([lengths[1], 0, 0]), block.point([0, 0, 0]))
    scene.apply(rb.JointTorque(lambda t, q, w: torque(t)), crank)

    bodies = [(m, m * length**2 / 12) for m, length in zip(masses, lengths, strict=False)] + [(masses[2], unit**2)]
    half = [np.array([length / 2, 0]) for length in lengths]
    pins = [
        (-1, np.zeros(2), 0, -half[0], mu[0] * radii[0]),
        (0, half[0], 1, -half[1], mu[1] * radii[1]),
        (1, half[1], 2, np.zeros(2), 0.0),
    ]
    by_hand = Mechanism(bodies, pins, [(2, np.array([0, -1.0]), mu[2])], torque=torque, length=unit)
    e = [np.array([math.cos(angle), math.sin(angle)]) for angle in (a, b)]
    n = [np.array([-p[1], p[0]]) for p in e]
    end, tip = lengths[0] * e[0], lengths[0] * rates[0] * n[0]
    places = [*(end / 2), a, *(end + lengths[1] / 2 * e[1]), b, x, level, 0]
    speeds = [*(tip / 2), rates[0], *(tip + lengths[1] / 2 * rates[1] * n[1]), rates[1], speed, 0, 0]
    return scene, crank, block, by_hand, np.array(places + speeds), pace, unit


@pytest.mark.parametrize("seed", [0, 1, 2, 4])
def test_a_slider_crank_reverses_rests_and_breaks_away(seed):
    """At rest friction of three joints holds one motion; it was refused as not unique. While it rests nothing moves, so
    that all that counts is when it ends: where all of them are at their limits."""
    scene, crank, block, by_hand, start, pace, unit = slider_crank(seed)
    told, state = by_hand.run(start, 3.0 * pace, pace)
    run = rb.simulate(scene, 3.0 * pace, error=1e-9)
    for what, kind in (("reverses", "reverse"), ("rests", "stick"), ("leaves", "slip")):
        expected = [t for t, happened in told if happened == what]
        found = run.events.times(kind, crank)
        assert len(found) == len(expected) and np.allclose(found, expected, rtol=0, atol=1e-8 * pace)
    for t in np.linspace(0, 3.0 * pace, 40):
        y = state(t)
        assert abs(run[crank].angle(t) - y[2]) < 1e-8
        assert abs(run[block].displacement(t) - y[6]) < 1e-8 * unit


def test_bars_nearly_straight_on_pins_that_lock_push_each_other_hard():
    """The floor's friction alone would turn the bars into the floor, and no force of it keeps them out; that of the
    pins, pressed by 1.9 kN, does: one solution, found from what the floor presses them with. It was refused."""
    lengths, masses = (
        np.array([0.9416768465942449, 0.7525992722570005]) * 1e-3,
        (0.6990381352317581, 1.7108689808099802),
    )
    mu, radii = (
        (0.4946224425454482, 0.19488208683619684, 0.49472143207657665),
        (1.5801100091715213e-05, 6.920764556569487e-05),
    )
    angles, rates = (
        np.array([-1.1537866145128208, -1.1460836599542903]),
        np.array([18.735426383577366, -23.04239316472159]),
    )
    scene, first, second, touch = two_bars(lengths, masses, mu, radii, angles, rates)
    run = rb.simulate(scene, 1e-5, error=1e-9)
    # as seen from the crank: its own friction, of the knee, and of the floor
    e = [np.array([math.cos(a), math.sin(a)]) for a in angles]
    n = [np.array([-math.sin(a), math.cos(a)]) for a in angles]

    def cross(p, q):
        return p[0] * q[1] - p[1] * q[0]

    def laws(z):
        speeding, first_pin, second_pin, normal = z[:2] / lengths, z[2:4], z[4:6], z[6]
        center = lengths[0] / 2 * (speeding[0] * n[0] - rates[0] ** 2 * e[0])
        other = 2 * center + lengths[1] / 2 * (speeding[1] * n[1] - rates[1] ** 2 * e[1])
        tip = normal * np.array([-mu[2], 1.0])
        rubs = [
            -s * m * r * np.hypot(*p) for s, m, r, p in zip((1, -1), mu, radii, (first_pin, second_pin), strict=False)
        ]
        weight = np.array([0, -g])
        inertia = np.array(masses) * lengths**2 / 12
        return np.concatenate(
            [
                masses[0] * (center - weight) - first_pin + second_pin,
                masses[1] * (other - weight) - second_pin - tip,
                [(inertia[0] * speeding[0] - rubs[0] + rubs[1]) / lengths[0] + cross(e[0], first_pin + second_pin) / 2],
                [(inertia[1] * speeding[1] - rubs[1]) / lengths[1] + cross(e[1], second_pin - tip) / 2],
                [2 * center[1] + lengths[1] * (speeding[1] * n[1][1] - rates[1] ** 2 * e[1][1])],
            ]
        )

    presses = 1751.0 * np.array([0.42, -1.02, 0.44, -1.01, 1.0])
    found = fsolve(laws, np.concatenate([[0, 0], presses]), xtol=1e-14)
    assert np.abs(laws(found)).max() < 1e-8
    assert run[touch].force(0.0)[1] == pytest.approx(found[6], rel=1e-9)
    changes = run[first].rate(1e-9) - rates[0]
    assert changes / 1e-9 == pytest.approx(found[0] / lengths[0], rel=1e-3)


@pytest.mark.parametrize("seed", range(3))
def test_a_ball_spins_in_a_corner_of_three_planes(seed):
    """At the origin as elsewhere: what contacts hold moves by rounding of their sizes, whatever the place is; of it
    errors of 600 % were told."""
    rng = np.random.default_rng([47, seed])
    tilts, turns = rng.uniform(0.5, 1.0, 3), 2 * math.pi / 3 * np.arange(3) + rng.uniform(-0.3, 0.3, 3)
    normals = np.stack([np.sin(tilts) * np.cos(turns), np.sin(tilts) * np.sin(turns), np.cos(tilts)], axis=1)
    mu, spin = rng.uniform(0.1, 0.5, 3), rng.uniform(-2, 2, 3)
    runs = []
    for place in (np.zeros(3), np.array([1.0, 2.0, 3.0])):
        scene = rb.Scene(gravity=[0, 0, -g])
        ball = scene.add(rb.RigidBody(1.3, [0.1] * 3), position=place, angular_velocity_world=spin)
        for normal, rubs in zip(normals, mu, strict=True):
            scene.contact(ball.sphere(0.5), rb.Plane(normal, place - 0.5 * normal), friction=rb.Coulomb(rubs))
        run = rb.simulate(scene, 1.0, error=1e-9)
        assert run.error < 1e-9
        runs.append(run[ball].angular_velocity(np.linspace(0, 1, 20)))
    assert np.abs(runs[0] - runs[1]).max() < 1e-8
