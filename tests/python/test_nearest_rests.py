"""The state of rest nearest to given coordinates, where all there are is known."""

import math

import numpy as np
import pytest
import rbdyn as rb

ROD = rb.shapes.rod(1.0, 1.0, [0, 0, 1])


def double_pendulum():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    upper = scene.add(ROD, rb.Revolute([0, 1, 0], point=[0, 0, 0.5]), angle=0.3)
    scene.add(ROD, rb.Revolute([0, 1, 0], at=[0, 0, -0.5], point=[0, 0, 0.5]), parent=upper)
    return scene


def two_hinges():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    for k in range(2):
        scene.add(ROD, rb.Revolute([0, 1, 0], at=[3.0 * k, 0, 0], point=[0, 0, 0.5]), angle=0.3)
    return scene


@pytest.mark.parametrize("make", [double_pendulum, two_hinges])
def test_pendulums_rest_at_the_nearest_half_turns(make):
    random = np.random.default_rng(5)
    scene = make()
    for near in random.uniform(-3.1, 3.1, (60, 2)):
        (state,) = rb.equilibria(scene, near=near)
        assert state.coordinates == pytest.approx(math.pi * np.round(near / math.pi), abs=1e-12)


def test_a_rest_is_told_by_the_turns_of_near_unless_a_spring_counts_them():
    scene = double_pendulum()
    (state,) = rb.equilibria(scene, near=[4 * math.pi + 0.1, -2 * math.pi - 0.2])
    assert state.coordinates == pytest.approx([4 * math.pi, -2 * math.pi], abs=1e-12)
    wound = rb.Scene()
    for k in range(2):
        wheel = wound.add(ROD, rb.Revolute([0, 1, 0], at=[3.0 * k, 0, 0]), angle=0.3)
        wound.apply(rb.TorsionSpring(2.0, rest_angle=0.5), wheel)
    (state,) = rb.equilibria(wound, near=[0.5 + 4 * math.pi, 0.4])
    assert state.coordinates == pytest.approx([0.5, 0.5], abs=1e-12)


def test_a_slow_damped_motion_does_not_go_round():
    # beads on both sides of a hoop, a spring between: they slide down, and no further than that
    scene = rb.Scene(gravity=[0, 0, -9.81])
    circle = rb.Circle(radius=1.0, start=[0, 0, -1], toward=[1, 0, 0])
    one = scene.add(rb.Particle(1.0), rb.Rail(circle, side="+", up=[0, 0, 1]), parameter=0.5)
    two = scene.add(rb.Particle(1.0), rb.Rail(circle, side="-", up=[0, 0, 1]), parameter=3.0)
    scene.connect(rb.Spring(2.0, rest_length=1.0), one, two)
    (state,) = rb.equilibria(scene)
    assert state.stable and np.abs(state.coordinates).max() < math.pi


def test_no_farther_rest_is_given_than_one_that_is_known():
    random = np.random.default_rng(7)
    for _ in range(30):
        scene = rb.Scene(gravity=random.normal(size=3) * 5)
        body = None
        for _ in range(3):
            solid = rb.RigidBody(1.0, random.uniform(0.2, 0.35, 3), com=random.uniform(-0.6, 0.6, 3))
            joint = rb.Revolute(random.normal(size=3), at=random.uniform(-0.5, 0.5, 3))
            body = scene.add(solid, joint, **({} if body is None else {"parent": body}))
        (known,) = rb.equilibria(scene)
        near = known.coordinates + random.uniform(-1.5, 1.5, 3)
        (state,) = rb.equilibria(scene, near=near)
        assert np.linalg.norm(state.coordinates - near) <= np.linalg.norm(known.coordinates - near) * (1 + 1e-9)
