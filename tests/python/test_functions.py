"""Functions written in plain NumPy: recorded once, and then exactly what their closed forms say."""

import math

import numpy as np
import pytest
import rbdyn as rb

ERROR = 1e-11
# what simulate() promises is relative to the extent of the motion, here of order one
PROMISED = {"rtol": 0, "atol": 10 * ERROR}
TIMES = np.linspace(0.0, 2.0, 21)


def moved_by(force, mass=2.0, velocity=(0.0, 0.0, 0.0), position=(0.0, 0.0, 0.0), gravity=None):
    """The run of a free particle under one force."""
    scene = rb.Scene(gravity=gravity)
    ball = scene.add(rb.Particle(mass), position=position, velocity=velocity)
    scene.apply(rb.Force(force), ball)
    run = rb.simulate(scene, 2.0, error=ERROR)
    return run, run[ball]


def test_a_force_of_time_moves_a_particle_as_its_double_integral():
    _, ball = moved_by(lambda t, position, velocity: [2.0 * np.cos(3 * t), 0, 2.0 * np.exp(-t)])
    x, _, z = ball.position(TIMES).T
    np.testing.assert_allclose(x, (1 - np.cos(3 * TIMES)) / 9, **PROMISED)
    np.testing.assert_allclose(z, np.exp(-TIMES) - 1 + TIMES, **PROMISED)


def test_a_force_toward_the_origin_makes_an_ellipse():
    _, ball = moved_by(lambda t, position, velocity: -8.0 * position, position=[1, 0, 0], velocity=[0, 1, 0])
    x, y, _ = ball.position(TIMES).T
    np.testing.assert_allclose(x, np.cos(2 * TIMES), **PROMISED)
    np.testing.assert_allclose(y, np.sin(2 * TIMES) / 2, **PROMISED)


def test_a_force_across_the_velocity_turns_it():
    field = np.array([0.0, 0.0, 3.0])
    _, ball = moved_by(lambda t, position, velocity: np.cross(velocity, field), mass=1.0, velocity=[1, 0, 0])
    vx, vy, _ = ball.velocity(TIMES).T
    np.testing.assert_allclose(vx, np.cos(3 * TIMES), **PROMISED)
    np.testing.assert_allclose(vy, -np.sin(3 * TIMES), **PROMISED)


@pytest.mark.parametrize(
    "resistance",
    [
        lambda t, r, v: -0.5 * np.linalg.norm(v) * v,
        lambda t, r, v: -0.5 * np.sqrt(v @ v) * v,
        lambda t, r, v: -0.5 * np.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2) * v,
        lambda t, r, v: np.array([-0.5 * abs(v[0]) * v[0], 0, 0]),
        lambda t, r, v: [-np.hypot(v[0], 0 * t) * v[0] / 2, 0.0, 0.0],
        lambda t, r, v: np.multiply(np.negative(v), np.absolute(v)) * np.float32(0.5),
    ],
)
def test_every_way_to_write_quadratic_drag_is_quadratic_drag(resistance):
    # m v' = -c v^2 from v0: v = v0/(1 + c v0 t/m)
    _, ball = moved_by(resistance, mass=1.0, velocity=[2, 0, 0])
    np.testing.assert_allclose(ball.velocity(TIMES)[:, 0], 2 / (1 + TIMES), **PROMISED)


def test_the_zero_of_a_length_is_an_event_where_the_closed_form_says():
    # thrown up along a line against gravity and quadratic drag: the apex is at (v_t/g) atan(v0/v_t), v_t^2 = m g/c
    scene = rb.Scene(gravity=[0, 0, -10.0])
    bead = scene.add(rb.Particle(2.0), rb.Rail(rb.Line([0, 0, 1])), speed=4.0)
    scene.apply(rb.Force(lambda t, r, v: -0.2 * np.linalg.norm(v) * v), bead)
    run = rb.simulate(scene, 1.0, error=ERROR)
    (apex,) = run.events.times("switch")
    assert apex == pytest.approx(np.arctan(0.4), abs=10 * ERROR)
    assert run[bead].speed(apex) == pytest.approx(0.0, abs=10 * ERROR)


