"""Estimates of a body on a hinge that turns by little, and mechanisms that close from far guesses.

Truths: the series of a pendulum's equation about its start, and gaps of what is assembled.
"""

import math

import numpy as np
import pytest
import rbdyn as rb


@pytest.mark.parametrize("engine", ["cvode-adams", "cvode-bdf", "dop853", "taylor"])
@pytest.mark.parametrize(("gravity", "until"), [(9.8125, 1e-3), (1e-2, 1.0), (1e-4, 1.0)])
@pytest.mark.parametrize("angle", [1.0, 3.0, 1000.0])
def test_how_far_a_hinge_has_turned_is_told_by_how_far_it_does(engine, gravity, until, angle):
    """Its angle was measured by a radian: all of its way was wrong, and 4e-6 told.

    theta = theta0 - k sin(theta0) t^2 / 2 + k^2 sin(2 theta0) t^4 / 48 - .., k = m g c / J.
    """
    c, inertia, mass = 0.8, 0.3, 1.5
    k = mass * gravity * c / (inertia + mass * c * c)
    turn = -k * math.sin(angle) * until**2 / 2 + k * k * math.sin(2 * angle) * until**4 / 48
    scene = rb.Scene(gravity=[0, -gravity, 0])
    body = scene.add(rb.RigidBody(mass, [inertia] * 3, com=[0, -c, 0]), rb.Revolute([0, 0, 1]), angle=angle)
    for error in (1e-3, 1e-5):
        run = rb.simulate(scene, until, error=error, engine=engine)
        off = abs(run[body].angle(until) - angle - turn)
        # the series is cut off, and the angle rounded
        assert off <= 2 * run.error * abs(turn) + (k * until**2) ** 3 + 4 * np.spacing(angle)


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e3])
@pytest.mark.parametrize("seed", range(8))
def test_what_closes_near_its_guesses_is_closed_in_any_unit(seed, unit):
    """Steps of the search turned by as many radians as the scene had metres: attitudes were no numbers then."""
    rng = np.random.default_rng(seed)
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, [1, 1, 1]), position=rng.uniform(-20, 20, 3) * unit)
    child = scene.add(
        rb.RigidBody(1.0, [1, 1, 1]), rb.Spherical(at=rng.uniform(-1, 1, 3) * unit, point=[0, 0, 0]), parent=body
    )
    far = rng.uniform(-1, 1, 3)
    length = abs(np.linalg.norm(far) + rng.uniform(-0.4, 0.4)) + 0.3
    rod = scene.constrain(rb.Rod(length * unit), body.point(far * unit), child.point(rng.uniform(-1, 1, 3) * unit))
    try:
        scene.assemble()
    except rb.InvalidInput as refused:
        assert "no start near the guesses" in str(refused)
        return
    run = rb.simulate(scene, 0.01)
    assert run[rod].gap(0.0) <= 1e-12 * unit


@pytest.mark.parametrize("engine", ["cvode-adams", "cvode-bdf", "dop853", "taylor"])
@pytest.mark.parametrize("turn", [1e-1, 1e-3, 1e-6])
@pytest.mark.parametrize("error", [1e-4, 1e-7])
def test_an_attitude_that_hardly_changes_is_told_by_how_far_its_body_turns(engine, turn, error):
    """A free body with equal moments turns about an axis that stays, R = exp([w] t), and its centre of mass goes
    straight. Its axes were measured by a radian, and CVODE told 9e-11 of a turn of 5e-6 rad that was 7e-7 of it off."""
    until, com = 5.0, np.array([0.3, 0.1, -0.2])
    omega = turn / until * np.array([0.3, -0.5, 0.7]) / np.linalg.norm([0.3, -0.5, 0.7])
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(0.5, [0.02, 0.02, 0.02], com=com), angular_velocity=omega)
    run = rb.simulate(scene, until, error=error, engine=engine)
    for t in np.linspace(0.0, until, 11)[1:]:
        w = omega * t
        angle = np.linalg.norm(w)
        x, y, z = w / angle
        k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        # 1 - cos by its half, for angles whose cosine is 1
        attitude = np.eye(3) + math.sin(angle) * k + 2 * math.sin(angle / 2) ** 2 * k @ k
        axes = run[body].rotation_matrix(t)
        assert np.linalg.norm(axes - attitude) <= 2 * run.error * turn + 1e-15
        way = run[body].center_of_mass(t) - com
        assert np.linalg.norm(way - np.cross(omega, com) * t) <= 2 * run.error * turn + 1e-15


@pytest.mark.parametrize("error", [1e-4, 1e-6])
def test_a_light_damped_mass_is_known_by_cvode_bdf_as_well_as_told(error):
    """It was held against series, of as many steps as stability asks for: 20 to 30 s at a thousandth of this mass."""

    def scene():
        scene = rb.Scene(gravity=[0, 0, -9.81])
        heavy = scene.add(rb.Particle(1.0), position=[1, 0.1, 0], velocity=[0, 1, 0])
        light = scene.add(rb.Particle(1e-3), position=[2, 0.1, 0.1])
        scene.connect(rb.Spring(30.0, rest_length=1.0, damping=1.0), heavy, [0, 0, 0])
        scene.connect(rb.Spring(30.0, rest_length=1.0, damping=5.0), light, heavy)
        return scene, heavy, light

    stiff, *bodies = scene()
    run = rb.simulate(stiff, 2.0, error=error, engine="cvode-bdf")
    fine, *others = scene()
    truth = rb.simulate(fine, 2.0, error=1e-10, engine="taylor")
    for t in np.linspace(0.0, 2.0, 21):
        for body, other in zip(bodies, others, strict=True):
            off = np.linalg.norm(run[body].position(t) - truth[other].position(t))
            assert off <= 2 * run.error * 2.0
