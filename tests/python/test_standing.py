"""What stands still stays to the bit, as long as what holds it does, whatever acts on it in time; and what only seems
to, moves. Against closed forms.
"""

import math

import numpy as np
import pytest
import rbdyn as rb
from planar_scenes import random_scene

G = 9.8125


def upward(tilt):
    return np.array([0.0, 0.0, 1.0]) if tilt is None else np.array(tilt) / np.linalg.norm(tilt)


def stack(up, masses, friction=None, radius=0.1):
    """Balls above each other on a floor, under weight."""
    scene = rb.Scene(gravity=-G * up)
    balls, touch = [], []
    for i, m in enumerate(masses):
        balls.append(scene.add(rb.shapes.sphere(m, radius), position=(2 * i + 1) * radius * up))
        below = rb.Plane(up) if i == 0 else balls[i - 1].sphere(radius)
        touch.append(scene.contact(balls[i].sphere(radius), below, friction=friction))
    return scene, balls, touch


def box_on_a_floor(m=2.0, half=(0.2, 0.1), **at):
    scene = rb.Scene(gravity=[0, -G, 0])
    b, h = half
    box = scene.add(rb.RigidBody(m, [0.1] * 3), rb.Planar([1, 0, 0], [0, 1, 0]), position=[0, h], **at)
    corners = [scene.contact(box.point([x, -h, 0]), rb.Plane([0, 1, 0])) for x in (-b, b)]
    return scene, box, corners


@pytest.mark.parametrize("seed", [4669, 6961])
def test_a_rod_that_has_come_to_rest_in_a_corner_has_no_acceleration_and_stays(seed):
    """Floor and wall hold all that it could do; what is left after its bounces was a rounding, and grew."""
    scene, bodies, _ = random_scene(seed, rough=False).scene()
    run, later = rb.simulate(scene, 1.5, rtol=1e-12), rb.simulate(scene, 1e5, rtol=1e-12)
    for body in bodies:
        assert not run[body].acceleration(1.5).any() and not run[body].angular_acceleration(1.5).any()
        assert (later[body].position(1e5) == later[body].position(1.5)).all()
        assert later[body].angle(1e5) == later[body].angle(1.5)
        assert np.abs(later[body].position(1e5) - run[body].position(1.5)).max() < 1e-14


@pytest.mark.parametrize("friction", [None, rb.Coulomb(0.5)])
@pytest.mark.parametrize("tilt", [None, [1, 2, 3], [-2, 1, 5]])
def test_a_stack_that_is_pressed_in_time_stays_to_the_bit(tilt, friction):
    up = upward(tilt)
    scene, balls, touch = stack(up, [1.0, 2.0, 3.0, 4.0], friction)
    scene.apply(rb.Force(lambda t, *_: [-(5 + 4 * np.sin(3 * t)) * u for u in up]), balls[-1])
    start = [(2 * i + 1) * 0.1 * up for i in range(4)]
    for until, options in ((20.0, {}), (20.0, {"rtol": 1e-9}), (2000.0, {"rtol": 1e-9})):
        run = rb.simulate(scene, until, **options)
        assert not len(run.events)
        for ball, place in zip(balls, start, strict=True):
            # a start is put on its surfaces, to rounding
            assert (run[ball].position(until) == run[ball].position(0.0)).all()
            assert np.abs(run[ball].position(0.0) - place).max() < 2e-16
            assert not run[ball].velocity(until).any() and not run[ball].acceleration(until).any()
    t, above = 1.3, 0.0
    for contact, m in zip(touch[::-1], [4.0, 3.0, 2.0, 1.0], strict=True):
        above += m * G
        assert np.abs(run[contact].force(t) - (above + 5 + 4 * math.sin(3 * t)) * up).max() < 1e-12 * above


