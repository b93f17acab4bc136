"""Friction on several feet of a body: what bears a load together begins, slides and stops as one.

Truths: closed forms, and stick and slip along one line followed from event to event.
"""

import itertools

import numpy as np
import pytest
import rbdyn as rb
from scipy.optimize import brentq

g = 9.81


def feet_on(kind, radius):
    """Places of feet: n on a circle, or the corners of a rectangle."""
    if kind == "box":
        return [(i * radius, j * 0.75 * radius) for i in (1, -1) for j in (1, -1)]
    angles = 2 * np.pi * np.arange(kind) / kind + 0.1 * (kind % 2)
    return list(zip(radius * np.cos(angles), radius * np.sin(angles), strict=True))


def block(scene, feet, friction, plane, mass=2.0, height=0.05, size=1.0):
    """A body on feet, at rest."""
    inertia = mass * size**2 * np.array([0.01, 0.012, 0.02])
    body = scene.add(rb.RigidBody(mass, inertia), position=[0, 0, height])
    for x, y in feet:
        scene.contact(body.point([x, y, -height]), plane, friction=friction)
    return body


SLOPES = [(3, 0.3), ("box", 0.61), (5, 0.1)]


@pytest.mark.parametrize(("kind", "slope"), SLOPES)
@pytest.mark.parametrize("until", [1e3])
def test_at_rest_on_the_edge_of_friction_it_sticks(kind, slope, until):
    """tan(slope) = mu, as a particle does."""
    scene = rb.Scene(gravity=[g * np.sin(slope), 0, -g * np.cos(slope)])
    body = block(scene, feet_on(kind, 0.2), rb.Coulomb(np.tan(slope)), rb.Plane([0, 0, 1]))
    run = rb.simulate(scene, until)
    assert "slip" not in [e.kind for e in run.events]
    assert np.abs(run[body].position(until) - [0, 0, 0.05]).max() < 1e-15


@pytest.mark.parametrize(("kind", "slope"), SLOPES)
@pytest.mark.parametrize("part", [1e-3, 1e-5])
@pytest.mark.parametrize("angle", [0.0, 0.9])
def test_just_beyond_the_edge_it_slides_uniformly(kind, slope, part, angle):
    """By a part of what friction holds, in any direction on the plane."""
    along = np.array([np.cos(angle), np.sin(angle), 0.0])
    scene = rb.Scene(gravity=g * (np.sin(slope) * along - np.cos(slope) * np.array([0, 0, 1.0])))
    mu = np.tan(slope) * (1 - part)
    body = block(scene, feet_on(kind, 0.2), rb.Coulomb(mu), rb.Plane([0, 0, 1]))
    until = 100.0
    run = rb.simulate(scene, until, max_steps=2000)
    distance = (g * np.sin(slope) - mu * g * np.cos(slope)) * until**2 / 2
    assert run.status == "reached end"
    assert np.linalg.norm(run[body].position(until) - [0, 0, 0.05] - distance * along) < 8e-15 / part * distance + 1e-12


@pytest.mark.parametrize(
    ("kind", "slope", "part"), [(3, 0.3, 0.0), (3, 0.3, 1e-3), ("box", 0.61, 1e-3), (5, 0.1, 1e-3)]
)
def test_feet_that_carry_a_wheel_on_a_rough_pin_do_what_they_do_without(kind, slope, part):
    """The wheel is balanced, and what slides straight does not turn it."""
    along = np.array([np.cos(0.9), np.sin(0.9), 0.0])
    scene = rb.Scene(gravity=g * (np.sin(slope) * along - np.cos(slope) * np.array([0, 0, 1.0])))
    mu = np.tan(slope) * (1 - part)
    body = block(scene, feet_on(kind, 0.2), rb.Coulomb(mu), rb.Plane([0, 0, 1]))
    pin = rb.Revolute([0, 0, 1], friction=rb.Coulomb(0.3), pin_radius=0.01)
    wheel = scene.add(rb.RigidBody(0.4, [0.001, 0.001, 0.002]), pin, parent=body)
    until = 100.0
    run = rb.simulate(scene, until, rtol=1e-12, max_steps=2000)
    distance = (g * np.sin(slope) - mu * g * np.cos(slope)) * until**2 / 2 if part else 0.0
    assert np.linalg.norm(run[body].position(until) - [0, 0, 0.05] - distance * along) < 1e-11 * distance + 1e-15
    assert abs(run[wheel].rate(until)) < 1e-12


