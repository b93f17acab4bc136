"""Contacts: impacts, friction, rolling."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from rbdyn import shapes
from rbdyn._core import BodyHandle, ContactHandle, Coulomb, Free, Particle, Planar, Plane, Revolute, RigidBody, Scene
from rbdyn.verification.case import TAYLOR, Answer, Answers, Solve, case, kinds, says

G = 9.8125
Z = [0.0, 0.0, 1.0]

contact = partial(case, subject="Contact and events", holds=TAYLOR)

FLOOR = Plane([0, 1, 0])


def _rectangle(mass: float, half_width: float, half_height: float) -> RigidBody:
    moment = mass * (half_width**2 + half_height**2) / 3
    return RigidBody(mass, [moment / 2, moment / 2, moment])


@contact(
    "ball restarted on the plane", row="bouncing ball restarted exactly on the plane", hard="the next bounce is lost"
)
def restarted(solve: Solve) -> Answers:
    """Each flight starts where the last one ended; ten are found one by one."""
    speed, times = 5.0, list[float]()
    for _ in range(10):
        scene = Scene(gravity=[0, 0, -G])
        ball = scene.add(Particle(1.0), position=[0, 0, 0], velocity=[0, 0, speed])
        scene.contact(ball, Plane(Z), restitution=1.0)
        run = solve(scene, 1.5 * 2 * speed / G)
        times.extend(run.events.times("impact"))
        speed = float(run[ball].velocity(times[-1])[2])
    yield Answer("bounces at", times, [10.0 / G] * 10)


@contact("Zeno ball", row="Zeno ball", hard="infinitely many bounces, and a fall through the floor")
def zeno(solve: Solve) -> Answers:
    """e = 0.9, h = 10 m: they end at 27.129019335612225 s, then it lies still."""
    e, h, g = 0.9, 10.0, 9.81
    scene = Scene(gravity=[0, 0, -g])
    ball = scene.add(Particle(1.0), position=[0, 0, h])
    hit = scene.contact(ball, Plane(Z), restitution=e)
    run = solve(scene, 30.0)
    fall = math.sqrt(2 * h / g)
    yield Answer("bounces end at", run.events.times("accumulation"), [fall * (1 + e) / (1 - e)])
    first = fall * (1 + 2 * e * (1 - e ** np.arange(20)) / (1 - e))
    yield Answer("first twenty bounces", run.events.times("impact")[:20], first)
    yield Answer("at rest at", run[ball].position(30.0), [0, 0, 0], scale=h)
    yield Answer("pressed by", run[hit].force(30.0)[2], g)


@contact("two balls land at once", row="simultaneous events", hard="depends on the order of writing")
def at_once(solve: Solve) -> Answers:
    """Both in either order, at the same instant."""
    for order in ((0, 1), (1, 0)):
        scene = Scene(gravity=[0, 0, -G])
        balls = [scene.add(Particle(1.0 + k), position=[float(k), 0, 1], name=f"ball {k}") for k in order]
        for ball in balls:
            scene.contact(ball, Plane(Z), restitution=0.5)
        run = solve(scene, 0.6)
        yield Answer("land at", run.events.times("impact"), [math.sqrt(2 / G)] * 2)
        yield Answer("rise at", [run[ball].velocity(0.6)[2] for ball in balls], [1.5 * math.sqrt(2 * G) - 0.6 * G] * 2)


@contact(
    "ball with backspin",
    row="backspin; disc beside tan a = 3 mu; sliding to rolling",
    hard="creep, chatter where it begins to roll",
    source="reference n_ball_backspin, 25 digits",
)
def backspin(solve: Solve) -> Answers:
    """It slides, rolls from 0.6988 s on, and comes back faster than it went."""
    scene = Scene(gravity=[0, 0, -G])
    ball = scene.add(
        shapes.sphere(0.5, 0.125),
        Free(),
        position=[0, 0, 0.125],
        velocity=[3, 0, 0],
        angular_velocity=[0, -24, 0],
    )
    scene.contact(ball.sphere(0.125), Plane(Z), friction=Coulomb(0.25))
    run = solve(scene, 2.0)
    yield Answer("rolls from", run.events.times("stick"), [0.69881710646041856233])
    yield Answer("place", run[ball].position(2.0), [3.1704146626803587678, 0, 0.125])
    yield Answer("spin", run[ball].angular_velocity_world(2.0), [0, 10.285714285714285714, 0], scale=24.0)


def _disc(mu: float, t: float, solve: Solve) -> tuple[float, float, str]:
    down = np.array([-0.8, -0.6, 0])
    normal = np.array([-0.6, 0.8, 0])
    scene = Scene(gravity=[0, -G, 0])
    disc = scene.add(shapes.disc(2.0, 0.25, Z), Free(), position=0.25 * normal)
    touch = scene.contact(disc.disc(0.25, Z), Plane(normal), friction=Coulomb(mu))
    run = solve(scene, t)
    return (
        float((run[disc].position(t) - 0.25 * normal) @ down),
        float(run[disc].rotation_matrix(t)[0, 0]),
        str(run[touch].state(0.5 * t)),
    )


@contact(
    "disc beside tan a = 3 mu", row="backspin; disc beside tan a = 3 mu; sliding to rolling", hard="the wrong side"
)
def disc(solve: Solve) -> Answers:
    """It rolls with 2/3 g sin a at the limit, and slides with g (sin a - mu cos a) below it."""
    t = 1.0
    for mu in (0.5, 0.25):
        distance, turned, state = _disc(mu, t, solve)
        yield Answer("rolls by", distance, G * 0.6 / 3 * t**2)
        yield Answer("turned, cosine", turned, math.cos(G * 0.6 / 3 * t**2 / 0.25), scale=1.0)
        yield says(state, "sticks")
    mu = 0.25 * (1 - 1e-6)
    distance, turned, state = _disc(mu, t, solve)
    yield Answer("slides by", distance, G * (0.6 - mu * 0.8) / 2 * t**2)
    yield Answer("turned, cosine", turned, math.cos(mu * 0.8 * G * t**2 / 0.25), scale=1.0)
    yield says(state, "slides")


def _ladder(angle: float, mu: float | None) -> tuple[Scene, BodyHandle, ContactHandle, ContactHandle]:
    scene = Scene(gravity=[0, -G, 0])
    place = [2 * math.cos(angle), 2 * math.sin(angle)]
    rod = scene.add(
        shapes.rod(10.0, 4.0, along=[1, 0, 0]), Planar(x=[1, 0, 0], y=[0, 1, 0]), position=place, angle=math.pi - angle
    )
    friction = None if mu is None else Coulomb(mu)
    floor = scene.contact(rod.point([-2, 0, 0]), FLOOR, friction=friction)
    wall = scene.contact(rod.point([2, 0, 0]), Plane([1, 0, 0]), friction=friction)
    return scene, rod, floor, wall


@contact("ladder leaves its wall", row="rocking, landing, ladders, cradles", hard="a wall that pulls")
def ladder(solve: Solve) -> Answers:
    """At two thirds of the height it started at; reference j_steep for the time."""
    scene, rod, _, wall = _ladder(1.5, None)
    run = solve(scene, 1.8)
    yield Answer("leaves at", run.events.times("detach", wall), [1.6602751674557266135])
    leaves = run.events.times("detach", wall)[0]
    yield Answer("its height there", math.sin(run[rod].angle(leaves)), 2 / 3 * math.sin(1.5))


@contact(
    "rough ladder",
    row="rocking, landing, ladders, cradles",
    hard="two ends slide, reactions depend on each other",
    source="reference n_ladder_friction, 25 digits",
)
def rough_ladder(solve: Solve) -> Answers:
    """It stands above its limit angle, and slides below it."""
    scene, rod, _, wall = _ladder(1.0, 0.25)
    run = solve(scene, 1.4)
    yield Answer("leaves the wall at", run.events.times("detach", wall), [1.3435454101899326565])
    yield Answer("rate there", -run[rod].rate(1.3435454101899326565), -1.3569702101566851784)
    scene, rod, _, _ = _ladder(1.0808390005411683109 + 1e-9, 0.25)
    run = solve(scene, 1e3)
    yield Answer("stands, moved by", run[rod].angle(1e3) - run[rod].angle(0.0), 0.0)


def _rocking(half_height: float, friction: Coulomb | None) -> tuple[Scene, BodyHandle]:
    b, h, tilt = 0.25, half_height, 0.25
    scene = Scene(gravity=[0, -G, 0])
    place = [0.0, b * math.sin(tilt) + h * math.cos(tilt)]
    block = scene.add(_rectangle(10.0, b, h), Planar(x=[1, 0, 0], y=[0, 1, 0]), position=place, angle=tilt)
    for side in (-b, b):
        scene.contact(block.point([side, -h, 0]), FLOOR, friction=friction)
    return scene, block


@contact(
    "rocking block, smooth",
    row="rocking, landing, ladders, cradles",
    hard="infinitely many impacts",
    source="reference n_rocking_frictionless, 25 digits",
)
def rocking(solve: Solve) -> Answers:
    """It comes to rest upright."""
    scene, block = _rocking(0.5, None)
    run = solve(scene, 1.0)
    yield Answer("upright at", run.events.times("accumulation"), [0.32577828496558748713])
    yield Answer("first lands at", run.events.times("land")[:1], [0.21920903478006144031])
    yield Answer("angle", run[block].angle(1.0), 0.0, scale=0.25)


@contact(
    "rocking block, rough",
    row="rocking, landing, ladders, cradles",
    hard="infinitely many impacts about fixed corners",
    source="reference n_rocking_housner, 25 digits",
)
def housner(solve: Solve) -> Answers:
    """Housner's block: each impact leaves 0.85 of the rate."""
    scene, _ = _rocking(0.75, Coulomb(math.inf))
    run = solve(scene, 6.0)
    yield Answer("upright at", run.events.times("accumulation"), [4.8678698980809936080])
    yield Answer("first lands at", run.events.times("land")[:2], [0.71577341992358011881, 1.4963885975717269972])


