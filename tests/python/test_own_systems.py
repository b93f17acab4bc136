"""First-order equations of one's own against SciPy, extrapolation in extended precision, and closed forms."""

import copy
import ctypes
import pickle

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp

GRAVITY, MASSES, LENGTHS = 9.81, (1.0, 0.7), (1.0, 0.6)
ENGINES = {"taylor": 1e-13, "dop853": 1e-13, "cvode-adams": 1e-9, "cvode-bdf": 1e-8}


def double_pendulum(t, x, sin=np.sin, cos=np.cos):
    """Two points on massless rods, angles from the vertical and their rates."""
    a, b, p, q = x
    (m1, m2), (l1, l2) = MASSES, LENGTHS
    both, across, back = (m1 + m2) * l1, m2 * l2 * cos(a - b), l1 * cos(a - b)
    first = -m2 * l2 * q * q * sin(a - b) - (m1 + m2) * GRAVITY * sin(a)
    second = l1 * p * p * sin(a - b) - GRAVITY * sin(b)
    determinant = both * l2 - across * back
    return [p, q, (first * l2 - across * second) / determinant, (both * second - back * first) / determinant]


START = [1.0, 1.5, 0.0, 0.0]


def extrapolated(f, x, until, steps):
    """x(until) by the modified midpoint rule, extrapolated (Gragg, Bulirsch, Stoer), in extended precision."""
    x, length = np.array(x, np.longdouble), np.longdouble(until) / steps
    for _ in range(steps):
        rows = []
        for count in range(2, 18, 2):
            h = length / count
            before, now = x, x + h * np.array(f(x))
            for _ in range(count - 1):
                before, now = now, before + 2 * h * np.array(f(now))
            row = [(before + now + h * np.array(f(now))) / 2]
            for k, lower in enumerate(rows[-1] if rows else []):
                ratio = (np.longdouble(count) / (count - 2 * (k + 1))) ** 2
                row.append(row[k] + (row[k] - lower) / (ratio - 1))
            rows.append(row)
        x = rows[-1][-1]
    return x


def test_a_double_pendulum_of_ones_own_is_scipys():
    system = rb.System(double_pendulum, START, names=["a", "b", "p", "q"])
    run = rb.simulate(system, until=5.0, error=1e-11)
    assert (run.engine, run.statistics.python_calls) == ("taylor", 0)
    times = np.linspace(0, 5, 41)
    scipys = solve_ivp(double_pendulum, (0, 5), START, method="DOP853", rtol=1e-13, atol=1e-14, t_eval=times).y.T
    assert np.abs(run.x(times) - scipys).max() < 1e-11  # of numbers up to 7; SciPy itself is at 2e-13
    assert (
        np.abs(run.rate(times) - [double_pendulum(t, x) for t, x in zip(times, run.x(times), strict=True)]).max()
        < 1e-12
    )


def test_a_double_pendulum_of_ones_own_is_right_to_the_error_it_tells():
    run = rb.simulate(rb.System(double_pendulum, START), until=2.0, error=1e-13)
    truth = extrapolated(lambda x: double_pendulum(0, x), START, 2.0, 300)
    wrong = np.abs(run.x(2.0) - truth).astype(float)
    largest = np.abs(run.x(np.linspace(0, 2, 500))).max(axis=0)
    assert (wrong / largest).max() <= 10 * run.error
    assert run.error <= 1e-13


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("trace", [None, False])
def test_every_engine_runs_what_is_recorded_and_what_is_called_back(engine, trace):
    system = rb.System(lambda t, x: [x[1], -4.0 * x[0]], [1.0, 0.0], trace=trace)
    if engine == "taylor" and trace is False:
        with pytest.raises(rb.InvalidInput, match="no Taylor series"):
            rb.simulate(system, 3.0, engine=engine)
        return
    error = ENGINES[engine]
    run = rb.simulate(system, 3.0, error=error, engine=engine)
    assert run.engine == engine and run.error <= error
    t = np.linspace(0, 3, 31)
    exact = np.stack([np.cos(2 * t), -2 * np.sin(2 * t)], axis=1)
    assert (np.abs(run.x(t) - exact) / [1.0, 2.0]).max() <= 10 * error


