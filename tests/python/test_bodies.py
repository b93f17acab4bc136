"""Rigid bodies, shapes and attitudes as Python sees them."""

import copy
import math
import pickle

import numpy as np
import pytest
import rbdyn as rb
from scipy.spatial.transform import Rotation

RANDOM = np.random.default_rng(20240607)


def cloud(points=8):
    return RANDOM.uniform(0.1, 2.0, points), RANDOM.uniform(-1.0, 1.0, (points, 3))


def inertia_of(masses, positions, pole):
    """The direct sum, elements -sum m x_i x_j off the diagonal."""
    x = positions - pole
    return np.einsum("k,kl,kl->", masses, x, x) * np.eye(3) - np.einsum("k,ki,kj->ij", masses, x, x)


def test_points_of_mass_have_the_inertia_of_the_direct_sum_about_any_point():
    for _ in range(20):
        masses, positions = cloud()
        body = rb.shapes.points(masses, positions)
        com = masses @ positions / masses.sum()
        pole = RANDOM.uniform(-3, 3, 3)
        np.testing.assert_allclose(body.mass, masses.sum(), rtol=1e-15)
        np.testing.assert_allclose(body.com, com, rtol=0, atol=1e-15)
        np.testing.assert_allclose(body.inertia(), inertia_of(masses, positions, com), rtol=0, atol=1e-14)
        np.testing.assert_allclose(body.inertia("origin"), inertia_of(masses, positions, 0), rtol=0, atol=1e-14)
        np.testing.assert_allclose(body.inertia(pole), inertia_of(masses, positions, pole), rtol=1e-14, atol=1e-13)


def test_a_body_given_about_its_origin_knows_its_inertia_about_its_centre_of_mass():
    top = rb.RigidBody(mass=1.0, com=[0, 0, 0.5], inertia=[0.5, 0.5, 0.25], inertia_about="origin")
    assert top.inertia_about == "origin"
    assert np.array_equal(top.inertia("origin"), np.diag([0.5, 0.5, 0.25]))
    assert np.array_equal(top.inertia(), np.diag([0.25, 0.25, 0.25]))
    assert np.array_equal(top.com, [0, 0, 0.5])


def test_principal_axes_are_right_handed_and_make_the_tensor_again():
    for _ in range(20):
        body = rb.shapes.points(*cloud())
        for about in ("com", "origin", [1.0, -2.0, 0.5]):
            moments, axes = body.principal(about)
            np.testing.assert_allclose(axes @ np.diag(moments) @ axes.T, body.inertia(about), rtol=0, atol=2e-14)
            np.testing.assert_allclose(axes.T @ axes, np.eye(3), rtol=0, atol=1e-15)
            assert np.linalg.det(axes) > 0
    assert body.principal().moments is not None and body.principal()._fields == ("moments", "axes")


def test_the_axes_of_a_gyroscope_and_of_a_rod_are_found_in_any_attitude():
    turn = Rotation.from_rotvec([0.3, -1.2, 0.7])
    top = rb.RigidBody(1.0, [0.3, 0.3, 0.1]).rotated(turn)
    assert top.is_gyroscope() and top.is_gyroscope(rtol=0.0) and not top.is_rod
    assert abs(top.gyroscope_axis() @ turn.as_matrix()[:, 2]) == pytest.approx(1.0, abs=1e-15)
    assert rb.RigidBody(1.0, [1.0, 2.0, 3.0]).gyroscope_axis() is None
    assert rb.shapes.rod(1.0, 0.7, [1, 2, 3]).is_rod


