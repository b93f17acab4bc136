"""Curves, forces, potentials, events and rails of the user's own in whole runs: native where traced, right anyway."""

import copy
import math
import pickle
import subprocess
import sys
import textwrap

import numpy as np
import pytest
import rbdyn as rb

ERROR = 1e-10
NEAR = {"rtol": 0, "atol": 10 * ERROR}
DOWN = [0, 0, -9.81]


def quadratic(k):
    return rb.Force(lambda t, position, velocity: -k * np.linalg.norm(velocity) * velocity)


def story(run):
    """Kinds of its events, those of one instant together."""
    groups, last = [], -math.inf
    for event in run.events:
        if event.time - last > 1e-5:
            groups.append(set())
        groups[-1].add(event.kind)
        last = event.time
    return groups


# --- a curve, a force and an event of one's own, in many forms ---

CURVES = {
    "wave": (lambda: rb.Curve(lambda u: [u, np.sin(u), 0.2 * u**2], domain=(-4, 4)), 1.0, 0.0),
    "steeper wave": (lambda: rb.Curve(lambda u: [2 * u, np.cos(3 * u), 0.5 * u**2], domain=(-3, 3)), 1.5, 0.4),
    "helix": (lambda: rb.Curve(lambda u: [np.cos(u), np.sin(u), 0.3 * u + 0.1 * u**2]), 4.0, 0.0),
    "ellipse": (lambda: rb.Curve(lambda u: [np.cos(u), 0, 2 * np.sin(u)], (0, 2 * np.pi), closed=True), 0.3, 1.0),
    "knot": (
        lambda: rb.Curve(
            lambda u: [(2 + np.cos(3 * u)) * np.cos(2 * u), (2 + np.cos(3 * u)) * np.sin(2 * u), np.sin(3 * u)],
            domain=(0, 2 * np.pi),
            closed=True,
        ),
        0.5,
        -2.0,
    ),
    "spline": (lambda: rb.Spline([[0, 0, 1], [1, 0.3, 0.2], [2, 0, 0], [3, 0.5, 0.4], [4, 0, 1.2]]), 0.5, 0.0),
    "closed spline": (lambda: rb.Spline([[1, 0, 0], [0, 1, 0.5], [-1, 0, 1], [0, -1, 0.5]], closed=True), 1.0, 0.0),
}


def own_scene(curve, parameter, speed, friction=None, load=None):
    scene = rb.Scene(gravity=DOWN)
    bead = scene.add(rb.Particle(mass=0.2), rb.Rail(curve, friction=friction), parameter=parameter, speed=speed)
    scene.apply(load if load is not None else quadratic(0.05), bead)
    scene.watch("apex", lambda now: now[bead].velocity[2], direction="falling")
    return scene, bead


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
def test_a_bead_on_any_curve_loses_to_drag_what_its_energy_says_and_no_python_runs(name, error):
    make, parameter, speed = CURVES[name]
    scene, bead = own_scene(make(), parameter, speed)
    run = rb.simulate(scene, until=4.0, error=error)
    assert run.statistics.python_calls == 0
    assert run.error <= error
    # E(0) - E(t) is the integral of k |v|^3; Gauss's rule of 30 points on each piece between the steps
    stops = np.unique(np.concatenate([run.t, [run.start, run.end]]))
    nodes, weights = np.polynomial.legendre.leggauss(30)
    half = np.diff(stops)[:, None] / 2
    times = (stops[:-1, None] + half * (nodes + 1)).ravel()
    lost = np.sum((half * weights).ravel() * 0.05 * np.abs(run[bead].speed(times)) ** 3)
    energy = run.kinetic_energy([0.0, run.end]) + 0.2 * 9.81 * run[bead].position([0.0, run.end])[:, 2]
    largest = max(np.max(run.kinetic_energy(run.t)), 1e-3)
    assert energy[0] - energy[1] == pytest.approx(lost, rel=0, abs=30 * max(error, 1e-14) * largest)
    # at an apex the bead has stopped rising
    for apex in run.events.times("apex"):
        assert abs(run[bead].velocity(apex)[2]) < 100 * error * np.max(np.abs(run[bead].speed(run.t)))
        assert run[bead].velocity(apex - 1e-3)[2] > run[bead].velocity(apex + 1e-3)[2]


