"""Rigid bodies in motion, as Python sees them: starts, loads at points, torques, watched quantities, results."""

import copy
import ctypes
import pickle

import numpy as np
import pytest
import rbdyn as rb
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation
from scipy.special import ellipk

BRICK = rb.RigidBody(mass=2.0, inertia=[0.3, 0.5, 0.7])
# nothing about it is symmetric, and its origin is not its centre of mass
STONE = rb.RigidBody(1.5, [[0.6, 0.05, -0.02], [0.05, 0.8, 0.03], [-0.02, 0.03, 1.1]], com=[0.1, -0.2, 0.3])
TOP = rb.RigidBody(mass=1.5, com=[0, 0, 0.4], inertia=[0.6, 0.6, 0.2], inertia_about="origin")
ROD = rb.RigidBody(mass=2.0, com=[0, 0, -0.6], inertia=[0.24, 0.24, 0.0])  # 1.2 m long, from its end
GRAVITY = [0, 0, -9.8]
ANGLES = rb.EulerAngles(theta=0.7, psi=-0.4, phi=1.3)
MATRIX = Rotation.from_euler("ZXZ", [-0.4, 0.7, 1.3]).as_matrix()


def held(body=STONE, joint=None, gravity=GRAVITY, **start):
    """A scene of one body, and its handle."""
    scene = rb.Scene(gravity=gravity)
    return scene, scene.add(body, joint or rb.Free(), **start)


# --- free bodies ---


def test_the_angular_velocity_of_a_free_body_has_the_period_of_the_elliptic_integral():
    inertia, omega = np.array([1.5, 2.0, 3.5]), np.array([0.3, 0.4, 1.2])
    scene, body = held(rb.RigidBody(1.0, inertia), gravity=None, angular_velocity=omega)
    crossing = scene.watch("crossing", lambda now: now[body].angular_velocity[0], direction="rising")
    run = rb.simulate(scene, 60.0, error=1e-12)
    twice_energy, momentum = inertia @ omega**2, np.sum((inertia * omega) ** 2)
    a, b, c = inertia
    assert momentum > twice_energy * b  # it goes round the axis of the largest moment
    around = momentum - twice_energy * a
    modulus = (b - a) * (twice_energy * c - momentum) / ((c - b) * around)
    period = 4 * ellipk(modulus) * np.sqrt(a * b * c / ((c - b) * around))
    times = run.events.times("crossing")
    assert len(times) > 5
    assert_allclose(np.diff(times), period, rtol=0, atol=1e-10)
    assert abs(run[crossing].value(times)).max() < 1e-11
    assert {"energy", "angular momentum"} <= set(run.drift)


def test_a_thrown_body_flies_its_parabola_whatever_its_spin():
    scene, body = held(position=[1, 2, 3], velocity=[4, 0, 5], attitude=ANGLES, angular_velocity=[3, -2, 5])
    motion = rb.simulate(scene, 2.0, error=1e-12)[body]
    t = np.linspace(0, 2, 11)
    start, velocity = motion.center_of_mass(0.0), motion.center_of_mass_velocity(0.0)
    assert_allclose(start, [1, 2, 3] + MATRIX @ [0.1, -0.2, 0.3], rtol=0, atol=1e-15)
    fall = start + velocity * t[:, None] + 0.5 * np.array(GRAVITY) * t[:, None] ** 2
    assert_allclose(motion.center_of_mass(t), fall, rtol=0, atol=2e-11)
    assert_allclose(motion.center_of_mass_acceleration(t), np.tile(GRAVITY, (11, 1)), rtol=0, atol=1e-14)


# --- starts ---


def test_a_free_body_starts_as_it_is_told():
    start = {"position": [1, 2, 3], "velocity": [-1, 0.5, 2], "attitude": ANGLES, "angular_velocity": [0.3, 0.2, -1.0]}
    scene, body = held(**start)
    motion = rb.simulate(scene, 1.0)[body]
    assert_allclose(motion.position(0.0), start["position"], rtol=0, atol=1e-15)
    assert_allclose(motion.velocity(0.0), start["velocity"], rtol=0, atol=1e-15)
    assert_allclose(motion.rotation_matrix(0.0), MATRIX, rtol=0, atol=1e-15)
    assert_allclose(motion.angular_velocity(0.0), start["angular_velocity"], rtol=0, atol=1e-15)
    assert_allclose(motion.angular_velocity_world(0.0), MATRIX @ start["angular_velocity"], rtol=0, atol=1e-15)


@pytest.mark.parametrize("joint", [rb.Free(), rb.Spherical(at=[1, 0, 0])])
def test_an_angular_velocity_may_be_given_in_world_axes(joint):
    scene, body = held(joint=joint, attitude=ANGLES, angular_velocity_world=[1, 2, 3])
    motion = rb.simulate(scene, 1.0)[body]
    assert_allclose(motion.angular_velocity_world(0.0), [1, 2, 3], rtol=0, atol=2e-15)
    assert_allclose(motion.angular_velocity(0.0), MATRIX.T @ [1, 2, 3], rtol=0, atol=2e-15)


