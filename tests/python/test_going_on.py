"""Runs that go on: the same motion, events, sticking, contacts and estimate as without an interruption."""

import copy
import pickle

import numpy as np
import pytest
import rbdyn as rb
from test_pickling import SCENES as EARLIER
from test_pickling import hoop

DOWN = [0, 0, -9.8125]


def ball_on_floor():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1.0], velocity=[0.3, 0, 0])
    scene.contact(ball, rb.Plane([0, 0, 1]), restitution=0.8)
    return scene


def chain():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    above = None
    for _ in range(3):
        link = rb.RigidBody(1.0, [0.1, 0.1, 0.01], com=[0, 0, -0.5])
        above = scene.add(link, rb.Revolute([0, 1, 0], at=[0, 0, 0 if above is None else -1]), parent=above, angle=0.5)
    return scene


def four_bar():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    crank = scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.1], com=[0, 0, 0.5]), rb.Revolute([0, 1, 0]), angle=0.3, rate=1.0)
    coupler = scene.add(
        rb.RigidBody(1.0, [0.2, 0.2, 0.2], com=[1, 0, 0]), rb.Revolute([0, 1, 0], at=[0, 0, 1]), parent=crank
    )
    rocker = scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.1], com=[0, 0, 0.5]), rb.Revolute([0, 1, 0], at=[2.0, 0, 0]))
    scene.constrain(rb.Ball(), coupler.point([2, 0, 0]), rocker.point([0, 0, 1.2]))
    scene.assemble(keep=[crank])
    return scene


def heavy_top():
    scene = rb.Scene(gravity=DOWN)
    body = rb.RigidBody(1.0, [0.2, 0.25, 0.1], com=[0, 0, 0.5])
    scene.add(body, rb.Spherical(), attitude=rb.EulerAngles(0.5, 0.1, 0.2), angular_velocity=[0, 0.5, 20.0])
    return scene


def oscillator():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: -4.0 * r), ball)
    scene.watch("middle", lambda now: now[ball].position[0])
    return scene


SCENES = [*EARLIER, ball_on_floor, chain, four_bar, heavy_top, oscillator]
names = pytest.mark.parametrize("scene_of", SCENES, ids=lambda f: f.__name__)


def told(events):
    return [(e.kind, e.name, e.direction) for e in events]


def state(run, t):
    values = []
    for body in run.bodies:
        motion = run[body]
        values += [motion.position(t), motion.velocity(t)]
        if "rotation_matrix" in motion.quantities:
            values += [motion.rotation_matrix(t).ravel(), motion.angular_velocity(t)]
    return np.concatenate(values)


def assert_goes_on(whole, first, second, error):
    assert second.start == first.end and second.end == whole.end
    together = [*first.events, *second.events]
    assert told(together) == told(whole.events)
    np.testing.assert_allclose([e.time for e in together], [e.time for e in whole.events], rtol=error, atol=0)
    for t in np.linspace(second.start, whole.end, 5)[1:]:
        expected = state(whole, t)
        np.testing.assert_allclose(state(second, t), expected, rtol=0, atol=4 * error * max(1, np.abs(expected).max()))


@names
@pytest.mark.parametrize("how", [{"error": 1e-10}, {"error": 1e-9, "keep": "end"}], ids=str)
def test_a_run_goes_on_as_if_it_had_not_ended(scene_of, how):
    scene = scene_of()
    whole = rb.simulate(scene, until=2.5, error=how["error"])
    for cut in [1.0, 1.7, *[e.time for e in whole.events][:4]]:
        first = rb.simulate(scene, until=cut, **how)
        second = rb.simulate(first, until=2.5)
        assert second.error <= how["error"]
        if "keep" in how:
            assert told([*first.events, *second.events]) == told(whole.events)
            close = 4 * how["error"] * max(1, np.abs(state(whole, 2.5)).max())
            np.testing.assert_allclose(state(second, 2.5), state(whole, 2.5), rtol=0, atol=close)
        else:
            assert_goes_on(whole, first, second, how["error"])


@pytest.mark.parametrize("steps", [1, 3, 7, 20])
def test_parts_that_were_interrupted_go_on_within_the_tolerance(steps):
    """One of them is cut within a step, and goes on with other steps: not with the same bits."""
    scene = rb.Scene(gravity=DOWN)
    hoop = rb.Rail(rb.Circle(0.5, start=[0, 0, -1], toward=[1, 0, 0]))
    one, other = (scene.add(rb.Particle(0.5), hoop, speed=speed) for speed in (4.3, 3.1))
    options = {"rtol": 1e-9, "engine": "taylor"}
    whole = rb.simulate(scene, 6.0, **options)
    first = rb.simulate(scene, 6.0, max_steps=steps, **options)
    assert first.status == "step limit" and len(whole.plan.parts) == 2
    on = rb.simulate(first, 6.0, max_steps=10**6)
    t = np.linspace(first.end, 6.0, 101)
    for body in (one, other):
        np.testing.assert_allclose(on[body].parameter(t), whole[body].parameter(t), rtol=0, atol=1e-7)


