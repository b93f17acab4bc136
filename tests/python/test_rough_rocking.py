"""Blocks that rock to rest on a floor that never lets them slip, to 1e-12: impacts about fixed corners, by quadratures.

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


def impacts(b, h, tilt, count):
    alpha, size = math.atan2(b, h), math.hypot(b, h)
    p2 = G / size * 3 / 4
    left = 1 - 1.5 * math.sin(alpha) ** 2
    t = half_time(p2, alpha, tilt)
    rate = math.sqrt(4 * p2 * math.sin(alpha - tilt / 2) * math.sin(tilt / 2))
    found = [(t, rate * left)]
    while len(found) < count:
        rate *= left
        top = rate * rate / (4 * p2)
        for _ in range(200):
            top = 2 * math.asin(rate * rate / (4 * p2 * math.sin(alpha - top / 2)))
        t += 2 * half_time(p2, alpha, top)
        found.append((t, rate * left))
    return found


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
