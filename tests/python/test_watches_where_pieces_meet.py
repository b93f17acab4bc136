"""Watched functions that pass zero just where a mode ends or two steps meet: once, whatever is left by rounding."""

import numpy as np
import pytest
import rbdyn as rb


def two_bars(seed):
    """Straight down, and moving so that the tip stays on a wall that it touches: they come back to be straight, where
    nothing presses the tip any more. Both angles pass zero at that instant, by the symmetry of the motion in time."""
    random = np.random.default_rng(seed)
    lengths, rate = random.uniform(0.5, 1, 2), random.uniform(0.25, 2) * random.choice([-1, 1])
    scene = rb.Scene(gravity=[0, -9.81, 0])
    upper, lower = (rb.RigidBody(1.0, [s * s / 24, s * s / 24, s * s / 12], com=[0, -s / 2, 0]) for s in lengths)
    one = scene.add(upper, rb.Revolute([0, 0, 1]), rate=rate)
    at = [0, -lengths[0], 0]
    two = scene.add(lower, rb.Revolute([0, 0, 1], at=at), rate=-rate * lengths.sum() / lengths[1], parent=one)
    scene.watch("upper", lambda now: now[one].angle)
    scene.watch("lower", lambda now: now[two].angle)
    scene.contact(two.point([0, -lengths[1], 0]), rb.Plane([1, 0, 0]))
    return scene, rate


def test_what_passes_as_a_contact_opens_passes_once():
    opened = 0
    for seed in range(40):
        scene, rate = two_bars(seed)
        run = rb.simulate(scene, 0.8, error=1e-9)
        for end in run.events.times("detach"):
            now = [(e.name, str(e.direction)) for e in run.events if e.kind == "watch" and abs(e.time - end) < 1e-7]
            back, forth = ("falling", "rising") if rate > 0 else ("rising", "falling")
            assert sorted(now) == sorted([("upper", back), ("lower", forth)]), seed
            opened += 1
    assert opened > 15


def four_bar():
    """A crank that turns fast enough never to turn back."""
    scene = rb.Scene(gravity=[0, -1, 0])
    bars = [rb.RigidBody(1.0, [0.1, 0.1, 0.1], com=[s / 2, 0, 0]) for s in (1.0, 3.0, 2.5)]
    crank = scene.add(bars[0], rb.Revolute([0, 0, 1]), angle=1.0, rate=9.0)
    coupler = scene.add(bars[1], rb.Revolute([0, 0, 1], at=[1, 0, 0]), parent=crank, angle=-0.5)
    rocker = scene.add(bars[2], rb.Revolute([0, 0, 1], at=[3, 0, 0]), angle=1.8)
    scene.constrain(rb.Ball(), coupler.point([3.0, 0, 0]), rocker.point([2.5, 0, 0]))
    scene.assemble()
    return scene, crank


def between_steps(rtol):
    """A run, and where the crank is before and after two steps meet: each is a little off, and begins with no gap."""
    scene, crank = four_bar()
    run = rb.simulate(scene, 2.0, rtol=rtol, engine="taylor")
    assert run[crank].rate(run.t).min() > 0
    meet = run.t[1:-1]
    return run, [[run[crank].angle(t, side=side) for t in meet] for side in ("before", "after")]


@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-5, 1e-6, 1e-7])
def test_what_passes_where_two_steps_meet_passes_once(rtol):
    run, (before, after) = between_steps(rtol)
    assert (np.array(after) < before).sum() > 5
    scene, crank = four_bar()
    middles = np.add(before, after) / 2
    for k, middle in enumerate(middles):
        scene.watch(str(k), lambda now, middle=float(middle): now[crank].angle - middle)
    again = rb.simulate(scene, 2.0, rtol=rtol, engine="taylor")
    assert np.array_equal(again.t, run.t)
    passes = [(event.name, str(event.direction)) for event in again.events]
    assert sorted(passes) == sorted((str(k), "rising") for k in range(len(middles)))