def test_a_rotor_out_of_balance_asks_of_its_bearings_what_it_says():
    rotor = rb.RigidBody(1.5, [[0.6, 0.05, -0.02], [0.05, 0.8, 0.03], [-0.02, 0.03, 1.1]], com=[0.1, -0.2, 0.3])
    axis, point, rate = np.array([1.0, 2.0, -0.5]), [0.3, 0.1, 0.2], 7.0
    offset, couple = rotor.imbalance(axis, point)
    assert not rotor.is_balanced(axis, point)
    scene = rb.Scene()
    body = scene.add(rotor, rb.Revolute(axis, point=point), rate=rate)
    motion = rb.simulate(scene, until=1.0)[body]
    turn = motion.rotation_matrix(0.7)
    np.testing.assert_allclose(motion.reaction(0.7), -(rate**2) * turn @ offset, rtol=0, atol=1e-13)
    np.testing.assert_allclose(motion.reaction_torque(0.7), rate**2 * turn @ couple, rtol=0, atol=1e-13)
    for principal in rotor.principal().axes.T:
        assert rotor.is_balanced(principal, rotor.com) and not rotor.is_balanced(principal, point)
        through = rb.Scene()
        body = through.add(rotor, rb.Revolute(principal, point=rotor.com), rate=rate)
        motion = rb.simulate(through, until=1.0)[body]
        assert abs(motion.reaction(0.7)).max() < 1e-13 and abs(motion.reaction_torque(0.7)).max() < 1e-13
    with pytest.raises(rb.InvalidInput, match="length of axis is 0"):
        rotor.imbalance([0, 0, 0])


def test_welded_halves_are_the_whole():
    half = rb.shapes.rod(mass=0.35, length=0.15, along=[0, 0, 1])
    both = half.shifted([0, 0, 0.075]) + half.shifted([0, 0, -0.075])
    whole = rb.shapes.rod(mass=0.7, length=0.3, along=[0, 0, 1])
    np.testing.assert_allclose(both.inertia(), whole.inertia(), rtol=2.3e-16, atol=0)
    np.testing.assert_allclose(both.com, whole.com, rtol=0, atol=1e-32)