@pytest.mark.parametrize("name", CURVES)
def test_a_less_accurate_run_is_near_a_more_accurate_one_by_what_it_promised(name):
    make, parameter, speed = CURVES[name]
    scene, bead = own_scene(make(), parameter, speed, friction=rb.Coulomb(0.3, 0.1))
    exact = rb.simulate(scene, until=3.0, error=1e-12)
    times = np.linspace(0, 3, 40)
    extent = np.max(np.ptp(exact[bead].position(times), axis=0))
    for error in (1e-6, 1e-9):
        run = rb.simulate(scene, until=3.0, error=error)
        assert story(run) == story(exact)
        np.testing.assert_allclose([e.time for e in run.events], [e.time for e in exact.events], rtol=2 * error)
        np.testing.assert_allclose(
            run[bead].position(times), exact[bead].position(times), rtol=0, atol=2 * error * max(extent, 1e-3)
        )


@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
def test_a_potential_of_ones_own_keeps_the_energy_on_a_curve_of_ones_own(error):
    make, parameter, speed = CURVES["knot"]
    well = rb.Potential(lambda position: -2.0 * (position @ position) - np.cos(position[0]))
    scene, bead = own_scene(make(), parameter, speed, load=well)
    run = rb.simulate(scene, until=5.0, error=error)
    assert run.statistics.python_calls == 0
    assert run.drift["energy"] < 10 * error


def test_the_way_a_force_is_run_does_not_change_the_motion():
    def law(t, position, velocity):
        return -0.05 * np.sqrt(velocity @ velocity) * velocity + [0.1 * np.cos(t), 0, 0]

    runs = []
    for options, engine in (
        ({"trace": True}, "taylor"),
        ({"trace": True}, "dop853"),
        ({"trace": False}, "dop853"),
        ({"trace": False}, "cvode-adams"),
    ):
        make, parameter, speed = CURVES["helix"]
        scene, bead = own_scene(make(), parameter, speed, load=rb.Force(law, **options))
        runs.append(rb.simulate(scene, until=2.0, error=1e-8, engine=engine)[bead].position(2.0))
    np.testing.assert_allclose(runs[1:], [runs[0]] * 3, rtol=0, atol=1e-7)


# --- what the plan says ---


def test_the_plan_names_what_is_traced_and_what_is_called_back_and_why():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), velocity=[1, 0, 0], name="ball")

    def wind(t, position, velocity):
        return -velocity

    def gusts(t, position, velocity):
        return [math.sin(t), 0, 0]

    line = gusts.__code__.co_firstlineno + 1
    scene.apply(rb.Force(wind), ball)
    assert 'force "wind" traced, native, on ball' in str(rb.plan(scene))
    assert rb.plan(scene).engine == "closed form"  # a drag in proportion, known as such
    assert rb.simulate(scene, 1.0).statistics.python_calls == 0
    scene.apply(rb.Force(gusts), ball)
    words = str(rb.plan(scene))
    assert 'force "wind" traced, native' in words
    assert f'force "gusts" on ball called back: line {line} of test_own_effects.py: math.sin(t) asks' in words
    assert rb.plan(scene).engine == "dop853"
    run = rb.simulate(scene, 1.0)
    assert run.statistics.python_calls > 0 and run.engine == "dop853"
    with pytest.raises(rb.InvalidInput, match="called back"):
        rb.simulate(scene, 1.0, engine="taylor")


def test_trace_false_calls_back_what_could_be_traced_and_says_so():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), velocity=[1, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: -v, trace=False), ball)
    assert "called back: trace=False" in str(rb.plan(scene))
    run = rb.simulate(scene, 1.0, error=ERROR)
    assert run.statistics.python_calls > 0
    assert run[ball].velocity(1.0)[0] == pytest.approx(math.exp(-1), abs=10 * ERROR)


# --- what goes wrong in a callback ---


class Mine(Exception):
    pass


def failing_after(calls, what):
    counted = iter(range(10**9))

    def law(t, position, velocity):
        if next(counted) == calls:
            what()
        return -4.0 * position

    return law


def oscillator(law, **options):
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.apply(rb.Force(law, trace=False, **options), ball)
    return scene, ball


def test_what_a_callback_raises_arrives_unchanged_with_the_run_up_to_there():
    error = Mine("broken", 7)

    def fail():
        raise error

    scene, ball = oscillator(failing_after(500, fail))
    with pytest.raises(Mine) as caught:
        rb.simulate(scene, until=50.0, rtol=1e-9)
    assert caught.value is error and error.args == ("broken", 7)
    run = error.run
    assert 0.0 < run.end < 50.0
    assert run[ball].position(run.end)[0] == pytest.approx(math.cos(2 * run.end), abs=1e-6)


