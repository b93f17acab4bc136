"""Events of watched functions with known roots: found whatever the run, once, in order, and at no touch."""

import importlib.util
import pathlib
import sys

import numpy as np
import pytest
import rbdyn as rb


def random_events():
    """The generator of random scenes with known roots."""
    path = pathlib.Path(__file__).parents[1] / "random" / "events.py"
    spec = importlib.util.spec_from_file_location("random_events", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["random_events"] = module
    spec.loader.exec_module(module)
    return module


def along(function, until, **options):
    """x = t, watched at a function of x."""
    scene = rb.Scene()
    clock = scene.add(rb.Particle(1.0), position=[0, 0, 0], velocity=[1, 0, 0])
    scene.watch("watched", lambda now: function(now[clock].position[0]))
    return rb.simulate(scene, until, **options)


def watched(run):
    return [(e.time, e.direction) for e in run.events if e.kind == "watch"]


@pytest.mark.parametrize("engine", ["auto", "taylor", "dop853"])
@pytest.mark.parametrize("until", [1.0, 1e3, 1e6, 1e9])
def test_a_ball_stops_on_the_floor_however_long_the_run(engine, until):
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1])
    scene.watch("floor", lambda now: now[ball].position[2], action="stop")
    run = rb.simulate(scene, until, engine=engine)
    assert run.status == "stopped by event"
    assert run.end == pytest.approx(np.sqrt(2 / 9.81), rel=1e-12)


@pytest.mark.parametrize("place", [1e-3, 1e-7, 1e-13, 1e-20])
def test_what_is_passed_soon_after_the_start_of_a_long_run_is_found(place):
    (event,) = watched(along(lambda x: x - place, 1e6))
    assert event == (pytest.approx(place, rel=1e-12), "rising")


def test_a_touch_is_no_passage():
    for touch in (
        lambda x: abs(x - 1),
        lambda x: -abs(x - 1),
        lambda x: (x - 1) ** 2,
        lambda x: np.minimum(x - 1, 1 - x),
        lambda x: np.where(x < 1, x - 1, 1 - x),
        lambda x: np.linalg.norm([x - 1, 0 * x, 0 * x]),
    ):
        assert watched(along(touch, 2.0)) == []
        assert watched(along(touch, 1.0)) == []


def test_a_corner_where_a_function_passes_zero_is_one_passage():
    run = along(lambda x: np.where(x < 1, x - 1, 3 * (x - 1)), 2.0)
    assert watched(run) == [(pytest.approx(1.0, rel=1e-15), "rising")]


@pytest.mark.parametrize("power", [3, 5, 7, 9, 11, 13, 15])
def test_a_root_of_odd_multiplicity_is_one_event(power):
    for until in (1.1, 2.0, 100.0):
        (event,) = watched(along(lambda x: (x - 1) ** power, until))
        assert event == (pytest.approx(1.0, rel=1e-9), "rising")


def test_a_function_that_starts_a_few_hundred_units_from_its_zero_passes_it():
    scene = rb.Scene()
    start = 1.0 + 450 * 2.0**-52
    ball = scene.add(rb.Particle(1.0), position=[start, 0, 0], velocity=[-1, 0, 0])
    scene.watch("one", lambda now: now[ball].position[0] - 1.0)
    ((time, direction),) = watched(rb.simulate(scene, 10.0))
    assert (time, direction) == (pytest.approx(start - 1.0, rel=1e-12), "falling")


def test_an_event_at_the_very_end_counts_after_others_of_its_function():
    for k in range(200):
        until = 0.5 + 0.0173 * k
        run = along(lambda x, u=until: (x - 0.1 * u) * (x - 0.7 * u) * (x - u), until)
        assert len(watched(run)) == 3, until
        assert run.events[-1].time <= run.end == until


def test_events_of_one_instant_come_in_an_order_of_their_own():
    def names(order):
        scene = rb.Scene()
        clock = scene.add(rb.Particle(1.0), velocity=[1, 0, 0], position=[0, 0, 0])
        factors = {"a": 1.0, "b": -3.0, "c": 0.1}
        for name in order:
            scene.watch(name, lambda now, f=factors[name]: f * (now[clock].position[0] - 0.7))
        run = rb.simulate(scene, 1.0)
        assert len({e.time for e in run.events}) == 1
        return [e.name for e in run.events]

    assert names("abc") == names("cba") == names("bca") == ["a", "b", "c"]


