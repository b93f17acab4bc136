"""Events: several in one step, grazing, at the ends, after long runs, and functions that are no number."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from rbdyn._core import BodyHandle, Force, Line, Now, Particle, Rail, Scene, System, SystemNow
from rbdyn.verification.case import STEPS, Answer, Answers, Solve, case, says

G = 9.8125

event = partial(case, subject="Contact and events", holds=STEPS)


@event("three roots in one step", row="several roots in one step", hard="two of three are missed")
def several(solve: Solve) -> Answers:
    """-(t + 6)(t + 2)(t - 2), from t = -8."""
    clock = System(lambda t, x: [-((t + 2) * (t - 2) + (t + 6) * (t - 2) + (t + 6) * (t + 2))], [120.0])
    clock.watch("root", lambda now: now[0])
    run = solve(clock, 5.0, start=-8.0)
    yield Answer("roots", run.events.times("root"), [-6.0, -2.0, 2.0], scale=13.0)


def above(ball: BodyHandle, level: float) -> Callable[[Now], Any]:
    """How far a ball is above a level."""
    return lambda now: now[ball].position[2] - level


def after(time: float) -> Callable[[SystemNow], Any]:
    """What is past of a time."""
    return lambda now: now[0] - time


@event("grazing", row="grazing, 1e-12 either side", hard="a double root is missed or counted twice")
def grazing(solve: Solve) -> Answers:
    """A ball thrown to 1e-12 above a level, and to 1e-12 below."""
    speed = math.sqrt(2 * G)
    for off in (1e-12, -1e-12):
        scene = Scene(gravity=[0, 0, -G])
        ball = scene.add(Particle(1.0), velocity=[0, 0, speed])
        level = speed * speed / (2 * G) - off
        scene.watch("level", above(ball, level))
        run = solve(scene, 2 * speed / G)
        top, apart = speed / G, math.sqrt(2 * 1e-12 / G)
        known = [top - apart, top + apart] if off > 0 else []
        # a height known to rounding gives a time to its quotient by the slope
        yield Answer("times", run.events.times("level"), known, scale=top, given=1e-9)


@event("an event at both ends", row="event at t0, exactly at the end, at a saved time", hard="lost, or doubled")
def ends(solve: Solve) -> Answers:
    """Of (t0, t1] the end counts, the start does not."""
    clock = System(lambda t, x: [1.0 + 0.0 * x[0]], [0.0])
    clock.watch("start", lambda now: now[0])
    clock.watch("middle", lambda now: now[0] - 0.5)
    clock.watch("end", lambda now: now[0] - 1.0)
    run = solve(clock, 1.0, keep=[0.0, 0.5, 1.0])
    yield Answer("start", run.events.times("start"), [])
    yield Answer("middle", run.events.times("middle"), [0.5])
    yield Answer("end", run.events.times("end"), [1.0])


@event(
    "time events 1e-8 apart", row="event after a reset; time events 1e-8 apart", hard="an endless loop, a lost order"
)
def close_together(solve: Solve) -> Answers:
    """Five of them, in order, after 1e6 s."""
    clock = System(lambda t, x: [1.0 + 0.0 * x[0]], [0.0])
    for k in range(1, 6):
        clock.watch(f"tick {k}", after(1e6 + 1e-8 * k))
    run = solve(clock, 1e6 + 1.0)
    ticks = [int(one.name[-1]) for one in run.events]
    yield Answer("order", ticks, [1, 2, 3, 4, 5], scale=0.0)
    yield Answer("times", [one.time for one in run.events], 1e6 + 1e-8 * np.arange(1, 6))


@event("a watch that resets what it watches", row="event after a reset; time events 1e-8 apart", hard="an endless loop")
def saw(solve: Solve) -> Answers:
    """x' = 1 back to zero each time that it is 1: a hundred times."""
    tooth = System(lambda t, x: [1.0 + 0.0 * x[0]], [0.0])
    tooth.watch("full", lambda now: now[0] - 1.0, action=lambda now: [0.0])
    run: Any = solve(tooth, 100.5)
    yield Answer("times", run.events.times("full"), np.arange(1.0, 101.0))
    yield Answer("end", run.x(100.5)[0], 0.5, scale=1.0)


@event("an event in the first of a million seconds", row="long steps: until = 1e6 s", hard="zero measured by the step")
def long_step(solve: Solve) -> Answers:
    """A polynomial motion is one step, as long as the run."""
    scene = Scene(gravity=[0, 0, -G])
    ball = scene.add(Particle(1.0), position=[0, 0, 1e-3])
    scene.watch("floor", lambda now: now[ball].position[2])
    run = solve(scene, 1e6)
    yield Answer("passes at", run.events.times("floor"), [math.sqrt(2e-3 / G)])


@event("a guard that is no number at first", row="a guard that is NaN where a step begins", hard="skipped silently")
def root(solve: Solve) -> Answers:
    """sqrt(t - 0) at t = 0, its zero less a quarter found at 1/16; a guard that stays no number is named."""
    scene = Scene()
    ball = scene.add(Particle(1.0), velocity=[1, 0, 0])
    scene.watch("quarter", lambda now: np.sqrt(now[ball].position[0]) - 0.25)
    run = solve(scene, 1.0)
    yield Answer("found at", run.events.times("quarter"), [0.0625])


@event("a guard 1e-13 from its zero", row="a guard 1e-13 from its zero at the start", hard="both are lost")
def near(solve: Solve) -> Answers:
    """One passes zero in the first 1e-13 s, one exactly at the end beside another."""
    clock = System(lambda t, x: [1.0 + 0.0 * x[0]], [0.0])
    clock.watch("first", lambda now: now[0] - 1e-13)
    clock.watch("last", lambda now: now[0] - 2.0)
    clock.watch("beside", lambda now: now[0] - (2.0 - 1e-12))
    run = solve(clock, 2.0)
    yield Answer("first", run.events.times("first"), [1e-13], scale=1.0)
    yield Answer("last", run.events.times("last"), [2.0])
    yield Answer("beside", run.events.times("beside"), [2.0 - 1e-12])


@event("a force that is no number", row="NaN from a user's guard or force", hard="it hangs")
def not_a_number(solve: Solve) -> Answers:
    """The run ends where the force does, by name, and keeps what it had."""
    scene = Scene()
    bead = scene.add(Particle(1.0), Rail(Line([1, 0, 0])), parameter=0.0, speed=1.0, name="bead")
    scene.apply(Force(lambda t, r, v: [np.sqrt(1.0 - t), 0.0, 0.0]), bead)
    run, why = solve.ending(scene, 2.0)
    yield Answer("ends at", run.end, 1.0, given=1e-6)
    yield says(f"{run.status}: {why}", "not finite")


@event("a pole of the equations", row="NaN from a user's guard or force", hard="steps shrink for ever")
def pole(solve: Solve) -> Answers:
    """x' = x^2 from 1 has no solution beyond t = 1, and none beyond 1e-15 from 1e15."""
    for start in (1.0, 1e15):
        blows = System(lambda t, x: [x[0] * x[0]], [start])
        run, why = solve.ending(blows, 2.0)
        yield Answer("ends at", run.end * start, 1.0, given=1e-3)
        yield says(f"{run.status}: {why}", "not finite")
