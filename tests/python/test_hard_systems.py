"""Systems of one's own where f has corners, roots and jumps, and where motion comes to a point of no return."""

import math

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp

ENGINES = ["taylor", "dop853", "cvode-adams", "cvode-bdf"]


def switches(run):
    return [(e.name, e.direction) for e in run.events if e.kind == "switch"]


@pytest.mark.parametrize("engine", ENGINES)
def test_a_sign_is_passed_once_each_way(engine):
    # x'' = -sign(x) from rest at 1 swings with the period 4 sqrt(2)
    run = rb.simulate(rb.System(lambda t, x: [x[1], -np.sign(x[0])], [1.0, 0.0]), 20.0, engine=engine, error=1e-7)
    quarter = math.sqrt(2.0)
    assert [e.time for e in run.events] == pytest.approx([(2 * k + 1) * quarter for k in range(7)], abs=2e-6)
    assert switches(run) == [("sign", ("falling", "rising")[k % 2]) for k in range(7)]


def test_two_signs_that_change_together_are_two_events():
    run = rb.simulate(
        rb.System(lambda t, x: [-1 + 0.1 * np.sign(x[0]), -1 + 0.1 * np.sign(x[1])], [1.0, 1.0]), 2.0, error=1e-9
    )
    assert switches(run) == [("sign", "falling")] * 2
    assert len({e.time for e in run.events}) == 1


def test_a_sign_in_a_mechanism_is_passed_once():
    scene = rb.Scene(gravity=[0, 0, 0])
    wheel = scene.add(rb.shapes.disc(1.0, radius=0.2, normal=[0, 0, 1]), rb.Revolute([0, 0, 1]), angle=0.3)
    scene.add(
        rb.shapes.rod(0.1, length=0.1, along=[1, 0, 0]), rb.Revolute([0, 0, 1], at=[0.1, 0, 0]), parent=wheel, angle=0.2
    )
    scene.apply(rb.JointTorque(lambda t, q, rate: -np.sign(q)), wheel)
    run = rb.simulate(scene, 3.0, error=1e-8)
    times = [e.time for e in run.events if e.kind == "switch"]
    assert len(times) > 4 and len(set(times)) == len(times)


def hertz(t, x):
    return [x[1], -9.81 + 1e3 * np.maximum(-x[0], 0) ** 1.5]


@pytest.mark.parametrize("engine", ENGINES)
def test_a_power_three_halves_is_entered_and_left(engine):
    error = 1e-9 if engine in ENGINES[:2] else 1e-6
    run = rb.simulate(rb.System(hertz, [1.0, 0.0]), 5.0, engine=engine, error=error)
    # a period is the fall of 1 m, twice, and the contact; nothing is lost in it
    in_contact = solve_ivp(
        lambda t, x: [x[1], -9.81 + 1e3 * max(-x[0], 0.0) ** 1.5],
        (0, 1),
        [0.0, -math.sqrt(2 * 9.81)],
        method="DOP853",
        rtol=1e-13,
        atol=1e-15,
        events=lambda t, x: x[0] if t > 0.01 else -1.0,
    ).t_events[0][0]
    fall = math.sqrt(2 / 9.81)
    times = [fall + k * (2 * fall + in_contact) + c for k in range(5) for c in (0.0, in_contact)]
    assert [e.time for e in run.events] == pytest.approx(times, rel=2 * error + 1e-11)
    since = 5.0 - times[-1]
    height = math.sqrt(2 * 9.81) * since - 9.81 / 2 * since**2
    assert run.x(5.0)[0] == pytest.approx(height, abs=5 * error)


def test_a_hertzian_ball_bounces_on_and_on():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1.0])
    scene.apply(rb.Force(lambda t, r, v: [0, 0, 1e3 * np.maximum(-r[2], 0) ** 1.5]), ball)
    run = rb.simulate(scene, 150.0, error=1e-6)
    assert run.status == "reached end" and len(run.events) == 283
    assert run.energy(149.0) == pytest.approx(run.energy(0.0), rel=1e-6)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("way", [{"error": 1e-6}, {"rtol": 1e-6}])
@pytest.mark.parametrize(
    ("f", "arrives"),
    [
        (lambda t, x: [-(x[0] ** (1 / 3))], 1.5),
        (lambda t, x: [-(x[0] ** 0.4)], 5 / 3),
        (lambda t, x: [-(x[0] ** (2 / 3))], 3.0),
        (lambda t, x: [-np.sqrt(x[0])], 2.0),
        (lambda t, x: [-1 / x[0]], 0.5),
    ],
)
def test_what_comes_to_a_root_at_its_zero_ends_there_and_says_where(f, arrives, engine, way):
    if arrives == 0.5 and engine == "cvode-bdf" and "rtol" in way:
        pytest.skip("with a local tolerance alone its steps pass the pole, and nothing estimates what that does")
    system = rb.System(f, [1.0], names=["level"])
    try:
        run = rb.simulate(system, 6.0, engine=engine, max_steps=1_000_000, **way)
    except rb.IntegrationError as end:
        assert "level" in str(end)
        run = end.run
        assert run.end > 0.8 * arrives
        # up to there it is what it is, and zero where it has arrived
        assert abs(run.x(min(run.end, arrives))[0]) < 1e-2
        assert abs(run.x(run.end)[0]) < 1e-2
    except rb.AccuracyError as end:
        assert end.run.certain_until <= arrives * (1 + 1e-6)
    else:
        # or it is held to be zero, as exactly as was asked
        assert run.status in ("step limit", "reached end")
        assert abs(run.x(run.end)[0]) < 1e-4