def test_a_joint_holds_its_point_and_starts_in_its_own_words():
    at, point = np.array([1.0, -2.0, 0.5]), np.array([0.2, 0.1, -0.3])
    t = np.linspace(0, 1, 7)
    scene, body = held(joint=rb.Spherical(at=at, point=point), attitude=ANGLES, angular_velocity=[1, 2, 3])
    motion = rb.simulate(scene, 1.0)[body]
    place, velocity = motion.point(point, t)
    assert_allclose(place, np.tile(at, (7, 1)), rtol=0, atol=1e-14)
    assert abs(velocity).max() < 1e-14

    scene, body = held(joint=rb.Revolute([0, 2, 0], at=at, point=point), angle=0.3, rate=-2.0)
    motion = rb.simulate(scene, 1.0)[body]
    assert (motion.angle(0.0), motion.rate(0.0)) == (0.3, -2.0)
    assert_allclose(motion.point(point, t).position, np.tile(at, (7, 1)), rtol=0, atol=1e-14)
    assert_allclose(motion.rotation_matrix(0.0), Rotation.from_rotvec([0, 0.3, 0]).as_matrix(), rtol=0, atol=1e-15)

    scene, body = held(joint=rb.Prismatic([0, 3, 4], at=at, point=point), displacement=0.25, rate=2.0)
    motion = rb.simulate(scene, 1.0)[body]
    assert (motion.displacement(0.0), motion.rate(0.0)) == (0.25, 2.0)
    assert_allclose(motion.point(point, 0.0).position, at + 0.25 * np.array([0, 0.6, 0.8]), rtol=0, atol=1e-15)
    assert_allclose(motion.point(point, 0.0).velocity, [0, 1.2, 1.6], rtol=0, atol=1e-15)
    assert_allclose(motion.displacement(t), 0.25 + 2 * t - 0.5 * 9.8 * 0.8 * t**2, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("body", "joint", "start", "words"),
    [
        (STONE, rb.Free(), {"angle": 1.0}, 'keyword "angle"; a body that is free starts with position, velocity, att'),
        (STONE, rb.Spherical(), {"position": [0, 0, 1]}, 'keyword "position"; a body on a ball joint starts with att'),
        (STONE, rb.Revolute([0, 0, 1]), {"displacement": 1.0}, "a body on a hinge starts with angle, rate"),
        (STONE, rb.Prismatic([0, 0, 1]), {"angle": 1.0}, "a body on a slide starts with displacement, rate"),
        (rb.Particle(1.0), rb.Free(), {"attitude": ANGLES}, "a particle that is free starts with position, velocity"),
    ],
)
def test_a_start_takes_the_keywords_of_its_joint_and_no_others(body, joint, start, words):
    with pytest.raises(TypeError, match=words):
        rb.Scene().add(body, joint, **start)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda s: s.add(rb.Particle(1.0), rb.Spherical()), "a Particle has no attitude"),
        (lambda s: s.add(rb.Particle(1.0), rb.Revolute([0, 0, 1])), "its joints are Free and Rail"),
        (lambda s: s.add(STONE, rb.Rail(rb.Line([1, 0, 0]))), "a Rail guides a Particle"),
        (lambda s: s.add(ROD, rb.Spherical()), "a rod-like body has no inertia against spin about its own line"),
        (lambda s: s.add(ROD), "hold it by Revolute, Prismatic or off its line"),
        (lambda s: (s.add(ROD, rb.Revolute([0, 0, 1])), rb.simulate(s, 1.0)), "moment of inertia about its axis is 0"),
        (lambda s: s.add(STONE, angular_velocity=[1, 0, 0], angular_velocity_world=[1, 0, 0]), "both angular_velocity"),
        (lambda s: s.add(STONE, name="stone", position=[0, 0, np.nan]), "stone: component 2 of position is nan"),
        (lambda s: s.add(STONE, rb.Revolute([0, 0, 1]), rate=np.inf), "rate is inf"),
        (lambda s: s.add(STONE, attitude=[2, 0, 0, 0]), "norm of the quaternion is 2"),
        (lambda s: rb.Revolute([0, 0, 0]), "an axis has a direction"),
        (lambda s: rb.Spherical(at=[0, np.nan, 0]), "component 1 of at"),
        (lambda s: rb.Torque([0, np.inf, 0]), "Torque: component 1 is inf"),
        (lambda s: rb.Torque([0, 0, 1], frame="rail"), 'frame is "rail"; it is one of "world", "body"'),
        (lambda s: rb.Torque(lambda t, r, w: [1, 2]), "a torque has three components, in N m"),
        (lambda s: rb.Torque(lambda t, r: [1, 2, 3]), "takes 2 arguments; it is called with 3"),
        (lambda s: rb.TorsionSpring(-1.0), "stiffness is -1"),
        (lambda s: s.apply(rb.Torque([0, 0, 1]), s.add(rb.Particle(1.0))), "a Torque acts on a RigidBody"),
        (lambda s: s.apply(rb.Force([0, 0, 1], frame="body"), s.add(rb.Particle(1.0))), "give the force in world axes"),
        (lambda s: s.apply(rb.Drag(1.0), s.add(rb.Particle(1.0)), at=[0, 0, 1]), "which has one point"),
        (lambda s: s.apply(rb.Torque([0, 0, 1]), s.add(STONE), at=[0, 0, 1]), "the same about every point"),
        (lambda s: s.apply(rb.TorsionSpring(1.0), s.add(STONE)), "about the axis of a Revolute joint"),
        (lambda s: s.apply(rb.Drag(1.0), s.add(STONE), at=[0, 1]), r"at has shape \(2,\)"),
        (lambda s: s.connect(rb.Spring(1.0), s.add(rb.Particle(1.0)).point([0, 0, 1]), [0, 0, 0]), "is a particle"),
        (lambda s: s.connect(rb.Spring(1.0), rb.Scene().add(STONE).point([0, 0, 1]), [0, 0, 0]), "another scene"),
    ],
)
def test_what_cannot_be_is_refused_with_its_reason(make, words):
    with pytest.raises(rb.InvalidInput, match=words):
        make(rb.Scene())


def test_an_attitude_may_be_given_in_any_form():
    rotation = Rotation.from_matrix(MATRIX)
    x, y, z, w = rotation.as_quat()
    for attitude in (ANGLES, MATRIX, MATRIX.tolist(), rotation, [w, x, y, z], -np.array([w, x, y, z])):
        scene, body = held(attitude=attitude)
        assert_allclose(rb.simulate(scene, 0.1)[body].rotation_matrix(0.0), MATRIX, rtol=0, atol=2e-15)


# --- what results are ---


@pytest.fixture(scope="module")
def spinning():
    scene, body = held(TOP, rb.Spherical(), attitude=rb.EulerAngles(0.9, 0.2, 0.1), angular_velocity=[0.3, 0.1, 7.0])
    run = rb.simulate(scene, 5.0, error=1e-12)
    return run, run[body], np.linspace(0, 5, 201)


def test_attitudes_come_back_in_every_form(spinning):
    _, motion, t = spinning
    matrices, quaternions, angles = motion.rotation_matrix(t), motion.quaternion(t), motion.euler_angles(t)
    assert (matrices.shape, quaternions.shape, angles.shape) == ((201, 3, 3), (201, 4), (201, 3))
    assert motion.rotation_matrix(1.0).shape == (3, 3) and motion.quaternion(1.0).shape == (4,)
    assert motion.rotation_matrix([[1.0, 2.0]]).shape == (1, 2, 3, 3)
    assert_allclose(Rotation.from_quat(quaternions[:, [1, 2, 3, 0]]).as_matrix(), matrices, rtol=0, atol=3e-15)
    assert_allclose(Rotation.from_euler("ZXZ", angles[:, [1, 0, 2]]).as_matrix(), matrices, rtol=0, atol=2e-14)
    assert_array_equal(motion.poisson_vector(t), matrices[:, 2, :])