@pytest.mark.parametrize("tilt", [None, [1, 2, 3]])
@pytest.mark.parametrize("seed", range(4))
def test_a_stack_is_left_where_nothing_presses_its_top_any_more(tilt, seed):
    """Lifted by k t + a sin(w t): the top goes where the weight is reached, as its equation says."""
    draw = np.random.default_rng(seed)
    up, m, k, a, w = upward(tilt), draw.uniform(0.5, 3), draw.uniform(1, 5), draw.uniform(0.1, 0.5), draw.uniform(1, 2)
    scene, balls, touch = stack(up, [1.0, 2.0, m])
    scene.apply(rb.Force(lambda t, *_: [(k * t + a * np.sin(w * t)) * u for u in up]), balls[-1])

    def force(t):
        return k * t + a * math.sin(w * t) - m * G

    low, high = 0.0, m * G / k + 1.0
    while (middle := 0.5 * (low + high)) not in (low, high):
        low, high = (middle, high) if force(middle) < 0 else (low, middle)
    t0 = low
    # askew, what is left of the stack stands on the rounding of its places, and falls a million times that far in 1 s
    run = rb.simulate(scene, t0 + 1.0, **({} if tilt is None else {"rtol": 1e-12}))
    (leaves,) = run.events
    assert leaves.kind == "detach" and leaves.subject == touch[2]
    assert abs(leaves.time - t0) < 1e-13 * t0
    # twice the integral of (k t + a sin(w t)) / m - g from t0 on
    s, t1 = 1.0, t0 + 1.0
    way = (
        k * (t0 * s**2 / 2 + s**3 / 6)
        + a * (math.cos(w * t0) * s / w - (math.sin(w * t1) - math.sin(w * t0)) / w**2)
        - m * G * s**2 / 2
    ) / m
    assert abs(run[touch[2]].gap(t1) - way) < 1e-9 * way
    for ball in balls[:2]:
        assert (run[ball].position(0.9 * t0) == run[ball].position(0.0)).all()
        assert np.abs(run[ball].position(t1) - run[ball].position(0.0)).max() < (1e-16 if tilt is None else 1e-11)


@pytest.mark.parametrize("name", ["power", "bell", "step", "resonance", "small"])
def test_a_force_that_moves_it_later_moves_it(name):
    """Along the floor, beside one that presses: hidden at the start behind all powers that a series has."""
    force, way = {
        "power": (lambda t: t**30, 4.0**32 / (31 * 32)),
        # of area 1/100 about t = 2
        "bell": (lambda t: np.exp(-((100 * (t - 2)) ** 2)) / math.sqrt(math.pi), 0.02),
        "step": (lambda t: np.where(t > 3, 2.0, 0.0), 1.0),
        # 4 - t = 2 - (t - 2), of which the second part is odd about it
        "resonance": (lambda t: 1e-6 / (1e-8 + (t - 2) ** 2), 0.04 * math.atan(2e4)),
        "small": (lambda t: 1e-5 * t, 1e-5 * 4.0**3 / 6),
    }[name]
    scene, box, _ = box_on_a_floor(m=1.0)
    scene.apply(rb.Force(lambda t, *_: [force(t), -3 - np.sin(t), 0]), box)
    run = rb.simulate(scene, 4.0)
    assert abs(run[box].position(4.0)[0] - way) < 1e-9 * way
    assert abs(run[box].position(4.0)[1] - 0.1) < 1e-15


def test_a_box_that_is_pressed_beside_its_middle_tips_where_its_corner_is_free():
    """At x from the middle, inside of the corner at b: never; outside, where F (x - b) is the weight's moment."""
    m, b, x, k = 2.0, 0.2, 0.3, 8.0
    scene, box, (left, right) = box_on_a_floor(m)
    scene.apply(rb.Force(lambda t, *_: [0, -k * t, 0]), box, at=[x, 0, 0])
    t0 = m * G * b / (k * (x - b))
    run = rb.simulate(scene, t0 + 0.1)
    (tips,) = run.events
    assert tips.kind == "detach" and tips.subject == left and abs(tips.time - t0) < 1e-14 * t0
    assert run[box].angle(t0 / 2) == 0.0 and (run[box].position(0.9 * t0) == [0, 0.1, 0]).all()
    assert run[right].gap(run.end) == pytest.approx(0, abs=1e-15) and run[box].angle(run.end) < 0