def test_a_watched_function_and_its_action_raise_unchanged_too():
    scene = rb.Scene(gravity=DOWN)
    ball = scene.add(rb.Particle(1.0), velocity=[0, 0, 5])

    def height(now):
        if now.time > 0.3:
            raise Mine("watch")
        return now[ball].position[2] - 10

    scene.watch("height", height, trace=False)
    with pytest.raises(Mine, match="watch") as caught:
        rb.simulate(scene, 1.0)
    assert caught.value.run.end <= 0.5

    scene = rb.Scene(gravity=DOWN)
    ball = scene.add(rb.Particle(1.0), velocity=[0, 0, 5])

    def act(now):
        raise Mine("action")

    scene.watch("apex", lambda now: now[ball].velocity[2], action=act)
    with pytest.raises(Mine, match="action") as caught:
        rb.simulate(scene, 1.0)
    assert caught.value.run.end == pytest.approx(5 / 9.81, rel=1e-9)


def test_nan_from_a_callback_names_the_function_and_the_time():
    def bad(t, position, velocity):
        return [math.nan if t > 1.0 else 0.0, 0, 0]

    scene, ball = oscillator(bad)
    with pytest.raises(rb.IntegrationError, match=r't = 1\.0.*force "bad" on particle 1.*nan') as caught:
        rb.simulate(scene, until=5.0)
    assert caught.value.run.end == pytest.approx(1.0, abs=1e-6)
    assert caught.value.run.status == "not finite"


def test_a_pole_of_a_recorded_force_is_named():
    scene = rb.Scene()
    scene.add(rb.Particle(1.0))
    scene.apply(rb.Force(lambda t, r, v: [1.0 / (2.0 - t) ** 2, 0.0, 0.0]), scene.bodies[0])
    with pytest.raises(
        rb.IntegrationError, match=r"t = (2|1\.99999).*force .* on particle 1, which has grown"
    ) as caught:
        rb.simulate(scene, until=3.0)
    assert caught.value.run.status == "not finite"


def test_ctrl_c_ends_a_run_that_calls_back(interrupt):
    scene, _ = oscillator(lambda t, r, v: -4.0 * r)
    with pytest.raises(KeyboardInterrupt) as caught:
        interrupt()
        rb.simulate(scene, until=1e12, rtol=1e-10, keep="end")
    assert caught.value.run.end > 0.0


def test_a_force_that_is_called_back_is_asked_about_states_near_the_motion():
    # air that thins out with height: math.exp overflows far from the motion
    def air(t, x, y, z, vx, vy, vz):
        k = -0.01 * math.exp(-z / 8000) * math.sqrt(vx * vx + vy * vy + vz * vz)
        return k * vx, k * vy, k * vz

    for until in (1.0, 40.0, 400.0):
        scene = rb.Scene(gravity=DOWN)
        ball = scene.add(rb.Particle(1.0), position=[0, 0, 100.0])
        scene.apply(rb.Force(air, trace=False), ball)
        traced = rb.Scene(gravity=DOWN)
        same = traced.add(rb.Particle(1.0), position=[0, 0, 100.0])
        traced.apply(rb.Force(lambda t, r, v: -0.01 * np.exp(-r[2] / 8000) * np.linalg.norm(v) * v), same)
        np.testing.assert_allclose(
            rb.simulate(scene, until)[ball].position(until), rb.simulate(traced, until)[same].position(until), rtol=1e-8
        )


# --- scenes as data ---


def rich_scene():
    k = rb.parameter(0.05, "k")
    scene = rb.Scene(gravity=DOWN)
    track = rb.Rail(
        rb.Curve(lambda u: [u, np.sin(u), 0.2 * u**2], domain=(-4, 4)), friction=rb.Coulomb(0.2, 0.1), drive=np.sin
    )
    bead = scene.add(rb.Particle(0.2), track, parameter=1.0)
    ball = scene.add(rb.Particle(0.3), position=[0, 0, 1])
    scene.apply(rb.Force(lambda t, r, v: -k * np.linalg.norm(v) * v), bead)
    scene.apply(rb.Potential(lambda r: -0.5 * r @ r), ball)
    scene.connect(rb.Spring(2.0), bead, ball)
    apex = scene.watch("apex", lambda now: now[bead].velocity[2] if now.time > 0.1 else 1.0, direction="falling")
    scene.integral("area", lambda now: now[ball].position[0])
    return scene, bead, ball, apex


