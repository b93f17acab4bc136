"""What is zero but for rounding (a reaction, a momentum, a free motion's damping) is measured by what it is a sum of,
never by itself. Against uniform motions and, of linear scenes, the matrix exponential.
"""

import numpy as np
import pytest
import rbdyn as rb
from scipy.linalg import expm


@pytest.mark.parametrize("error", [1e-3, 1e-9, 1e-12])
@pytest.mark.parametrize("com", [[0.1, 0, 0], [0.1, 0.2, 0], [-0.3, 0.07, 0.2]])
def test_a_body_in_the_plane_without_loads_moves_on(com, error):
    scene = rb.Scene()
    body = rb.RigidBody(1.0, [0.3, 0.33, 0.4], com=com)
    handle = scene.add(body, rb.Planar([1, 0, 0], [0, 1, 0]), velocity=[0.4, 0.5], rate=0.7)
    run = rb.simulate(scene, 2.0, error=error)
    assert run.error <= min(error, 1e-11)
    flat = np.array([*com[:2], 0.0])
    velocity = np.array([0.4, 0.5, 0.0]) + 0.7 * np.array([-com[1], com[0], 0.0])
    for t in (0.5, 2.0):
        at = run[handle].center_of_mass(t)
        assert np.abs(at[:2] - (flat + t * velocity)[:2]).max() < max(1e-14, run.error)
        assert abs(run[handle].angle(t) - 0.7 * t) < max(1e-14, run.error)


def test_what_falls_without_turning_takes_what_slides_on_it_along():
    """Nothing acts between a body and one that slides on it, whatever their masses; both fall."""
    scene = rb.Scene(gravity=[0, -9.81, 0])
    body = rb.RigidBody(1.9, [0.3, 0.3, 0.4], com=[0.1, -0.2, 0.05])
    falls = scene.add(body, position=[0.3, 0, 0], velocity=[0.7, 0, 0])
    slides = scene.add(
        rb.RigidBody(0.7, [0.3, 0.33, 0.4], com=[0.2, 0.1, 0]), rb.Prismatic([1, 2, 3]), parent=falls, displacement=0.4
    )
    run = rb.simulate(scene, 1.0, error=1e-9)
    assert run.error < 1e-12
    assert abs(run[slides].displacement(1.0) - 0.4) < 1e-14
    drop = run[falls].position(1.0) - run[falls].position(0.0)
    assert np.abs(drop - [0.7, -4.905, 0.0]).max() < 1e-13


def carts(masses, stiffness, damping, places, velocities):
    scene = rb.Scene()
    handles = [
        scene.add(rb.Particle(m), position=[x, 0, 0], velocity=[v, 0, 0])
        for m, x, v in zip(masses, places, velocities, strict=True)
    ]
    for a, b in zip(handles, handles[1:], strict=False):
        scene.connect(rb.Spring(stiffness, 0.0, damping=damping), a, b)
    return scene, handles


def test_damping_along_the_stiffness_leaves_the_whole_free():
    """A row of carts that nothing holds, springs and dampers between them, of any masses: half of them were refused."""
    worst = 0.0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(2, 6))
        masses = rng.uniform(0.5, 2.0, n).round(1 if seed % 2 else 16)
        stiffness, damping = rng.uniform(0.5, 5.0), rng.uniform(0.05, 0.5)
        places, velocities = rng.uniform(-1, 1, n), rng.uniform(-1, 1, n)
        scene, handles = carts(masses, stiffness, damping, places, velocities)
        run = rb.simulate(scene, 2.0, error=1e-9)
        assert run.engine == "closed form"
        assert run.error < 1e-13
        links = np.diff(np.eye(n), axis=0)
        pull = links.T @ links / masses[:, None]
        flow = np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness * pull, -damping * pull]])
        exact = (expm(2.0 * flow) @ np.concatenate([places, velocities]))[:n]
        worst = max(worst, max(abs(run[h].position(2.0)[0] - x) for h, x in zip(handles, exact, strict=True)))
    assert worst < 1e-13


def test_momentum_that_is_rounding_does_not_drift():
    """A body turned up about its centre of mass, which stays: its momentum is what rounding leaves of two."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    body = rb.RigidBody(1.0, [0.3, 0.33, 0.4], com=[0.1, 0.2, 0])
    handle = scene.add(body, rb.Planar([1, 0, 0], [0, 1, 0]))
    scene.apply(rb.Torque([0, 0, 0.1]), handle)
    run = rb.simulate(scene, 1.0, error=1e-9)
    assert {"momentum x", "momentum y"} <= set(run.drift)
    assert max(run.drift.values()) < 1e-13


@pytest.mark.parametrize(("pin", "rate"), [(0.02, 0.0), (0.0, 3.0)])
@pytest.mark.parametrize("k", [0.0, 0.5, 0.9])
def test_a_wheel_on_a_body_that_slides_on_feet_bears_no_moment(k, pin, rate):
    """A balanced wheel, held or turning evenly, on a box that slides: its moment is what rounding turns the box by."""
    slope, g = 0.3, 9.81
    scene = rb.Scene(gravity=[g * np.sin(slope), 0, -g * np.cos(slope)])
    box = scene.add(rb.shapes.box(2.0, [0.4, 0.3, 0.1]), position=[0, 0, 0.05], velocity=[1.0, 0, 0])
    for x, y in [(0.2, 0), (-0.2, 0.15), (-0.2, -0.15)]:
        rough = rb.Coulomb(k * np.tan(slope)) if k else None
        scene.contact(box.point([x, y, -0.05]), rb.Plane([0, 0, 1]), friction=rough)
    hinge = rb.Revolute([0, 1, 0], at=[0, 0, 0.1], friction=rb.Coulomb(0.1) if pin else None, pin_radius=pin)
    wheel = scene.add(rb.RigidBody(0.5, [0.01, 0.012, 0.01]), hinge, parent=box, rate=rate)
    run = rb.simulate(scene, 1.0, error=1e-9)
    assert run.error <= 1e-9
    way = 1.0 + 0.5 * g * (np.sin(slope) - k * np.tan(slope) * np.cos(slope))
    assert run[box].position(1.0)[0] == pytest.approx(way, rel=1e-12)
    assert abs(run[wheel].angle(1.0) - rate) < 1e-12
