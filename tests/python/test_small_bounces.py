"""Bounces of bodies on two contacts, down to 1e-14 of their first speed, against quadratures in extended precision.

A block without friction that turns about one corner, which slides, has the angle q alone:
    M(q) q'^2 / 2 + V(q) = E,  M = I + m (b cos q - h sin q)^2,  V = m g (b sin q + h cos q - h)
and comes back after 2 int_0^top sqrt(M / (2 (E - V))) dq. Its corners lie side by side at q = 0: what was lower than
4096 roundings of a gap was summed once, from the fourth of eleven impacts on.
"""

import numpy as np
import pytest
import rbdyn as rb

G = 9.8125
REAL = np.longdouble
pytestmark = pytest.mark.skipif(np.finfo(REAL).eps > 1e-18, reason="long double is double here")


def gauss(n=40):
    """Nodes and weights on [0, 1], by Newton's method from those of doubles."""
    x = np.polynomial.legendre.leggauss(n)[0].astype(REAL)
    for _ in range(3):
        before, p = np.ones_like(x), x.copy()
        for k in range(2, n + 1):
            before, p = p, ((2 * k - 1) * x * p - (k - 1) * before) / k
        slope = n * (x * p - before) / (x * x - 1)
        x = x - p / slope
    return (1 + x) / 2, 1 / ((1 - x * x) * slope * slope)


def impacts(m, moment, b, h, tilt, ratio):
    """Times and angular velocities after which it strikes, until 1e-14 of the first; `ratio`: of these, one by one."""
    m, moment, b, h, tilt = map(REAL, (m, moment, b, h, tilt))
    s, weight = gauss()

    def half(top):
        # q = top (1 - s^2); E - V as a difference of sines and cosines
        part = top * s * s / 2
        middle = top - part
        left = 2 * m * REAL(G) * np.sin(part) * (b * np.cos(middle) - h * np.sin(middle))
        q = top * (1 - s * s)
        turns = moment + m * (b * np.cos(q) - h * np.sin(q)) ** 2
        return (weight * np.sqrt(turns / (2 * left)) * 2 * top * s).sum()

    def energy(q):
        return m * REAL(G) * (b * np.sin(q) - 2 * h * np.sin(q / 2) ** 2)

    turns = moment + m * b * b
    first = rate = np.sqrt(2 * energy(tilt) / turns)
    t, found = half(tilt), []
    while rate > REAL(1e-14) * first:
        found.append((float(t), float(rate)))
        rate = rate * REAL(ratio)
        aim = turns * rate * rate / 2
        top = aim / (m * REAL(G) * b)
        for _ in range(30):
            top = top - (energy(top) - aim) / (m * REAL(G) * (b * np.cos(top) - h * np.sin(top)))
        t = t + 2 * half(top)
    return found, float(t)


def simulated(m, moment, b, h, tilt, restitutions):
    scene = rb.Scene(gravity=[0, -G, 0])
    block = scene.add(
        rb.RigidBody(m, [moment / 2, moment / 2, moment]),
        rb.Planar([1, 0, 0], [0, 1, 0]),
        position=[0, b * np.sin(tilt) + h * np.cos(tilt)],
        angle=tilt,
    )
    floor = rb.Plane([0, 1, 0])
    for x, e in zip((-b, b), restitutions, strict=True):
        scene.contact(block.point([x, -h, 0]), floor, restitution=e)
    return rb.simulate(scene, 5.0, rtol=1e-14)


@pytest.mark.parametrize("tilt", [0.25, 0.01])
@pytest.mark.parametrize(("b", "h"), [(0.2, 0.3), (0.2, 0.4)])
def test_a_block_rocks_down_to_1e_14_of_its_first_speed(b, h, tilt):
    m, moment = 1.5, 1.5 * (b * b + h * h) / 3
    # the corner that strikes stays, for 0 <= P lifts the other one
    ratio = (1 / m - b * b / moment) / (1 / m + b * b / moment)
    expected, _ = impacts(m, moment, b, h, tilt, ratio)
    run = simulated(m, moment, b, h, tilt, (0.0, 0.0))
    found = run.events.times("land")
    assert len(found) >= len(expected) - 1 and run.events[-1].kind == "accumulation"
    for k, (t, _) in enumerate(expected[: len(found)]):
        assert abs(found[k] - t) < 4e-15, k
        # they take turns
        assert [e for e in run.events if e.kind == "land"][k].name == f"contact {2 - k % 2}"
    assert abs(run.events[-1].time - expected[-1][0]) < 4e-15


