"""Rough and moving rails beside bodies that are joined: against laws written down apart (rails_by_hand.py), against the
same rail without a tree, and by what friction may do at all."""

import functools
import itertools
import math
import pickle

import numpy as np
import pytest
import rbdyn as rb
from rails_by_hand import Carriage, Hoop, Turntable, follow, g
from scipy.integrate import solve_ivp

CARRIAGES = range(6)


def swinging_hoop(friction, angle=0.8, parameter=1.0, speed=3.0, torque=None):
    scene = rb.Scene(gravity=[0, -g, 0])
    hoop = scene.add(
        rb.RigidBody(2.0, [0.3, 0.3, 0.6], com=[0, -0.7, 0]), rb.Revolute([0, 0, 1]), angle=angle, name="hoop"
    )
    circle = rb.Circle(radius=0.5, start=[0, -1, 0], toward=[1, 0, 0], center=[0, -0.7, 0])
    rail = rb.Rail(circle, friction=friction)
    bead = scene.add(rb.Particle(0.5), rail, parent=hoop, parameter=parameter, speed=speed, name="bead")
    if torque is not None:
        scene.apply(rb.JointTorque(torque), hoop)
    return scene, hoop, bead


def without(kind, events):
    return [e for e in events if e.kind != kind]


@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
def test_a_hoop_swings_as_a_pendulum_with_a_rough_bead_on_it(error):
    system = Hoop(2.0, 0.6 + 2 * 0.7**2, 0.7, 0.5, 0.5, lambda t: 9 * math.sin(2.2 * t))
    y, events = follow(system, [0.8, 1.0, 0.0, 6.0], 8.0, 0.5, 0.3)
    assert {kind for kind, _ in events} == {"stick", "slip", "reverse"}
    scene, hoop, bead = swinging_hoop(rb.Coulomb(0.5, 0.3), torque=lambda t, q, w: 9 * np.sin(2.2 * t))
    run = rb.simulate(scene, until=8.0, error=error)
    found = without("normal-zero", run.events)
    assert [e.kind for e in found] == [kind for kind, _ in events]
    assert all(e.subject == bead for e in run.events)
    assert max(abs(e.time - t) for e, (_, t) in zip(found, events, strict=True)) < max(error, 2e-12)
    assert abs(run[hoop].angle(8.0) - y[0]) < max(error, 2e-12)
    assert abs(run[bead].parameter(8.0) - y[1]) < max(error, 2e-12)
    assert run.error <= error
    # the reaction where the bead slides, and how large it is where it passes zero
    state = [run[hoop].angle(3.9), run[bead].parameter(3.9), run[hoop].rate(3.9), run[bead].speed(3.9) / 0.5]
    _, along, _, across = system.solve(3.9, state, 0.3, int(math.copysign(1, state[3])))
    psi = state[0] + state[1]
    by_hand = across * np.array([math.sin(psi), -math.cos(psi)]) + along * np.array([math.cos(psi), math.sin(psi)])
    assert np.abs(run[bead].reaction(3.9)[:2] - by_hand).max() < max(30 * error, 1e-11)
    for e in run.events:
        if e.kind == "normal-zero":
            assert np.linalg.norm(run[bead].reaction(e.time)) < 100 * max(error, 1e-13)


def turntable(plane, speed=24.2):
    """A bead on a groove of a plate, and the plate turns in a plane: three axes, the last one across it."""
    x, y, z = np.array(plane, dtype=float)
    com, point, along, by = [-1.95, -2.25], [-2.88, -2.15], [0.96, 0.28], 26.0

    def torque(t):
        return 874.0 * np.sin(5.85 * t)

    moments = np.abs(30 * x + 30 * y + 48.5 * z)
    scene = rb.Scene(gravity=-by * y)
    body = rb.RigidBody(6.7, moments, com=com[0] * x + com[1] * y)
    plate = scene.add(body, rb.Revolute(z), angle=-0.18, rate=-0.23)
    scene.apply(rb.JointTorque(lambda t, q, w: torque(t)), plate)
    groove = rb.Line(along[0] * x + along[1] * y, point=point[0] * x + point[1] * y)
    rail = rb.Rail(groove, friction=rb.Coulomb(0.8, 0.31))
    bead = scene.add(rb.Particle(1.1), rail, parent=plate, parameter=0.98, speed=speed)
    return scene, plate, bead


