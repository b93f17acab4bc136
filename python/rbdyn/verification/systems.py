"""Systems: trees of bodies, attraction, springs."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from rbdyn._core import BodyHandle, Free, Gravitation, Line, Particle, Rail, Revolute, RigidBody, Scene, Spring
from rbdyn.verification.case import ALL, STEPS, TAYLOR, Answer, Answers, Engine, Solve, Unfinished, case

Z = [0.0, 0.0, 1.0]

system = partial(case, subject="Systems and mechanisms")
scale = partial(case, subject="Scale and length")

# those that come through close approaches in steps that are not too many
EXACT: tuple[Engine, ...] = ("closed form", "taylor")


@system(
    "double pendulum",
    row="double pendulum, chains, trees",
    hard="wrong reactions",
    source="reference l_double_pendulum, 25 digits",
)
def double_pendulum(solve: Solve) -> Answers:
    """Two compound bodies, their centres of mass off the line of the hinges."""
    scene = Scene(gravity=[0, -9.8125, 0])
    upper = scene.add(
        RigidBody(2.0, [0.25, 0.25, 0.5], com=[0.125, -0.5, 0]), Revolute(Z, at=[0.25, 1, 0]), angle=1.5, rate=0.5
    )
    lower = scene.add(
        RigidBody(1.25, [0.125, 0.125, 0.1875], com=[0.0625, -0.375, 0]),
        Revolute(Z, at=[0.125, -1, 0], point=[0, 0.125, 0]),
        parent=upper,
        angle=-0.75,
        rate=2.0,
    )
    run = solve(scene, 5.0)
    yield Answer("angle", run[upper].angle(5.0), 0.18206901231884338060, scale=1.0)
    size = float(np.max(np.linalg.norm(run[lower].reaction(np.linspace(0, 5, 201)), axis=1)))
    known = [4.0156239100237069497, 1.5913584435719103311, 0]
    yield Answer("reaction", run[lower].reaction(5.0), known, scale=size)
    yield Answer("energy", run.energy(5.0), 32.786377359438500411)


@system(
    "three thin rods",
    row="thin rods in trees and loops",
    hard="a body's inertia is inverted",
    source="reference l_triple_rods, 25 digits",
)
def triple_rods(solve: Solve) -> Answers:
    """No inertia about their own lines."""
    scene = Scene(gravity=[0, -9.8125, 0])
    bodies: list[BodyHandle] = []
    for mass, length, angle in ((3.0, 1.0, 2.0), (1.5, 1.0, -0.5), (0.75, 2.0, 1.0)):
        moment = mass * length**2 / 12
        at = [0, -1, 0] if bodies else [0, 0, 0]
        body = RigidBody(mass, [moment, 0, moment], com=[0, -length / 2, 0])
        parent = bodies[-1] if bodies else None
        bodies.append(scene.add(body, Revolute(Z, at=at), parent=parent, angle=angle))
    run = solve(scene, 1.0)
    yield Answer("angle", run[bodies[0]].angle(1.0), -0.14431131095604502807, scale=1.0)
    yield Answer("angle of the third", run[bodies[2]].angle(1.0), -0.71721877949576925078, scale=1.0)


def _two(masses: tuple[float, float], speed: float) -> Scene:
    scene = Scene()
    one = scene.add(Particle(masses[0]), position=[0, 0, 0])
    other = scene.add(Particle(masses[1]), position=[1, 0, 0], velocity=[0, speed, 0])
    scene.connect(Gravitation(1.0), one, other)
    return scene


@system(
    "Kepler, e = 0.9",
    row="Kepler, e = 0.999 for 1000 turns; Pythagorean three bodies",
    hard="a step's length changes by a thousand",
    source="reference o_kepler_e09, 25 digits",
    holds=("closed form", "taylor", "dop853", "cvode-adams", "cvode-bdf"),
)
def kepler(solve: Solve) -> Answers:
    """One turn from pericentre to pericentre, the centre of mass moving."""
    scene = _two((1.0, 0.5), 1.6881943016134133)
    t = 162.231147038945067606617
    run = solve(scene, t)
    yield Answer("place of the first", run[scene.bodies[0]].position(t), [0, 91.292565991784951740, 0])
    yield Answer("place of the second", run[scene.bodies[1]].position(t), [1, 91.292565991784932583, 0])


@system(
    "Kepler, e = 0.999",
    row="Kepler, e = 0.999 for 1000 turns; Pythagorean three bodies",
    hard="a close approach in a millionth of the period",
    source="reference o_kepler_e0999, 25 digits",
    error=1e-4,
    holds=EXACT,
)
def kepler_close(solve: Solve) -> Answers:
    """Ten turns and a half."""
    scene = _two((1.0, 0.5), 1.7316177407268613652746580555685795843601226806640625)
    t = 1703427.04390835459344089031219482421875
    run = solve(scene, t)
    known = [666.66666666651990612, 983228.16308854035169, 0]
    yield Answer("place of the first", run[scene.bodies[0]].position(t), known)


@system(
    "Kepler, e = 0.999, 1000 turns",
    row="Kepler, e = 0.999 for 1000 turns; Pythagorean three bodies",
    hard="an error of phase that a thousand close approaches amplify",
    source="reference o_kepler_e0999, 25 digits",
    error=1e-3,
    holds=("closed form",),
    quick=False,
)
def kepler_long(solve: Solve) -> Answers:
    """A quarter turn before, and at the pericentre, where both are 1 m apart."""
    scene = _two((1.0, 0.5), 1.7316177407268613652746580555685795843601226806640625)
    steps = 200_000 if solve.engine == "taylor" else 1000
    for t, one, other in (
        (
            162190589.2521311938762664794921875,
            [557.76180406961175143776, 93617378.261955021153813812],
            [-1114.5236081392235028756, 93617345.204023738954400138],
        ),
        (162231147.038890898227691650390625, [0, 93640777.437003838207182189], [1, 93640777.437003825908003081]),
    ):
        run = solve(scene, t, keep="end", max_steps=steps)
        for body, known in zip(scene.bodies, (one, other), strict=True):
            yield Answer("place", run[body].position(t)[:2], known)
        apart = [run[body].position(t)[0] for body in scene.bodies]
        # they are up to 2000 m apart
        yield Answer("apart", apart[1] - apart[0], other[0] - one[0], scale=2000.0)


@system(
    "Pythagorean three bodies",
    row="Kepler, e = 0.999 for 1000 turns; Pythagorean three bodies",
    hard="close approaches, down to 4e-4 m, after which an error has grown",
    source="reference o_pythagorean, 25 digits",
    error=1e-4,
    holds=STEPS,
)
def pythagorean(solve: Solve) -> Answers:
    """Masses 3, 4, 5 at rest at the corners of a triangle (Burrau 1913), to beyond the closest approach at 15.83 s."""
    return _pythagorean(20.0, [3.0042926366963992054, 0.51192523502468586560], solve)


@system(
    "Pythagorean three bodies for 50 s",
    row="Kepler, e = 0.999 for 1000 turns; Pythagorean three bodies",
    hard="errors grow a millionfold",
    source="reference o_pythagorean, 25 digits",
    error=1e-4,
    holds=TAYLOR,
)
def pythagorean_long(solve: Solve) -> Answers:
    """To the eve of its dissolution, fourteen close approaches later."""
    return _pythagorean(50.0, [-2.7014614092655247252, -3.7972226827224479963], solve)


def _pythagorean(t: float, known: list[float], solve: Solve) -> Answers:
    scene = Scene()
    places = {3.0: [1, 3, 0], 4.0: [-2, -1, 0], 5.0: [1, -1, 0]}
    balls = [scene.add(Particle(mass), position=place) for mass, place in places.items()]
    for k in range(3):
        scene.connect(Gravitation(1.0), balls[k], balls[k - 1])
    run = solve(scene, t)
    yield Answer("place of the lightest", run[balls[0]].position(t)[:2], known)
    yield Answer("energy", run.energy(t), -12.816666666666666666666666666667)


@system(
    "figure of eight",
    row="Kepler, e = 0.999 for 1000 turns; Pythagorean three bodies",
    hard="three bodies",
    source="reference o_figure_eight, 25 digits",
)
def figure_of_eight(solve: Solve) -> Answers:
    """Three equal masses on one curve."""
    scene = Scene()
    place, speed = np.array([0.97000436, -0.24308753, 0]), np.array([0.466203685, 0.43236573, 0])
    balls = [
        scene.add(Particle(1.0), position=place, velocity=speed),
        scene.add(Particle(1.0), position=-place, velocity=speed),
        scene.add(Particle(1.0), position=[0, 0, 0], velocity=[-0.93240737, -0.86473146, 0]),
    ]
    for k in range(3):
        scene.connect(Gravitation(1.0), balls[k], balls[k - 1])
    run = solve(scene, 1.0)
    known = [0.99358291994097784127, 0.21920494711469556273, 0]
    yield Answer("place of the first", run[balls[0]].position(1.0), known)


@system(
    "chain of 100 masses",
    row="chain of 100,000 masses, the first one kicked",
    hard="masses that do not move yet",
    holds=STEPS,
    error=1e-9,
)
def chain(solve: Solve) -> Answers:
    """The first mass is kicked: a sum over the modes of a chain with fixed ends."""
    n, t = 100, 5.0
    scene = Scene()
    line = Rail(Line([1, 0, 0]))
    balls = [scene.add(Particle(1.0), line, parameter=0.0, speed=1.0 if k == 0 else 0.0) for k in range(n)]
    for a, b in zip(balls[:-1], balls[1:], strict=True):
        scene.connect(Spring(1.0), a, b)
    scene.connect(Spring(1.0), balls[0], [0, 0, 0])
    scene.connect(Spring(1.0), balls[-1], [0, 0, 0])
    run = solve(scene, t)
    angle = np.arange(1, n + 1) * math.pi / (n + 1)
    rate = 2 * np.sin(angle / 2)
    for j in (0, 5):
        terms = np.sin(angle) * np.sin((j + 1) * angle) * np.sin(rate * t) / rate
        yield Answer(
            f"place of mass {j + 1}", run[balls[j]].parameter(t), 2 / (n + 1) * float(np.sum(terms)), scale=1.0
        )


@system(
    "chain of 100,000 masses",
    row="chain of 100,000 masses, the first one kicked",
    hard="costs that grow with the square of their number",
    source="equations written apart, 20 digits",
    holds=TAYLOR,
    error=1e-9,
    quick=False,
)
def long_chain(solve: Solve) -> Answers:
    """Springs of 1 m in space, the first mass kicked askew."""
    if solve.engine != "taylor":
        raise Unfinished("the case leaves engines of lower order no time: they hold a thousand masses in seconds")
    return kicked(100_000, solve)


def kicked(n: int, solve: Solve) -> Answers:
    """So many masses, at least 30: what moves in 1 s is the first ten, and knows nothing of the others."""
    scene, balls = Scene(), list[BodyHandle]()
    for k in range(n):
        velocity = [0.0, 0.0, 0.0] if k else [0.3, 0.4, 0.2]
        balls.append(scene.add(Particle(1.0), position=[k, 0, 0], velocity=velocity))
        if k:
            scene.connect(Spring(100.0, rest_length=1.0), balls[k - 1], balls[k])
    run = solve(scene, 1.0, keep="end")
    known = [0.11382375302281502187, 0.39743850911849476894, 0.19871925455924738447]
    yield Answer("place of mass 1", run[balls[0]].position(1.0), known)
    known = [0.016613593977514342952, -8.6219519791927836815e-10, -4.3109759895963918407e-10]
    yield Answer("mass 6 moved by", run[balls[5]].position(1.0) - [5.0, 0, 0], known, scale=0.05)


@scale(
    "mass ratio 1e8",
    row="mass ratios, stiff springs",
    hard="the small motion of the large mass",
    holds=ALL,
)
def mass_ratio(solve: Solve) -> Answers:
    """Two free masses and a spring: omega^2 = k (1/m + 1/M)."""
    heavy, light, k, t = 1e8, 1.0, 4.0, 20.0
    scene = Scene()
    one = scene.add(Particle(heavy), position=[0, 0, 0])
    two = scene.add(Particle(light), position=[1, 0, 0])
    scene.connect(Spring(k), one, two)
    run = solve(scene, t)
    cosine = math.cos(math.sqrt(k * (1 / heavy + 1 / light)) * t)
    center = light / (heavy + light)
    yield Answer(
        "place of the light mass", run[two].position(t)[0], center + cosine * heavy / (heavy + light), scale=1.0
    )
    moved = center * (1 - cosine)
    yield Answer("place of the heavy mass", run[one].position(t)[0], moved, scale=2 * center)


@scale(
    "a spring of 1e9 N/m",
    row="mass ratios, stiff springs",
    hard="a fast motion that does not matter shortens each step",
    source="reference i_stiff, 25 digits",
    holds=ALL,
)
def stiff(solve: Solve) -> Answers:
    """Frequencies 1.5 and 40132 rad/s."""
    scene = Scene()
    line = Rail(Line([1, 0, 0]))
    one = scene.add(Particle(1.0), line, parameter=1.0, speed=0.25)
    two = scene.add(Particle(2.0), line, parameter=1.0, speed=0.0)
    scene.connect(Spring(4.0), one, [0, 0, 0])
    scene.connect(Spring(3.0), two, [0, 0, 0])
    scene.connect(Spring(1073741824.0), one, two)
    t = 0.001000000000000000020816681711721685
    run = solve(scene, t)
    yield Answer("x1", run[one].parameter(t), 1.0000848663548789457995640749348)
    yield Answer("v1", run[one].speed(t), -0.045609109261729861578420502301897, scale=0.25)


def _free_spring(metre: float, kilogram: float, second: float) -> tuple[Scene, BodyHandle]:
    scene = Scene(gravity=[0, 0, -9.81 * metre / second**2])
    speed = 0.7 * metre / second
    a = scene.add(Particle(0.3 * kilogram), position=[0, 0, 0], velocity=[0, speed, 0])
    body = RigidBody(1.1 * kilogram, np.array([0.3, 0.4, 0.5]) * kilogram * metre**2)
    b = scene.add(body, Free(), position=[1.3 * metre, 0, 0])
    spring = Spring(3.0 * kilogram / second**2, rest_length=0.9 * metre)
    scene.connect(spring, a, b.point([0.1 * metre, 0.2 * metre, 0]))
    return scene, b


@scale("other units", row="units from 1e-9 to 1e9", hard="absolute constants inside", source="symmetry", holds=STEPS)
def units(solve: Solve) -> Answers:
    """Units of 2^-30 and 2^30 m, kg and s change no digit; with cvode-bdf, none of twelve."""
    # cvode-bdf rounds otherwise in other units, by 1e-14 to 1e-13 (most likely by its choice of pivots): to 1e-12
    scale = 1e-12 / solve.error if solve.engine == "cvode-bdf" else 0.0
    small, large = 2.0**-30, 2.0**30
    told = {
        "small metres": (small, 1.0, 1.0),
        "large metres": (large, 1.0, 1.0),
        "small kilograms": (1.0, small, 1.0),
        "large kilograms": (1.0, large, 1.0),
        "small seconds": (1.0, 1.0, small),
        "large seconds": (1.0, 1.0, large),
    }
    if solve.engine != "cvode-bdf":
        # which differs here by 4e-9, a thousandth of its error
        told["all at once"] = (small, large, large)

    def place(metre: float, kilogram: float, second: float) -> np.ndarray:
        scene, body = _free_spring(metre, kilogram, second)
        return solve(scene, 2.0 * second)[body].position(2.0 * second) / metre

    known = place(1.0, 1.0, 1.0)
    for name, unit in told.items():
        yield Answer(f"place in {name}", place(*unit), known, scale=scale)
