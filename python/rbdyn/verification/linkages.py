"""Linkages of many bars, and linkages over many turns."""

from __future__ import annotations

import math
from functools import partial

from rbdyn._core import Ball, BodyHandle, ConstraintHandle, JointTorque, Revolute, RigidBody, Scene, Spring
from rbdyn.verification.case import STEPS, TAYLOR, Answer, Answers, Solve, case
from rbdyn.verification.mechanisms import point

Z = [0.0, 0.0, 1.0]

linkage = partial(case, subject="Systems and mechanisms")


def _bar(mass: float, x: float, y: float, moment: float) -> RigidBody:
    return RigidBody(mass, [moment, moment, moment], com=[x, y, 0])


def _hinge(x: float, y: float = 0.0) -> Revolute:
    return Revolute(Z, at=[x, y, 0])


@linkage(
    "Andrews' mechanism",
    row="stiff governor; Andrews' mechanism",
    hard="seven bodies and three loops in 0.03 s, from rest at a dead centre",
    source="reference m_andrews, 25 digits",
    holds=STEPS,
)
def andrews(solve: Solve) -> Answers:
    """The squeezing mechanism of the test set for initial value problems."""
    scene = Scene()
    k1 = scene.add(_bar(0.04325, 0.00092, 0, 2.194e-6), _hinge(0), angle=-0.061713890014276369814)
    k2 = scene.add(_bar(0.00365, -0.0115, 0, 4.41e-7), _hinge(0.007), parent=k1)
    k3 = scene.add(_bar(0.02373, 0.01043, -0.01874, 5.255e-6), _hinge(-0.03635, 0.03273), angle=0.45527981916307032815)
    k5 = scene.add(_bar(0.0705, 0.02308, 0.00916, 1.169e-5), _hinge(-0.06934, -0.00227), angle=0.48736497954384255942)
    k4 = scene.add(_bar(0.00706, 0, -0.00579, 5.667e-7), _hinge(0.04), parent=k5, angle=0.22266839016588570960)
    k7 = scene.add(_bar(0.05498, -0.00449, -0.01228, 1.912e-5), _hinge(-0.06934, -0.00227), angle=1.2305474445498211159)
    k6 = scene.add(_bar(0.00706, 0.00579, 0, 5.667e-7), _hinge(0, -0.04), parent=k7, angle=-0.22266839016588570960)
    pins = [
        scene.constrain(Ball(), point(k2, [-0.028, 0, 0]), point(body, place))
        for body, place in ((k3, [0, -0.035, 0]), (k4, [0, -0.02, 0]), (k6, [0.02, 0, 0]))
    ]
    scene.apply(JointTorque(0.033), k1)
    scene.connect(Spring(4530.0, rest_length=0.07785), k3.point([0.02, -0.018, 0]), [0.014, 0.072, 0])
    t = 0.03
    run = solve(scene, t, max_steps=2000)
    known = [15.810771195153708748, 0.040822240119645808436, 0.52440996587995403119, 1.0480807410419378362]
    yield Answer("angles", [run[body].angle(t) for body in (k1, k3, k5, k7)], known)
    known = [-15.756371058411841492, -0.53473011634207969200, 0.53473011634207969200]
    yield Answer("angles between bars", [run[body].angle(t) for body in (k2, k4, k6)], known)
    yield Answer("gaps", max(float(run[pin].gap(t)) for pin in pins), 0.0, scale=0.1)


# Jansen's proportions [m], his letters: a and l place the hinge of the leg, m is the crank
JANSEN = {
    **{"a": 0.38, "b": 0.415, "c": 0.393, "d": 0.401, "e": 0.558, "f": 0.394, "g": 0.367},
    **{"h": 0.657, "i": 0.49, "j": 0.5, "k": 0.619, "l": 0.078, "m": 0.15},
}


def _meet(one: complex, far: float, other: complex, near: float, side: int) -> complex:
    """Where bars of these lengths from two places meet, to the left (1) of the line between them or to the right."""
    between = other - one
    reach = abs(between)
    x = (far**2 - near**2 + reach**2) / (2 * reach)
    return one + between / reach * complex(x, side * math.sqrt(far**2 - x**2))


def walking_leg(rate: float) -> tuple[Scene, BodyHandle, list[ConstraintHandle]]:
    """A leg of Jansen's walking linkage: its crank, ten more bars of 1 kg/m, and the pins that close five loops."""
    size = JANSEN
    center, fixed, crank = 0j, complex(-size["a"], -size["l"]), complex(size["m"])
    top = _meet(crank, size["j"], fixed, size["b"], -1)
    low = _meet(crank, size["k"], fixed, size["c"], 1)
    left = _meet(top, size["e"], fixed, size["d"], -1)
    knee = _meet(left, size["f"], low, size["g"], -1)
    foot = _meet(knee, size["h"], low, size["i"], -1)
    scene, turns = Scene(), dict[str, float]()
    bars = dict[str, BodyHandle]()

    def add(name: str, start: complex, end: complex, parent: str = "", **how: float) -> None:
        length, along = size[name], end - start
        turns[name] = math.atan2(along.imag, along.real)
        angle = math.remainder(turns[name] - turns.get(parent, 0.0), 2 * math.pi)
        joint = _hinge(size[parent]) if parent else _hinge(start.real, start.imag)
        moment = length**3 / 12
        body = RigidBody(length, [0, moment, moment], com=[length / 2, 0, 0])
        before = bars[parent] if parent else None
        bars[name] = scene.add(body, joint, parent=before, angle=angle, name=name, **how)

    add("m", center, crank, rate=rate)
    add("j", crank, top, "m")
    add("k", crank, low, "m")
    for name, end in (("b", top), ("d", left), ("c", low)):
        add(name, fixed, end)
    add("e", top, left, "b")
    add("f", left, knee, "d")
    add("g", low, knee, "c")
    add("h", knee, foot, "g")
    add("i", low, foot, "c")
    ends = {name: point(bar, [size[name], 0, 0]) for name, bar in bars.items()}
    pairs = (("j", "b"), ("e", "d"), ("k", "c"), ("f", "g"), ("h", "i"))
    pins = [scene.constrain(Ball(), ends[one], ends[other]) for one, other in pairs]
    scene.assemble(keep=[bars["m"]])
    return scene, bars["m"], pins