def test_euler_angles_are_continuous_and_their_rates_are_their_slopes(spinning):
    _, motion, t = spinning
    angles = motion.euler_angles(t)
    assert angles[-1, 2] > 2 * np.pi  # whole turns are kept
    assert abs(np.diff(angles, axis=0)).max() < 0.5
    h = 1e-4
    slopes = (motion.euler_angles(t[1:-1] + h) - motion.euler_angles(t[1:-1] - h)) / (2 * h)
    assert_allclose(motion.euler_rates(t[1:-1]), slopes, rtol=0, atol=1e-5)


@pytest.mark.parametrize("joint", [rb.Free(), rb.Spherical()])
def test_euler_angles_start_as_they_were_given(joint):
    given = rb.EulerAngles(theta=0.9, psi=7.0, phi=-20.0)
    scene, body = held(joint=joint, attitude=given, angular_velocity=[0.3, 0.1, 7.0])
    run = rb.simulate(scene, 1.0)
    assert_allclose(run[body].euler_angles(0.0), [0.9, 7.0, -20.0], rtol=0, atol=1e-14)
    unpickled = pickle.loads(pickle.dumps(scene))
    assert unpickled == scene == copy.deepcopy(scene)
    assert_array_equal(rb.simulate(unpickled, 1.0)[body].euler_angles(1.0), run[body].euler_angles(1.0))
    plain, other = held(joint=joint, attitude=given.quaternion, angular_velocity=[0.3, 0.1, 7.0])
    principal = rb.simulate(plain, 1.0)[other].euler_angles(0.0)
    assert_allclose(principal, [0.9, 7.0 - 2 * np.pi, -20.0 + 6 * np.pi], rtol=0, atol=1e-14)


def test_a_hinge_keeps_the_turns_it_starts_with():
    scene, body = held(ROD, rb.Revolute([0, 1, 0]), angle=7.0)
    for engine in ("closed form", "taylor"):
        angle = rb.simulate(scene, 1.0, engine=engine)[body].angle
        assert angle(0.0) == 7.0 and abs(angle(1.0) - 2 * np.pi) < 1.0


# --- the heavy body in Euler angles ---


def test_a_top_in_euler_angles_moves_as_in_quaternions():
    top, spin = rb.EulerTop(TOP, 9.8), [0.3, 0.1, 7.0]
    start = rb.EulerAngles(0.9, 7.0, 0.1)
    x = top.state(start, spin)
    assert_allclose(x[3:], start.rates(spin), rtol=1e-15)
    assert_allclose(top.rates(x)[:3], x[3:], rtol=0)
    run = rb.simulate(top, x, until=5.0, error=1e-11)
    assert run.status == "reached end" and run.error < 1e-11 and run.events == []
    t = np.linspace(0, 5, 21)
    assert run.state(t).shape == (21, 6) and run.state(1.0).shape == (6,)
    scene, body = held(TOP, rb.Spherical(), attitude=start, angular_velocity=spin)
    assert_allclose(run.state(t)[:, :3], rb.simulate(scene, 5.0)[body].euler_angles(t), rtol=0, atol=1e-8)
    assert rb.simulate(top, x, until=5.0, rtol=1e-8, engine="dop853").error is None
    assert_allclose(rb.simulate(top, x, until=5.0, keep="end").state(5.0), run.state(5.0), rtol=0, atol=1e-7)
    assert run.state([]).shape == (0, 6)


def test_a_top_in_euler_angles_stops_where_they_fail():
    top = rb.EulerTop(TOP, 9.8)
    run = rb.simulate(top, top.state(rb.EulerAngles(2.0, 0.0, 0.0), [0, 0, 0]), 10.0)
    assert run.status == "stopped by event" and run.end < 1.0 and run.certain_until == run.end
    (event,) = run.events
    assert event.name == "sin theta too small for Euler angles" and event.time == run.end
    assert abs(np.sin(run.state(run.end)[0])) == pytest.approx(1e-3, abs=1e-12)
    assert "sin theta too small for Euler angles" in str(run)
    with pytest.raises(rb.InvalidInput, match=r"\|sin theta\| at the start is 0"):
        rb.simulate(top, [0, 0, 0, 0, 0, 1], 1.0)
    with pytest.raises(rb.InvalidInput, match="number of variables of the state is 2"):
        rb.simulate(top, [1.0, 0], 1.0)
    with pytest.raises(rb.InvalidInput, match="product of inertia"):
        rb.EulerTop(STONE, 9.8)
    with pytest.raises(rb.AccuracyError) as caught:
        rb.simulate(top, top.state(ANGLES, [0.3, 0.1, 7.0]), 5.0, error=4e-15, engine="dop853")
    assert caught.value.run.state(0.0)[0] == ANGLES.theta


def test_a_run_that_kept_its_end_alone_has_the_angles_of_that_attitude(spinning):
    _, motion, _ = spinning
    scene, body = held(TOP, rb.Spherical(), attitude=rb.EulerAngles(0.9, 0.2, 0.1), angular_velocity=[0.3, 0.1, 7.0])
    run = rb.simulate(scene, 5.0, error=1e-12, engine="taylor", keep="end")
    angles = run[body].euler_angles(5.0)
    assert abs(angles[1:]).max() <= np.pi
    turns = (angles - motion.euler_angles(5.0)) / (2 * np.pi)
    assert_allclose(turns, np.round(turns), rtol=0, atol=1e-11)


def test_angular_velocity_and_acceleration_are_slopes_of_the_attitude(spinning):
    _, motion, t = spinning
    t, h = t[1:-1], 1e-4
    r, slope = motion.rotation_matrix(t), (motion.rotation_matrix(t + h) - motion.rotation_matrix(t - h)) / (2 * h)
    skew = slope @ r.transpose(0, 2, 1)
    omega = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
    assert_allclose(motion.angular_velocity_world(t), omega, rtol=0, atol=2e-5)
    assert_allclose(
        np.einsum("nij,nj->ni", r, motion.angular_velocity(t)), motion.angular_velocity_world(t), atol=1e-13
    )
    change = (motion.angular_velocity(t + h) - motion.angular_velocity(t - h)) / (2 * h)
    assert_allclose(motion.angular_acceleration(t), change, rtol=0, atol=2e-5)


