"""NumPy on recorded numbers: arrays of expressions, and NumPy's functions of them.

A function that is recorded is called with `ExpressionArray`s, arrays of objects that pass NumPy's functions on to this
file (`__array_ufunc__`, `__array_function__`); so does a single Expression. Ufuncs are applied element by element;
array functions that depend on values (where, clip, interp) are written here, the others are NumPy's own.
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from rbdyn import _core
from rbdyn._core import Condition, Expression, Parameter
from rbdyn.errors import InvalidInput
from rbdyn.reasons import PLAIN_ARRAY

# NumPy's ufuncs of single numbers, by name
_SCALAR: dict[str, Callable[..., Any]] = dict(_core._functions)
_SCALAR["divmod"] = lambda x, y: (_SCALAR["floor_divide"](x, y), _SCALAR["remainder"](x, y))
_SCALAR["clip"] = lambda x, lower, upper: _SCALAR["minimum"](_SCALAR["maximum"](x, lower), upper)
_SCALAR["conj"] = _SCALAR["positive"]
_SCALAR["bitwise_not"] = _SCALAR["invert"]

# those that NumPy's loop over objects does as it should, by Python's operators
_BY_OPERATOR = {"add", "subtract", "multiply", "divide", "negative", "positive", "matmul", "vecdot", "vecmat", "matvec"}

_RECORDED = (Expression, Condition)


class ExpressionArray(np.ndarray):
    """An array of recorded numbers."""

    __array_priority__ = 1000.0

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        return array_ufunc(ufunc, method, *inputs, **options)

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        return array_function(function, types, args, kwargs)

    def astype(self, dtype: Any, *args: Any, **kwargs: Any) -> Any:
        """A copy: recorded numbers stand for floats."""
        return self.copy() if np.dtype(dtype).kind in "fO" else super().astype(dtype, *args, **kwargs)


def array(numbers: Sequence[Any], shape: Sequence[int]) -> ExpressionArray:
    """The array of these numbers, as they are."""
    result = np.empty(len(numbers), dtype=object)
    result[:] = numbers
    return result.view(ExpressionArray).reshape(shape)


def _bare(x: Any) -> Any:
    """An array of objects, or a single one, without this file's hooks on arrays."""
    if isinstance(x, np.ndarray):
        return x.view(np.ndarray) if isinstance(x, ExpressionArray) else x
    return _objects(x) if isinstance(x, list | tuple | Expression | Condition | Parameter) else x


def _objects(x: Any) -> np.ndarray:
    """x as an array of objects."""
    if isinstance(x, ExpressionArray):
        return x.view(np.ndarray)
    if isinstance(x, _RECORDED):
        result = np.empty((), dtype=object)
        result[()] = x
        return result
    return np.asarray(_core._meaning(x) if isinstance(x, Parameter) else x, dtype=object)


def _hooked(x: Any) -> Any:
    """Results of NumPy's own functions: arrays with this file's hooks."""
    if isinstance(x, np.ndarray):
        if x.dtype != object or isinstance(x, ExpressionArray):
            return x
        return x.view(ExpressionArray) if x.ndim else x[()]
    if isinstance(x, tuple | list):
        return type(x)(_hooked(item) for item in x) if type(x) in (tuple, list) else x
    return x


def _meant(x: Any) -> Any:
    """Parameters replaced by what they stand for here: an expression, or their value."""
    if isinstance(x, list | tuple) and type(x) in (list, tuple):
        return type(x)(_meant(item) for item in x)
    return _core._meaning(x) if isinstance(x, Parameter) else x


def _each(f: Callable[..., Any], *inputs: Any) -> Any:
    """f of each element, inputs broadcast against each other."""
    if not any(isinstance(x, np.ndarray | list | tuple) for x in inputs):
        return f(*inputs)
    arrays = [_objects(x) for x in inputs]
    if len(arrays) > 1:
        shape = np.broadcast_shapes(*(a.shape for a in arrays))
        columns = [
            a.ravel().tolist() if a.shape == shape else np.broadcast_to(a, shape).ravel().tolist() for a in arrays
        ]
    else:
        shape = arrays[0].shape
        columns = [arrays[0].ravel().tolist()]
    results = [f(*row) for row in zip(*columns, strict=True)]
    if not shape:
        return results[0]
    if results and isinstance(results[0], tuple):
        return tuple(array(part, shape) for part in zip(*results, strict=True))
    return array(results, shape)


def _into(out: Any, result: Any) -> Any:
    """The result, in the array asked for."""
    if isinstance(out, tuple):
        if len(out) == 1:
            return _into(out[0], result)
        return tuple(_into(o, r) for o, r in zip(out, result, strict=True))
    if out is None:
        return result
    if out.dtype != object:
        raise InvalidInput(PLAIN_ARRAY)
    _bare(out)[...] = _objects(result)
    return out


