"""simulate(): options, failures with what there is of the run, Ctrl-C, threads, progress."""

import itertools
import threading
import time

import numpy as np
import pytest
import rbdyn as rb


def oscillator():
    """A mass on a spring, of angular frequency 2."""
    scene = rb.Scene()
    mass = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.connect(rb.Spring(4.0), mass, [0, 0, 0])
    return scene, mass


# beyond the patience of any test, in memory that does not grow
ENDLESS = {"until": 1e12, "rtol": 1e-12, "keep": "end", "engine": "taylor"}


@pytest.mark.parametrize("engine", ["auto", "taylor", "dop853", "cvode-adams", "cvode-bdf"])
def test_every_engine_gives_the_motion_of_the_closed_form(engine):
    scene, mass = oscillator()
    run = rb.simulate(scene, until=3.0, error=1e-8, engine=engine)
    assert run.error <= 1e-8
    t = np.linspace(0, 3, 31)
    np.testing.assert_allclose(run[mass].position(t)[:, 0], np.cos(2 * t), rtol=0, atol=1e-7)
    assert run.engine == ("closed form" if engine == "auto" else engine)


def test_linear_equations_are_solved_by_modes():
    scene, mass = oscillator()
    plan = rb.plan(scene)
    assert plan.engine == "closed form"
    assert plan.reason == "modes of a linear scene: exact at every time, whatever the time"
    run = rb.simulate(scene, until=1e6, error=1e-14)
    assert run.engine == "closed form" and run.statistics.steps == 0
    assert run[mass].position(1e6)[0] == pytest.approx(np.cos(2e6), abs=4e-15)
    row = rb.cost(scene, until=1e3, engines=["closed form"], budget=0.5)[0]
    assert row.engine == "closed form" and row.error < 1e-14
    # a field turns velocities: no modes of real numbers
    ball = scene.add(rb.Particle(1.0), velocity=[1, 0, 0])
    scene.apply(rb.Lorentz(2.0, [0, 0, 1]), ball)
    assert "exponential of a linear scene" in rb.plan(scene).parts[1].reason
    # a spring of some length does not pull in proportion
    scene.connect(rb.Spring(4.0, rest_length=1.0), mass, [0, 0, 1])
    with pytest.raises(rb.InvalidInput, match="equations of particle 1 are not linear"):
        rb.simulate(scene, 1.0, engine="closed form")


def test_a_run_may_start_at_any_time():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0))
    scene.apply(rb.Force(lambda t, r, v: [t, 0, 0]), ball)
    run = rb.simulate(scene, until=3.0, start=1.0)
    assert run.start == 1.0
    assert run[ball].velocity(3.0)[0] == pytest.approx(4.0, rel=1e-9)


def test_particles_without_forces_stay_where_they_are_put():
    scene = rb.Scene()
    particles = [scene.add(rb.Particle(1.0), position=[x, 1, 0]) for x in (0.0, 0.75)]
    run = rb.simulate(scene, 1.0)
    for particle in particles:
        np.testing.assert_array_equal(run[particle].position(1.0), run[particle].position(0.0))


def test_with_a_local_tolerance_there_is_no_estimate():
    scene, mass = oscillator()
    run = rb.simulate(scene, 3.0, rtol=1e-10)
    assert run.error is None and run.statistics.runs == 1
    assert run[mass].position(3.0)[0] == pytest.approx(np.cos(6.0), abs=1e-8)
    assert "no estimate" in str(run)