@pytest.mark.parametrize("trace", [None, False])
def test_what_is_watched_is_found_where_the_closed_form_has_it(trace):
    system = rb.System(lambda t, x: [x[1], -4.0 * x[0]], [1.0, 0.0], names=["x", "v"])
    system.watch("down", lambda now: now["x"] - 0.5, direction="falling", trace=trace)
    system.watch("up", lambda now: now.x[0] - 0.5, direction="rising", trace=trace)
    system.watch("enough", lambda now: now.time - 7.0, action="stop", trace=trace)
    run = rb.simulate(system, 10.0, error=1e-12)
    assert (run.status, run.end) == ("stopped by event", 7.0)
    first = np.arccos(0.5) / 2
    assert run.events.times("down") == pytest.approx([first, first + np.pi, first + 2 * np.pi], rel=1e-12)
    assert run.events.times("up") == pytest.approx([np.pi - first, 2 * np.pi - first], rel=1e-12)
    assert run.events.times("enough") == [7.0]


@pytest.mark.parametrize("whole", [True, False])
def test_a_ball_of_ones_own_bounces_as_the_closed_form_says(whole):
    system = rb.System(lambda t, x: [x[1], -10.0], [1.0, 0.0], names=["height", "speed"])
    after = (lambda now: [0.0, -0.9 * now["speed"]]) if whole else (lambda now: {"height": 0.0, 1: -0.9 * now.x[1]})
    system.watch("floor", lambda now: now["height"], direction="falling", action=after)
    run = rb.simulate(system, 5.0, error=1e-12)
    fall = np.sqrt(0.2)
    expected = [fall + 2 * fall * sum(0.9**k for k in range(1, n + 1)) for n in range(30)]
    expected = [t for t in expected if t <= 5.0]
    assert len(expected) == 8
    assert run.events.times("floor") == pytest.approx(expected, rel=1e-12)
    assert run.x(expected[0])[1] == pytest.approx(9 * fall, rel=1e-12)
    assert run.x(expected[0], side="before")[1] == pytest.approx(-10 * fall, rel=1e-12)
    assert run.rate(1.0) == pytest.approx([run["speed"].value(1.0), -10.0])


def test_a_relay_slides_and_lets_go_where_it_must():
    """x' = a(t) - sign(x): slides on x = 0 while |a| <= 1 (Filippov)."""
    system = rb.System(lambda t, x: [0.4 * t - np.sign(x[0])], [1.0])
    run = rb.simulate(system, 4.0, error=1e-12)
    # x = 1 - t + 0.2 t^2 until it is zero, and leaves it where 0.4 t = 1
    landed = (1 - np.sqrt(1 - 0.8)) / 0.4
    assert run.events.times("switch") == pytest.approx([landed, 2.5], rel=1e-12)
    assert run.x(2.0) == [0.0] and run.rate(2.0) == [0.0]
    assert run.x(4.0) == pytest.approx([0.2 * (4.0 - 2.5) ** 2], rel=1e-11)
    assert run.rate(2.5, side="after") == pytest.approx([0.0], abs=1e-12)


def test_a_case_of_ones_own_changes_sides_at_an_event():
    def spring(t, x):
        return [x[1], -9.0 * x[0] if x[0] > 0 else -x[0]]

    run = rb.simulate(rb.System(spring, [0.0, 1.0]), 6.0, error=1e-12)
    half = np.pi / 3
    assert run.events.times("switch") == pytest.approx([half, half + np.pi, 2 * half + np.pi], rel=1e-12)


