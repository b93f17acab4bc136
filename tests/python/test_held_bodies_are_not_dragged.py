"""What constraints leave no motion has a speed of rounding, and a drag by its square has no direction there."""

import numpy as np
import pytest
import rbdyn as rb


def scene_of(joint, constraint, is_held, turned):
    """A pendulum on a plate that constraints hold still, or on none."""
    scene = rb.Scene(gravity=turned @ [0, 0, -9.81])
    parent = {}
    if is_held:
        inertia = turned @ np.diag([0.3, 0.4, 0.5]) @ turned.T
        plate = scene.add(rb.RigidBody(2.0, (inertia + inertia.T) / 2), joint(turned))
        scene.constrain(constraint(turned), plate, [0, 0, 0])
        scene.apply(rb.Drag(quadratic=3.0), plate)
        parent = {"parent": plate}
    rod = rb.RigidBody(1.0, [0.02, 0.02, 0.02], com=turned @ [0, 0, -0.4])
    rod = scene.add(rod, rb.Revolute(turned @ [0, 1, 0]), angle=1.2, rate=0.7, **parent)
    return scene, rod


@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("joint", "constraint"),
    [
        (lambda q: rb.Planar(q @ [1, 0, 0], q @ [0, 0, 1]), lambda q: rb.Weld()),
        (lambda q: rb.Free(), lambda q: rb.Weld()),
        (lambda q: rb.Spherical(), lambda q: rb.Weld()),
        (lambda q: rb.Universal(q @ [0, 1, 0], q @ [1, 0, 0]), lambda q: rb.Weld()),
    ],
)
def test_a_pendulum_on_a_plate_that_is_held_still_is_one_on_the_ground(joint, constraint, seed, error):
    """Its speed passed zero by rounding again and again: no accuracy was sure of these events, and all were refused."""
    turned, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    turned *= np.linalg.det(turned)
    scene, rod = scene_of(joint, constraint, True, turned)
    run = rb.simulate(scene, 0.8, error=error)
    alone, free = scene_of(joint, constraint, False, turned)
    expected = rb.simulate(alone, 0.8, error=1e-13)
    assert [e for e in run.events if e.kind == "switch"] == []
    t = np.linspace(0, 0.8, 9)
    off = np.abs(run[rod].angle(t) - expected[free].angle(t)).max()
    assert off < 3.0 * error and run.error < error
