"""Motions over very many periods: what is off then, what first integrals have drifted by, and what it takes.

    python long_runs.py [periods] [motion ...]

A million periods by default, or as many (a figure and zeros) as are done in LIMIT seconds. All are integrated by steps
of the series at a local tolerance of 1e-15, also where there is a closed form, which then tells the phase; a period of
the linkage is a quadrature. Phases are in radians, 2 pi a period. The series moves states to what is conserved and to
what closes loops after every step; how much there is to take away is seen from dop853, which holds nothing, in a
thousand periods at 1e-13.
"""

import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import rbdyn as rb
from rbdyn.verification.linkages import FLYWHEEL, flywheel_linkage

LIMIT = 180.0
G = 9.8125
Z = [0, 0, 1]
# periods are not whole: what tells the phase moves there
INTO = 0.3


@dataclass
class Motion:
    scene: rb.Scene
    period: float
    # of a run at its end: the phase error [rad], None if nothing tells it; and what else there is to say
    judged: Callable
    without_projection: bool = True


def beside_closed_form(scene, period, read):
    """What a run is late by beside the closed form, whose rate is that of its values 1e-5 periods to either side."""

    def judged(run):
        t, h = run.end, 1e-5 * period
        exact = rb.simulate(scene, t + h, engine="closed form", error=1e-9)
        rate = (read(exact, t + h) - read(exact, t - h)) / (2 * h)
        late = (read(run, t) - read(exact, t)) @ rate / (rate @ rate)
        return late * math.tau / period, ""

    return Motion(scene, period, judged)


