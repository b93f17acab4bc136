"""What moves as functions of time say is known to the rounding of the time at which they are asked, and that is told.

A function that you write is computed in doubles: of sin(w t) the product is rounded, which is w times half a unit in
the last place of the time. Truth: the exact product, less whole turns of 50 digits.
"""

import math
from fractions import Fraction

import numpy as np
import pytest
import rbdyn as rb

CASES = [(3.0, 1e6, 2.0), (100.0, 1e4, 2.0), (1539.438, -100.0, 3e-4), (7.3, 0.0, 3e4), (2.9e4, 12.5, 1e-3)]
TURN = 2 * Fraction("3.14159265358979323846264338327950288419716939937510")


def turned(w, t):
    """w t, less whole turns."""
    angle = Fraction(w) * Fraction(t)
    return float(angle - round(angle / TURN) * TURN)


def swung(w):
    scene = rb.Scene()
    arm = rb.RigidBody(1.0, [1, 1, 1], com=[0.5, 0, 0])
    return scene, scene.add(arm, rb.Revolute([0, 0, 1], motion=lambda t: 0.6 * np.sin(w * t)))


def slid(w):
    scene = rb.Scene()
    return scene, scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Prismatic([1, 0, 0], motion=lambda t: 0.6 * np.cos(w * t)))


@pytest.mark.parametrize("w, start, span", CASES)
@pytest.mark.parametrize("made, truth", [(swung, math.sin), (slid, math.cos)])
def test_the_rounding_of_the_time_is_told(made, truth, w, start, span):
    scene, body = made(w)
    run = rb.simulate(scene, start + span, start=start, error=1e-6)
    times = start + span * np.random.default_rng(5).uniform(0.01, 0.99, 60)
    values = np.array([0.6 * truth(turned(w, float(t))) for t in times])
    found = run[body].angle(times) if made is swung else run[body].displacement(times)
    assert abs(found - values).max() <= 3 * run.error * np.ptp(values)
    assert run.error < 1e-6


def test_what_is_asked_beyond_it_is_refused():
    scene, _ = swung(3.0)
    with pytest.raises(rb.AccuracyError):
        rb.simulate(scene, 1e6 + 2, start=1e6, error=1e-12)
    assert rb.simulate(scene, 2.0, error=1e-12).error < 1e-14
