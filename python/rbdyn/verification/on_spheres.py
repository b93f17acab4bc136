"""A plate on a ball and an ellipsoid in a bowl, which roll to and fro in a plane: quadratures of 20 digits.

Both turn about where they touch, so that T = (m r^2 + I) w^2/2 with r from there to the centre of mass, and the height
has the rest of the energy: a quarter of the period is the integral of the angle over its rate. The plate touches R q
from its centre when it leans by q; of the ellipse as much arc has passed as of the bowl.
"""

from __future__ import annotations

import math
from functools import partial

from rbdyn._core import Coulomb, Free, RigidBody, Scene, Sphere
from rbdyn.verification.case import TAYLOR, Answer, Answers, Solve, case, says

G = 9.8125

on_spheres = partial(
    case,
    subject="Contact and events",
    row="discs and ellipsoids on spheres and in bowls",
    holds=TAYLOR,
    source="quadrature, 20 digits",
)


@on_spheres("plate balances on a ball", hard="where a flat face touches a ball moves with its lean")
def plate(solve: Solve) -> Answers:
    """Released at a lean of 1/4 rad it is level after a quarter of its period, and back after a whole one."""
    radius, lean, quarter = 0.75, 0.25, 0.10480992733924269983
    start = [
        radius * (math.sin(lean) - lean * math.cos(lean)),
        0,
        radius * (math.cos(lean) + lean * math.sin(lean)),
    ]
    scene = Scene(gravity=[0, 0, -G])
    plate = scene.add(
        RigidBody(1.0, [0.015625] * 3),
        Free(),
        position=start,
        attitude=[math.cos(lean / 2), 0, math.sin(lean / 2), 0],
    )
    touch = scene.contact(plate.disc(0.5, [0, 0, 1]), Sphere([0, 0, 0], radius), friction=Coulomb(10.0))
    run = solve(scene, 4 * quarter)
    yield Answer("level", run[plate].position(quarter), [0, 0, radius])
    yield Answer("rate", abs(run[plate].angular_velocity_world(quarter)[1]), 5.3832270670915913525)
    yield Answer("back", run[plate].position(4 * quarter), start)
    yield says(str(run[touch].state(quarter)), "sticks")


@on_spheres("ellipsoid rolls in a bowl", hard="where it touches is the zero of a function of degree six")
def ellipsoid(solve: Solve) -> Answers:
    """Released beside the bottom it is there after a quarter of its period, and back after a whole one."""
    quarter, turned = 0.17118428126910775020, -0.16598275251099284394
    start = [0.041198134807010937185, 0, -0.73716515587495937813]
    scene = Scene(gravity=[0, 0, -G])
    body = scene.add(
        RigidBody(2.0, [0.05, 0.0625, 0.055]),
        Free(),
        position=start,
        attitude=[math.cos(turned / 2), 0, -math.sin(turned / 2), 0],
    )
    bowl = Sphere([0, 0, 0], 1.0, inside=True)
    scene.contact(body.ellipsoid([0.375, 0.3125, 0.25]), bowl, friction=Coulomb(math.inf))
    run = solve(scene, 4 * quarter)
    yield Answer("bottom", run[body].position(quarter), [0, 0, -0.75])
    yield Answer("rate", run[body].angular_velocity_world(quarter), [0, -1.6391341322504706819, 0])
    yield Answer("back", run[body].position(4 * quarter), start)