@contact(
    "box lands on a corner",
    row="rocking, landing, ladders, cradles",
    hard="energy gained at the second corner",
    source="reference n_box_landing, 25 digits",
)
def box(solve: Solve) -> Answers:
    """On one corner, then flat."""
    scene = Scene(gravity=[0, -G, 0])
    plane = Planar(x=[1, 0, 0], y=[0, 1, 0])
    block = scene.add(
        _rectangle(3.0, 0.5, 0.25), plane, position=[0, 0.75], velocity=[1, -0.5], angle=0.25, rate=-0.125
    )
    for side in (-0.5, 0.5):
        scene.contact(block.point([side, -0.25, 0]), FLOOR)
    run = solve(scene, 1.0)
    yield Answer("lands at", run.events.times("land"), [0.23796147616931475275, 0.28812339652657570461])
    yield Answer("slides on with", run[block].velocity(1.0), [1, 0, 0])


@contact(
    "rod falls on both ends",
    row="rocking, landing, ladders, cradles",
    hard="impacts in quick succession",
    source="reference n_rod_fall, 25 digits",
)
def rod_falls(solve: Solve) -> Answers:
    """Eight impacts."""
    scene = Scene(gravity=[0, -G, 0])
    plane = Planar(x=[1, 0, 0], y=[0, 1, 0])
    rod = scene.add(
        RigidBody(1.0, [1 / 6, 1 / 6, 1 / 3]), plane, position=[0, 3], velocity=[0.5, 0], angle=0.75, rate=1.0
    )
    for end in (-1.0, 1.0):
        scene.contact(rod.point([end, 0, 0]), FLOOR, restitution=0.5)
    known = [0.64103632169303933128, 1.2409040201275986246, 1.5749070372799699291, 1.7375674836079165588]
    known += [1.8793369123272908185, 2.0177115609066259625, 2.0956274372547271600, 2.1488623088916303346]
    run = solve(scene, known[-1] + 1e-6)
    yield Answer("strikes at", run.events.times("impact"), known)