def test_a_recorded_drag_is_the_drag_of_the_library():
    def thrown(load):
        scene = rb.Scene(gravity=[0, 0, -9.81])
        ball = scene.add(rb.Particle(0.5), velocity=[3, 1, 5])
        scene.apply(load, ball)
        return rb.simulate(scene, 1.5, error=ERROR)[ball].position(1.5)

    recorded = rb.Force(lambda t, r, v: -0.1 * v - 0.05 * np.linalg.norm(v) * v)
    np.testing.assert_allclose(thrown(recorded), thrown(rb.Drag(linear=0.1, quadratic=0.05)), **PROMISED)


@pytest.mark.parametrize(
    ("function", "value"),
    [
        (lambda t: 2 ** (t + 1), lambda t: 2 ** (t + 1)),
        (lambda t: (t + 1) ** 1.5, lambda t: (t + 1) ** 1.5),
        (lambda t: (t + 1) ** -2, lambda t: (t + 1) ** -2.0),
        (lambda t: np.power(t + 1, t), lambda t: (t + 1) ** t),
        (lambda t: np.tan(t / 2) + np.log(t + 1), lambda t: np.tan(t / 2) + np.log(t + 1)),
        (lambda t: np.tanh(t) - np.square(t), lambda t: np.tanh(t) - t**2),
        (lambda t: 1 - (3 - +t) / (2 + t), lambda t: 1 - (3 - t) / (2 + t)),
        (lambda t: np.float64(2) * t + np.int32(3) + np.array(1.0) * t, lambda t: 3 * t + 3),
        (lambda t: np.dot([1, 2, 3], [t, t, 1]), lambda t: 3 * t + 3),
        (lambda t: 4, lambda t: 4 + 0 * t),
        (np.sin, np.sin),
    ],
)
def test_a_recorded_function_of_time_has_its_values(function, value):
    rail = rb.Rail(rb.Line([1, 0, 0]), drive=function)
    times = np.linspace(0.0, 1.0, 11)
    # a few operations, each rounded
    np.testing.assert_allclose(rail.drive(times), value(times), rtol=1e-14, atol=1e-15)


def test_a_block_that_sticks_to_a_moving_belt_moves_with_it():
    scene = rb.Scene(gravity=[0, 0, -10])
    belt = rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(0.5), drive=lambda t: 2 * np.sin(t))
    block = scene.add(rb.Particle(1.0), belt, parameter=0.0, speed=0.0)
    run = rb.simulate(scene, 2.0, error=ERROR)
    # 2 cos t < mu g: it never slips
    assert len(run.events) == 0
    np.testing.assert_allclose(run[block].position(TIMES)[:, 0], 2 * (1 - np.cos(TIMES)), **PROMISED)
    np.testing.assert_allclose(run[block].speed(TIMES), 2 * np.sin(TIMES), **PROMISED)


def test_a_block_slips_off_when_the_belt_accelerates_beyond_friction():
    scene = rb.Scene(gravity=[0, 0, -10])
    belt = rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(0.5), drive=lambda t: 2 * t**2)
    block = scene.add(rb.Particle(1.0), belt, speed=0.0)
    run = rb.simulate(scene, 2.0, error=ERROR)
    # 4 t = mu g, and from there on the acceleration is mu g
    (slip,) = run.events.times("slip", block)
    assert slip == pytest.approx(1.25, abs=10 * ERROR)
    assert run[block].speed(2.0) == pytest.approx(2 * 1.25**2 + 5 * 0.75, abs=100 * ERROR)