@pytest.mark.parametrize(
    "attitude",
    [
        Rotation.from_rotvec([0.3, -1.2, 0.7]),
        Rotation.from_rotvec([0.3, -1.2, 0.7]).as_matrix(),
        Rotation.from_rotvec([0.3, -1.2, 0.7]).as_quat()[[3, 0, 1, 2]],
        list(Rotation.from_rotvec([0.3, -1.2, 0.7]).as_quat()[[3, 0, 1, 2]] * (1 + 5e-7)),
        # intrinsic z, x, z: precession, nutation, proper rotation
        (lambda psi, theta, phi: rb.EulerAngles(theta=theta, psi=psi, phi=phi))(
            *Rotation.from_rotvec([0.3, -1.2, 0.7]).as_euler("ZXZ")
        ),
    ],
    ids=["scipy", "matrix", "quaternion", "nearly unit", "Euler angles"],
)
def test_every_form_of_an_attitude_turns_a_body_alike(attitude):
    matrix = Rotation.from_rotvec([0.3, -1.2, 0.7]).as_matrix()
    body = rb.RigidBody(2.0, [1.0, 2.0, 2.5], com=[0.1, 0.2, 0.3])
    turned = body.rotated(attitude)
    np.testing.assert_allclose(turned.com, matrix @ body.com, rtol=0, atol=1e-15)
    np.testing.assert_allclose(turned.inertia(), matrix @ body.inertia() @ matrix.T, rtol=0, atol=3e-15)
    np.testing.assert_allclose(rb.EulerAngles.of(attitude).rotation_matrix, matrix, rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("attitude", "words"),
    [
        ([2, 0, 0, 0], "norm of the quaternion is 2;"),
        (np.diag([1, 1, -1]), "determinant of the matrix is -1;"),
        (np.eye(2), r"attitude has shape \(2, 2\); it is a quaternion"),
        (Rotation.from_rotvec(np.ones((2, 3))), r"attitude has shape \(2, 4\)"),
        ("upright", "attitude is 'upright'; give numbers"),
        (rb.EulerAngles(np.nan, 0, 0), "EulerAngles: theta is nan;"),
    ],
)
def test_what_is_no_attitude_is_refused(attitude, words):
    with pytest.raises(rb.InvalidInput, match=words):
        rb.RigidBody(1.0, [1, 1, 1]).rotated(attitude)
    with pytest.raises(ValueError, match=words):
        rb.EulerAngles.of(attitude)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: rb.RigidBody(-1.0, [1, 1, 1]), "RigidBody: mass is -1; a mass is positive"),
        (lambda: rb.RigidBody(np.nan, [1, 1, 1]), "mass is nan"),
        (lambda: rb.RigidBody(1.0, [1, 1, 3]), "one is 3; each is at most the sum of the other two"),
        (lambda: rb.RigidBody(1.0, [[1, 0.25, 0], [0, 1, 0], [0, 0, 1]]), "an inertia is symmetric"),
        (lambda: rb.RigidBody(1.0, [1, 1]), r"inertia has shape \(2,\); it is three principal moments"),
        (lambda: rb.RigidBody(1.0, [1, 1, 1], inertia_about="G"), 'inertia_about is "G"; it is one of "com", "origin"'),
        (lambda: rb.RigidBody(1.0, [1, 1, 1]).inertia("G"), 'about is "G"; it is one of'),
        (lambda: rb.RigidBody(1.0, [1, 1, 1], com=[0, 0]), r"com has shape \(2,\)"),
        (lambda: rb.shapes.rod(1.0, -1.0, [0, 0, 1]), "rod: length is -1;"),
        (lambda: rb.shapes.points([1.0], [[0, 0, 0], [1, 0, 0]]), "points: masses has 1 numbers and positions 2"),
        (lambda: rb.shapes.points([1.0], [0, 0, 0]), r"points: positions has shape \(3,\)"),
        (lambda: rb.shapes.solid(1.0, [(0, 1), (0, 1)]), "solid: bounds is .* three ranges"),
        (lambda: rb.shapes.solid(1.0, [(0, 1), (0, 1), 3]), "the bounds of z has shape"),
        (lambda: rb.shapes.solid(1.0, [(0, 1), (0, 1), (0, 1, 2)]), "bounds of z has 3 numbers"),
        (lambda: rb.shapes.solid(lambda x, y, z: x[:3], [(0, 1), (0, 1), (0, 1)]), "density has shape"),
        (lambda: rb.shapes.solid(-1.0, [(0, 1), (0, 1), (0, 1)]), "a density is zero or positive"),
    ],
)
def test_numbers_no_body_has_are_refused(make, words):
    with pytest.raises(rb.InvalidInput, match=words):
        make()


def test_a_density_is_integrated_whether_it_takes_arrays_or_floats():
    e = math.exp(-1.0)

    def of_floats(x, y, z):
        return math.exp(-x) if y >= 0 else 0.0

    bounds = [(0, 1), (0, 2), (0, 3)]
    arrays, floats = (rb.shapes.solid(f, bounds) for f in (lambda x, y, z: np.exp(-x), of_floats))
    assert arrays.mass == pytest.approx(6 * (1 - e), rel=1e-13)
    assert arrays.com[0] == pytest.approx((1 - 2 * e) / (1 - e), rel=1e-13)
    np.testing.assert_allclose(floats.inertia(), arrays.inertia(), rtol=1e-14, atol=1e-15)


def test_bounds_may_be_functions():
    def y(x):
        return -math.sqrt(1 - x * x), math.sqrt(1 - x * x)

    def z(x, y):
        return 0.0, math.sqrt(max(0.0, 1 - x * x - y * y))

    half_ball = rb.shapes.solid(3.0, [(-1, 1), y, z])
    assert half_ball.mass == pytest.approx(2 * math.pi, rel=1e-13)
    np.testing.assert_allclose(half_ball.com, [0, 0, 3 / 8], rtol=0, atol=1e-13)
    moments = half_ball.inertia("origin")
    np.testing.assert_allclose(moments, 0.4 * 2 * math.pi * np.eye(3), rtol=0, atol=1e-12)