def test_the_reaction_of_a_ball_joint_is_what_the_motion_of_g_asks_for(spinning):
    run, motion, t = spinning
    needed = 1.5 * (motion.center_of_mass_acceleration(t) - GRAVITY)
    assert_allclose(motion.reaction(t), needed, rtol=0, atol=1e-12)
    assert_array_equal(motion.reaction_torque(t), np.zeros((201, 3)))
    # by hand from Euler's equations at the start
    r, omega, arm = motion.rotation_matrix(0.0), np.array([0.3, 0.1, 7.0]), np.array([0, 0, 0.4])
    inertia, weight = np.diag([0.6, 0.6, 0.2]), 1.5 * r.T @ GRAVITY
    turning = np.linalg.solve(inertia, np.cross(arm, weight) - np.cross(omega, inertia @ omega))
    acceleration = np.cross(turning, arm) + np.cross(omega, np.cross(omega, arm))
    assert_allclose(motion.reaction(0.0), r @ (1.5 * acceleration - weight), rtol=0, atol=1e-13)
    assert {"energy", "vertical angular momentum", "spin"} <= set(run.drift)
    assert max(run.drift[name] for name in ("energy", "vertical angular momentum", "spin")) < 1e-13


def test_a_point_of_a_body_moves_as_the_body_carries_it():
    scene, stone = held(velocity=[1, 2, 3], angular_velocity=[0.3, -2.0, 1.1], attitude=ANGLES)
    run = rb.simulate(scene, until=2.0, error=1e-13)
    place = np.array([0.4, -0.7, 0.2])
    point = run[stone.point(place)]
    t = np.linspace(0.1, 1.9, 7)
    turned = run[stone].rotation_matrix(t) @ place
    assert_allclose(point.position(t), run[stone].position(t) + turned, rtol=0, atol=1e-14)
    h = 1e-3
    weights = {-3: -1 / 60, -2: 3 / 20, -1: -3 / 4, 1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    for value, slope in ((point.position, point.velocity), (point.velocity, point.acceleration)):
        assert_allclose(sum(w * value(t + k * h) for k, w in weights.items()) / h, slope(t), rtol=0, atol=1e-10)
    # at the centre of mass gravity alone
    assert_allclose(run[stone.point(STONE.com)].acceleration(t), [GRAVITY] * 7, rtol=0, atol=1e-12)
    assert_array_equal(run[stone.point([0, 0, 0])].velocity(0.7), run[stone].velocity(0.7))
    with pytest.raises(rb.InvalidInput):
        run[held()[1].point(place)]


def test_points_of_the_instantaneous_axis_move_along_it():
    scene, body = held(position=[1, 0, 0], velocity=[0, 2, 1], attitude=ANGLES, angular_velocity=[1, -2, 3])
    motion = rb.simulate(scene, 1.0, error=1e-12)[body]
    axis = motion.instantaneous_axis(0.5)
    assert isinstance(axis, rb.Axis) and axis.point.shape == (3,)
    r = motion.rotation_matrix(0.5)
    velocity = motion.point(r.T @ (axis.point - motion.position(0.5)), 0.5).velocity
    assert_allclose(np.cross(velocity, axis.direction), 0, rtol=0, atol=1e-13)
    assert_allclose((axis.point - motion.center_of_mass(0.5)) @ axis.direction, 0, atol=1e-14)
    points, directions = motion.instantaneous_axis(np.linspace(0, 1, 4))
    assert points.shape == directions.shape == (4, 3)
    still = rb.Scene()
    body = still.add(STONE)
    assert_array_equal(rb.simulate(still, 1.0)[body].instantaneous_axis(0.5).direction, [0, 0, 0])


def test_a_body_has_the_quantities_of_its_joint_and_others_are_refused():
    scene = rb.Scene()
    free, hinge = scene.add(STONE), scene.add(STONE, rb.Revolute([0, 0, 1]))
    slide, bead = scene.add(STONE, rb.Prismatic([0, 0, 1])), scene.add(rb.Particle(1.0))
    run = rb.simulate(scene, 1.0)
    assert "rate" in run[hinge].quantities and "displacement" not in run[hinge].quantities
    assert "reaction" not in run[free].quantities and "quaternion" not in run[bead].quantities
    for ask, words in (
        (run[free].angle, "angle is asked for, and its joint has none"),
        (run[hinge].displacement, "displacement is asked for, and its joint has none"),
        (run[slide].angle, "angle"),
        (run[free].rate, "rate is asked for"),
        (run[free].reaction, "it is free, and only a joint exerts a reaction"),
        (run[bead].quaternion, "it is a particle"),
        (run[hinge].parameter, "only a body on a rail"),
    ):
        with pytest.raises(rb.InvalidInput, match=words):
            ask(0.5)
    sample = run.sample([0.0, 0.5])
    for handle in (free, hinge, slide, bead):
        names = {name.partition(".")[0] for name in sample[handle]}
        assert names == set(run[handle].quantities)
    assert sample[free]["rotation_matrix"].shape == (2, 3, 3)
    assert sample[free]["instantaneous_axis.point"].shape == (2, 3)


def test_a_sample_of_bodies_becomes_a_table_or_a_dataset(spinning):
    run, motion, t = spinning
    sample = run.sample(t)
    pytest.importorskip("pandas")
    table = sample.to_pandas()
    assert_array_equal(table["body 1", "rotation_matrix", "z e1"], motion.rotation_matrix(t)[:, 2, 0])
    assert_array_equal(table["body 1", "quaternion", "w"], motion.quaternion(t)[:, 0])
    pytest.importorskip("xarray")
    data = sample.to_xarray()
    assert_array_equal(data["body 1.euler_angles"].sel(euler="phi"), motion.euler_angles(t)[:, 2])


def test_figures_show_bodies(spinning, tmp_path):
    run, _, _ = spinning
    assert len(run.plot(tmp_path / "top.png").axes) == 4
    for joint in (rb.Revolute([0, 1, 0]), rb.Prismatic([0, 1, 1])):
        scene, _ = held(joint=joint)
        assert len(rb.simulate(scene, 1.0).plot().axes) == 4


# --- hinges and slides ---


def test_a_pendulum_has_the_period_of_the_elliptic_integral_and_its_bearing_a_quarter_of_the_weight():
    scene, arm = held(ROD, rb.Revolute(axis=[0, 1, 0]), angle=np.pi / 2)
    scene.watch("bottom", lambda now: now[arm].angle, direction="falling")
    run = rb.simulate(scene, 30.0, error=1e-12)
    length = (0.24 + 2 * 0.36) / (2 * 0.6)
    period = 4 * np.sqrt(length / 9.8) * ellipk(0.5)
    assert_allclose(np.diff(run.events.times("bottom")), period, rtol=0, atol=1e-11)
    assert_allclose(run[arm].reaction(0.0), [0, 0, 2.0 * 9.8 / 4], rtol=0, atol=1e-13)
    assert run[arm].reaction_torque(0.0).shape == (3,)


@pytest.mark.parametrize("tiny", [1.8e-3, 3e-6])
def test_a_small_torque_of_a_heavy_pendulum_on_its_hinge_is_judged_by_what_it_is_a_difference_of(tiny):
    # the weight turns it about the axis alone: the bearing's torque is of the deviation moments, and has all digits
    body = rb.RigidBody(4.6, [[0.9, 0, 0], [0, 0.85, tiny], [0, tiny, 0.06]], com=[0, 0, -0.83])
    scene, arm = held(body, rb.Revolute([0, 1, 0], point=[0, 0, -0.05]), gravity=[0, 0, -9.8], angle=0.08)
    run = rb.simulate(scene, 20.0, error=1e-12)
    motion = run[arm]
    assert run.error < 1e-14
    for t in (0.0, 3.3, 20.0):
        turn, rate, push = motion.rotation_matrix(t), motion.rate(t), motion.angular_acceleration(t)[1]
        expected = turn @ [tiny * rate**2, 0.0, tiny * push]  # I alpha + omega x I omega, about the axis nothing
        assert_allclose(motion.reaction_torque(t), expected, rtol=0, atol=1e-14 * tiny)


def test_a_hinge_that_is_no_principal_axis_carries_the_torque_of_the_deviation_moments():
    scene, wheel = held(STONE, rb.Revolute([0, 0, 1], point=[0.1, -0.2, 0.3]), gravity=None, rate=3.0)
    motion = rb.simulate(scene, 2.0, error=1e-12)[wheel]
    inertia, omega = np.array([[0.6, 0.05, -0.02], [0.05, 0.8, 0.03], [-0.02, 0.03, 1.1]]), np.array([0, 0, 3.0])
    for t in (0.0, 0.7, 2.0):
        expected = motion.rotation_matrix(t) @ np.cross(omega, inertia @ omega)
        assert_allclose(motion.reaction_torque(t), expected, rtol=0, atol=1e-12)
    assert_allclose(motion.angle(2.0), 6.0, rtol=0, atol=1e-11)


def test_a_torsion_spring_swings_a_body_and_keeps_its_energy():
    scene, wheel = held(BRICK, rb.Revolute([0, 0, 2]), angle=1.5)
    scene.apply(rb.TorsionSpring(stiffness=2.8, rest_angle=0.5), wheel)
    run = rb.simulate(scene, 10.0, error=1e-12)
    t = np.linspace(0, 10, 101)
    assert_allclose(run[wheel].angle(t), 0.5 + np.cos(2.0 * t), rtol=0, atol=1e-11)
    assert np.ptp(run.energy(t)) < 1e-11
    damped, wheel = held(BRICK, rb.Revolute([0, 0, 2]), rate=1.0)
    damper = damped.apply(rb.TorsionSpring(0.0, damping=0.35), wheel)
    run = rb.simulate(damped, 4.0, error=1e-12)
    assert_allclose(run[wheel].rate(t[:41]), np.exp(-0.5 * t[:41]), rtol=0, atol=1e-11)
    assert_allclose(run.work(0, 4, of=damper), 0.35 * (np.exp(-4.0) - 1), rtol=0, atol=1e-10)


# --- loads at points ---


def test_a_force_in_body_axes_at_a_point_spins_a_hinge_up():
    scene, wheel = held(BRICK, rb.Revolute([0, 0, 1]), gravity=None)
    jet = scene.apply(rb.Force([0, 1.4, 0], frame="body"), wheel, at=[0.5, 0, 0])
    run = rb.simulate(scene, 4.0, error=1e-12)
    assert_allclose(run[wheel].angle(4.0), 0.5 * 16.0, rtol=0, atol=1e-10)
    assert_allclose(run.power(4.0, of=jet), 0.7 * 4.0, rtol=0, atol=1e-10)
    assert_allclose(run[wheel].force(4.0), run[wheel].rotation_matrix(4.0) @ [0, 1.4, 0], rtol=0, atol=1e-13)


@pytest.mark.parametrize("frame", ["world", "body"])
def test_a_force_sees_the_point_it_acts_at(frame):
    def push(t, position, velocity):
        return [0.3 * position[1], -0.2 * velocity[0], 0.1 * t]

    motions = []
    for trace in (True, False):
        scene, body = held(gravity=None, position=[0, 0, 1], attitude=ANGLES, angular_velocity=[0.2, 0.5, -0.3])
        scene.apply(rb.Force(push, frame=frame, trace=trace), body, at=[0.2, 0.3, -0.1])
        motions.append(rb.simulate(scene, 2.0, error=1e-11)[body])
    traced, called = motions
    place, velocity = traced.point([0.2, 0.3, -0.1], 1.2)
    force = np.array(push(1.2, place, velocity))
    if frame == "body":
        force = traced.rotation_matrix(1.2) @ force
    assert_allclose(traced.force(1.2), force, rtol=0, atol=1e-12)
    assert_allclose(traced.rotation_matrix(2.0), called.rotation_matrix(2.0), rtol=0, atol=1e-10)
    assert_allclose(traced.position(2.0), called.position(2.0), rtol=0, atol=1e-10)


def test_a_spring_between_points_of_two_bodies_keeps_what_it_must():
    scene = rb.Scene()
    a = scene.add(BRICK, position=[0, 0, 0], angular_velocity=[1, 0.5, 0], attitude=ANGLES)
    b = scene.add(STONE, position=[2, 0, 0.5], velocity=[0, 0.3, 0])
    from_, to = [0.3, 0.2, 0.1], [-0.4, 0, 0.2]
    spring = scene.connect(rb.Spring(5.0, rest_length=1.0), a.point(from_), b.point(to))
    run = rb.simulate(scene, 5.0, error=1e-11)
    t = np.linspace(0, 5, 21)
    apart = run[a].point(from_, t).position - run[b].point(to, t).position
    length = np.linalg.norm(apart, axis=1)
    assert_allclose(run[spring].length(t), length, rtol=0, atol=1e-13)
    pull = -5.0 * (length - 1.0)[:, None] * apart / length[:, None]
    assert_allclose(run[spring].force(t), pull, rtol=0, atol=1e-12)
    assert_allclose(run[a].force(t), pull, rtol=0, atol=1e-12)
    for kept in (run.momentum(t), run.angular_momentum(t), run.energy(t)):
        assert np.ptp(kept, axis=0).max() < 2e-10
    assert {"energy", "angular momentum"} <= set(run.drift)


def test_a_spring_at_the_handle_of_a_body_is_at_its_centre_of_mass():
    ends = []
    for point in (None, [0.1, -0.2, 0.3]):
        scene, body = held(attitude=ANGLES, angular_velocity=[1, 2, 3])
        scene.connect(rb.Spring(20.0), body if point is None else body.point(point), [0, 0, 2])
        ends.append(rb.simulate(scene, 2.0, error=1e-11)[body].position(2.0))
    assert_allclose(ends[0], ends[1], rtol=0, atol=1e-10)


# --- torques ---


def steer(t, rotation_matrix, angular_velocity):
    return -0.3 * angular_velocity + np.array([0.2 * np.sin(t), rotation_matrix[2, 1], rotation_matrix[0, 2] ** 2])


def steer_by_numbers(t, r, w, torque):
    matrix, omega = np.ctypeslib.as_array(r, (3, 3)), np.ctypeslib.as_array(w, (3,))
    torque[0], torque[1], torque[2] = steer(t, matrix, omega)


DOUBLES = ctypes.POINTER(ctypes.c_double)


@pytest.mark.parametrize("joint", [rb.Spherical(point=[0.1, 0, 0]), rb.Free()])
@pytest.mark.parametrize("frame", ["body", "world"])
def test_a_torque_is_the_same_traced_called_back_and_compiled(frame, joint):
    compiled = ctypes.CFUNCTYPE(None, ctypes.c_double, DOUBLES, DOUBLES, DOUBLES)(steer_by_numbers)
    motions = []
    for torque in (
        rb.Torque(steer, frame=frame),
        rb.Torque(steer, frame=frame, trace=False),
        rb.Torque(compiled, frame=frame),
    ):
        scene, body = held(joint=joint, attitude=ANGLES, angular_velocity=[1, -0.5, 2])
        scene.apply(torque, body)
        motions.append(rb.simulate(scene, 2.0, error=1e-11)[body])
    t = np.linspace(0, 2, 9)
    for motion in motions[1:]:
        assert_allclose(motion.rotation_matrix(t), motions[0].rotation_matrix(t), rtol=0, atol=1e-10)
        assert_allclose(motion.angular_velocity(t), motions[0].angular_velocity(t), rtol=0, atol=1e-10)


def test_a_torque_of_numba_is_called_by_its_address():
    numba = pytest.importorskip("numba")
    doubles = numba.types.CPointer(numba.float64)

    @numba.cfunc(numba.void(numba.float64, doubles, doubles, doubles))
    def compiled(t, r, w, torque):
        for i in range(3):
            torque[i] = -0.3 * w[i]
        torque[0] += 0.2 * np.sin(t)
        torque[1] += r[7]
        torque[2] += r[2] * r[2]

    angles = []
    for f in (steer, compiled):
        scene, body = held(attitude=ANGLES, angular_velocity=[1, -0.5, 2])
        scene.apply(rb.Torque(f), body)
        angles.append(rb.simulate(scene, 2.0, error=1e-11)[body].rotation_matrix(2.0))
    assert_allclose(angles[0], angles[1], rtol=0, atol=1e-10)


def test_a_torque_says_what_it_is():
    torque = rb.Torque(steer)
    assert torque.traced and torque.frame == "body" and torque.function.inputs == 13
    assert repr(torque) == "Torque(steer, traced)"
    assert repr(rb.Torque([0, 0, 1], frame="world")) == 'Torque([0, 0, 1], frame="world")'
    assert repr(rb.Force([0, 0, 1], frame="body")) == 'Force([0, 0, 1], frame="body")'
    scene, body = held()
    scene.apply(torque, body)
    plan = rb.plan(scene)
    assert "user torque" in plan.effects and 'torque "steer" traced, native, on body 1' in plan.functions
    scene.apply(rb.Torque(steer, trace=False), body)
    assert any(line.startswith('torque "steer" on body 1 called back') for line in rb.plan(scene).functions)


def test_a_constant_torque_in_body_axes_turns_with_the_body():
    # about a principal axis in either frame: the axis stays where it is
    for frame in ("body", "world"):
        scene, body = held(BRICK, gravity=None, angular_velocity=[0, 0, 1.0])
        torque = scene.apply(rb.Torque([0, 0, 1.4], frame=frame), body)
        run = rb.simulate(scene, 3.0, error=1e-12)
        assert_allclose(run[body].angular_velocity(3.0), [0, 0, 7.0], rtol=0, atol=1e-11)
        assert_allclose(run.work(0, 3, of=torque), 0.5 * 0.7 * (49 - 1), rtol=0, atol=1e-9)


def test_what_a_torque_raises_arrives_unchanged_with_the_run():
    calls = []

    def broken(t, r, w):
        calls.append(t)
        if len(calls) > 200:
            raise ZeroDivisionError("no more")
        return [0, 0, 1]

    scene, body = held(gravity=None, angular_velocity=[3, 2, 5])
    scene.apply(rb.Torque(broken, trace=False), body)
    with pytest.raises(ZeroDivisionError, match="no more") as caught:
        rb.simulate(scene, 2.0)
    assert 0 < caught.value.run.end < 2.0


# --- watched quantities ---

VECTORS = ["position", "velocity", "acceleration", "force", "center_of_mass", "center_of_mass_velocity"]
VECTORS += ["center_of_mass_acceleration", "angular_velocity", "angular_velocity_world", "angular_acceleration"]
VECTORS += ["poisson_vector", "euler_angles", "quaternion", "rotation_matrix"]
JOINTS = {
    "free": (rb.Free(), {"position": [1, 2, 0], "attitude": ANGLES, "angular_velocity": [1, 0.5, 2]}, []),
    "ball": (rb.Spherical(point=[0, 0.1, 0]), {"attitude": ANGLES, "angular_velocity": [1, 0.5, 2]}, ["reaction"]),
    "hinge": (rb.Revolute([1, 2, 2]), {"angle": 0.4, "rate": 3.0}, ["reaction", "reaction_torque", "angle", "rate"]),
    "slide": (
        rb.Prismatic([1, 2, 2]),
        {"displacement": 0.4, "rate": 3.0},
        ["reaction", "reaction_torque", "displacement", "rate"],
    ),
}


@pytest.mark.parametrize("kind", JOINTS)
@pytest.mark.parametrize("body", [STONE, TOP], ids=["stone", "top"])
def test_every_quantity_is_the_same_traced_called_back_and_afterwards(kind, body):
    joint, start, more = JOINTS[kind]
    scene, handle = held(body, joint, **start)
    names = [*VECTORS, *more, "kinetic_energy"]
    watches = {}
    for name in names:
        # a number that every component enters by a weight of its own

        def weighed(now, name=name):
            value = np.asarray(getattr(now[handle], name))
            return sum((i + 1.5) * x for i, x in enumerate(value.ravel())) + 1e3

        watches[name] = [scene.watch(f"{name} {trace}", weighed, trace=trace) for trace in (True, False)]
    run = rb.simulate(scene, 0.25, error=1e-10)
    motion = run[handle]
    for t in (0.0, 0.11, 0.25):
        for name in names:
            traced, called = (run[w].value(t) for w in watches[name])
            value = run.kinetic_energy(t) if name == "kinetic_energy" else getattr(motion, name)(t)
            expected = sum((i + 1.5) * x for i, x in enumerate(np.ravel(value))) + 1e3
            assert traced == pytest.approx(called, rel=0, abs=2e-12), name
            assert traced == pytest.approx(expected, rel=0, abs=2e-12), name


def test_a_watched_matrix_is_an_array_with_products():
    scene, body = held(attitude=ANGLES, angular_velocity=[1, 2, 3])
    watch = scene.watch(
        "lean",
        lambda now: (now[body].rotation_matrix @ np.array([0, 0, 1]))[2] - np.cos(now[body].euler_angles[0]),
        trace=True,
    )
    run = rb.simulate(scene, 1.0)
    assert abs(run[watch].value(np.linspace(0, 1, 5))).max() < 1e-14


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda now, s: now[s["free"]].reaction, "free, and only a joint exerts a reaction"),
        (lambda now, s: now[s["free"]].angle, "has no angle; a body on a Revolute, Cylindrical or Planar joint has"),
        (lambda now, s: now[s["hinge"]].displacement, "a body on a Prismatic or Cylindrical joint has"),
        (lambda now, s: now[s["free"]].rate, "a body on a Revolute, Prismatic, Cylindrical or Planar joint has"),
        (lambda now, s: now[s["bead"]].quaternion, "is a particle, and what is asked is of rigid bodies"),
        (lambda now, s: now[s["bead"]].angular_velocity, "is a particle"),
        (lambda now, s: now[s["hinge"]].parameter, "only a particle on a rail"),
    ],
)
@pytest.mark.parametrize("trace", [True, False])
def test_what_a_body_does_not_have_cannot_be_watched(ask, words, trace):
    scene = rb.Scene()
    handles = {"free": scene.add(STONE), "hinge": scene.add(STONE, rb.Revolute([0, 0, 1]))}
    handles["bead"] = scene.add(rb.Particle(1.0))
    with pytest.raises(rb.InvalidInput, match=words):
        scene.watch("w", lambda now: np.sum(ask(now, handles)), trace=trace)
        rb.simulate(scene, 1.0)


