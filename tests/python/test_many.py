"""Many at once: members are what simulate() makes of them, whatever runs them and whatever became of the others."""

import pickle
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
import rbdyn as rb

DOWN = [0, 0, -9.81]


def oscillator():
    k = rb.parameter(4.0, "k")
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], name="ball")
    scene.apply(rb.Force(lambda t, r, v: -k * r), ball)
    return scene, ball, k


def hoop():
    scene = rb.Scene(gravity=DOWN)
    rail = rb.Rail(rb.Circle(1.0, [0, 0, -1], [1, 0, 0]), friction=rb.Coulomb(0.3, 0.2))
    bead = scene.add(rb.Particle(1.0), rail, name="bead")
    scene.watch("round", lambda now: now[bead].parameter - 6.0, action="stop")
    return scene, bead


def top():
    scene = rb.Scene(gravity=DOWN)
    body = rb.shapes.cone(1.0, 0.1, 0.3, [0, 0, 1])
    it = scene.add(body, rb.Spherical(), angular_velocity=[0, 0, 100], name="top")
    scene.apply(rb.Drag(linear=0.01), it, at=[0.0, 0.0, 0.2])
    return scene, it


def double_pendulum():
    bar = rb.RigidBody(1.0, [0.5, 0.5, 0.25], com=[0, 0, -0.5])
    scene = rb.Scene(gravity=DOWN)
    upper = scene.add(bar, rb.Revolute([0, 1, 0]), angle=0.5, name="upper")
    lower = scene.add(bar, rb.Revolute([0, 1, 0], at=[0, 0, -1]), parent=upper, name="lower")
    return scene, upper, lower


def swept():
    """Sweeps of several kinds: scene, what is varied, until, how to make one member."""
    scene, ball, k = oscillator()
    yield scene, {(ball, "position"): np.outer(np.linspace(0.5, 2, 9), [1, 0, 0]), k: np.linspace(1, 9, 9)}, 3.0
    scene, bead = hoop()
    yield scene, {(bead, "speed"): np.linspace(-3, 12, 9), (bead, "parameter"): np.linspace(0, 1, 9)}, 2.0
    scene, it = top()
    tilts = [rb.EulerAngles(theta, 0.1, 0.2) for theta in np.linspace(0.1, 1.0, 5)]
    yield scene, {(it, "attitude"): tilts, (it, "angular_velocity"): np.outer(np.arange(5), [0, 1, 50])}, 0.3
    scene, upper, lower = double_pendulum()
    yield scene, {(upper, "angle"): np.linspace(0, 2, 7), (lower, "rate"): np.linspace(-3, 3, 7)}, 1.0


def one(scene, vary, i, until, **options):
    """A member by itself."""
    numbers = {key: key.value for key in vary if not isinstance(key, tuple)}
    try:
        for key in numbers:
            key.value = vary[key][i]
        initial = {key: values[i] for key, values in vary.items() if isinstance(key, tuple)}
        return rb.simulate(scene, until, initial=initial, **options)
    finally:
        for key, value in numbers.items():
            key.value = value


def same(member, run):
    assert (member.status, member.end, member.error, member.engine) == (run.status, run.end, run.error, run.engine)
    assert member.events == run.events and str(member.plan) == str(run.plan)
    assert member.drift == run.drift
    times = np.linspace(0, run.end, 7)
    for handle in run.bodies:
        for name in run[handle].quantities:
            got, wanted = (getattr(r[handle], name)(times) for r in (member, run))
            assert np.array_equal(got, wanted, equal_nan=True), name
    assert np.array_equal(member.energy(times), run.energy(times))


@pytest.mark.parametrize("options", [{"error": 1e-9}, {"rtol": 1e-9}, {"rtol": 1e-9, "engine": "dop853"}])
def test_members_are_what_simulate_makes_of_them_on_any_number_of_threads(options):
    for scene, vary, until in swept():
        before = pickle.dumps(scene)
        runs = [one(scene, vary, i, until, **options) for i in range(len(next(iter(vary.values()))))]
        for threads in (1, 2, 3, None):
            many = rb.simulate_many(scene, vary, until, threads=threads, **options)
            assert len(many) == len(runs)
            for member, run in zip(many, runs, strict=True):
                same(member, run)
        assert pickle.dumps(scene) == before