def test_a_scene_with_traced_functions_is_data_and_its_copies_move_alike():
    scene, bead, ball, apex = rich_scene()
    run = rb.simulate(scene, 1.0)
    for other in (copy.copy(scene), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
        assert other == scene
        again = rb.simulate(other, 1.0)
        assert again.end == run.end and len(again.events) == len(run.events)
        # the old handles are good for it
        np.testing.assert_array_equal(again[bead].position(1.0), run[bead].position(1.0))
        np.testing.assert_array_equal(again[ball].velocity(0.5), run[ball].velocity(0.5))
        assert again[apex].value(0.7) == run[apex].value(0.7)
    other = copy.copy(scene)
    other.apply(rb.Drag(linear=1.0), ball)
    assert other != scene
    assert rich_scene()[0] == scene


def test_a_scene_and_its_handles_travel_to_another_process(tmp_path):
    scene, bead, ball, apex = rich_scene()
    run = rb.simulate(scene, 1.0)
    expected = (run[bead].position(1.0).tolist(), run[apex].value(0.7))
    (tmp_path / "scene").write_bytes(pickle.dumps((scene, bead, ball, apex, expected)))
    program = f"""
        import pickle
        import rbdyn as rb
        scene, bead, ball, apex, expected = pickle.loads(open({str(tmp_path / "scene")!r}, "rb").read())
        new = scene.add(rb.Particle(1.0), position=[5, 0, 0])
        run = rb.simulate(scene, 1.0)
        assert abs(run[bead].position(1.0) - expected[0]).max() < 1e-8, (run[bead].position(1.0), expected)
        assert abs(run[apex].value(0.7) - expected[1]) < 1e-8
        assert len({{new, bead, ball}}) == 3
    """
    subprocess.run([sys.executable, "-W", "error", "-c", textwrap.dedent(program)], check=True, cwd=tmp_path)


def test_a_scene_that_calls_back_says_what_keeps_it_from_being_pickled():
    scene, _ = oscillator(failing_after(10, lambda: None))
    with pytest.raises(TypeError, match='"law" is called back'):
        pickle.dumps(scene)
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0))
    scene.watch("high", lambda now: now[ball].position[2] - 1, action=lambda now: {ball: {"speed": float(now.time)}})
    with pytest.raises(TypeError, match='action of watch "high"'):
        pickle.dumps(scene)
    # a copy needs no pickle
    assert rb.simulate(copy.copy(scene), 1.0).end == 1.0


def test_a_run_keeps_the_parameters_it_was_started_with():
    k = rb.parameter(4.0, "k")
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: -k * r), ball)
    run = rb.simulate(scene, 1.0, error=ERROR)
    k.value = 9.0
    later = rb.simulate(scene, 1.0, error=ERROR)
    np.testing.assert_allclose(run[ball].position(1.0)[0], math.cos(2.0), **NEAR)
    np.testing.assert_allclose(run[ball].acceleration(1.0)[0], -4 * math.cos(2.0), rtol=0, atol=1e-8)
    np.testing.assert_allclose(later[ball].position(1.0)[0], math.cos(3.0), **NEAR)


def test_parameters_reach_curves_drives_potentials_motions_and_watches():
    p = rb.parameter(1.0, "p")
    scene = rb.Scene(gravity=DOWN)
    free = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[0, 0, 3])
    scene.apply(rb.Potential(lambda r: -0.5 * p * r[0] ** 2), free)
    scene.watch("level", lambda now: now[free].position[2] - 0.2 * p, direction="rising")
    ridden = scene.add(rb.Particle(1.0), rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(0.8), drive=lambda t: p * t))
    moved = scene.add(rb.Particle(1.0), rb.Rail(rb.Line([1, 0, 0]), motion=lambda t: [0, p * t, 0]))
    for value in (1.0, 2.0):
        p.value = value
        run = rb.simulate(scene, 0.5, error=ERROR)
        np.testing.assert_allclose(run[free].position(0.5)[0], math.cos(math.sqrt(value) * 0.5), **NEAR)
        np.testing.assert_allclose(run[ridden].speed(0.5), value * 0.5, **NEAR)
        np.testing.assert_allclose(run[moved].position(0.5)[1], value * 0.5, **NEAR)
        rises = (3 - math.sqrt(9 - 2 * 9.81 * 0.2 * value)) / 9.81
        np.testing.assert_allclose(run.events.times("level"), [rises], **NEAR)


# --- watched functions ---


def thrown(up=5.0):
    scene = rb.Scene(gravity=[0, 0, -10.0])
    return scene, scene.add(rb.Particle(1.0), velocity=[1, 0, up])


