"""Discs and ellipsoids on spheres and in bowls, against the distance from a point to them, and closed forms.

The distance of a point from an ellipsoid here is the zero of its multiplier by bisection, from all places of a disc the
nearest by hand; motions are those of `touching_by_hand.py`, which shares no equation with the library.
"""

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import quad
from scipy.optimize import minimize
from touching_by_hand import Touching, disc, ellipsoid

KINDS = ["ellipsoid", "disc", "face"]


def up_to_a_change(scene, until, error):
    """A run, and where it leaves, or where what does not slip would have to be pulled; else its end."""
    try:
        run = rb.simulate(scene, until=until, error=error)
    except rb.IntegrationError as failed:
        run = failed.run
    return run, min([run.end] + [e.time for e in run.events])


@pytest.mark.parametrize("rolls", [False, True], ids=["smooth", "rolls"])
@pytest.mark.parametrize("kind,inside", [(k, i) for k in KINDS for i in (False, True) if not (i and k == "face")])
def test_what_touches_moves_as_equations_written_apart_tell(kind, inside, rolls):
    compared = 0
    for seed in range(4):
        touching = Touching(seed, kind, inside, rolls)
        scene, body, contact = touching.scene()
        run, end = up_to_a_change(scene, 0.5, 1e-10)
        if end < 0.05:
            continue
        times = np.linspace(0, end, 5)[1:]
        places, attitudes = touching.motion(times)
        for t, place, attitude in zip(times, places, attitudes, strict=True):
            # differences of normals leave 1e-10
            np.testing.assert_allclose(run[body].position(t), place, atol=2e-9)
            np.testing.assert_allclose(run[body].rotation_matrix(t), attitude, atol=2e-9)
            assert abs(run[contact].gap(t)) < 1e-13
        compared += 1
    assert compared >= 3


@pytest.mark.parametrize("rolls", [False, True], ids=["smooth", "rolls"])
def test_a_face_goes_over_to_its_rim_and_back_on_a_large_ball(rolls):
    """The place of contact passes the rim with many metres a second, and the force jumps there."""
    passed = 0
    for seed in range(12):
        touching = Touching(seed, "face", False, rolls, radius_of_ball=30.0)
        scene, body, contact = touching.scene()
        run, end = up_to_a_change(scene, 0.4, 1e-11)
        times = np.linspace(0, end, 400)
        y = np.array([run[body].rotation_matrix(t).T @ -run[body].position(t) for t in times])
        across = np.hypot(y[:, 0], y[:, 1])
        assert max(abs(run[contact].gap(t)) for t in times) < 2e-13 * 30
        energy = run.energy(times)
        assert np.ptp(energy) < 1e-11 * np.abs(energy).max()
        rim = 100.0 - touching.distance(np.array([100.0, 0, 0]))[1]
        passed += np.count_nonzero(np.diff(across > rim))
    assert passed > 5