def test_numbers_by_reference_are_taken_as_they_are_when_a_run_starts():
    k = rb.parameter(4.0, "k")
    system = rb.System(lambda t, x: [x[1], -k * x[0]], [1.0, 0.0])
    assert system.parameters == [k]
    runs = {}
    for k.value in (4.0, 9.0):
        runs[k.value] = rb.simulate(system, 1.0, error=1e-12)
    for value, run in runs.items():
        assert run.x(1.0)[0] == pytest.approx(np.cos(np.sqrt(value)), rel=1e-11)
        assert run.rate(1.0)[1] == pytest.approx(-value * run.x(1.0)[0], rel=1e-15)


def test_it_starts_where_initial_says():
    system = rb.System(lambda t, x: -x, [1.0, 2.0], names=["a", "b"])
    for initial, start in [({"b": 5.0}, [1, 5]), ({0: 3.0}, [3, 2]), ([4.0, 4.0], [4, 4]), (None, [1, 2])]:
        run = rb.simulate(system, 1.0, error=1e-12, initial=initial)
        assert run.x(1.0) == pytest.approx(np.array(start) / np.e, rel=1e-11)
    assert list(system.x0) == [1.0, 2.0]


def test_a_compiled_function_is_called_by_its_address():
    @ctypes.CFUNCTYPE(None, ctypes.c_double, ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_double))
    def decay(t, x, rate):
        rate[0], rate[1] = -x[0], -2 * x[1]

    run = rb.simulate(rb.System(decay, [1.0, 1.0]), 1.0, error=1e-12)
    assert run.engine == "dop853" and run.statistics.python_calls == 0
    assert run.x(1.0) == pytest.approx([np.exp(-1), np.exp(-2)], rel=1e-11)


@pytest.mark.parametrize("size", [1, 9, 40])
@pytest.mark.parametrize("trace", [None, False])
def test_states_of_any_length_are_lists(size, trace):
    rates = -np.linspace(1, 3, size)
    run = rb.simulate(rb.System(lambda t, x: rates * x, np.ones(size), trace=trace), 1.0, error=1e-12)
    assert run.x(1.0).shape == (size,) and run.x([0.5, 1.0]).shape == (2, size)
    assert run.x(1.0) == pytest.approx(np.exp(rates), rel=1e-11)


def test_one_variable_may_be_given_as_a_number():
    for f in (lambda t, x: -x[0], lambda t, x: -float(x[0]), lambda t, x: [-float(x[0])]):
        assert rb.simulate(rb.System(f, [1.0]), 1.0, error=1e-12).x(1.0) == pytest.approx([np.exp(-1)], rel=1e-11)


@pytest.mark.parametrize("engine", ["taylor", "dop853"])
def test_what_grows_from_nothing_through_many_others_does_not_ask_for_endless_steps(engine):
    """Diffusion along a ring: of n places the farthest begins as t^(n/2)."""
    n = 30
    ring = np.roll(np.eye(n), 1, axis=0) + np.roll(np.eye(n), -1, axis=0) - 2 * np.eye(n)
    system = rb.System(lambda t, x: np.roll(x, 1) - 2 * x + np.roll(x, -1), np.eye(n)[0])
    run = rb.simulate(system, 5.0, engine=engine, max_steps=500)
    values, vectors = np.linalg.eigh(ring)
    exact = vectors @ (np.exp(5 * values) * vectors[0])
    assert run.x(5.0) == pytest.approx(exact, abs=1e-9 * exact.max())


def test_runs_and_systems_are_data():
    system = rb.System(double_pendulum, START, names=["a", "b", "p", "q"])
    system.watch("low", lambda now: now["a"], direction="rising")
    run = rb.simulate(system, until=3.0, error=1e-10)
    again, other = pickle.loads(pickle.dumps(run)), pickle.loads(pickle.dumps(system))
    t = np.linspace(0, 3, 50)
    assert np.array_equal(again.x(t), run.x(t)) and np.array_equal(again.rate(t), run.rate(t))
    assert again.events == run.events and again.statistics == run.statistics and str(again) == str(run)
    assert np.array_equal(rb.simulate(other, until=3.0, error=1e-10).x(t), run.x(t))
    assert np.array_equal(rb.simulate(copy.deepcopy(system), until=3.0, error=1e-10).x(t), run.x(t))
    sample = run.sample(t)
    assert np.array_equal(sample["b"], run["b"].value(t)) and np.array_equal(sample[1], run[1].value(t))