@pytest.mark.parametrize("trace", [True, False])
@pytest.mark.parametrize(("direction", "times"), [("rising", [0.2]), ("falling", [0.8]), ("either", [0.2, 0.8])])
def test_a_level_is_passed_in_the_directions_that_are_watched(direction, times, trace):
    scene, ball = thrown()
    level = scene.watch("level", lambda now: now[ball].position[2] - 0.8, direction=direction, trace=trace)
    run = rb.simulate(scene, 1.0, error=ERROR)
    np.testing.assert_allclose(run.events.times("level"), times, **NEAR)
    np.testing.assert_array_equal(run.events.times("level"), run.events.times("watch"))
    assert {e.name for e in run.events} == {"level"}
    np.testing.assert_allclose(run[level].value([0.2, 0.5]), [0.0, 0.45], **NEAR)
    assert isinstance(run[level].value(0.5), float)
    assert (run.statistics.python_calls > 0) == (not trace)


@pytest.mark.parametrize("trace", [True, False])
def test_a_watch_may_stop_the_run(trace):
    scene, ball = thrown()
    scene.watch("floor", lambda now: now[ball].position[2], action="stop", direction="falling", trace=trace)
    run = rb.simulate(scene, 5.0, error=ERROR)
    assert run.status == "stopped by event" and run.events[-1].name == "floor"
    assert run.end == pytest.approx(1.0, abs=10 * ERROR)


def test_an_action_changes_the_state_and_the_value_before_is_kept():
    scene, ball = thrown()

    def bounce(now):
        vx, vy, vz = now[ball].velocity
        assert now.time == pytest.approx(1.0, abs=1e-8) or now.time > 1.0
        return {ball: {"velocity": [vx, vy, -vz / 2]}}

    scene.watch("floor", lambda now: now[ball].position[2], direction="falling", action=bounce)
    run = rb.simulate(scene, 1.4, error=ERROR)
    (hit,) = run.events.times("floor")
    assert run[ball].velocity(hit, side="before")[2] == pytest.approx(-5.0, abs=100 * ERROR)
    assert run[ball].velocity(hit)[2] == pytest.approx(2.5, abs=100 * ERROR)
    assert run[ball].position(1.4)[2] == pytest.approx(2.5 * 0.4 - 5 * 0.16, abs=100 * ERROR)


def test_an_action_moves_a_bead_in_the_words_of_its_rail():
    scene = rb.Scene()
    bead = scene.add(rb.Particle(1.0), rb.Rail(rb.Line([1, 0, 0])), speed=1.0)
    scene.watch(
        "gate", lambda now: now[bead].parameter - 1, action=lambda now: {bead: {"parameter": 3.0, "speed": 2.0}}
    )
    run = rb.simulate(scene, 2.0, error=ERROR)
    np.testing.assert_allclose(run.events.times("gate"), [1.0], **NEAR)
    np.testing.assert_allclose(run[bead].parameter(2.0), 5.0, **NEAR)


@pytest.mark.parametrize(
    ("returned", "message"),
    [
        (lambda ball: 3, "returns 3"),
        (lambda ball: {"ball": {}}, "each is a handle"),
        (lambda ball: {ball: {"color": 1}}, 'changes "color"'),
        (lambda ball: {ball: {"speed": 1.0}}, "free"),
        (lambda ball: {ball: {"velocity": [1, 2]}}, "velocity"),
        (lambda ball: {ball: {"velocity": [1, 2, math.nan]}}, "nan"),
    ],
)
def test_an_action_that_returns_no_change_of_state_is_refused(returned, message):
    scene, ball = thrown()
    scene.watch("apex", lambda now: now[ball].velocity[2], action=lambda now: returned(ball))
    with pytest.raises(rb.InvalidInput, match=message):
        rb.simulate(scene, 1.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"name": ""}, "name is empty"),
        ({"name": "taken"}, "already"),
        ({"direction": "up"}, 'direction is "up"'),
        ({"action": "halt"}, 'action is "halt"'),
        ({"action": 3}, "action is 3"),
        ({"function": 3}, "no function"),
        ({"function": lambda now: [1, 2]}, "one number"),
        ({"function": lambda now: math.sin(now.time), "trace": True}, "math.sin"),
    ],
)
def test_a_watch_that_breaks_a_rule_is_refused(options, message):
    scene, ball = thrown()
    scene.watch("taken", lambda now: now.time - 1)
    given = {"name": "new", "function": lambda now: now.time - 2, **options}
    name, function = given.pop("name"), given.pop("function")
    with pytest.raises(rb.InvalidInput, match=message):
        scene.watch(name, function, **given)


def test_a_free_body_has_no_quantities_of_rails():
    scene, ball = thrown()
    with pytest.raises(rb.InvalidInput, match="is free"):
        scene.watch("n", lambda now: now[ball].speed)


