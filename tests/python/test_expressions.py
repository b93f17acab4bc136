"""NumPy's functions of recorded numbers: what is recorded gives NumPy's own numbers."""

import math
import operator

import numpy as np
import pytest
import rbdyn as rb
from hypothesis import given, settings
from hypothesis import strategies as st

# a few operations, each rounded
ROUNDED = {"rtol": 4e-15, "atol": 1e-15}
# no two of them in a whole ratio, where a jump is as near as rounding
ANYWHERE = (-2.71, -0.93, -0.37, 0.23, 0.83, 1.61, 3.43)
POSITIVE = (0.1, 0.7, 1.0, 2.5, 9.0)
WITHIN_ONE = (-0.95, -0.4, 0.0, 0.3, 0.9)

UNARY = {
    "sin cos arctan sinh cosh tanh arcsinh exp exp2 expm1 cbrt square absolute fabs sign floor ceil trunc rint "
    "deg2rad radians rad2deg degrees negative positive conjugate tan": ANYWHERE,
    "log log2 log10 log1p sqrt reciprocal": POSITIVE,
    "arcsin arccos arctanh": WITHIN_ONE,
    "arccosh": (1.1, 2.0, 30.0),
}
SIZES = 10.0 ** np.linspace(-300, 300, 401)
NEAR = 10.0 ** -np.linspace(0.1, 15.9, 80)
# where digits are lost by the formulas that come to mind
ALL_SIZES = {
    "arcsinh tanh arctan": (*SIZES, *-SIZES, 0.0),
    "log1p": (*SIZES, *-NEAR, *(NEAR - 1.0), *-SIZES[SIZES < 1.0], 0.0),
    "expm1": (*SIZES[SIZES < 700.0], *-SIZES, 709.0, 0.0),
    "arctanh": (*SIZES[SIZES < 1.0], *-SIZES[SIZES < 1.0], *(1.0 - NEAR), *(NEAR - 1.0), 0.0),
    "arccosh": (*(1.0 + NEAR), *(1.0 + SIZES), 1.0),
    "exp2": (*SIZES[SIZES < 1000.0], *-SIZES[SIZES < 1000.0], -1010.7, 1023.3, 12.0),
}
BINARY = (
    "add subtract multiply divide logaddexp arctan2 hypot maximum minimum fmax fmin copysign remainder mod fmod "
    "floor_divide"
)


def numpy_of(name, *points):
    with np.errstate(all="ignore"):
        return getattr(np, name)(*points)


@pytest.mark.parametrize(
    ("name", "points"), [(name, points) for names, points in UNARY.items() for name in names.split()]
)
def test_a_ufunc_of_one_number_is_numpys(name, points):
    f = rb.Function(lambda x: getattr(np, name)(x))
    bare = rb.Function(lambda x: getattr(np, name)(np.array([x, 2 * x / 2]))[1])
    for x in points:
        np.testing.assert_allclose(f(x), numpy_of(name, x), **ROUNDED)
        np.testing.assert_allclose(bare(x), numpy_of(name, x), **ROUNDED)


@pytest.mark.parametrize("name", " ".join(ALL_SIZES).split())
def test_a_ufunc_has_its_digits_for_arguments_of_any_size(name):
    f = rb.Function(lambda x: getattr(np, name)(x))
    points = np.array(next(points for names, points in ALL_SIZES.items() if name in names.split()))
    np.testing.assert_allclose([f(x) for x in points], numpy_of(name, points), rtol=1.2e-15, atol=0)


def test_lengths_and_powers_have_their_digits_for_arguments_of_any_size():
    hypot, power = rb.Function(np.hypot), rb.Function(np.power)
    for x in SIZES[::7]:
        for y in SIZES[::11]:
            assert hypot(x, -y) == pytest.approx(np.hypot(x, y), rel=5e-16, abs=0)
        y = 300 / math.log10(x) if x != 1.0 else 2.0
        assert power(x, y) == pytest.approx(x**y, rel=5e-16, abs=0)
    assert power(0.0, 0.0) == 1.0 and power(0.0, 2.5) == 0.0 and power(3.0, 0.0) == 1.0
    alike = rb.Function(np.logaddexp)
    assert alike(1e-9, -40.0) == pytest.approx(np.logaddexp(1e-9, -40.0), rel=5e-16)


