"""Balls that strike each other by turns, ever slower, go on until their limit, though no force presses them together.

Truth: Newton's law impact by impact, in 800 decimal digits, for where flights get shorter by a ninth speeds get less by
ten; the last speed is that of the centre of mass. A middle ball goes to and fro between two others, or between a wall
and another: with little restitution what is left of the speeds gets less than any rounding of them long before the time
that is left does.
"""

from decimal import Decimal, getcontext

import numpy as np
import pytest
import rbdyn as rb

RADIUS = 0.1
# where the last impact comes much later than the others
REFUSED = (7,)


def strikes(masses, places, speeds, e, walled):
    """Of each impact its time, its place in the row and what a rounding of the speeds makes of its flight; the limit of
    the times, none if they part."""
    getcontext().prec = 800
    inverse = [1 / Decimal(m) for m in masses]
    x, v = [Decimal(a) for a in places], [Decimal(a) for a in speeds]
    apart = [2 * Decimal(RADIUS)] * (len(x) - 1)
    if walled:
        inverse, x, v = [Decimal(0), *inverse], [Decimal(-0.3), *x], [Decimal(0), *v]
        apart = [Decimal(RADIUS), *apart]
    t, found, quiet = Decimal(0), [], 0
    while quiet < 4 * len(x):
        next_ones = [
            (max(x[i + 1] - x[i] - apart[i], Decimal(0)) / (v[i] - v[i + 1]), i)
            for i in range(len(apart))
            if v[i] > v[i + 1]
        ]
        if not next_ones:
            return found, None
        flight, i = min(next_ones)
        rounding = Decimal(2.2e-16) * flight * abs(Decimal(max(speeds, key=abs)) / (v[i] - v[i + 1]))
        quiet = quiet + 1 if flight < Decimal("1e-25") else 0
        t += flight
        x = [a + b * flight for a, b in zip(x, v, strict=True)]
        impulse = (1 + Decimal(e)) * (v[i] - v[i + 1]) / (inverse[i] + inverse[i + 1])
        v[i] -= impulse * inverse[i]
        v[i + 1] += impulse * inverse[i + 1]
        found.append((t, i, rounding))
    return found, t


def row(masses, places, speeds, e, walled):
    scene = rb.Scene()
    balls = [
        scene.add(rb.RigidBody(m, [0.4 * m * RADIUS**2] * 3), position=[x, 0, 0], velocity=[v, 0, 0])
        for m, x, v in zip(masses, places, speeds, strict=True)
    ]
    contacts = []
    if walled:
        contacts.append(scene.contact(balls[0].sphere(RADIUS), rb.Plane([1, 0, 0], [-0.3, 0, 0]), restitution=e))
    for a, b in zip(balls, balls[1:], strict=False):
        contacts.append(scene.contact(a.sphere(RADIUS), b.sphere(RADIUS), restitution=e))
    return scene, balls, contacts


def check(masses, places, speeds, e, walled, error):
    truth, limit = strikes(masses, places, speeds, e, walled)
    scene, balls, contacts = row(masses, places, speeds, e, walled)
    span = float(limit if limit is not None else truth[-1][0]) * 1.7
    run = rb.simulate(scene, span, error=error)
    told = [(v.time, contacts.index(v.subject)) for v in run.events if v.kind == "impact"]
    assert len(told) >= min(len(truth), 3)
    for (time, contact), (exact, of, rounding) in zip(told, truth, strict=False):
        assert contact == of
        assert abs(Decimal(time) - exact) <= Decimal(run.error) * exact + rounding
    if limit is None:
        assert len(told) == len(truth) == len(run.events)
        return None
    ends = [v for v in run.events if v.kind != "impact"]
    assert [v.kind for v in ends] == ["accumulation"]
    off = float(abs(Decimal(ends[0].time) - limit) / limit)
    assert off <= run.error
    # they go on together
    last = 0.0 if walled else np.dot(masses, speeds) / sum(masses)
    for ball in balls:
        assert abs(run[ball].velocity(span)[0] - last) <= run.error * max(abs(np.array(speeds)))
    return off, run.error


def test_three_balls_go_on_to_their_limit():
    masses, places = [1.09, 0.411, 0.0584], [0.0, 0.41800000000000004, 1.532]
    for error in (1e-7, 6e-10):
        off, told = check(masses, places, [1.9911170785846941, 0.0, 0.0], 0.02, False, error)
        assert off < 2e-11 and told < 1e-10


@pytest.mark.parametrize("walled", [False, True])
@pytest.mark.parametrize("seed", range(40))
def test_rows_of_any_masses_strike_as_newton_says(seed, walled):
    rng = np.random.default_rng(seed)
    count = 2 if walled else 3
    masses = [float(f"{10**x:.3g}") for x in rng.uniform(-2, 2, count)]
    places = [0.0]
    for gap in rng.uniform(0.01, 1, count - 1):
        places.append(places[-1] + 2 * RADIUS + round(float(gap), 3))
    speeds = [0.0] * count
    speeds[-1 if walled else 0] = (-1 if walled else 1) * float(rng.uniform(0.5, 2))
    e = float(round(10 ** rng.uniform(np.log10(0.005), np.log10(0.3)), 4))
    try:
        check(masses, places, speeds, e, walled, 1e-7)
    except rb.AccuracyError:
        assert not walled and seed in REFUSED
