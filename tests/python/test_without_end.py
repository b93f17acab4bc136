"""Runs without an end of their own, and runs that would need more memory than there is."""

import math
import warnings

import numpy as np
import pytest
import rbdyn as rb


def falling(height=3.0):
    scene = rb.Scene(gravity=[0, 0, -9.81])
    stone = scene.add(rb.Particle(1.0), position=[0, 0, height], name="stone")
    scene.watch("ground", lambda now: now[stone].position[2], action="stop")
    return scene


def swinging(end):
    scene = rb.Scene(gravity=[0, 0, -9.81])
    rod = scene.add(rb.shapes.rod(1.0, 1.0, [0, 0, 1]), rb.Revolute([0, 1, 0], point=[0, 0, 0.5]), angle=1.0)
    scene.apply(rb.Drag(1e-12), rod)
    scene.watch("enough", lambda now: now.time - end, action="stop")
    return scene


@pytest.mark.parametrize("height", [1e-6, 3.0, 1e7])
def test_a_run_until_infinity_ends_where_it_is_stopped(height):
    fall = math.sqrt(2 * height / 9.81)
    run = rb.simulate(falling(height), math.inf)
    assert run.status == "stopped by event" and run.end == pytest.approx(fall, rel=1e-9)
    assert run.end == pytest.approx(rb.simulate(falling(height), 3 * fall).end, rel=1e-15)
    shown = []
    rb.simulate(falling(height), until=math.inf, progress=shown.append)
    assert shown[-1] == 1.0


def test_an_end_of_a_rail_stops_it_and_it_goes_on_and_keeps_what_it_is_told():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    slope = rb.Rail(rb.Polynomial([[0, 0, 0], [1, 0, -1]], domain=(0, 40)))
    scene.add(rb.Particle(1.0), slope)
    length = 40 * math.sqrt(2)
    end = math.sqrt(2 * length / (9.81 / math.sqrt(2)))
    first = rb.simulate(scene, 1.0)
    for run in (rb.simulate(scene, math.inf, keep=[0.5, 1.5, 3.0]), rb.simulate(first, math.inf)):
        assert run.end == pytest.approx(end, rel=1e-12)
        assert run.events[-1].kind == "rail-end"


def test_functions_of_events_are_called_with_those_of_the_run_alone():
    scene, got = swinging(70.0), []
    scene.watch("lowest", lambda now: now[scene.bodies[0]].angle)
    run = rb.simulate(scene, math.inf, events=got.append, rtol=1e-10)
    whole = rb.simulate(scene, 100.0, rtol=1e-10)
    assert run.end == 70.0 and len(got) == len(whole.events) > 50
    np.testing.assert_allclose([e.time for e in got], [e.time for e in whole.events], atol=1e-7)


def test_what_nothing_can_stop_is_refused():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    scene.add(rb.Particle(1.0))
    system = rb.System(lambda t, x: [1.0], [0.0])
    for thing in (scene, system):
        with pytest.raises(rb.InvalidInput, match='nothing can stop the run.* action "stop"'):
            rb.simulate(thing, math.inf)
    scene.watch("never", lambda now: now.time + 1.0, action="stop")
    with pytest.raises(rb.InvalidInput, match="nothing stopped the run up to t = 1.15"):
        rb.simulate(scene, math.inf)
    for until in (-math.inf, math.nan):
        with pytest.raises(rb.InvalidInput, match="a time is finite"):
            rb.simulate(scene, until)
    with pytest.raises(rb.InvalidInput, match="a time is finite"):
        rb.simulate_many(scene, {(scene.bodies[0], "velocity"): [[1.0, 0, 0]]}, math.inf)


@pytest.mark.parametrize("given", [{}, {"rtol": 1e-12}])
def test_a_run_that_needs_terabytes_says_so_once(given):
    with pytest.warns(RuntimeWarning, match=r"would take [\d.]+ TB at t = 1e\+10 s; .* of memory are free") as told:
        # without what compares sizes (sizes.py): the warning is of the line that calls
        run = rb.simulate.__wrapped__(swinging(1000.0), 1e10, max_steps=10**12, **given)
    assert run.end == 1000.0 and len(told) == 1
    assert told[0].filename == __file__


def test_a_warning_that_is_an_error_stops_the_run():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(RuntimeWarning, match="TB") as stopped:
            rb.simulate(swinging(1e9), 1e10, rtol=1e-12, max_steps=10**12)
    assert 0 < stopped.value.run.end < 1e6


def test_what_does_not_grow_needs_no_warning():
    # warnings are errors here
    for given in ({"keep": "end"}, {"keep": "end", "rtol": 1e-12, "events": "last"}, {"keep": [1.0, 2.0]}):
        assert rb.simulate(swinging(1000.0), 1e10, **given).end == 1000.0
