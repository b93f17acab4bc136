"""NumPy's functions of arrays with recorded numbers in them, where these depend on values or divide small matrices."""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from rbdyn import _core
from rbdyn.errors import InvalidInput
from rbdyn.shown import shown
from rbdyn.tracing import FUNCTIONS, NOTHING, SCALAR, array, each, hooked, into, is_recorded, objects, reduced

# --- array functions that depend on values ---


def _where(condition: Any, a: Any = NOTHING, b: Any = NOTHING) -> Any:
    if a is NOTHING or b is NOTHING:
        raise TypeError("np.where(condition) asks which elements there are; np.where(condition, a, b) can be recorded")
    return each(_core._where, condition, a, b)


def where(condition: Any, a: Any, b: Any) -> Any:
    """a where the condition holds, else b; element by element for arrays.

    In a recorded function the condition is a Condition, or an array of them; everywhere else this is np.where.
    """
    if any(is_recorded(x) for x in (condition, a, b)):
        return _where(condition, a, b)
    try:
        return np.where(condition, a, b)[()]
    except OverflowError:
        raise InvalidInput(
            f"where: {shown(a)} or {shown(b)} is a whole number that NumPy has no type for; give it as a float"
        ) from None
    except (TypeError, ValueError) as problem:
        raise InvalidInput(f"where: {_misfit(condition, a, b)}") from problem


def _misfit(condition: Any, a: Any, b: Any) -> str:
    """Why np.where() does not take them."""
    arrays = {}
    for name, value in (("condition", condition), ("a", a), ("b", b)):
        try:
            arrays[name] = np.asarray(value)
        except Exception:
            return f"{name} is {shown(value)}; give numbers, or an array of numbers"
    shapes = [array.shape for array in arrays.values()]
    try:
        np.broadcast_shapes(*shapes)
    except ValueError:
        return f"condition has shape {shapes[0]}, a {shapes[1]} and b {shapes[2]}; give arrays of one shape, or numbers"
    return f"a is of type {arrays['a'].dtype} and b of {arrays['b'].dtype}; give numbers, or arrays of them"


def _clip(x: Any, a_min: Any = None, a_max: Any = None, out: Any = None, *, min: Any = None, max: Any = None) -> Any:
    lower, upper = (min if a_min is None else a_min), (max if a_max is None else a_max)
    result = x
    if lower is not None:
        result = each(SCALAR["maximum"], result, lower)
    if upper is not None:
        result = each(SCALAR["minimum"], result, upper)
    return into(out, result)


def _select(conditions: Sequence[Any], choices: Sequence[Any], default: Any = 0.0) -> Any:
    if len(conditions) != len(choices):
        raise ValueError(f"np.select: {len(conditions)} conditions and {len(choices)} choices; one for each")
    result = default
    for condition, choice in zip(reversed(conditions), reversed(choices), strict=True):
        result = _where(condition, choice, result)
    return result


def _piecewise(x: Any, conditions: Any, functions: Sequence[Any], *args: Any, **kwargs: Any) -> Any:
    if not isinstance(conditions, list | tuple) and np.ndim(conditions) <= np.ndim(x):
        conditions = [conditions]
    if len(functions) not in (len(conditions), len(conditions) + 1):
        raise ValueError(f"np.piecewise: {len(conditions)} conditions and {len(functions)} functions")
    values = [f(x, *args, **kwargs) if callable(f) else f for f in functions]
    result = values.pop() if len(values) > len(conditions) else 0.0
    # where several hold, the last one counts
    for condition, value in zip(conditions, values, strict=True):
        result = _where(condition, value, result)
    return result


def _interp(x: Any, xp: Any, fp: Any, left: Any = None, right: Any = None, period: Any = None) -> Any:
    knots = np.asarray(xp, dtype=float).ravel()
    values = objects(fp).ravel().tolist()
    if len(knots) != len(values) or not len(knots):
        raise ValueError(f"np.interp: {len(knots)} places and {len(values)} values; one for each")
    if period is not None:
        left = right = None
        period = abs(float(period))
        order = np.argsort(knots % period, kind="stable")
        knots = (knots % period)[order]
        values = [values[i] for i in order]
        knots = np.concatenate((knots[-1:] - period, knots, knots[:1] + period))
        values = [values[-1], *values, values[0]]
    left = values[0] if left is None else left
    right = values[-1] if right is None else right

    def between(u: Any, first: int, last: int) -> Any:
        """The value between knots `first` and `last`, by halves: few of the choices are live at a time."""
        if last - first == 1:
            slope = (values[last] - values[first]) / (knots[last] - knots[first])
            return values[first] + slope * (u - knots[first])
        middle = (first + last) // 2
        return _core._where(u > knots[middle], between(u, middle, last), between(u, first, middle), "interp")

    def one(u: Any) -> Any:
        if period is not None:
            u = u % period
        inside = between(u, 0, len(knots) - 1) if len(knots) > 1 else values[0]
        above = _core._where(u > knots[-1], right, inside, "interp")
        return _core._where(u < knots[0], left, above, "interp")

    return each(one, x)


# --- linear algebra ---