def test_a_table_on_four_legs_that_is_pressed_in_time_stays():
    scene = rb.Scene(gravity=[0, 0, -G])
    table = scene.add(rb.RigidBody(3.0, [0.2, 0.2, 0.3]), position=[0, 0, 0.5])
    legs = [scene.contact(table.point([x, y, -0.5]), rb.Plane([0, 0, 1])) for x in (-0.4, 0.4) for y in (-0.3, 0.3)]
    scene.apply(rb.Force(lambda t, *_: [0, 0, -9 - 8 * np.cos(2 * t)]), table, at=[0.1, 0.05, 0])
    run = rb.simulate(scene, 50.0)
    assert not len(run.events) and (run[table].position(50.0) == [0, 0, 0.5]).all()
    assert (run[table].rotation_matrix(50.0) == np.eye(3)).all()
    total = sum(run[leg].force(7.0) for leg in legs)
    assert np.abs(total - [0, 0, 3 * G + 9 + 8 * math.cos(14)]).max() < 1e-12 * 3 * G


def test_what_is_carried_by_a_driven_plate_does_not_stand():
    scene = rb.Scene(gravity=[0, 0, -G])
    plate = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Prismatic([0, 0, 1], motion=lambda t: 0.1 * t**3))
    ball = scene.add(rb.shapes.sphere(1.0, 0.1), position=[0, 0, 0.1])
    scene.contact(ball.sphere(0.1), plate.plane([0, 0, 1]))
    run = rb.simulate(scene, 2.0)
    assert abs(run[ball].position(2.0)[2] - 0.9) < 1e-12


def smooth_stack(draw, tilt, is_pressed):
    """Boxes of decimal sizes, each on both ends of what it shares with the one below, smooth, perhaps pressed in time.

    What each end bears follows from moments, from the top down: at a load `top` on the uppermost box."""
    up, along = np.array([-math.sin(tilt), math.cos(tilt), 0.0]), np.array([math.cos(tilt), math.sin(tilt), 0.0])
    scene, boxes, touch, ends = rb.Scene(gravity=-G * up), [], [], []
    x = height = 0.0
    for k in range(int(draw.integers(2, 5))):
        w, h, m = (
            round(draw.uniform(0.2, 1.0), 2),
            round(draw.uniform(0.1, 0.6), 2),
            round(10 ** draw.uniform(-1, 1.5), 2),
        )
        x = 0.0 if k == 0 else round(x + draw.uniform(-0.3, 0.3) * w, 3)
        place = x * along + (height + h / 2) * up
        box = scene.add(rb.shapes.box(m, [w, h, 0.3]), rb.Planar([1, 0, 0], [0, 1, 0]), position=place[:2], angle=tilt)
        height += h
        ends.append([])
        for side in (-1, 1):
            corner = box.point([side * w / 2, -h / 2, 0])
            mine = x + side * w / 2
            if k == 0:
                touch.append(scene.contact(corner, rb.Plane(up)))
                ends[k].append(mine)
                continue
            below, x0, w0, h0, _ = boxes[k - 1]
            theirs = x0 + side * w0 / 2
            if side * mine <= side * theirs:
                touch.append(scene.contact(corner, below.plane([0, 1, 0], [0, h0 / 2, 0])))
            else:
                surface = box.plane([0, -1, 0], [0, -h / 2, 0])
                touch.append(scene.contact(below.point([side * w0 / 2, h0 / 2, 0]), surface))
            ends[k].append(min(side * mine, side * theirs) * side)
        boxes.append((box, x, w, h, m))
    a, w = (round(draw.uniform(1, 50), 1), round(draw.uniform(0.5, 5), 1)) if is_pressed else (0.0, 1.0)
    if is_pressed:
        scene.apply(rb.Force(lambda t, *_: [-a * (1 + np.sin(w * t)) * u for u in up]), boxes[-1][0])

    def bears(top):
        forces, acts = [], [(boxes[-1][1], top)]
        for (_, x, _, _, m), (left, right) in zip(boxes[::-1], ends[::-1], strict=True):
            acts = [*acts, (x, m * G)]
            on_right = sum(f * (at - left) for at, f in acts) / (right - left)
            on_left = sum(f for _, f in acts) - on_right
            acts = [(left, on_left), (right, on_right)]
            forces = [on_left, on_right, *forces]
        return np.array(forces)

    return scene, [box for box, *_ in boxes], touch, bears, a