def test_what_a_free_body_does_not_have_is_refused_in_a_callback_too():
    scene, ball = thrown()
    scene.watch("n", lambda now: math.sin(now[ball].speed), trace=False)
    with pytest.raises(rb.InvalidInput, match="is free"):
        rb.simulate(scene, 1.0)


def test_names_of_events_that_are_not_there_are_refused():
    scene, ball = thrown()
    scene.watch("apex", lambda now: now[ball].velocity[2])
    run = rb.simulate(scene, 1.0)
    assert run.events.times("apex").shape == (1,)
    assert run.events.times("impact").shape == (0,)
    with pytest.raises(rb.InvalidInput, match="apexes"):
        run.events.times("apexes")


def test_a_watch_that_never_fires_has_a_name_all_the_same():
    scene, ball = thrown()
    scene.watch("high", lambda now: now[ball].position[2] - 100)
    assert rb.simulate(scene, 1.0).events.times("high").shape == (0,)


def test_an_integral_of_ones_own_is_reported_with_its_drift():
    scene = rb.Scene()
    planet = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[0, 1.1, 0])
    scene.apply(rb.Potential(lambda r: 1.0 / np.linalg.norm(r)), planet)
    scene.integral("eccentricity", lambda now: now[planet].position @ now[planet].velocity ** 2)
    scene.integral("areal velocity", lambda now: np.cross(now[planet].position, now[planet].velocity)[2] / 2)
    run = rb.simulate(scene, 10.0, error=ERROR)
    assert run.drift["areal velocity"] < 1e-12
    assert run.drift["eccentricity"] > 0.1  # it is none


# --- rails that move, that push one way, that end ---


def turning(t):
    c, s = np.cos(2 * t), np.sin(2 * t)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def homogeneous(t):
    c, s = np.cos(2 * t), np.sin(2 * t)
    return np.array([[c, -s, 0, t**2], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


@pytest.mark.parametrize(
    ("motion", "turns", "moves"),
    [
        (lambda t: [t**2, 0, 0], False, True),
        (turning, True, False),
        (lambda t: (turning(t), [t**2, 0, 0]), True, True),
        (lambda t: ([t**2, 0, 0], turning(t)), True, True),
        (homogeneous, True, True),
    ],
    ids=["displacement", "matrix", "pair", "pair turned round", "4x4"],
)
def test_a_bead_on_a_rail_that_moves_obeys_newton_in_the_axes_of_the_rail(motion, turns, moves):
    scene = rb.Scene(gravity=DOWN)
    rail = rb.Rail(rb.Line([1, 0, 0], point=[0, 0.5, 0]), motion=motion)
    assert rail.moves
    bead = scene.add(rb.Particle(0.5), rail, parameter=0.3, speed=0.1)
    run = rb.simulate(scene, 1.0, error=ERROR)
    assert run.statistics.python_calls == 0
    # u'' = w^2 u - d'' . t, with w = 2 about z and d'' = 2 along x
    t = np.linspace(0, 1, 6)
    u = run[bead].parameter(t)
    if not turns:
        np.testing.assert_allclose(u, 0.3 + 0.1 * t - t**2, **NEAR)
    elif not moves:
        np.testing.assert_allclose(u, 0.3 * np.cosh(2 * t) + 0.05 * np.sinh(2 * t), **NEAR)
    else:
        # particular solution of u'' = 4 u - 2 cos 2t: cos(2t)/4
        np.testing.assert_allclose(u, np.cos(2 * t) / 4 + 0.05 * np.cosh(2 * t) + 0.05 * np.sinh(2 * t), **NEAR)
    # where it is in the world, and the reaction that takes it there
    rotation = turning(1.0) if turns else np.eye(3)
    displacement = np.array([1.0, 0, 0]) if moves else np.zeros(3)
    np.testing.assert_allclose(run[bead].position(1.0), rotation @ [u[-1], 0.5, 0] + displacement, **NEAR)
    newton = 0.5 * run[bead].acceleration(1.0) - 0.5 * np.array(DOWN)
    np.testing.assert_allclose(run[bead].reaction(1.0), newton, rtol=0, atol=1e-7)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"side": "left"}, 'side is "left"; .*both'),
        ({"side": ""}, 'side is ""'),
        ({"ends": "bounce"}, 'ends is "bounce"; .*release'),
        ({"side": "+", "motion": lambda t: [t, 0, 0]}, "motion"),
        ({"motion": lambda t: t}, "a motion is a displacement"),
        ({"motion": lambda t: [math.sin(t), 0, 0]}, "math.sin"),
        ({"motion": lambda t: 2 * np.eye(3)}, "orthonormal"),
        ({"motion": lambda t: -np.eye(3)}, "mirror"),
        ({"drive": lambda t: math.sin(t)}, "math.sin"),
        ({"drive": lambda t: [t, t]}, "drive"),
    ],
)
def test_a_rail_that_breaks_a_rule_is_refused(options, message):
    with pytest.raises(rb.InvalidInput, match=message):
        rb.Rail(rb.Circle(1.0, [1, 0, 0], [0, 0, 1]), **options)


