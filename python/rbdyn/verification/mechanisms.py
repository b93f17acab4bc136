"""Closed loops of bodies."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from rbdyn._core import Ball, BodyHandle, Hinge, Prismatic, Revolute, RigidBody, Scene, Spring, Torque, Universal
from rbdyn.verification.case import STEPS, Answer, Answers, Solve, case

Z = [0.0, 0.0, 1.0]

mechanism = partial(case, subject="Systems and mechanisms")


def _bar(mass: float, com: list[float], moment: float) -> RigidBody:
    return RigidBody(mass, [moment / 2, moment / 2, moment], com=com)


def _rod(along: list[float]) -> RigidBody:
    d = np.array(along, float)
    return RigidBody(1.0, (d @ d * np.eye(3) - np.outer(d, d)) / 12, com=d / 2)


def point(body: BodyHandle, place: Any) -> Any:
    """A point of a body, of a type that all who take one take."""
    return body.point(place)


@mechanism(
    "four-bar linkage",
    row="linkages over many turns; a walking linkage",
    hard="constraints drift apart",
    source="reference m_four_bar_gravity, 25 digits",
    holds=STEPS,
)
def four_bar(solve: Solve) -> Answers:
    """A crank-rocker under gravity; its loop stays closed to rounding."""
    scene = Scene(gravity=[0, -9.8125, 0])
    crank = scene.add(_bar(1.0, [0.375, 0, 0], 0.046875), Revolute(Z), angle=0.5, rate=3.0)
    coupler = scene.add(_bar(2.0, [1, 0.125, 0], 2 / 3), Revolute(Z, at=[0.75, 0, 0]), parent=crank, angle=0.1)
    rocker = scene.add(_bar(1.5, [0.75, 0, 0], 0.28125), Revolute(Z, at=[2, 0, 0]), angle=1.4)
    pin = scene.constrain(Ball(), point(coupler, [2, 0, 0]), point(rocker, [1.5, 0, 0]))
    scene.assemble(keep=[crank])
    run = solve(scene, 5.0)
    yield Answer("angle of the crank", run[crank].angle(5.0), -0.88688257197909755672, scale=1.0)
    size = float(np.max(np.linalg.norm(run[pin].force(np.linspace(0, 5, 201)), axis=1)))
    known = [-5.1243266508908306115, 0.50981062041562372571, 0]
    yield Answer("force of the pin", run[pin].force(5.0), known, scale=size)
    yield Answer("gap", float(np.max(run[pin].gap(run.t))), 0.0, scale=1.0)


@mechanism(
    "four-bar linkage for 1000 s",
    row="linkages over many turns; a walking linkage",
    hard="constraints drift apart",
    source="conservation",
    error=1e-6,
    quick=False,
    holds=("taylor",),
)
def four_bar_long(solve: Solve) -> Answers:
    """Energy and closure after a thousand seconds."""
    scene = Scene()
    crank = scene.add(_bar(1.0, [0.375, 0, 0], 0.046875), Revolute(Z), angle=0.5, rate=3.0)
    coupler = scene.add(_bar(2.0, [1, 0.125, 0], 2 / 3), Revolute(Z, at=[0.75, 0, 0]), parent=crank, angle=0.1)
    rocker = scene.add(_bar(1.5, [0.75, 0, 0], 0.28125), Revolute(Z, at=[2, 0, 0]), angle=1.4)
    pin = scene.constrain(Ball(), point(coupler, [2, 0, 0]), point(rocker, [1.5, 0, 0]))
    scene.assemble(keep=[crank])
    run = solve(scene, 1000.0, keep="end")
    yield Answer("gap", run[pin].gap(run.end), 0.0, scale=1.0)
    yield Answer("energy", max(run.drift.values()), 0.0, scale=1.0)


@mechanism(
    "Bricard's mechanism",
    row="Bricard's mechanism: 30 rows of rank 29",
    hard="a singular factorisation",
    source="reference m_bricard, 25 digits",
    holds=STEPS,
)
def bricard(solve: Solve) -> Answers:
    """Five rods, six hinges, one constraint too many."""
    points = np.array([[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]], float)
    axes = [[0, 1, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 0]]
    scene = Scene(gravity=[0, -9.81, 0])
    rods: list[BodyHandle] = []
    for k in range(1, 6):
        at = points[0] if k == 1 else points[k - 1] - points[k - 2]
        parent = rods[-1] if rods else None
        rods.append(scene.add(_rod(list(points[k] - points[k - 1])), Revolute(axes[k - 1], at=at), parent=parent))
    scene.constrain(Hinge(axes[5]), point(rods[-1], points[5] - points[4]), points[5])
    run = solve(scene, 2.0)
    known = [2.8955832920258424624, -0.19711514794155859699, 2.8955832920258424624]
    yield Answer("angles", [run[rod].angle(2.0) for rod in rods[:3]], known, scale=2.0)
    yield Answer("degrees of freedom", run.plan.freedom, 1, scale=0.0)


@mechanism(
    "two windows of four bars",
    row="N-four-bar through its flat position",
    hard="rows lose rank",
    source="reference m_n_four_bar, 25 digits",
    holds=STEPS,
)
def windows(solve: Solve) -> Answers:
    """Rods that stand, joined at their tops; before they lie in one line."""
    scene = Scene(gravity=[0, -9.81, 0])
    rods = [scene.add(_rod([0, 1, 0]), Revolute([0, 0, -1], at=[k, 0, 0]), rate=1.0) for k in range(3)]
    for k in range(2):
        coupler = scene.add(_rod([1, 0, 0]), Revolute(Z, at=[0, 1, 0]), parent=rods[k], rate=1.0)
        scene.constrain(Ball(), point(coupler, [1, 0, 0]), point(rods[k + 1], [0, 1, 0]))
    run = solve(scene, 0.5)
    yield Answer("angles", [run[rod].angle(0.5) for rod in rods], [0.76881862755520605760] * 3, scale=1.0)
    yield Answer("rate", run[rods[0]].rate(0.5), 2.7273084942770729473)


@mechanism(
    "parallelogram through flat",
    row="N-four-bar through its flat position",
    hard="a branch is left",
    error=1e-5,
    holds=STEPS,
)
def flat(solve: Solve) -> Answers:
    """It is flat at pi - 1 and goes on at the same rate."""
    scene = Scene()
    short, long = _bar(1.0, [0.5, 0, 0], 0.1), _bar(1.0, [1, 0, 0], 0.1)
    left = scene.add(short, Revolute(Z), angle=1.0, rate=1.0)
    top = scene.add(long, Revolute(Z, at=[1, 0, 0]), parent=left, angle=-1.0, rate=-1.0)
    right = scene.add(short, Revolute(Z, at=[2, 0, 0]), angle=1.0, rate=1.0)
    scene.constrain(Ball(), point(top, [2, 0, 0]), point(right, [1, 0, 0]))
    run = solve(scene, 5.0)
    yield Answer("is flat at", run.events.times("singular"), [math.pi - 1])
    yield Answer("angles", [run[left].angle(5.0), run[right].angle(5.0)], [6.0, 6.0])


@mechanism(
    "shafts joined by a cross",
    row="a massless cross in a universal joint",
    hard="a body without mass",
    source="reference m_cardan_shafts, 25 digits",
    holds=STEPS,
)
def cardan(solve: Solve) -> Answers:
    """A torque on one of two shafts."""
    scene = Scene()
    first, second = [1.0, 0, 0], [4.0, 3.0, 0]
    one = scene.add(RigidBody(1.0, [0.5, 0.5, 0.5]), Revolute(first), rate=2.0)
    two = scene.add(RigidBody(1.0, [0.25, 0.25, 0.25]), Revolute(second), rate=1.0)
    cross = Universal(Z, list(np.cross(Z, second)))
    scene.constrain(cross, point(one, [0, 0, 0]), point(two, [0, 0, 0]))
    scene.apply(Torque([0.75, 0, 0], frame="world"), one)
    scene.assemble(keep=[one])
    run = solve(scene, 0.5)
    yield Answer("angles", [run[one].angle(0.5), run[two].angle(0.5)], [1.0988678800949129802, 1.0029083112002317861])
    yield Answer("rates", [run[one].rate(0.5), run[two].rate(0.5)], [2.2959577053339827567, 2.5710627590948655597])


@mechanism(
    "stiff governor",
    row="stiff governor; Andrews' mechanism",
    hard="a spring of 8e5 N/m with a damper of 4e4",
    source="reference m_flyball_governor, 25 digits",
    error=1e-6,
    holds=STEPS,
)
def governor(solve: Solve) -> Answers:
    """A shaft, a slider, two rods with balls."""
    mass, ball, thin = 0.3, 5.0, 0.01
    along, across, cube = mass * thin**2 / 6, mass * (1 + thin**2) / 12, 3.0 * 0.1**2 / 6
    scene = Scene(gravity=[0, 0, -9.81])
    shaft = scene.add(RigidBody(mass, [across, across, along], com=[0, 0, 0.5]), Revolute(Z), rate=2 * math.pi)
    slider = scene.add(RigidBody(3.0, [cube, cube, cube]), Prismatic(Z), displacement=0.5, parent=shaft)
    rods = []
    for side in (1.0, -1.0):
        about = across + 0.25 * mass + ball
        com = [side * (0.5 * mass + ball) / (mass + ball), 0, 0]
        arm = RigidBody(mass + ball, [along, about, about], com=com, inertia_about="origin")
        joint = Revolute([0, side, 0], at=[side * 0.05, 0, 1])
        rods.append(scene.add(arm, joint, angle=math.radians(30), parent=shaft))
        spring = Spring(800000.0, rest_length=0.5, damping=40000.0)
        scene.connect(spring, slider.point([side * 0.05, 0, 0]), rods[-1].point([side * 0.5, 0, 0]))
    t = 0.125
    run = solve(scene, t)
    yield Answer("slider", run[slider].displacement(t), 0.53646985915241898154)
    yield Answer("rods", [run[rod].angle(t) for rod in rods], [0.48185411602893195159] * 2, scale=1.0)
    yield Answer("rate of the shaft", run[shaft].rate(t), 6.0164143141234267425)