@functools.cache
def turntable_by_hand():
    com, point, along = np.array([-1.95, -2.25]), np.array([-2.88, -2.15]), np.array([0.96, 0.28])
    moment = 48.5 + 6.7 * np.dot(com, com)
    system = Turntable(6.7, moment, com, 1.1, point, along, 26.0, lambda t: 874.0 * math.sin(5.85 * t))
    return system.follow([-0.18, 0.98, -0.23, 24.2], 2.5, 0.31)


PLANES = {
    "across z": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "across y": [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
    "across x": [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
}


@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("plane", PLANES)
def test_a_bead_in_a_groove_of_a_plate_is_pressed_from_side_to_side(plane, error):
    """Each passage of its reaction through zero is told once, with the direction along n = b x t."""
    scene, plate, bead = turntable(PLANES[plane])
    y, events = turntable_by_hand()
    assert [kind for kind, _, _ in events].count("normal-zero") > 3
    run = rb.simulate(scene, until=2.5, error=error)
    told = [(e.kind, 1 if e.direction == "rising" else -1) for e in run.events]
    assert told == [(kind, sign) for kind, sign, _ in events]
    assert max(abs(e.time - t) for e, (_, _, t) in zip(run.events, events, strict=True)) < max(error, 5e-12)
    assert abs(run[plate].angle(2.5) - y[0]) < max(error, 5e-12)
    assert abs(run[bead].parameter(2.5) - y[1]) < 30 * max(error, 5e-12)  # it goes 40 m
    assert run.error <= error


def test_what_presses_passes_zero_from_side_to_side_in_turns():
    """It is continuous, so that each passage is the other way, later than the one before."""
    for k in range(40):
        scene, _, _ = turntable(PLANES["across z"], speed=24.0 + 0.03 * k)
        passages = [e for e in rb.simulate(scene, until=2.5, error=1e-9).events if e.kind == "normal-zero"]
        assert len(passages) > 3
        for one, other in itertools.pairwise(passages):
            assert one.direction != other.direction, k
            assert other.time - one.time > 1e-3, k


@pytest.mark.parametrize("across, normal", [([0, 1, 0], [0, 1, 0]), ([0, 0, 1], [0, 0, -1]), ([0, 1, 1], [0, 1, 1])])
def test_what_presses_a_slide_passes_zero_in_a_direction(across, normal):
    """b is z, or y where the plane has z in it, and t the axis: the plane of motion is that of x and `across`."""
    scene = rb.Scene()
    slide = rb.Prismatic([1, 0, 0], friction=rb.Coulomb(0.1))
    block = scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.1]), slide, rate=20.0)
    push = np.array(across, dtype=float)
    scene.apply(
        rb.Force(lambda t, r, v: [push[0], push[1] * np.sin(3 * t + 0.3), push[2] * np.sin(3 * t + 0.3)]), block
    )
    run = rb.simulate(scene, until=5.0, error=1e-11)
    times = (np.arange(1, 5) * np.pi - 0.3) / 3
    assert [e.kind for e in run.events] == ["normal-zero"] * 4
    assert np.abs([e.time for e in run.events] - times).max() < 1e-11
    # the reaction is -push sin(3 t + 0.3), and the cosine alternates from -1 on
    rises = np.dot(push, normal) > 0
    expected = ["rising" if rises == (k % 2 == 0) else "falling" for k in range(4)]
    assert [e.direction for e in run.events] == expected


def test_what_sticks_on_a_hoop_that_swings_does_not_creep():
    scene, hoop, bead = swinging_hoop(rb.Coulomb(0.9, 0.6), angle=0.2, parameter=0.1, speed=0.3)
    run = rb.simulate(scene, until=200.0, error=1e-9)
    (sticks,) = run.events.times("stick")
    assert [e.kind for e in run.events] == ["stick"]
    place = run[bead].parameter(sticks)
    assert all(run[bead].parameter(t) == place and run[bead].speed(t) == 0.0 for t in (10.0, 77.7, 200.0))
    # from there on it is one pendulum, which keeps its energy
    assert abs(run.energy(200.0) - run.energy(sticks)) < 1e-9 * abs(run.energy(sticks))


