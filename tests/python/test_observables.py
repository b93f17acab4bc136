"""What is computed from a motion, against the motion itself: modes, sides of jumps, work, frames, Euler angles."""

import sys
import time
from pathlib import Path

import numpy as np
import pytest
import rbdyn as rb
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

sys.path.insert(0, str(Path(__file__).parents[1] / "random"))
import observables  # noqa: E402

G = [0, 0, -9.81]


def slope(f, t, h=1e-4):
    return (f(t - 2 * h) - 8 * f(t - h) + 8 * f(t + h) - f(t + 2 * h)) / (12 * h)


def test_every_observable_of_scenes_at_random_is_what_the_motion_and_the_laws_say():
    check = observables.main(count=45, seed=5000, quiet=True)
    assert not check.wrong, check.notes[:10]
    assert sum(check.compared.values()) > 5000


# --- the mode says what acts ---


def test_a_distinction_within_a_distinction_is_weighed_once():
    scene = rb.Scene()
    block = scene.add(rb.Particle(1.0), velocity=[1, 0, 0])

    def friction(t, position, velocity):
        v = velocity[0]
        return [rb.where(v > 0, -10 * np.sign(v), 10 * np.sign(-v)) + 3.0, 0, 0]

    scene.apply(rb.Force(friction), block)
    pull = scene.watch("pull", lambda now: now[block].force[0] - 1.0)
    run = rb.simulate(scene, 2.0)
    assert run.end == 2.0 and len(run.events) == 1
    assert_allclose(run[block].acceleration(1.5), 0, rtol=0, atol=1e-15)
    assert_allclose(run[block].force(1.5), 0, rtol=0, atol=1e-15)
    assert run[pull].value(1.5) == pytest.approx(-1.0, abs=1e-15)
    assert run.power(1.5) == 0


def test_a_force_that_jumps_is_on_each_side_of_its_jump_what_the_mode_says():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(2.0), position=[-1, 0, 0], velocity=[1, 0, 0])
    load = scene.apply(rb.Force(lambda t, r, v: [-3 * np.sign(r[0]), rb.where(r[0] > 0, 1.0, 5.0), 0]), ball)
    value = scene.watch("pull", lambda now: now[ball].force[1] - 2)
    run = rb.simulate(scene, 1.0)
    crossing = run.events[0].time
    for side, force in (("before", [3, 5, 0]), ("after", [-3, 1, 0])):
        assert_allclose(run[ball].force(crossing, side=side), force, rtol=0, atol=0)
        assert_allclose(run[ball].acceleration(crossing, side=side), np.array(force) / 2, rtol=0, atol=0)
        assert run[value].value(crossing, side=side) == force[1] - 2
        v = run[ball].velocity(crossing)
        assert run.power(crossing, of=load, side=side) == pytest.approx(force @ v, rel=1e-15)


def test_a_body_on_a_spring_to_a_bead_that_has_left_its_rail_moves_as_reported():
    scene = rb.Scene(gravity=G)
    arc = rb.Curve(lambda u: [np.sin(u), 0 * u, -np.cos(u)], domain=(-1.0, 0.5))
    bead = scene.add(rb.Particle(1.0), rb.Rail(arc, ends="release"), speed=4.0)
    body = scene.add(rb.RigidBody(1.0, [0.1, 0.2, 0.3]), position=[2, 0, 0])
    hinge = scene.add(rb.RigidBody(1.0, [0.1, 0.2, 0.3]), rb.Revolute([0, 1, 0], point=[0.3, 0, 0]))
    for other in (body, hinge):
        scene.connect(rb.Spring(20.0, 0.5), bead, other.point([0.1, 0.2, 0.3]))
    run = rb.simulate(scene, 1.0, error=1e-12)
    t = 0.8
    for other in (body, hinge):
        motion = run[other]
        assert_allclose(motion.angular_acceleration(t), slope(motion.angular_velocity, t), rtol=0, atol=1e-7)
        assert_allclose(motion.acceleration(t), slope(motion.velocity, t), rtol=0, atol=1e-7)
    assert_allclose(
        run[hinge].reaction(t), slope(run[hinge].center_of_mass_velocity, t) - run[hinge].force(t), atol=1e-6
    )