def test_nothing_of_python_runs_during_the_integration():
    calls = []

    def force(t, position, velocity):
        calls.append(t)
        return -position

    run, _ = moved_by(force, position=[1, 0, 0])
    assert len(calls) == 1
    assert run.statistics.python_calls == 0


@pytest.mark.parametrize(
    ("force", "reason"),
    [
        (lambda t, r: r, "takes 2 arguments; it is called with 3"),
        (lambda t, r, v: [1, 2], r"returns shape \(2,\); a force has three components"),
        (lambda t, r, v: None, "returns None; a force has three components"),
        (lambda t, r, v: ["a", 0, 0], "returns 'a'"),
        (lambda t, r, v: [np.nan, 0, 0], "is nan"),
    ],
)
def test_what_is_no_force_is_refused_when_it_is_given(force, reason):
    with pytest.raises(rb.InvalidInput, match=reason) as caught:
        rb.Force(force)
    assert str(caught.value).startswith("Force: ")


def test_an_expression_is_of_no_use_after_its_function_has_returned():
    kept = []
    rb.Force(lambda t, position, velocity: kept.append(t) or position)
    with pytest.raises(rb.InvalidInput, match="has returned"):
        kept[0] + 1
    assert "Expression" in repr(kept[0])


def test_a_function_of_another_is_recorded_too():
    def wind(t):
        return np.array([np.sin(t), 0, 0])

    _, ball = moved_by(lambda t, position, velocity: wind(t) - 0 * velocity, mass=1.0)
    np.testing.assert_allclose(ball.velocity(TIMES)[:, 0], 1 - np.cos(TIMES), **PROMISED)


@pytest.mark.parametrize(
    "sign",
    [
        np.sign,
        lambda v: np.where(v > 0, 1.0, np.where(v < 0, -1.0, 0.0)),
        lambda v: np.array([1.0 if x > 0 else -1.0 if x < 0 else 0.0 for x in v]),
    ],
)
def test_dry_friction_written_with_a_sign_stops_and_holds(sign):
    # deceleration 1 from speed 1: at rest from t = 1 on; the axes without motion stay at rest
    _, ball = moved_by(lambda t, r, v: -1.0 * sign(v), mass=1.0, velocity=[1, 0, 0])
    np.testing.assert_allclose(ball.velocity(TIMES)[:, 0], np.maximum(1 - TIMES, 0), **PROMISED)
    np.testing.assert_allclose(ball.velocity(TIMES)[:, 1:], 0.0, atol=0)


def test_a_wall_by_an_if_bounces_as_its_closed_form_says():
    k = rb.parameter(16.0, "stiffness")

    def wall(t, position, velocity):
        push = -k * position[0] if position[0] > 0 else 0.0
        return np.array([push, 0.0, 0.0])

    load = rb.Force(wall, trace=True)
    for stiffness in (16.0, 25.0):
        k.value = stiffness
        scene = rb.Scene()
        ball = scene.add(rb.Particle(1.0), position=[-1, 0, 0], velocity=[2, 0, 0])
        scene.apply(load, ball)
        run = rb.simulate(scene, 2.0, error=ERROR)
        # in at t = 1/2, half an oscillation later out again with the speed it came with
        out = 0.5 + np.pi / np.sqrt(stiffness)
        np.testing.assert_allclose(run.events.times("switch"), [0.5, out], **PROMISED)
        np.testing.assert_allclose(run[ball].velocity(2.0), [-2, 0, 0], **PROMISED)


def test_a_parameter_is_its_number_in_a_watched_function_that_is_called_back():
    k = rb.parameter(2.0)
    scene = rb.Scene(gravity=[0, 0, -10.0])
    ball = scene.add(rb.Particle(1.0), velocity=[0, 0, 5])
    scene.watch("slow", lambda now: math.fabs(now[ball].velocity[2]) - k, direction="falling")
    (time,) = rb.simulate(scene, 0.6, error=ERROR).events.times("watch")
    assert time == pytest.approx(0.3, abs=10 * ERROR)