@pytest.mark.parametrize("is_pressed", [False, True])
@pytest.mark.parametrize("is_askew", [False, True])
def test_a_smooth_stack_stays_to_the_bit_where_statics_says_that_it_stands_and_tips_where_not(is_askew, is_pressed):
    """Nothing holds it along the floor, and nothing pushes it: what its places are rounded by does not, for 1e5 s."""
    stands = tips = 0
    for seed in range(50):
        draw = np.random.default_rng([seed, is_askew, is_pressed])
        tilt = draw.uniform(-3, 3) if is_askew else 0.0
        scene, boxes, touch, bears, a = smooth_stack(draw, tilt, is_pressed)
        least = min(bears(0.0).min(), bears(2 * a).min())
        if least > 0:
            until = 2e3 if is_pressed else 1e5
            for options in ({}, {"rtol": 1e-12}):
                run = rb.simulate(scene, until, **options)
                assert not len(run.events)
                for box in boxes:
                    assert (run[box].position(until) == run[box].position(0.0)).all(), seed
                    assert run[box].angle(until) == run[box].angle(0.0), seed
            forces = [np.linalg.norm(run[c].force(0.0)) for c in touch]
            assert np.abs(forces - bears(a)).max() < 1e-12 * bears(a).max(), seed
            stands += 1
        elif bears(a).min() < 0:
            run = rb.simulate(scene, 0.1, rtol=1e-12)
            assert max(abs(run[box].angle(0.1) - run[box].angle(0.0)) for box in boxes) > 1e-3 * 0.1, seed
            tips += 1
    assert stands > 30 and tips > 2


@pytest.mark.parametrize("slope", [1e-13, 1e-12, 1e-10])
def test_a_smooth_stack_slides_down_the_least_slope_that_is_no_rounding(slope):
    scene, boxes, *_ = smooth_stack(np.random.default_rng(1), 0.0, False)
    scene.gravity = [slope * G, -G, 0]
    run = rb.simulate(scene, 0.25, rtol=1e-12)
    for box in boxes:
        way = run[box].position(0.25)[0] - run[box].position(0.0)[0]
        assert way == pytest.approx(0.5 * slope * G * 0.0625, rel=1e-2)


def test_a_force_that_comes_later_moves_one_box_of_a_smooth_stack():
    scene = rb.Scene(gravity=[0, -9.81, 0])
    boxes = []
    for k in range(2):
        box = scene.add(
            rb.shapes.box(1.0 + k, [0.4, 0.2, 0.3]),
            rb.Planar([1, 0, 0], [0, 1, 0]),
            position=[0.027 * k, 0.1 + 0.2 * k],
        )
        below = boxes[-1].plane([0, 1, 0], [0, 0.1, 0]) if k else rb.Plane([0, 1, 0])
        for x in (-0.2, 0.2):
            scene.contact(box.point([x, -0.1, 0]), below)
        boxes.append(box)
    scene.apply(rb.Force(lambda t, *_: [np.where(t > 3, 0.125 * (t - 3), 0.0), 0, 0]), boxes[1])
    run = rb.simulate(scene, 4.0, rtol=1e-12)
    assert all((run[box].position(3.0) == run[box].position(0.0)).all() for box in boxes)
    # the integral of t / 16 twice
    assert abs(run[boxes[1]].position(4.0)[0] - 0.027 - 1 / 96) < 1e-14
    assert abs(run[boxes[0]].position(4.0)[0]) < 1e-14


def feet_of(scene, body, corners, friction=None, up=(0, 0, 1)):
    return [scene.contact(body.point(c), rb.Plane(up), friction=friction) for c in corners]