# --- actions ---


def test_a_blow_changes_the_angular_velocity_and_results_jump_there():
    scene, body = held(TOP, rb.Spherical(), attitude=rb.EulerAngles(0.5, 0, 0), angular_velocity=[0, 0, 20.0])
    scene.watch(
        "blow",
        lambda now: now.time - 1.0,
        action=lambda now: {body: {"angular_velocity": now[body].angular_velocity + [0, 1.0, -5.0]}},
    )
    run = rb.simulate(scene, 2.0, error=1e-11)
    motion = run[body]
    before, after = motion.angular_velocity(1.0, side="before"), motion.angular_velocity(1.0)
    assert_allclose(after - before, [0, 1.0, -5.0], rtol=0, atol=1e-13)
    assert_allclose(motion.rotation_matrix(1.0), motion.rotation_matrix(1.0, side="before"), rtol=0, atol=1e-14)
    assert_allclose(motion.angular_velocity([0.5, 1.5])[:, 2], [20.0, 15.0], rtol=0, atol=1e-13)
    # what follows is the motion from there
    again, later = held(TOP, rb.Spherical(), attitude=motion.quaternion(1.0), angular_velocity=after)
    end = rb.simulate(again, 1.0, error=1e-11)[later].rotation_matrix(1.0)
    assert_allclose(motion.rotation_matrix(2.0), end, rtol=0, atol=1e-10)


