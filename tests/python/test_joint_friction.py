"""Friction in hinges and slides against integrations of laws written down apart, and what goes with it."""

import math
import pickle

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp

g = 9.81


def pendulum(static, dynamic, radius, angle):
    scene = rb.Scene(gravity=[0, -g, 0])
    joint = rb.Revolute([0, 0, 1], friction=rb.Coulomb(static, dynamic), pin_radius=radius)
    return scene, scene.add(rb.RigidBody(1.3, [0.2, 0.2, 0.4], com=[0, -0.7, 0]), joint, angle=angle)


def swings(static, dynamic, radius, angle, until):
    """Angle and rate at the end, and what happens, by an equation for the whole reaction at the pin."""
    m, c, moment = 1.3, 0.7, 0.4 + 1.3 * 0.7**2
    k = dynamic * radius

    def acceleration(phi, w, sign):
        along = -m * c * w * w - m * g * math.cos(phi)
        # moment a = -m g c sin - sign k |R|, the part of R across the bar m (c a + g sin): the root on that side
        b, p, q = m * c, m * g * math.sin(phi), m * g * c * math.sin(phi)
        a2, a1, a0 = (
            moment**2 - (k * b) ** 2,
            2 * (moment * q - k * k * b * p),
            q * q - k * k * (along * along + p * p),
        )
        root = math.sqrt(a1 * a1 - 4 * a2 * a0)
        return (-a1 - sign * root) / (2 * a2)

    t, y, sign, events = 0.0, [angle, 0.0], -math.copysign(1, angle), []
    while True:

        def stops(_, y):
            return y[1]

        stops.terminal, stops.direction = True, -sign
        found = solve_ivp(
            lambda _, y, s=sign: [y[1], acceleration(y[0], y[1], s)],
            (t, until),
            y,
            method="DOP853",
            rtol=1e-13,
            atol=1e-14,
            events=stops,
        )
        t, y = found.t[-1], [found.y[0, -1], 0.0]
        if t >= until:
            return found.y[:, -1], events
        if m * g * c * abs(math.sin(y[0])) <= static * radius * m * g:
            return np.array(y), [*events, ("stick", t)]
        sign = -math.copysign(1, y[0])
        events.append(("reverse", t))


@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
def test_a_pendulum_on_a_rough_pin_swings_out(error):
    scene, body = pendulum(0.6, 0.4, 0.1, 1.2)
    (angle, _), events = swings(0.6, 0.4, 0.1, 1.2, 60.0)
    run = rb.simulate(scene, until=60.0, error=error)
    assert [e.kind for e in run.events] == [kind for kind, _ in events]
    assert events[-1][0] == "stick"
    assert max(abs(e.time - t) for e, (_, t) in zip(run.events, events, strict=True)) < max(10 * error, 1e-12)
    assert abs(run[body].angle(60.0) - angle) < max(3 * error, 1e-12)
    assert run.error <= error
    assert run[body].angle(60.0) == run[body].angle(run.events[-1].time)
    # friction is part of the reaction: its torque is mu r times what presses
    t = 0.3
    pressing = np.linalg.norm(run[body].reaction(t)[:2])
    assert abs(run[body].reaction_torque(t)[2] - 0.4 * 0.1 * pressing) < 1e-12


def accelerations(y, torques):
    """Of two bars of length 1: angular accelerations and the forces at both pins, by Lagrange's equations."""
    m, moment, c = 1.0, 0.2, 0.5
    a, b, wa, wb = y[0], y[0] + y[1], y[2], y[2] + y[3]
    mass = [[moment + m * c * c + m, m * c * math.cos(a - b)], [m * c * math.cos(a - b), moment + m * c * c]]
    rest = [
        -m * c * math.sin(a - b) * wb**2 - m * (c + 1) * g * math.sin(a) + torques[0] - torques[1],
        m * c * math.sin(a - b) * wa**2 - m * g * c * math.sin(b) + torques[1],
    ]
    turn = np.linalg.solve(mass, rest)

    def along(angle, w, alpha):
        return alpha * np.array([math.cos(angle), math.sin(angle)]) - w * w * np.array(
            [math.sin(angle), -math.cos(angle)]
        )

    weight = np.array([0, m * g])
    second = m * (along(a, wa, turn[0]) + c * along(b, wb, turn[1])) + weight
    first = m * c * along(a, wa, turn[0]) + weight + second
    return np.array([turn[0], turn[1] - turn[0]]), np.array([np.hypot(*first), np.hypot(*second)])


