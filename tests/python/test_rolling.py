"""Torques of contacts against rolling and pivoting: what they do under other loads, and what goes with them."""

import math
import pickle

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp

g, m, r = 9.81, 0.5, 0.1


def ball_on_a_plane(friction, gravity=(0, 0, -g), normal=(0, 0, 1), **start):
    scene = rb.Scene(gravity=gravity)
    ball = scene.add(rb.shapes.sphere(mass=m, radius=r), position=r * np.array(normal), **start)
    return scene, ball, scene.contact(ball.sphere(r), rb.Plane(normal), friction=friction)


@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
def test_rolling_under_a_load_that_changes(error):
    # N = m g + 3 sin(2 t): 1.4 m r v' = -rho N
    rho, v0 = 0.004, 1.0
    scene, ball, touch = ball_on_a_plane(
        rb.Coulomb(0.5, rolling=rho), velocity=[v0, 0, 0], angular_velocity=[0, v0 / r, 0]
    )
    scene.apply(rb.Force(lambda t, p, v: [0, 0, -3 * np.sin(2 * t)]), ball)
    run = rb.simulate(scene, until=2.5, error=error)
    t = np.linspace(0, 2.5, 26)
    speed = v0 - rho / (1.4 * m * r) * (m * g * t + 1.5 * (1 - np.cos(2 * t)))
    assert abs(run[ball].velocity(t)[:, 0] - speed).max() < max(10 * error, 1e-12)
    assert abs(run[touch].force(t)[:, 2] - m * g - 3 * np.sin(2 * t)).max() < max(10 * error, 1e-12)
    assert run.error <= error and len(run.events) == 0


def test_a_ball_that_rolls_and_spins_between_a_curve_and_its_stop():
    # on a plane that leans: v and the spin apart, the way curved; against the equations of a ball that does not slip
    rho, sigma, tilt = 0.01, 0.002, 0.06
    normal = np.array([math.sin(tilt), 0, math.cos(tilt)])
    v0, spin = np.array([-0.3 * math.cos(tilt), 0.8, 0.3 * math.sin(tilt)]), 12.0
    scene, ball, _ = ball_on_a_plane(
        rb.Coulomb(0.5, rolling=rho, pivoting=sigma),
        normal=normal,
        velocity=v0,
        angular_velocity=np.cross(normal, v0) / r + spin * normal,
    )
    gravity = np.array([0, 0, -g])
    along = gravity - normal * (gravity @ normal)
    load = -gravity @ normal

    def rates(_, y):
        v = y[3:]
        return [*v, *((along - rho / r * load * v / np.linalg.norm(v)) / 1.4)]

    found = solve_ivp(rates, (0, 1.0), [*(r * normal), *v0], method="DOP853", rtol=1e-13, atol=1e-14)
    for error in (1e-6, 1e-9, 1e-11):
        run = rb.simulate(scene, until=30.0, error=error)
        assert np.linalg.norm(run[ball].position(1.0) - found.y[:3, -1]) < max(error, 1e-12)
        assert np.linalg.norm(run[ball].velocity(1.0) - found.y[3:, -1]) < max(error, 1e-12)
        assert abs(run[ball].angular_velocity_world(1.0) @ normal - (spin - sigma * load / (0.4 * r * r))) < 30 * error
        assert [e.kind for e in run.events] == ["stick", "stick", "rest"]
        assert np.linalg.norm(run[ball].velocity(30.0)) == 0.0
        assert np.linalg.norm(run[ball].angular_velocity(30.0)) == 0.0


def test_a_held_ball_breaks_loose_where_its_load_does():
    rho, k = 0.004, 0.05
    scene, ball, _ = ball_on_a_plane(rb.Coulomb(0.5, rolling=rho))
    scene.apply(rb.Force(lambda t, p, v: [k * t, 0, 0]), ball)
    run = rb.simulate(scene, until=6.0, error=1e-10)
    breaks = rho * m * g / (r * k)
    assert [e.kind for e in run.events] == ["slip"]
    assert abs(run.events[0].time - breaks) < 1e-11
    assert abs(run[ball].velocity(6.0)[0] - k * (6.0 - breaks) ** 2 / 2 / (1.4 * m)) < 1e-10


def test_friction_with_torques_is_data(tmp_path):
    friction = rb.Coulomb(0.5, 0.4, rolling=0.004, pivoting=0.002)
    again = pickle.loads(pickle.dumps(friction))
    assert again == friction != rb.Coulomb(0.5, 0.4) and hash(again) == hash(friction)
    assert (again.rolling, again.pivoting) == (0.004, 0.002)
    assert repr(friction) == "Coulomb(mu_static=0.5, mu_dynamic=0.4, rolling=0.004, pivoting=0.002)"
    scene, ball, _ = ball_on_a_plane(friction, velocity=[1, 0, 0], angular_velocity=[0, 10, 2])
    rb.save(scene, tmp_path / "scene.json")
    other = rb.load(tmp_path / "scene.json")
    one, two = (rb.simulate(s, until=5.0, error=1e-9) for s in (scene, other))
    assert np.array_equal(one[ball].position(5.0), two[other.bodies[0]].position(5.0))
    assert pickle.loads(pickle.dumps(one)).events[0].time == one.events[0].time
    # with what resists sliding all goes; what only holds more leaves the torques
    smooth = rb.simulate(scene.without("dynamic friction", "static friction"), until=5.0)
    assert np.allclose(smooth[ball].velocity(5.0), [1, 0, 0], atol=1e-12)
    held = rb.simulate(scene.without("static friction"), until=5.0, error=1e-9)
    assert np.allclose(held[ball].position(5.0), one[ball].position(5.0), atol=1e-9)


