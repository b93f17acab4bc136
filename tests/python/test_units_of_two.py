"""Lengths, masses and times in other powers of two: every engine gives the same motion, bit for bit, contacts too."""

import numpy as np
import pytest
import rbdyn as rb

ENGINES = [engine for engine in rb.engines() if engine != "closed form"]


def stiff_springs(length, mass, time, engine):
    """Three masses on springs and dampers, one of them stiff, in units of which there are so many in a m, kg and s."""
    newton, stiffness, damping = mass * length / time**2, mass / time**2, mass / time
    scene = rb.Scene(gravity=[0, 0, -9.8125 * newton / mass])
    places = [[1.0, 0, 0], [2.0, 0.25, 0], [2.0, 0, 1.5]]
    bodies = [
        scene.add(rb.Particle(m * mass), position=np.array(r) * length)
        for m, r in zip((1.0, 3.0, 0.375), places, strict=True)
    ]
    ends = [[0, 0, 0], *bodies]
    for k, (strong, slow) in enumerate([(1e4, 200.0), (1e3, 10.0), (50.0, 0.5)]):
        spring = rb.Spring(strong * stiffness, rest_length=0.875 * length, damping=slow * damping)
        scene.connect(spring, ends[k + 1], ends[k])
    run = rb.simulate(scene, 2.0 * time, rtol=1e-7, engine=engine)
    return [np.array(run[body].position(k * time / 4)) / length for body in bodies for k in range(9)]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("units", [(2.0**10, 1, 1), (1, 2.0**-20, 1), (1, 1, 2.0**13), (2.0**-7, 2.0**11, 2.0**-9)])
def test_they_change_no_bit(units, engine):
    plain, other = stiff_springs(1, 1, 1, engine), stiff_springs(*units, engine)
    assert all(np.array_equal(a, b) for a, b in zip(plain, other, strict=True))


def ball_and_bars(length, mass, time):
    """A ball thrown on a floor that it touches, and two bars whose tip strikes a wall."""
    scene = rb.Scene(gravity=[0, -9.8125 * length / time**2, 0])

    def body(m, moment, com=0.0):
        moment *= mass * length**2
        return rb.RigidBody(m * mass, [moment, moment, moment], com=[0, com * length, 0])

    ball = scene.add(
        body(2.0, 0.25),
        rb.Planar([1, 0, 0], [0, 1, 0]),
        position=[0, 0.5 * length],
        velocity=[1.5 * length / time, 2.0 * length / time],
        rate=3.0 / time,
    )
    scene.contact(ball.sphere(0.5 * length), rb.Plane([0, 1, 0]), restitution=0.5, friction=rb.Coulomb(0.25))
    upper = scene.add(body(1.0, 0.125, -0.5), rb.Revolute([0, 0, 1], at=[5 * length, 4 * length, 0]), rate=1.0 / time)
    at = [0, -length, 0]
    lower = scene.add(body(1.0, 0.125, -0.5), rb.Revolute([0, 0, 1], at=at), rate=-2.0 / time, parent=upper)
    wall = rb.Plane([1, 0, 0], [4.875 * length, 0, 0])
    scene.contact(lower.point([0, -length, 0]), wall, restitution=0.75)
    run = rb.simulate(scene, 1.5 * time, error=1e-10)
    events = [(e.kind, e.name, e.time / time) for e in run.events]
    places = [run[b].position(k * time / 4) / length for b in (ball, upper, lower) for k in range(7)]
    return events, np.array(places)


@pytest.mark.parametrize(
    "units", [(2.0**-60, 1, 1), (2.0**90, 2.0**-90, 2.0**40), (1, 2.0**100, 1), (2.0**-100, 2.0**-50, 2.0**-100)]
)
def test_they_change_no_bit_of_contacts(units):
    """A moment of inertia is as small as its unit makes it, beside any mass."""
    (events, places), (others, there) = ball_and_bars(1, 1, 1), ball_and_bars(*units)
    assert len(events) > 5 and {kind for kind, *_ in events} >= {"impact"}
    assert events == others and np.array_equal(places, there)
