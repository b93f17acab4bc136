"""Which first integrals a scene is said to have, against sums over its motion."""

import numpy as np
import pytest
import rbdyn as rb


def spread(values):
    return np.ptp(np.asarray(values, float), axis=0)


def two_on_springs(centres, gravity=(0, 0, 0)):
    scene = rb.Scene(gravity=gravity)
    one = scene.add(rb.Particle(1.0), position=[0.3, -0.2, 0.5], velocity=[0.1, 0.7, -0.3])
    two = scene.add(rb.Particle(2.0), position=[-0.4, 0.6, 0.1], velocity=[0.2, -0.1, 0.4])
    scene.connect(rb.Spring(2.0, rest_length=0.1), one, two)
    for centre in centres:
        scene.connect(rb.Spring(3.0, rest_length=0.3), one, centre)
    return scene, [(one, 1.0), (two, 2.0)]


LINES = [
    ([[1, 1, 1], [2, 2, 2], [-1, -1, -1]], (0, 0, 0)),
    ([[0, 0, 0], [1, 2, 3]], (0, 0, 0)),
    ([[0.1, 0.2, 0.3], [1.1, 2.2, 3.3], [-0.7, -1.4, -2.1]], (0, 0, 0)),
    ([[0.3, 0.1, 0.2]], (1.0, -2.0, 0.5)),
    ([[0.3, 0.1, 0.2], [1.3, -1.9, 0.7]], (1.0, -2.0, 0.5)),
]


@pytest.mark.parametrize(("centres", "gravity"), LINES)
def test_about_a_line_through_all_centres_angular_momentum_stays(centres, gravity):
    scene, bodies = two_on_springs(centres, gravity)
    run = rb.simulate(scene, until=3.0, error=1e-10)
    assert set(run.drift) == {"energy", "axial angular momentum"}
    assert run.drift["axial angular momentum"] < 1e-9
    along = np.subtract(centres[1], centres[0]) if len(centres) > 1 else np.array(gravity)
    t = np.linspace(0, 3, 31)
    moment = sum(m * np.cross(run[b].position(t) - np.array(centres[0], float), run[b].velocity(t)) for b, m in bodies)
    assert spread(moment @ along / np.linalg.norm(along)) < 1e-9
    assert spread(moment).max() > 1e-2  # of all of it, none else


@pytest.mark.parametrize(
    ("centres", "gravity"),
    [([[0, 0, 0], [1, 2, 3], [1, 2, 3.0001]], (0, 0, 0)), ([[0, 0, 0], [1, 2, 3]], (0, 0, -1.0))],
)
def test_about_no_line_it_is_not_named(centres, gravity):
    scene, _ = two_on_springs(centres, gravity)
    assert set(rb.simulate(scene, until=0.5).drift) == {"energy"}


def test_along_a_smooth_plane_momentum_stays_through_bounces():
    for kind in "bounce", "on the plane":
        scene = rb.Scene(gravity=[0, 0, -9.81])
        a = scene.add(rb.Particle(1.0), position=[0.2, 0.1, 1.0], velocity=[1.0, 0.2, 0.0])
        b = scene.add(rb.Particle(0.5), position=[-0.2, 0.1, 1.5], velocity=[0.3, 0.1, 0.0])
        scene.connect(rb.Spring(5.0, rest_length=0.4), a, b)
        if kind == "bounce":
            for body in a, b:
                scene.contact(body, rb.Plane([0, 0, 1]), restitution=0.5)
        else:
            scene.constrain(rb.PointOnPlane(rb.Plane([0, 0, 1], [0, 0, 1.0])), a)
        run = rb.simulate(scene, until=1.0, error=1e-10)
        assert {"momentum x", "momentum y", "angular momentum z"} <= set(run.drift) and "momentum z" not in run.drift
        t = np.linspace(0, run.end, 41)
        momentum = 1.0 * run[a].velocity(t) + 0.5 * run[b].velocity(t)
        assert spread(momentum)[:2].max() < 1e-9 and spread(momentum)[2] > 0.1
        assert max(run.drift[n] for n in ("momentum x", "momentum y", "angular momentum z")) < 1e-9


