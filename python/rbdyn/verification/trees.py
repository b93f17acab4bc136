"""Trees of bodies in space, and a chain whose masses differ by 1e12."""

from __future__ import annotations

from functools import partial

import numpy as np

from rbdyn._core import BodyHandle, Free, Revolute, RigidBody, Scene
from rbdyn.verification.case import Answer, Answers, Solve, case

Z = [0.0, 0.0, 1.0]

tree = partial(case, subject="Systems and mechanisms", row="double pendulum, chains, trees")


@tree("chain of five in space", hard="five axes, no two alike", source="reference l_chain5, 25 digits")
def chain(solve: Solve) -> Answers:
    """Hinge axes y, x, (0, 1, 1), x, y."""
    scene = Scene(gravity=[0, 0, -9.8125])
    axes = ([0, 1, 0], [1, 0, 0], [0, 1, 1], [1, 0, 0], [0, 1, 0])
    starts = ((1.0, 0.0), (0.5, 0.0), (-0.5, 1.0), (0.25, 0.0), (0.75, -1.0))
    links: list[BodyHandle] = []
    for k, (axis, (angle, rate)) in enumerate(zip(axes, starts, strict=True)):
        body = RigidBody(1 - k / 8, [0.0625, 0.0625, 0.03125], com=[0, 0, -0.25])
        joint = Revolute(axis, at=[0, 0, -0.5 if k else 0.0])
        links.append(scene.add(body, joint, parent=links[-1] if links else None, angle=angle, rate=rate))
    run = solve(scene, 1.0)
    known = [-0.25213848042613895876, -0.20275056079641187010, -1.0592351570442041534]
    known += [-0.19214572385147048986, 0.21218746028814745929]
    yield Answer("angles", [run[link].angle(1.0) for link in links], known, scale=1.0)
    size = float(np.max(np.linalg.norm(run[links[4]].reaction(np.linspace(0, 1, 201)), axis=1)))
    known = [-6.2688996532790821130, 3.8661539914355161327, 6.9087532301109870391]
    yield Answer("reaction of the last", run[links[4]].reaction(1.0), known, scale=size)


@tree("two bodies hinged in free space", hard="drift of momenta", source="reference l_free_pair, 25 digits")
def free_pair(solve: Solve) -> Answers:
    """Without weight."""
    scene = Scene()
    one = scene.add(
        RigidBody(2.0, [0.5, 0.75, 0.625], com=[0.125, 0, 0.25]),
        Free(),
        position=[0.25, -0.5, 0],
        attitude=[0.5, 0.5, -0.5, 0.5],
        velocity=[0.5, 0.25, -0.125],
        angular_velocity=[1, -0.5, 2],
    )
    other = scene.add(
        RigidBody(1.0, [0.25, 0.125, 0.3125], com=[0, 0.5, 0]),
        Revolute([2, -1, 2], at=[0.25, 0.5, 0], point=[0, -0.25, 0.125]),
        parent=one,
        angle=0.75,
        rate=-3.0,
    )
    run = solve(scene, 10.0)
    known = [2.4931836438677467692, 0.69912586046977213120, -4.8411973316878628480]
    yield Answer("place", run[one].position(10.0), known)
    yield Answer("angle between them", run[other].angle(10.0), 2.2124169498064916211)
    yield Answer("momentum", run.momentum(10.0), run.momentum(0.0))
    yield Answer("angular momentum", run.angular_momentum(10.0), run.angular_momentum(0.0))


@tree("two pendulums on a beam", hard="a tree with branches", source="reference l_branched, 25 digits")
def branched(solve: Solve) -> Answers:
    """The beam turns about the vertical."""
    scene = Scene(gravity=[0, 0, -9.8125])
    beam = scene.add(RigidBody(2.0, [0.125, 0.5, 0.5], com=[0.0625, 0, 0]), Revolute(Z), rate=1.5)
    left = scene.add(
        RigidBody(1.0, [0.125, 0.125, 0.0625], com=[0, 0, -0.5]),
        Revolute([1, 0, 0], at=[-0.75, 0, 0]),
        parent=beam,
        angle=1.0,
    )
    right = scene.add(
        RigidBody(0.5, [0.0625, 0.0625, 0.03125], com=[0, 0.125, -0.25]),
        Revolute([0, 1, 0], at=[1, 0, 0]),
        parent=beam,
        angle=-0.75,
        rate=0.5,
    )
    run = solve(scene, 10.0)
    yield Answer("angle of the beam", run[beam].angle(10.0), 17.150397363123679661)
    known = [-0.56398884982200690115, -0.65823505381929631477]
    yield Answer("angles on it", [run[left].angle(10.0), run[right].angle(10.0)], known, scale=1.0)


@case(
    "chain of masses 1e8, 1e4, 1, 1e-4",
    subject="Systems and mechanisms",
    row="mass ratio 1e8 along a chain",
    hard="reactions of the light end are lost in those of the heavy one",
    source="equations written apart, 20 digits",
    error=1e-9,
)
def heavy_to_light(solve: Solve) -> Answers:
    """A pendulum of four points on rods of 1 m; each reaction to 1e-9 of itself."""
    scene = Scene(gravity=[0, -9.8125, 0])
    points: list[BodyHandle] = []
    for mass, angle in zip((1e8, 1e4, 1.0, 1e-4), (0.75, -1.0, 0.75, 0.75), strict=True):
        joint = Revolute(Z, at=[0, -1, 0] if points else [0, 0, 0])
        parent = points[-1] if points else None
        points.append(scene.add(RigidBody(mass, [0, 0, 0], com=[0, -1, 0]), joint, parent=parent, angle=angle))
    run = solve(scene, 1.0)
    # of the rods, from straight down
    angles = np.cumsum([run[point].angle(1.0) for point in points])
    known = [-0.74478601741890813574, 0.20837903432247671729, 0.17556861883366119601, -1.3405991159961092769]
    yield Answer("angles", angles, known)
    forces = [
        [493714844.69518603620, 535538007.95236357013],
        [-22833.499064129074070, 107986.14051001990620],
        [-2.0642618235065066510, 11.636523015382434347],
        [0.00072369714492716009418, 0.00016959943508697730027],
    ]
    for k, (point, force) in enumerate(zip(points, forces, strict=True)):
        size = float(np.max(np.linalg.norm(run[point].reaction(np.linspace(0, 1, 201)), axis=1)))
        yield Answer(f"reaction {k + 1}", run[point].reaction(1.0)[:2], force, scale=size)
