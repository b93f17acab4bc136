"""Long chains against SciPy: springs of a length in space, and stiff ones by implicit steps in a band."""

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp

N = 24
START = np.array([[1.0 * i, 0.02 * (i % 3), 0.01 * (i % 2)] for i in range(N)])
KICK = np.array([0.3, 0.4, 0.2])


def springs(stiff):
    return [
        (1e6, 1e6) if stiff and i % 2 == 0 else (1.0 if stiff else 30.0, 1.0 if stiff else 0.0) for i in range(N - 1)
    ]


def chain(stiff):
    scene = rb.Scene()
    bodies = []
    for i in range(N):
        velocity = KICK if i == 0 else np.zeros(3)
        bodies.append(scene.add(rb.Particle(mass=1.0), position=START[i], velocity=velocity))
    for i, (stiffness, damping) in enumerate(springs(stiff)):
        scene.connect(rb.Spring(stiffness=stiffness, damping=damping, rest_length=1.0), bodies[i], bodies[i + 1])
    return scene, bodies


def truth(stiff, until):
    k, d = np.array(springs(stiff)).T

    def rate(_, y):
        x, v = y.reshape(2, N, 3)
        along, relative = np.diff(x, axis=0), np.diff(v, axis=0)
        length = np.linalg.norm(along, axis=1)
        unit = along / length[:, None]
        pull = (k * (length - 1.0) + d * np.einsum("ij,ij->i", relative, unit))[:, None] * unit
        force = np.zeros((N, 3))
        force[:-1] += pull
        force[1:] -= pull
        return np.concatenate([v.ravel(), force.ravel()])

    start = np.concatenate([START.ravel(), np.vstack([KICK, np.zeros((N - 1, 3))]).ravel()])
    if stiff:
        beside = np.abs(np.subtract.outer(np.arange(N), np.arange(N))) <= 1
        pattern = np.kron(np.ones((2, 2)), np.kron(beside, np.ones((3, 3))))
        how = {"method": "Radau", "rtol": 1e-8, "atol": 1e-10, "jac_sparsity": pattern}
    else:
        how = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14}
    y = solve_ivp(rate, (0.0, until), start, **how).y[:, -1]
    return y.reshape(2, N, 3)[0]


def test_a_chain_in_space_moves_as_scipy_says():
    scene, bodies = chain(stiff=False)
    until, error = 1.5, 1e-9
    run = rb.simulate(scene, until, error=error)
    expected = truth(False, until)
    moved = np.linalg.norm(expected - START, axis=1).max()
    for i, body in enumerate(bodies):
        assert np.linalg.norm(run[body].position(until) - expected[i]) <= error * moved + 1e-14 * N


@pytest.mark.parametrize("masses", [24, 30, 100])
def test_masses_that_hardly_move_are_asked_for_no_more_than_rounding_leaves_them(masses):
    # at 30 m a place rounds to 4e-15 m, which a spring of 100 N/m makes some 5e-14 m/s of in a tenth of a second; the
    # last of these masses have no velocity of which that is 1e-9
    scene, last = rb.Scene(), None
    for i in range(masses):
        body = scene.add(rb.Particle(1.0), position=[float(i), 0, 0], velocity=[0, 0, 0] if i else [0.3, 0.4, 0.2])
        if last is not None:
            scene.connect(rb.Spring(100.0, rest_length=1.0), last, body)
        last = body
    for error in (1e-8, 1e-9, 1e-10):
        run = rb.simulate(scene, 1.0, error=error, keep="end")
        assert run.error <= error
        assert run.statistics.runs == 2


@pytest.mark.skipif("cvode-bdf" not in rb.engines(), reason="a build without SUNDIALS")
def test_a_stiff_chain_by_implicit_steps_moves_as_scipy_says():
    scene, bodies = chain(stiff=True)
    until, error = 0.01, 1e-5
    expected = truth(True, until)
    moved = np.linalg.norm(expected - START, axis=1).max()
    for engine in ("cvode-bdf", "auto"):
        run = rb.simulate(scene, until, error=error, engine=engine, keep="end")
        assert "cvode-bdf" in run.engine, engine
        # stability would ask a series for some 1e4 steps: |lambda| is 4e6 / s
        assert run.statistics.steps < 1000, engine
        for i, body in enumerate(bodies):
            assert np.linalg.norm(run[body].position(until) - expected[i]) <= error * moved, (engine, i)


def test_springs_that_have_hardly_begun_to_move_cut_no_steps():
    """Far from the held end masses still fall as one: what their springs change by, from 1e-40 m on, is nothing yet."""
    scene, before = rb.Scene(gravity=[0, 0, -9.81]), [0, 0, 0]
    for i in range(30):
        mass = scene.add(rb.Particle(0.1), position=[0.1 * (i + 1), 0, 0])
        scene.connect(rb.Spring(100.0, rest_length=0.1), mass, before)
        before = mass
    work = rb.simulate(scene, 1.0, rtol=1e-8, engine="dop853", keep="end").statistics
    # one look at each of 30 springs a step
    assert work.guard_evaluations <= 1.2 * 30 * work.steps