@pytest.mark.parametrize("e", [0.3, 0.7])
def test_an_end_of_a_rod_bounces_while_the_other_rests(e):
    m, b, tilt = 1.0, 0.5, 0.1
    moment = m * b * b / 3
    expected, limit = impacts(m, moment, b, 0.0, tilt, e)
    run = simulated(m, moment, b, 0.0, tilt, (0.0, e))
    found = run.events.times("impact")
    # flights of less than two roundings of the time are summed
    assert len(found) >= len(expected) - 2
    for k, (t, _) in enumerate(expected[: len(found)]):
        assert abs(found[k] - t) < 1e-14, k
    # what is left after 1e-14 of the first speed
    assert (run.events[-1].kind, abs(run.events[-1].time - limit) < 1e-14) == ("accumulation", True)


def dropped(e, *, slide=None, along=0.0):
    """A ball dropped from half a metre on a table, which may be on a rough slide; when its bounces end."""
    scene = rb.Scene(gravity=[0, -G, 0])
    ball = scene.add(
        rb.RigidBody(1.0, [0.1, 0.1, 0.1]), rb.Planar([1, 0, 0], [0, 1, 0]), position=[0, 1], velocity=[along, 0]
    )
    if slide is None:
        table = rb.Plane([0, 1, 0])
    else:
        table = scene.add(rb.RigidBody(2.0, [1, 1, 1]), slide).plane([0, 1, 0])
    scene.contact(ball.sphere(0.5), table, restitution=e)
    return scene, np.sqrt(1 / G) * (1 + e) / (1 - e)


@pytest.mark.parametrize("e", [0.3, 0.5, 0.7, 0.9])
@pytest.mark.parametrize("along", [0.0, 1.0])
def test_every_impact_of_a_ball_is_told_down_to_1e_12_of_the_first(e, along):
    scene, end = dropped(e, along=along)
    run = rb.simulate(scene, end + 0.5, error=1e-12)
    impulses = np.array([event.impulse[1] for event in run.events if event.kind == "impact"])
    k = np.arange(len(impulses))
    assert impulses == pytest.approx(np.sqrt(G) * (1 + e) * e**k, rel=1e-9, abs=1e-14)
    assert impulses[-1] < 1e-12 * impulses[0]
    (ends,) = run.events.times("accumulation")
    assert abs(ends - end) < 1e-13


@pytest.mark.parametrize("e", [0.3, 0.5, 0.7, 0.9])
def test_beside_friction_in_a_joint_bounces_end_when_their_series_does(e):
    """They are followed to some 1e-6 s of their end there; what is left takes the time of a geometric series."""
    scene, end = dropped(e, slide=rb.Prismatic([1, 0, 0], friction=rb.Coulomb(0.5)))
    run = rb.simulate(scene, end + 0.5, error=1e-10)
    (ends,) = run.events.times("accumulation")
    assert abs(ends - end) < 1e-10 * end


def test_what_lands_a_part_of_a_flight_later_strikes_later():
    """Two particles so low that doubles do not tell their gaps from nothing: each strikes when its own fall ends."""
    lower, later = 2.0**-33, 1 + 1e-5
    first = (2 * lower / G) ** 0.5
    falls = {"lower": lower, "higher": lower * (2.5 * later) ** 2}
    scene = rb.Scene(gravity=[0, -G, 0])
    bodies = [scene.add(rb.Particle(1.0), position=[1.0 + k, h, 0]) for k, h in enumerate(falls.values())]
    for name, body in zip(falls, bodies, strict=True):
        scene.contact(body, rb.Plane([0, 1, 0]), restitution=0.5, name=name)
    # one motion of both: it is level, and as long as it wants to be
    scene.connect(rb.Spring(1.0, rest_length=1.0), *bodies)
    run = rb.simulate(scene, 1e-3, rtol=1e-12)
    struck = {name: [e.time for e in run.events if e.kind == "impact" and e.name == name] for name in falls}
    for found, flights in zip(struck["lower"][:4], (1.0, 2.0, 2.5, 2.75), strict=True):
        assert abs(found - flights * first) < 1e-5 * 1e-4 * first
    for found, flights in zip(struck["higher"][:3], (1.0, 2.0, 2.5), strict=True):
        assert abs(found - flights * 2.5 * later * first) < 1e-5 * 1e-4 * first