def governor(friction, parameter=0.7):
    """A hoop that a motion turns about its vertical diameter, ever faster and back, and a bead on it."""
    scene = rb.Scene(gravity=[0, 0, -g])
    drive = rb.Revolute([0, 0, 1], motion=lambda t: 4 * t + 2 * np.sin(t))
    hoop = scene.add(rb.shapes.ring(1.0, 0.5, [0, 1, 0]), drive)
    circle = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0])
    bead = scene.add(rb.Particle(0.5), rb.Rail(circle, friction=friction), parent=hoop, parameter=parameter)
    return scene, hoop, bead


class Turned:
    """The same bead: on a driven hoop its own law is all there is."""

    def solve(self, t, y, mu, sign):
        phi, w = y
        spin, spun = 4 + 2 * math.cos(t), -2 * math.sin(t)
        m, a = 0.5, 0.5
        outward = m * (a * w * w + g * math.cos(phi) + a * spin**2 * math.sin(phi) ** 2)
        beside = m * a * (2 * spin * w * math.cos(phi) + spun * math.sin(phi))
        pressing = math.hypot(outward, beside)
        pull = -m * g * math.sin(phi) + m * a * spin**2 * math.sin(phi) * math.cos(phi)
        along = -pull if sign == 0 else -mu * sign * pressing
        return np.array([(pull + along) / (m * a)]), along, pressing, outward

    def slip(self, t, y):
        return 0.5 * y[1]

    def rest(self, t, y):
        return np.array([y[0], 0.0])


@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
def test_a_rough_bead_on_a_hoop_that_a_motion_turns(error):
    y, events = follow(Turned(), [0.7, 0.0], 20.0, 0.125, 0.1)
    assert {kind for kind, _ in events} == {"stick", "slip", "reverse"}
    scene, hoop, bead = governor(rb.Coulomb(0.125, 0.1))
    run = rb.simulate(scene, until=20.0, error=error)
    assert [e.kind for e in run.events] == [kind for kind, _ in events]
    assert max(abs(e.time - t) for e, (_, t) in zip(run.events, events, strict=True)) < max(error, 5e-12)
    assert abs(run[bead].parameter(20.0) - y[0]) < max(error, 5e-12)
    assert run.error <= error
    # what the motion does goes into the bead and into friction
    t = np.linspace(0.5, 19.5, 11)
    turned = [run[bead].reaction(s)[:2] @ run[bead].velocity(s)[:2] for s in t]
    assert np.all(np.isfinite(turned)) and "energy" not in run.drift


def carriage(seed, drive=None, drive_rate=None):
    """Three carriages on each other, the last one held by a spring, and a bead on a rough curve of it."""
    rng = np.random.default_rng(seed)
    masses, bead, stiffness = rng.uniform(0.5, 2, 3), rng.uniform(0.3, 1.5), rng.uniform(5, 30)
    kind, radius, rise = rng.integers(3), rng.uniform(0.4, 1), rng.uniform(0.2, 1.0) / (2 * np.pi)
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    if kind == 2:
        c = rng.normal(size=(4, 3)) * np.array([1, 1, 0.3, 0.1])[:, None]
        shape = rb.Polynomial(c)

        def curve(u):
            return (
                c[0] + u * (c[1] + u * (c[2] + u * c[3])),
                c[1] + u * (2 * c[2] + 3 * u * c[3]),
                2 * c[2] + 6 * u * c[3],
            )

    else:
        rise *= kind
        shape = (
            rb.Helix(radius, 2 * np.pi * rise, start=axes[:, 0], toward=axes[:, 1])
            if kind
            else rb.Circle(radius, start=axes[:, 0], toward=axes[:, 1])
        )

        def curve(u):
            out = radius * (np.cos(u) * axes[:, 0] + np.sin(u) * axes[:, 1])
            along = radius * (np.cos(u) * axes[:, 1] - np.sin(u) * axes[:, 0])
            return out + rise * u * axes[:, 2], along + rise * axes[:, 2], -out

    dynamic = rng.uniform(0.1, 0.6)
    static = dynamic * rng.uniform(1, 1.5)
    start = rng.normal(size=6) * [0.3, 0.3, 0.3, 1, 1, 1]
    u, w = rng.normal(), 2 * rng.normal()
    scene, parts = rb.Scene(gravity=[0, 0, -g]), []
    for k in range(3):
        slide = rb.Prismatic(np.eye(3)[k])
        joined = {"parent": parts[-1]} if parts else {}
        block = rb.RigidBody(masses[k], [0.1, 0.1, 0.1])
        parts.append(scene.add(block, slide, displacement=start[k], rate=start[3 + k], **joined))
    scene.connect(rb.Spring(stiffness), parts[2], [0, 0, 0])
    rail = rb.Rail(shape, friction=rb.Coulomb(static, dynamic), **({} if drive is None else {"drive": drive}))
    speed = w * np.linalg.norm(curve(u)[1])
    parts.append(scene.add(rb.Particle(bead), rail, parent=parts[2], parameter=u, speed=speed))
    moves = () if drive is None else (lambda t: float(drive(t)), drive_rate)
    return (
        scene,
        parts,
        Carriage(masses, bead, stiffness, curve, *moves),
        [*start[:3], u, *start[3:], w],
        static,
        dynamic,
    )


