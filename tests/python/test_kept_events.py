"""events=: all of them, the last of each, or each handed on."""

import pickle
import resource

import pytest
import rbdyn as rb


def bead():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    hoop = rb.Rail(rb.Circle(0.5, [0, 0, -1], [1, 0, 0]), friction=rb.Coulomb(0.4, 0.1))
    scene.add(rb.Particle(0.5), hoop, parameter=0.0, speed=7.0)
    return scene


def in_parts():
    scene = bead()
    swing = scene.add(rb.Particle(1.0), rb.Rail(rb.Circle(0.5, [0, 0, -1], [1, 0, 0])), parameter=0.1)
    scene.watch("lowest", lambda now: now[swing].parameter)
    return scene


def bouncing():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1])
    scene.contact(ball, rb.Plane([0, 0, 1]), restitution=0.9)
    return scene


def stopping():
    scene = bead()
    scene.watch("enough", lambda now: now.time - 3.0, action="stop")
    return scene


def own():
    system = rb.System(lambda t, x: [x[1], -10.0], [1.0, 0.0], names=["height", "speed"])
    system.watch("floor", lambda now: now["height"], direction="falling", action=lambda now: {0: 0.0, 1: 4.0})
    return system


@pytest.mark.parametrize("given", [{"error": 1e-9}, {"rtol": 1e-9}])
@pytest.mark.parametrize("made", [bead, in_parts, bouncing, stopping, own])
def test_what_is_kept_and_what_is_handed_on_are_the_events_of_the_run(made, given):
    scene, got = made(), []
    whole = rb.simulate(scene, 5.0, **given)
    last, each = rb.simulate(scene, 5.0, events="last", **given), rb.simulate(scene, 5.0, events=got.append, **given)
    assert len(whole.events) > 2
    assert got == list(whole.events)
    groups = {}
    for event in whole.events:
        groups.setdefault((event.kind, event.name, event.subject), []).append(event)
    assert sorted(e.time for e in last.events) == sorted(group[-1].time for group in groups.values())
    for event in last.events:
        assert event.count == len(groups[event.kind, event.name, event.subject])
    ending = [e for e in whole.events if whole.status == "stopped by event" and e.time == whole.end]
    assert list(each.events) == ending and bool(ending) == (made is stopping)
    assert last.statistics.events == each.statistics.events == len(whole.events)
    for run in (last, each):
        assert (run.end, run.status, run.error) == (whole.end, whole.status, whole.error)
        assert len(str(run).splitlines()) == len(str(whole).splitlines())
    assert pickle.loads(pickle.dumps(last.events)) == last.events


def test_a_run_that_goes_on_hands_on_its_own_events():
    half, got = rb.simulate(bead(), 3.0), []
    whole = rb.simulate(half, 6.0)
    rb.simulate(half, 6.0, events=got.append)
    assert got == list(whole.events) and got


@pytest.mark.parametrize("given", [{"error": 1e-9}, {"rtol": 1e-9}])
def test_what_the_function_raises_arrives_with_the_run(given):
    def refuse(event):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine") as caught:
        rb.simulate(bead(), 6.0, events=refuse, **given)
    assert isinstance(caught.value.run, rb.Trajectory)


@pytest.mark.parametrize("events", ["first", 3, None])
def test_anything_else_is_refused(events):
    with pytest.raises(rb.InvalidInput, match='it is (one of )?"all", "last"'):
        rb.simulate(bead(), 1.0, events=events)


def test_work_says_that_it_needs_the_events():
    run = rb.simulate(bouncing(), 3.0, events="last")
    with pytest.raises(rb.InvalidInput, match="did not keep its events"):
        run.work(0.0, 3.0)


def test_a_long_run_of_impacts_takes_no_more_memory():
    def grown(count):
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        run = rb.simulate(own(), 0.8 * count, rtol=1e-8, keep="end", events="last")
        assert run.events[-1].count == pytest.approx(count, abs=2)
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before

    grown(1000)
    assert grown(200_000) < 10_000  # kB; all events and modes of it take 90 MB