def test_an_exception_in_a_density_arrives_unchanged():
    def broken(x, y, z):
        raise KeyError("material")

    with pytest.raises(KeyError, match="material"):
        rb.shapes.solid(broken, [(0, 1), (0, 1), (0, 1)])


def bodies():
    return [
        rb.RigidBody(1.0, [1, 2, 3]),
        rb.RigidBody(1.0, [0.5, 0.5, 0.25], com=[0, 0, 0.5], inertia_about="origin"),
        rb.RigidBody(0.7, [[1, 0.1, 0], [0.1, 1.2, 0.2], [0, 0.2, 1.3]], com=[0.1, 0, 0]),
        rb.shapes.cone(0.7, 0.1, 0.3, [1, 1, 1]).rotated(rb.EulerAngles(1, 2, 3)),
    ]


def test_bodies_and_angles_are_equal_copied_and_pickled_in_all_digits():
    for k, body in enumerate(bodies()):
        for twin in (copy.copy(body), copy.deepcopy(body), pickle.loads(pickle.dumps(body))):
            assert twin == body and hash(twin) == hash(body)
        assert body != bodies()[k - 1] and body != 0
    angles = rb.EulerAngles(1.0, 0.5, -2.0)
    assert pickle.loads(pickle.dumps(angles)) == angles == rb.EulerAngles(theta=1.0, psi=0.5, phi=-2.0)
    assert angles != rb.EulerAngles(1.0, 0.5, 2.0) and tuple(angles) == (1.0, 0.5, -2.0)


def test_a_body_as_given_prints_itself_as_it_is_written():
    names = {"RigidBody": rb.RigidBody, "EulerAngles": rb.EulerAngles}
    for body in bodies()[:3]:
        assert eval(repr(body), names) == body
    assert repr(bodies()[0]) == "RigidBody(mass=1, inertia=[1, 2, 3])"
    assert repr(rb.EulerAngles(1, 0.1, 0)) == "EulerAngles(theta=1, psi=0.1, phi=0)"


def test_euler_angles_and_rates_are_those_of_scipy_and_of_the_rotation():
    for _ in range(20):
        theta, psi, phi = RANDOM.uniform([0.1, -3, -3], [3.0, 3, 3])
        angles = rb.EulerAngles(theta, psi, phi)
        turn = Rotation.from_euler("ZXZ", [psi, theta, phi])
        np.testing.assert_allclose(angles.rotation_matrix, turn.as_matrix(), rtol=0, atol=1e-15)
        assert abs(angles.quaternion @ turn.as_quat()[[3, 0, 1, 2]]) == pytest.approx(1.0, abs=1e-15)
        rates, second = RANDOM.uniform(-2, 2, (2, 3))
        omega = angles.angular_velocity(rates)
        np.testing.assert_allclose(omega, angles.matrix @ rates, rtol=0, atol=1e-15)
        np.testing.assert_allclose(angles.rates(omega), rates, rtol=0, atol=1e-13)
        # eq. 7.50 with the torque that Euler's equations (7.48) ask for
        moments = np.array([0.5, 0.75, 1.125])
        omega_rate = angles.angular_acceleration(rates, second)
        torque = moments * omega_rate + np.cross(omega, moments * omega)
        b = angles.right_side(rates, moments, torque)
        np.testing.assert_allclose(angles.matrix @ second, b, rtol=0, atol=1e-13)


def test_angles_go_on_through_the_vertical():
    angles = rb.EulerAngles(0.1, 0.5, 0.0)
    for theta in np.linspace(0.1, -7.0, 72):
        angles = rb.EulerAngles.of(rb.EulerAngles(theta, 0.5, 0.0).quaternion, previous=angles)
        np.testing.assert_allclose(tuple(angles), (theta, 0.5, 0.0), rtol=0, atol=1e-13)