@pytest.mark.parametrize("name", ["arcsinh", "log1p", "arctanh", "expm1"])
@pytest.mark.parametrize("size", [1e-3, 1e-9, 1e-17, 1e-200])
def test_what_is_watched_of_small_numbers_is_located_as_what_it_is_of(name, size):
    f = getattr(np, name)
    level = float(f(0.5 * size))
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[size, 0, 0])
    scene.connect(rb.Spring(1.0), ball, [0, 0, 0])
    scene.watch("half", lambda now: f(now[ball].position[0]) - level)
    scene.watch("none", lambda now: f(now[ball].position[0]))
    run = rb.simulate(scene, 3.0, error=1e-12)
    assert run.events.times("half") == pytest.approx([math.pi / 3], abs=1e-12)
    assert run.events.times("none") == pytest.approx([math.pi / 2], abs=1e-12)


def test_forces_of_small_numbers_move_as_their_slopes_do():
    for f in (np.arcsinh, np.arctanh, np.log1p, np.expm1):
        scene = rb.Scene()
        ball = scene.add(rb.Particle(1.0), position=[1e-18, 0, 0])
        scene.apply(rb.Force(lambda t, r, v, f=f: [-f(r[0]), 0, 0]), ball)
        for engine in ("taylor", "dop853"):
            run = rb.simulate(scene, 10.0, error=1e-10, engine=engine)
            assert run[ball].position(10.0)[0] == pytest.approx(1e-18 * math.cos(10.0), abs=2e-28)


def test_a_system_of_expm1_goes_on_where_it_is_minus_one():
    run = rb.simulate(rb.System(lambda t, x: [1.0, np.expm1(-x[0] * x[0])], [30.0, 0.0]), 20.0)
    assert run.x(20.0) == pytest.approx([50.0, -20.0], rel=1e-14)


@pytest.mark.parametrize("name", BINARY.split())
def test_a_ufunc_of_two_numbers_is_numpys(name):
    u = getattr(np, name)
    both = rb.Function(lambda x, y: u(x, y))
    left, right = rb.Function(lambda x: u(x, 0.7)), rb.Function(lambda y: u(-1.3, y))
    for x in ANYWHERE:
        for y in ANYWHERE:
            np.testing.assert_allclose(both(x, y), u(x, y), **ROUNDED)
        np.testing.assert_allclose(left(x), u(x, 0.7), **ROUNDED)
        np.testing.assert_allclose(right(x), u(-1.3, x), **ROUNDED)


@pytest.mark.parametrize("name", ["power", "float_power"])
@pytest.mark.parametrize("n", [0, 1, 2, 3, -2, 0.5, 2.5, -1.5, 20])
def test_powers_are_numpys(name, n):
    f = rb.Function(lambda x: getattr(np, name)(x, n))
    for x in POSITIVE:
        # up to twenty factors, each rounded
        np.testing.assert_allclose(f(x), x**n, rtol=2e-14)


def test_an_exponent_may_vary_where_the_base_is_positive():
    f = rb.Function(lambda x, y: x**y + 2.0**y)
    assert f(1.7, -0.6) == pytest.approx(1.7**-0.6 + 2.0**-0.6, rel=1e-14)
    with pytest.raises(rb.InvalidInput, match="base of a power is -2"):
        rb.Function(lambda y: (-2.0) ** y)


