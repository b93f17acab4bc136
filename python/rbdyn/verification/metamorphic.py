"""Checks that need no answer: the same motion told in another way."""

from __future__ import annotations

from functools import partial

import numpy as np

from rbdyn._core import (
    Circle,
    Curve,
    Drag,
    Fixed,
    Force,
    Free,
    Particle,
    Potential,
    Rail,
    Revolute,
    RigidBody,
    Scene,
    Spring,
)
from rbdyn.verification.case import ALL, STEPS, Answer, Answers, Solve, case

same = partial(case, subject="Metamorphic checks", source="symmetry", holds=STEPS)

MOMENTS = [0.3, 0.4, 0.5]


@same("turned world", row="rotate or translate the world", hard="an axis that is special")
def turned(solve: Solve) -> Answers:
    """A heavy body on a spring, seen from axes that are turned and moved."""
    q, _ = np.linalg.qr(np.array([[1.0, 2, 3], [-2, 1, 0.5], [0.3, -1, 2]]))
    q *= np.linalg.det(q)
    places = []
    for turn, shift in ((np.eye(3), np.zeros(3)), (q, np.array([3.0, -5, 2]))):
        scene = Scene(gravity=turn @ [0, 0, -9.81])
        body = scene.add(
            RigidBody(1.1, MOMENTS),
            Free(),
            position=shift + turn @ [1.3, 0, 0],
            attitude=turn,
            angular_velocity=[0.5, 1.5, -0.25],
        )
        scene.connect(Spring(30.0, rest_length=0.5), body.point([0.1, 0.2, 0]), shift)
        places.append(turn.T @ (solve(scene, 2.0)[body].position(2.0) - shift))
    yield Answer("place", places[1], places[0])


@same("mirrored world", row="mirror the world", hard="a turn that is taken for its opposite")
def mirrored(solve: Solve) -> Answers:
    """A heavy body on a spring, and its image in a plane: places are mirrored, turns mirrored and reversed."""
    normal = np.array([2.0, -1.0, 2.0]) / 3
    image = np.eye(3) - 2 * np.outer(normal, normal)
    turn, _ = np.linalg.qr(np.array([[1.0, 2, 3], [-2, 1, 0.5], [0.3, -1, 2]]))
    turn *= np.linalg.det(turn)
    inertia = np.array([[0.3, 0.05, -0.02], [0.05, 0.4, 0.03], [-0.02, 0.03, 0.5]])
    ends = []
    for m in (np.eye(3), image):
        reverse = np.linalg.det(m)
        scene = Scene(gravity=m @ [0, 0, -9.81])
        body = scene.add(
            RigidBody(1.1, m @ inertia @ m.T),
            Free(),
            position=m @ [1.3, 0, 0],
            attitude=m @ turn @ m.T,
            velocity=m @ [0.25, 0.5, 0],
            angular_velocity=reverse * m @ [0.5, 1.5, -0.25],
        )
        scene.connect(Spring(30.0, rest_length=0.5), body.point(m @ [0.1, 0.2, 0]), np.zeros(3))
        run = solve(scene, 2.0)
        ends.append((m.T @ run[body].position(2.0), reverse * m.T @ run[body].angular_velocity(2.0)))
    yield Answer("place", ends[1][0], ends[0][0], given=solve.estimate or 0.0)
    yield Answer("angular velocity", ends[1][1], ends[0][1], given=solve.estimate or 0.0)


@same("bodies in another order", row="permute bodies", hard="depends on the order of writing")
def permuted(solve: Solve) -> Answers:
    """Three masses and springs, added in two orders."""
    starts = [([0, 0, 0], [0, 0.5, 0]), ([1, 0, 0.2], [0, 0, 0.3]), ([0.4, 1.1, 0], [0.2, 0, 0])]
    ends = []
    for order in ((0, 1, 2), (2, 0, 1)):
        scene = Scene()
        balls = {k: scene.add(Particle(1.0 + k), position=starts[k][0], velocity=starts[k][1]) for k in order}
        for a, b in ((0, 1), (1, 2), (0, 2)):
            scene.connect(Spring(3.0, rest_length=0.7), balls[a], balls[b])
        run = solve(scene, 3.0)
        ends.append([run[balls[k]].position(3.0) for k in range(3)])
    yield Answer("places", ends[1], ends[0])