@pytest.mark.parametrize(
    ("joint", "words", "read"),
    [
        (rb.Free(), {"position": [1, 2, 3]}, "position"),
        (rb.Free(), {"velocity": [1, 2, 3]}, "velocity"),
        (rb.Free(), {"attitude": MATRIX}, "rotation_matrix"),
        (rb.Free(), {"attitude": rb.EulerAngles(0.7, -0.4, 1.3)}, "rotation_matrix"),
        (rb.Free(), {"angular_velocity": [1, 2, 3]}, "angular_velocity"),
        (rb.Spherical(), {"angular_velocity_world": [1, 2, 3]}, "angular_velocity_world"),
        (rb.Revolute([0, 1, 0]), {"angle": 2.5}, "angle"),
        (rb.Revolute([0, 1, 0]), {"rate": -1.5}, "rate"),
        (rb.Prismatic([0, 1, 0]), {"displacement": 2.5}, "displacement"),
        (rb.Prismatic([0, 1, 0]), {"rate": -1.5}, "rate"),
    ],
)
def test_an_action_changes_what_it_names_and_nothing_else(joint, words, read):
    start = {"angular_velocity": [0.4, 0.1, 0.2]} if isinstance(joint, rb.Free | rb.Spherical) else {"rate": 0.5}
    scene, body = held(joint=joint, **start)
    scene.watch("now", lambda now: now.time - 0.5, action=lambda now: {body: words})
    motion = rb.simulate(scene, 1.0)[body]
    value = MATRIX if read == "rotation_matrix" else next(iter(words.values()))
    assert_allclose(getattr(motion, read)(0.5), value, rtol=0, atol=2e-15)
    kept = {"position", "velocity", "rotation_matrix", "angular_velocity"} & set(motion.quantities) - {read}
    if isinstance(joint, rb.Free):
        for name in kept:
            quantity = getattr(motion, name)
            assert_allclose(quantity(0.5), quantity(0.5, side="before"), rtol=0, atol=2e-14)


