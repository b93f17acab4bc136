"""Drag that grows with the square of the speed, where speed begins: |v| v at rest, with friction.

A norm that is zero begins with some power of time: the first where what breaks away is accelerated, the second where it
breaks away at the edge of its cone. Truth: closed forms of one-dimensional motion, and equations written down apart,
integrated by SciPy from the first terms of the slip a little later.
"""

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

G, K = 9.81, 0.2


def loads(kind):
    own = rb.Force(lambda t, p, v: -K * np.linalg.norm(v) * v)
    return {"drag": rb.Drag(quadratic=K), "own": own}[kind]


@pytest.mark.parametrize("kind", ["drag", "own"])
@pytest.mark.parametrize("place", [[0, 0, 0], [3, -2, 0]])
@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_pulled_from_rest_beyond_the_cone(kind, place, turn):
    scene = rb.Scene(gravity=[0, 0, -G])
    particle = scene.add(rb.Particle(1.0), position=place)
    scene.contact(particle, rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.3))
    scene.apply(loads(kind), particle)
    along = np.array([np.cos(turn), np.sin(turn), 0])
    scene.apply(rb.Force(6 * along), particle)
    run = rb.simulate(scene, 4.0, error=1e-8)
    pull = 6 - 0.3 * G
    way = np.log(np.cosh(np.sqrt(pull * K) * 4)) / K
    assert np.abs(run[particle].position(4.0) - place - way * along).max() < 1e-8 * way


def broken_away(force, mu_static, t_end, quadratic):
    """Slip's time, and position and velocity at the end, of unit mass with mu = 0.3."""
    t0 = brentq(lambda t: np.hypot(*force(t)) - mu_static * G, 0.1, 1.5, xtol=1e-15)

    def rate(t, y):
        u = y[2:]
        s = np.hypot(*u)
        return [*u, *(np.array(force(t)) - 0.3 * G * u / s - quadratic * s * u)]

    d = np.array(force(t0)) / np.hypot(*force(t0))
    h, first = 1e-5, 3e-5
    slope = (np.array(force(t0 + h)) - np.array(force(t0 - h))) / (2 * h)
    if mu_static > 0.3:
        first = 1e-8
        u = d * (mu_static - 0.3) * G * first
    else:
        across = np.array([-d[1], d[0]])
        u = slope @ d * first**2 / 2 * (d + across * first * (slope @ across) / (0.3 * G))
    y = solve_ivp(rate, (t0 + first, t_end), [0, 0, *u], method="Radau", rtol=1e-10, atol=1e-13).y[:, -1]
    return t0, y


@pytest.mark.parametrize("kind", ["drag", "own"])
@pytest.mark.parametrize("mu_static", [0.3, 0.4])
@pytest.mark.parametrize(
    "pull",
    [
        lambda t: [6 * np.sin(t), 0 * t],
        lambda t: [5 * np.sin(t), 3 * np.sin(t)],
        lambda t: [6 * np.sin(t), 2 * np.sin(0.7 * t)],
    ],
    ids=["along an axis", "oblique", "turning"],
)
def test_breaking_away_from_a_plane(kind, mu_static, pull):
    scene = rb.Scene(gravity=[0, 0, -G])
    particle = scene.add(rb.Particle(1.0))
    scene.contact(particle, rb.Plane([0, 0, 1]), friction=rb.Coulomb(mu_static, 0.3))
    scene.apply(loads(kind), particle)
    scene.apply(rb.Force(lambda t, p, v: [*pull(t), 0.0]), particle)
    run = rb.simulate(scene, 2.0, error=1e-9)
    t0, y = broken_away(pull, mu_static, 2.0, K)
    assert abs(run.events.times("slip")[0] - t0) < 1e-11
    assert np.abs(run[particle].position(2.0)[:2] - y[:2]).max() < 2e-7
    assert np.abs(run[particle].velocity(2.0)[:2] - y[2:]).max() < 2e-7