def test_executors_of_threads_and_of_processes_give_the_same():
    for scene, vary, until in swept():
        here = rb.simulate_many(scene, vary, until)
        with ThreadPoolExecutor(2) as threads, ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes:
            for pool in (threads, processes):
                many = rb.simulate_many(scene, vary, until, executor=pool)
                for member, run in zip(many, here, strict=True):
                    same(member, run)


@pytest.mark.parametrize("options", [{"error": 1e-9}, {"rtol": 1e-9}, {"rtol": 1e-9, "keep": "end"}])
def test_members_side_by_side_have_the_bits_that_they_have_one_after_the_other(options):
    # as many as there are lanes, and some more, of steps that are of very different lengths
    scene, it = top()
    spins = np.outer(np.logspace(-2, 3, 21), [0, 0.1, 1])
    beads, bead = hoop()
    speeds = np.linspace(-5, 12, 21)
    for swept_scene, vary, until, body in (
        (scene, {(it, "angular_velocity"): spins}, 0.2, it),
        (beads, {(bead, "speed"): speeds}, 3.0, bead),
    ):
        beside, apart = (
            rb.simulate_many(swept_scene, vary, until, threads=1, lanes=lanes, **options) for lanes in (True, False)
        )
        assert beside.status == apart.status
        assert np.array_equal(beside.error, apart.error, equal_nan=True)
        assert np.array_equal(beside.end, apart.end) and (beside.end < until).sum() == (4 if body is bead else 0)
        for a, b in zip(beside, apart, strict=True):
            assert (a.statistics.steps, a.statistics.runs, a.events) == (
                b.statistics.steps,
                b.statistics.runs,
                b.events,
            )
            assert np.array_equal(a[body].velocity(a.end), b[body].velocity(b.end))
            if "keep" not in options:
                same(a, b)


def test_a_cluster_of_dask_gives_the_same():
    distributed = pytest.importorskip("distributed")
    scene, upper, lower = double_pendulum()
    vary = {(upper, "angle"): np.linspace(0, 2, 24), (lower, "rate"): np.linspace(-3, 3, 24)}
    here = rb.simulate_many(scene, vary, 1.0)
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        there = rb.simulate_many(scene, vary, 1.0, executor=client.get_executor())
        used = client.run(lambda: "rbdyn" in __import__("sys").modules)
    assert list(used.values()) == [True, True]
    for member, run in zip(there, here, strict=True):
        same(member, run)


class Immediate(Executor):
    """An executor of one's own: pickles what it is given, as those that send it elsewhere do."""

    def __init__(self):
        self.chunks = 0

    def submit(self, function, /, *args, **kwargs):
        self.chunks += 1
        future = Future()
        try:
            function, args = pickle.loads(pickle.dumps((function, args)))
            future.set_result(pickle.loads(pickle.dumps(function(*args, **kwargs))))
        except Exception as exception:
            future.set_exception(exception)
        return future


def test_any_executor_will_do_and_numbers_keep_their_identity_on_the_way():
    scene, ball, k = oscillator()
    other = rb.parameter(0.5, "other")
    scene.apply(rb.Force(lambda t, r, v: [k * other, 0, 0]), ball)
    vary = {k: np.linspace(1, 9, 40), other: np.linspace(0, 1, 40)}
    pool = Immediate()
    many = rb.simulate_many(scene, vary, 1.0, executor=pool)
    assert 1 < pool.chunks < 40
    for i in (0, 17, 39):
        same(many[i], one(scene, vary, i, 1.0))


def test_a_sweep_plans_once():
    for scene, vary, until in list(swept())[:2]:
        many = rb.simulate_many(scene, vary, until, threads=1)
        assert sum(s.planned for s in many.statistics) <= 2  # one of them starts at rest, in its plane


def test_numbers_stay_what_they_are():
    scene, _, k = oscillator()
    rb.simulate_many(scene, {k: [1.0, 2.0]}, 1.0)
    assert k.value == 4.0
    seen = []
    rb.simulate_many(scene, {k: np.linspace(1, 2, 20000)}, 5.0, progress=lambda fraction: seen.append(k.value))
    assert seen and set(seen) == {4.0}


