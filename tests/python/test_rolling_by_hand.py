"""Bodies that roll and slide on a table, against their equations written down apart and integrated by SciPy."""

import math

import numpy as np
import pytest
import rbdyn as rb

pytest.importorskip("scipy")
from rolling_by_hand import Body, disc, ellipsoid  # noqa: E402

GRAVITY = 9.8125
FLOOR = rb.Plane([0, 0, 1])


def both(mass, inertia, surface, lowest, friction, attitude, w, times, **by_hand):
    """The run's attitudes, places and angular velocities at times, and those by hand."""
    hand = Body(mass, inertia, lowest, GRAVITY, **by_hand)
    turn = np.asarray(attitude)
    slides = hand.mu is not None
    rows = hand.run(turn, w, times, v=[0, 0, 0] if slides else None)
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    body = scene.add(
        rb.RigidBody(mass, inertia), position=rows[0, 9:12], velocity=rows[0, 12:15], attitude=turn, angular_velocity=w
    )
    scene.contact(surface(body), FLOOR, friction=friction)
    run = rb.simulate(scene, until=times[-1], error=1e-9)
    assert list(run.events) == []
    own = np.column_stack(
        [run[body].rotation_matrix(times).reshape(-1, 9), run[body].position(times), run[body].velocity(times)]
    )
    return own, rows[:, :15]


def test_a_smooth_disc_that_nearly_lies_flat():
    """Its lowest point goes round half of the rim within hundredths of a second; time stepping does not follow that."""
    mass, radius = 0.65, 0.2078
    across = mass * radius**2 / 4
    own, hand = both(
        mass,
        np.diag([across, across, 2 * across]),
        lambda b: b.disc(radius, [0, 0, 1]),
        disc(radius),
        None,
        tilted(0.9),
        [0.0, 0.5, 0.15],
        np.linspace(0, 0.5, 51),
        mu=0.0,
    )
    assert np.min(np.arccos(own[:, 8])) < 0.1 and own[-1, 8] < own[:, 8].max() - 0.01
    assert np.allclose(own, hand, rtol=0, atol=1e-9)


def tilted(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


@pytest.mark.parametrize("rolling", [0.0, 1e-4])
def test_eulers_disc(rolling):
    radius, mass, tilt = 0.0375, 0.4, 0.3
    across = mass * radius**2 / 4
    rate = math.sqrt(4 * GRAVITY / (radius * math.sin(tilt)))
    friction = rb.Coulomb(math.inf, rolling=rolling) if rolling else rb.Coulomb(math.inf)
    own, hand = both(
        mass,
        np.diag([across, across, 2 * across]),
        lambda b: b.disc(radius, [0, 0, 1]),
        disc(radius),
        friction,
        tilted(tilt),
        [0, rate * math.sin(tilt), 0],
        np.linspace(0, 1, 6),
        rolling=rolling,
    )
    assert np.allclose(own, hand, rtol=0, atol=1e-9)
    # without rolling friction it stays at its tilt
    fallen = tilt - math.acos(own[-1, 8])
    assert (fallen > 1e-3) == (rolling > 0) and (rolling > 0 or abs(fallen) < 1e-12)


@pytest.mark.parametrize("spin", [-3.0, 3.0])
def test_rattleback(spin):
    c, s = math.cos(0.05), math.sin(0.05)
    axes = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    own, hand = both(
        1.0,
        axes @ np.diag([2e-4, 1.6e-3, 1.7e-3]) @ axes.T,
        lambda b: b.ellipsoid([0.2, 0.03, 0.02], [0, 0, 0.01]),
        ellipsoid([0.2, 0.03, 0.02], [0, 0, 0.01]),
        rb.Coulomb(math.inf),
        np.eye(3),
        [0.01, 0.01, spin],
        np.linspace(0, 2, 5),
    )
    assert np.allclose(own, hand, rtol=0, atol=2e-9)


def test_tippe_top_while_it_slides_and_turns_over():
    radius, mass, low, tilt, spin = 0.02, 0.015, 0.15, 0.3, 200.0
    along = 0.4 * mass * radius**2
    own, hand = both(
        mass,
        np.diag([0.95 * along, 0.95 * along, along]),
        lambda b: b.sphere(radius, [0, 0, low * radius]),
        ellipsoid([radius] * 3, [0, 0, low * radius]),
        rb.Coulomb(0.1),
        tilted(tilt),
        [0, spin * math.sin(tilt), spin * math.cos(tilt)],
        np.linspace(0, 2.0, 4),
        mu=0.1,
    )
    assert np.allclose(own, hand, rtol=0, atol=1e-7)
    assert math.degrees(math.acos(own[-1, 8])) > 75
