"""Loads that pass the limit of friction by little: the slip as its closed form has it, or a refusal that says why.

A block is pushed by A sin(w t), where L = mu N holds. It slips from w t = pi/2 - a on, cos(a) = L / A, and with z = w
times the time since then stops where tan(a) (1 - cos z) = z - sin z, having moved by

    A / w^2 (sin(a) (z - sin z) + cos(a) (1 - cos z - z^2 / 2)) / m.

Both sides are taken by their series, so that nothing cancels.
"""

import math
import re

import numpy as np
import pytest
import rbdyn as rb
from scipy.optimize import brentq

G, W, MU = 9.8125, 2.0, 0.5


def after(first, z):
    """The series of sine or cosine from the term of power `first` on."""
    return sum((-1) ** (n // 2) * z**n / math.factorial(n) for n in range(first, first + 20, 2))


def slips(load):
    """When it slips and stops, and how far it goes, under A = load; L is a number of few bits."""
    limit = MU * G
    a = math.atan2(math.sqrt((load - limit) * (load + limit)), limit)
    # z - sin z = -after(3), 1 - cos z = -after(2)
    z = brentq(lambda z: math.tan(a) * -after(2, z) / z**2 + after(3, z) / z**2, a, 6 * a, xtol=1e-300, rtol=1e-15)
    moves = load / W**2 * (math.sin(a) * -after(3, z) - math.cos(a) * after(4, z))
    begins = (math.pi / 2 - a) / W
    return begins, begins + z / W, moves


def block(load, friction):
    scene = rb.Scene(gravity=[0, 0, -G])
    mass = scene.add(rb.Particle(1.0), position=[0, 0, 0])
    scene.contact(mass, rb.Plane([0, 0, 1]), friction=friction)
    scene.apply(rb.Force(lambda t, r, v: [load * np.sin(W * t), 0, 0]), mass)
    return scene, mass


@pytest.mark.parametrize("excess", [1e-3, 1e-4, 1e-5, 1e-6])
def test_a_cone_that_is_passed_by_a_millionth_is_passed_as_the_closed_form_says(excess):
    load = MU * G + excess
    scene, mass = block(load, rb.Coulomb(MU))
    run = rb.simulate(scene, 2.0, error=1e-9)
    begins, ends, moves = slips(load)
    assert [event.kind for event in run.events] == ["slip", "stick", "rest"]
    # when it begins is known to the rounding of the time, all that follows to that of forces beside the margin
    assert abs(run.events[0].time - begins) <= 4e-16
    assert abs(run.events[1].time - ends) <= 4e-16 + run.error * (ends - begins)
    assert abs(run[mass].position(2.0)[0] - moves) <= run.error * moves
    assert run.error <= 1e-9


@pytest.mark.parametrize("excess", [1e-8, 1e-10, 1e-12, 1e-13])
def test_what_rounding_decides_is_refused_with_the_margin(excess):
    load = MU * G + excess
    scene, mass = block(load, rb.Coulomb(MU))
    with pytest.raises(rb.AccuracyError, match=r"friction of contact 1 is passed from t = 0\.785") as refused:
        rb.simulate(scene, 2.0, error=1e-9)
    told = str(refused.value)
    begins, _, moves = slips(load)
    run = refused.value.run
    assert abs(run.events[0].time - begins) <= 1e-12
    if "reached" in told:
        # of the run that is returned, where another one was better
        returned = re.search(r"\((\S+) in the run that is returned", told) or re.search(r"reached (\S+) in", told)
        assert abs(run[mass].position(2.0)[0] / moves - 1) <= 3 * float(returned[1])
    part = float(told.split("s, by ")[1].split(" of what")[0])
    assert abs(part - (load - MU * G) / (MU * G)) <= 0.05 * part + 1e-15
    assert "mu_dynamic below mu_static" in told


def test_with_a_dynamic_coefficient_below_it_the_same_margin_is_known():
    load = MU * G + 1e-11
    scene, _ = block(load, rb.Coulomb(MU, 0.3))
    run = rb.simulate(scene, 2.0, error=1e-9)
    assert run.error <= 1e-9
    assert run.events[0].kind == "slip" and abs(run.events[0].time - slips(load)[0]) <= 4e-16
