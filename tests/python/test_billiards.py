"""Motions that impacts make: what two runs of hardly any steps would agree on, though rounding made it, is told.

Balls that fly from wall to wall take one step from each impact to the next, whatever the tolerance. The truth is that
of the same doubles in 60 digits.
"""

from decimal import Decimal, getcontext

import numpy as np
import pytest
import rbdyn as rb

getcontext().prec = 60


def billiard(seed):
    """Sinai's: an elastic particle in a square around a disc. Its scene, and its place at the end by 60 digits."""
    random = np.random.default_rng(seed)
    radius = random.uniform(0.1, 0.35)
    place, velocity = [0.9, random.uniform(-0.9, 0.9), 0.0], [*random.normal(size=2), 0.0]
    until = float(random.choice([10, 20, 30]))
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=place, velocity=velocity)
    for normal in ([1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]):
        scene.contact(ball, rb.Plane(normal, [-c for c in normal]), restitution=1.0)
    scene.contact(ball, rb.Sphere([0, 0, 0], radius), restitution=1.0)

    x, v = [Decimal(c) for c in place[:2]], [Decimal(c) for c in velocity[:2]]
    square, left, bounces, was_round = Decimal(radius) ** 2, Decimal(until), 0, False
    while True:
        walls = [((1 if v[i] > 0 else -1) - x[i]) / v[i] for i in (0, 1)]
        flight, strikes = min((walls[0], 0), (walls[1], 1))
        along, speed2 = x[0] * v[0] + x[1] * v[1], v[0] ** 2 + v[1] ** 2
        inside = along**2 - speed2 * (x[0] ** 2 + x[1] ** 2 - square)
        if inside > 0 and along < 0 and not was_round and (d := (-along - inside.sqrt()) / speed2) < flight:
            flight, strikes = d, 2
        x = [c + w * min(flight, left) for c, w in zip(x, v, strict=True)]
        if flight > left:
            return scene, ball, until, np.array([float(c) for c in x]), bounces
        left, bounces, was_round = left - flight, bounces + 1, strikes == 2
        if was_round:
            turn = 2 * (x[0] * v[0] + x[1] * v[1]) / square
            v = [w - turn * c for c, w in zip(x, v, strict=True)]
        else:
            v[strikes] = -v[strikes]


@pytest.mark.parametrize("error", [1e-6, 1e-9])
def test_a_chaotic_billiard_is_as_right_as_it_tells(error):
    told = 0
    for seed in range(60):
        scene, ball, until, end, bounces = billiard(seed)
        try:
            run = rb.simulate(scene, until=until, error=error)
        except rb.AccuracyError:
            continue
        told += 1
        assert len(run.events) == bounces, seed
        true = np.abs(run[ball].position(until)[:2] - end).max() / 2
        assert true <= min(error, 3 * run.error + 1e-15), seed
    assert told >= 25


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13])
def test_a_ceiling_just_below_the_apex_is_struck_when_it_is_told(depth):
    speed, gravity = 3.1, 9.81
    apex = Decimal(speed) ** 2 / (2 * Decimal(gravity))
    ceiling = float(apex * (1 - Decimal(depth)))
    scene = rb.Scene(gravity=[0, 0, -gravity])
    ball = scene.add(rb.Particle(1.0), velocity=[0.0, 0.0, speed])
    scene.contact(ball, rb.Plane([0, 0, -1], [0, 0, ceiling]), restitution=0.5)
    left = (Decimal(speed) ** 2 - 2 * Decimal(gravity) * Decimal(ceiling)).sqrt()
    true = (Decimal(speed) - left) / Decimal(gravity)
    run = rb.simulate(scene, until=0.5, error=1e-7)
    (struck,) = run.events.times("impact")
    assert abs(Decimal(struck) - true) / true <= Decimal(2 * run.error + 2e-16)


def test_bounces_down_a_slope_are_known_to_thirteen_digits():
    # the numbers of the reference's slope: 269 bounces over 27 s, at up to 158 m/s along it
    scene = rb.Scene(gravity=[0, -9.81, 0])
    ball = scene.add(rb.Particle(1.0), position=[0, 10, 0], velocity=[1, 0, 0])
    scene.contact(ball, rb.Plane([-3, 4, 0]), restitution=0.9)
    run = rb.simulate(scene, until=40.0, error=1e-12)
    (limit,) = run.events.times("accumulation")
    assert abs(limit - 27.091427978515566428) <= 27.1 * run.error