def array_ufunc(ufunc: np.ufunc, method: str, *inputs: Any, out: Any = None, **options: Any) -> Any:
    """A ufunc, or a reduction by it, of expressions."""
    if any(isinstance(x, Parameter) for x in inputs):
        inputs = tuple(_meant(x) for x in inputs)
        if not any(_is_recorded(x) for x in inputs):
            return getattr(ufunc, method)(*inputs, **options, **({} if out is None else {"out": out}))
    name = ufunc.__name__
    for ignored in ("dtype", "casting", "order", "subok", "signature"):
        options.pop(ignored, None)
    if method == "__call__":
        if options.get("where", True) is True:
            options.pop("where", None)
        if options and name not in _BY_OPERATOR:
            raise TypeError(f"np.{name}: {', '.join(options)} cannot be recorded")
        if name in _BY_OPERATOR:
            result = _hooked(ufunc(*(_bare(x) for x in inputs), **options, dtype=object))
        elif name in _SCALAR:
            result = _each(_SCALAR[name], *inputs)
        else:
            raise TypeError(f"the ufunc {name} cannot be recorded")
        return result if out is None else _into(out, result)
    if method == "reduce" and name in _SCALAR:
        result = _reduced(_SCALAR[name], ufunc.identity, *inputs, **options)
        return result if out is None else _into(out, result)
    if method == "accumulate" and name in _SCALAR:
        x = np.moveaxis(_objects(inputs[0]), options.get("axis", 0), 0)
        rows = [x[0]]
        for row in x[1:]:
            rows.append(_objects(_each(_SCALAR[name], rows[-1], row)))
        result = np.moveaxis(np.stack(rows), 0, options.get("axis", 0)).view(ExpressionArray)
        return result if out is None else _into(out, result)
    if method == "outer" and name in _SCALAR:
        a, b = (_objects(x) for x in inputs)
        return _each(_SCALAR[name], a.reshape(a.shape + (1,) * b.ndim), b)
    raise TypeError(f"np.{name}.{method} cannot be recorded")


_NOTHING = object()


def _reduced(
    f: Callable[..., Any],
    identity: Any,
    x: Any,
    axis: Any = 0,
    keepdims: bool = False,
    initial: Any = _NOTHING,
    where: Any = True,
) -> Any:
    if where is not True:
        raise TypeError("where=: a part of an array that depends on recorded numbers; np.where() can be recorded")
    x = _objects(x)
    axes = tuple(range(x.ndim)) if axis is None else (axis,) if isinstance(axis, int) else tuple(axis)
    axes = tuple(a % x.ndim for a in axes)
    kept = [a for a in range(x.ndim) if a not in axes]
    rows = np.transpose(x, kept + list(axes)).reshape([x.shape[a] for a in kept] + [-1])
    result = np.empty(rows.shape[:-1], dtype=object)
    for index in np.ndindex(*result.shape):
        items = rows[index].tolist()
        if initial is not _NOTHING and initial is not None and initial is not np._NoValue:
            items.insert(0, initial)
        if not items and identity is None:
            raise ValueError("no numbers to choose from: the array is empty")
        result[index] = functools.reduce(f, items) if items else identity
    if keepdims:
        result = result.reshape([1 if a in axes else n for a, n in enumerate(x.shape)])
    return _hooked(result)


# --- array functions that depend on values ---


def _where(condition: Any, a: Any = _NOTHING, b: Any = _NOTHING) -> Any:
    if a is _NOTHING or b is _NOTHING:
        raise TypeError("np.where(condition) asks which elements there are; np.where(condition, a, b) can be recorded")
    return _each(_core._where, condition, a, b)


def where(condition: Any, a: Any, b: Any) -> Any:
    """a where the condition holds, else b; element by element for arrays.

    In a recorded function the condition is a Condition, or an array of them; everywhere else this is np.where.
    """
    if any(_is_recorded(x) for x in (condition, a, b)):
        return _where(condition, a, b)
    return np.where(condition, a, b)[()]


def _is_recorded(x: Any) -> bool:
    if isinstance(x, np.ndarray):
        return x.dtype == object and any(isinstance(item, _RECORDED) for item in x.flat)
    if isinstance(x, list | tuple):
        return any(_is_recorded(item) for item in x)
    return isinstance(x, _RECORDED)


def _clip(x: Any, a_min: Any = None, a_max: Any = None, out: Any = None, *, min: Any = None, max: Any = None) -> Any:
    lower, upper = (min if a_min is None else a_min), (max if a_max is None else a_max)
    result = x
    if lower is not None:
        result = _each(_SCALAR["maximum"], result, lower)
    if upper is not None:
        result = _each(_SCALAR["minimum"], result, upper)
    return _into(out, result)


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
    values = _objects(fp).ravel().tolist()
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

    return _each(one, x)


# --- linear algebra ---


