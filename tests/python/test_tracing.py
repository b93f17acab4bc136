"""How functions of the user's are recorded: every case they distinguish, and why not where that is impossible."""

import copy
import inspect
import math
import pickle
import subprocess
import sys
import textwrap

import numpy as np
import pytest
import rbdyn as rb
from rbdyn._core import _user_function


def line_of(function, text):
    """The line of a function's source that holds a text."""
    lines, first = inspect.getsourcelines(function)
    return first + next(i for i, line in enumerate(lines) if text in line)


# --- cases ---


def test_an_if_is_recorded_with_both_sides():
    def f(t):
        if t > 1:
            return 2 * t
        return t * t

    recorded = rb.Function(f)
    for t in (-1.0, 0.5, 1.0, 1.5):
        assert recorded(t) == f(t)
    assert f"if, line {line_of(f, 'if t')} of test_tracing.py" in str(recorded)


def test_nested_cases_are_recorded_on_every_side():
    def f(x, y, z):
        if x > 0:
            if y > x:
                return x + y
            elif z < y:
                return x - z
            return x * z
        for _ in range(2):
            if y > 2:
                y = y - 1
        return y if 0 < z <= 1 else max(x, y, z)

    recorded = rb.Function(f)
    points = (-1.5, 0.3, 0.75, 2.25, 3.5, 4.25, 6.0)
    for x in points:
        for y in points:
            for z in points:
                assert recorded(x, y, z) == f(x, y, z)


def test_a_question_whose_answer_follows_is_not_asked_again():
    calls = []

    def stairs(t):
        calls.append(1)
        result = 0.0
        for knot in range(10):
            if t > knot:
                result += 1.0
        return result

    recorded = rb.Function(stairs)
    # ten knots part the line in eleven pieces
    assert len(calls) == 11
    for t in (-1.0, 0.0, 0.5, 3.0, 3.5, 10.0):
        assert recorded(t) == stairs(t)


def test_equality_is_known_where_neither_is_greater():
    def sign(x, y):
        if x > y:
            return 1.0
        if y > x:
            return -1.0
        assert x == y and not x != y
        return 0.0

    recorded = rb.Function(sign)
    assert (recorded(1.0, 0.0), recorded(0.0, 1.0), recorded(2.0, 2.0)) == (1.0, -1.0, 0.0)


def test_conditions_of_known_numbers_are_known():
    recorded = rb.Function(lambda t: t if 0 * t < 1 and 0 * t == 0 and float(0 * t + 2) == 2 else 1 / 0)
    assert recorded(3.0) == 3.0


def test_a_number_is_no_other_thing():
    assert rb.Function(lambda t: 1.0 if t == None or t == "a" else t)(4.0) == 4.0  # noqa: E711


# --- why not ---


def uses_math(t):
    return math.sin(t)


def fills_an_array(t):
    f = np.zeros(3)
    f[0] = t
    return f[0]


def adds_into_an_array(t):
    f = np.zeros(3)
    f += np.stack([t, t, t])
    return f[0]


def compares(t):
    return 1.0 if t == 1 else 0.0


def asks_truth(t):
    return 1.0 if t else 0.0


def converts(t):
    return 2 * float(t)


def counts(t):
    return int(t) + 1


def swallows(t):
    try:
        return float(t)
    except ValueError:
        return 0.0


def makes_floats(t):
    return np.array([t, 1.0], dtype=float)[0]


def indexes(t):
    return [1.0, 2.0][t]


def never_ends(t):
    while t < 1e300:
        t = t + 1.0
    return t


def waits_for_ever(t):
    while t > 0:
        pass
    return t


def has_many_cases(t):
    result = 0.0
    for k in range(10):
        if np.sin(k * t) > 0.5:
            result = result + 1.0
    return result


def divides_by_zero(t):
    if t > 1:
        return t / (1 - 1) if t is None else 1 / 0
    return t


def asks_numpy(t):
    return np.spacing(t)


def chooses_elements(t):
    v = np.stack([t, 2 * t])
    return v[v > 0].sum()


def mixes(t):
    return np.sin(np.array([t, 0.5]))[0]


