"""Motions without torque: what is said of them before they are computed."""

import math

import numpy as np
import pytest
import rbdyn as rb

racket = rb.RigidBody(1.0, [1.0, 2.0, 3.0])


def test_kinds_of_motion_are_told_apart():
    kinds = {
        (0.0, 0.0, 0.0): "rest",
        (0.0, 1.5, 0.0): "permanent",
        (0.1, 1.0, 0.0): "generic",
    }
    for omega, kind in kinds.items():
        assert rb.PoinsotMotion(racket, omega).kind == kind
    # A (B - A) w1^2 = C (C - B) w3^2 exactly: 3 (1) 4 = 6 (2) 1
    assert rb.PoinsotMotion(rb.RigidBody(1.0, [3.0, 4.0, 6.0]), [2.0, 0.5, 1.0]).kind == "separatrix"
    assert rb.PoinsotMotion(rb.RigidBody(1.0, [2.0, 2.0, 1.0]), [0.5, 0.0, 3.0]).kind == "symmetric"


def test_only_the_intermediate_axis_is_unstable():
    speed = 1.5
    rates = [rb.PoinsotMotion(racket, speed * np.eye(3)[k]).growth_rate for k in range(3)]
    # w sqrt((I2 - I1)(I3 - I2) / (I1 I3))
    assert rates == pytest.approx([0.0, speed * math.sqrt(1.0 / 3.0), 0.0], abs=1e-15)
    assert math.isnan(rb.PoinsotMotion(racket, [0.1, 1.0, 0.0]).growth_rate)


def test_the_period_is_that_of_the_flips():
    assert rb.PoinsotMotion(racket, [0.1, 1.0, 0.0]).period == pytest.approx(25.510977876634716929, rel=1e-15)
    assert rb.PoinsotMotion(racket, [1e-6, 1.0, 0.0]).period == pytest.approx(105.32119394639243715, rel=1e-14)


def test_the_earth_nutates_in_293_days_and_says_nothing_of_13000_years():
    day = 86164.0
    omega = 2.0 * math.pi / day
    earth = rb.PoinsotMotion(rb.RigidBody(1.0, [0.9966, 0.9966, 1.0]), [1e-6 * omega, 0.0, omega])
    alpha = (1.0 - 0.9966) / 0.9966
    assert earth.proper_rotation_rate == pytest.approx(-alpha * omega, rel=1e-12)
    assert 2.0 * math.pi / abs(earth.proper_rotation_rate) / day == pytest.approx(293.1176, abs=1e-4)
    assert 2.0 * math.pi / earth.precession_rate / day == pytest.approx(0.9966, abs=1e-9)
    low, high = earth.tilt
    assert low == pytest.approx(high) == pytest.approx(0.9966e-6, rel=1e-9)


def test_polhode_and_herpolhode_lie_where_they_must():
    omega = np.array([0.8, 0.3, 1.1])
    motion = rb.PoinsotMotion(racket, omega)
    inside, outside = motion.polhode(100), motion.herpolhode(100)
    assert inside.shape == outside.shape == (100, 3)
    np.testing.assert_allclose(inside[0], omega, rtol=0, atol=0)
    np.testing.assert_allclose(inside[-1], omega, rtol=0, atol=2e-15)
    moments = np.array([1.0, 2.0, 3.0])
    np.testing.assert_allclose((moments * inside**2).sum(axis=1), 2.0 * motion.kinetic_energy, rtol=4e-15)
    np.testing.assert_allclose(
        np.linalg.norm(moments * inside, axis=1), np.linalg.norm(motion.angular_momentum), rtol=4e-15
    )
    # the herpolhode lies in Poinsot's plane across K
    K = motion.angular_momentum
    np.testing.assert_allclose(outside @ K / np.linalg.norm(K), motion.plane_distance, rtol=4e-15)


def test_about_a_fixed_point_its_moments_count():
    ball = rb.shapes.sphere(1.0, 0.5)
    held = rb.PoinsotMotion(ball, [0.0, 1.0, 0.5], point=[0.0, 0.0, -1.0])
    assert held.kind == "symmetric"
    assert rb.PoinsotMotion(ball, [0.0, 1.0, 0.5]).kind == "permanent"


def test_what_has_no_period_asks_for_a_time():
    with pytest.raises(rb.InvalidInput, match="until"):
        rb.PoinsotMotion(racket, [0.0, 1.0, 0.0]).polhode()
    assert len(rb.PoinsotMotion(racket, [0.0, 1.0, 0.0]).polhode(5, until=2.0)) == 5
    with pytest.raises(rb.InvalidInput, match="three moments"):
        rb.PoinsotMotion(rb.shapes.rod(1.0, 1.0, along=[0, 0, 1]), [1.0, 0.0, 0.0])


# |omega| turns through 1e16 to 1.7e19 rad: of the phase 32 digits less those are left
FAR = {
    1e16: [0.47662954194244377139, -0.82111900454294951868, 0.46232085849744116488],
    1e18: [-0.10126058650342921688, -0.99980970210909250546, 0.20050677071663884481],
    1.7e19: [-0.12185698308430496099, -0.99635651927931255121, 0.20947386343199686132],
}


@pytest.mark.parametrize("t", FAR)
def test_a_phase_of_more_periods_than_a_double_counts_is_right(t):
    """Jacobi's functions at the time, in 90 digits by mpmath: of 2^53 periods the number is no longer a double."""
    motion = rb.PoinsotMotion(rb.RigidBody(1.0, [1, 2, 2.5]), [0.1, 1.0, 0.2])
    unknown = 1e-15 + 2.0**-100 * t
    assert np.abs(motion.polhode(2, until=t)[1] - FAR[t]).max() < unknown
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, [1, 2, 2.5]), angular_velocity=[0.1, 1.0, 0.2])
    run = rb.simulate(scene, t)
    assert np.abs(run[body].angular_velocity(t) - FAR[t]).max() < run.error < 100 * unknown