def test_of_a_run_only_the_end_or_some_times_may_be_kept():
    scene, mass = oscillator()
    end = rb.simulate(scene, 100.0, engine="taylor", keep="end")
    assert end[mass].position(100.0)[0] == pytest.approx(np.cos(200.0), abs=1e-8)
    with pytest.raises(rb.InvalidInput, match="keep"):
        end[mass].position(1.0)
    # the start is known, and the drift between the two
    assert end[mass].position(0.0)[0] == 1.0
    assert 0.0 <= end.drift["energy"] < 1e-8
    times = rb.simulate(scene, 100.0, engine="taylor", keep=[70.0, 20.0])
    np.testing.assert_allclose(times[mass].position([20.0, 70.0])[:, 0], np.cos([40.0, 140.0]), atol=1e-8)
    assert times.t.size < rb.simulate(scene, 100.0, engine="taylor").t.size


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"until": 0.0}, "until is 0"),
        ({"until": np.nan}, "until is nan"),
        ({"until": 1.0, "error": 0.0}, "error is 0"),
        ({"until": 1.0, "rtol": 1.0}, "rtol is 1"),
        ({"until": 1.0, "engine": "euler"}, 'engine is "euler".*taylor'),
        ({"until": 1.0, "keep": "some"}, 'keep is "some"'),
        ({"until": 1.0, "keep": [2.0]}, "keep is 2"),
        ({"until": 1.0, "keep": [[0.5]]}, r"keep has shape \(1, 1\)"),
        ({"until": 1.0, "max_steps": 0}, "max_steps is 0"),
        ({"until": 1.0, "progress": "yes"}, "progress is 'yes'"),
    ],
)
def test_an_option_that_breaks_a_rule_is_refused(options, words):
    with pytest.raises(rb.InvalidInput, match=words):
        rb.simulate(oscillator()[0], **options)


def test_the_step_limit_ends_a_run_and_says_so():
    scene, mass = oscillator()
    run = rb.simulate(scene, max_steps=1000, **ENDLESS)
    assert run.status == "step limit" and "max_steps" in run.advice
    assert 0.0 < run.end < ENDLESS["until"]
    assert run[mass].position(run.end)[0] == pytest.approx(np.cos(2 * run.end), abs=1e-6)


def test_an_error_out_of_reach_carries_the_run_and_how_far_it_is_certain():
    # a pendulum that all but stops at the top: errors grow exponentially, again and again
    scene = rb.Scene(gravity=[0, 0, -1.0])
    hoop = rb.Rail(rb.Circle(radius=1.0, start=[0, 0, -1], toward=[1, 0, 0]))
    bead = scene.add(rb.Particle(1.0), hoop, speed=2.0)
    with pytest.raises(rb.AccuracyError, match="was asked for") as caught:
        rb.simulate(scene, until=200.0, error=1e-12)
    run = caught.value.run
    assert isinstance(caught.value, rb.Error) and not isinstance(caught.value, ValueError)
    assert run.status == "accuracy not reached" and 0.0 < run.certain_until < 200.0
    assert run[bead].parameter(1.0) == pytest.approx(4 * np.arctan(np.exp(1.0)) - np.pi, abs=1e-10)


def test_a_motion_that_cannot_go_on_carries_what_there_is():
    # x'' = x^2 blows up in finite time
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[np.sqrt(2 / 3), 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [r[0] ** 2, 0, 0]), ball)
    with pytest.raises(rb.IntegrationError, match="not finite|step limit") as caught:
        rb.simulate(scene, until=10.0, rtol=1e-10)
    run = caught.value.run
    # x = 6/(sqrt(6) - t)^2
    assert run.end == pytest.approx(np.sqrt(6), rel=1e-3)
    assert run[ball].position(1.0)[0] == pytest.approx(6 / (np.sqrt(6) - 1) ** 2, rel=1e-8)


def test_ctrl_c_stops_a_run_within_a_second_and_keeps_it(interrupt):
    scene, mass = oscillator()
    interrupt()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt) as caught:
        rb.simulate(scene, **ENDLESS)
    assert time.monotonic() - began < 1.3
    run = caught.value.run
    assert run.status == "stopped by user" and run.end > 0.0
    assert run[mass].position(run.end).shape == (3,)


def test_steps_of_a_long_chain_ask_on_their_way():
    """They are so long that to ask after each 64 is too late."""
    scene, last = rb.Scene(gravity=[0, 0, -9.81]), {}
    for i in range(250):
        hinge = rb.Revolute([0, 1, 0] if i % 2 else [1, 0, 0], at=[0, 0, -0.5 if i else 0.0], point=[0, 0, 0.5])
        last = {"parent": scene.add(rb.shapes.box(1.0, [0.1, 0.1, 1.0]), hinge, angle=np.sin(i), **last)}
    asked = []
    run = rb.simulate(scene, 100.0, rtol=1e-9, max_steps=40, progress=lambda fraction: asked.append(time.monotonic()))
    assert run.status == "step limit"
    assert len(asked) > 5
    assert np.diff(asked).max() < 1.0