@pytest.mark.parametrize(
    ("function", "text", "reason"),
    [
        (uses_math, "math.sin", r"math.sin\(t\) asks for the value .*; np.sin can be recorded"),
        (fills_an_array, "f[0] =", r"into an array of plain numbers; .*np.array\(\[x, y, z\]\)"),
        (adds_into_an_array, "f +=", "into an array of plain numbers"),
        (compares, "t == 1", "asks whether a recorded number equals another"),
        (asks_truth, "if t", "asks whether a recorded number is zero"),
        (converts, "float(t)", r"float\(t\) asks for the value .*; leave the conversion out"),
        (counts, "int(t)", r"int\(t\) asks for a whole number; np.floor"),
        (swallows, "float(t)", r"float\(t\) asks for the value"),
        (makes_floats, "np.array", "asks for the value .*; leave out the type"),
        (indexes, "[t]", "raises TypeError: list indices"),
        (never_ends, "while", "64 cases|without end|1000 times"),
        (waits_for_ever, "while", "without end"),
        (has_many_cases, "if np.sin", "more than 64 cases together"),
        (divides_by_zero, "1 / 0", "raises ZeroDivisionError"),
        (asks_numpy, "np.spacing", "the ufunc spacing cannot be recorded"),
        (chooses_elements, "v[v > 0]", "raises IndexError"),
        (mixes, "np.sin", r"np.stack\(\[x, 1.0\]\)"),
    ],
)
def test_what_cannot_be_recorded_says_which_line_and_what_helps(function, text, reason):
    with pytest.raises(rb.InvalidInput, match=reason) as caught:
        _user_function("time", function, True)
    message = str(caught.value)
    assert message.startswith(f'TimeFunction: function "{function.__name__}" cannot be recorded: ')
    assert f"line {line_of(function, text)} of test_tracing.py" in message
    # by default it is called back, for the same reason
    user = _user_function("time", function)
    assert user.recorded is None and user.is_python
    assert user.reason in message


def test_the_line_is_the_users_own_not_one_of_numpy_or_this_library():
    def f(t):
        return np.vectorize(lambda x: math.cos(x))(np.stack([t, t])).sum()

    user = _user_function("time", f)
    assert f"line {line_of(f, 'vectorize')} of test_tracing.py: math.cos(x) asks" in user.reason


def test_a_function_that_is_not_written_in_python_has_no_line():
    user = _user_function("time", math.sin)
    assert user.reason.startswith("it asks for the value of a number that is being recorded")
    assert user(0.5) == math.sin(0.5)


def test_a_function_that_changes_its_mind_is_not_recorded():
    asked = []

    def f(t, x, y, z, vx, vy, vz):
        asked.append(1)
        return (1.0 if (x if len(asked) % 2 else y) > 0 else 2.0), 0.0, 0.0

    assert "something else each time" in _user_function("force", f).reason