def test_a_hinge_held_by_dry_friction_of_its_own_is_at_rest_in_every_report():
    scene = rb.Scene(gravity=G)
    door = scene.add(rb.RigidBody(1.0, [0.1, 0.2, 0.3]), rb.Revolute([0, 0.1, 1.0], point=[0.3, 0, 0]), rate=1.0)
    scene.apply(rb.Torque(lambda t, r, w: [0, 0, -2 * np.sign(w[2])]), door)
    run = rb.simulate(scene, 3.0, error=1e-11)
    t = run.end
    assert run[door].rate(t) == 0
    assert_allclose(run[door].angular_acceleration(t), 0, rtol=0, atol=0)
    assert_allclose(run[door].reaction(t), [0, 0, 9.81], rtol=0, atol=1e-14)
    assert run.power(t) == 0


def test_frenets_axes_of_a_reaction_turn_with_the_rail():
    def turning(t):
        return np.array([[np.cos(2 * t), -np.sin(2 * t), 0], [np.sin(2 * t), np.cos(2 * t), 0], [0, 0, 1]])

    curve = rb.Helix(0.5, 0.8, start=[1, 0, 0], toward=[0, 1, 0])
    scene = rb.Scene(gravity=G)
    bead = scene.add(rb.Particle(1.0), rb.Rail(curve, motion=turning), speed=1.0)
    run = rb.simulate(scene, 2.0)
    for t in (0.3, 1.1, 1.9):
        frame = curve.frenet(run[bead].parameter(t))
        turn = turning(t)
        axes = np.array([turn @ frame.tangent, turn @ frame.normal, turn @ frame.binormal])
        reaction = run[bead].reaction_frenet(t)
        assert_allclose(reaction, axes @ run[bead].reaction(t), rtol=0, atol=1e-13)
        assert abs(reaction[0]) < 1e-13  # smooth


def test_after_a_release_nothing_goes_along_the_rail():
    scene = rb.Scene(gravity=G)
    rail = rb.Rail(rb.Curve(lambda u: [u, 0 * u, 0.5 * u**2], domain=(-1, 1)), ends="release")
    bead = scene.add(rb.Particle(1.0), rail, speed=6.0)
    speed = scene.watch("speed", lambda now: now[bead].speed - 1)
    place = scene.watch("place", lambda now: now[bead].parameter - 3)
    run = rb.simulate(scene, 1.0, error=1e-12)
    leaves = run.events.times("rail-end")[0]
    motion = run[bead]
    assert motion.speed(leaves, side="before") > 3
    for t in (leaves, 0.5 * (leaves + 1), 1.0):
        assert motion.speed(t) == 0 and motion.tangential_force(t) == 0
        assert motion.parameter(t) == 1.0 and motion.arc_length(t) == motion.arc_length(leaves, side="before")
        assert run[speed].value(t) == -1 and run[place].value(t) == -2
    assert np.linalg.norm(motion.velocity(1.0)) > 3


# --- work ---


def rod():
    scene = rb.Scene(gravity=G)
    law = rb.RigidBody(2.0, com=[0, 0, -0.6], inertia=[0.24, 0.24, 0.0])
    return scene, scene.add(law, rb.Revolute([0, 1, 0]), angle=2.0, rate=1.0)


def test_work_over_a_long_span_of_a_closed_form_is_the_gain_of_kinetic_energy():
    scene, body = rod()
    run = rb.simulate(scene, 1e4)
    gain = run.kinetic_energy(1e4) - run.kinetic_energy(0.0)
    assert run.work(0.0, 1e4) == pytest.approx(gain, rel=1e-13)
    weight = 2.0 * 9.81 * (run[body].center_of_mass(0.0) - run[body].center_of_mass(1e4))[2]
    assert gain == pytest.approx(weight, rel=1e-11)
    with pytest.raises(rb.InvalidInput, match="this run goes from 0 to 10000 s"):
        run.work(0.0, 1.1e4)
    wheel = rb.Scene()
    wheel_body = wheel.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Revolute([0, 0, 1]), angle=1.0, rate=2.0)
    spring = wheel.apply(rb.TorsionSpring(3.0, 0.2, 1e-3), wheel_body)
    long = rb.simulate(wheel, 1e5)
    assert long.engine == "closed form"
    assert long.work(0, 1e5, of=spring) == pytest.approx(long.kinetic_energy(1e5) - long.kinetic_energy(0), rel=1e-13)