def test_results_are_arrays_over_the_members():
    scene, ball, k = oscillator()
    n = 6
    x0, stiffness = np.linspace(0.5, 2.0, n), np.linspace(1.0, 9.0, n)
    many = rb.simulate_many(scene, {(ball, "position"): np.outer(x0, [1, 0, 0]), k: stiffness}, until=3.0, error=1e-11)
    times = np.linspace(0.0, 3.0, 5)
    omega = np.sqrt(stiffness)
    assert many.status == ["reached end"] * n and many.error.shape == (n,) and many.error.max() <= 1e-11
    assert np.array_equal(many.end, np.full(n, 3.0)) and many.engine == [many[0].engine] * n
    assert many[ball].position(3.0).shape == (n, 3) and many[ball].position(times).shape == (n, 5, 3)
    assert many[ball].position(times)[:, :, 0] == pytest.approx(x0[:, None] * np.cos(np.outer(omega, times)), abs=1e-10)
    assert many["ball"].velocity(1.0)[:, 0] == pytest.approx(-x0 * omega * np.sin(omega), abs=1e-10)
    assert many.kinetic_energy(times).shape == (n, 5) and many.momentum(0.0).shape == (n, 3)
    assert many.kinetic_energy(1.0, of=ball) == pytest.approx(0.5 * (x0 * omega * np.sin(omega)) ** 2, abs=1e-10)
    assert [len(events) for events in many.events] == [0] * n
    assert many[ball].quantities == many[0][ball].quantities
    assert np.array_equal(many[-1].t, many.runs[n - 1].t)
    assert list(many.vary) == [(ball, "position"), k] and np.array_equal(many.vary[k], stiffness)
    with pytest.raises(IndexError, match="there are 6 members"):
        many[6]
    with pytest.raises(AttributeError):
        many[ball].colour  # noqa: B018
    with pytest.raises(AttributeError):
        many.colour  # noqa: B018
    with pytest.raises(rb.InvalidInput, match='nothing named "bell"'):
        many["bell"]
    with pytest.raises(rb.InvalidInput, match="this run goes from 0 to 3"):
        many[ball].position(4.0)
    with pytest.raises(rb.InvalidInput, match="is a particle"):
        many[ball].quaternion(1.0)
    assert "6 members: 6 reached end" in str(many) and "ball position" in str(many)


def test_rtol_gives_no_estimate():
    scene, _, k = oscillator()
    assert np.isnan(rb.simulate_many(scene, {k: [1.0, 2.0]}, 1.0, rtol=1e-9).error).all()


def meeting():
    """Two bodies that meet if the first starts at rest."""
    scene = rb.Scene()
    a = scene.add(rb.Particle(1.0), position=[1, 0, 0], name="a")
    b = scene.add(rb.Particle(1.0), name="b")
    scene.connect(rb.Gravitation(1.0), a, b)
    return scene, a


def check_one_that_failed(many, a):
    assert many.status == ["reached end", "not finite", "reached end"] and list(many.failed) == [1]
    assert isinstance(many.errors[1], rb.IntegrationError) and many.errors[0] is None
    with pytest.raises(rb.IntegrationError, match="not finite") as caught:
        many[1]
    partial = many.runs[1]
    # two masses 1 from rest at distance 1 meet after pi / 4
    assert caught.value.run.end == partial.end == pytest.approx(np.pi / 4, abs=1e-6)
    x = many[a].position([0.5, 1.5])
    assert np.isnan(x[1, 1]).all() and np.isfinite(x[[0, 2]]).all() and np.isfinite(x[1, 0]).all()
    assert np.array_equal(x[1, 0], partial[a].position(0.5))
    assert np.isnan(many[a].position(1.5)[1]).all() and np.isnan(many.energy(1.5)[1])
    assert "member 1" in str(many) and "1 not finite" in str(many)


