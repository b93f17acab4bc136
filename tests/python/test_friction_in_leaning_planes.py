"""What joints keep in a plane is known as well in a plane that leans as in one along the world's axes.

Across that plane nothing moves, and what the joint can bear there alone it does: friction at contacts has no part of
it. A box that is pulled ever harder breaks away when the pull is mu m g, and moves by the third power of the time then;
one that a disc rolls over tips when their centre of mass is over its foot. The scenes are turned as a whole.
"""

import numpy as np
import pytest
import rbdyn as rb
from scipy.spatial.transform import Rotation

MASS, WEIGHT, RATE = 1.3, 9.7, 4.0


def axes(seed):
    return np.eye(3) if seed == 0 else Rotation.random(random_state=seed).as_matrix()


def pulled(turned, mu, mu_dynamic):
    x, _, z = turned.T
    scene = rb.Scene(gravity=-WEIGHT * z)
    box = scene.add(rb.RigidBody(MASS, [0.3] * 3), rb.Planar(x, z))
    feet = [
        scene.contact(box.point(at * x - 0.001 * z), rb.Plane(z, -0.001 * z), friction=rb.Coulomb(mu, mu_dynamic))
        for at in (-0.9, 0.9)
    ]
    pull = RATE * x
    scene.apply(rb.Force(lambda t, r, v: [float(pull[0]) * t, float(pull[1]) * t, float(pull[2]) * t]), box)
    return scene, box, feet


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("error", [1e-9, 1e-12])
@pytest.mark.parametrize("mu, mu_dynamic", [(0.3, 0.3), (0.3, 0.24), (0.71, 0.71)])
def test_a_box_that_is_pulled_ever_harder(seed, error, mu, mu_dynamic):
    turned = axes(seed)
    scene, box, feet = pulled(turned, mu, mu_dynamic)
    breaks = mu * MASS * WEIGHT / RATE
    run = rb.simulate(scene, breaks + 0.4, error=error)
    jump = (mu - mu_dynamic) * WEIGHT
    far = jump * 0.4**2 / 2 + RATE * 0.4**3 / 6 / MASS
    assert run.events.times("slip") == pytest.approx([breaks] * 2, rel=1e-13)
    assert abs(run[box].position(run.end) @ turned[:, 0] - far) <= 3 * run.error * far
    for foot in feet:
        across = run[foot].force(np.linspace(0, run.end, 50)) @ turned[:, 1]
        assert abs(across).max() <= 1e-14 * MASS * WEIGHT


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("mu", [0.5, 0.15])
def test_a_box_that_tips_under_a_disc(seed, mu):
    turned = axes(seed)
    x, y, z = turned.T
    disc_mass, width, height, radius, speed, start = 2.9, 0.7, 0.5, 0.3, 0.77, -0.1
    tips = ((1 + MASS / disc_mass) * width / 2 - start) / speed
    about = np.outer(x, x) / 2 + np.outer(y, y) / 2 + np.outer(z, z)
    scene = rb.Scene(gravity=-WEIGHT * y)
    box = scene.add(
        rb.RigidBody(MASS, MASS * (width**2 + height**2) / 12 * about), rb.Planar(x, y), position=[0, height / 2]
    )
    disc = scene.add(
        rb.RigidBody(disc_mass, disc_mass * radius**2 / 2 * about),
        rb.Planar(x, y),
        position=[start, height + radius],
        velocity=[speed, 0],
        rate=-speed / radius,
    )
    feet = [
        scene.contact(box.point(at * x - height / 2 * y), rb.Plane(y), friction=rb.Coulomb(mu))
        for at in (-width / 2, width / 2)
    ]
    scene.contact(disc.sphere(radius), box.plane(y, height / 2 * y), friction=rb.Coulomb(2.0))
    run = rb.simulate(scene, tips + 0.2, error=1e-10)
    assert [e.kind for e in run.events][:1] == ["detach"]
    assert run.events[0].time == pytest.approx(tips, rel=1e-12)
    times = np.linspace(0, run.end, 100)
    for foot in feet:
        assert abs(run[foot].force(times) @ z).max() <= 1e-13 * (MASS + disc_mass) * WEIGHT


@pytest.mark.parametrize("angle", [1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12])
@pytest.mark.parametrize("seed", range(3))
def test_planes_that_hardly_lean(seed, angle):
    """A box slides to rest on a plate in a plane beside one of the world; nothing turns them out of it."""
    way = np.random.default_rng(seed).normal(size=3)
    x, y, z = Rotation.from_rotvec(angle * way / np.linalg.norm(way)).as_matrix().T
    scene = rb.Scene(gravity=-WEIGHT * z)
    plate = scene.add(rb.RigidBody(0.8, [20.0] * 3), rb.Planar(x, z), position=[0, 0.05])
    feet = [scene.contact(plate.point(at * x - 0.05 * z), rb.Plane(z), friction=rb.Coulomb(0.4)) for at in (-3, 3)]
    box = scene.add(rb.RigidBody(0.5, [2.0] * 3), rb.Planar(x, z), position=[0, 0.2], velocity=[1.3, 0])
    feet += [
        scene.contact(box.point(at * x - 0.1 * z), plate.plane(z, 0.05 * z), friction=rb.Coulomb(0.21))
        for at in (-1, 1)
    ]
    stops = 1.3 / (0.21 * WEIGHT)
    run = rb.simulate(scene, stops + 0.3, error=1e-12)
    assert run.events.times("stick") == pytest.approx([stops] * 2, rel=1e-12)
    assert (run[box].position(run.end) - run[box].position(0)) @ x == pytest.approx(1.3 * stops / 2, rel=1e-12)
    times = np.linspace(0, run.end, 20)
    for body in (plate, box):
        torque = run[body].reaction_torque(times)
        assert abs(torque @ x).max() <= 1e-13 and abs(torque @ z).max() <= 1e-13
    for foot in feet:
        assert abs(run[foot].force(times) @ y).max() <= 1e-14


@pytest.mark.parametrize("seed", range(8))
def test_what_stands_still_takes_no_steps(seed):
    """A plate that rests but for rounding does not keep the box that slides on it from one step to where it stops."""
    turned = axes(seed)
    x, _, z = turned.T
    scene = rb.Scene(gravity=-WEIGHT * z)
    plate = scene.add(rb.RigidBody(0.8, [20.0] * 3), rb.Planar(x, z), position=[0, 0.05])
    for at in (-3, 3):
        scene.contact(plate.point(at * x - 0.05 * z), rb.Plane(z), friction=rb.Coulomb(0.4))
    box = scene.add(rb.RigidBody(0.5, [2.0] * 3), rb.Planar(x, z), position=[0, 0.2], velocity=[2.6, 0])
    for at in (-1, 1):
        scene.contact(box.point(at * x - 0.1 * z), plate.plane(z, 0.05 * z), friction=rb.Coulomb(0.21))
    run = rb.simulate(scene, 1.2, rtol=1e-12)
    assert run.statistics.steps <= 3
