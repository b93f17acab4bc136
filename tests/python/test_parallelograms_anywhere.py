"""Parallelograms written at pivots anywhere: 0.1 + 0.7 is not 0.8, and the ground bar differs from the coupler by
rounding. Without loads cranks turn evenly for ever, angle = start + rate t, and pass flat at each whole number of half
turns; a bar that differs by more than rounding folds."""

import numpy as np
import pytest
import rbdyn as rb
from scipy.spatial.transform import Rotation


def parallelogram(crank, coupler, pivot, rotation, masses=(1.0, 1.0, 1.0), start=1.0, rate=1.0, driven=False):
    axis, along, pivot = rotation @ [0, 0, 1], rotation @ [1, 0, 0], np.asarray(pivot)

    def bar(mass, length):
        inertia = mass * length**2 * rotation @ np.diag([0.01, 0.1, 0.1]) @ rotation.T
        return rb.RigidBody(mass, (inertia + inertia.T) / 2, com=along * length / 2)

    scene = rb.Scene()
    if driven:
        joint, turns = rb.Revolute(axis, at=pivot, motion=lambda t: start + rate * t), {}
    else:
        joint, turns = rb.Revolute(axis, at=pivot), {"angle": start, "rate": rate}
    left = scene.add(bar(masses[0], crank), joint, **turns)
    hinge = rb.Revolute(axis, at=along * crank)
    top = scene.add(bar(masses[1], coupler), hinge, parent=left, angle=-start, rate=-rate)
    ground = rb.Revolute(axis, at=pivot + along * coupler)
    right = scene.add(bar(masses[2], crank), ground, angle=start, rate=rate)
    scene.constrain(rb.Ball(), top.point(along * coupler), right.point(along * crank))
    return scene, top, right


def held_against_the_truth(made, until, error, start=1.0, rate=1.0):
    scene, top, right = made
    run = rb.simulate(scene, until=until, error=error)
    assert run.status == "reached end"
    times = np.linspace(0, until, 61)
    exact = start + rate * times
    off = max(np.abs(run[right].angle(times) - exact).max(), np.abs(run[top].angle(times) + exact).max())
    assert off / (abs(rate) * until) <= max(run.error, 4e-16)
    assert run.error <= error
    turns = np.sort((start, start + rate * until)) / np.pi
    passes = (np.arange(np.ceil(turns[0]), turns[1]) * np.pi - start) / rate
    assert run.events.times("singular") == pytest.approx(np.sort(passes), rel=0, abs=5e-7)


plain, about_z = np.eye(3), Rotation.from_rotvec([0, 0, 0.5]).as_matrix()


@pytest.mark.parametrize("error", [1e-6, 1e-9])
@pytest.mark.parametrize("rotation", [plain, about_z], ids=["along x", "along 0.5 rad"])
@pytest.mark.parametrize("pivot", [(0.1, 0.2, 0), (1, 2, 0), (10.1, 0.2, 0)])
def test_pivots_need_not_be_at_the_origin(pivot, rotation, error):
    held_against_the_truth(parallelogram(0.3, 0.7, pivot, rotation), 10.0, error)


@pytest.mark.parametrize("rotation", [plain, about_z], ids=["along x", "along 0.5 rad"])
@pytest.mark.parametrize("pivot", [(0.1, 0.2, 0), (1, 2, 0)])
def test_to_the_last_digits_near_the_origin(pivot, rotation):
    held_against_the_truth(parallelogram(0.3, 0.7, pivot, rotation), 10.0, 1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_short_decimals_anywhere(seed):
    rng = np.random.default_rng(seed)
    crank, coupler = np.round(10 ** rng.uniform(-0.5, 0.5, 2), 2)
    pivot = [*np.round(rng.uniform(-1, 1, 2), 1), 0]
    start, rate, rotation = rng.uniform(0.3, 2.8), rng.choice([-1, 1]), rng.choice([plain, about_z])
    for driven in (False, True):
        made = parallelogram(crank, coupler, pivot, rotation, start=start, rate=rate, driven=driven)
        held_against_the_truth(made, 7.0, 1e-9, start, rate)


@pytest.mark.parametrize("seed", [0, 4])
def test_turned_in_space(seed):
    rng = np.random.default_rng(seed)
    crank, coupler = 10 ** rng.uniform(-0.5, 0.5, 2)
    masses = 10 ** rng.uniform(-1, 1, 3)
    rotation = Rotation.random(random_state=seed).as_matrix()
    start, rate = rng.uniform(0.3, 2.8), rng.choice([-1, 1])
    made = parallelogram(crank, coupler, rng.uniform(-1, 1, 3), rotation, masses, start, rate)
    held_against_the_truth(made, 10.0, 1e-6, start, rate)


def test_a_bar_longer_by_more_than_rounding_folds():
    bar = rb.RigidBody(1.0, [0.1, 0.1, 0.1], com=[0.15, 0, 0])
    scene = rb.Scene()
    left = scene.add(bar, rb.Revolute([0, 0, 1], at=[0.1, 0.2, 0]), angle=1.0, rate=1.0)
    top = scene.add(bar, rb.Revolute([0, 0, 1], at=[0.3, 0, 0]), parent=left, angle=-1.0, rate=-1.0)
    right = scene.add(bar, rb.Revolute([0, 0, 1], at=[0.8 + 1e-7, 0.2, 0]), angle=1.0, rate=1.0)
    scene.constrain(rb.Ball(), top.point([0.7, 0, 0]), right.point([0.3, 0, 0]))
    scene.assemble(keep=[left])
    run = rb.simulate(scene, until=4.0, error=1e-6)
    assert abs(run[right].angle(4.0) - run[left].angle(4.0)) > 0.1
