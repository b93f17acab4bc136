"""Steps of DOP853 where rounding, and lengths that stay away from zero, would make them short or dear."""

import numpy as np
import pytest
import rbdyn as rb
from rbdyn.verification.linkages import andrews
from scipy.integrate import solve_ivp

KNOWN = [15.810771195153708748, 0.040822240119645808436, 0.52440996587995403119, 1.0480807410419378362]


def steps_and_error(rtol):
    """Of Andrews' mechanism, whose angles are known to 20 digits."""
    found = {}

    def solve(scene, until, **options):
        found["run"] = run = rb.simulate(scene, until, engine="dop853", rtol=rtol, max_steps=100_000)
        return run

    angles = next(iter(andrews(solve))).ours
    return found["run"].statistics.steps, np.abs(np.array(angles) - KNOWN).max()


def test_rounding_where_slopes_are_solved_for_makes_no_steps_short():
    """Five of seven bars begin with accelerations that are zero but for what 1.4e4 rad/s^2 beside them leave: 5e-11.

    Their rates are 1e-15 rad/s then, and an error of a part of those is asked for. Looked at from one other state
    nearby, that rounding is 1e-9 or 1e-21: at rtol = 1e-10 the run took 10,063 steps, at 1e-9 245, at 1e-15 all
    that max_steps allows.
    """
    steps, errors = zip(*[steps_and_error(rtol) for rtol in (1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-14)], strict=True)
    assert all(after < 2 * before for before, after in zip(steps, steps[1:], strict=False))
    assert steps[-1] < 1000
    assert errors[0] < 1e-7 and errors[2] < 1e-9 and errors[4] < 1e-11


def chain(count, unit, pull=0.0):
    scene = rb.Scene(gravity=[0, 0, -9.8125 * unit])
    last = [0, 0, 0]
    masses = []
    for i in range(count):
        masses.append(scene.add(rb.Particle(0.1), position=[0.1 * (i + 1) * unit, 0, 0.01 * i * unit]))
        scene.connect(rb.Spring(100.0, rest_length=0.1 * unit), masses[-1], last)
        last = masses[-1]
    return scene, masses


@pytest.mark.parametrize("engine", ["dop853", "cvode-adams"])
@pytest.mark.parametrize("unit", [1.0, 1e-6, 1e6])
def test_springs_that_keep_their_length_cost_no_guards(engine, unit):
    scene, masses = chain(6, unit)
    run = rb.simulate(scene, 0.6, engine=engine, rtol=1e-8)
    assert run.statistics.guard_evaluations == 0
    truth = rb.simulate(scene, 0.6, engine="taylor", rtol=1e-13)
    for mass in masses:
        apart = run[mass].position(0.6) - truth[mass].position(0.6)
        assert np.abs(apart).max() < 1e-6 * unit


@pytest.mark.parametrize("engine", ["dop853", "cvode-adams", "taylor"])
@pytest.mark.parametrize("unit", [1.0, 1e-6, 1e6])
@pytest.mark.parametrize("aside", [0.0, 1e-12, 1e-9, 1e-3])
def test_a_spring_whose_ends_meet_is_found_to_do_so(engine, unit, aside):
    """A mass that a spring of length l pulls on, thrown from 2 l at its other end: it passes that, or beside it.

    Beside it by less than the rounding of what the series has of its length, the guard saw it there, and the run ended
    as not finite.
    """
    # x - l = A cos(w t + p) until it is at -l, then x + l the same the other way
    length, k, m, v = 0.5 * unit, 40.0, 0.7, 3.0 * unit
    w = np.sqrt(k / m)
    scene = rb.Scene()
    mass = scene.add(rb.Particle(m), position=[2 * length, aside * unit, 0], velocity=[-v, 0, 0])
    scene.connect(rb.Spring(k, rest_length=length), mass, [0, 0, 0])
    amplitude, phase = np.hypot(length, v / w), np.arctan2(v / w, length)
    meets = (np.arccos(-length / amplitude) - phase) / w
    until = 1.5 * meets
    run = rb.simulate(scene, until, engine=engine, rtol=1e-10)
    place = run[mass].position(until)
    if aside < 1e-6:
        after, speed = until - meets, amplitude * w * np.sin(w * meets + phase)
        x = -length + length * np.cos(w * after) - speed / w * np.sin(w * after)
        # of the turn in between, which takes less than 1e-9 s, the first order of CVODE sees the less
        known = (1e-6 if engine == "cvode-adams" else 2e-8) * unit
        assert place[0] == pytest.approx(x, abs=known) and abs(place[1]) < 100 * aside * unit + known
    else:

        def rates(_, state):
            r = state[:2]
            far = np.linalg.norm(r)
            return [*state[2:], *(-k / m * (far - length) / far * r)]

        begin = [2 * length, aside * unit, -v, 0.0]
        truth = solve_ivp(rates, [0, until], begin, method="DOP853", rtol=1e-12, atol=1e-14 * unit)
        assert np.abs(place[:2] - truth.y[:2, -1]).max() < 1e-6 * unit
    kinetic = 0.5 * m * v**2 + 0.5 * k * (np.hypot(2 * length, aside * unit) - length) ** 2
    assert run.energy(until) == pytest.approx(kinetic, rel=1e-6)
