"""Ellipsoids and discs that begin with the velocities of rolling where friction cannot hold them, so that they slip at
once: the same motion at any time and in any unit of length, by their equations written down apart (rolling_by_hand.py),
from a slip of a billionth."""

import numpy as np
import pytest
import rbdyn as rb

pytest.importorskip("scipy")
from rolling_by_hand import Body, disc, ellipsoid  # noqa: E402

GRAVITY, MU, END = 9.8125, 0.02, 0.25


def drawn(seed):
    """Shape, mass, inertia, attitude and angular velocity, in units of 1 m."""
    rng = np.random.default_rng([31, seed])
    mass = rng.uniform(0.5, 2)
    semi_axes = rng.uniform(0.1, 0.2, 3)
    inertia = np.diag(mass * rng.uniform(0.005, 0.009, 3))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    return seed % 2 == 0, semi_axes, mass, inertia, turn, rng.normal(size=3) * 3


def by_hand(seed):
    is_disc, semi_axes, mass, inertia, turn, omega = drawn(seed)
    hand = Body(mass, inertia, disc(semi_axes[0]) if is_disc else ellipsoid(semi_axes), GRAVITY, mu=MU)
    r, _ = hand.arm(turn, omega)
    return hand.run(turn, omega, [0.0, END], v=-np.cross(turn @ omega, r) + [1e-9, 0, 0])


@pytest.mark.parametrize("seed", range(6))
def test_what_cannot_roll_slips_at_once_at_any_time_in_any_unit(seed):
    is_disc, semi_axes, mass, inertia, turn, omega = drawn(seed)
    begin, end = by_hand(seed)
    for length, start in ((1.0, 0.0), (1e-3, 1e3), (1e-6, 0.0), (1e-6, 1e4), (1e3, 1e4)):
        scene = rb.Scene(gravity=[0, 0, -GRAVITY * length])
        body = scene.add(
            rb.RigidBody(mass, inertia * length**2),
            position=begin[9:12] * length,
            velocity=(begin[12:15] - [1e-9, 0, 0]) * length,
            attitude=turn,
            angular_velocity=omega,
        )
        surface = body.disc(semi_axes[0] * length, [0, 0, 1]) if is_disc else body.ellipsoid(semi_axes * length)
        contact = scene.contact(surface, rb.Plane([0, 0, 1]), friction=rb.Coulomb(MU))
        run = rb.simulate(scene, start=start, until=start + END, error=1e-9)
        assert run[contact].state(start) == "slides" and list(run.events) == []
        at = run.end
        found = np.concatenate([run[body].rotation_matrix(at).ravel(), run[body].position(at) / length])
        assert np.abs(found - end[:12]).max() < 2e-8
        assert np.abs(run[body].velocity(at) / length - end[12:15]).max() < 1e-7