@same("welded pieces", row="the same rigid body written as welded pieces", hard="a joint without freedom", holds=STEPS)
def welded(solve: Solve) -> Answers:
    """A pendulum of one body, and of two of them welded."""
    one, two = RigidBody(1.0, MOMENTS, com=[0, -0.5, 0]), RigidBody(2.0, [0.2, 0.25, 0.3], com=[0.1, -0.25, 0])
    angles = []
    for whole in (True, False):
        scene = Scene(gravity=[0, -9.81, 0])
        hinge = Revolute([0, 0, 1])
        if whole:
            swing = scene.add(one + two.shifted([0.25, -0.5, 0]), hinge, angle=2.0)
        else:
            swing = scene.add(one, hinge, angle=2.0)
            scene.add(two, Fixed(at=[0.25, -0.5, 0]), parent=swing)
        angles.append(solve(scene, 3.0)[swing].angle(3.0))
    yield Answer("angle", angles[1], angles[0], scale=1.0)


@same("there and back", row="time reversal", hard="energy lost in steps")
def reversed_(solve: Solve) -> Answers:
    """A ball on a spring, its velocity turned round halfway."""
    place, velocity = np.array([1.0, 0, 0]), np.array([0, 0.75, 0.5])
    for sign in (1.0, -1.0):
        scene = Scene(gravity=[0, 0, -9.81])
        ball = scene.add(Particle(1.0), position=place, velocity=sign * velocity)
        scene.connect(Spring(20.0, rest_length=0.5), ball, [0, 0, 0])
        run = solve(scene, 2.0)
        place, velocity = run[ball].position(2.0), sign * run[ball].velocity(2.0)
    # the way back begins with the error of the way there, which grows
    yield Answer("back at", place, [1.0, 0, 0], given=20 * (solve.estimate or 0.0))


@same("stop and go on", row="stop and restart in the middle", hard="a state that is not whole", holds=ALL)
def restarted(solve: Solve) -> Answers:
    """A top by one run, and by two."""
    ends = []
    for pieces in (1, 2):
        attitude = np.array([1.0, 0.1, 0.2, 0.3]) / np.linalg.norm([1.0, 0.1, 0.2, 0.3])
        omega = np.array([0.5, 1.5, -0.25])
        for _ in range(pieces):
            scene = Scene()
            body = scene.add(RigidBody(1.1, MOMENTS), Free(), attitude=attitude, angular_velocity=omega)
            run = solve(scene, 2.0 / pieces)
            attitude, omega = run[body].quaternion(run.end), run[body].angular_velocity(run.end)
        ends.append(omega)
    yield Answer("omega", ends[1], ends[0], given=10 * (solve.estimate or 0.0))


@same("an effect of zero", row="an effect with coefficient zero against none", hard="it is simulated all the same")
def zero(solve: Solve) -> Answers:
    """Drag with coefficients of zero changes no digit."""
    ends = []
    for has in (False, True):
        scene = Scene(gravity=[0, 0, -9.81])
        ball = scene.add(Particle(1.0), position=[1, 0, 0], velocity=[0, 0.75, 0.5])
        scene.connect(Spring(20.0, rest_length=0.5), ball, [0, 0, 0])
        if has:
            scene.apply(Drag(linear=0.0, quadratic=0.0), ball)
        ends.append(solve(scene, 2.0)[ball].position(2.0))
    yield Answer("place", ends[1], ends[0], scale=0.0)


@same("built in, and written in Python", row="C++ against Python", hard="two descriptions of one motion")
def written(solve: Solve) -> Answers:
    """A circle, drag and a spring of C++, and the same as functions of one's own."""
    ends = []
    for own in (False, True):
        scene = Scene(gravity=[0, 0, -9.81])
        if own:
            curve = Curve(lambda u: [0.5 * np.sin(u), 0.0 * u, -0.5 * np.cos(u)], domain=(-20, 20))
            bead = scene.add(Particle(0.5), Rail(curve), parameter=0.25, speed=4.0)
            scene.apply(Force(lambda t, r, v: -(0.05 + 0.02 * np.linalg.norm(v)) * v), bead)
            # a force is the gradient of its potential
            scene.apply(Potential(lambda r: -3.0 * (np.linalg.norm(r - np.array([0.75, 0.5, 0])) - 0.25) ** 2), bead)
        else:
            curve = Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0])
            bead = scene.add(Particle(0.5), Rail(curve), parameter=0.25, speed=4.0)
            scene.apply(Drag(linear=0.05, quadratic=0.02), bead)
            scene.connect(Spring(6.0, rest_length=0.25), bead, [0.75, 0.5, 0])
        run = solve(scene, 3.0)
        ends.append((run[bead].position(3.0), run[bead].reaction(3.0)))
    yield Answer("place", ends[1][0], ends[0][0], given=solve.estimate or 0.0)
    yield Answer("reaction", ends[1][1], ends[0][1], given=solve.estimate or 0.0)
