"""Where bounces with friction end: in corners, against walls that nothing presses on, and in flight beside each other.

Truths: what two contacts at right angles leave of a ball's motion (nothing), and free flight.
"""

import math

import numpy as np
import pytest
import rbdyn as rb

G = 9.8125


@pytest.mark.parametrize("seed", range(40))
def test_a_ball_that_lands_in_a_corner_is_at_rest_to_the_bit(seed):
    """It rolls down the wall: floor and wall together stop all of it; it went on rolling at 1e-17 rad/s."""
    rng = np.random.default_rng(seed)
    radius, mass, speed = rng.uniform(0.1, 0.4), rng.uniform(0.5, 3.0), rng.uniform(0.01, 0.2)
    moment = rng.uniform(0.3, 0.9) * mass * radius**2
    scene = rb.Scene(gravity=[0, -G, 0])
    b = scene.add(
        rb.RigidBody(mass, [moment / 2, moment / 2, moment]),
        rb.Planar([1, 0, 0], [0, 1, 0]),
        position=[-radius, radius + rng.uniform(0, 1e-3)],
        velocity=[0, -speed],
        rate=-speed / radius,
    )
    for plane in rb.Plane([0, 1, 0]), rb.Plane([-1, 0, 0]):
        scene.contact(b.sphere(radius), plane, friction=rb.Coulomb(0.7))
    run = rb.simulate(scene, 1e5, rtol=1e-12)
    # what the wall does not press is held by no row, and its acceleration is one of rounding
    assert max(np.abs(run[b].velocity(1e5)).max(), np.abs(run[b].angular_velocity(1e5)).max()) < 1e-25
    assert (run[b].position(0.2) == run[b].position(1e5)).all() and run[b].angle(0.2) == run[b].angle(1e5)


@pytest.mark.parametrize("turns", [1e-7, 1e-6, 1e-5, 1e-3])
@pytest.mark.parametrize("way", [0.1, 1.0, 2.0, 3.0])
def test_balls_that_fly_along_touching_do_not_hold_each_other(way, turns):
    """Rolling on each other they part as what flies straight on does; a contact that pulled held them together."""
    radii, masses = np.array([0.2, 0.3]), (1.0, 2.0)
    normal = np.array([math.cos(way), math.sin(way)])
    across = np.array([-normal[1], normal[0]])
    scene = rb.Scene(gravity=[1.0, -G, 0])
    starts = np.array([0.0, 1.0]), np.array([0.0, 1.0]) + radii.sum() * normal
    speeds = np.array([1.0, 2.0]), np.array([1.0, 2.0]) + turns * radii.sum() * across
    balls = [
        scene.add(
            rb.RigidBody(m, [0.01 * m, 0.01 * m, 0.02 * m]),
            rb.Planar([1, 0, 0], [0, 1, 0]),
            position=list(x),
            velocity=list(v),
            rate=turns,
        )
        for m, x, v in zip(masses, starts, speeds, strict=True)
    ]
    contact = scene.contact(balls[0].sphere(0.2), balls[1].sphere(0.3), friction=rb.Coulomb(0.3))
    run = rb.simulate(scene, 0.3, rtol=1e-12)
    t = np.linspace(0.01, 0.3, 30)
    assert not run[contact].force(t).any()
    for b, x, v in zip(balls, starts, speeds, strict=True):
        free = x[:, None] + np.outer(v, t) + np.outer([1.0, -G], t * t / 2)
        assert np.abs(run[b].position(t)[:, :2].T - free).max() < 1e-15
        assert np.allclose(run[b].angular_velocity(t)[:, 2], turns, rtol=1e-8)
    # (r^2 + (u t)^2)^(1/2) - r
    apart = (turns * t) ** 2 * radii.sum() / 2
    assert np.abs(run[contact].gap(t) / apart - 1).max() < 1e-6 + 2e-15 / apart.min()
