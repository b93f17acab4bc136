"""Parallelograms of equal bars without gravity go round evenly, angle = 1 + t, and pass flat at k pi - 1; turned in
space by any rotation they are the same, though rounded numbers no longer make their bars quite alike."""

import numpy as np
import pytest
import rbdyn as rb


def turned(seed, bars):
    """A parallelogram, with a third crank if there are three, its plane turned by a random rotation."""
    rotation, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    rotation *= np.linalg.det(rotation)
    axis = rotation @ [0, 0, 1]

    def bar(length, mass):
        inertia = mass * rotation @ np.diag([0.05, 0.1, 0.1]) @ rotation.T
        return rb.RigidBody(mass, inertia, com=rotation @ [length / 2, 0, 0])

    scene = rb.Scene()
    left = scene.add(bar(1, 1.0), rb.Revolute(axis), angle=1.0, rate=1.0)
    hinge = rb.Revolute(axis, at=rotation @ [1, 0, 0])
    top = scene.add(bar(2, 2.0), hinge, parent=left, angle=-1.0, rate=-1.0)
    for along in (2.0, 0.7)[: bars - 1]:
        at = rotation @ [along, 0, 0]
        crank = scene.add(bar(1, 1.0), rb.Revolute(axis, at=at), angle=1.0, rate=1.0)
        scene.constrain(rb.Ball(), top.point(at), crank.point(rotation @ [1, 0, 0]))
    return scene, left, top


def held_against_the_truth(run, left, top, error):
    assert run.status == "reached end"
    times = np.linspace(0, 32, 101)
    assert np.abs(run[left].angle(times) - 1 - times).max() < 32 * error
    assert np.abs(run[top].angle(times) + 1 + times).max() < 32 * error
    # where constraints are all but dependent the time is known to 3e-6, the motion as asked (docs/mechanisms.md)
    assert run.events.times("singular") == pytest.approx(np.arange(1, 11) * np.pi - 1, rel=0, abs=5e-7)


@pytest.mark.parametrize("bars", [2, 3])
@pytest.mark.parametrize("seed", range(6))
def test_they_pass_flat_ten_times(seed, bars):
    scene, left, top = turned(seed, bars)
    for rtol in (1e-10, 1e-13):
        held_against_the_truth(rb.simulate(scene, until=32.0, rtol=rtol), left, top, 1e-12)


@pytest.mark.parametrize("closing", ["ball", "hinge"])
@pytest.mark.parametrize(("pivot", "error"), [((0.0, 0.0, 0.0), 1e-9), ((0.3, 0.2, 0.1), 1e-6)])
@pytest.mark.parametrize("seed", range(10))
def test_driven_ones_pass_flat_in_any_plane(seed, pivot, error, closing):
    rotation, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    rotation *= np.linalg.det(rotation)
    axis, along = rotation @ [0, 0, 1], rotation @ [1, 0, 0]

    def bar(length, mass, inertia):
        turned = inertia * rotation @ np.diag([0.6, 0.7, 1.0]) @ rotation.T
        return rb.RigidBody(mass, (turned + turned.T) / 2, com=along * length / 2)

    scene, pivot = rb.Scene(), np.array(pivot)
    left = scene.add(bar(1, 1.0, 0.1), rb.Revolute(axis, at=pivot, motion=lambda t: 0.6 + t))
    top = scene.add(bar(2, 2.0, 0.7), rb.Revolute(axis, at=along), parent=left, angle=-0.6, rate=-1.0)
    right = scene.add(bar(1, 1.0, 0.1), rb.Revolute(axis, at=pivot + 2 * along), angle=0.6, rate=1.0)
    joint = rb.Ball() if closing == "ball" else rb.Hinge(axis)
    scene.constrain(joint, top.point(2 * along), right.point(along))
    run = rb.simulate(scene, until=7.0, error=error)
    times = np.linspace(0, 7, 71)
    assert run.status == "reached end" and run.error <= error
    # opposite bars stay parallel: angles are equal
    assert np.abs(run[right].angle(times) - 0.6 - times).max() < 7 * error
    assert np.abs(run[top].angle(times) + 0.6 + times).max() < 7 * error
    assert run.events.times("singular") == pytest.approx(np.array([1, 2]) * np.pi - 0.6, rel=0, abs=5e-7)


@pytest.mark.parametrize("seed", range(8))
def test_driven_antiparallelograms_pass_flat_in_any_plane(seed):
    # bars 1, 2, 1, 2 crossed: tan(psi/2) = -3 tan(theta/2), by which the coupler keeps its length
    rotation, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    rotation *= np.linalg.det(rotation)
    axis, along = rotation @ [0, 0, 1], rotation @ [1, 0, 0]

    def crank_at(theta):
        return 2 * np.arctan2(-3 * np.sin(theta / 2), np.cos(theta / 2))

    def coupler_at(theta):
        return np.angle((2 + np.exp(1j * crank_at(theta)) - np.exp(1j * theta)) / 2) - theta

    body = rb.RigidBody(1.0, [0.1, 0.1, 0.1], com=along / 2)
    scene, start, h = rb.Scene(), 0.6, 1e-6
    rates = [(f(start + h) - f(start - h)) / (2 * h) for f in (coupler_at, crank_at)]
    left = scene.add(body, rb.Revolute(axis, motion=lambda t: start + t))
    hinge = rb.Revolute(axis, at=along)
    top = scene.add(body, hinge, parent=left, angle=coupler_at(start), rate=rates[0])
    right = scene.add(body, rb.Revolute(axis, at=2 * along), angle=crank_at(start), rate=rates[1])
    scene.constrain(rb.Ball(), top.point(2 * along), right.point(along))
    run = rb.simulate(scene, until=3.5, error=1e-9)
    assert run.status == "reached end"
    times = np.linspace(0, 3.5, 61)
    assert np.abs(np.exp(1j * run[right].angle(times)) - np.exp(1j * crank_at(start + times))).max() < 1e-8
