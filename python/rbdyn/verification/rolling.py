"""Bodies that roll and slide on a table: tippe top, rattleback, Euler's disk.

The numbers of 20 digits are from Newton's and Euler's laws written down apart from the library and integrated by
extrapolation in 32 digits; tests/python/test_verification.py makes the earlier ones anew, to the digits of SciPy.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from rbdyn import shapes
from rbdyn._core import BodyHandle, Coulomb, Free, Plane, RigidBody, Scene, Trajectory
from rbdyn.verification.case import TAYLOR, Answer, Answers, Solve, case, kinds, says

G = 9.8125
TABLE = Plane([0, 0, 1])
ROW = "tippe top, rattleback, Euler's disk"

rolling = partial(case, subject="Contact and events", row=ROW, holds=TAYLOR)


def tilted(cosine: float, sine: float) -> np.ndarray:
    """An attitude, turned about the x axis."""
    return np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])


# after [s], an axis of the body and its angular velocity, in the world
RATTLES = (
    (2.0, [1.10356751647502696750, -1.10403041511423026616, 0.726698718533711953633]),
    (5.0, [0.00274073397452096484880, 0.00336231001490571566368, 3.00000603555631362222]),
)
TURNS_OVER = (
    (
        1.0,
        [-0.404914439648521836141, -0.827218365695119814819, 0.389556250137022687699],
        [4.34187193166725642054, 7.08542968881838498139, 190.629707074914512968],
    ),
    (
        3.0,
        [0.424998819560475556798, 0.0567338913466722292972, -0.903414228881118702292],
        [-1.16525996800203357564, 0.156055997597692086709, 152.980567797658572448],
    ),
)
FALLING = (
    (
        0.25,
        [0.0579280256039172052343, 0.0138871781526567888270, 0.998224168277140184714],
        [-7.87478730605498293241, -2.89592427197105719035, -0.650477847179602568582],
    ),
    (
        0.4,
        [-0.00334397859897720508982, 0.00375686064397540340251, 0.999987351822627470159],
        [1.79629427431121810453, -1.76332261764522117581, -1.25520457091554173306],
    ),
)


@rolling(
    "rolling in a steady circle",
    hard="a disc that rolls on its edge",
)
def euler_disk(solve: Solve) -> Answers:
    """With its centre at rest a thin disc tilted by a goes round at omega^2 = 4 g/(r sin a)."""
    r, tilt = 0.25, 0.5
    around = math.sqrt(4 * G / (r * math.sin(tilt)))
    scene = Scene(gravity=[0, 0, -G])
    # tilted about x; the lowest point is along -y of the body, omega along that diameter
    attitude = [math.cos(tilt / 2), math.sin(tilt / 2), 0, 0]
    disc = scene.add(
        shapes.disc(2.0, r, [0, 0, 1]),
        Free(),
        position=[0, 0, r * math.sin(tilt)],
        attitude=attitude,
        angular_velocity=[0, around * math.sin(tilt), 0],
    )
    scene.contact(disc.disc(r, [0, 0, 1]), TABLE, friction=Coulomb(10.0))
    t = 0.5
    run = solve(scene, t)
    axis = run[disc].rotation_matrix(t)[:, 2]
    known = [math.sin(tilt) * math.sin(around * t), -math.sin(tilt) * math.cos(around * t), math.cos(tilt)]
    yield Answer("axis", axis, known)
    yield Answer("centre", run[disc].position(t), [0, 0, r * math.sin(tilt)])


@rolling(
    "Euler's disk falls",
    hard="it goes round ever faster, and ends at a finite time",
    source="equations written apart, 20 digits",
)
def falling_disk(solve: Solve) -> Answers:
    """Friction against rolling takes its energy; it lies flat after 0.463 s, and the run says so."""
    r, friction = 0.0375, Coulomb(math.inf, rolling=0.004)
    scene = Scene(gravity=[0, 0, -G])
    disc = scene.add(
        shapes.disc(0.4, r, [0, 0, 1]),
        Free(),
        position=[0, 0, r * 0.28],
        attitude=tilted(0.96, 0.28),
        angular_velocity=[0, 17.119190011991417, 0],
    )
    scene.contact(disc.disc(r, [0, 0, 1]), TABLE, friction=friction)
    run = solve(scene, 0.4)
    for t, axis, omega in FALLING:
        yield Answer(f"axis after {t} s", run[disc].rotation_matrix(t)[:, 2], axis)
        yield Answer(f"omega after {t} s", run[disc].angular_velocity_world(t), omega)
    run, why = solve.ending(scene, 1.0, rtol=1e-12)
    yield says(f"{run.status}: {why}", "inconsistent", "come to lie flat")


def rattleback(spin: float) -> tuple[Scene, BodyHandle]:
    """Half an ellipsoid whose axes of inertia are turned against those of its surface."""
    omega = np.array([0.0078125, 0.0078125, spin])
    inertia = np.array([[2.5e-4, -7.5e-5, 0], [-7.5e-5, 1.5e-3, 0], [0, 0, 1.7e-3]])
    scene = Scene(gravity=[0, 0, -G])
    stone = scene.add(
        RigidBody(1.0, inertia),
        Free(),
        position=[0, 0, 0.01],
        velocity=-np.cross(omega, [0, 0, -0.01]),
        angular_velocity=omega,
    )
    surface = stone.ellipsoid([0.2, 0.03125, 0.02], [0, 0, 0.01])
    scene.contact(surface, TABLE, friction=Coulomb(math.inf))
    return scene, stone


@rolling(
    "rattleback",
    hard="it turns round one way and not the other",
    source="equations written apart, 20 digits",
)
def turns_round(solve: Solve) -> Answers:
    """Spun with -3 rad/s it rattles and comes back with +3; spun with +3 it goes on (Bondi 1986)."""
    scene, stone = rattleback(-3.0)
    run = solve(scene, 5.0)
    for t, omega in RATTLES:
        yield Answer(f"omega after {t} s", run[stone].angular_velocity_world(t), omega, scale=3.0)
    times = np.linspace(0, 5, 41)
    yield Answer("energy", run.energy(times), np.full(41, run.energy(0.0)))
    scene, stone = rattleback(3.0)
    run = solve(scene, 5.0)
    spin = run[stone].angular_velocity_world(times)[:, 2]
    yield Answer("goes on", np.sign(spin), np.ones(41), scale=0.0)
    yield Answer("energy, going on", run.energy(times), np.full(41, run.energy(0.0)))


TOP = {"radius": 0.02, "mass": 0.015, "off": 0.15 * 0.02}
ALONG = 0.4 * 0.015 * 0.02**2
MOMENTS = np.array([0.95 * ALONG, 0.95 * ALONG, ALONG])


def tippe_top() -> tuple[Scene, BodyHandle]:
    """A sphere whose centre of mass is below its centre, spun with 200 rad/s beside its axis."""
    scene = Scene(gravity=[0, 0, -G])
    top = scene.add(
        RigidBody(TOP["mass"], MOMENTS),
        Free(),
        position=[0, 0, TOP["radius"] - 0.8 * TOP["off"]],
        attitude=tilted(0.8, 0.6),
        angular_velocity=[0, 120, 160],
    )
    scene.contact(top.sphere(TOP["radius"], [0, 0, TOP["off"]]), TABLE, friction=Coulomb(0.1))
    return scene, top


def _jellett(run: Trajectory, top: BodyHandle, t: float) -> float:
    """K about the centre of mass along the way from there to where the top touches, whatever friction does."""
    turn = run[top].rotation_matrix(t)
    way = TOP["off"] * turn[:, 2] - [0, 0, TOP["radius"]]
    return float(turn @ (MOMENTS * run[top].angular_velocity(t)) @ way)


@rolling(
    "tippe top",
    hard="it slides, turns over, and rolls on its head",
    source="equations written apart, 20 digits; Jellett's integral",
)
def turns_over(solve: Solve) -> Answers:
    """Jellett's integral stays; after 3.44 s it slides no more, within 4 degrees of upside down."""
    scene, top = tippe_top()
    t = 5.0
    run = solve(scene, t)
    for when, axis, omega in TURNS_OVER:
        yield Answer(f"axis after {when} s", run[top].rotation_matrix(when)[:, 2], axis)
        yield Answer(f"omega after {when} s", run[top].angular_velocity_world(when), omega)
    times = np.linspace(0, t, 41)
    jellett = [_jellett(run, top, when) for when in times]
    yield Answer("Jellett's integral", jellett, np.full(41, _jellett(run, top, 0.0)))
    yield kinds(run, "stick")
    yield Answer("upside down", run[top].rotation_matrix(t)[2, 2], -1.0, given=3e-3)
