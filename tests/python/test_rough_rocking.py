"""Blocks that rock to rest on a floor where they do not slip, to 1e-12: impacts about fixed corners, by quadratures.

G. W. Housner, The behavior of inverted pendulum structures during earthquakes, 1963: about a corner, R from the centre
and alpha from upright, phi'' = p^2 sin(alpha - phi) back, p^2 = m g R / I, and an impact leaves 1 - (3/2) sin(alpha)^2
of the rate of a solid block. Small rates are taken from differences that are products, so that nothing cancels.
"""

import math

import numpy as np
import pytest
import rbdyn as rb

G = 9.8125
NODES, WEIGHTS = np.polynomial.legendre.leggauss(60)


def half_time(p2, alpha, top):
    """From rest at a tilt down to upright, by tilt = top - s^2."""
    s = 0.5 * math.sqrt(top) * (1 + NODES)
    rate = np.sqrt(4 * p2 * np.sin(alpha - top + s * s / 2) * np.sin(s * s / 2))
    return 0.5 * math.sqrt(top) * WEIGHTS @ (2 * s / rate)


def impacts(b, h, tilt, count=0):
    """Times of impacts and rates after them; without a count all down to 1e-13 of the first one."""
    alpha, size = math.atan2(b, h), math.hypot(b, h)
    p2 = G / size * 3 / 4
    left = 1 - 1.5 * math.sin(alpha) ** 2
    t = half_time(p2, alpha, tilt)
    rate = math.sqrt(4 * p2 * math.sin(alpha - tilt / 2) * math.sin(tilt / 2))
    found = [(t, rate * left)]
    while len(found) < count or (count == 0 and rate > 1e-13 * found[0][1]):
        rate *= left
        top = rate * rate / (4 * p2)
        for _ in range(200):
            top = 2 * math.asin(rate * rate / (4 * p2 * math.sin(alpha - top / 2)))
        t += 2 * half_time(p2, alpha, top)
        found.append((t, rate * left))
    return found


def end_of_rocking(b, h, tilt):
    """Where impacts accumulate: what is left of them is a geometric series."""
    left = 1 - 1.5 * math.sin(math.atan2(b, h)) ** 2
    *_, (before, _), (last, _) = impacts(b, h, tilt)
    return last + (last - before) * left / (1 - left)


def rocking(b, h, tilt, mu, restitution=0.0, mass=10.0):
    scene = rb.Scene(gravity=[0, -G, 0])
    plane = rb.Planar(x=[1, 0, 0], y=[0, 1, 0])
    solid = rb.RigidBody(mass, [h * h * mass / 3, b * b * mass / 3, (b * b + h * h) * mass / 3])
    c, s = math.cos(tilt), math.sin(tilt)
    block = scene.add(solid, plane, position=[b * c - h * s, b * s + h * c], angle=tilt)
    corners = [
        scene.contact(block.point([side, -h, 0]), rb.Plane([0, 1, 0]), friction=rb.Coulomb(mu), restitution=restitution)
        for side in (-b, b)
    ]
    return scene, block, corners


@pytest.mark.parametrize(
    ("b", "h", "tilt"), [(0.25, 0.75, 0.25), (0.21, 0.67, 0.2), (0.3, 0.8, 0.31), (0.123, 0.5, 0.1)]
)
def test_each_impact_is_where_its_quadrature_has_it(b, h, tilt):
    scene = rb.Scene(gravity=[0, -G, 0])
    plane = rb.Planar(x=[1, 0, 0], y=[0, 1, 0])
    solid = rb.RigidBody(10.0, [h * h * 10 / 3, b * b * 10 / 3, (b * b + h * h) * 10 / 3])
    place = [0.0, b * math.sin(tilt) + h * math.cos(tilt)]
    block = scene.add(solid, plane, position=place, angle=tilt)
    never = rb.Coulomb(math.inf)
    for side in (-b, b):
        scene.contact(block.point([side, -h, 0]), rb.Plane([0, 1, 0]), friction=never)
    run = rb.simulate(scene, 8.0, error=1e-12)
    assert run.error <= 1e-12
    lands = run.events.times("land")
    expected = impacts(b, h, tilt, min(len(lands), 60))
    assert len(lands) > 40
    for at, (t, _) in zip(lands, expected, strict=False):
        assert abs(at - t) <= max(run.error, 1e-14) * t
    for at, (_, rate) in zip(lands[:20], expected, strict=False):
        assert abs(abs(run[block].rate(at)) - rate) <= run.error * 3
    assert abs(run[block].angle(8.0)) < 1e-13


def random_blocks(count):
    rng = np.random.default_rng(1)
    slender = [(0.45216, 1.93360, 0.115695, 12.87), (0.33833, 1.69028, 0.151555, 8.60), (0.1, 0.95, 0.05, 1.0)]
    for b, h, tilt, mu in slender:
        yield b, h, tilt, mu, 1.0
    for _ in range(count):
        b = rng.uniform(0.05, 1)
        h = b * rng.uniform(0.8, 5)
        tilt = rng.uniform(0.02, 0.9) * math.atan2(b, h)
        yield b, h, tilt, rng.uniform(1, 30), 10 ** rng.uniform(-4, 4)


@pytest.mark.parametrize(("b", "h", "tilt", "mu", "mass"), list(random_blocks(30)))
def test_what_friction_holds_rocks_to_its_end_without_a_slip(b, h, tilt, mu, mass):
    # it asks for less than 0.75 N at any tilt: T / N is largest, h b / (h^2 + b^2) and less, where it is let go
    scene, block, corners = rocking(b, h, tilt, mu, mass=mass)
    run = rb.simulate(scene, 100.0, error=1e-9)
    assert len(run.events.times("slip")) == 0
    expected = end_of_rocking(b, h, tilt)
    (end,) = run.events.times("accumulation")
    assert run.error < 1e-10
    assert abs(end - expected) <= (run.error + 1e-14) * expected
    assert {run[corner].state(run.end) for corner in corners} == {"sticks"}
    assert abs(run[block].position(run.end)[0] - b) < 1e-12 and abs(run[block].angle(run.end)) < 1e-12


@pytest.mark.parametrize(("restitution", "slenderness"), [(0.1, 1.0), (0.1, 2.0), (0.3, 1.0), (0.3, 2.0), (0.3, 4.0)])
def test_corners_that_bounce_come_to_rest_as_where_nothing_ever_slips(restitution, slenderness):
    b = 0.2
    tilt = 0.4 * math.atan2(1, slenderness)
    ends = []
    for mu in (5.0, math.inf):
        scene, block, corners = rocking(b, b * slenderness, tilt, mu, restitution)
        run = rb.simulate(scene, 20.0, error=1e-8)
        assert len(run.events.times("slip")) == 0 and run.status == "reached end"
        assert {run[corner].state(run.end) for corner in corners} == {"sticks"}
        assert abs(run[block].angle(run.end)) < 1e-12
        ends.append((run.events.times("accumulation")[-1], run.error))
    (one, its), (other, others) = ends
    assert abs(one - other) <= (its + others) * other