def _cross(a: Any, b: Any, *args: Any, **kwargs: Any) -> Any:
    x, y = objects(a), objects(b)
    if args or kwargs or x.shape != (3,) or y.shape != (3,):
        return hooked(np.cross(x, y, *args, **kwargs))
    x0, x1, x2 = x.tolist()
    y0, y1, y2 = y.tolist()
    return array([x1 * y2 - x2 * y1, x2 * y0 - x0 * y2, x0 * y1 - x1 * y0], (3,))


def _norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Any:
    x = objects(x)
    if axis is None and (ord is None or x.ndim == 1):
        rows, shape = x.reshape(1, -1), (1,) * x.ndim if keepdims else ()
    elif isinstance(axis, int):
        rest = np.moveaxis(x, axis, -1)
        rows = rest.reshape(-1, rest.shape[-1])
        shape = tuple(1 if a == axis % x.ndim else n for a, n in enumerate(x.shape)) if keepdims else rest.shape[:-1]
    else:
        raise TypeError("np.linalg.norm of a matrix can be recorded without ord only")
    results = [_length(row.tolist(), ord) for row in rows]
    return array(results, shape) if shape else results[0]


def _length(items: list[Any], kind: Any) -> Any:
    if kind is None or kind == 2:
        return _core._length(items)
    sizes = [abs(item) for item in items]
    if kind == 1:
        return functools.reduce(operator.add, sizes)
    if kind in (np.inf, -np.inf):
        return functools.reduce(SCALAR["maximum" if kind > 0 else "minimum"], sizes)
    if isinstance(kind, int | float) and kind > 0:
        return functools.reduce(operator.add, [size**kind for size in sizes]) ** (1.0 / kind)
    raise TypeError(f"np.linalg.norm with ord={kind!r} cannot be recorded")


def _square(a: Any) -> list[list[Any]]:
    a = objects(a)
    if a.ndim != 2 or a.shape[0] != a.shape[1]:
        raise np.linalg.LinAlgError(f"a matrix of shape {a.shape}; it is square")
    if a.shape[0] > 4:
        raise TypeError(f"np.linalg of a matrix of {a.shape[0]} rows cannot be recorded; up to 4 rows can")
    rows: list[list[Any]] = a.tolist()
    return rows


def _minor(a: list[list[Any]], row: int, column: int) -> list[list[Any]]:
    return [r[:column] + r[column + 1 :] for i, r in enumerate(a) if i != row]


def _determinant(a: list[list[Any]]) -> Any:
    """By the first row (Laplace)."""
    if not a:
        return 1.0
    result: Any = 0.0
    for k, x in enumerate(a[0]):
        result = result + (x if k % 2 == 0 else -x) * _determinant(_minor(a, 0, k))
    return result


def _inverse(a: Any) -> Any:
    """The transposed matrix of cofactors over the determinant (Cramer)."""
    a = _square(a)
    n = len(a)
    determinant = _determinant(a)
    items = [(-1) ** (i + j) * _determinant(_minor(a, j, i)) / determinant for i in range(n) for j in range(n)]
    return array(items, (n, n))


def _is_close(a: Any, b: Any, rtol: float = 1e-05, atol: float = 1e-08, equal_nan: bool = False) -> Any:
    return abs(np.subtract(a, b)) <= atol + rtol * abs(np.positive(b))


def _linspace(start: Any, stop: Any, num: int = 50, endpoint: bool = True, *args: Any, **kwargs: Any) -> Any:
    steps = num - 1 if endpoint else num
    return hooked(np.stack([np.add(start, np.subtract(stop, start) * (k / max(steps, 1))) for k in range(num)]))


def _array_like(value: float) -> Callable[..., Any]:
    def filled(x: Any, *args: Any, shape: Any = None, **kwargs: Any) -> Any:
        shape = np.shape(x) if shape is None else shape
        size = int(np.prod(shape))
        return array([value] * size, (shape,) if isinstance(shape, int) else tuple(shape))

    return filled


def _full_like(x: Any, value: Any, *args: Any, **kwargs: Any) -> Any:
    shape = np.shape(x)
    return array([value] * int(np.prod(shape)), shape)


FUNCTIONS.update(
    {
        np.where: _where,
        np.clip: _clip,
        np.select: _select,
        np.piecewise: _piecewise,
        np.interp: _interp,
        np.cross: _cross,
        np.linalg.norm: _norm,
        np.linalg.det: lambda a: _determinant(_square(a)),
        np.linalg.inv: _inverse,
        np.linalg.solve: lambda a, b: np.dot(_inverse(a), b),
        np.linspace: _linspace,
        np.isclose: _is_close,
        np.allclose: lambda a, b, *args, **kwargs: np.all(_is_close(a, b, *args, **kwargs)),
        np.zeros_like: _array_like(0.0),
        np.ones_like: _array_like(1.0),
        np.empty_like: _array_like(0.0),
        np.full_like: _full_like,
        np.real: lambda x: x,
        np.nan_to_num: lambda x, *args, **kwargs: x,
        np.copy: lambda x, *args, **kwargs: x.copy() if isinstance(x, np.ndarray) else x,
        np.round: lambda x, decimals=0, out=None: into(out, each(lambda u: round(u, decimals), x)),
        np.any: lambda x, axis=None, *args, **kwargs: reduced(SCALAR["logical_or"], False, x, axis, **kwargs),
        np.all: lambda x, axis=None, *args, **kwargs: reduced(SCALAR["logical_and"], True, x, axis, **kwargs),
    }
)
