"""A free box that slides on a plate that rests in a plane slows down by mu g, whichever way it slides."""

import numpy as np
import pytest
import rbdyn as rb
from scipy.spatial.transform import Rotation

GRAVITY, MU, SPEED = 9.7, 0.05, 1.7


def slid(turned, across):
    x, y, z = turned.T
    scene = rb.Scene(gravity=-GRAVITY * z)
    plate = rb.RigidBody(0.8, [20.0] * 3)
    below = scene.add(plate, rb.Planar(x, z), position=[0, 0.05])
    for at in (-9, 9):
        scene.contact(below.point(at * x - 0.05 * z), rb.Plane(z), friction=rb.Coulomb(0.9))
    way = x * np.cos(across) + y * np.sin(across)
    box = scene.add(rb.RigidBody(0.3, [2.0] * 3), position=0.2 * z, velocity=SPEED * way, attitude=turned)
    for i in (-2, 2):
        for j in (-2, 2):
            scene.contact(box.point([i, j, -0.1]), below.plane(z, 0.05 * z), friction=rb.Coulomb(MU))
    run = rb.simulate(scene, 1.0, error=1e-9)
    return run[box].position(1.0) - run[box].position(0.0), way


@pytest.mark.parametrize("across", [0.0, 0.7, np.pi / 2])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_it_slows_down_by_its_friction(seed, across):
    turned = np.eye(3) if seed == 0 else Rotation.random(random_state=seed).as_matrix()
    moved, way = slid(turned, across)
    far = SPEED - MU * GRAVITY / 2
    assert np.linalg.norm(moved - far * way) < 1e-8 * far