def pendulum():
    """L = 1 m, g = 9.81 m/s^2, to 90 degrees."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    bob = scene.add(rb.RigidBody(1.0, [0, 0, 0], com=[0, 0, -1]), rb.Revolute([0, 1, 0]), angle=math.pi / 2)
    return beside_closed_form(scene, 2.3678419475762374, lambda run, t: np.array([run[bob].angle(t)]))


def free_body():
    """Moments 1, 2, 3, omega = (0.1, 1, 0): two flips a period."""
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, [1, 2, 3]), rb.Free(), angular_velocity=[0.1, 1, 0])
    return beside_closed_form(scene, 25.510977876634716929, lambda run, t: run[body].angular_velocity(t))


def symmetric_top():
    """That with cusps of the list of hard cases; phase of the nutation."""
    scene = rb.Scene(gravity=[0, 0, -8])
    body = rb.RigidBody(1.0, [1, 1, 1.5], com=[0, 0, 0.125], inertia_about="origin")
    start = rb.EulerAngles(math.pi / 3, 0, 0)
    top = scene.add(body, rb.Spherical(), attitude=start, angular_velocity=[0, 0, 3])
    return beside_closed_form(scene, 1.4610376297378547, lambda run, t: run[top].rotation_matrix(t)[2:, 2])


def spring():
    """An ellipse about the anchor, omega = 2 rad/s."""
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[0, 0.5, 0])
    scene.connect(rb.Spring(4.0), ball, [0, 0, 0])
    return beside_closed_form(scene, math.pi, lambda run, t: run[ball].position(t))


def double_pendulum():
    """Two compound bodies that go over the top, without order; a period is 2 s, about a swing of the upper one."""
    scene = rb.Scene(gravity=[0, -G, 0])
    upper = scene.add(
        rb.RigidBody(2.0, [0.25, 0.25, 0.5], com=[0.125, -0.5, 0]), rb.Revolute(Z, at=[0.25, 1, 0]), angle=1.5, rate=0.5
    )
    scene.add(
        rb.RigidBody(1.25, [0.125, 0.125, 0.1875], com=[0.0625, -0.375, 0]),
        rb.Revolute(Z, at=[0.125, -1, 0], point=[0, 0.125, 0]),
        parent=upper,
        angle=-0.75,
        rate=2.0,
    )
    return Motion(scene, 2.0, lambda run: (None, ""))


def four_bar():
    """A crank of 1/16 m on a flywheel, a coupler and a rocker."""
    scene, crank, pin = flywheel_linkage(2 * math.pi)

    def judged(run):
        # between whole turns the crank is not even: there it is known from a short run
        left = math.fmod(run.end, FLYWHEEL)
        short = rb.simulate(scene, left, error=1e-12)
        turned = round((run.end - left) / FLYWHEEL) * math.tau
        return run[crank].angle(run.end) - turned - short[crank].angle(left), f"gap {run[pin].gap(run.end):.1e} m"

    return Motion(scene, FLYWHEEL, judged)


def rolling_disc():
    """Tilted by 0.5 rad, its centre at rest: round at sqrt(4 g/(r sin a)) for ever."""
    r, tilt = 0.25, 0.5
    around = math.sqrt(4 * G / (r * math.sin(tilt)))
    scene = rb.Scene(gravity=[0, 0, -G])
    disc = scene.add(
        rb.shapes.disc(2.0, r, Z),
        rb.Free(),
        position=[0, 0, r * math.sin(tilt)],
        attitude=[math.cos(tilt / 2), math.sin(tilt / 2), 0, 0],
        angular_velocity=[0, around * math.sin(tilt), 0],
    )
    scene.contact(disc.disc(r, Z), rb.Plane(Z), friction=rb.Coulomb(10.0))
    start = rb.simulate(scene, 1e-3).energy(0.0)

    def judged(run):
        t = run.end
        axis = run[disc].rotation_matrix(t)[:, 2]
        turned = around * math.fmod(t, math.tau / around)
        off = math.remainder(math.atan2(axis[0], -axis[1]) - turned, math.tau)
        energy = abs(run.energy(t) / start - 1)
        moved = np.linalg.norm(run[disc].position(t)[:2])
        return off, f"energy {energy:.1e}, tilt {abs(math.acos(axis[2]) - tilt):.1e} rad, centre {moved:.1e} m"

    return Motion(scene, math.tau / around, judged, without_projection=False)


MOTIONS = {
    "pendulum": pendulum,
    "free body": free_body,
    "symmetric top": symmetric_top,
    "spring": spring,
    "double pendulum": double_pendulum,
    "four-bar linkage": four_bar,
    "rolling disc": rolling_disc,
}


def after(motion, periods, engine="taylor", rtol=1e-15):
    """The end of a run of so many periods and INTO one, and its seconds."""
    began = time.perf_counter()
    run = rb.simulate(motion.scene, (periods + INTO) * motion.period, engine=engine, rtol=rtol, keep="end")
    return run, time.perf_counter() - began


def as_many(motion, periods, limit):
    """How many periods are done within the limit [s], as one figure and zeros; all, if they are."""
    few = max(1, min(periods, 300))
    # the first run plans and makes machine code
    after(motion, few)
    most = limit / after(motion, few)[1] * few
    if most >= periods:
        return periods
    size = 10 ** int(math.log10(most))
    return int(most // size * size)


def worst(drift):
    """The first integral that has drifted the most."""
    return max(((value, name) for name, value in drift.items()), default=(math.nan, ""))


def measured(name, periods=1_000_000, limit=LIMIT):
    """The figures of a motion, by what they are."""
    motion = MOTIONS[name]()
    count = as_many(motion, periods, limit)
    run, seconds = after(motion, count)
    phase, more = motion.judged(run)
    found = {"periods": count, "steps": run.statistics.steps, "phase": phase, "seconds": seconds, "more": more}
    found["drift"], found["integral"] = worst(run.drift)
    if motion.without_projection:
        found["unheld"] = worst(after(motion, min(count, 1000), "dop853", 1e-13)[0].drift)[0]
    return found


def line(name, found):
    """A row of the table."""

    def shown(key):
        value = found.get(key)
        return "-" if value is None or math.isnan(value) else f"{abs(value):.1e}"

    drift = f"{shown('drift')} {found['integral']}".strip()
    cells = [name, f"{found['periods']:,}", f"{found['steps']:,}", shown("phase"), drift, shown("unheld")]
    return "| " + " | ".join([*cells, found["more"] or "-", f"{found['seconds']:.0f}"]) + " |"


def main():
    words = sys.argv[1:]
    periods = int(float(words.pop(0))) if words and words[0][0].isdigit() else 1_000_000
    print("| motion | periods | steps | phase [rad] | drift | of dop853, 1000 periods | else | time [s] |")
    print("|---|---|---|---|---|---|---|---|")
    for name in words or MOTIONS:
        print(line(name, measured(name, periods)), flush=True)


if __name__ == "__main__":
    main()