@pytest.mark.parametrize("feet", [3, 4, 5])
def test_a_plan_names_the_feet_whose_forces_the_motion_does_not_determine(feet):
    """Three feet of a table bear what they must; of more, all that depend on each other are named, and none of what
    else stands there on as many as it needs."""
    angle = 2 * np.pi * np.arange(feet) / feet
    corners = np.column_stack([0.3 * np.cos(angle), 0.3 * np.sin(angle), np.full(feet, -0.5)])
    scene = rb.Scene(gravity=[0, 0, -G])
    table = scene.add(rb.RigidBody(5.0, [1.0, 1.1, 0.7]), position=[0, 0, 0.5])
    stool = scene.add(rb.RigidBody(5.0, [1.0, 1.1, 0.7]), position=[3, 0, 0.5])
    touch = feet_of(scene, table, corners)
    others = feet_of(scene, stool, [[0.2, 0, -0.5], [-0.1, 0.2, -0.5], [-0.1, -0.2, -0.5]])
    names = rb.plan(scene).not_unique
    assert len(names) == (0 if feet == 3 else feet)
    run = rb.simulate(scene, 1.0)
    assert run.plan.not_unique == names and all(name in str(run.plan) for name in names)
    assert sum(run[c].force(0.5)[2] for c in touch) == pytest.approx(5.0 * G, rel=1e-13)
    # a point in the middle of a triangle, by its barycentric coordinates
    assert [run[c].force(0.5)[2] for c in others] == pytest.approx([5.0 * G / 3] * 3, rel=1e-13)


def test_what_friction_holds_twice_is_named_and_what_slides_is_not():
    """A box on two rough feet that hold: their forces along the floor may be any that cancel. Where it slides, each is
    one only."""
    for speed, expected in ((0.0, 2), (1.0, 0)):
        scene = rb.Scene(gravity=[0, -G, 0])
        box = scene.add(
            rb.RigidBody(2.0, [0.1] * 3), rb.Planar([1, 0, 0], [0, 1, 0]), position=[0, 0.1], velocity=[speed, 0]
        )
        for x in (-0.2, 0.2):
            scene.contact(box.point([x, -0.1, 0]), rb.Plane([0, 1, 0]), friction=rb.Coulomb(0.5))
        assert len(rb.plan(scene).not_unique) == expected


def test_starts_elsewhere_are_named_anew():
    """A table that is let go above its floor stands on nothing yet."""
    scene = rb.Scene(gravity=[0, 0, -G])
    table = scene.add(rb.RigidBody(5.0, [1.0, 1.1, 0.7]), position=[0, 0, 0.5])
    feet_of(scene, table, [[x, y, -0.5] for x in (-0.3, 0.3) for y in (-0.2, 0.2)])
    assert len(rb.plan(scene).not_unique) == 4
    run = rb.simulate(scene, 0.1, initial={(table, "position"): [0, 0, 1.5]})
    assert run.plan.not_unique == []


def test_what_is_shaken_and_stands_is_followed_as_long_as_asked():
    """Steps of what does not move are no steps to and fro that lead nowhere."""
    scene = rb.Scene(gravity=[0, 0, -G])
    box = scene.add(rb.shapes.box(3.1, [0.1, 0.1, 0.02]), position=[0, 0, 0.01])
    for x, y in [(-0.05, -0.05), (0.05, -0.05), (0, 0.05)]:
        scene.contact(box.point([x, y, -0.01]), rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.6))
    push = 0.2 * 3.1 * G
    scene.apply(rb.Force(lambda t, r, v: [push * np.sin(150.0 * t), 0.0 * t, 0.0 * t]), box)
    run = rb.simulate(scene, 1e6, rtol=1e-9, keep="end", max_steps=4000)
    # a step limit that is small beside what is left ends the run where it is reached, not after a thousand steps
    assert run.status == "step limit" and run.statistics.steps == 4000
    assert np.abs(run[box].position(run.end) - [0, 0, 0.01]).max() < 1e-15