def test_a_chain_of_two_rubs_as_its_laws_say():
    k = np.array([0.3 * 0.08, 0.4 * 0.05])
    scene = rb.Scene(gravity=[0, -g, 0])
    bar = rb.RigidBody(1.0, [0.1, 0.1, 0.2], com=[0, -0.5, 0])
    first = scene.add(bar, rb.Revolute([0, 0, 1], friction=rb.Coulomb(0.5, 0.3), pin_radius=0.08), angle=1.5)
    second = scene.add(
        bar,
        rb.Revolute([0, 0, 1], at=[0, -1, 0], friction=rb.Coulomb(0.6, 0.4), pin_radius=0.05),
        parent=first,
        angle=-0.8,
    )

    def rates(_, y, signs):
        torques = np.zeros(2)
        for _ in range(60):
            turn, pressing = accelerations(y, torques)
            torques, last = -signs * k * pressing, torques
            if abs(torques - last).max() < 1e-16:
                break
        return [*y[2:], *turn]

    t, y, signs, times = 0.0, np.array([1.5, -0.8, 0, 0]), np.array([-1.0, 1.0]), []
    while t < 3.0:
        stops = [lambda _, y, s, i=i: y[2 + i] for i in range(2)]
        for i in range(2):
            stops[i].terminal, stops[i].direction = True, -signs[i]
        found = solve_ivp(rates, (t, 3.0), y, args=(signs,), method="DOP853", rtol=1e-12, atol=1e-13, events=stops)
        t, y = found.t[-1], found.y[:, -1]
        for i in range(2):
            if len(found.t_events[i]):
                times.append(t)
                y[2 + i] = 0.0
                signs = np.where(np.arange(2) == i, -signs, signs)
    for error in (1e-6, 1e-9, 1e-11):
        run = rb.simulate(scene, until=3.0, error=error)
        assert [e.kind for e in run.events] == ["reverse"] * len(times)
        assert abs(np.array([e.time for e in run.events]) - times).max() < max(error, 3e-12)
        assert abs(run[first].angle(3.0) - y[0]) < max(error, 3e-12)
        assert abs(run[second].angle(3.0) - y[1]) < max(error, 3e-12)
        assert run.error <= error
    # what is gone of the energy is what friction took: the work on both pins
    t = np.linspace(0, 3, 2001)
    assert "energy" not in run.drift
    assert run.energy(3.0) < run.energy(0.0)
    assert np.all(np.diff(run.energy(t)) < 1e-12)


def test_a_block_on_a_slide_sticks_and_slips_under_a_force_that_swings():
    scene = rb.Scene(gravity=[0, 0, -g])
    block = scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.2]), rb.Prismatic([1, 0, 0], friction=rb.Coulomb(0.5, 0.3)))
    scene.apply(rb.JointForce(lambda t, q, w: 6 * np.sin(t)), block)
    run = rb.simulate(scene, until=20.0, error=1e-10)
    slips, sticks = run.events.times("slip"), run.events.times("stick")
    breaks = math.asin(0.5 * g / 6)
    assert abs(np.array(slips) - breaks - math.pi * np.arange(len(slips))).max() < 1e-12
    for start, end in zip(slips, sticks, strict=False):
        # the speed that the force gives is taken by friction
        sign = math.copysign(1, math.sin(start))
        assert abs(6 * (math.cos(start) - math.cos(end)) - sign * 0.3 * g * (end - start)) < 1e-12
        assert run[block].rate(end) == 0.0