def test_tables_have_a_column_a_variable(tmp_path):
    run = rb.simulate(rb.System(lambda t, x: -x, [1.0, 2.0], names=["a", "b"]), 1.0)
    run.sample([0.0, 0.5]).to_csv(tmp_path / "x.csv")
    head, *rows = (tmp_path / "x.csv").read_text().splitlines()
    assert head == "t,a,b"
    assert [float(x) for x in rows[1].split(",")] == [0.5, *run.x(0.5)]
    frame = run.sample().to_pandas()
    assert list(frame.columns) == ["a", "b"] and frame.attrs["engine"] == "taylor"


def test_what_ends_in_infinity_ends_there_with_its_name():
    with pytest.raises(rb.IntegrationError, match="not finite at t = 1.0000000000") as caught:
        rb.simulate(rb.System(lambda t, x: [x[0] ** 2], [1.0]), 2.0)
    assert caught.value.run.x(0.5) == pytest.approx([2.0], rel=1e-9)


def test_an_exception_of_ones_own_arrives_with_the_run():
    def f(t, x):
        if float(t) > 0.5:
            raise KeyError("boom")
        return [1.0]

    with pytest.raises(KeyError, match="boom") as caught:
        rb.simulate(rb.System(f, [1.0]), 2.0)
    assert isinstance(caught.value.run, rb.SystemRun)


def test_the_plan_says_what_is_run_and_why():
    plan = rb.plan(rb.System(lambda t, x: -x, [1.0]))
    assert (plan.engine, plan.variables, plan.size.variables) == ("taylor", ["x[0]"], 1)
    plan = rb.plan(rb.System(lambda t, x: [-float(x[0])], [1.0]))
    assert plan.engine == "dop853" and "float(x[0])" in plan.functions[0]


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (lambda: rb.System(lambda t, x: x, []), "x0 has 0 numbers"),
        (lambda: rb.System(lambda t, x: x, [[1.0]]), r"x0 has shape \(1, 1\)"),
        (lambda: rb.System(lambda t, x: x, [np.nan]), r"x0\[0\] is nan"),
        (
            lambda: rb.System(lambda t, x: [1.0, 2.0], [1.0]),
            r"returns shape \(2,\); it returns the rates of 1 variable",
        ),
        (
            lambda: rb.System(lambda t, x: x[:1], [1.0, 2.0]),
            r"returns shape \(1,\); it returns the rates of 2 variables",
        ),
        (lambda: rb.System(lambda x: x, [1.0]), "takes 1 argument; it is called with 2"),
        (lambda: rb.System(3, [1.0]), "3 is no function"),
        (lambda: rb.System(lambda t, x: x, [1.0, 2.0], names=["a", "a"]), 'two variables named "a"'),
        (lambda: rb.System(lambda t, x: x, [1.0, 2.0], names=["a"]), "count of names is 1"),
        (lambda: rb.System(lambda t, x: x, [1.0], names=[""]), "a name is empty"),
        (
            lambda: rb.System(rb.Function(lambda x: x), [1.0]),
            "Function has 1 inputs and 1 results; here it has 2 and 1",
        ),
        (lambda: small().watch("w", lambda now: now["b"]), 'no variable named "b"; there are "a"'),
        (lambda: small().watch("w", lambda now: now.position), "SystemNow has no position; it has time, x"),
        (lambda: small().watch("", lambda now: now.time), "name is empty"),
        (lambda: small().watch("w", 3), "3 is no function"),
        (lambda: small().watch("w", lambda now: now.x[0], action="jump"), 'action is "jump"'),
        (lambda: small().watch("w", lambda now: now.x[0], direction="up"), 'direction is "up"'),
        (lambda: rb.simulate(small(), 1.0, initial=[1.0, 2.0]), "count of numbers of initial is 2"),
        (lambda: rb.simulate(small(), 1.0, initial={"b": 1.0}), 'no variable named "b"'),
        (lambda: rb.simulate(small(), 1.0, engine="closed form"), "a System has none"),
        (lambda: rb.simulate(small(), 1.0)["b"], 'no variable named "b"'),
        (lambda: rb.simulate(small(), 1.0).x(2.0), "this run goes from 0 to 1"),
        (lambda: rb.simulate(changed(lambda now: [1.0, 2.0]), 2.0), "count of numbers of what its action returns is 2"),
        (lambda: rb.simulate(changed(lambda now: {"a": np.inf}), 2.0), "a after its action is inf"),
    ],
)
def test_what_breaks_a_rule_is_said(bad, message):
    with pytest.raises(rb.InvalidInput, match=message):
        bad()