def test_the_words_of_a_rail_can_be_read():
    rail = rb.Rail(rb.Line([1, 0, 0]), side="-", ends="release")
    assert (rail.side, rail.ends, rail.moves) == ("-", "release", False)
    assert pickle.loads(pickle.dumps(rail)) == rail
    moving = rb.Rail(rb.Line([1, 0, 0]), motion=turning)
    assert pickle.loads(pickle.dumps(moving)) == moving and moving != rb.Rail(rb.Line([1, 0, 0]))


@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("start", [1e-3, 0.1, 0.5])
def test_a_bead_leaves_a_sphere_where_two_thirds_of_its_height_are_left(start, error):
    scene = rb.Scene(gravity=DOWN)
    circle = rb.Circle(radius=2.0, start=[0, 0, 1], toward=[1, 0, 0])
    bead = scene.add(rb.Particle(0.4), rb.Rail(circle, side="-"), parameter=start)
    run = rb.simulate(scene, until=6.0, error=error)
    (leaves,) = run.events.times("detach", bead)
    x, _, z = run[bead].position(leaves)
    assert z / 2.0 == pytest.approx(2 / 3 * math.cos(start), abs=10 * error)
    np.testing.assert_allclose(run[bead].acceleration(leaves + 0.1), DOWN, rtol=0, atol=1e-9)
    np.testing.assert_allclose(run[bead].reaction(leaves + 0.1), 0.0, atol=0)
    # it does not come back
    assert len(run.events) == 1


def test_a_curve_of_ones_own_may_push_one_way():
    # over the hill z = 1/(1 + x^2), uphill from where it is hollow: the normal that points up there is kept
    hill = rb.Curve(lambda u: [u, 0, 1 / (1 + u**2)], domain=(-20, 20))
    scene = rb.Scene(gravity=DOWN)
    bead = scene.add(rb.Particle(1.0), rb.Rail(hill, side="+"), parameter=-2.0, speed=12.0)
    run = rb.simulate(scene, 0.3, error=ERROR)
    (leaves,) = run.events.times("detach")
    # past the inflection, where v^2 times the curvature is the weight's part along the normal
    u = run[bead].position(leaves)[0]
    slope, bend = -2 * u / (1 + u**2) ** 2, (6 * u**2 - 2) / (1 + u**2) ** 3
    assert -1 / math.sqrt(3) < u < 0
    v2 = 144 - 2 * 9.81 * (1 / (1 + u**2) - 0.2)
    assert -bend / (1 + slope**2) * v2 == pytest.approx(9.81, rel=1e-8)
    np.testing.assert_allclose(run[bead].acceleration(leaves + 0.01), DOWN, rtol=0, atol=1e-9)
    # slower it stays on the hill, and comes back
    slow = rb.Scene(gravity=DOWN)
    slow.add(rb.Particle(1.0), rb.Rail(hill, side="+"), parameter=-2.0, speed=2.0)
    assert len(rb.simulate(slow, 1.0).events) == 0


def test_a_rail_that_releases_lets_go_at_its_end():
    scene = rb.Scene(gravity=DOWN)
    ramp = rb.Polynomial([[0, 0, 0], [1, 0, 0]], domain=(0, 2))
    bead = scene.add(rb.Particle(1.0), rb.Rail(ramp, ends="release"), parameter=0.5, speed=3.0)
    run = rb.simulate(scene, 1.0, error=ERROR)
    assert [e.kind for e in run.events] == ["rail-end"]
    assert run.status == "reached end" and run.events[0].time == pytest.approx(0.5, abs=10 * ERROR)
    np.testing.assert_allclose(run[bead].position(1.0), [3.5, 0, -9.81 / 8], **NEAR)
    stopped = rb.Scene(gravity=DOWN)
    stopped.add(rb.Particle(1.0), rb.Rail(ramp), parameter=0.5, speed=3.0)
    assert rb.simulate(stopped, 1.0).status == "stopped by event"


# --- distinctions at zeros that no double holds: sin(t) at pi is 1.2e-16 ---