def test_a_case_that_breaks_a_rule_is_left_to_the_calls():
    user = _user_function("force", lambda t, r, v: (1.0, 2.0, 3.0) if r[0] > v[0] else (1.0, 2.0))
    assert user.recorded is None
    assert user(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0) == (1.0, 2.0, 3.0)
    with pytest.raises(rb.InvalidInput, match=r"returns shape \(2,\); a force has three components"):
        user(0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_trace_false_calls_back_and_says_so():
    user = _user_function("time", np.sin, False)
    assert (user.recorded, user.reason, user.is_python, user.name) == (None, "trace=False", True, "sin")
    assert user(0.5) == np.sin(0.5)
    assert user.calls == 1


def test_an_interrupt_is_no_reason():
    def f(t):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        _user_function("time", f)


# --- every kind of function ---


def test_a_force_may_take_vectors_or_numbers():
    vectors = _user_function("force", lambda t, r, v: t * np.cross(r, v))
    numbers = _user_function("force", lambda t, x, y, z, vx, vy, vz: (y * vz, t, abs(vx)))
    arguments = (2.0, 1.0, 2.0, 3.0, -4.0, 5.0, 6.5)
    assert vectors.reason == numbers.reason == ""
    np.testing.assert_allclose(vectors(*arguments), 2 * np.cross(arguments[1:4], arguments[4:]), rtol=1e-15)
    assert numbers(*arguments) == (13.0, 2.0, 4.0)
    more = _user_function("force", lambda t, r, v, k=3.0: -k * r)
    assert more(*arguments) == (-3.0, -6.0, -9.0)
    with pytest.raises(rb.InvalidInput, match="takes 2 arguments; it is called with 3, or with each of the 7 numbers"):
        _user_function("force", lambda t, r: r)


def test_a_potential_may_take_a_vector_or_numbers():
    assert _user_function("potential", lambda r: 0.5 * r @ r).recorded(1.0, 2.0, 2.0) == 4.5
    assert _user_function("potential", lambda x, y, z: np.hypot(x, y) * z).recorded(3.0, 4.0, 2.0) == 10.0
    assert _user_function("potential", lambda r: math.sqrt(r @ r))(1.0, 2.0, 2.0) == 3.0


def rotation(t):
    c, s = np.cos(t), np.sin(t)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def homogeneous(t):
    c, s = np.cos(t), np.sin(t)
    return np.array([[c, -s, 0, t], [s, c, 0, 2 * t], [0, 0, 1, 0], [0, 0, 0, 1]])


@pytest.mark.parametrize("trace", [True, False])
@pytest.mark.parametrize(
    ("motion", "turns", "moves"),
    [
        (lambda t: [t, 2 * t, 0], False, True),
        (rotation, True, False),
        (lambda t: (rotation(t), [t, 2 * t, 0]), True, True),
        (lambda t: (np.array([t, 2 * t, 0]), rotation(t)), True, True),
        (homogeneous, True, True),
    ],
)
def test_a_rigid_motion_may_be_written_in_any_of_its_forms(motion, turns, moves, trace):
    result = _user_function("motion", motion, trace)(0.7)
    matrix, displacement = np.reshape(result[:9], (3, 3)), result[9:]
    np.testing.assert_allclose(matrix, rotation(0.7) if turns else np.eye(3), rtol=1e-15)
    np.testing.assert_allclose(displacement, [0.7, 1.4, 0] if moves else np.zeros(3), rtol=1e-15)


@pytest.mark.parametrize(
    "motion",
    [lambda t: t, lambda t: [t, t], lambda t: (rotation(t), rotation(t)), lambda t: homogeneous(t).T],
)
def test_what_is_no_rigid_motion_is_refused(motion):
    with pytest.raises(rb.InvalidInput, match="a motion is a displacement"):
        _user_function("motion", motion)(0.5)


def test_a_curve_is_three_functions_of_one_number():
    helix = _user_function("curve", lambda u: (np.cos(u), np.sin(u), 0.1 * u))
    np.testing.assert_allclose(helix.recorded(2.0), [np.cos(2), np.sin(2), 0.2], rtol=1e-15)


# --- parameters ---


def test_a_parameter_is_used_by_reference():
    k = rb.parameter(2.0, "k")
    f = rb.Function(lambda x: np.sin(k * x) + k**2 - 1 / k + np.maximum(k, 1.0) * abs(-k) + 0 * k.value)
    for value in (2.0, 0.5):
        k.value = value
        expected = np.sin(value * 0.3) + value**2 - 1 / value + max(value, 1.0) * value
        assert f(0.3) == pytest.approx(expected, rel=1e-15)
    assert f.parameters == [k] and f.parameters[0] is k
    assert repr(k) == "parameter(0.5, 'k')"


def test_a_parameter_outside_of_a_function_asks_to_be_explicit():
    k = rb.parameter(2.0, "stiffness")
    for use in (lambda: k * 2, lambda: 2 - k, lambda: np.sin(k), lambda: np.array([1.0]) * k, lambda: k > 1):
        with pytest.raises(rb.InvalidInput, match=r"stiffness: .*write \.value"):
            use()
    assert float(k) == 2.0
    with pytest.raises(rb.InvalidInput, match="finite"):
        k.value = math.inf
    with pytest.raises(rb.InvalidInput, match="finite"):
        rb.parameter(math.nan)


def test_a_parameter_is_its_number_where_a_function_is_called_back():
    k = rb.parameter(2.0)
    user = _user_function("force", lambda t, r, v: -k * r * math.cos(t) + float(k) + k.value, trace=None)
    assert user.recorded is None and "math.cos" in user.reason
    assert user(0.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0) == (2.0, 0.0, -2.0)
    k.value = 3.0
    assert user(0.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0) == (3.0, 0.0, -3.0)


def test_float_of_a_parameter_would_fix_it_for_good():
    k = rb.parameter(2.0)
    assert "float(k) asks for the value" in _user_function("time", lambda t: float(k) * t).reason


def test_a_copy_of_a_parameter_is_another_one():
    k = rb.parameter(2.0, "k")
    for other in (copy.copy(k), copy.deepcopy(k), pickle.loads(pickle.dumps(k))):
        other.value = 5.0
        assert (other.name, k.value) == ("k", 2.0)


def test_parameters_pickled_with_their_functions_stay_shared():
    k = rb.parameter(2.0, "k")
    f, g = rb.Function(lambda x: k * x), rb.Function(lambda x: k + x)
    f, g, k = pickle.loads(pickle.dumps((f, g, k)))
    k.value = 10.0
    assert (f(2.0), g(2.0)) == (20.0, 12.0)


# --- functions as data ---


def branching(x, y):
    return np.hypot(x, y) % 3 if x > y else (np.sign(x), np.floor(y), x)[2] - np.exp(y)


def test_a_function_is_data():
    f, g, h = rb.Function(branching), rb.Function(branching), rb.Function(lambda x, y: x + y)
    assert f == g and hash(f) == hash(g) and f != h and f != "f"
    assert (f.inputs, f.outputs, f.parameters) == (2, 1, [])
    assert "norm" in str(f) and "exp" in str(f) and "if, line" in str(f)
    for other in (copy.copy(f), copy.deepcopy(f), pickle.loads(pickle.dumps(f))):
        assert other == f
        assert other(1.0, 2.0) == f(1.0, 2.0)
    assert rb.Function(f) == f
    with pytest.raises(rb.InvalidInput, match="called with 1 numbers; it takes 2"):
        f(1.0)


def test_a_function_has_all_its_inputs_used_or_not():
    f = rb.Function(lambda x, y, z: y)
    assert f.inputs == 3 and f(1.0, 2.0, 3.0) == 2.0
    assert _user_function("force", lambda t, r, v: [0, 0, -1]).recorded.inputs == 7
    assert rb.Function(lambda *xs: sum(xs), 4)(1.0, 2.0, 3.0, 4.0) == 10.0


def test_a_recorded_function_is_taken_where_its_numbers_fit():
    f = rb.Function(lambda t, x, y, z, vx, vy, vz: (-x, -y, -z))
    assert _user_function("force", f).recorded == f
    with pytest.raises(rb.InvalidInput, match="has 7 inputs and 3 results; here it has 1 and 1"):
        _user_function("time", f)


def test_a_function_travels_to_another_process(tmp_path):
    # the pickle of a lambda: no source of it is needed
    (tmp_path / "f").write_bytes(pickle.dumps(rb.Function(lambda x, y: np.hypot(x, y) if x > 0 else x - y)))
    program = f"""
        import pickle
        f = pickle.loads(open({str(tmp_path / "f")!r}, "rb").read())
        assert f(3.0, 4.0) == 5.0 and f(-1.0, 2.0) == -3.0
    """
    subprocess.run([sys.executable, "-c", textwrap.dedent(program)], check=True, cwd=tmp_path)


def test_a_function_becomes_part_of_another():
    k = rb.parameter(3.0)
    polar = rb.Function(lambda x, y: (np.hypot(x, y), np.arctan2(y, x) * k))
    f = rb.Function(lambda x: sum(polar(x, 2.0)) if x > 1 else polar(0.0, 1.0)[1] * x)
    for x in (-1.0, 2.0):
        assert f(x) == (np.hypot(x, 2.0) + 3 * np.arctan2(2.0, x) if x > 1 else 1.5 * np.pi * x)
    k.value = 0.0
    assert (f(2.0), f.parameters) == (np.hypot(2.0, 2.0), [k])
    with pytest.raises(rb.InvalidInput, match="its inputs are numbers"):
        rb.Function(lambda x: polar(x, "a"))


def test_data_that_are_no_function_are_refused():
    from rbdyn._core import _function

    for nodes, outputs in (([("add", 0, 1, -1, -1, 0.0)], [0]), ([("input", 3, -1, -1, -1, 0.0)], [0]), ([], [0])):
        with pytest.raises(rb.InvalidInput, match="Function"):
            _function(1, nodes, outputs, [], [])
    with pytest.raises(rb.InvalidInput, match='"tangle"'):
        _function(1, [("tangle", 0, 1, -1, -1, 0.0)], [0], [], [])


def test_recordings_do_not_mix():
    kept = []

    def outer(t):
        inner = rb.Function(lambda x: x + 1)
        kept.append(t)
        return inner(2.0) + t

    assert rb.Function(outer)(1.0) == 4.0
    with pytest.raises(rb.InvalidInput, match="has returned"):
        rb.Function(lambda t: kept[0] + t)
    for inner in (lambda x, t: x + t, lambda x, t: rb.where(x > 0, t, x), lambda x, t: rb.where(t > 0, x, 2 * x)):
        with pytest.raises(rb.InvalidInput, match="another"):
            rb.Function(lambda t, inner=inner: rb.Function(lambda x: inner(x, t))(1.0) + t, 1)


def test_a_parameter_stays_one_in_a_recording_that_a_call_back_makes():
    k = rb.parameter(2.0)
    made = []

    def f(t):
        made.append(rb.Function(lambda x: k * x))
        return math.sin(k * t)

    assert _user_function("time", f, False)(1.0) == math.sin(2.0)
    k.value = 3.0
    assert made[0](1.0) == 3.0