@contact(
    "two balls in line",
    row="rocking, landing, ladders, cradles",
    hard="momentum lost",
    source="reference n_two_balls_line, 25 digits",
)
def two_balls(solve: Solve) -> Answers:
    """Newton's law of impact."""
    scene = Scene()
    one = scene.add(Particle(1.0), position=[0, 0, 0], velocity=[2, 0, 0])
    two = scene.add(Particle(2.5), position=[3, 0, 0], velocity=[-0.5, 0, 0])
    scene.contact(one.sphere(0.25), two.sphere(0.375), restitution=0.8)
    run = solve(scene, 2.0)
    yield Answer("meet at", run.events.times("impact"), [0.95])
    velocities = [run[one].velocity(2.0)[0], run[two].velocity(2.0)[0]]
    yield Answer("velocities", velocities, [-1.2142857142857143650, 0.78571428571428574601])


@contact(
    "Newton's cradle with gaps",
    row="rocking, landing, ladders, cradles",
    hard="the order of impacts",
    source="reference n_newton_cradle, 25 digits",
    error=1e-6,
)
def cradle(solve: Solve) -> Answers:
    """Three balls a millionth of a metre apart strike one after the other."""
    gap, r = 9.5367431640625e-7, 0.0625
    scene = Scene(gravity=[0, -G, 0])
    bob = RigidBody(0.5, [0, 0, 0], com=[0, -1, 0])
    balls = [scene.add(bob, Revolute(Z, at=[k * (2 * r + gap), 0, 0]), angle=-0.5 if k == 0 else 0.0) for k in range(3)]
    for a, b in zip(balls[:-1], balls[1:], strict=True):
        scene.contact(a.sphere(r, [0, -1, 0]), b.sphere(r, [0, -1, 0]), restitution=1.0)
    known = [0.50940268968431735772, 0.50940330496546829228, 1.5282086835709993369, 1.5282092988520321968]
    run = solve(scene, known[-1] + 0.1)
    yield Answer("strike at", run.events.times("impact"), known)