@pytest.mark.parametrize("has_drive", [False, True])
def test_random_curves_on_carriages_rub_as_newtons_laws_say(has_drive):
    """In space |N| has two parts, and it depends on the friction that it makes."""
    kinds = set()
    for seed in CARRIAGES:
        drives = (lambda t: 0.5 * np.sin(3 * t), lambda t: 1.5 * math.cos(3 * t)) if has_drive else ()
        scene, parts, system, start, static, dynamic = carriage(seed, *drives)
        y, events = follow(system, start, 3.0, static, dynamic)
        run = rb.simulate(scene, until=3.0, error=1e-10)
        found = without("normal-zero", run.events)
        assert [e.kind for e in found] == [kind for kind, _ in events], seed
        assert max([abs(e.time - t) for e, (_, t) in zip(found, events, strict=True)], default=0) < 1e-10, seed
        for k in range(3):
            assert abs(run[parts[k]].displacement(3.0) - y[k]) < 1e-10, seed
        assert abs(run[parts[3]].parameter(3.0) - y[3]) < 1e-10, seed
        assert run.error <= 1e-10
        kinds |= {kind for kind, _ in events}
    assert kinds == {"stick", "slip", "reverse"}


def same(rail, until=4.0, **start):
    """A bead on a rail of the world, which needs no tree, and of what is welded to the world."""
    runs = []
    for is_tree in (False, True):
        scene = rb.Scene(gravity=[0, 0, -g])
        joined = {"parent": scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.1]), rb.Fixed())} if is_tree else {}
        bead = scene.add(rb.Particle(0.5), rail, **joined, **start)
        runs.append((rb.simulate(scene, until=until, error=1e-11), bead))
    return runs


def turning(angle):
    return lambda t: np.array(
        [[np.cos(angle(t)), -np.sin(angle(t)), 0], [np.sin(angle(t)), np.cos(angle(t)), 0], [0, 0, 1]]
    )


rough = rb.Coulomb(0.4, 0.2)
ring = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0])
line = rb.Line([1, 0, 0])
parabola = rb.Parabola(1.0, [1, 0, 0], [0, 0, 1])
RAILS = {
    "rough": (rb.Rail(ring, friction=rough), {"parameter": 0.0, "speed": 7.0}),
    "rough helix": (
        rb.Rail(rb.Helix(0.3, 0.4, [0, 0, 1], [1, 0, 0]), friction=rough),
        {"parameter": 0.0, "speed": 4.0},
    ),
    "rough spline": (
        rb.Rail(rb.Spline([[0, 0, 0], [1, 0.3, -1], [2, 0, 0], [3, -1, 1]]), friction=rough),
        {"parameter": 0.1, "speed": 0.5},
    ),
    "rough parabola": (rb.Rail(parabola, friction=rb.Coulomb(0.3)), {"parameter": 0.9, "speed": 0.0}),
    "belt": (rb.Rail(line, friction=rough, drive=1.0), {"parameter": 0.0, "speed": 0.0}),
    "belt that swings": (
        rb.Rail(parabola, friction=rough, drive=lambda t: np.sin(3 * t)),
        {"parameter": 0.9, "speed": 0.0},
    ),
    "belt that jumps": (
        rb.Rail(line, friction=rough, drive=lambda t: np.sign(1 - t) * 0.5),
        {"parameter": 0.0, "speed": 0.0},
    ),
    "turns": (rb.Rail(ring, motion=turning(lambda t: 5 * t)), {"parameter": 0.5, "speed": 0.0}),
    "turns, rough": (
        rb.Rail(ring, friction=rough, motion=turning(lambda t: 5 * t + np.sin(t))),
        {"parameter": 0.5, "speed": 0.0},
    ),
    "shakes, rough": (
        rb.Rail(ring, friction=rough, motion=lambda t: [np.sin(3 * t), 0, 0.2 * np.cos(7 * t)]),
        {"parameter": 0.5, "speed": 0.0},
    ),
}