def test_what_is_at_zero_has_neither_sign():
    f = rb.Function(lambda x: np.heaviside(x, 0.5) + 10 * np.heaviside(x, 1.0) + 100 * np.heaviside(x, 0.0))
    assert [f(x) for x in (-1.0, 0.0, 1.0)] == [0.0, 10.5, 111.0]
    g = rb.Function(np.sign)
    assert [g(x) for x in (-2.0, -0.0, 0.0, 3.0)] == [-1.0, 0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    "f",
    [
        lambda x, y: divmod(x, y)[0] + 3 * divmod(x, y)[1],
        lambda x, y: divmod(x, 0.6)[1] + divmod(2.0, y)[0],
        lambda x, y: x % y + 2.0 % x + x // y + 7.0 // x,
        lambda x, y: abs(x) ** 1.5 - (+x) * (-y),
        lambda x, y: math.floor(x) + 2 * math.ceil(y) + 5 * math.trunc(x + y),
        lambda x, y: round(x, 1) + round(y),
        lambda x, y: np.float64(2.0) * x - np.float64(0.5) / y + np.int32(3) + np.array(2.0) * x + True * y,
        lambda x, y: sum(divmod(np.stack([x, y]), 0.7)[0]),
        lambda x, y: (x > 0) * 3.0 + (y < 1) + 2 * (x >= y),
    ],
)
def test_pythons_arithmetic_is_recorded(f):
    recorded = rb.Function(f)
    for x in ANYWHERE:
        for y in ANYWHERE:
            assert recorded(x, y) == pytest.approx(float(f(x, y)), rel=1e-14, abs=1e-14)


@pytest.mark.parametrize("compare", [operator.gt, operator.lt, operator.ge, operator.le])
def test_a_comparison_keeps_its_word_where_both_sides_are_equal(compare):
    chosen = rb.Function(lambda x, y: rb.where(compare(x, y), 1.0, -1.0))
    branched = rb.Function(lambda x, y: 1.0 if compare(x, y) else -1.0)
    reflected = rb.Function(lambda x: rb.where(compare(0.5, x), 1.0, -1.0))
    for x in (0.25, 0.5, 0.75):
        assert chosen(x, 0.5) == branched(x, 0.5) == (1.0 if compare(x, 0.5) else -1.0)
        assert reflected(x) == (1.0 if compare(0.5, x) else -1.0)


@pytest.mark.parametrize(
    "condition",
    [
        lambda x, y: (x > 0) & (y > 0),
        lambda x, y: (x > 0) | (y > 1),
        lambda x, y: ~(x > 0),
        lambda x, y: (x > 0) ^ (y > 0),
        lambda x, y: np.logical_and(x > 0, y < x),
        lambda x, y: np.logical_or(x > 1, ~(y < x) & (x < 2)),
        lambda x, y: np.logical_not(np.logical_xor(x > 1, y > 1)),
        lambda x, y: np.greater(x, y) & np.less_equal(y, 1.0) | np.signbit(x),
        lambda x, y: np.all(np.array([x, y]) > 0) if isinstance(x, float) else np.all(np.stack([x, y]) > 0),
        lambda x, y: np.any(np.stack([x, y]) > 1),
        lambda x, y: np.isfinite(x) & (y > x),
    ],
)
def test_conditions_join_as_logic_says(condition):
    def f(x, y):
        return rb.where(condition(x, y), x + y, x - 2 * y)

    recorded = rb.Function(f)
    for x in ANYWHERE:
        for y in ANYWHERE:
            # as numpy's own bools: ~True of Python's is -2
            u, v = np.float64(x), np.float64(y)
            assert recorded(x, y) == pytest.approx(float(f(u, v)), abs=1e-15)


MATRIX = np.array([[2.0, -1.0, 0.5], [0.0, 3.0, 1.0], [1.5, 0.0, 4.0]])