@pytest.mark.parametrize(
    ("joint", "words", "message"),
    [
        (rb.Free(), {"angle": 1.0}, "changes angle of body 1, whose joint has none; give position, velocity, attitude"),
        (rb.Revolute([0, 1, 0]), {"attitude": ANGLES}, "give angle, rate"),
        (rb.Prismatic([0, 1, 0]), {"velocity": [0, 0, 1]}, "give displacement, rate"),
        (rb.Free(), {"angular_velocity": [1, 0, 0], "angular_velocity_world": [1, 0, 0]}, "both angular_velocity"),
        (rb.Free(), {"position": [0, 0, np.nan]}, "a state is finite"),
        (rb.Free(), {"colour": 1.0}, 'changes "colour"'),
    ],
)
def test_an_action_speaks_its_joints_words(joint, words, message):
    scene, body = held(joint=joint)
    scene.watch("now", lambda now: now.time - 0.5, action=lambda now: {body: words})
    with pytest.raises(rb.InvalidInput, match=message):
        rb.simulate(scene, 1.0)


# --- scenes as data ---


def full_scene():
    scene = rb.Scene(gravity=GRAVITY)
    free = scene.add(STONE, name="stone", position=[0.1, 0.2, 0.3], velocity=[1, 0, 0], attitude=ANGLES)
    ball = scene.add(TOP, rb.Spherical(at=[1, 0, 0]), attitude=ANGLES, angular_velocity_world=[0, 1, 5])
    hinge = scene.add(ROD, rb.Revolute([0, 1, 0], at=[0, 0, 2]), angle=0.3, rate=0.1)
    slide = scene.add(BRICK, rb.Prismatic([1, 0, 1], point=[0, 0, 0.1]), displacement=0.2, rate=-0.1)
    bead = scene.add(rb.Particle(0.1), position=[0, 0, 5])
    scene.apply(rb.Torque(steer, frame="world"), free)
    scene.apply(rb.Torque([0.1, 0, 0]), ball)
    scene.apply(rb.TorsionSpring(1.0, 0.2, 0.1), hinge)
    scene.apply(rb.Force([0, 0, 1], frame="body"), slide, at=[0.1, 0.2, 0.3])
    scene.connect(rb.Spring(2.0, 0.5), free.point([0.1, 0, 0]), ball.point([0, 0, 1]))
    scene.connect(rb.Spring(2.0, 0.5), bead, hinge.point([0, 0, -1.2]))
    scene.connect(rb.Spring(1.0), slide, [0, 0, 0])
    scene.watch("up", lambda now: now[free].rotation_matrix[2, 2] + now[hinge].angle)
    return scene, [free, ball, hinge, slide, bead]


