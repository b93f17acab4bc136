"""Rigid bodies: rotation, tops, pendulums, and bodies that are none."""

from __future__ import annotations

import cmath
import math
from decimal import Decimal, localcontext
from functools import partial
from typing import Any

import numpy as np

from rbdyn import shapes
from rbdyn._core import EulerAngles, Free, Particle, Revolute, RigidBody, Scene, Spherical, System
from rbdyn.verification.case import ALL, Answer, Answers, Engine, Solve, case, says

G = 9.81

rotation = partial(case, subject="Rotation")

# those that know the state beside an unstable rotation to more than doubles leave
EXACT: tuple[Engine, ...] = ("closed form", "taylor")


def _flips(small: float, period: float, solve: Solve) -> Answers:
    scene = Scene()
    body = scene.add(RigidBody(1.0, [1, 2, 3]), Free(), angular_velocity=[small, 1, 0])
    scene.watch("flip", lambda now: now[body].angular_velocity[1])
    run = solve(scene, 2.2 * period)
    yield Answer("flips at", run.events.times("flip"), period * np.array([0.25, 0.75, 1.25, 1.75]))


@rotation(
    "flips, omega = (0.1, 1, 0)",
    row="flips about the intermediate axis",
    hard="noise decides the time of a flip",
    source="elliptic integral, 20 digits",
    holds=ALL,
)
def flips_of_a_tenth(solve: Solve) -> Answers:
    """Period of omega 25.510977876634716929."""
    return _flips(0.1, 25.510977876634716929, solve)


@rotation(
    "flips, omega = (1e-3, 1, 0)",
    row="flips about the intermediate axis",
    hard="noise decides the time of a flip",
    source="elliptic integral, 20 digits",
    holds=ALL,
)
def flips_of_a_thousandth(solve: Solve) -> Answers:
    """Period of omega 57.462848874962666871."""
    return _flips(1e-3, 57.462848874962666871, solve)


@rotation(
    "flips, omega = (1e-6, 1, 0)",
    row="near the separatrix",
    hard="1 - m underflows through k",
    source="elliptic integral, 20 digits",
    error=1e-8,
    holds=EXACT,
)
def flips_of_a_millionth(solve: Solve) -> Answers:
    """Period of omega 105.32119394639243715."""
    return _flips(1e-6, 105.32119394639243715, solve)


@rotation(
    "on the intermediate axis",
    row="exactly on the intermediate axis",
    hard="rounding seeds a flip",
    holds=ALL,
)
def intermediate(solve: Solve) -> Answers:
    """Exactly on it a body stays for ever."""
    scene = Scene()
    body = scene.add(
        RigidBody(1.0, [1, 2, 3]), Free(), attitude=EulerAngles(0.5, 0.25, 0.75), angular_velocity=[0, 1, 0]
    )
    run = solve(scene, 200.0)
    yield Answer("omega", run[body].angular_velocity(200.0), [0, 1, 0], scale=0.0)


@rotation(
    "a million turns about a stable axis",
    row="stable axes over 1e6 turns",
    hard="drift to another axis",
    holds=("closed form",),
)
def million_turns(solve: Solve) -> Answers:
    """Energy and angular momentum are those of the start."""
    until = 2e6 * math.pi
    for omega in ([1, 1e-3, 0], [1e-3, 0, 1]):
        scene = Scene()
        scene.add(RigidBody(1.0, [1, 2, 3]), Free(), angular_velocity=omega)
        run = solve(scene, until)
        for t in (until / 3, until):
            yield Answer("T", run.kinetic_energy(t), run.kinetic_energy(0.0))
            yield Answer("K", run.angular_momentum(t), run.angular_momentum(0.0))


@rotation("symmetric body", row="symmetric body; nearly equal moments; sphere", hard="0/0", holds=ALL)
def symmetric(solve: Solve) -> Answers:
    """omega turns about the axis at (C - A) omega3/A."""
    scene = Scene()
    body = scene.add(RigidBody(1.0, [1, 1, 1.5]), Free(), angular_velocity=[0.25, 0, 2])
    run, rate = solve(scene, 50.0), 0.5 * 2
    known = [0.25 * math.cos(50 * rate), 0.25 * math.sin(50 * rate), 2]
    yield Answer("omega", run[body].angular_velocity(50.0), known)


@rotation(
    "nearly equal moments", row="symmetric body; nearly equal moments; sphere", hard="false precession", holds=ALL
)
def nearly_equal(solve: Solve) -> Answers:
    """Moments 1, 1 + 1e-12, 1 + 2e-12: omega moves by 1e-10 in 100 s, a ball's not at all."""
    omega = np.array([0.5, 0.75, 1.0])
    scene = Scene()
    body = scene.add(RigidBody(1.0, [1, 1 + 1e-12, 1 + 2e-12]), Free(), angular_velocity=omega)
    ball = scene.add(RigidBody(1.0, [1, 1, 1]), Free(), angular_velocity=omega)
    run = solve(scene, 100.0)
    rate = np.array([-1e-12 * omega[1] * omega[2], 2e-12 * omega[0] * omega[2], -1e-12 * omega[0] * omega[1]])
    # moments near 1 are doubles 2e-16 apart
    yield Answer("omega", run[body].angular_velocity(100.0), omega + 100 * rate, given=1e-13)
    yield Answer("omega of a ball", run[ball].angular_velocity(100.0), omega)