@pytest.mark.parametrize(("count", "mus"), [(3, (0.3, 0.3)), (4, (0.3, 0.3)), (6, (0.3, 0.3)), (4, (0.3, 0.25))])
def test_a_round_table_that_is_turned_begins_to_pivot(count, mus):
    """By symmetry each foot bears the same: I w' = tau sin(w t) - mu m g R."""
    mass, inertia, radius, tau, rate, height = 2.0, 0.05, 0.25, 3.0, 2.0, 0.1
    scene = rb.Scene(gravity=[0, 0, -10])
    body = scene.add(rb.RigidBody(mass, [0.03, 0.03, inertia]), position=[0, 0, height])
    for x, y in feet_on(count, radius):
        scene.contact(body.point([x, y, -height]), rb.Plane([0, 0, 1]), friction=rb.Coulomb(*mus))
    scene.apply(rb.Torque(lambda t, r, om: [0 * t, 0 * t, tau * np.sin(rate * t)]), body)
    run = rb.simulate(scene, 1.5, max_steps=5000)
    holds, rubs = (mu * mass * 10 * radius for mu in mus)
    start = np.arcsin(holds / tau) / rate
    turns = (tau / rate * (np.cos(rate * start) - np.cos(rate * 1.5)) - rubs * (1.5 - start)) / inertia
    assert [e.kind for e in run.events] == ["slip"] * count
    assert np.allclose(run.events.times("slip"), start, rtol=1e-10, atol=0)
    assert abs(run[body].angular_velocity_world(1.5)[2] / turns - 1) < 1e-10
    assert np.abs(run[body].position(1.5) - [0, 0, height]).max() < 1e-9


def shaken(amplitude, rate, mu, until):
    """The way of what a floor x = A (1 - cos(w t)) carries, and its events, from event to event."""
    pull = mu * g
    place, speed = (lambda t: amplitude * (1 - np.cos(rate * t))), (lambda t: amplitude * rate * np.sin(rate * t))
    asks = lambda t: amplitude * rate**2 * np.cos(rate * t)  # noqa: E731
    t, x, v, sign, events = 0.0, 0.0, 0.0, 1 if amplitude * rate**2 > pull else 0, []
    step = np.pi / rate / 500

    def first(f, begin):
        for a in itertools.count(begin, step):
            if a >= until:
                return until
            if f(a) > 0 >= f(a + step):
                return brentq(f, a, a + step, xtol=1e-15, rtol=1e-15)
        return None

    while t < until:
        if sign == 0:
            end = first(lambda q: pull - abs(asks(q)), t)
            x, v, t = x + place(end) - place(t), speed(end), end
            sign = int(np.sign(asks(t)))
            kind = "slip"
        else:
            end = first(lambda q, s=sign, v0=v, t0=t: s * (speed(q) - v0 - s * pull * (q - t0)), t + step / 2)
            x, v, t = x + v * (end - t) + sign * pull * (end - t) ** 2 / 2, v + sign * pull * (end - t), end
            is_stuck = abs(asks(t)) <= pull
            sign, kind = (0, "stick") if is_stuck else (int(np.sign(asks(t))), "reverse")
        if t < until:
            events.append((kind, t))
    return x, events


@pytest.mark.parametrize("along", [(1, 0, 0), (0.6, 0.8, 0), (-0.28, 0.96, 0)])
@pytest.mark.parametrize("kind", [3, "box"])
@pytest.mark.parametrize(("amplitude", "rate", "mu"), [(0.1, 12.0, 0.3), (0.05, 5.0, 0.1)])
def test_on_a_shaken_floor_all_feet_stick_and_slip_together(amplitude, rate, mu, kind, along):
    scene = rb.Scene(gravity=[0, 0, -g])
    floor = scene.add(
        rb.RigidBody(1.0, [1, 1, 1]), rb.Prismatic(along, motion=lambda t: amplitude * (1 - np.cos(rate * t)))
    )
    feet = feet_on(kind, 0.1)
    body = block(scene, feet, rb.Coulomb(mu), floor.plane([0, 0, 1]), height=0.01)
    run = rb.simulate(scene, 2.0, max_steps=5000)
    way, events = shaken(amplitude, rate, mu, 2.0)
    first = [(e.kind, e.time) for e in run.events if str(e.subject).endswith("contact 1>")]
    assert [kind for kind, _ in first] == [kind for kind, _ in events]
    assert np.allclose([t for _, t in first], [t for _, t in events], rtol=1e-9, atol=0)
    assert abs(run[body].position(2.0) @ np.array(along) - way) < 1e-11
    told = [e.kind for e in run.events if e.kind in ("slip", "stick", "reverse")]
    assert len(told) == len(feet) * len(events)


