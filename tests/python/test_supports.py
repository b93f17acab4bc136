"""What rests on something that moves, against closed forms: riders share the motion of what carries them, exactly.

Forces pass the point of what is driven or slides there, so that moments of reactions are nothing but the rounding of
the places that they are differences of. What is really small beside that is still judged.
"""

import numpy as np
import pytest
import rbdyn as rb


@pytest.mark.parametrize("gravity", [9.81, 9.81e6])
@pytest.mark.parametrize("angle", [0.1, 0.3, 0.7, 1.1])
def test_a_package_rides_on_a_cart_that_slides_down(angle, gravity):
    down = np.array([np.cos(angle), 0, -np.sin(angle)])
    scene = rb.Scene(gravity=[0, 0, -gravity])
    cart = scene.add(rb.RigidBody(1.3, [1, 1, 1]), rb.Prismatic(down))
    package = scene.add(rb.Particle(0.7), position=[0, 0, 0])
    contact = scene.contact(package, cart.plane([0, 0, 1]), friction=rb.Coulomb(9.0))
    run = rb.simulate(scene, 1.0, error=1e-12)
    assert run.error < 1e-13 and not len(run.events)
    way = gravity * np.sin(angle) / 2
    assert np.abs(run[package].position(1.0) - way * down).max() < 1e-14 * way
    # m a - m g, horizontal and vertical
    force = 0.7 * (gravity * np.sin(angle) * down + [0, 0, gravity])
    assert np.abs(run[contact].force(0.5) - force).max() < 1e-13 * gravity


@pytest.mark.parametrize("seed", range(6))
def test_a_cart_that_brakes_keeps_what_sticks_on_it(seed):
    draw = np.random.default_rng(seed)
    heavy, light = draw.uniform(0.1, 3, 2)
    tilt, speed, mu, g = draw.uniform(0.05, 0.7), draw.uniform(0.2, 3), draw.uniform(0.05, 0.6), 9.81
    scene = rb.Scene(gravity=[0, 0, -g])
    slide = rb.Prismatic([1, 0, 0], friction=rb.Coulomb(mu))
    cart = scene.add(rb.RigidBody(heavy, [heavy] * 3), slide, rate=speed)
    rider = scene.add(rb.Particle(light), position=[0, 0, 0], velocity=[speed, 0, 0])
    scene.contact(rider, cart.plane([-np.sin(tilt), 0, np.cos(tilt)]), friction=rb.Coulomb(2.0))
    run = rb.simulate(scene, 2 * speed / (mu * g))
    stops = run.events.times("stick", cart)[0]
    assert abs(stops - speed / (mu * g)) < 1e-14 * stops
    assert abs(run[cart].displacement(run.end) - speed**2 / (2 * mu * g)) < 1e-14


@pytest.mark.parametrize("normal", [(1, 0, 1), (1, 2, 3), (-2, 1, 5)])
@pytest.mark.parametrize("mu", [0.0, 0.5])
def test_what_lies_on_a_plate_moves_as_the_plate_is_driven(normal, mu):
    n = np.array(normal) / np.linalg.norm(normal)
    scene = rb.Scene(gravity=-9.81 * n)
    plate = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Prismatic(n, motion=lambda t: 0.1 * np.sin(3 * t)))
    ball = scene.add(rb.RigidBody(1.0, [0.01] * 3), position=0.1 * n, velocity=0.3 * n)
    scene.contact(ball.sphere(0.1), plate.plane(n), friction=rb.Coulomb(mu) if mu else None)
    run = rb.simulate(scene, 2.0)
    t = np.linspace(0, 2, 9)
    assert np.abs(run[ball].position(t) - np.outer(0.1 + 0.1 * np.sin(3 * t), n)).max() < 1e-10


def test_a_reaction_that_is_small_is_still_told():
    """A moment of a micrometre's arm, far above the rounding of places: its digits are those that are left."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    cart = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Prismatic([1, 0, 0]), displacement=1.0)
    rider = scene.add(rb.Particle(0.5), position=[1 + 1e-6, 0, 0])
    scene.contact(rider, cart.plane([0, 0, 1]), friction=rb.Coulomb(0.5))
    run = rb.simulate(scene, 1.0, error=1e-8)
    assert 2e-10 < run.error < 1e-8
    arm = (1 + 1e-6) - 1.0
    assert abs(run[cart].reaction_torque(0.5)[1] + 0.5 * 9.81 * arm) < run.error * 0.5 * 9.81 * arm
    with pytest.raises(rb.AccuracyError):
        rb.simulate(scene, 1.0, error=1e-11)