def small():
    return rb.System(lambda t, x: -x, [1.0], names=["a"])


def changed(action):
    system = small()
    system.watch("half", lambda now: now["a"] - 0.5, action=action)
    return system


@pytest.mark.parametrize("system", ["f", "watch", "action"])
def test_what_is_called_back_cannot_be_pickled_and_says_so(system):
    given = rb.System(lambda t, x: -x, [1.0], trace=False if system == "f" else None)
    if system == "watch":
        given.watch("w", lambda now: now.x[0], trace=False)
    if system == "action":
        given.watch("w", lambda now: now.x[0], action=lambda now: [1.0])
    with pytest.raises(TypeError, match=r"only what is traced can be pickled"):
        pickle.dumps(given)


def test_what_accuracy_costs_is_told_as_of_scenes():
    # the same motion as a scene and as equations of one's own: errors of the same size, every engine in turn
    system = rb.System(lambda t, x: [x[1], -9.81 * np.sin(x[0])], [2.0, 0.0], names=["angle", "rate"])
    system.watch("lowest point", lambda now: now["angle"])
    price = rb.cost(system, until=5.0, errors=[1e-4, 1e-8], budget=6.0)
    assert price.automatic == "taylor" and "long double" in price.reference
    engines = {row.engine for row in price.rows}
    assert {"taylor", "dop853"} <= engines and "closed form" not in engines
    assert [m.reason for m in price.missing if m.engine == "closed form"] == ["cannot: a System has none"]
    exact = rb.simulate(system, until=5.0, error=1e-13)
    for row in price.rows:
        run = rb.simulate(system, until=5.0, rtol=row.tolerance, engine=row.engine)
        apart = np.abs(run.x(5.0) - exact.x(5.0)).max() / 6.0
        assert apart <= 3 * row.motion_error + 1e-14
        assert row.has_all_events and row.events == row.events_expected == len(exact.events)
    assert price.cheapest(1e-8).error <= 1e-8


def test_what_cannot_be_recorded_is_priced_without_a_series():
    system = rb.System(lambda t, x: [x[1], -float(x[0])], [1.0, 0.0])
    price = rb.cost(system, until=3.0, errors=[1e-4], budget=3.0)
    assert price.automatic == "dop853" and {row.engine for row in price.rows} <= {"dop853", "cvode-adams", "cvode-bdf"}
    assert [m.reason for m in price.missing if m.engine == "taylor"][0].startswith("cannot: f of this System is called")


def test_a_system_that_ends_early_has_no_price_and_says_why():
    system = rb.System(lambda t, x: [1 + x[0] ** 2], [0.0])
    with pytest.raises(rb.IntegrationError) as here:
        rb.cost(system, until=2.0, budget=2.0)
    assert here.value.run.end == pytest.approx(np.pi / 2)