@pytest.mark.parametrize("number", [-1.0, math.nan, math.inf])
def test_lengths_are_lengths(number):
    with pytest.raises(rb.InvalidInput, match="rolling"):
        rb.Coulomb(0.3, rolling=number)
    with pytest.raises(rb.InvalidInput, match="pivoting"):
        rb.Coulomb(0.3, pivoting=number)
    with pytest.raises(rb.InvalidInput, match="pin_radius"):
        rb.Revolute([0, 0, 1], friction=rb.Coulomb(0.3), pin_radius=number)


def test_where_torques_are_not_there():
    with pytest.raises(rb.InvalidInput, match="contacts"):
        rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(0.3, rolling=0.1))
    with pytest.raises(rb.InvalidInput, match="contacts"):
        rb.Prismatic([1, 0, 0], friction=rb.Coulomb(0.3, pivoting=0.1))
    with pytest.raises(rb.InvalidInput, match="mu_static"):
        rb.Coulomb(0.0, rolling=0.1)


def test_what_never_slips_rolls_and_then_comes_to_rest():
    # 1.4 v' = -rho g / r
    rho, v = 0.01, 1.0
    scene, ball, _ = ball_on_a_plane(
        rb.Coulomb(math.inf, rolling=rho), velocity=[v, 0, 0], angular_velocity=[0, v / r, 0]
    )
    run = rb.simulate(scene, until=3.0)
    stop = 1.4 * r * v / (rho * g)
    assert abs(run[ball].velocity(0.0)[0] - v) < 1e-14
    assert abs(run[ball].velocity(0.5 * stop)[0] - 0.5 * v) < 1e-12
    assert np.allclose(run.events.times("stick"), [stop], atol=1e-12)
    assert not run[ball].velocity(3.0).any()


def test_torques_that_follow_forces_which_are_not_unique_are_no_law():
    scene = rb.Scene(gravity=[0, 0, -g])
    ball = scene.add(
        rb.shapes.sphere(1.0, r), position=[0, 0, r * 2**0.5], velocity=[1, 0, 0], angular_velocity=[0, 2**0.5 / r, 0]
    )
    for side in (1, -1):
        scene.contact(ball.sphere(r), rb.Plane([0, side, 1]), friction=rb.Coulomb(0.9, rolling=0.002))
    with pytest.raises(rb.IntegrationError, match="not unique"):
        rb.simulate(scene, until=1.0)


def test_a_disc_that_has_settled_lies_flat():
    """Euler's disc ends at a finite time, its contact running round at an infinite rate, and the run says so."""
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    radius, tilt = 0.0375, 0.3
    rate = np.sqrt(4 * 9.8125 / (radius * np.sin(tilt)))
    disc = scene.add(
        rb.shapes.disc(0.4, radius, [0, 0, 1]),
        position=[0, 0, radius * np.sin(tilt)],
        attitude=rb.EulerAngles(theta=tilt, psi=0.0, phi=0.0),
        angular_velocity=[0, rate * np.sin(tilt), 0],
    )
    scene.contact(disc.disc(radius, [0, 0, 1]), rb.Plane([0, 0, 1]), friction=rb.Coulomb(np.inf, rolling=4e-3))
    with pytest.raises(rb.IntegrationError, match="the disc of contact 1 has come to lie flat") as ended:
        rb.simulate(scene, 5.0, rtol=1e-12)
    run = ended.value.run
    level = np.linalg.norm(run[disc].rotation_matrix(run.end)[:2, 2])
    assert level < 1e-6
    # small tilts end at 3/2 R/rho sqrt(tilt R/g)
    assert abs(run.end / (1.5 * radius / 4e-3 * np.sqrt(tilt * radius / 9.8125)) - 1) < 0.1


@pytest.mark.parametrize("seed", range(20))
def test_wheels_of_a_cart_stop_rolling_together(seed):
    """Two wheels, of different radii, with one coefficient: it slows by (sum m) g b / (sum m + I/r^2), each torque
    being b r N, and both wheels have stopped where that ends."""
    draw = np.random.default_rng(seed)
    speed, mass, wheel, b = draw.uniform(0.2, 2), draw.uniform(0.5, 3), 0.3, draw.uniform(0.001, 0.01)
    scene = rb.Scene(gravity=[0, 0, -g])
    start = {"position": [0, 0.5], "velocity": [speed, 0]}
    cart = scene.add(rb.RigidBody(mass, [0.1] * 3), rb.Planar([1, 0, 0], [0, 0, 1]), **start)
    wheels, inertia = [], mass + 2 * wheel
    for radius, x in zip(draw.uniform(0.05, 0.3, 2), (-0.5, 0.5), strict=True):
        moment = 0.5 * wheel * radius**2
        hinge = rb.Revolute([0, 1, 0], at=[x, 0, radius - 0.5])
        wheels.append(scene.add(rb.RigidBody(wheel, [moment] * 3), hinge, parent=cart, rate=speed / radius))
        scene.contact(wheels[-1].sphere(radius), rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.6, rolling=b * radius))
        inertia += moment / radius**2
    slowing = (mass + 2 * wheel) * g * b / inertia
    end = speed / slowing
    run = rb.simulate(scene, 1.5 * end, error=1e-9)
    assert run[cart].position(1.5 * end)[0] == pytest.approx(0.5 * speed * end, rel=1e-8)
    assert [e.time for e in run.events] == pytest.approx([end] * 4, rel=1e-8)
    assert [e.kind for e in run.events] == ["stick", "stick", "rest", "rest"]
    assert all(run[w].rate(1.5 * end) == 0.0 for w in wheels)
