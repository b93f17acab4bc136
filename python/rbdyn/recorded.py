"""Recorded functions as scene files have them (docs/files.md), for arrays of inputs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_OF_ONE: dict[str, Callable[[Any], Any]] = {
    "sqrt": np.sqrt,
    "sin": np.sin,
    "cos": np.cos,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "exp": np.exp,
    "log": np.log,
    "expm1": np.expm1,
    "log1p": np.log1p,
    "arcsinh": np.arcsinh,
    "arctanh": np.arctanh,
    "sign": np.sign,
    "floor": np.floor,
}
_BETWEEN: dict[str, Callable[[Any, Any], Any]] = {"+": np.add, "*": np.multiply, "/": np.divide}


def evaluated(function: dict[str, Any], parameters: list[float], *inputs: Array) -> Array:
    """The results (n, m) of a function of a file for inputs (n,) each."""
    lines: list[Any] = []

    def line(word: str) -> Any:
        return lines[int(word[1:])]

    with np.errstate(all="ignore"):
        for operation in function["operations"]:
            words = operation.partition(" = ")[2].partition("  (")[0].split()
            first = words[0]
            value: Any
            if first == "input":
                value = inputs[int(words[1])]
            elif first == "parameter":
                value = parameters[int(words[1])]
            elif first == "arctan2":
                value = np.arctan2(line(words[1]), line(words[2]))
            elif first == "norm":
                x, y, z = (line(word) for word in words[1:])
                value = np.hypot(np.hypot(x, y), z)
            elif first in _OF_ONE:
                value = _OF_ONE[first](line(words[1]))
            elif len(words) > 1 and words[1] in _BETWEEN:
                value = _BETWEEN[words[1]](line(first), line(words[2]))
            elif len(words) > 1 and words[1] == "^":
                # of a number, or of another line
                exponent = words[2]
                is_line = exponent[0] == "n" and exponent != "nan"
                value = np.power(line(first), line(exponent) if is_line else float(exponent))
            elif len(words) > 1 and words[1] == "where":
                # n1 where n2 > 0, else n3
                value = np.where(line(words[2]) > 0, line(first), line(words[6]))
            else:
                value = float(first)
            lines.append(value)
    shape = np.shape(inputs[0])
    return np.stack([np.broadcast_to(line(word), shape) for word in function["results"]], axis=-1).astype(float)