def test_a_scene_of_bodies_is_data():
    scene, handles = full_scene()
    for other in (copy.copy(scene), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
        assert other == scene and other.bodies == handles
        other.apply(rb.Torque([0, 0, 1]), handles[0])
        assert other != scene
    again, _ = full_scene()
    assert again == scene
    runs = [rb.simulate(s, 0.5) for s in (scene, pickle.loads(pickle.dumps(scene)))]
    for handle in handles:
        assert_array_equal(runs[0][handle].position(0.5), runs[1][handle].position(0.5))
    assert_array_equal(runs[0][handles[0]].quaternion(0.5), runs[1][handles[0]].quaternion(0.5))


@pytest.mark.parametrize(
    "value",
    [
        rb.Spherical(at=[1, 2, 3], point=[0, 0, 1]),
        rb.Revolute([0, 1, 0], at=[1, 2, 3]),
        rb.Prismatic([0, 1, 0], point=[1, 2, 3]),
        rb.Torque([1, 2, 3]),
        rb.Torque(steer, frame="world"),
        rb.Force([1, 2, 3], frame="body"),
        rb.TorsionSpring(1.0, 0.2, 0.3),
        rb.Scene().add(STONE).point([1, 2, 3]),
    ],
)
def test_joints_loads_and_points_are_data(value):
    again = pickle.loads(pickle.dumps(value))
    assert again == value and hash(again) == hash(value) and repr(again) == repr(value)
    assert value != 0 and value != rb.Free()


def test_the_same_in_other_axes_is_not_the_same():
    assert rb.Force([1, 0, 0]) != rb.Force([1, 0, 0], frame="body")
    assert rb.Torque([1, 0, 0]) != rb.Torque([1, 0, 0], frame="world")
    assert rb.Spherical(at=[0, 0, 1]) != rb.Spherical(point=[0, 0, 1])
    handle = rb.Scene().add(STONE)
    assert handle.point([0, 0, 1]) != handle.point([0, 0, 2])
    assert_array_equal(handle.point([0, 0, 2]).point, [0, 0, 2])
    assert handle.point([0, 0, 2]).body == handle
    with pytest.raises(rb.InvalidInput, match=r"point has shape \(2,\)"):
        handle.point([0, 1])


# --- the same body on its joint, by every engine ---


@pytest.mark.parametrize("engine", ["taylor", "dop853", "cvode-adams"])
def test_engines_agree_on_a_heavy_stone(engine):
    scene, body = held(joint=rb.Spherical(), attitude=ANGLES, angular_velocity=[1, 2, 3])
    usual = rb.simulate(scene, 3.0, error=1e-12)[body].rotation_matrix(3.0)
    run = rb.simulate(scene, 3.0, error=1e-9, engine=engine)
    assert run.engine == engine
    assert abs(run[body].rotation_matrix(3.0) - usual).max() < 1e-8