@pytest.mark.parametrize("engine", ENGINES[1:])
@pytest.mark.parametrize("way", [{"error": 1e-6}, {"rtol": 1e-6}])
def test_what_is_called_back_and_chatters_ends_with_its_name(engine, way):
    system = rb.System(lambda t, x: [-math.copysign(1.0, x[0]), 1.0], [1.0, 0.0], names=["slip", "time"])
    with pytest.raises(rb.IntegrationError, match=r"inconsistent at t = 1\.0.*rate of slip jumps from") as failure:
        rb.simulate(system, 3.0, engine=engine, **way)
    run = failure.value.run
    assert run.end == pytest.approx(1.0, abs=1e-3)
    assert run.x(0.5) == pytest.approx([0.5, 0.5], abs=1e-6)
    # recorded, it slides
    assert rb.simulate(rb.System(lambda t, x: [-np.sign(x[0])], [1.0]), 3.0).x(3.0) == 0.0


# with less memory than the steps allowed would take it is said that they would
@pytest.mark.filterwarnings("ignore:simulate. what this run keeps:RuntimeWarning")
def test_a_motion_to_infinity_that_swings_ever_faster_ends():
    # x' > x^1.75 is infinite after 4/3; to resolve the sine to there takes steps without end
    run = rb.simulate(rb.System(lambda t, x: [x[0] ** 1.75 + 0.04 * np.sin(3 * x[0]) + 0.1], [1.0]), 9.0, rtol=1e-9)
    assert run.status == "step limit" and 1.0 < run.end < 4 / 3 and run.statistics.steps < 200_000


def test_steps_as_short_as_an_explicit_engine_needs_get_on():
    # stiff: hardly anything moves in a step, and the run comes to its end
    system = rb.System(lambda t, x: [-1e4 * (x[0] - math.cos(float(t)))], [1.0])
    run = rb.simulate(system, 1.0, engine="dop853", rtol=1e-6)
    assert run.status == "reached end" and run.x(1.0)[0] == pytest.approx(math.cos(1.0), abs=1e-4)


def test_bounces_without_end_are_named():
    ball = rb.System(lambda t, x: [x[1], -1.0 + 0 * x[0]], [1.0, 0.0])
    ball.watch("floor", lambda now: now.x[0], direction="falling", action=lambda now: [0.0, -0.5 * now.x[1]])
    with pytest.raises(rb.IntegrationError, match='watch "floor" changes the state ever sooner') as failure:
        rb.simulate(ball, 50.0)
    run = failure.value.run
    # the fall, and bounces each half as long as the one before: sqrt(2) (1 + 2 (1/2 + 1/4 + ...))
    assert run.end == pytest.approx(3 * math.sqrt(2.0), rel=1e-12)
    assert (run.events[-1].kind, run.events[-1].name) == ("accumulation", "floor")


@pytest.mark.parametrize("scale", [1e-240, 1e-160, 1e160, 1e240])
@pytest.mark.parametrize("engine", ["taylor", "dop853", "cvode-adams"])
def test_units_as_far_as_doubles_go_change_no_digit_that_is_told(scale, engine):
    def pendulum(size):
        return rb.System(lambda t, x: [x[1], -np.sin(x[0] / size) * size], [2.0 * size, 0.0])

    times = np.linspace(0, 30, 301)
    exact = rb.simulate(pendulum(1.0), 30.0, error=1e-12).x(times)
    run = rb.simulate(pendulum(scale), 30.0, engine=engine, error=1e-6)
    off = np.abs(run.x(times) / scale - exact).max() / 2.0
    assert off < 1e-6 and off < run.error


def test_units_beyond_are_refused():
    with pytest.raises(rb.InvalidInput, match=r"System: x0\[1\] is 1e\+?280; a state is below 1e250"):
        rb.System(lambda t, x: [x[1], -x[0]], [0.0, 1e280])
    with pytest.raises(rb.InvalidInput, match="the largest number of its motion is 1e-300"):
        rb.simulate(rb.System(lambda t, x: [x[1], -np.sin(x[0])], [1e-300, 0.0]), 10.0)
    scene = rb.Scene()
    scene.add(rb.Particle(1.0), position=[2e170, 0, 0])
    with pytest.raises(rb.InvalidInput, match=r"particle 1: the largest number of its start is 2e\+?170"):
        rb.simulate(scene, 1.0)


@pytest.mark.parametrize("changed", [{5: 1.0}, {-3: 1.0}, {2**70: 1.0}])
def test_an_action_that_changes_what_is_not_there_is_refused(changed):
    system = rb.System(lambda t, x: [x[1], -x[0]], [1.0, 0.0])
    system.watch("half", lambda now: now.x[0] - 0.5, action=lambda now: changed)
    with pytest.raises(rb.InvalidInput, match='watch "half"'):
        rb.simulate(system, 5.0)
    with pytest.raises(rb.InvalidInput):
        rb.simulate(rb.System(lambda t, x: [x[1], -x[0]], [1.0, 0.0]), 5.0, initial=changed)


def test_a_rate_that_is_not_finite_is_named_with_its_value_and_place():
    system = rb.System(lambda t, x: [-1.0 + 0 * x[0], np.log(x[0])], [1.0, 0.0], names=["a", "b"])
    with pytest.raises(rb.IntegrationError, match=r"the rate of b, .*at .*a|the rate of b, which is"):
        rb.simulate(system, 3.0)
