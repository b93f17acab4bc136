"""The shorter laws that a plan takes for single bodies, against the one mechanics of what is joined.

A scene whose bodies hang on the world has laws of its own for particles and for bodies on each joint; the same scene
with something welded to the world, on which the bodies hang, is a tree. Both are told to the same motion, with its
reactions.
RBDYN_TEST_LAWS: how many random scenes (24).
"""

import os

import numpy as np
import pytest
import rbdyn as rb

SCENES = int(os.environ.get("RBDYN_TEST_LAWS", "24"))
ERROR = 1e-11


def unit(random):
    v = random.normal(size=3)
    return v / np.linalg.norm(v)


def random_body(random):
    masses, places = random.uniform(0.2, 2.0, 5), random.uniform(-0.5, 0.5, (5, 3))
    return rb.shapes.points(masses, places)


def random_joint(random):
    """A joint, its start, and what the body on it is asked."""
    place = {"at": random.uniform(-1, 1, 3), "point": random.uniform(-0.3, 0.3, 3)}
    attitude, spin = rb.EulerAngles(*random.uniform(0.2, 2.8, 3)), random.uniform(-3, 3, 3)
    kind = random.integers(4)
    if kind == 0:
        start = {"position": random.uniform(-1, 1, 3), "velocity": random.uniform(-1, 1, 3)}
        return rb.Free(), start | {"attitude": attitude, "angular_velocity": spin}
    if kind == 1:
        return rb.Spherical(**place), {"attitude": attitude, "angular_velocity": spin}
    if kind == 2:
        return rb.Revolute(unit(random), **place), {"angle": random.uniform(-2, 2), "rate": random.uniform(-3, 3)}
    return rb.Prismatic(unit(random), **place), {
        "displacement": random.uniform(-0.5, 0.5),
        "rate": random.uniform(-1, 1),
    }


def loaded(scene, body, joint, random):
    """Some of all there is that acts on a body."""
    point = body.point(random.uniform(-0.4, 0.4, 3))
    if random.random() < 0.5:
        scene.apply(rb.Drag(linear=random.uniform(0.01, 0.3), quadratic=random.uniform(0.0, 0.2)), body)
    if random.random() < 0.5:
        c = random.uniform(-1, 1, 3)
        scene.apply(rb.Force(lambda t, r, v: np.sin(3 * t) * c - 0.1 * r), body, at=random.uniform(-0.3, 0.3, 3))
    if random.random() < 0.5 and not isinstance(joint, rb.Prismatic):
        k = random.uniform(-0.5, 0.5, 3)
        scene.apply(rb.Torque(lambda t, R, w: np.cos(2 * t) * k - 0.05 * w), body)
    if random.random() < 0.7:
        spring = rb.Spring(random.uniform(1, 20), rest_length=random.uniform(0.1, 0.6), damping=random.uniform(0, 0.5))
        scene.connect(spring, point, random.uniform(1.5, 2.5, 3))
    if isinstance(joint, rb.Revolute) and random.random() < 0.5:
        scene.apply(rb.TorsionSpring(random.uniform(0.5, 3), rest_angle=0.3, damping=random.uniform(0, 0.2)), body)


def told(seed, is_tree):
    random = np.random.default_rng(seed)
    scene = rb.Scene(gravity=random.uniform(-6, 6, 3))
    joined = {"parent": scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.1]), rb.Fixed())} if is_tree else {}
    bodies = []
    for _ in range(1 + random.integers(2)):
        joint, start = random_joint(random)
        body = scene.add(random_body(random), joint, **joined, **start)
        bodies.append((body, not isinstance(joint, rb.Free)))
        loaded(scene, body, joint, random)
    first = bodies[0][0]
    if len(bodies) == 2:
        scene.connect(rb.Spring(5.0, damping=0.2), first.point([0.2, 0.1, 0.0]), bodies[1][0].point([0, 0.3, 0.1]))
    scene.watch("level", lambda now: now[first].center_of_mass[2] - now[first].center_of_mass[0])
    return rb.simulate(scene, until=2.0, error=ERROR), bodies


QUANTITIES = (
    "position",
    "velocity",
    "acceleration",
    "rotation_matrix",
    "angular_velocity_world",
    "angular_acceleration",
    "reaction",
    "reaction_torque",
)


@pytest.mark.parametrize("seed", range(SCENES))
def test_a_body_on_the_world_moves_as_one_on_a_weld(seed):
    (special, bodies), (tree, twins) = told(seed, False), told(seed, True)
    times = np.linspace(0.0, 2.0, 9)
    for (body, is_held), (twin, _) in zip(bodies, twins, strict=True):
        for name in QUANTITIES if is_held else QUANTITIES[:-2]:
            ours, theirs = getattr(special[body], name)(times), getattr(tree[twin], name)(times)
            scale = np.abs(theirs).max()
            assert np.abs(ours - theirs).max() <= 30 * ERROR * max(scale, 1.0), (seed, name)
    for name in ("kinetic_energy", "potential_energy", "momentum", "power"):
        ours, theirs = (
            getattr(special, name)(times, of=[b for b, _ in bodies]),
            getattr(tree, name)(times, of=[b for b, _ in twins]),
        )
        assert np.abs(ours - theirs).max() <= 30 * ERROR * max(np.abs(theirs).max(), 1.0), (seed, name)
    assert [e.kind for e in special.events] == [e.kind for e in tree.events]
    for ours, theirs in zip(special.events, tree.events, strict=True):
        assert abs(ours.time - theirs.time) <= 2 * ERROR * theirs.time