@names
def test_a_run_that_was_interrupted_goes_on_with_the_same_bits(scene_of):
    scene = scene_of()
    whole = rb.simulate(scene, until=2.5, rtol=1e-10)
    if whole.statistics.steps < 4:
        pytest.skip("it has no step to be interrupted after")
    # as many events as steps may be taken count as too many
    for steps in {n for n in range(whole.statistics.steps) if n > len(whole.events) and n % 3 == 1}:
        first = rb.simulate(scene, until=2.5, rtol=1e-10, max_steps=steps)
        if whole.plan.parts and first.status == "reached end":
            continue
        assert first.status == "step limit"
        second = rb.simulate(pickle.loads(pickle.dumps(first)), until=2.5, max_steps=10**6)
        assert told([*first.events, *second.events]) == told(whole.events)
        assert [e.time for e in (*first.events, *second.events)] == [e.time for e in whole.events]
        # parts that were not begun, or had gone further, are computed from their start
        if not whole.plan.parts:
            assert np.array_equal(second.t[1:], whole.t[len(first.t) :])
            for t in np.linspace(second.start, 2.5, 7)[1:]:
                assert np.array_equal(state(second, t), state(whole, t))


@names
def test_a_loaded_run_goes_on_as_the_saved_one(scene_of, tmp_path):
    run = rb.simulate(scene_of(), until=1.0, error=1e-9)
    run.save(tmp_path / "run.npz")
    here, there = rb.simulate(run, until=2.0), rb.simulate(rb.load(tmp_path / "run.npz"), until=2.0)
    assert here.events == there.events and here.error == there.error
    for t in np.linspace(1.0, 2.0, 5):
        assert np.array_equal(state(here, t), state(there, t))


def test_a_run_goes_on_many_times_with_its_estimate():
    whole = rb.simulate(hoop(), until=6.0, error=1e-10)
    run, events = rb.simulate(hoop(), until=0.25, error=1e-10), []
    while run.end < 6.0:
        events += run.events
        run = rb.simulate(run, until=run.end + 0.25)
        assert run.error <= 1e-10
    assert told([*events, *run.events]) == told(whole.events)
    np.testing.assert_allclose(state(run, 6.0), state(whole, 6.0), rtol=0, atol=1e-10)


def test_what_sticks_goes_on_sticking():
    run = rb.simulate(hoop(), until=5.5)
    assert run.events[-1].kind == "stick"
    on = rb.simulate(run, until=1e6)
    (bead,) = run.bodies
    assert len(on.events) == 0 and on[bead].speed(1e6) == 0.0
    assert np.array_equal(on[bead].position(1e6), run[bead].position(5.5))


def test_an_interrupt_leaves_a_run_that_goes_on():
    class Enough(Exception):
        pass

    def stop(fraction):
        if fraction > 0.4:
            raise Enough

    scene = heavy_top()
    with pytest.raises(Enough) as interrupted:
        rb.simulate(scene, until=4e3, rtol=1e-11, progress=stop)
    first = interrupted.value.run
    assert 0 < first.end < 4e3
    second, whole = rb.simulate(first, until=4e3), rb.simulate(scene, until=4e3, rtol=1e-11)
    assert second.start == first.end and np.array_equal(state(second, 4e3), state(whole, 4e3))
    # and with an estimate
    with pytest.raises(Enough) as interrupted:
        rb.simulate(scene, until=1e3, error=1e-6, progress=stop)
    first = interrupted.value.run
    assert 0 < first.end <= 1e3
    second = rb.simulate(first, until=1.1e3)
    assert second.start == first.end and second.error <= 1e-6
    np.testing.assert_allclose(
        state(second, 1.1e3), state(rb.simulate(scene, until=1.1e3, error=1e-6), 1.1e3), rtol=0, atol=4e-5
    )


def test_what_stopped_a_run_does_not_stop_it_again():
    def watched(action):
        scene = hoop()
        bead = scene.bodies[0]
        scene.watch("side", lambda now: now[bead].position[0] - 0.25, action=action)
        return scene

    whole = rb.simulate(watched("record"), until=6.0, error=1e-10)
    run, events = rb.simulate(watched("stop"), until=6.0, error=1e-10), []
    for _ in range(100):
        events += run.events
        if run.status == "reached end":
            break
        assert run.status == "stopped by event" and run.events[-1].name == "side"
        run = rb.simulate(run, until=6.0)
    assert told(events) == told(whole.events)
    np.testing.assert_allclose([e.time for e in events], [e.time for e in whole.events], rtol=1e-10)
    np.testing.assert_allclose(state(run, 6.0), state(whole, 6.0), rtol=0, atol=1e-10)