@rotation("a moment of 1e-12", row="rod-like body, one moment 1e-12 or 0", hard="a singular spin", holds=ALL)
def thin(solve: Solve) -> Answers:
    """omega turns about the rod at (C - A) omega3/A, nearly -omega3."""
    scene = Scene()
    body = scene.add(RigidBody(1.0, [1, 1, 1e-12]), Free(), angular_velocity=[0.25, 0, 2])
    run, rate = solve(scene, 20.0), (1e-12 - 1) * 2
    known = [0.25 * math.cos(20 * rate), 0.25 * math.sin(20 * rate), 2]
    yield Answer("omega", run[body].angular_velocity(20.0), known)


@rotation(
    "a rod where its spin is free",
    row="rod-like body, one moment 1e-12 or 0",
    hard="a moment of zero",
    source="a rule",
    holds=(),
)
def rod(solve: Solve) -> Answers:
    """A thin rod that may spin about itself is refused by name."""

    def act() -> None:
        scene = Scene(gravity=[0, 0, -G])
        scene.add(shapes.rod(1.0, 1.0, along=[0, 0, 1]), Free(), name="needle")
        solve(scene, 1.0)

    yield says(solve.refusal(act), "needle")


@rotation(
    "bodies that are none", row="moments that violate rules", hard="silently unphysical", source="rules", holds=()
)
def impossible(solve: Solve) -> Answers:
    """Each is refused with the rule that it breaks."""
    yield says(solve.refusal(lambda: RigidBody(1.0, [1, 1, 3])), "triangle inequality", "3")
    yield says(solve.refusal(lambda: RigidBody(-1.0, [1, 1, 1])), "mass", "-1")
    yield says(solve.refusal(lambda: RigidBody(math.nan, [1, 1, 1])), "mass", "nan")
    yield says(solve.refusal(lambda: RigidBody(1.0, np.array([[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]))), "symmetric")
    yield says(solve.refusal(lambda: Particle(0.0)), "mass", "0")


@rotation(
    "Euler angles through 0 and pi", row="theta -> 0 and pi in Euler angles", hard="angle rates diverge", holds=ALL
)
def poles(solve: Solve) -> Answers:
    """A ball turned about its line of nodes: theta counts on, psi and phi stay."""
    scene = Scene()
    start = EulerAngles(0.5, 0.0, 0.25)
    body = scene.add(RigidBody(1.0, [1, 1, 1]), Free(), attitude=start, angular_velocity_world=[1, 0, 0])
    run = solve(scene, 10.0)
    yield Answer("theta, psi, phi", run[body].euler_angles(10.0), [10.5, 0.0, 0.25])


@rotation(
    "top with cusps",
    row="top with cusps",
    hard="a square root's singularity at each cusp",
    source="theta1, period and precession to 17 digits",
    holds=ALL,
)
def cusps(solve: Solve) -> Answers:
    """A = 1, C = 1.5, Mgl = 1, omega3 = 3, let go at 60 degrees."""
    scene = Scene(gravity=[0, 0, -8])
    top = scene.add(
        RigidBody(1.0, [1, 1, 1.5], com=[0, 0, 0.125], inertia_about="origin"),
        Spherical(),
        attitude=EulerAngles(math.pi / 3, 0.0, 0.0),
        angular_velocity=[0, 0, 3],
    )
    period = 1.4610376297378547
    run = solve(scene, 2 * period)
    low = run[top].euler_angles(0.5 * period)[0]
    yield Answer("theta1", low, math.radians(65.257837854397279), scale=1.0)
    yield Answer("precession", run[top].euler_angles(period)[1], 0.33168586628482653, scale=1.0)
    yield Answer("theta at a cusp", run[top].euler_angles(period)[0], math.pi / 3, scale=1.0)


@rotation("sleeping top", row="sleeping top at the threshold", hard="slow growth looks like stability", holds=ALL)
def sleeping(solve: Solve) -> Answers:
    """Upright it sleeps; beside it, below 49.5227 rad/s, it falls at a known rate."""
    a, c, m, length, spin, tilt = 0.002, 0.0008, 0.5, 0.04, 48.0, 1e-5
    body = RigidBody(m, [a, a, c], com=[0, 0, length], inertia_about="origin")
    scene = Scene(gravity=[0, 0, -G])
    top = scene.add(body, Spherical(), angular_velocity=[0, 0, spin])
    run = solve(scene, 10.0)
    yield Answer("asleep, the axis", run[top].rotation_matrix(10.0)[:, 2], [0, 0, 1], scale=0.0)
    scene = Scene(gravity=[0, 0, -G])
    top = scene.add(body, Spherical(), attitude=EulerAngles(tilt, 0.0, 0.0), angular_velocity=[0, 0, spin])
    # A z'' - i C omega z' - M g l z = 0 of the axis' projection
    root = cmath.sqrt(4 * a * m * G * length - (c * spin) ** 2)
    one, other = ((1j * c * spin + sign * root) / (2 * a) for sign in (1, -1))
    t = 0.5
    z = tilt * (other * cmath.exp(one * t) - one * cmath.exp(other * t)) / (other - one)
    axis = solve(scene, t)[top].rotation_matrix(t)[:, 2]
    # of terms of their square
    yield Answer("awake, its tilt", math.hypot(axis[0], axis[1]), abs(z), scale=1.0, given=10 * abs(z) ** 3)


@rotation(
    "Kovalevskaya's top",
    row="forced rigid body",
    hard="no closed form in common functions",
    source="reference d_kovalevskaya, 25 digits",
)
def kovalevskaya(solve: Solve) -> Answers:
    """omega after 5 s."""
    scene = Scene(gravity=[0, 0, -10])
    top = scene.add(
        RigidBody(1.0, [2, 2, 1], com=[0.25, 0, 0], inertia_about="origin"),
        Spherical(),
        attitude=EulerAngles(0.75, 0.25, 1.5),
        angular_velocity=[1, 0.5, 2],
    )
    known = [-0.1285968748329442701, -1.5904538711749802628, 2.80414171379479968724]
    yield Answer("omega", solve(scene, 5.0)[top].angular_velocity(5.0), known)


@rotation(
    "a rigid body forced in time",
    row="forced rigid body",
    hard="a yardstick of other libraries",
    source="series of 45 digits, 25 digits",
)
def forced(solve: Solve) -> Answers:
    """Euler's equations with the coefficients -2, 1.25, -0.5 and sin(t)^2/4 on the third."""
    system = System(
        lambda t, x: [-2 * x[1] * x[2], 1.25 * x[0] * x[2], -0.5 * x[0] * x[1] + 0.25 * np.sin(t) ** 2],
        [1.0, 0.0, 0.9],
    )
    run: Any = solve(system, 20.0)
    yield Answer("after 10 s", run.x(10.0), [-0.6688624229801340104, -0.5876984022040686022, 2.010777393073610821768])
    yield Answer("after 20 s", run.x(20.0), [-0.8337911612328247375, 0.4364575433604751425, 3.281619148536095776005])


def _period(angle: float) -> Decimal:
    """2 pi/(sqrt(g/L) agm(1, cos(angle/2))) of the doubles, L = 1, to 40 digits."""
    with localcontext() as context:
        context.prec = 60
        half = Decimal(angle) / 2
        term, cosine, k = Decimal(1), Decimal(0), 0
        while abs(term) > Decimal("1e-55"):
            cosine += term
            k += 2
            term *= -half * half / (k * (k - 1))
        a, b = Decimal(1), cosine
        while abs(a - b) > Decimal("1e-50"):
            a, b = (a + b) / 2, (a * b).sqrt()
        return 2 * Decimal("3.14159265358979323846264338327950288419716939937511") / (Decimal(G).sqrt() * a)


def _pendulum(turns: int, solve: Solve) -> Answers:
    # 0.05 rad, 90 and 179 degrees: 2.006380173531749, 2.367841947576237, 7.825796837537 s
    for angle in (0.05, math.pi / 2, math.radians(179)):
        scene = Scene(gravity=[0, 0, -G])
        swing = scene.add(RigidBody(1.0, [0, 0, 0], com=[0, 0, -1]), Revolute([0, 1, 0]), angle=angle)
        with localcontext() as context:
            context.prec = 60
            exact = (turns + Decimal("0.25")) * _period(angle)
            t = float(exact)
            late = float(Decimal(t) - exact)
        run, rate = solve(scene, t), math.sqrt(4 * G) * math.sin(angle / 2)
        # lowest at the exact time; the double nearest to it is late by a little
        yield Answer("angle at the lowest point", run[swing].angle(t), -rate * late, scale=angle)
        yield Answer("rate there", run[swing].rate(t), -rate)


@case(
    "a million periods of a pendulum",
    subject="Scale and length",
    row="1e6 periods of a pendulum",
    hard="an error of phase",
    source="arithmetic-geometric mean, 40 digits",
    holds=("closed form",),
)
def pendulum(solve: Solve) -> Answers:
    """L = 1, g = 9.81, from 0.05 rad, 90 and 179 degrees."""
    return _pendulum(1_000_000, solve)


@case(
    "a thousand periods of a pendulum",
    subject="Scale and length",
    row="1e6 periods of a pendulum",
    hard="an error of phase",
    source="arithmetic-geometric mean, 40 digits",
    error=1e-7,
    holds=EXACT,
    quick=False,
)
def pendulum_by_steps(solve: Solve) -> Answers:
    """The same by engines that step."""
    return _pendulum(1000, solve)