@pytest.mark.parametrize("pull", [lambda t: 4 + t**4, lambda t: 4 + float(t) ** 4])
def test_a_block_at_the_edge_of_its_cone_begins_to_slide_silently(pull):
    # held by 4 N, pulled with 4 + t^4 from the start, recorded and called back
    scene = rb.Scene(gravity=[0, 0, -10])
    rail = rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(0.4))
    block = scene.add(rb.Particle(1.0), rail, parameter=0.0, speed=0.0)
    scene.apply(rb.Force(lambda t, position, velocity: [pull(t), 0, 0]), block)
    run = rb.simulate(scene, 1.0, error=1e-8)
    assert [e.kind for e in run.events] == []
    assert run[block].speed(1.0) == pytest.approx(0.2, rel=1e-6)


@pytest.mark.parametrize("trace", [None, False])
@pytest.mark.parametrize("until", [1.0, 1e5, 1e9, 1e10])
def test_two_places_beside_the_top_of_a_throw_are_found_however_long_the_run(until, trace):
    speed = 9.81 * 0.37
    level = speed**2 / 2 / 9.81 * (1 - 1e-6)
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(1.0), velocity=[0, 0, speed])
    scene.watch("level", lambda now: now[ball].position[2] - level, trace=trace)
    run = rb.simulate(scene, until, error=1e-9)
    assert run.events.times("level") == pytest.approx([0.37 * (1 - 1e-3), 0.37 * (1 + 1e-3)], rel=1e-11)


@pytest.mark.parametrize("engine", ["auto", "taylor", "dop853"])
def test_a_corner_that_a_run_begins_with_is_silent(engine):
    # zero within the rounding of the time at which the run begins, not within that of the place
    for offset in (1.42e-17, -1.42e-17, 0.0):
        for touch in (abs, lambda u: -abs(u), lambda u: np.maximum(u, -u), lambda u: np.where(u < 0, -u, u)):
            scene = rb.Scene(gravity=[0, 0, -0.1])
            ball = scene.add(
                rb.Particle(1.0), position=[0, 0, 1.8624341286327727e-05 + offset], velocity=[0, 0, -3.5e-4]
            )
            scene.watch("watched", lambda now, b=ball, f=touch: f(now[b].position[2] - 1.8624341286327727e-05))
            run = rb.simulate(scene, 160.5, start=158.7815013731243, error=1e-6, engine=engine)
            assert watched(run) == []


@pytest.mark.parametrize("engine", ["auto", "taylor", "dop853"])
@pytest.mark.parametrize("trace", [None, False])
def test_what_is_passed_soon_after_a_start_far_from_zero_is_found(engine, trace):
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1], velocity=[0, 0, 3])
    scene.watch("watched", lambda now: now[ball].position[2] - 0.5, trace=trace)
    start = -(2.0**28)
    run = rb.simulate(scene, start + 1e6, start=start, error=1e-6, engine=engine)
    ((time, direction),) = watched(run)
    assert direction == "falling"
    assert time - start == pytest.approx((3 + np.sqrt(9 + 9.81)) / 9.81, abs=1e-7)


@pytest.mark.parametrize("engine", ["auto", "taylor", "dop853"])
@pytest.mark.parametrize("until", [0.003, 1.0, 1e5])
def test_a_power_is_told_from_a_corner_near_it(engine, until):
    scene = rb.Scene(gravity=[0, 0, -1e8])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 131.25], velocity=[0, 0, 108052.4375])
    scene.watch("corner", lambda now: abs(now[ball].position[2]))
    scene.watch("power", lambda now: ((now[ball].position[2] - 144.625) / 100) ** 7)
    run = rb.simulate(scene, until, error=1e-6, engine=engine)
    root = np.sqrt(108052.4375**2 - 2e8 * (144.625 - 131.25))
    expected = [(108052.4375 - root) / 1e8, (108052.4375 + root) / 1e8]
    assert run.events.times("power") == pytest.approx(expected, rel=1e-6)
    assert len(run.events.times("corner")) == 0


@pytest.mark.cvode
def test_random_scenes_lose_no_event_and_make_none_up():
    count = random_events().tried(200, seed=12)
    assert count.wrong == 0, count.examples[:5]
    assert count.expected > 1000
    # among them those whose first event comes so soon that no double tells its time to the error asked for
    assert sum(count.refused.values()) < 60