@pytest.mark.parametrize("keep", ["end", [0.7, 2.5, 4.0]])
def test_work_is_computed_from_what_was_kept_or_refused(keep):
    scene, body = rod()
    drag = scene.apply(rb.Drag(0.1), body)
    pull = scene.apply(rb.Force([1, 0, 0]), body)
    every, some = rb.simulate(scene, 5.0, error=1e-11), rb.simulate(scene, 5.0, error=1e-11, keep=keep)
    t0, t1 = (0.0, 5.0) if keep == "end" else (0.7, 2.5)
    for of in (None, pull):
        assert some.work(t0, t1, of=of) == pytest.approx(every.work(t0, t1, of=of), rel=1e-9)
    sizes = [float(every.power(t, of=drag)) for t in np.linspace(t0, t1, 20001)]
    assert every.work(t0, t1, of=drag) == pytest.approx(
        np.trapezoid(sizes, dx=(t1 - t0) / 20000)
        if hasattr(np, "trapezoid")
        else np.trapezoid(sizes, dx=(t1 - t0) / 20000),
        rel=1e-6,
    )
    with pytest.raises(rb.InvalidInput, match=r"did not keep the motion between \(keep=\)"):
        some.work(t0, t1, of=drag)


def test_work_leaves_out_what_a_landing_takes():
    scene = rb.Scene(gravity=G)
    circle = rb.Circle(radius=1.0, start=[0, 0, 1], toward=[1, 0, 0])
    bead = scene.add(rb.Particle(0.5), rb.Rail(circle, side="+"), parameter=np.pi, speed=5.6)
    run = rb.simulate(scene, 3.0, error=1e-11)
    (landing, *_) = run.events.times("land")
    lost = run.kinetic_energy(landing) - run.kinetic_energy(landing, side="before")
    assert lost < -0.1
    weight = 0.5 * 9.81 * (run[bead].position(0.0) - run[bead].position(landing))[2]
    assert run.work(0.0, landing) == pytest.approx(weight, rel=1e-9)
    later = min(run.end, landing + 0.05)
    gain = run.kinetic_energy(later) - run.kinetic_energy(0.0)
    assert run.work(0.0, later) == pytest.approx(gain - lost, rel=1e-9)
    some = rb.simulate(scene, 3.0, error=1e-11, keep=[0.05, later])
    with pytest.raises(rb.InvalidInput, match="did not keep"):
        some.work(0.05, later)


# --- Euler angles ---


def path_of(motion, until, start=0.0):
    """Times, and the turns of psi and phi from the quaternion on the way in steps that lose none."""
    t = np.linspace(start, until, 40 * int(until) + 1)
    for _ in range(60):
        q, w = motion.quaternion(t), np.linalg.norm(motion.angular_velocity(t), axis=1)
        q *= np.cumprod(np.concatenate([[1.0], np.where(np.sum(q[1:] * q[:-1], axis=1) < 0, -1.0, 1.0)]))[:, None]
        upright, fallen = q[:, 0] + 1j * q[:, 3], q[:, 1] + 1j * q[:, 2]
        least = np.minimum(abs(upright), abs(fallen))
        coarse = 0.6 * np.diff(t) * np.maximum(w[1:], w[:-1]) > 0.5 * np.minimum(least[1:], least[:-1])
        if not coarse.any():
            break
        assert len(t) < 1e6
        t = np.sort(np.concatenate([t, 0.5 * (t[1:] + t[:-1])[coarse]]))
    s, r = np.unwrap(np.angle(upright)), np.unwrap(np.angle(fallen))
    return t, np.stack([s + r - s[0] - r[0], s - r - s[0] + r[0]], axis=1)


