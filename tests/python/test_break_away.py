"""What breaks away in space at a friction that does not fall, against equations written down apart.

A particle on a rough plane is held against a force that turns as it grows. Where it breaks away its slip begins without
an acceleration, and its direction turns from the first moment on. m u' = F - mu N u/|u| is integrated by an implicit
method (SciPy's Radau), which needs no series, from the first terms of the slip a little later.
"""

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp

GRAVITY, MASS = 9.8125, 1.0
LOADS = {
    "linear and square": lambda t: [3.0 * t, 0.5 * t + t * t],
    "a turning one": lambda t: [2.0 * t, 0.8 * t * t],
    "fast": lambda t: [38.0 * t, 2.0 * t + 90.0 * t * t],
}


def slid(load, mu, t0, until):
    """Velocities at times, by hand."""

    def force(t):
        return np.array(load(t))

    def rate(t, u):
        return (force(t) - mu * MASS * GRAVITY * u / np.linalg.norm(u)) / MASS

    along = force(t0) / np.linalg.norm(force(t0))
    across = np.array([-along[1], along[0]])
    h = 1e-4
    slope = (force(t0 + h) - force(t0 - h)) / (2 * h)
    # u = (F'.d) t^2 / (2 m) along d, which turns by (F'.b) / (mu N) a second
    first = 3e-5
    start = slope @ along * first**2 / (2 * MASS) * (along + across * first * (slope @ across) / (mu * MASS * GRAVITY))
    return solve_ivp(rate, (t0 + first, until), start, method="Radau", rtol=1e-10, atol=1e-15, dense_output=True).sol


@pytest.mark.parametrize("name", LOADS)
def test_its_direction_turns_as_the_equations_say(name):
    load, mu = LOADS[name], 0.4
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    particle = scene.add(rb.Particle(MASS), position=[1, 2, 0])
    contact = scene.contact(particle, rb.Plane([0, 0, 1]), friction=rb.Coulomb(mu))
    scene.apply(rb.Force(lambda t, x, v: [*load(t), 0.0]), particle)
    run = rb.simulate(scene, 2.0, error=1e-10)
    (t0,) = run.events.times("slip")
    assert abs(np.linalg.norm(load(t0)) - mu * MASS * GRAVITY) < 1e-11
    exact = slid(load, mu, t0, 2.0)
    for t in t0 + np.array([0.003, 0.01, 0.1, 0.3]):
        u = exact(t)
        assert np.linalg.norm(run[particle].velocity(t)[:2] - u) < 1e-7 * np.linalg.norm(u) + 1e-12
        force = run[contact].force(t)
        assert abs(np.hypot(*force[:2]) - mu * force[2]) < 1e-9
    assert run.statistics.steps < 500


def test_in_every_direction_alike():
    """Seen from a turned frame the motion is the same, so the turn is no artefact of the axes."""
    ways = []
    for turn in (0.0, 0.7, 2.5):
        c, s = np.cos(turn), np.sin(turn)
        scene = rb.Scene(gravity=[0, 0, -GRAVITY])
        particle = scene.add(rb.Particle(MASS), position=[1, 2, 0])
        scene.contact(particle, rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.4))

        def force(t, x, v, c=c, s=s):
            a, b = 3.0 * t, 0.5 * t + t * t
            return [c * a - s * b, s * a + c * b, 0.0]

        scene.apply(rb.Force(force), particle)
        u = rb.simulate(scene, 2.0, error=1e-10)[particle].velocity(2.0)
        ways.append([c * u[0] + s * u[1], c * u[1] - s * u[0]])
    assert np.ptp(ways, axis=0).max() < 2e-10


def test_it_is_tried_again_from_each_rest():
    """A load that comes, goes and comes in another direction: it slides, stops, and breaks away once more."""
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    particle = scene.add(rb.Particle(MASS), position=[1, 2, 0])
    contact = scene.contact(particle, rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.4))
    scene.apply(
        rb.Force(lambda t, x, v: [4.2 * np.sin(t) ** 2, 0.5 * np.sin(2 * t) + 0.3 * t * np.sin(t), 0.0]), particle
    )
    run = rb.simulate(scene, 8.0, error=1e-8)
    kinds = [e.kind for e in run.events]
    assert kinds.count("slip") >= 2 and kinds.count("slip") - kinds.count("stick") in (0, 1)
    for t in np.linspace(0, 8, 161):
        force = run[contact].force(t)
        assert np.hypot(*force[:2]) <= 0.4 * force[2] * (1 + 1e-9)
        if run[contact].state(t) == "slides":
            assert force[:2] @ run[particle].velocity(t)[:2] <= 0.0


@pytest.mark.parametrize("load", [lambda t: [3.0 * t, 0.5 * t + t * t], lambda t: [3.0 * t, 0.5 * t]])
def test_at_the_point_its_surface_is_given_by(load):
    """There nothing has a size: a run broke away at speeds of 1e-263, and was refused for it."""
    places = []
    for start in ([1, 2, 0], [0, 0, 0]):
        scene = rb.Scene(gravity=[0, 0, -GRAVITY])
        particle = scene.add(rb.Particle(MASS), position=start)
        scene.contact(particle, rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.4))
        scene.apply(rb.Force(lambda t, x, v: [*load(t), 0.0]), particle)
        places.append(rb.simulate(scene, 2.0, error=1e-10)[particle].position(2.0) - start)
    assert abs(places[1] - places[0]).max() < 1e-10 < abs(places[0]).max()


@pytest.mark.parametrize("over", [1e-12, 1e-10, 1e-8, 1e-5])
def test_a_cone_that_is_barely_passed_along_a_line(over):
    """Pushed along x by mu N + over - 2 (t - 1)^2: it slips at 1 - a and stops at 1 + 2 a, a = sqrt(over / 2)."""
    scene = rb.Scene(gravity=[0, 0, -10.0])
    block = scene.add(rb.Particle(1.0))
    scene.contact(block, rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.5))
    scene.apply(rb.Force(lambda t, *_: [5 - 2 * (t - 1) ** 2 + over, 0, 0]), block)
    # of what it is pushed by more than it is held by, 1e-15 N is rounding
    run = rb.simulate(scene, 2.5, rtol=1e-9) if over < 1e-10 else rb.simulate(scene, 2.5, error=1e-2)
    a = np.sqrt(over / 2)
    # the force is rounded to 1e-15 N, which is a time of 1e-15 / (4 a)
    assert abs(run.events.times("slip")[0] - (1 - a)) < 1e-15 / a + 1e-14
    assert abs(run.events.times("stick")[0] - (1 + 2 * a)) < 4e-15 / a + 1e-13
    assert not run[block].velocity(2.5).any()
