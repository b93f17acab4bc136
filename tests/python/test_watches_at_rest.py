"""Watched functions that pass zero where what they watch strikes and stays: once, whatever rounding leaves of them."""

import itertools
import math

import pytest
import rbdyn as rb

LENGTH, RATE = 0.796875, 0.390625
UNITS = list(itertools.product((1.0, 1e16, 1e-7, 1e8), (1.0, 1e4, 1e-13), (1e9, 1e-5)))


def bar_at_a_wall(units, side, swings):
    """A bar on a spring that comes back down to where it began, at a wall without restitution. `swings`: beside one
    that goes on swinging, on a spring that presses the bar on its wall."""
    length, time, mass = units
    moment = mass * length**2
    scene = rb.Scene(gravity=[0, -9.8125 * length / time**2, 0])

    def bar(x, **start):
        inertia = LENGTH**2 / 12 * moment
        body = rb.RigidBody(mass, [inertia / 2, inertia / 2, inertia], com=[0, -LENGTH / 2 * length, 0])
        return scene.add(body, rb.Revolute([0, 0, 1], at=[x * length, 0, 0]), **start)

    one = bar(0, angle=0.0, rate=side * RATE / time)
    scene.watch("down", lambda now: now[one].angle)
    scene.apply(rb.TorsionSpring(2.0 * moment / time**2), one)
    scene.contact(one.point([0, -LENGTH * length, 0]), rb.Plane([side, 0, 0]))
    if swings:
        other = bar(side * 5, angle=side * 0.5)
        scene.connect(rb.Spring(1e-3 * mass / time**2, rest_length=10 * length), one, other)
    return scene, 2.0 * time


def passed(run):
    return [(str(e.direction), e.time) for e in run.events if e.name == "down"]


@pytest.mark.parametrize("swings", [False, True])
@pytest.mark.parametrize("side", [1, -1])
def test_what_strikes_at_zero_and_stays_passes_it_once(side, swings):
    for units in UNITS:
        scene, until = bar_at_a_wall(units, side, swings)
        run = rb.simulate(scene, until, error=1e-9)
        (lands,) = run.events.times("land")
        # half a period of the small swing, all but the cube of its size
        stiffness, inertia = 2.0 + 9.8125 * LENGTH / 2, LENGTH**2 / 3
        assert abs(lands / units[1] - math.pi * math.sqrt(inertia / stiffness)) < 0.01
        assert passed(run) == [("falling" if side > 0 else "rising", lands)], units


@pytest.mark.parametrize("swings", [False, True])
def test_nor_does_a_run_that_goes_on(swings, tmp_path):
    for units in UNITS[::5]:
        scene, until = bar_at_a_wall(units, 1, swings)
        run = rb.simulate(scene, until, error=1e-9)
        run.save(tmp_path / "run.npz")
        assert len(passed(run)) == 1
        for half in (run, rb.load(tmp_path / "run.npz")):
            assert passed(rb.simulate(half, 2 * until)) == [], units


@pytest.mark.parametrize("restitution", [0.0, 0.25])
def test_what_turns_back_there_passes_back_and_forth(restitution):
    """Pulled off its wall again, or thrown back."""
    scene = rb.Scene(gravity=[0, -9.8125, 0])
    body = rb.RigidBody(1.0, [0.05, 0.05, 0.1], com=[0, -0.5, 0])
    one = scene.add(body, rb.Revolute([0, 0, 1]), rate=0.5)
    scene.watch("down", lambda now: now[one].angle)
    scene.contact(one.point([0, -1, 0]), rb.Plane([1, 0, 0]), restitution=restitution)
    other = scene.add(body, rb.Revolute([0, 0, 1], at=[5, 0, 0]), angle=0.5)
    scene.connect(rb.Spring(0.5, rest_length=1.0), one, other)
    run = rb.simulate(scene, 2.0, error=1e-9)
    directions = [direction for direction, _ in passed(run)]
    assert len(directions) >= 2
    assert all(a != b for a, b in itertools.pairwise(directions))