def test_a_bead_on_a_bend_with_equal_coefficients():
    """SciPy's DOP853 on the same equation, written by hand: slip and stop."""
    times = []
    for kind in ("drag", "own"):
        scene = rb.Scene(gravity=[0, 0, -G])
        rail = rb.Rail(rb.Curve(lambda u: [u, 0 * u, 0.2 * u * u]), friction=rb.Coulomb(0.3))
        bead = scene.add(rb.Particle(1.0), rail, parameter=0.3)
        scene.apply(loads(kind), bead)
        scene.apply(rb.Force(lambda t, p, v: [6 * np.sin(t), 0.0, 0.0]), bead)
        run = rb.simulate(scene, 2.5, error=1e-9)
        assert [e.kind for e in run.events][:2] == ["slip", "stick"]
        times.append([e.time for e in run.events][:2])
    assert np.abs(np.array(times) - [0.792832979221481, 2.3210864967]).max() < 2e-9


@pytest.mark.parametrize("kind", ["drag", "own"])
@pytest.mark.parametrize("mu_static", [0.3, 0.4])
def test_a_slide_with_friction_and_drag(kind, mu_static):
    scene = rb.Scene(gravity=[0, 0, -G])
    slide = rb.Prismatic([1, 0, 0], friction=rb.Coulomb(mu_static, 0.3))
    block = scene.add(rb.RigidBody(1.0, [0.1] * 3), slide)
    scene.apply(loads(kind), block)
    scene.apply(rb.Force(lambda t, p, v: [6 * np.sin(t), 0, 0]), block)
    run = rb.simulate(scene, 2.0, error=1e-9)
    t0, y = broken_away(lambda t: [6 * np.sin(t), 0 * t], mu_static, 2.0, K)
    assert abs(run.events.times("slip")[0] - t0) < 1e-11
    assert abs(run[block].displacement(2.0) - y[0]) < 2e-7


@pytest.mark.parametrize("kind", ["drag", "own"])
def test_a_hinge_with_equal_coefficients(kind):
    """A lever on a rough pin; what presses the pin is what its centre of mass is accelerated by, less what acts."""
    inertia, arm, radius, mu = 0.1, 0.3, 0.3, 0.3
    scene = rb.Scene(gravity=[0, -G, 0])
    hinge = rb.Revolute([0, 0, 1], friction=rb.Coulomb(mu), pin_radius=radius)
    lever = scene.add(rb.RigidBody(1.0, [inertia] * 3, com=[arm, 0, 0]), hinge, angle=0.4)
    scene.apply(loads(kind), lever)
    scene.apply(rb.JointTorque(lambda t, q, w: 2.5 + 3 * t), lever)
    run = rb.simulate(scene, 1.2, error=1e-9)

    def pressing(q, w, wd):
        out, across = np.array([np.cos(q), np.sin(q)]), np.array([-np.sin(q), np.cos(q)])
        return np.hypot(*(arm * wd * across - arm * w**2 * out + [0, G] + K * arm**2 * abs(w) * w * across))

    def law(t, y):
        q, w = y
        torque = 2.5 + 3 * t - G * arm * np.cos(q) - K * arm**3 * abs(w) * w
        over = lambda wd: (inertia + arm**2) * wd - torque + mu * radius * pressing(q, w, wd)  # noqa: E731
        return [w, brentq(over, -1e-6, 1e3, xtol=1e-15)]

    t0 = (G * arm * np.cos(0.4) + mu * radius * G - 2.5) / 3
    assert abs(run.events.times("slip")[0] - t0) < 1e-11
    exact = solve_ivp(law, (t0 + 1e-9, 1.2), [0.4, 0.0], method="RK45", rtol=1e-10, atol=1e-12).y[:, -1]
    assert np.abs([run[lever].angle(1.2) - exact[0], run[lever].rate(1.2) - exact[1]]).max() < 1e-6