def test_a_member_that_fails_stops_no_other_and_keeps_its_run():
    scene, a = meeting()
    vary = {(a, "velocity"): [[0, 1, 0], [0, 0, 0], [0, 1.2, 0]]}
    check_one_that_failed(rb.simulate_many(scene, vary, 2.0), a)
    with ThreadPoolExecutor(1) as pool:
        check_one_that_failed(rb.simulate_many(scene, vary, 2.0, executor=pool), a)
    check_one_that_failed(rb.simulate_many(scene, vary, 2.0, executor=Immediate()), a)


def test_a_member_out_of_reach_is_an_accuracy_error():
    scene = rb.Scene(gravity=[0, 0, -1.0])
    rail = rb.Rail(rb.Circle(radius=1.0, start=[0, 0, -1], toward=[1, 0, 0]))
    bead = scene.add(rb.Particle(1.0), rail)
    # the middle one all but stops at the top
    many = rb.simulate_many(scene, {(bead, "speed"): [1.0, 2.0, 3.0]}, 200.0, error=1e-10, engine="taylor")
    assert isinstance(many.errors[1], rb.AccuracyError) and many.status[1] == "accuracy not reached"
    assert 0.0 < many.errors[1].run.certain_until < 200.0 and list(many.failed) == [1]


def test_a_member_that_is_refused_as_it_starts_stops_no_other():
    k = rb.parameter(4.0, "k")
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.connect(rb.Spring(stiffness=k), ball, [0, 0, 0])
    for pool in (None, Immediate()):
        many = rb.simulate_many(scene, {k: [1.0, -1.0, 2.0]}, 1.0, executor=pool)
        assert many.status == ["reached end", "refused", "reached end"] and many.runs[1] is None
        with pytest.raises(rb.InvalidInput, match="stiffness"):
            many[1]
        x = many[ball].position(1.0)[:, 0]
        assert np.isnan(x[1]) and x[[0, 2]] == pytest.approx(np.cos(np.sqrt([1.0, 2.0])), abs=1e-9)
        assert np.isnan(many.end[1])


def test_names_are_keys_as_handles_are():
    scene, ball, k = oscillator()
    starts = [[1.0, 0, 0], [2.0, 0, 0]]
    by_handle = rb.simulate_many(scene, {(ball, "position"): starts}, 1.0)
    with ThreadPoolExecutor(2) as executor:
        for options in ({}, {"executor": executor}):
            named = rb.simulate_many(scene, {("ball", "position"): starts}, 1.0, **options)
            assert np.array_equal(named[ball].position(1.0), by_handle[ball].position(1.0))
            assert str(named) == str(by_handle) and list(named.vary) == [(ball, "position")]
    with pytest.raises(rb.InvalidInput, match="is given twice, by its handle and by its name"):
        rb.simulate_many(scene, {("ball", "position"): starts, (ball, "position"): starts}, 1.0)
    with pytest.raises(rb.InvalidInput, match="bowl"):
        rb.simulate_many(scene, {("bowl", "position"): starts}, 1.0)


def test_what_is_wrong_with_a_call_names_the_function_that_was_called():
    scene, ball, k = oscillator()
    system = rb.System(lambda t, x: -x, [1.0])
    for vary in ({k: [1.0, 2.0]}, {}):
        with pytest.raises(TypeError, match="^simulate_many: scene is <System: .*>; it is a Scene$"):
            rb.simulate_many(system, vary, 1.0)
    with pytest.raises(TypeError, match="^simulate_many: until is 'x'; it is a number$"):
        rb.simulate_many(scene, {k: [1.0, 2.0]}, "x")


def test_the_last_events_of_members_are_those_that_simulate_keeps():
    scene, ball, k = oscillator()
    scene.watch("middle", lambda now: now[ball].position[0])
    for executor in (None, Immediate()):
        vary = {k: np.array([1.0, 4.0])}
        many = rb.simulate_many(scene, vary, 20.0, events="last", executor=executor)
        for i, member in enumerate(many.runs):
            alone = one(scene, vary, i, 20.0, events="last")
            assert len(member.events) == len(alone.events) == 1 and member.events[0].count == (6, 13)[i]
            assert [(e.time, e.count) for e in member.events] == [(e.time, e.count) for e in alone.events]
    for events in (lambda e: None, 3):
        with pytest.raises(rb.InvalidInput, match='^simulate_many: events is .*; it is "all" or "last"'):
            rb.simulate_many(scene, {k: [1.0]}, 1.0, events=events)
    with pytest.raises(rb.InvalidInput, match='events is "first"'):
        rb.simulate_many(scene, {k: [1.0]}, 1.0, events="first")