@pytest.mark.parametrize("name", RAILS)
def test_a_rail_of_a_weld_is_one_of_the_world(name):
    rail, start = RAILS[name]
    (alone, first), (tree, second) = same(rail, **start)
    said = [[(e.kind, e.direction) for e in run.events] for run in (alone, tree)]
    assert said[0] == said[1]
    assert max([abs(a.time - b.time) for a, b in zip(alone.events, tree.events, strict=True)], default=0) < 1e-13
    asked = (
        "parameter arc_length speed tangential_force position velocity acceleration reaction reaction_frenet".split()
    )
    for t in np.linspace(0.05, alone.end - 0.05, 23):
        for what in asked:
            one, other = (np.asarray(getattr(run[bead], what)(t)) for run, bead in ((alone, first), (tree, second)))
            assert np.abs(one - other).max() < 1e-11 * max(1.0, np.abs(one).max()), (what, t)
        assert abs(alone.power(t, of=first) - tree.power(t, of=second)) < 1e-10


def test_a_rail_that_moves_on_a_body_that_moves():
    """A carriage with a line that turns in it: the bead is thrown out, and shakes the carriage."""
    scene = rb.Scene()
    cart = scene.add(rb.RigidBody(2.0, [0.1, 0.1, 0.1]), rb.Prismatic([1, 0, 0]))
    bead = scene.add(
        rb.Particle(0.5), rb.Rail(line, motion=turning(lambda t: 2 * t)), parent=cart, parameter=0.3, speed=0.1
    )
    run = rb.simulate(scene, until=2.0, error=1e-11)

    def rates(t, y):
        x, s, v, w = y
        c, n = math.cos(2 * t), math.sin(2 * t)
        # unknown: the cart's acceleration, s'', N across the line
        bent = np.array([-4 * w * n - 4 * s * c, 4 * w * c - 4 * s * n])
        a = [[2.0, 0, -n], [0.5, 0.5 * c, n], [0, 0.5 * n, -c]]
        turn = np.linalg.solve(a, [0, *(-0.5 * bent)])
        return [v, w, turn[0], turn[1]]

    y = solve_ivp(rates, (0, 2.0), [0, 0.3, 0, 0.1], method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    assert abs(run[cart].displacement(2.0) - y[0]) < 1e-11
    assert abs(run[bead].parameter(2.0) - y[1]) < 1e-11
    assert "energy" not in run.drift and run.energy(2.0) > 2 * run.energy(0.0)


def test_a_rail_whose_motion_has_a_corner_ends_the_run_by_name():
    scene = rb.Scene(gravity=[0, 0, -g])
    post = scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.1]), rb.Fixed())
    scene.add(rb.Particle(0.5), rb.Rail(ring, motion=lambda t: [np.abs(t - 1), 0, 0]), parent=post, name="pearl")
    with pytest.raises(rb.IntegrationError, match="velocity of the rail of pearl jumps") as stopped:
        rb.simulate(scene, until=2.0)
    assert stopped.value.run.status == "inconsistent" and abs(stopped.value.run.end - 1.0) < 1e-12


def body(rng):
    v = rng.uniform(0.1, 0.5, 3)
    return rb.RigidBody(rng.uniform(0.5, 2), v.sum() - v, com=rng.normal(size=3) * 0.2)


