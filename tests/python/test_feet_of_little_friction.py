"""Boxes on feet of which some have far less friction than others: they stand where friction by hand says that they do.

Through one foot, at its height, a force along the plane is borne by it alone: it presses with part of the weight, for
the feet of little friction may have the rest, and holds up to mu W. Others hold what is left of a turning moment.
"""

import numpy as np
import pytest
import rbdyn as rb
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

WEIGHT = 9.81
FEET = np.array([[1, 1, -0.5], [-1, 1, -0.5], [-1, -1, -0.5], [1, -1, -0.5], [0.1, 0.2, -0.5]])


def scene_of(turned, friction, force, law):
    scene = rb.Scene(gravity=turned @ [0, 0, -WEIGHT])
    inertia = turned @ np.diag([0.3, 0.4, 0.5]) @ turned.T
    box = scene.add(rb.RigidBody(1.0, (inertia + inertia.T) / 2), position=turned @ [0, 0, 0.5])
    feet = [
        scene.contact(box.point(turned @ foot), rb.Plane(turned @ [0, 0, 1]), friction=rb.Coulomb(mu))
        for foot, mu in zip(FEET, friction, strict=True)
    ]
    f = turned @ force
    scene.apply(rb.Force(lambda t, x, v: [f[k] * law(t) for k in range(3)]), box, at=turned @ FEET[-1])
    return scene, box, feet


@pytest.mark.parametrize("little", [1e-6, 1e-4, 1e-2])
@pytest.mark.parametrize("much", [50.0, np.inf])
@pytest.mark.parametrize("seed", [None, 1, 2])
def test_one_foot_bears_the_friction_of_all(little, much, seed):
    """Straight lines in time along axes of the world mixed what a foot of little friction bears with its load: steps
    went by the root of the coefficient, and boxes slipped early that were turned."""
    turned = np.eye(3) if seed is None else Rotation.random(random_state=seed).as_matrix()
    scene, box, feet = scene_of(turned, [little] * 4 + [much], np.array([1.0, 0.3, 0]), lambda t: 20.0 * np.sin(t))
    run = rb.simulate(scene, 1.5, error=1e-9)
    assert len(run.events) == 0 and np.linalg.norm(run[box].velocity(1.5)) == 0.0
    assert run.statistics.steps < 500
    t = np.linspace(0, 1.5, 16)
    whole = np.zeros((16, 3))
    for foot, mu in zip(feet, [little] * 4 + [much], strict=True):
        force = run[foot].force(t) @ turned
        assert (force[:, 2] >= -1e-12).all()
        if np.isfinite(mu):
            assert (np.hypot(force[:, 0], force[:, 1]) <= mu * force[:, 2] + 1e-13).all()
        whole += force
    assert np.abs(whole - np.outer(20.0 * np.sin(t), [-1.0, -0.3, 0]) - [0, 0, WEIGHT]).max() < 1e-11


def holds_until(feet, friction, at, rate):
    """How long forces inside all cones balance a force that grows as rate t: a linear programme whose edges are added
    where a cone is left."""
    count = len(feet)
    balance = np.zeros((6, 3 * count + 1))
    for i, foot in enumerate(feet):
        for k, e in enumerate(np.eye(3)):
            balance[:, 3 * i + k] = [*e, *np.cross(foot, e)]
    balance[:, -1] = [*rate, *np.cross(at, rate)]
    edges = []

    def add(i, angle):
        edges.append(np.zeros(3 * count + 1))
        edges[-1][3 * i : 3 * i + 3] = [np.cos(angle), np.sin(angle), -friction[i]]

    finite = [i for i in range(count) if np.isfinite(friction[i])]
    for i in finite:
        for angle in np.linspace(0, 2 * np.pi, 12, endpoint=False):
            add(i, angle)
    bounds = [(0, None) if k % 3 == 2 else (None, None) for k in range(3 * count)] + [(0, None)]
    aim = np.zeros(3 * count + 1)
    aim[-1] = -1.0
    weight = [0, 0, WEIGHT, 0, 0, 0]
    tight = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    for _ in range(60):
        found = linprog(
            aim,
            A_ub=np.array(edges),
            b_ub=np.zeros(len(edges)),
            A_eq=balance,
            b_eq=weight,
            bounds=bounds,
            options=tight,
        ).x
        far = len(edges)
        for i in finite:
            x, y, z = found[3 * i : 3 * i + 3]
            if np.hypot(x, y) > friction[i] * z + 1e-11:
                add(i, np.arctan2(y, x))
        if len(edges) == far:
            break
    return found[-1]


@pytest.mark.parametrize("turned", [None, 1, 2])
@pytest.mark.parametrize(
    "friction",
    [
        [1e-6, 1e-6, 1e-6, 1e-6, 50.0],
        [np.inf, 1e-6, 1e-6, np.inf, 50.0],
        [1e-4, 0.3, 1e-6, 0.8, 1e-4],
        [0.3, 1e-6, 0.8],
    ],
)
def test_nothing_slips_while_forces_inside_all_cones_are_left(friction, turned):
    """The rounding of loads went into friction of little feet: slips were told up to 2e-2 of the time early."""
    judged = 0
    for seed in range(6):
        rng = np.random.default_rng(seed)
        angle = np.linspace(0, 2 * np.pi, len(friction), endpoint=False) + rng.uniform(0, 0.6, len(friction))
        feet = np.c_[rng.uniform(0.4, 1, len(friction)) * [np.cos(angle), np.sin(angle)]].T
        feet = np.c_[feet, np.full(len(friction), -0.5)]
        at, rate = rng.uniform(-0.3, 0.3, 3), rng.normal(size=3) * [1, 1, 0.3]
        end = holds_until(feet, friction, at, rate)
        if not 1e-6 < end < 1e3:
            continue
        judged += 1
        q = np.eye(3) if turned is None else Rotation.random(random_state=turned).as_matrix()
        scene = rb.Scene(gravity=q @ [0, 0, -WEIGHT])
        inertia = q @ np.diag([0.3, 0.4, 0.5]) @ q.T
        box = scene.add(rb.RigidBody(1.0, (inertia + inertia.T) / 2), position=q @ [0, 0, 0.5])
        for foot, mu in zip(feet, friction, strict=True):
            scene.contact(box.point(q @ foot), rb.Plane(q @ [0, 0, 1]), friction=rb.Coulomb(mu))
        f = q @ rate
        # not quite as t, which straight lines would follow
        scene.apply(rb.Force(lambda t, x, v, f=f: [f[k] * np.sinh(t) for k in range(3)]), box, at=q @ at)
        run = rb.simulate(scene, 0.9999 * np.arcsinh(end), error=1e-6)
        assert len(run.events) == 0 and np.linalg.norm(run[box].velocity(run.end)) == 0.0, seed
    assert judged >= 4