def test_effects_parameters_files_and_pickles():
    scene, body = pendulum(0.6, 0.4, 0.1, 1.2)
    run = rb.simulate(scene, until=2.0, error=1e-9)
    assert {"dynamic friction", "static friction"} <= set(run.plan.effects)
    smooth = scene.without("dynamic friction", "static friction")
    assert rb.plan(smooth).engine == "closed form"
    bare = rb.Scene(gravity=[0, -g, 0])
    bare.add(rb.RigidBody(1.3, [0.2, 0.2, 0.4], com=[0, -0.7, 0]), rb.Revolute([0, 0, 1]), angle=1.2)
    assert rb.plan(smooth).effects == rb.plan(bare).effects
    table = str(rb.effects(scene, until=2.0, error=1e-9))
    assert "dynamic friction" in table and "static friction" in table
    joint = rb.Revolute([0, 0, 1], friction=rb.Coulomb(0.6, 0.4), pin_radius=0.1)
    again = pickle.loads(pickle.dumps(joint))
    assert again == joint and hash(again) == hash(joint) and repr(again) == repr(joint)
    assert again.friction == rb.Coulomb(0.6, 0.4) and again.pin_radius == 0.1
    slide = rb.Prismatic([1, 0, 0], friction=rb.Coulomb(0.2))
    assert pickle.loads(pickle.dumps(slide)) == slide != rb.Prismatic([1, 0, 0])
    copy = pickle.loads(pickle.dumps(run))
    assert copy[body].angle(1.5) == run[body].angle(1.5)
    mu = rb.parameter(0.4)
    varied = rb.Scene(gravity=[0, -g, 0])
    bob = varied.add(
        rb.RigidBody(1.3, [0.2, 0.2, 0.4], com=[0, -0.7, 0]),
        rb.Revolute([0, 0, 1], friction=rb.Coulomb(0.6, mu), pin_radius=0.1),
        angle=1.2,
    )
    assert abs(rb.simulate(varied, until=2.0, error=1e-9)[bob].angle(2.0) - run[body].angle(2.0)) < 1e-9
    mu.value = 0.2
    less, _ = swings(0.6, 0.2, 0.1, 1.2, 2.0)
    assert abs(rb.simulate(varied, until=2.0, error=1e-9)[bob].angle(2.0) - less[0]) < 1e-9


def test_friction_in_joints_is_kept_in_files(tmp_path):
    scene, body = pendulum(0.6, 0.4, 0.1, 1.2)
    path = tmp_path / "scene.json"
    rb.save(scene, path)
    again = rb.load(path)
    one, other = (rb.simulate(s, until=3.0, error=1e-9) for s in (scene, again))
    assert one[body].angle(3.0) == other[again.bodies[0]].angle(3.0)


@pytest.mark.parametrize("mu", [1e-3, 1e-6, 1e-9, 1e-12])
def test_the_friction_of_a_pin_is_known_however_small_it_is(mu):
    """Beside moments of 5 N m, of which it would be what is left."""
    scene, bob = pendulum(mu, mu, 0.05, 1.0)
    run = rb.simulate(scene, 1.5, error=1e-9)
    t = np.linspace(0.01, 1.49, 97)
    presses = np.linalg.norm(run[bob].reaction(t), axis=1)
    resists = run[bob].reaction_torque(t)[:, 2]
    assert run.error <= 1e-9
    assert abs(resists + np.sign(run[bob].rate(t)) * mu * 0.05 * presses).max() <= 1e-13 * mu * presses.max()


def test_friction_of_a_millionth_takes_the_energy_that_its_torque_does():
    mu = 1e-6
    scene, bob = pendulum(mu, mu, 0.05, 1.0)
    run = rb.simulate(scene, 0.8, error=1e-11)
    assert not len(run.events)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    t = 0.4 + 0.4 * nodes
    lost = 0.4 * weights @ (mu * 0.05 * np.linalg.norm(run[bob].reaction(t), axis=1) * abs(run[bob].rate(t)))
    assert abs((run.energy(0.0) - run.energy(0.8)) / lost - 1) < 1e-7
