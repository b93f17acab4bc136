"""NumPy on recorded numbers: arrays of expressions, and NumPy's functions of them.

A function that is recorded is called with `ExpressionArray`s, arrays of objects that pass NumPy's functions on to this
file (`__array_ufunc__`, `__array_function__`); so does a single Expression. Ufuncs are applied element by element;
array functions that depend on values (where, clip, interp) are in array_functions.py, the others are NumPy's own.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from rbdyn import _core
from rbdyn._core import Condition, Expression, Parameter
from rbdyn.errors import InvalidInput
from rbdyn.reasons import PLAIN_ARRAY

# NumPy's ufuncs of single numbers, by name
SCALAR: dict[str, Callable[..., Any]] = dict(_core._functions)
SCALAR["divmod"] = lambda x, y: (SCALAR["floor_divide"](x, y), SCALAR["remainder"](x, y))
SCALAR["clip"] = lambda x, lower, upper: SCALAR["minimum"](SCALAR["maximum"](x, lower), upper)
SCALAR["modf"] = lambda x: (x - SCALAR["trunc"](x), SCALAR["trunc"](x))
SCALAR["logaddexp"] = lambda x, y: SCALAR["maximum"](x, y) + SCALAR["log1p"](SCALAR["exp"](-abs(x - y)))
SCALAR["conj"] = SCALAR["positive"]
SCALAR["bitwise_not"] = SCALAR["invert"]

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
    arranged: Any = result.view(ExpressionArray).reshape(shape)
    return arranged  # type: ignore[no-any-return]


def _bare(x: Any) -> Any:
    """An array of objects, or a single one, without this file's hooks on arrays."""
    if isinstance(x, np.ndarray):
        return x.view(np.ndarray) if isinstance(x, ExpressionArray) else x
    return objects(x) if isinstance(x, list | tuple | Expression | Condition | Parameter) else x


def objects(x: Any) -> np.ndarray:
    """x as an array of objects."""
    if isinstance(x, ExpressionArray):
        return x.view(np.ndarray)
    if isinstance(x, _RECORDED):
        result = np.empty((), dtype=object)
        result[()] = x
        return result
    return np.asarray(_core._meaning(x) if isinstance(x, Parameter) else x, dtype=object)


def hooked(x: Any) -> Any:
    """Results of NumPy's own functions: arrays with this file's hooks."""
    if isinstance(x, np.ndarray):
        if x.dtype != object or isinstance(x, ExpressionArray):
            return x
        return x.view(ExpressionArray) if x.ndim else x[()]
    if isinstance(x, tuple | list):
        return type(x)(hooked(item) for item in x) if type(x) in (tuple, list) else x
    return x


def is_recorded(x: Any) -> bool:
    if isinstance(x, np.ndarray):
        return x.dtype == object and any(isinstance(item, _RECORDED) for item in x.flat)
    if isinstance(x, list | tuple):
        return any(is_recorded(item) for item in x)
    return isinstance(x, _RECORDED)


def _meant(x: Any) -> Any:
    """Parameters replaced by what they stand for here: an expression, or their value."""
    if isinstance(x, list | tuple) and type(x) in (list, tuple):
        return type(x)(_meant(item) for item in x)
    return _core._meaning(x) if isinstance(x, Parameter) else x


def each(f: Callable[..., Any], *inputs: Any) -> Any:
    """f of each element, inputs broadcast against each other."""
    if not any(isinstance(x, np.ndarray | list | tuple) for x in inputs):
        return f(*inputs)
    arrays = [objects(x) for x in inputs]
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


def into(out: Any, result: Any) -> Any:
    """The result, in the array asked for."""
    if isinstance(out, tuple):
        if len(out) == 1:
            return into(out[0], result)
        return tuple(into(o, r) for o, r in zip(out, result, strict=True))
    if out is None:
        return result
    if out.dtype != object:
        raise InvalidInput(PLAIN_ARRAY)
    _bare(out)[...] = objects(result)
    return out


