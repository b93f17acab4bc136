"""Lengths, masses and times in other powers of two: every engine gives the same motion, bit for bit."""

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