# of its crank, let go with 2 pi rad/s where it points at +x: the integral of sqrt(T(angle)/T(0)) over a turn
WALKS = 1.4228462691879339036899921432


def _closed(solve: Solve, gap: float, turns: int) -> Answer:
    """That a gap is below 1e-10 m and what rounding leaves: three angles of so many turns, at arms of up to 2 m.

    CVODE moves no state onto constraints: there it is below what is asked for a length of 1 m.
    """
    scale = 1.0 if solve.engine.startswith("cvode") else 1e-10 / solve.error
    return Answer("gap", gap, 0.0, scale=scale, given=3 * 2.2e-16 * turns * math.tau / scale)


def walk(turns: int, solve: Solve, **options: object) -> Answers:
    """So many turns of its crank."""
    scene, crank, pins = walking_leg(2 * math.pi)
    t = turns * WALKS
    run = solve(scene, t, keep="end", **options)
    yield Answer("degrees of freedom", run.plan.freedom, 1, scale=0.0)
    # to the double nearest to t, and that of the angle
    given = 8e-16 * turns * math.tau
    yield Answer("crank turned by", run[crank].angle(t), turns * math.tau, scale=1.0, given=given)
    yield Answer("its rate", run[crank].rate(t), math.tau)
    yield _closed(solve, max(float(run[pin].gap(t)) for pin in pins), turns)


@linkage(
    "walking linkage",
    row="linkages over many turns; a walking linkage",
    hard="eleven bars, ten of them in five loops",
    source="period by quadrature, 28 digits",
    holds=STEPS,
)
def walking(solve: Solve) -> Answers:
    """A leg of Jansen's walking linkage, free of weight: after two turns of its crank all is as it was."""
    return walk(2, solve, max_steps=3000)


@linkage(
    "walking linkage for an hour",
    row="linkages over many turns; a walking linkage",
    hard="eleven bars that fall apart",
    source="period by quadrature, 28 digits",
    error=1e-6,
    quick=False,
    holds=TAYLOR,
)
def walking_on(solve: Solve) -> Answers:
    """2530 turns, with a local tolerance alone."""
    return walk(2530, solve, rtol=1e-13, max_steps=1_000_000 if solve.engine == "taylor" else 3000)


def flywheel_linkage(rate: float) -> tuple[Scene, BodyHandle, ConstraintHandle]:
    """A crank of 1/16 m on a flywheel, a coupler of 2 m and a rocker of 1.5 m; rods of 1 kg."""
    scene = Scene()
    size, coupler, rocker, ground = 0.0625, 2.0, 1.5, 2.0
    end = complex(size)
    meet = _meet(end, coupler, complex(ground), rocker, 1)
    rods = [RigidBody(1.0, [0, x**2 / 12, x**2 / 12], com=[x / 2, 0, 0]) for x in (coupler, rocker)]
    crank = scene.add(RigidBody(1.0, [10, 10, 10]), _hinge(0), rate=rate)
    along, down = meet - end, meet - ground
    joint = scene.add(rods[0], _hinge(size), parent=crank, angle=math.atan2(along.imag, along.real))
    swing = scene.add(rods[1], _hinge(ground), angle=math.atan2(down.imag, down.real))
    pin = scene.constrain(Ball(), point(joint, [coupler, 0, 0]), point(swing, [rocker, 0, 0]))
    scene.assemble(keep=[crank])
    return scene, crank, pin


# of the crank, as above
FLYWHEEL = 1.0000129451917917298722038283


@linkage(
    "four-bar linkage for 100,000 turns",
    row="linkages over many turns; a walking linkage",
    hard="constraints drift apart",
    source="period by quadrature, 28 digits",
    error=1e-5,
    quick=False,
    holds=TAYLOR,
)
def many_turns(solve: Solve) -> Answers:
    """A flywheel and a rocker, with a local tolerance alone; doubles of 6e5 rad are 1e-10 rad apart."""
    return turn(100_000, solve)


def turn(turns: int, solve: Solve) -> Answers:
    """So many turns of it."""
    scene, crank, pin = flywheel_linkage(2 * math.pi)
    t = turns * FLYWHEEL
    run = solve(scene, t, keep="end", rtol=1e-12, max_steps=1_000_000 if solve.engine == "taylor" else 3000)
    yield Answer("crank turned by", run[crank].angle(t), turns * math.tau, scale=1.0)
    yield Answer("energy", max(run.drift.values()), 0.0, scale=1e-5)
    yield _closed(solve, float(run[pin].gap(t)), turns)
