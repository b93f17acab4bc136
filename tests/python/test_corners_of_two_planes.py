"""A particle that falls into a corner of two planes: it strikes them by turns, ever sooner, and is stopped in the
corner or between one of them and its weight. Against impacts one after the other, in 60 digits."""

import decimal
import math
from decimal import Decimal

import numpy as np
import pytest
import rbdyn as rb

g = 9.8125


def impacts(place, normals, e):
    """Times of impacts on planes through the origin of what falls from rest, until they follow at once."""
    with decimal.localcontext(decimal.Context(prec=60)):
        normals = [[Decimal(float(c)) for c in n] for n in normals]
        normals = [[c / (n[0] ** 2 + n[1] ** 2).sqrt() for c in n] for n in normals]
        p, v, e, weight = [Decimal(float(c)) for c in place], [Decimal(0)] * 2, Decimal(e), Decimal(g)
        t, last, times = Decimal(0), None, []
        while True:
            waits = []
            for n in normals:
                # a plane that was struck last is touched
                gap = Decimal(0) if n is last else n[0] * p[0] + n[1] * p[1]
                u, pull = n[0] * v[0] + n[1] * v[1], weight * n[1]
                waits.append((u + (u * u + 2 * pull * gap).sqrt()) / pull)
            wait, last = min((w, i) for i, w in enumerate(waits) if w > 0)
            last = normals[last]
            p = [p[0] + v[0] * wait, p[1] + v[1] * wait - weight * wait * wait / 2]
            v = [v[0], v[1] - weight * wait]
            u = last[0] * v[0] + last[1] * v[1]
            v = [c - (1 + e) * u * n for c, n in zip(v, last, strict=True)]
            t += wait
            times.append(float(t))
            if wait < t * Decimal(10) ** -25:
                return np.array(times)


@pytest.mark.parametrize("at", [[0, 0, 0], [0.3, -0.7, 0]], ids=["origin", "elsewhere"])
@pytest.mark.parametrize("angle", [0.8, 1.2, 1.4, 1.5, 1.53])
@pytest.mark.parametrize("e", [0.2, 0.5, 0.7])
@pytest.mark.parametrize("aside", [0.003, -0.015])
def test_a_particle_in_a_corner_strikes_by_turns_until_it_stops(at, angle, e, aside):
    """Between steep planes it went on switching (28 of these 60): 2e-15 s lie between its last impacts."""
    scene = rb.Scene(gravity=[0, -g, 0])
    bead = scene.add(rb.Particle(1.0), position=np.add(at, [aside, 1.0, 0]))
    normals = [[side * math.sin(angle), math.cos(angle)] for side in (1, -1)]
    for normal in normals:
        scene.contact(bead, rb.Plane([*normal, 0], at), restitution=e)
    run = rb.simulate(scene, 20.0, rtol=1e-12, max_steps=5000)
    times = impacts(np.subtract(np.add(at, [aside, 1.0, 0]), at)[:2], normals, e)
    assert run.status == "reached end"
    first = next(x.time for x in run.events if x.kind == "accumulation")
    assert abs(first - times[-1]) < 1e-13
    mine = np.array([x.time for x in run.events if x.kind == "impact" and x.time < first * (1 - 1e-9)])
    assert mine.size > 4 and np.allclose(mine, times[: mine.size], rtol=1e-13, atol=0)
    assert not (run[bead].position(20.0) - at).any() and not run[bead].velocity(20.0).any()
