"""Points on rails and friction."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from rbdyn._core import Circle, Coulomb, Line, Particle, Polynomial, Rail, Scene, Spline, Spring, System
from rbdyn.array_functions import where
from rbdyn.verification.case import STEPS, Answer, Answers, Solve, case, kinds

G = 9.8125

rail = partial(case, subject="Friction and rails")


def _belt(mu_static: float, mu_dynamic: float, solve: Solve) -> Answers:
    # weight, mass, stiffness and speed of the belt are 1: held from 0 to mu_static, then a circle about mu_dynamic
    scene = Scene(gravity=[0, 0, -1])
    moving = Rail(Line([1, 0, 0]), friction=Coulomb(mu_static, mu_dynamic), drive=1.0)
    block = scene.add(Particle(1.0), moving, parameter=0.0, speed=1.0)
    scene.connect(Spring(1.0), block, [0, 0, 0])
    gap = mu_static - mu_dynamic
    slips = 2 * (math.pi - math.atan(gap))
    run = solve(scene, mu_static + 2 * (slips + 2 * gap) + 0.5 * slips)
    away, held = run.events.times("slip"), run.events.times("stick")
    first = np.array([mu_static, mu_static + slips + 2 * gap, mu_static + 2 * (slips + 2 * gap)])
    yield Answer("breaks away at", away, first)
    yield Answer("is held at", held, first[:2] + slips)


@rail("belt", row="belt, m = k = v = 1, fs = 1, fd = .5", hard="creep, a wrong period")
def belt(solve: Solve) -> Answers:
    """Slips last 5.35589008917797424, holds 1."""
    return _belt(1.0, 0.5, solve)


@rail(
    "belt, fs = 100 fd",
    row="fs much larger than fd, fs -> fd",
    hard="the force jumps by a hundredfold at release",
    error=1e-9,
)
def belt_of_a_hundred(solve: Solve) -> Answers:
    """The jump at release is nearly all of the force."""
    return _belt(1.0, 0.01, solve)


@rail(
    "belt, fs beside fd", row="fs much larger than fd, fs -> fd", hard="holds of 2e-4 s in periods of 6 s", error=1e-9
)
def belt_of_little(solve: Solve) -> Answers:
    """Holds are short, each a stick and a slip all the same."""
    return _belt(0.5001, 0.5, solve)


def _incline(slope: float) -> Line:
    return Line([1.0, 0.0, -slope])


@rail("hold below the cone", row="static hold below the cone for 1e6 s", hard="creep")
def hold(solve: Solve) -> Answers:
    """A bead that friction holds does not move at all."""
    scene = Scene(gravity=[0, 0, -G])
    bead = scene.add(Particle(1.0), Rail(_incline(0.5), friction=Coulomb(0.6, 0.3)), parameter=0.3)
    run = solve(scene, 1e6)
    yield Answer("moves by", run[bead].parameter([1.0, 12345.678, 1e6]) - 0.3, 0.0)
    yield Answer("speed", run[bead].speed(1e6), 0.0)
    yield kinds(run)


@rail("on the edge of the cone", row="static hold below the cone for 1e6 s", hard="rounding decides of tan a = mu")
def edge(solve: Solve) -> Answers:
    """At tan a = mu_static it is held, a little above it slides."""
    for slope in (0.1, 1 / 3, 0.7, 7.3):
        scene = Scene(gravity=[0, 0, -G])
        held = Rail(_incline(slope), friction=Coulomb(slope, 0.5 * slope))
        bead = scene.add(Particle(1.0), held, parameter=0.3)
        yield Answer("moves by", solve(scene, 10.0)[bead].parameter(10.0) - 0.3, 0.0)
        scene = Scene(gravity=[0, 0, -G])
        loose = Rail(_incline(slope * (1 + 1e-9)), friction=Coulomb(slope, 0.5 * slope))
        bead = scene.add(Particle(1.0), loose, parameter=0.0)
        pull = G / math.hypot(1, slope * (1 + 1e-9)) * (slope * (1 + 1e-9) - 0.5 * slope)
        yield Answer("slides to", solve(scene, 1.0)[bead].arc_length(1.0), 0.5 * pull)


@rail("thrown up an incline", row="static hold below the cone for 1e6 s", hard="creep after it stops")
def thrown_up(solve: Solve) -> Answers:
    """It slows, stops and stays."""
    scene = Scene(gravity=[0, 0, -G])
    bead = scene.add(Particle(2.0), Rail(_incline(0.5), friction=Coulomb(0.625, 0.25)), parameter=0.0, speed=-4.0)
    slowing = G / math.hypot(1, 0.5) * (0.5 + 0.25)
    run = solve(scene, 1e4)
    yield Answer("stops at", run.events.times("stick"), [4 / slowing])
    yield Answer("has come to", run[bead].arc_length(1e4), -8 / slowing)


@rail("coasting on a bend", row="coasting on a frictional bend, no gravity", hard="curvature takes the speed")
def bend(solve: Solve) -> Answers:
    """v = v0 exp(-mu alpha) on every curve; on a circle v = v0/(1 + mu v0 t/R)."""
    scene = Scene()
    circle = Rail(Circle(radius=2.0, start=[1, 0, 0], toward=[0, 1, 0]), friction=Coulomb(0.25))
    round_ = scene.add(Particle(1.0), circle, parameter=0.0, speed=3.0)
    run = solve(scene, 5.0)
    speed = run[round_].speed(5.0)
    yield Answer("speed on a circle", speed, 3 / (1 + 0.25 * 3 * 5 / 2))
    yield Answer("and by its angle", speed, 3 * math.exp(-0.25 * run[round_].parameter(5.0)), scale=3.0)
    scene = Scene()
    curve = Rail(Polynomial(np.array([[0, 0, 0], [1, 0, 0], [0, 0, 0.5]])), friction=Coulomb(0.25))
    bead = scene.add(Particle(1.0), curve, parameter=0.0, speed=3.0)
    scene.watch("there", lambda now: now[bead].position[0] - 2.0, action="stop")
    run = solve(scene, 50.0)
    yield Answer("speed on a parabola", run[bead].speed(run.end), 3 * math.exp(-0.25 * math.atan(2.0)), scale=3.0)


@rail(
    "inflection of a rough rail", row="N through zero; inflection with F_t = N = 0", hard="a kink of |N|, threshold 0"
)
def inflection(solve: Solve) -> Answers:
    """z = u^3/3 from u = -1 to 1 without gravity: turned by pi/4 to the level and back, N = 0 between."""
    scene = Scene()
    curve = Rail(Polynomial(np.array([[0, 0, 0], [1, 0, 0], [0, 0, 0], [0, 0, 1 / 3]])), friction=Coulomb(0.5, 0.25))
    bead = scene.add(Particle(1.0), curve, parameter=-1.0, speed=2.0)
    scene.watch("there", lambda now: now[bead].position[0] - 1.0, action="stop")
    run = solve(scene, 50.0)
    yield Answer("speed", run[bead].speed(run.end), 2 * math.exp(-0.25 * math.pi / 2), scale=2.0)
    (zero,) = run.events.times("normal-zero")
    yield Answer("N is zero at u", run[bead].parameter(zero), 0.0, scale=1.0)


def _zero_of_the_normal(mu: float, start: float) -> float:
    # down a hoop from rest at an angle over pi/2 from its lowest point; while it is pulled, w = v^2/(g R) obeys
    # w' + 2 mu w = -2 sin u - 2 mu cos u, and N = 0 where w = -cos u
    a = (2 - 4 * mu**2) / (1 + 4 * mu**2)
    b = -2 * mu * (1 + a)
    c = -(a * math.cos(start) + b * math.sin(start))

    def n(u: float) -> float:
        return a * math.cos(u) + b * math.sin(u) + c * math.exp(-2 * mu * (u - start)) + math.cos(u)

    low, high = start - 1.5, start
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if n(middle) > 0 else (low, middle)
    return 0.5 * (low + high)


@rail("N through zero on a hoop", row="N through zero; inflection with F_t = N = 0", hard="friction has a kink there")
def normal_zero(solve: Solve) -> Answers:
    """The angle where a rough hoop pushes instead of pulling."""
    scene = Scene(gravity=[0, 0, -G])
    hoop = Rail(Circle(radius=1.0, start=[0, 0, -1], toward=[1, 0, 0]), friction=Coulomb(0.25, 0.125))
    bead = scene.add(Particle(1.0), hoop, parameter=2.5)
    run = solve(scene, 2.0)
    zero = run.events.times("normal-zero")[0]
    yield Answer("at the angle", run[bead].parameter(zero), _zero_of_the_normal(0.125, 2.5))


@rail(
    "off a sphere",
    row="one-sided rail: leave a sphere, land again",
    hard="it is on the rail again where it leaves",
    holds=STEPS,
)
def sphere(solve: Solve) -> Answers:
    """From nearly at rest: acos(2/3 + v^2/(3 g R)), 48.19 degrees; then a parabola."""
    scene = Scene(gravity=[0, 0, -G])
    out = Rail(Circle(radius=1.0, start=[0, 0, 1], toward=[1, 0, 0]), side="-")
    speed = 0.1 * math.sqrt(G)
    bead = scene.add(Particle(0.2), out, parameter=0.0, speed=speed)
    scene.watch("ground", lambda now: now[bead].position[2] + 1.0, direction="falling", action="stop")
    run = solve(scene, 10.0)
    (leaves,) = run.events.times("detach")
    angle = math.acos(2 / 3 + speed**2 / (3 * G))
    x, _, z = run[bead].position(leaves)
    yield Answer("leaves at", math.atan2(x, z), angle)
    down = math.sqrt(G * math.cos(angle)) * math.sin(angle)
    fall = (math.sqrt(down**2 + 2 * G * (1 + math.cos(angle))) - down) / G
    yield Answer("falls for", run.end - leaves, fall, scale=run.end)


@rail("lands in a loop", row="one-sided rail: leave a sphere, land again", hard="landing is found once, and held")
def loop(solve: Solve) -> Answers:
    """It leaves at an angle from the top and lands at three times that on the other side."""
    scene = Scene(gravity=[0, 0, -G])
    inside = Rail(Circle(radius=1.0, start=[0, 0, -1], toward=[1, 0, 0]), side="+")
    bead = scene.add(Particle(0.2), inside, parameter=0.0, speed=math.sqrt(3.5 * G))
    run = solve(scene, 1.6)
    leaves, lands = run.events.times("detach"), run.events.times("land")
    above = math.asin(0.5)
    x, _, z = run[bead].position(leaves[0])
    yield Answer("leaves at", math.atan2(z, x), above)
    x, _, z = run[bead].position(lands[0])
    yield Answer("lands at", abs(math.remainder(math.atan2(z, x) + 3 * above, 2 * math.pi)), 0.0, scale=math.pi)


@rail("spline with jumps of curvature", row="spline rail with a curvature jump", hard="the order drops at a knot")
def spline(solve: Solve) -> Answers:
    """Without friction the speed at a height is known, at knots of which the curvature jumps too."""
    points = [[0, 0, 0], [1, 0, 0.5], [2, 0, -0.25], [3, 0, 0.25], [4, 0, 0]]
    curve = Spline(np.array(points), slopes={1: [1, 0, 0], 2: [1, 0, 0.1], 3: [1, 0, -0.25]})
    scene = Scene(gravity=[0, 0, -G])
    bead = scene.add(Particle(1.0), Rail(curve), parameter=0.0, speed=5.0)
    scene.watch("knot", lambda now: now[bead].position[0] - 3.0, action="stop")
    run = solve(scene, 5.0)
    yield Answer("speed at a knot", run[bead].speed(run.end), math.sqrt(25 - 2 * G * 0.25))
    z = run[bead].position(0.5 * run.end)[2]
    yield Answer("speed halfway", run[bead].speed(0.5 * run.end), math.sqrt(25 - 2 * G * z), scale=5.0)


@rail("Filippov sliding", row="Filippov sliding (two fields pointing at each other)", hard="infinitely many switches")
def filippov(solve: Solve) -> Answers:
    """Between (1, -1) above and (3, 2) below y = 0 the motion goes along with 5/3."""
    fields = System(lambda t, x: [where(x[1] > 0, 1.0, 3.0), where(x[1] > 0, -1.0, 2.0)], [0.0, 1.0])
    run = solve(fields, 3.0)
    x = run.x(3.0)  # type: ignore[attr-defined]
    yield Answer("has come to", x[0], 1 + 2 * 5 / 3)
    yield Answer("off the surface by", x[1], 0.0)
    yield Answer("switches at", run.events.times("switch"), [1.0])


@rail("relay", row="Filippov sliding (two fields pointing at each other)", hard="chatter")
def relay(solve: Solve) -> Answers:
    """Dry friction written as a sign stops a mass where it should and holds it."""
    mass = System(lambda t, x: [x[1], -2.0 * np.sign(x[1])], [0.0, 3.0])
    run = solve(mass, 1e3)
    x = run.x(1e3)  # type: ignore[attr-defined]
    yield Answer("stops at", run.events.times("switch"), [1.5])
    yield Answer("place", x[0], 2.25)
    yield Answer("speed", x[1], 0.0)