def random_tree(seed):
    """Bodies on hinges, rough ones too, balls, slides and free, and rough beads on curves of them."""
    rng = np.random.default_rng(seed)
    scene, parts, beads = rb.Scene(gravity=[0, 0, -g]), [], []
    for k in range(rng.integers(1, 4)):
        joined = {} if k == 0 or rng.random() < 0.2 else {"parent": parts[rng.integers(k)]}
        axis, at, kind = rng.normal(size=3), rng.normal(size=3) * 0.4, rng.integers(5)
        if kind == 0:
            part = scene.add(body(rng), rb.Revolute(axis, at=at), angle=rng.normal(), rate=rng.normal(), **joined)
        elif kind == 1:
            part = scene.add(body(rng), rb.Spherical(at=at), angular_velocity=rng.normal(size=3), **joined)
        elif kind == 2:
            part = scene.add(body(rng), rb.Prismatic(axis, at=at), displacement=0.2, rate=rng.normal(), **joined)
        elif kind == 3:
            pin = rb.Revolute(axis, at=at, friction=rb.Coulomb(0.3, 0.2), pin_radius=0.05)
            part = scene.add(body(rng), pin, angle=rng.normal(), rate=rng.normal(), **joined)
        else:
            part = scene.add(body(rng), rb.Free(), position=at, velocity=rng.normal(size=3))
        parts.append(part)
        scene.connect(rb.Spring(10.0, 0.2), part, rng.normal(size=3))
    for _ in range(rng.integers(1, 3)):
        mu, on = rng.uniform(0.1, 0.5), parts[rng.integers(len(parts))]
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        shape = (
            rb.Circle(0.5, axes[:, 0], axes[:, 1], center=rng.normal(size=3) * 0.3),
            rb.Helix(0.4, 0.6, axes[:, 0], axes[:, 1]),
            rb.Line(axes[:, 0]),
            rb.Parabola(0.5, axes[:, 0], axes[:, 1]),
        )[rng.integers(4)]
        rail = rb.Rail(shape, friction=rb.Coulomb(1.2 * mu, mu))
        bead = scene.add(rb.Particle(0.5), rail, parent=on, parameter=rng.normal(), speed=rng.normal())
        scene.connect(rb.Spring(20.0), bead, on)
        beads.append((bead, on, shape, mu))
    return scene, beads


@pytest.mark.parametrize("seed", range(20))
def test_friction_on_rails_of_random_trees_is_coulombs_and_takes_energy(seed):
    scene, beads = random_tree(seed)
    run = rb.simulate(scene, until=1.5, error=1e-9)
    ends = [0.0, *(e.time for e in run.events), 1.5]
    for begin, end in zip(ends[:-1], ends[1:], strict=True):
        if end - begin < 1e-9:
            continue
        t = np.linspace(begin, end, 9)[1:-1]
        assert np.all(np.diff(run.energy(t)) < 1e-11 * np.abs(run.energy(t)).max())
        for bead, on, shape, mu in beads:
            for s in t:
                tangent = run[on].rotation_matrix(s) @ shape.frenet(run[bead].parameter(s)).tangent
                along = run[bead].reaction(s) @ tangent
                pressing = np.linalg.norm(run[bead].reaction(s) - along * tangent)
                if run[bead].speed(s) == 0.0:
                    assert abs(along) <= 1.2 * mu * pressing * (1 + 1e-12)
                else:
                    assert abs(along + math.copysign(mu * pressing, run[bead].speed(s))) < 1e-12 * pressing
    # all that is gone was taken by friction, none was given


