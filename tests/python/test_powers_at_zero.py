"""What rests where a force |x|^r, r > 0, is zero stays there; what something else moves leaves that place in time."""

import math

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp

ENGINES = [engine for engine in rb.engines() if engine != "closed form"]

LAWS = {
    "|x|^1.5": lambda x: -(abs(x) ** 1.5),
    "|x|^2.5": lambda x: -(abs(x) ** 2.5),
    "x sqrt|x|": lambda x: -x * np.sqrt(abs(x)),
    "sign(x) sqrt|x|": lambda x: -np.sign(x) * np.sqrt(abs(x)),
    "sqrt(x^2) x": lambda x: -np.sqrt(x * x) * x,
}


def slide(law, place):
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Prismatic([1, 0, 0]), displacement=place)
    scene.apply(rb.JointForce(lambda t, q, rate: law(q - place)), body)
    return scene, lambda run, t: run[body].displacement(t)


def hinge_on_a_hinge(law, place):
    """The second one turns with the first."""
    scene = rb.Scene()
    arm = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Revolute([0, 1, 0]), rate=1.0)
    body = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Revolute([0, 1, 0]), parent=arm, angle=place)
    scene.apply(rb.JointTorque(lambda t, q, rate: law(q - place)), body)
    return scene, lambda run, t: run[body].angle(t)


def equations(law, place):
    """Beside a variable that grows."""
    system = rb.System(lambda t, x: [x[1], law(x[0] - place), x[2]], [place, 0.0, 1.0])
    return system, lambda run, t: run.x(t)[0]


def pair(law, place):
    scene = rb.Scene()
    one, other = (scene.add(rb.Particle(1.0), position=[x, 1, 0]) for x in (0.0, 1.0 + place))
    scene.connect(rb.Central(lambda distance: law(distance - 1.0 - place)), one, other)
    return scene, lambda run, t: run[other].position(t)[0] - 1.0


@pytest.mark.parametrize("engine", [*ENGINES, "auto"])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("made", [slide, hinge_on_a_hinge, equations, pair])
def test_what_rests_there_stays(made, law, engine):
    for place in (0.0, 1.0):
        scene, coordinate = made(LAWS[law], place)
        try:
            run = rb.simulate(scene, until=1.0, error=1e-6, engine=engine)
        except rb.IntegrationError as problem:
            # its slope is infinite there, which a Jacobian has and which is told
            assert engine == "cvode-bdf" and "sqrt|x|" in law
            assert "not finite" in str(problem)
            continue
        assert run.status == "reached end"
        assert float(np.ravel(coordinate(run, 1.0))[0]) == place
        assert run.error <= 1e-6


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("place", [0.0, 1.0, -1000.0])
def test_what_is_pulled_leaves_in_time(place, engine):
    """A force of 1 N beside it, from rest: by another method, from the place itself."""
    scene = rb.Scene(gravity=[1, 0, 0])
    ball = scene.add(rb.Particle(1.0), position=[place, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [-(abs(r[0] - place) ** 1.5), 0, 0]), ball)
    run = rb.simulate(scene, until=2.0, error=1e-6, engine=engine)
    known = solve_ivp(lambda t, x: [x[1], 1.0 - abs(x[0]) ** 1.5], (0, 2), [0, 0], "DOP853", rtol=1e-12, atol=1e-13)
    assert run[ball].position(2.0)[0] - place == pytest.approx(known.y[0, -1], abs=1e-6 * 1.5)
    assert run[ball].velocity(2.0)[0] == pytest.approx(known.y[1, -1], abs=1e-6 * 1.5)


@pytest.mark.parametrize("engine", ["auto", "dop853", "cvode-adams"])
@pytest.mark.parametrize("power", [1000, 2000, 4001, 12178])
def test_high_whole_powers_pass_zero(engine, power):
    """From the 1025th on they were no products: where the cosine passes zero, and they are nothing to every double,
    steps came to nothing. The integral of cos^n is that of a bell of width 1/sqrt(n): x(10) by quadrature."""
    start, times = 2.4115219074059344, 1e3

    def rate(t, x):
        return [-x[0] + times * np.cos((t - start) * 0.3) ** power]

    run = rb.simulate(rb.System(rate, [0.5]), 10.0, error=1e-7, engine=engine, max_steps=5000)
    t = np.linspace(0.0, 10.0, 400001)
    values = np.exp(t - 10.0) * times * np.cos((t - start) * 0.3) ** power
    exact = 0.5 * math.exp(-10.0) + np.trapezoid(values, t)
    largest = times * math.sqrt(2.0 * math.pi / power) / 0.3
    assert run.end == 10.0
    assert abs(run.x(10.0)[0] - exact) <= 1e-7 * largest