@pytest.mark.parametrize("along", [(0.6, 0.8, 0.0), (-0.96, 0.28, 0.0), (0.1, 0.3, 0.0)])
def test_a_slip_that_is_hardly_asked_for_takes_as_few_steps_in_any_direction(along):
    """Over 60 s and millions of steps, where along an axis it took milliseconds."""
    rate, mu, mass = 4.891546369347187, 0.29980962533624483, 1.3073871847248235
    most = 1.001 * mu * g * mass

    def run(d):
        scene = rb.Scene(gravity=[0, 0, -g])
        body = scene.add(rb.Particle(mass))
        scene.contact(body, rb.Plane([0, 0, 1]), friction=rb.Coulomb(mu))
        push = [most * one for one in d]
        scene.apply(rb.Force(lambda t, r, v: [one * np.sin(rate * t) for one in push]), body)
        result = rb.simulate(scene, 4.0, max_steps=2000)
        return result, result[body].position(4.0) @ np.array(d)

    d = np.array(along) / np.linalg.norm(along)
    (plain, way), (turned, other) = run((1.0, 0.0, 0.0)), run(tuple(d))
    assert [e.kind for e in turned.events] == [e.kind for e in plain.events]
    assert np.allclose([e.time for e in turned.events], [e.time for e in plain.events], rtol=1e-9, atol=0)
    assert abs(other - way) < 1e-12


@pytest.mark.parametrize("feet", [3, 4])
@pytest.mark.parametrize("k", [0.5, 0.9])
@pytest.mark.parametrize("end", [1e3, 1e5])
def test_what_slides_straight_for_long_does_not_turn(feet, k, end):
    """The forces of its feet balance: what rounding left of them turned it, and from 1e4 s on it was refused."""
    slope, g = 0.3, 9.81
    scene = rb.Scene(gravity=[g * np.sin(slope), 0, -g * np.cos(slope)])
    box = scene.add(rb.shapes.box(2.0, [0.4, 0.3, 0.1]), position=[0, 0, 0.05])
    three = [(0.2, 0), (-0.2, 0.15), (-0.2, -0.15)]
    for x, y in three if feet == 3 else [(0.2, 0.15), (0.2, -0.15), (-0.2, 0.15), (-0.2, -0.15)]:
        rough = rb.Coulomb(k * np.tan(slope))
        scene.contact(box.point([x, y, -0.05]), rb.Plane([0, 0, 1]), friction=rough)
    run = rb.simulate(scene, end)
    way = 0.5 * g * np.sin(slope) * (1 - k) * end**2
    assert run.error <= 1e-9
    assert run[box].position(end)[0] == pytest.approx(way, rel=1e-13)
    assert list(run[box].angular_velocity(end)) == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("odd", ["torque", "friction"])
def test_what_is_pushed_to_turn_as_it_slides_turns(odd):
    """A torque that begins as zero turns it, and so does one foot that is rougher than the others."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    box = scene.add(rb.shapes.box(2.0, [0.4, 0.3, 0.1]), position=[0, 0, 0.05], velocity=[3.0, 0, 0])
    for i, (x, y) in enumerate([(0.2, 0), (-0.2, 0.15), (-0.2, -0.15)]):
        rough = rb.Coulomb(0.2 if odd == "friction" and i == 1 else 0.1)
        scene.contact(box.point([x, y, -0.05]), rb.Plane([0, 0, 1]), friction=rough)
    if odd == "torque":
        scene.apply(rb.Torque(lambda t, r, w: [0, 0, 0.1 * t]), box)
    run = rb.simulate(scene, 0.5)
    assert abs(run[box].angular_velocity(0.5)[2]) > 0.01