def test_a_rough_bead_in_a_loop():
    """A parallelogram: its top moves without turning, as a carriage on an arc does."""
    scene = rb.Scene(gravity=[0, -g, 0])
    bar = rb.RigidBody(1.0, [0.1, 0.1, 0.1], com=[0, -0.5, 0])
    left = scene.add(bar, rb.Revolute([0, 0, 1]), angle=0.6)
    top = scene.add(
        rb.RigidBody(1.5, [0.1, 0.1, 0.1], com=[1, 0, 0]),
        rb.Revolute([0, 0, 1], at=[0, -1, 0]),
        parent=left,
        angle=-0.6,
    )
    right = scene.add(bar, rb.Revolute([0, 0, 1], at=[2, 0, 0]), angle=0.6)
    scene.constrain(rb.Ball(), top.point([2, 0, 0]), right.point([0, -1, 0]))
    bead = scene.add(
        rb.Particle(0.7), rb.Rail(line, friction=rb.Coulomb(0.3, 0.2)), parent=top, parameter=1.0, speed=0.5
    )
    run = rb.simulate(scene, until=3.0, error=1e-10)

    class Swing:
        """theta of the bars, s of the bead on the top."""

        def solve(self, t, y, mu, sign):
            theta, _, w, _ = y
            c, n = math.cos(theta), math.sin(theta)
            way, m = np.array([c, n]), 0.7
            inertia = 2 * (0.1 + 0.25) + 1.5

            def found(side):
                # unknown: theta'', s'', N upward on the bead, f along x
                a = [
                    [inertia, 0, n, c],
                    [m * way[0], m, 0, -1],
                    [m * way[1], 0, -1, 0],
                    [0, 1, 0, 0] if sign == 0 else [0, 0, mu * sign * side, 1],
                ]
                b = [-(2 * 0.5 + 1.5) * g * n, m * n * w * w, -m * c * w * w - m * g, 0]
                return np.linalg.solve(a, b)

            x = found(1)
            if sign != 0 and x[2] < 0:
                x = found(-1)
            return x[:2], x[3], abs(x[2]), x[2]

        def slip(self, t, y):
            return y[3]

        def rest(self, t, y):
            return np.array([*y[:3], 0.0])

    y, events = follow(Swing(), [0.6, 1.0, 0.0, 0.5], 3.0, 0.3, 0.2)
    found = without("normal-zero", run.events)
    assert [e.kind for e in found] == [kind for kind, _ in events] and len(events) > 2
    assert max(abs(e.time - t) for e, (_, t) in zip(found, events, strict=True)) < 1e-9
    assert abs(run[left].angle(3.0) - y[0]) < 1e-9 and abs(run[bead].parameter(3.0) - y[1]) < 1e-9


def test_effects_plans_files_pickles_and_numbers(tmp_path):
    scene, hoop, bead = swinging_hoop(rb.Coulomb(0.5, 0.3))
    run = rb.simulate(scene, until=2.0, error=1e-9)
    assert {"dynamic friction", "static friction"} <= set(run.plan.effects)
    assert any("rate of the rail of bead" in line for line in run.plan.guards)
    bare, _, _ = swinging_hoop(None)
    smooth = scene.without("dynamic friction", "static friction")
    assert rb.plan(smooth).effects == rb.plan(bare).effects and "energy" in rb.simulate(smooth, until=0.1).drift
    one, other = (rb.simulate(s, until=2.0, error=1e-9) for s in (smooth, bare))
    assert one[bead].parameter(2.0) == other[bare.bodies[1]].parameter(2.0)
    assert "dynamic friction" in str(rb.effects(scene, until=1.0, error=1e-9))
    rb.save(scene, tmp_path / "scene.json")
    again = rb.load(tmp_path / "scene.json")
    assert rb.simulate(again, until=2.0, error=1e-9)[again.bodies[1]].parameter(2.0) == run[bead].parameter(2.0)
    copy = pickle.loads(pickle.dumps(run))
    assert copy[bead].parameter(1.5) == run[bead].parameter(1.5)
    mu = rb.parameter(0.3)
    varied, _, pearl = swinging_hoop(rb.Coulomb(0.5, mu))
    assert abs(rb.simulate(varied, until=2.0, error=1e-9)[pearl].parameter(2.0) - run[bead].parameter(2.0)) < 1e-9
    mu.value = 0.1
    less, _, fresh = swinging_hoop(rb.Coulomb(0.5, 0.1))
    assert (
        abs(
            rb.simulate(varied, until=2.0, error=1e-9)[pearl].parameter(2.0)
            - rb.simulate(less, until=2.0, error=1e-9)[fresh].parameter(2.0)
        )
        < 1e-9
    )


def test_an_action_gives_a_bead_that_sticks_a_new_speed():
    scene, hoop, bead = swinging_hoop(rb.Coulomb(0.9, 0.6), angle=0.2, parameter=0.1, speed=0.3)
    scene.watch("later", lambda now: now.time - 3.0, action=lambda now: {bead: {"speed": 1.0}})
    run = rb.simulate(scene, until=6.0, error=1e-9)
    assert [e.kind for e in run.events] == ["stick", "watch", "slip", "stick"]
    (kick,) = run.events.times("later")
    assert run[bead].speed(kick, side="before") == 0.0 and abs(run[bead].speed(kick) - 1.0) < 1e-15


def test_rest_with_friction_on_a_rail_of_a_body_is_refused_by_name():
    scene, _, _ = swinging_hoop(rb.Coulomb(0.5, 0.3))
    with pytest.raises(rb.InvalidInput, match="friction on the rail of bead"):
        rb.equilibria(scene)