@pytest.mark.parametrize("engine", ["closed form", "taylor"])
def test_euler_angles_go_round_the_poles_without_a_jump(engine):
    rng = np.random.default_rng(3)
    for _ in range(6):
        scene = rb.Scene()
        start = rb.EulerAngles(*rng.normal(size=3))
        body = scene.add(rb.RigidBody(1.0, [1, 2, 2.5]), attitude=start, angular_velocity=rng.normal(size=3) * 3)
        motion = rb.simulate(scene, 40.0, engine=engine, error=1e-10)[body]
        t, turned = path_of(motion, 40.0)
        angles = motion.euler_angles(t)
        assert_allclose(angles[:, 1:] - angles[0, 1:], turned, rtol=0, atol=1e-7)
        assert_allclose(
            motion.rotation_matrix(t), Rotation.from_euler("ZXZ", angles[:, [1, 0, 2]]).as_matrix(), atol=1e-13
        )


def test_euler_angles_of_a_body_that_starts_upright_are_continuous_from_there():
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, [1, 2, 2.5]), angular_velocity=[0.3, 1.0, 0.2])
    motion = rb.simulate(scene, 1.0)[body]
    angles = motion.euler_angles(np.linspace(0, 1, 10001))
    assert abs(np.diff(angles, axis=0)).max() < 1e-3
    assert np.isfinite(motion.euler_rates(0.0)).all()


@pytest.mark.parametrize("engine", ["closed form", "taylor"])
@pytest.mark.parametrize("joint", [rb.Free(), rb.Spherical(), rb.Revolute([0.3, 0, 1])])
def test_runs_that_keep_times_have_the_turns_of_the_motion(joint, engine):
    def scene():
        s = rb.Scene(gravity=G)
        law = rb.RigidBody(1.0, [1, 1, 0.4], com=[0, 0, 0.1])
        hinge = isinstance(joint, rb.Revolute)
        start = {"angle": 0.2, "rate": 9.0} if hinge else {"angular_velocity": [0.4, 0.1, 9.0]}
        return s, s.add(law, joint, **({} if hinge else {"attitude": rb.EulerAngles(0.5, 3.0, -9.0)}), **start)

    times = [0.0, 3.0, 11.0, 20.0]
    found = []
    for keep in ("all", times):
        s, body = scene()
        found.append(rb.simulate(s, 20.0, engine=engine, error=1e-9, keep=keep)[body].euler_angles(times))
    assert_allclose(found[1], found[0], rtol=0, atol=1e-8)
    assert abs(found[0][-1, 1:] - found[0][0, 1:]).max() > 50


@pytest.mark.parametrize("kind", ["stone", "gyroscope", "upright", "top", "tilted top"])
def test_turns_of_a_closed_form_are_known_at_once(kind):
    scene = rb.Scene(gravity=G if "top" in kind else None)
    inertia = [1.0, 1.0, 0.4] if kind in ("gyroscope", "top", "tilted top") else [1.0, 2.0, 2.5]
    start = {} if kind == "upright" else {"attitude": rb.EulerAngles(0.5, 0.3, 0.1)}
    if kind == "tilted top":
        scene = rb.Scene(gravity=[3.0, 1.0, -9.0])
    top = "top" in kind
    law = rb.RigidBody(1.0, inertia, com=[0, 0, 0.1] if top else [0, 0, 0])
    body = scene.add(law, rb.Spherical() if top else rb.Free(), angular_velocity=[0.5, 3.0, 9.0], **start)
    run = rb.simulate(scene, 1e6)
    assert run.engine == "closed form"
    begin = time.perf_counter()
    last = run[body].euler_angles(1e6)
    assert time.perf_counter() - begin < 0.5
    assert abs(last[1:]).max() > 1e5
    # the same as by going through the motion, which short runs do
    _, turned = path_of(run[body], 30.0, start=0.1)
    angles = rb.simulate(scene, 1e6)[body].euler_angles([0.1, 30.0])
    assert_allclose(angles[1, 1:] - angles[0, 1:], turned[-1], rtol=0, atol=1e-6)
