"""A ball that bounces to its end and rolls on, against friction's torque, until it rests.

Truth: impact by impact by hand. Each one takes (1 + e) of the speed along the normal, and along the plane what mu
allows or what makes it roll; nothing acts on it in flight. Then it slides, rolls, and rests by constant accelerations.
"""

import math

import numpy as np
import pytest
import rbdyn as rb

FORM = 0.4  # of its moment of inertia, in m r^2


def by_hand(r, h, v, omega, e, mu, rolling, g):
    """When the bounces end, when it rests, and where."""
    t, down = math.sqrt(2 * h / g), math.sqrt(2 * h * g)
    ways, times = [v * t], [t]
    while True:
        slip = v - omega * r
        needed, allowed = slip / (1 + 1 / FORM), mu * (1 + e) * down
        push = math.copysign(min(abs(needed), allowed), slip)
        v, omega = v - push, omega + push / (FORM * r)
        if abs(needed) <= allowed:
            omega = v / r
        down *= e
        flight = 2 * down / g
        if flight < 1e-20 * t:
            break
        ways.append(v * flight)
        times.append(flight)
    end = math.fsum(times)
    slip = v - omega * r
    if abs(slip) > 1e-14 * abs(v):
        way = math.copysign(1.0, slip)
        a, turn = -mu * g * way, (way * mu * g * r - math.copysign(rolling * g, omega)) / (FORM * r * r)
        d = -slip / (a - turn * r)
        ways.append(v * d + a * d * d / 2)
        times.append(d)
        v += a * d
    a = rolling * g / r / (1 + FORM)
    ways.append(v * abs(v) / (2 * a))
    times.append(abs(v) / a)
    return end, math.fsum(times), math.fsum(ways)


@pytest.mark.parametrize("seed", range(24))
def test_it_comes_to_rest_where_and_when_it_should(seed):
    rng = np.random.default_rng(seed)
    unit = 10.0 ** rng.uniform(-6, 6) if seed % 2 else 1.0
    r, mass, g = rng.uniform(0.05, 0.4) * unit, rng.uniform(0.3, 3.0), 9.8125 * unit
    h, v = rng.uniform(0.1, 1.0) * r, rng.uniform(0.2, 2.0) * unit
    omega = rng.uniform(0.0, 2.0) * v / r if seed % 3 else 0.0
    e, mu, rolling = rng.uniform(0.1, 0.9), rng.uniform(0.05, 0.8), rng.uniform(5e-4, 1e-2) * r
    end, rest, way = by_hand(r, h, v, omega, e, mu, rolling, g)

    scene = rb.Scene(gravity=[0, 0, -g])
    ball = scene.add(
        rb.RigidBody(mass, [FORM * mass * r * r] * 3),
        position=[0, 0, r + h],
        velocity=[v, 0, 0],
        angular_velocity=[0, omega, 0],
    )
    scene.contact(ball.sphere(r), rb.Plane([0, 0, 1]), friction=rb.Coulomb(mu, rolling=rolling), restitution=e)
    for error in (1e-6, 1e-12):
        run = rb.simulate(scene, until=1.2 * rest, error=error)
        told = run.error + 8e-15  # and what rounding makes of the truth
        bounced = [event.time for event in run.events if event.kind == "accumulation"]
        assert bounced == [pytest.approx(end, rel=told)]
        assert run[ball].position(run.end)[0] == pytest.approx(way, rel=told)
        assert (run[ball].velocity(run.end) == 0.0).all()