def test_what_breaks_a_rule_is_refused_before_anything_runs():
    scene, ball, k = oscillator()
    for vary, message in (
        ({(ball, "position"): [[0, 0, 0], [0, np.nan, 0]]}, "member 1: ball: component 1 of position is nan"),
        ({(ball, "position"): [[0, 0], [0, 1]]}, r"member 0: ball: position has shape \(2,\)"),
        ({(ball, "speed"): [1.0]}, 'ball has no "speed"; a particle that is free starts with position, velocity'),
        ({k: [1.0, np.inf]}, "member 1: parameter: k is inf"),
        ({k: [1.0, 2.0], (ball, "velocity"): [[0, 0, 0]]}, "numbers of members differ: parameter.*has 2, .*has 1"),
        ({k: 1.0}, "has one value; it has one for each member"),
        ({}, "vary is {}; it is a mapping"),
        ([1, 2], "it is a mapping"),
        ({"k": [1.0]}, "it is a handle or a name, and a word of add"),
    ):
        for pool in (None, Immediate()):
            with pytest.raises(rb.InvalidInput, match=message):
                rb.simulate_many(scene, vary, 1.0, executor=pool)
    for options, message in (
        ({"threads": 0}, "threads is 0"),
        ({"threads": 2, "executor": Immediate()}, "both threads and executor"),
        ({"until": -1.0}, "until is -1"),
        ({"error": 1e-9, "rtol": 1e-9}, "both error"),
        ({"progress": 3}, "progress is 3"),
        ({"lanes": 4}, "lanes is 4; it is True or False"),
        ({"executor": 3}, "executor is 3; it is one of concurrent.futures"),
    ):
        with pytest.raises(rb.InvalidInput, match=message):
            rb.simulate_many(scene, {k: [1.0]}, **{"until": 1.0, **options})
    assert len(rb.simulate_many(scene, {k: []}, 1.0)) == 0


def calling_back():
    k = rb.parameter(1.0, "k")
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], name="ball")
    scene.apply(rb.Force(lambda t, r, v: [-float(k.value) * r[0], 0, 0], trace=False), ball)
    return scene, ball, k


def test_functions_that_are_called_back_see_the_numbers_of_their_member():
    scene, ball, k = calling_back()
    vary = {k: [1.0, 4.0, 9.0], (ball, "position"): [[1, 0, 0], [2, 0, 0], [3, 0, 0]]}
    many = rb.simulate_many(scene, vary, 1.0, threads=2)
    for i in range(3):
        same(many[i], one(scene, vary, i, 1.0))
    assert many["ball"].position(1.0)[:, 0] == pytest.approx([1, 2, 3] * np.cos([1, 2, 3]), abs=1e-8)
    assert k.value == 1.0


def test_what_a_function_throws_is_the_error_of_its_member():
    class Enough(Exception):
        pass

    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), name="ball")

    def force(t, r, v):
        if r[0] > 1.5:
            raise Enough
        return [0, 0, 0]

    scene.apply(rb.Force(force, trace=False), ball)
    many = rb.simulate_many(scene, {(ball, "velocity"): [[1, 0, 0], [2, 0, 0]]}, 1.0)
    assert many.errors[0] is None and isinstance(many.errors[1], Enough)
    with pytest.raises(Enough):
        many[1]


def test_what_cannot_be_sent_is_refused_with_a_sentence():
    scene, _, k = calling_back()
    with pytest.raises(rb.InvalidInput, match="cannot be sent to another process.*use threads="):
        rb.simulate_many(scene, {k: [1.0, 2.0]}, 1.0, executor=Immediate())
    with ThreadPoolExecutor(2) as pool:
        assert rb.simulate_many(scene, {k: [1.0, 2.0]}, 1.0, executor=pool).status == ["reached end"] * 2