def test_where_the_error_is_out_of_reach_it_goes_on_from_where_it_is_certain():
    scene = rb.Scene(gravity=[0, 0, -1.0])
    circle = rb.Circle(radius=1.0, start=[0, 0, -1], toward=[1, 0, 0])
    scene.add(rb.Particle(1.0), rb.Rail(circle), speed=2.0)  # a pendulum that all but stops at the top
    with pytest.raises(rb.AccuracyError) as broken:
        rb.simulate(scene, 200.0, error=1e-12)
    first = broken.value.run
    assert 0 < first.certain_until < first.end
    with pytest.raises(rb.AccuracyError):
        rb.simulate(first, until=200.0)
    later = first.certain_until + 1.0
    second = rb.simulate(first, until=later, error=1e-6)
    assert second.start == first.certain_until and second.error <= 1e-6
    # u = gd(t) turned: sin(u / 2) = tanh t on the separatrix
    (bead,) = first.bodies
    for t in np.linspace(second.start, later, 4):
        np.testing.assert_allclose(np.sin(second[bead].parameter(t) / 2), np.tanh(t), rtol=0, atol=1e-6)


def test_a_motion_that_cannot_be_continued_ends_again_where_it_did():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[np.sqrt(2 / 3), 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [r[0] ** 2, 0, 0]), ball)
    for how in ({"rtol": 1e-10}, {"error": 1e-9}):
        with pytest.raises(rb.IntegrationError) as broken:
            rb.simulate(scene, until=10.0, **how)
        with pytest.raises(rb.IntegrationError) as again:
            rb.simulate(broken.value.run, until=10.0)
        assert abs(again.value.run.end - broken.value.run.end) <= 1e-9 * broken.value.run.end


def test_at_the_end_of_a_rail_there_is_nothing_to_go_on_with():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    rail = rb.Rail(rb.Polynomial([[0, 0, 0], [1, 0, -1]], domain=(0, 1)))
    scene.add(rb.Particle(1.0), rail, name="bead")
    run = rb.simulate(scene, until=5.0)
    assert run.status == "stopped by event"
    with pytest.raises(rb.InvalidInput, match="bead is at the end of its rail"):
        rb.simulate(run, until=6.0)
    with pytest.raises(rb.InvalidInput, match="until is 0.1"):
        rb.simulate(run, until=0.1)


def test_a_run_goes_on_as_it_was_asked_for_or_as_is_asked_now():
    scene = chain()
    first = rb.simulate(scene, until=1.0, rtol=1e-8, engine="dop853")
    second = rb.simulate(first, until=2.0)
    assert second.error is None and second.engine == "dop853"
    third = rb.simulate(first, until=2.0, error=1e-10, engine="taylor")
    assert third.error <= 1e-10 and third.engine == "taylor"
    whole = rb.simulate(scene, until=2.0, error=1e-11)
    np.testing.assert_allclose(state(third, 2.0), state(whole, 2.0), rtol=0, atol=1e-8)
    # more accurate than the first part was
    rough = rb.simulate(scene, until=1.0, error=1e-5)
    fine = rb.simulate(rough, until=2.0, error=1e-11)
    assert fine.start == 1.0 and fine.error <= 1e-11
    np.testing.assert_allclose(state(fine, 2.0), state(whole, 2.0), rtol=0, atol=1e-9)
    with pytest.raises(rb.InvalidInput, match="give one"):
        rb.simulate(first, until=2.0, error=1e-9, rtol=1e-9)


def test_angles_count_on():
    scene = heavy_top()
    whole, first = rb.simulate(scene, until=4.0), rb.simulate(scene, until=2.0)
    (body,) = scene.bodies
    for run in (first, copy.deepcopy(first), rb.simulate(scene, until=2.0, keep=[0.5, 2.0])):
        for how in ({}, {"keep": [2.5, 4.0]}):
            on = rb.simulate(run, until=4.0, **how)
            for t in (2.5, 4.0):
                np.testing.assert_allclose(on[body].euler_angles(t), whole[body].euler_angles(t), rtol=0, atol=1e-7)
    assert abs(whole[body].euler_angles(4.0)[2]) > 20  # turns were counted


def test_numbers_are_those_of_the_run():
    k = rb.parameter(4.0)
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: -k * r), ball)
    run = rb.simulate(scene, until=1.0)
    k.value = 9.0
    on = rb.simulate(run, until=3.0)
    np.testing.assert_allclose(on[ball].position(3.0)[0], np.cos(6.0), rtol=0, atol=1e-9)
