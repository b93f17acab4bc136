"""Absolute values, larger and smaller ones and distinctions within each other: every event, and the force they make."""

import random

import numpy as np
import pytest
import rbdyn as rb


def function_of(draw, depth):
    """A piecewise linear function of t, made of corners and jumps within each other; and its text."""
    if depth == 0:
        slope = draw.choice([1.0, -1.0, draw.uniform(-3, 3)])
        zero = draw.uniform(0.01, 1)
        return lambda t: slope * (t - zero), f"{slope:.3g} (t - {zero:.3g})"
    kind = draw.choice(["abs", "abs", "abs", "maximum", "minimum", "sum", "sign", "where"])
    f, text = function_of(draw, depth - 1)
    if kind == "abs":
        offset, sign = draw.uniform(0, 0.6), draw.choice([1, -1])
        return lambda t: sign * np.abs(f(t)) - sign * offset, f"{sign} (|{text}| - {offset:.3g})"
    if kind == "sign":
        jump = draw.uniform(-0.6, 0.6)
        return lambda t: f(t) + jump * np.sign(f(t)), f"({text} and {jump:.3g} sign)"
    g, other = function_of(draw, draw.randrange(depth))
    if kind in ("maximum", "minimum"):
        which = getattr(np, kind)
        return lambda t: which(f(t), g(t)), f"{kind}({text}, {other})"
    if kind == "where":
        h, third = function_of(draw, draw.randrange(depth))
        return lambda t: np.where(f(t) > 0, g(t), h(t)), f"where({text}, {other}, {third})"
    return lambda t: f(t) + g(t), f"({text} + {other})"


@pytest.mark.parametrize("engine", ["auto", "taylor", "dop853"])
@pytest.mark.parametrize("seed", range(150))
def test_every_change_of_sign_is_an_event(seed, engine):
    f, text = function_of(random.Random(seed), 2 + seed % 3)
    scene = rb.Scene()
    scene.add(rb.Particle(1.0), position=[0, 0, 0], velocity=[1, 0, 0])
    scene.watch("w", lambda now: f(now.time))
    found = rb.simulate(scene, until=1.0, engine=engine).events.times("w")
    # the linear pieces are longer than these by far, but by chance
    times = np.linspace(0, 1, 100_001)
    side = np.sign(f(times))
    changes = np.nonzero(side[1:] * side[:-1] < 0)[0]
    assert len(found) == len(changes), text
    np.testing.assert_allclose(found, times[changes] + 0.5e-5, atol=0.6e-5, err_msg=text)


@pytest.mark.parametrize("engine", ["auto", "dop853", "cvode-bdf"])
@pytest.mark.parametrize("power", [0.5, 1.0, 1.5])
def test_a_force_of_one_corner_in_another_is_what_it_is(power, engine):
    scene = rb.Scene()
    body = scene.add(rb.Particle(1.0), position=[0, 0, 0], velocity=[0, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [np.abs(np.abs(t - 0.5) - 0.2) ** power, 0, 0]), body)
    run = rb.simulate(scene, until=1.0, error=1e-9, engine=engine)
    # four ramps of |t - c|^power, two of length 0.3 and two of length 0.2
    speed = 2 * (0.3 ** (power + 1) + 0.2 ** (power + 1)) / (power + 1)
    assert run[body].velocity(1.0)[0] == pytest.approx(speed, rel=1e-9)


@pytest.mark.parametrize("rtol", [10.0**-k for k in range(6, 16)] + [3e-12, 3e-13])
@pytest.mark.parametrize("engine", ["taylor", "dop853"])
def test_a_corner_within_a_distinction_by_the_same_number(rtol, engine):
    system = rb.System(lambda t, x: [3 * x[1], -3 * x[0]], [np.sin(0.3), np.cos(0.3)], names=["s", "c"])
    system.watch("w", lambda now: np.where(now["s"] > 0, abs(now["s"]), 1) - 0.01)
    run = rb.simulate(system, 5.0, rtol=rtol, engine=engine)
    # s = sin(3 t + 0.3) through 0 and through 0.01, at its rise and at its fall
    low = np.arcsin(0.01)
    phases = np.sort([k * 2 * np.pi + a for k in range(3) for a in (0.0, low, np.pi - low, np.pi)])
    times = (phases - 0.3) / 3
    assert run.events.times("w") == pytest.approx(times[(times > 0) & (times < 5)], abs=1e-4)