SIGNS = {
    "sign": np.sign,
    "heaviside": lambda x: 2 * np.heaviside(x, 0.5) - 1,
    "where": lambda x: rb.where(x > 0, 1.0, -1.0),
    "quotient": lambda x: x / abs(x),
    "root of a square": lambda x: x / np.sqrt(x * x),
}
CORNERS = {
    "abs": abs,
    "sign times x": lambda x: np.sign(x) * x,
    "root of a square": lambda x: np.sqrt(x**2),
    "where": lambda x: rb.where(x > 0, x, -x),
}
LEVELS = {"maximum": lambda x: np.maximum(x, 0.0), "where": lambda x: rb.where(x > 0, x, 0.0)}


def on_driven_belt(drive, friction, speed=0.0):
    scene = rb.Scene(gravity=DOWN)
    rail = rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(*friction), drive=drive)
    return scene, scene.add(rb.Particle(1.0), rail, parameter=0.0, speed=speed)


@pytest.mark.parametrize("name", SIGNS)
def test_a_belt_that_turns_round_where_a_sine_does_carries_its_block_back(name):
    scene, block = on_driven_belt(lambda t: 2 * SIGNS[name](np.sin(t)), (0.3, 0.2))
    run = rb.simulate(scene, until=6, error=1e-9)
    a = 0.2 * 9.81
    first, second = 2 / a, 4 / a  # s, from rest to 2 m/s, and from there to -2 m/s
    right = 2 * (math.pi - first / 2) - 2 * (6 - math.pi - second)
    np.testing.assert_allclose(run[block].position(6)[0], right, rtol=0, atol=1e-8)
    assert story(run) == [{"stick"}, {"slip", "switch"}, {"stick"}]


@pytest.mark.parametrize("name", SIGNS)
@pytest.mark.parametrize("rate, phase", [(1.0, 0.0), (1.0, math.pi / 2), (1.3, 0.0), (2.7, 0.4)])
def test_a_watched_sign_of_a_sine_jumps_through_zero_each_time(name, rate, phase):
    scene = rb.Scene()
    scene.add(rb.Particle(1.0), position=[0, 0, 0], velocity=[1, 0, 0])
    scene.watch("sign", lambda now: SIGNS[name](np.sin(rate * now.time + phase)))
    run = rb.simulate(scene, until=10, error=1e-9)
    zeros = [(k * math.pi - phase) / rate for k in range(1, 10)]
    found = [e.time for e in run.events if e.kind == "watch"]
    np.testing.assert_allclose(found, [t for t in zeros if t < 10], rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", CORNERS)
def test_a_drive_with_corners_throws_no_block_off(name):
    scene, block = on_driven_belt(lambda t: 0.8 * CORNERS[name](np.sin(1.8 * t)), (0.3, 0.1))
    run = rb.simulate(scene, until=10, error=1e-9)
    # five whole arches of area 2, and the rest of 18 rad
    right = 0.8 / 1.8 * (2 * 5 + 1 - math.cos(18 - 5 * math.pi))
    np.testing.assert_allclose(run[block].position(10)[0], right, rtol=0, atol=1e-8)
    assert {e.kind for e in run.events} == {"switch"}


@pytest.mark.parametrize("function", [*CORNERS.values(), *LEVELS.values()])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_watched_corner_or_level_at_zero_passes_nothing(function, side):
    scene = rb.Scene()
    scene.add(rb.Particle(1.0), position=[0, 0, 0], velocity=[1, 0, 0])
    scene.watch("touch", lambda now: side * function(np.sin(now.time + 0.3)))
    run = rb.simulate(scene, until=10, error=1e-9)
    assert {e.kind for e in run.events} <= {"switch"}


def test_a_force_that_is_a_sign_switches_once_at_each_zero():
    scene = rb.Scene()
    body = scene.add(rb.Particle(1.0), position=[0, 0, 0], velocity=[1, 0, 0])
    scene.apply(rb.Force(lambda t, position, velocity: [np.sign(np.sin(t)), 0, 0]), body)
    run = rb.simulate(scene, until=10, error=1e-9)
    np.testing.assert_allclose([e.time for e in run.events], [math.pi, 2 * math.pi, 3 * math.pi], rtol=1e-14)
    # pi s to and pi s fro leave the speed as it was
    late = 10 - 3 * math.pi
    right = 3 * math.pi + 1.5 * math.pi**2 + (1 + math.pi) * late - late**2 / 2
    np.testing.assert_allclose(run[body].position(10)[0], right, rtol=0, atol=1e-8)