def _cross(a: Any, b: Any, *args: Any, **kwargs: Any) -> Any:
    x, y = _objects(a), _objects(b)
    if args or kwargs or x.shape != (3,) or y.shape != (3,):
        return _hooked(np.cross(x, y, *args, **kwargs))
    x0, x1, x2 = x.tolist()
    y0, y1, y2 = y.tolist()
    return array([x1 * y2 - x2 * y1, x2 * y0 - x0 * y2, x0 * y1 - x1 * y0], (3,))


def _norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Any:
    x = _objects(x)
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
        return functools.reduce(_SCALAR["maximum" if kind > 0 else "minimum"], sizes)
    if isinstance(kind, int | float) and kind > 0:
        return functools.reduce(operator.add, [size**kind for size in sizes]) ** (1.0 / kind)
    raise TypeError(f"np.linalg.norm with ord={kind!r} cannot be recorded")


def _square(a: Any) -> list[list[Any]]:
    a = _objects(a)
    if a.ndim != 2 or a.shape[0] != a.shape[1]:
        raise np.linalg.LinAlgError(f"a matrix of shape {a.shape}; it is square")
    if a.shape[0] > 4:
        raise TypeError(f"np.linalg of a matrix of {a.shape[0]} rows cannot be recorded; up to 4 rows can")
    return a.tolist()


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


def _array_like(value: float) -> Callable[..., Any]:
    def filled(x: Any, *args: Any, shape: Any = None, **kwargs: Any) -> Any:
        shape = np.shape(x) if shape is None else shape
        size = int(np.prod(shape))
        return array([value] * size, (shape,) if isinstance(shape, int) else tuple(shape))

    return filled


def _full_like(x: Any, value: Any, *args: Any, **kwargs: Any) -> Any:
    shape = np.shape(x)
    return array([value] * int(np.prod(shape)), shape)


_FUNCTIONS: dict[Any, Callable[..., Any]] = {
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
    np.isclose: _is_close,
    np.allclose: lambda a, b, *args, **kwargs: np.all(_is_close(a, b, *args, **kwargs)),
    np.zeros_like: _array_like(0.0),
    np.ones_like: _array_like(1.0),
    np.empty_like: _array_like(0.0),
    np.full_like: _full_like,
    np.real: lambda x: x,
    np.nan_to_num: lambda x, *args, **kwargs: x,
    np.copy: lambda x, *args, **kwargs: x.copy() if isinstance(x, np.ndarray) else x,
    np.round: lambda x, decimals=0, out=None: _into(out, _each(lambda u: round(u, decimals), x)),
    np.any: lambda x, axis=None, *args, **kwargs: _reduced(_SCALAR["logical_or"], False, x, axis, **kwargs),
    np.all: lambda x, axis=None, *args, **kwargs: _reduced(_SCALAR["logical_and"], True, x, axis, **kwargs),
}


def array_function(function: Any, types: Any, args: Any, kwargs: Any) -> Any:
    """A function of NumPy of arrays with expressions in them."""
    if Parameter in types:
        args = tuple(_meant(x) for x in args)
        kwargs = {key: _meant(x) for key, x in kwargs.items()}
        if not any(_is_recorded(x) for x in (*args, *kwargs.values())):
            return function(*args, **kwargs)
    own = _FUNCTIONS.get(function)
    if own is not None:
        return own(*args, **kwargs)
    # NumPy's own, for arrays of objects
    hooks = np.ndarray.__array_function__
    template = array([], (0,))
    return _hooked(hooks(template, function, (ExpressionArray,), args, kwargs))


def rigid_motion(returned: Any, user: str, name: str) -> list[Any]:
    """A rotation matrix row by row, then a displacement, from any of the ways to write a rigid motion."""
    rule = (
        "a motion is a displacement (3,), a rotation matrix (3, 3), a pair of both, or a homogeneous matrix (4, 4), "
        "displacements in m"
    )
    rotation: Any = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    displacement: Any = [0.0, 0.0, 0.0]
    parts = [np.asarray(part, dtype=object) for part in returned] if _is_pair(returned) else [_objects(returned)]
    shapes = sorted(part.shape for part in parts)
    if shapes not in ([(3,)], [(3, 3)], [(4, 4)], [(3,), (3, 3)]):
        shown = " and ".join(str(part.shape) for part in parts)
        raise InvalidInput(f"{user}: function {name} returns shape {shown}; {rule}")
    for part in parts:
        items = np.asarray(part).tolist()
        if part.shape == (3,):
            displacement = items
        elif part.shape == (3, 3):
            rotation = items
        else:
            rotation = [row[:3] for row in items[:3]]
            displacement = [row[3] for row in items[:3]]
            last = [float(x) if not isinstance(x, Expression) or "(" in repr(x) else None for x in items[3]]
            if last != [0.0, 0.0, 0.0, 1.0]:
                raise InvalidInput(f"{user}: function {name} returns a matrix whose last row is not 0 0 0 1; {rule}")
    return [x for row in rotation for x in row] + displacement


def _is_pair(returned: Any) -> bool:
    return isinstance(returned, tuple | list) and len(returned) == 2