LONG = {"until": 200.0, "error": 1e-9}


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_stops_within_a_second_and_hands_back_what_is_done(interrupt, threads):
    scene, bead = hoop()
    speeds = {(bead, "speed"): np.linspace(1.0, 9.0, 100000)}
    interrupt()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt) as caught:
        rb.simulate_many(scene, speeds, threads=threads, **LONG)
    # reading 100,000 starts takes its time, too
    assert time.monotonic() - began < 2.5
    many = caught.value.many
    assert len(many) == 100000 and many.status[-1] == "not begun" and many.runs[-1] is None
    if many.runs[0] is not None:
        assert many.status[0] in ("reached end", "stopped by event", "stopped by user")
    with pytest.raises(rb.Error, match="was not begun"):
        many[len(many) - 1]


def test_ctrl_c_stops_one_long_run_among_them(interrupt):
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[0, 1, 0])
    scene.apply(rb.Force(lambda t, r, v: -r * (r @ r) - 0.1 * v + np.cos(t) * np.array([1.0, 0, 0])), ball)
    interrupt()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt) as caught:
        rb.simulate_many(scene, {(ball, "velocity"): [[0, 1, 0]] * 2}, 1e9, rtol=1e-9, keep="end")
    assert time.monotonic() - began < 1.3
    run = caught.value.many.runs[0]
    assert run.status == "stopped by user" and 0.0 < run.end < 1e9


def test_ctrl_c_stops_the_threads_of_an_executor(interrupt):
    scene, bead = hoop()
    speeds = {(bead, "speed"): np.linspace(1.0, 9.0, 20000)}
    began = []

    def begin(fraction):
        # once some are done, however busy the machine is
        if fraction > 0.0 and not began:
            interrupt()
            began.append(time.monotonic())

    with ThreadPoolExecutor(2) as pool:
        with pytest.raises(KeyboardInterrupt) as caught:
            rb.simulate_many(scene, speeds, executor=pool, progress=begin, **LONG)
        assert time.monotonic() - began[0] < 2.0
    many = caught.value.many
    assert many.runs[-1] is None and many.runs[0] is not None
    assert any(run is not None and run.status in ("reached end", "stopped by event") for run in many.runs)


def test_progress_is_that_of_all_members():
    scene, bead = hoop()
    speeds = {(bead, "speed"): np.linspace(1.0, 9.0, 3000)}
    for options in ({"threads": 1}, {"threads": 2}, {"executor": Immediate()}):
        seen = []
        rb.simulate_many(scene, speeds, 3.0, progress=seen.append, **options)
        assert seen and seen == sorted(seen) and 0.0 <= seen[0] and seen[-1] == 1.0


def test_what_progress_raises_arrives_with_what_is_done():
    class Enough(Exception):
        pass

    def progress(fraction):
        raise Enough

    scene, bead = hoop()
    with pytest.raises(Enough) as caught:
        rb.simulate_many(scene, {(bead, "speed"): np.linspace(1.0, 9.0, 100000)}, progress=progress, **LONG)
    assert len(caught.value.many) == 100000


def test_to_xarray_has_members_and_times():
    xr = pytest.importorskip("xarray")
    scene, ball, k = oscillator()
    many = rb.simulate_many(scene, {k: [1.0, 4.0], (ball, "velocity"): [[0, 0, 0], [0, 1, 0]]}, 1.0)
    data = many.to_xarray([0.0, 0.5, 1.0])
    assert isinstance(data, xr.Dataset) and data["ball.position"].dims == ("member", "t", "component")
    assert np.array_equal(data["ball.position"].values, many[ball].position([0.0, 0.5, 1.0]))
    assert list(data["vary k"].values) == [1.0, 4.0] and list(data["status"].values) == ["reached end"] * 2
    assert data["vary ball.velocity"].dims == ("member", "component")


def test_without_xarray_it_is_said_what_to_install(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "xarray", None)
    scene, _, k = oscillator()
    with pytest.raises(ImportError, match="pip install xarray"):
        rb.simulate_many(scene, {k: [1.0]}, 1.0).to_xarray([0.0])