def test_a_run_that_is_ended_on_a_step_goes_on_from_where_the_step_began():
    """A chain so long that a step asks on its way; told to stop, it keeps the steps that are done."""

    class Enough(Exception):
        pass

    def enough(fraction):
        raise Enough

    scene, last = rb.Scene(gravity=[0, 0, -9.81]), {}
    for i in range(150):
        joint = rb.Spherical(at=[0, 0, -0.5 if i else 0.0], point=[0, 0, 0.5])
        spin = [np.sin(i), np.cos(i), np.sin(2 * i)]
        body = scene.add(rb.shapes.box(1.0, [0.1, 0.1, 1.0]), joint, angular_velocity=spin, **last)
        last = {"parent": body}
    whole = rb.simulate(scene, until=0.05, rtol=1e-9)
    begun = rb.simulate(scene, until=0.001, rtol=1e-9)
    with pytest.raises(Enough) as caught:
        rb.simulate(begun, until=100.0, progress=enough)
    ended = caught.value.run
    assert ended.status == "stopped by user" and 0.001 <= ended.end < 0.05
    on = rb.simulate(ended, until=0.05)
    assert np.abs(on[body].position(0.05) - whole[body].position(0.05)).max() < 1e-7


def test_ctrl_c_stops_the_pricing_of_a_scene(interrupt):
    scene, _ = oscillator()
    interrupt()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        rb.cost(scene, 1e5, budget=60.0)
    assert time.monotonic() - began < 1.3


def test_an_exception_of_the_progress_function_arrives_with_the_run():
    class Enough(Exception):
        pass

    def progress(fraction):
        raise Enough

    scene, _ = oscillator()
    with pytest.raises(Enough) as caught:
        rb.simulate(scene, progress=progress, **ENDLESS)
    assert caught.value.run.status == "stopped by user"


def test_other_threads_go_on_while_a_run_is_made():
    scene, _ = oscillator()
    done = threading.Event()

    def work():
        rb.simulate(scene, max_steps=200_000, **ENDLESS)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    ticks = sum(1 for _ in itertools.takewhile(lambda _: not done.wait(0.001), itertools.count()))
    thread.join()
    # held, the lock would let no tick through; far fewer are asked for than a free machine would count
    assert ticks > 10


def test_runs_in_several_threads_are_the_runs_made_alone():
    def drive(t):
        return 1 + np.sin(t) / 2

    scene = rb.Scene(gravity=[0, 0, -1])
    belt = rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(1.0, 0.5), drive=drive)
    block = scene.add(rb.Particle(1.0), belt, speed=1.0)
    scene.connect(rb.Spring(1.0), block, [0, 0, 0])
    alone = rb.simulate(scene, 50.0)
    runs = []
    threads = [threading.Thread(target=lambda: runs.append(rb.simulate(scene, 50.0))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(runs) == 4 and len(alone.events) > 5
    t = np.linspace(0, 50, 101)
    for run in runs:
        np.testing.assert_array_equal(run.events.times("slip"), alone.events.times("slip"))
        np.testing.assert_array_equal(run[block].position(t), alone[block].position(t))


def test_progress_is_a_fraction_that_ends_at_one():
    fractions = []
    scene, _ = oscillator()
    rb.simulate(scene, until=5e5, rtol=1e-12, engine="taylor", keep="end", progress=fractions.append)
    assert len(fractions) > 1 and fractions[-1] == 1.0
    assert fractions == sorted(fractions) and fractions[0] > 0.0


def test_a_progress_bar_is_a_line_on_stderr(capsys):
    scene, _ = oscillator()
    rb.simulate(scene, until=1.0, engine="taylor", progress=True)
    captured = capsys.readouterr()
    assert "100" in captured.err and "%" in captured.err and captured.out == ""