def array_ufunc(ufunc: np.ufunc, method: str, *inputs: Any, out: Any = None, **options: Any) -> Any:
    """A ufunc, or a reduction by it, of expressions."""
    if any(isinstance(x, Parameter) for x in inputs):
        inputs = tuple(_meant(x) for x in inputs)
        if not any(is_recorded(x) for x in inputs):
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
            result = hooked(ufunc(*(_bare(x) for x in inputs), **options, dtype=object))
        elif name in SCALAR:
            result = each(SCALAR[name], *inputs)
        elif all(set(signature) <= {"O", "-", ">"} for signature in ufunc.types):
            # a function in Python, by np.vectorize or np.frompyfunc
            result = hooked(ufunc(*(_bare(x) for x in inputs)))
        else:
            raise TypeError(f"the ufunc {name} cannot be recorded")
        return result if out is None else into(out, result)
    if method == "reduce" and name in SCALAR:
        result = reduced(SCALAR[name], ufunc.identity, *inputs, **options)
        return result if out is None else into(out, result)
    if method == "accumulate" and name in SCALAR:
        x = np.moveaxis(objects(inputs[0]), options.get("axis", 0), 0)
        rows = [x[0]]
        for row in x[1:]:
            rows.append(objects(each(SCALAR[name], rows[-1], row)))
        result = np.moveaxis(np.stack(rows), 0, options.get("axis", 0)).view(ExpressionArray)
        return result if out is None else into(out, result)
    if method == "outer" and name in SCALAR:
        a, b = (objects(x) for x in inputs)
        return each(SCALAR[name], a.reshape(a.shape + (1,) * b.ndim), b)
    raise TypeError(f"np.{name}.{method} cannot be recorded")


NOTHING = object()


def reduced(
    f: Callable[..., Any],
    identity: Any,
    x: Any,
    axis: Any = 0,
    keepdims: bool = False,
    initial: Any = NOTHING,
    where: Any = True,
) -> Any:
    if where is not True:
        raise TypeError("where=: a part of an array that depends on recorded numbers; np.where() can be recorded")
    x = objects(x)
    axes = tuple(range(x.ndim)) if axis is None else (axis,) if isinstance(axis, int) else tuple(axis)
    axes = tuple(a % x.ndim for a in axes)
    kept = [a for a in range(x.ndim) if a not in axes]
    rows = np.transpose(x, kept + list(axes)).reshape([x.shape[a] for a in kept] + [-1])
    result = np.empty(rows.shape[:-1], dtype=object)
    for index in np.ndindex(*result.shape):
        items = rows[index].tolist()
        if initial is not NOTHING and initial is not None and initial is not np._NoValue:
            items.insert(0, initial)
        if not items and identity is None:
            raise ValueError("no numbers to choose from: the array is empty")
        result[index] = functools.reduce(f, items) if items else identity
    if keepdims:
        result = result.reshape([1 if a in axes else n for a, n in enumerate(x.shape)])
    return hooked(result)


# NumPy's functions of arrays that are not NumPy's own here (array_functions.py)
FUNCTIONS: dict[Any, Callable[..., Any]] = {}


def array_function(function: Any, types: Any, args: Any, kwargs: Any) -> Any:
    """A function of NumPy of arrays with expressions in them."""
    if Parameter in types:
        args = tuple(_meant(x) for x in args)
        kwargs = {key: _meant(x) for key, x in kwargs.items()}
        if not any(is_recorded(x) for x in (*args, *kwargs.values())):
            return function(*args, **kwargs)
    own = FUNCTIONS.get(function)
    if own is not None:
        return own(*args, **kwargs)
    # NumPy's own, for arrays of objects
    hooks = np.ndarray.__array_function__
    template = array([], (0,))
    return hooked(hooks(template, function, (ExpressionArray,), args, kwargs))


def rigid_motion(returned: Any, user: str, name: str) -> list[Any]:
    """A rotation matrix row by row, then a displacement, from any of the ways to write a rigid motion."""
    rule = (
        "a motion is a displacement (3,), a rotation matrix (3, 3), a pair of both, or a homogeneous matrix (4, 4), "
        "displacements in m"
    )
    rotation: Any = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    displacement: Any = [0.0, 0.0, 0.0]
    parts = [np.asarray(part, dtype=object) for part in returned] if _is_pair(returned) else [objects(returned)]
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
    return [*(x for row in rotation for x in row), *displacement]


def _is_pair(returned: Any) -> bool:
    return isinstance(returned, tuple | list) and len(returned) == 2