@pytest.mark.parametrize(
    "f",
    [
        lambda v: np.where(v > 0, v, -2 * v),
        lambda v: np.where([True, False, True], v, 0.0),
        lambda v: np.clip(v, -0.5, 1.0),
        lambda v: np.clip(v, None, [0, 1, 2]),
        lambda v: v.clip(-0.5, 0.5),
        lambda v: np.maximum(v, 0) - np.minimum(v, [1, 0, 2]),
        lambda v: np.sign(v) * np.hypot(v, 1.0) + np.arctan2(v, v[::-1] + 3.5),
        lambda v: np.select([v > 1, v > 0], [v, v**2], default=-v),
        lambda v: np.piecewise(v, [v < 0, v >= 1], [lambda x: -x, lambda x: x**2, lambda x: 3 * x]),
        lambda v: np.interp(v, [-2, -1, 0, 0.5, 3], [1, 0, 2, -1, 4]),
        lambda v: np.interp(v, [-1, 0, 0.5], [1, 0, 2], left=-5, right=7),
        lambda v: np.interp(v, [0.1, 0.5, 1.4], [1, 0, 2], period=1.5),
        lambda v: MATRIX @ v + v @ MATRIX,
        lambda v: np.dot(MATRIX, v) + np.matmul(v, MATRIX),
        lambda v: np.cross(v, [1, 2, 3]) + np.cross(MATRIX, v)[1],
        lambda v: v / np.linalg.norm(v) + np.linalg.norm(v, 1) - np.linalg.norm(v, np.inf),
        lambda v: np.linalg.norm(MATRIX * v, axis=1) + np.linalg.norm(MATRIX * v),
        lambda v: np.linalg.norm(MATRIX * v, axis=0, keepdims=True)[0],
        lambda v: [np.inner(v, v), np.outer(v, v)[0, 2], np.vdot(v, [1, 2, 3])],
        lambda v: [v.sum(), v.mean(), v.prod()],
        lambda v: [np.sum(v), np.mean(v), np.prod(v)],
        lambda v: [np.max(v), v.min(), np.ptp(v)],
        lambda v: np.cumsum(v) + np.diff(np.append(v, 1.0)),
        lambda v: np.stack([v, 2 * v])[1] + np.concatenate([v[:1], [1.0, 2.0]]),
        lambda v: np.stack([v[0], 1.0, v[2]]) + np.hstack([v[0], v[1:]]),
        lambda v: np.array([v[0], 2 * v[1], v[2] + 1]),
        lambda v: np.asarray(v) * np.array([1, 2, 3]),
        lambda v: np.einsum("ij,j->i", MATRIX, v) + np.einsum("i,i", v, v),
        lambda v: np.linalg.solve(MATRIX * v[0] + 9 * np.eye(3), v),
        lambda v: np.linalg.inv(MATRIX * v[0] + 9 * np.eye(3)) @ v + np.linalg.det(MATRIX * v),
        lambda v: np.zeros_like(v) + np.ones_like(v) * v - np.full_like(v, 2.0) + v.copy() + np.copy(v),
        lambda v: np.roll(v, 1) + np.reshape(v, (3, 1))[:, 0] + np.flip(v) + v.T,
        lambda v: np.float64(2) * v + v * np.float64(3) - (1 - v) / 4 + abs(v) ** 1.5,
        lambda v: np.multiply.outer(v, v)[1] + np.add.reduce([v, v]),
        lambda v: np.round(v, 1) + np.floor(v) + np.rint(v * 3),
        lambda v: np.deg2rad(v) + np.remainder(v, 0.7) + v % 2 + v // 0.3 + np.fmod(v, 0.4),
        lambda v: [v.dot(v), np.trace(np.outer(v, v)), np.tensordot(v, v, 1)],
        lambda v: sorted(v),
        lambda v: v[np.argmax(v)] * v,
        lambda v: np.where(np.isclose(v, 1.62, rtol=0.1), v, -v) + np.allclose(v, v[0]) * 1.0,
        lambda v: v.astype(float) + np.polyval([1, 2, 3], v) + np.polynomial.Polynomial([1, 2, 3])(v),
        lambda v: np.vectorize(lambda x: x * abs(x))(v) + np.linspace(v[0], v[1], 3) + np.linspace(0, v, 4)[1],
        lambda v: np.modf(v)[0] + 2 * np.modf(v)[1],
        lambda v: [np.poly1d([1, 2])(v[0]), np.var(v), np.std(v)],
        lambda v: np.max([v[0], 2 * v[1]]) + np.linalg.norm([v[0], v[1]]) + np.sum([v[0], v[2]]) * v,
        lambda v: np.column_stack([v, v])[:, 1] + np.tile(v, 2)[3:] + np.repeat(v, 2)[::2] + np.atleast_1d(v),
        lambda v: np.nan_to_num(v) + np.real(v) + np.zeros_like(v, dtype=float) + np.kron(v, [1.0]),
        lambda v: np.apply_along_axis(lambda u: u * 2, 0, v) if isinstance(v[0], float) else 2 * v,
        lambda v: np.heaviside(v, 0.0) + np.logical_and(v > 0, v < 2) * 3.0,
    ],
)
def test_an_array_function_is_numpys(f):
    recorded = rb.Function(lambda x, y, z: f(np.stack([x, y, z])))
    for v in ([0.31, -0.73, 1.62], [2.13, 0.43, -1.37], [-0.2, 3.7, 0.9]):
        np.testing.assert_allclose(recorded(*v), f(np.array(v)), rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize(
    "f",
    [
        lambda v: np.maximum(v, 0) + np.minimum(v, 1),
        lambda v: np.where(v > 0, v, -2 * v),
        lambda v: np.sign(v),
        lambda v: np.clip(v, -0.5, 1.0),
        lambda v: np.max(v) * np.sqrt(v @ v),
    ],
)
def test_an_array_that_the_function_makes_of_its_numbers_branches(f):
    recorded = rb.Function(lambda x, y: f(np.array([x, y])))
    for v in ([0.3, -0.7], [2.1, 0.45], [-0.2, -3.7], [-1.0, 2.0]):
        np.testing.assert_allclose(recorded(*v), f(np.array(v)), rtol=1e-14)


def test_changing_arrays_in_place_is_recorded():
    def f(x, y):
        a = np.zeros_like(np.stack([x, y]))
        a[0] = 2 * x
        a += [y, y]
        a *= 3
        np.add(a, 1.0, out=a)
        return a

    np.testing.assert_allclose(rb.Function(f)(2.0, 5.0), [28.0, 16.0], rtol=1e-15)


def test_a_length_of_many_components_is_one_norm_after_another():
    f = rb.Function(lambda a, b, c, d, e: np.linalg.norm(np.stack([a, b, c, d, e])))
    assert str(f).count("norm") == 2
    assert f(1.0, 2.0, 3.0, 4.0, 5.0) == pytest.approx(math.sqrt(55), rel=1e-15)
    # a root of a sum of weighted squares is a length too: it has a slope where it is zero
    g = rb.Function(lambda a, b: np.sqrt(a**2 / 4 + 9 * b * b))
    assert "norm" in str(g) and "sqrt" not in str(g)
    assert g(2.0, 1.0) == pytest.approx(math.sqrt(10), rel=1e-15)


def test_a_table_of_many_places_asks_few_of_them():
    places = np.linspace(0.0, 1.0, 65)
    table = rb.Function(lambda x: np.interp(x, places, places**2))
    for x in np.linspace(-0.1, 1.1, 50):
        assert table(x) == pytest.approx(np.interp(x, places, places**2), rel=1e-13, abs=1e-15)
    # one choice for each place, but on the way to any segment no more than the depth of the tree
    assert str(table).count(" where ") == 65


@settings(max_examples=50, deadline=None)
@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0.1, 3))
def test_a_recorded_function_agrees_with_python_everywhere(x, y, z):
    def f(a, b, c):
        r = np.hypot(a, c)
        u = np.exp(-abs(b)) * np.sin(a * b) + np.maximum(a, b) / r
        return u if u > a else np.arctan2(b, c) - r

    assert recorded_everywhere(x, y, z) == pytest.approx(float(f(x, y, z)), rel=1e-12, abs=1e-13)


def _everywhere(a, b, c):
    r = np.hypot(a, c)
    u = np.exp(-abs(b)) * np.sin(a * b) + np.maximum(a, b) / r
    return u if u > a else np.arctan2(b, c) - r


recorded_everywhere = rb.Function(_everywhere)


def test_where_is_numpys_where_outside_of_a_recording():
    assert rb.where(True, 1.0, 2.0) == 1.0
    np.testing.assert_array_equal(rb.where(np.array([1, -1]) > 0, [1, 2], 0), [1, 0])