def test_friction_on_the_plane_leaves_none():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    a = scene.add(rb.Particle(1.0), position=[0.2, 0.1, 1.0], velocity=[1.0, 0.2, 0.0])
    scene.contact(a, rb.Plane([0, 0, 1]), restitution=0.5, friction=rb.Coulomb(0.3))
    assert not run_names(scene)


def run_names(scene):
    return set(rb.simulate(scene, until=0.2).drift)


@pytest.mark.parametrize("axis", [[0, 0, 1], [1, 2, 2]])
def test_about_the_axis_of_a_circular_rail_angular_momentum_stays(axis):
    axis = np.array(axis, float) / np.linalg.norm(axis)
    start = np.cross(axis, [0.3, 1.0, 0.1])
    centre = np.array([0.5, -0.3, 0.2])
    scene = rb.Scene(gravity=(-9.81 * axis).tolist())
    circle = rb.Circle(1.0, start.tolist(), np.cross(axis, start).tolist(), centre.tolist())
    bead = scene.add(rb.Particle(1.0), rb.Rail(circle), parameter=0.4, speed=0.7)
    other = scene.add(rb.Particle(0.5), position=[0.1, 0.2, 0.9], velocity=[0.2, 0.1, 0.3])
    scene.connect(rb.Spring(4.0, rest_length=0.5), bead, other)
    run = rb.simulate(scene, until=2.0, error=1e-10)
    name = "angular momentum z" if axis[2] == 1.0 else "axial angular momentum"
    assert set(run.drift) == {"energy", name} and run.drift[name] < 1e-9
    t = np.linspace(0, 2, 31)
    moment = sum(m * np.cross(run[b].position(t) - centre, run[b].velocity(t)) for b, m in ((bead, 1.0), (other, 0.5)))
    assert spread(moment @ axis) < 1e-9 and spread(moment @ np.cross(axis, [1.0, 0.0, 0.3])) > 1e-3


def test_of_planar_and_cylindrical_joints_what_they_let_go_stays():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    body = scene.add(rb.RigidBody(2.0, [0.1, 0.2, 0.3]), rb.Planar([1, 0, 0], [0, 1, 0]), velocity=[0.3, 0.1], rate=0.5)
    scene.add(
        rb.RigidBody(1.0, [0.1] * 3),
        rb.Revolute([0, 0, 1], at=[0.2, 0, 0], point=[0, -0.3, 0], motion=np.sin),
        parent=body,
    )
    run = rb.simulate(scene, until=2.0, error=1e-10)
    assert set(run.drift) == {"momentum x", "momentum y", "angular momentum z"} and max(run.drift.values()) < 1e-9
    scene = rb.Scene(gravity=[0, 0, -9.81])
    shaft = scene.add(rb.RigidBody(2.0, [0.1, 0.2, 0.3], com=[0.1, 0, 0]), rb.Cylindrical([0, 0, 1]), rate=0.5)
    scene.add(rb.RigidBody(1.0, [0.1] * 3), rb.Prismatic([0, 0, 1], at=[0.2, 0, 0]), parent=shaft, rate=1.0)
    run = rb.simulate(scene, until=2.0, error=1e-10)
    assert set(run.drift) == {"energy", "angular momentum z"} and max(run.drift.values()) < 1e-9


def test_a_force_in_a_joint_is_one_from_outside_if_the_ground_bears_it():
    def slide(parent=None):
        return rb.Prismatic([1, 0, 0]), ({} if parent is None else {"parent": parent})

    scene = rb.Scene()
    car = scene.add(rb.RigidBody(1.0, [1, 1, 1]), slide()[0], displacement=0.3)
    scene.apply(rb.JointForce(lambda t, q, w: -q), car)
    assert not run_names(scene)
    scene = rb.Scene()
    car = scene.add(rb.RigidBody(1.0, [1, 1, 1]), slide()[0], displacement=0.3)
    joint, parent = slide(car)
    load = scene.add(rb.RigidBody(1.0, [1, 1, 1]), joint, displacement=0.2, **parent)
    scene.apply(rb.JointForce(lambda t, q, w: -q), load)
    run = rb.simulate(scene, until=2.0, error=1e-10)
    assert set(run.drift) == {"momentum x"} and run.drift["momentum x"] < 1e-9