def by_many(semi_axes, y, inside, random):
    """The distance of a place from an ellipsoid among 4,000 of its points, made the least."""
    points = random.normal(size=(4000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    sign = -1 if inside else 1

    def distance(u):
        return sign * np.linalg.norm(y - semi_axes * u / np.linalg.norm(u))

    best = points[np.argmin(sign * np.linalg.norm(y - points * semi_axes, axis=1))]
    return sign * minimize(distance, best, method="Nelder-Mead", options={"xatol": 1e-12, "fatol": 1e-15}).fun


@pytest.mark.parametrize("inside", [False, True])
def test_gaps_of_ellipsoids_are_those_of_the_nearest_of_many_points(inside):
    random = np.random.default_rng(3)
    for seed in range(20):
        axes = np.exp(random.uniform(-1, 1, 3)) * 10.0 ** random.integers(-4, 5)
        radius = (
            axes.max() ** 2 / axes.min() * random.uniform(1.01, 4) if inside else axes.max() * random.uniform(0.1, 3)
        )
        direction = random.normal(size=3)
        reach = random.uniform(0, radius - axes.max()) if inside else radius + axes.max() * random.uniform(1, 3)
        if seed == 0 and inside:
            reach = 0.0
        place = direction / np.linalg.norm(direction) * reach
        attitude = random.normal(size=4)
        attitude /= np.linalg.norm(attitude)
        scene = rb.Scene()
        body = scene.add(rb.shapes.ellipsoid(1.0, axes), position=place, attitude=attitude)
        contact = scene.contact(body.ellipsoid(axes), rb.Sphere([0, 0, 0], radius, inside=inside))
        run = rb.simulate(scene, until=1e-9)
        y = -run[body].rotation_matrix(0.0).T @ place
        far = by_many(axes, y, inside, random)
        assert run[contact].gap(0.0) == pytest.approx((radius - far) if inside else far - radius, abs=1e-11 * radius)


@pytest.mark.parametrize("inside", [False, True])
def test_a_round_ellipsoid_is_a_sphere(inside):
    runs = []
    for shape in (lambda b: b.ellipsoid([0.3, 0.3, 0.3]), lambda b: b.sphere(0.3)):
        scene = rb.Scene(gravity=[0, 0, -9.81])
        body = scene.add(
            rb.RigidBody(2.0, [0.1, 0.12, 0.14]),
            position=[0.3, 0.2, -0.4] if inside else [0.1, 0.05, 1.5],
            angular_velocity=[1, 2, -1],
        )
        scene.contact(shape(body), rb.Sphere([0, 0, 0], 1.0, inside=inside), restitution=0.6, friction=rb.Coulomb(0.4))
        runs.append((rb.simulate(scene, until=0.8, error=1e-11), body))
    (one, a), (other, b) = runs
    kinds = [[e.kind for e in run.events if e.kind != "impact"] for run in (one, other)]
    assert kinds[0] == kinds[1] and len(one.events) > 0
    for kind in set(kinds[0]):
        np.testing.assert_allclose(one.events.times(kind), other.events.times(kind), atol=1e-13)
    for t in np.linspace(0, 0.8, 9):
        np.testing.assert_allclose(one[a].position(t), other[b].position(t), atol=3e-11)


@pytest.mark.parametrize("shape", ["ellipsoid", "rim", "face"])
@pytest.mark.parametrize("inside", [False, True])
def test_impacts_turn_the_speed_of_approach_round(shape, inside):
    """At the point that is nearest by hand, with the restitution; energy is lost, and none of it by what is smooth."""
    if shape == "face" and inside:
        return
    random = np.random.default_rng(11)
    axes = np.array([0.2, 0.3, 0.4])
    distance = ellipsoid(axes, inside) if shape == "ellipsoid" else disc(0.3, inside)
    radius = 1.5
    struck = 0
    for _ in range(10):
        attitude = random.normal(size=4) if shape != "face" else [1, 0.1, 0.05, 0.3]
        scene = rb.Scene(gravity=[0, 0, -9.81])
        body = scene.add(
            rb.RigidBody(1.3, [0.05, 0.06, 0.07]),
            position=[0.2, 0.1, 0.0] if inside else [0.05, 0.1, 2.2],
            attitude=attitude / np.linalg.norm(attitude),
            angular_velocity=random.normal(size=3) * (0.1 if shape == "face" else 2),
        )
        part = body.ellipsoid(axes) if shape == "ellipsoid" else body.disc(0.3, [0, 0, 1])
        scene.contact(part, rb.Sphere([0, 0, 0], radius, inside=inside), restitution=0.7)
        run = rb.simulate(scene, until=0.8, error=1e-10)
        impact = run.events[0]
        assert impact.kind == "impact"
        t, turn = impact.time, run[body].rotation_matrix(impact.time)
        y = -turn.T @ run[body].position(t)
        n, far = distance(y)
        assert far == pytest.approx(radius, abs=1e-13 * 10)
        x = turn @ (y - far * n)
        rates, momenta = [], []
        for side in ("before", "after"):
            v, w = run[body].velocity(t, side=side), run[body].angular_velocity_world(t, side=side)
            rates.append((turn @ n) @ (v + np.cross(w, x)))
            spin = turn @ (np.array([0.05, 0.06, 0.07]) * (turn.T @ w))
            momenta.append(np.concatenate([1.3 * v, spin]))
        assert rates[1] == pytest.approx(-0.7 * rates[0], abs=1e-11)
        impulse = momenta[1][:3] - momenta[0][:3]
        np.testing.assert_allclose(np.cross(turn @ n, impulse), 0, atol=1e-10)
        np.testing.assert_allclose(momenta[1][3:] - momenta[0][3:], np.cross(x, impulse), atol=1e-10)
        np.testing.assert_allclose(impulse, impact.impulse, atol=1e-10)
        struck += 1
    assert struck == 10


def test_an_upright_disc_rolls_in_a_bowl_as_a_pendulum():
    """Its centre is on a circle of R - r, and turning adds to its mass: T = 3/4 m v^2."""
    radius, bowl, lean = 0.25, 2.0, 0.9
    scene = rb.Scene(gravity=[0, 0, -9.81])
    wheel = scene.add(
        rb.shapes.disc(1.0, radius, [0, 0, 1]),
        position=(bowl - radius) * np.array([np.sin(lean), 0, -np.cos(lean)]),
        attitude=[np.sqrt(0.5), np.sqrt(0.5), 0, 0],
    )
    scene.contact(wheel.disc(radius, [0, 0, 1]), rb.Sphere([0, 0, 0], bowl, inside=True), friction=rb.Coulomb(np.inf))
    length = 1.5 * (bowl - radius)
    # a quarter of the period of a pendulum of that length, sin(q/2) = sin(lean/2) sin u
    k = np.sin(lean / 2)
    quarter = (
        np.sqrt(length / 9.81) * quad(lambda u: 1 / np.sqrt(1 - (k * np.sin(u)) ** 2), 0, np.pi / 2, epsrel=1e-13)[0]
    )
    run = rb.simulate(scene, until=4 * quarter, error=1e-11)
    np.testing.assert_allclose(run[wheel].position(quarter), [0, 0, radius - bowl], atol=1e-10)
    np.testing.assert_allclose(run[wheel].position(4 * quarter), run[wheel].position(0), atol=1e-10)


def test_a_plate_rolls_on_a_ball_as_rigid_plates_do():
    """A flat face on a fixed ball, in a plane: contact R q from the centre of the face when it leans by q."""
    radius, mass, moment = 0.8, 1.0, 0.02
    lean = 0.3
    scene = rb.Scene(gravity=[0, 0, -9.81])
    # leaning by q the contact is at R (sin q, 0, cos q), and the centre R q back along the face
    place = radius * np.array([np.sin(lean) - lean * np.cos(lean), 0, np.cos(lean) + lean * np.sin(lean)])
    plate = scene.add(
        rb.RigidBody(mass, [moment] * 3), position=place, attitude=[np.cos(lean / 2), 0, np.sin(lean / 2), 0]
    )
    scene.contact(plate.disc(0.5, [0, 0, 1]), rb.Sphere([0, 0, 0], radius), friction=rb.Coulomb(np.inf))

    def energy(q):
        return mass * 9.81 * radius * (np.cos(q) + q * np.sin(q))

    # 1/2 (m R^2 q^2 + I) q'^2 = V(lean) - V(q), by q = lean sin u to the middle
    def slope(u):
        q = lean * np.sin(u)
        # what vanishes at the end over what dq does
        return lean * np.cos(u) / np.sqrt(2 * (energy(lean) - energy(q)) / (mass * radius**2 * q**2 + moment))

    quarter = quad(slope, 0, np.pi / 2, epsabs=1e-12, epsrel=1e-12, limit=200)[0]
    run = rb.simulate(scene, until=4 * quarter, error=1e-11)
    np.testing.assert_allclose(run[plate].position(quarter), [0, 0, radius], atol=1e-7)
    np.testing.assert_allclose(run[plate].position(4 * quarter), place, atol=1e-7)
    assert len(run.events) == 0


def test_bodies_that_both_move_keep_their_momenta():
    scene = rb.Scene()
    spinning = scene.add(
        rb.shapes.ellipsoid(2.0, [0.2, 0.3, 0.4]), position=[0, 0, 0], angular_velocity=[3, 1, 2], velocity=[1, 0, 0]
    )
    ball = scene.add(rb.RigidBody(1.0, [0.1] * 3), position=[2, 0.1, 0.05], angular_velocity=[0, 5, 0])
    plate = scene.add(
        rb.shapes.disc(0.7, 0.6, [0, 0, 1]),
        position=[4, 0, 0.2],
        attitude=[np.cos(0.6), 0, np.sin(0.6), 0],
        velocity=[-1, 0, 0],
    )
    scene.contact(spinning.ellipsoid([0.2, 0.3, 0.4]), ball.sphere(0.5), restitution=0.8, friction=rb.Coulomb(0.3))
    scene.contact(plate.disc(0.6, [0, 0, 1]), ball.sphere(0.5), restitution=0.5, friction=rb.Coulomb(0.2))
    run = rb.simulate(scene, until=4.0, error=1e-10)
    assert len(run.events.times("impact")) >= 2
    for t in np.linspace(0, 4, 9):
        np.testing.assert_allclose(run.momentum(t), run.momentum(0), atol=1e-13)
        np.testing.assert_allclose(
            run.angular_momentum(t, pole=[0, 0, 0]), run.angular_momentum(0, pole=[0, 0, 0]), atol=1e-12
        )


def test_what_cannot_touch_a_bowl_at_one_place_is_refused():
    scene = rb.Scene()
    body = scene.add(rb.shapes.ellipsoid(1.0, [0.2, 0.5, 0.6]))
    with pytest.raises(ValueError, match=r"radius of curvature .* is 1.[78].* m, and of the bowl 1.5 m"):
        scene.contact(body.ellipsoid([0.2, 0.5, 0.6]), rb.Sphere([0, 0, 0], 1.5, inside=True))
    scene.contact(body.ellipsoid([0.2, 0.5, 0.6]), rb.Sphere([0, 0, 0], 2.0, inside=True))


def test_a_disc_that_falls_flat_in_a_bowl_is_named():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    coin = scene.add(rb.shapes.disc(1.0, 0.5, [0, 0, 1]))
    scene.contact(coin.disc(0.5, [0, 0, 1]), rb.Sphere([0, 0, 0], 2.0, inside=True))
    with pytest.raises(rb.IntegrationError, match="lie flat") as failed:
        rb.simulate(scene, until=3.0)
    # all of its rim at once, sqrt(R^2 - r^2) below
    assert failed.value.run.end == pytest.approx(np.sqrt(2 * np.sqrt(4 - 0.25) / 9.81), rel=1e-12)


@pytest.mark.parametrize("rtol", [1e-8, 1e-11, 1e-13])
def test_a_disc_that_comes_to_lie_flat_in_a_bowl_is_named(rtol):
    """It slides down with one end of its rim on the bowl, turning in a vertical plane until the other one is there."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    coin = scene.add(rb.shapes.disc(1.0, 0.2, [0, 0, 1]), position=[-0.4, 0, 0.1])
    contact = scene.contact(coin.disc(0.2, [0, 0, 1]), rb.Sphere([0, 0, 0], 1.0, inside=True))
    with pytest.raises(rb.IntegrationError, match="lie flat") as failed:
        rb.simulate(scene, until=3.0, rtol=rtol)
    run = failed.value.run
    place = run[coin].position(run.end)
    # a tilt of 2^-23 is none
    assert np.linalg.norm(place) == pytest.approx(np.sqrt(1 - 0.04), abs=0.2 * 2.0**-22)
    assert run.energy(run.end) <= run.energy(0) + 1e-12 and abs(run[contact].gap(run.end)) < 1e-12
    # what goes over between face and rim, or all of a rim, has no name to list
    assert all(line.startswith("gap of contact 1") for line in run.plan.guards)