@contact(
    "table on four legs",
    row="a contact redundant in its reactions",
    hard="a singular matrix",
)
def table(solve: Solve) -> Answers:
    """It stands; the forces together are its weight."""
    scene = Scene(gravity=[0, 0, -G])
    top = scene.add(shapes.box(3.0, [2, 1, 0.5]), Free(), position=[0, 0, 0.25])
    legs = [scene.contact(top.point([x, y, -0.25]), Plane(Z)) for x in (-1.0, 1.0) for y in (-0.5, 0.5)]
    run = solve(scene, 2.0)
    yield Answer("forces", sum(run[leg].force(1.0)[2] for leg in legs), 3 * G)
    # of a table of 2 m
    yield Answer("place", run[top].position(2.0), [0, 0, 0.25], scale=2.0)
    yield kinds(run)


@case(
    "Painleve's rod",
    subject="Friction and rails",
    row="Painleve's rod",
    hard="no motion satisfies the laws, or two do",
    source="reference n_painleve_rod, 25 digits",
    error=1e-5,
    holds=TAYLOR,
)
def painleve(solve: Solve) -> Answers:
    """It slides until there is no solution, and the run says so at that instant; with less friction it leaves."""
    for mu, until in ((1.75, 1.0), (1.5, 0.2)):
        angle, rate = 0.5, 2.0
        arm = 0.5 * np.array([math.cos(angle), math.sin(angle)])
        velocity = [-20.0 - rate * arm[1], rate * arm[0]]
        scene = Scene(gravity=[0, -G, 0])
        rod = scene.add(
            shapes.rod(1.0, 1.0, along=[1, 0, 0]),
            Planar(x=[1, 0, 0], y=[0, 1, 0]),
            position=arm,
            velocity=velocity,
            angle=angle,
            rate=rate,
        )
        touch = scene.contact(rod.point([-0.5, 0, 0]), FLOOR, friction=Coulomb(mu))
        if mu == 1.5:
            run = solve(scene, until)
            yield Answer("leaves the floor at", run.events.times("detach", touch)[:1], [0.15892501891056741148])
        else:
            run, why = solve.ending(scene, until, rtol=1e-12)
            # the approach is that of a root: times beside it are a thousand times the local error
            yield Answer("ends at", run.end, 0.097412234670931449645, given=1e-4)
            yield says(f"{run.status}: {why}", "inconsistent", "Painleve")
