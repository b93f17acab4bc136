"""Why a function of the user's could not be recorded: the line, its text, what it asks for, and what helps."""

from __future__ import annotations

import inspect
import itertools
import linecache
import os
import re
import sys
from types import CodeType, FrameType, TracebackType
from typing import Any

import numpy as np

from rbdyn.errors import Error

PLAIN_ARRAY = (
    "puts a recorded number into an array of plain numbers; make the array of its components, np.array([x, y, z]), "
    "or np.zeros_like(position)"
)

# math's names of what NumPy names otherwise
_NUMPY = {
    "acos": "arccos",
    "acosh": "arccosh",
    "asin": "arcsin",
    "asinh": "arcsinh",
    "atan": "arctan",
    "atan2": "arctan2",
    "atanh": "arctanh",
    "dist": "linalg.norm",
    "pow": "power",
}


def _is_users(frame: FrameType) -> bool:
    root = str(frame.f_globals.get("__name__", "")).partition(".")[0]
    return root not in ("numpy", "scipy", "rbdyn", "numba") and root not in sys.stdlib_module_names


def _frame(caller: FrameType | None) -> FrameType | None:
    """The innermost frame of the user's code, within that of the caller of what is recorded."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and frame is not caller and not _is_users(frame):
        frame = frame.f_back
    return None if frame is caller else frame


def _at(code: CodeType, line: int) -> str:
    return f"line {line} of {os.path.basename(code.co_filename)}"


def place(caller: FrameType | None) -> str:
    """Where the user's code is now: line 12 of scene.py."""
    frame = _frame(caller)
    return "an unknown line" if frame is None else _at(frame.f_code, frame.f_lineno)


def _source(code: CodeType, line: int, instruction: int) -> str:
    """The text of an instruction, or of its line."""
    whole = linecache.getline(code.co_filename, line)
    if hasattr(code, "co_positions") and instruction >= 0:
        position = next(itertools.islice(code.co_positions(), instruction // 2, None), None)
        if position is not None and None not in position:
            first, last, start, end = position
            if first == last == line:
                part = whole.encode()[start:end].decode(errors="replace")
                if part:
                    return part
    return whole.strip()


def _stores_an_item(code: CodeType, instruction: int, text: str) -> bool:
    import dis

    if instruction >= 0 and instruction < len(code.co_code):
        return dis.opname[code.co_code[instruction]] == "STORE_SUBSCR"
    return re.match(r"\w+\[.*\]\s*=[^=]", text) is not None


def _value_of(text: str) -> str:
    asks = "asks for the value of a number that is being recorded"
    used = re.search(r"\bmath\.(\w+)", text) or re.match(r"(\w+)\(", text)
    if used:
        name = _NUMPY.get(used[1], used[1])
        root = getattr(np, name.partition(".")[0], None)
        if root is not None and name not in ("array", "asarray", "float64", "zeros", "full"):
            return f"{asks}; np.{name} can be recorded"
    if re.match(r"(np\.)?float(64)?\(", text):
        return f"{asks}; leave the conversion out"
    if re.search(r"\b(array|asarray|full|astype)\(", text):
        return f"{asks}; leave out the type, so that the array holds what is recorded"
    return f"{asks}; NumPy's functions can be recorded, float() and those of math cannot"


def refusal(kind: str, place: str, caller: FrameType | None) -> str:
    """What the user's code asks for that a recorded number does not know."""
    simple = {
        "equality": "asks whether a recorded number equals another; compare by < or >, or abs(a - b) with a tolerance",
        "truth": "asks whether a recorded number is zero; compare it with < or >",
        "whole": "asks for a whole number; np.floor and np.trunc can be recorded",
        "endless": "asks about recorded numbers without end",
        "decisions": "distinguishes cases more than 1000 times",
        "paths": "is one of several distinctions that make more than 64 cases together; "
        "np.where and np.maximum choose without multiplying cases",
        "inconsistent": "does something else each time the function is called; it depends on nothing but its arguments",
        "sizes": "leads to more numbers that are returned on one side than on the other",
    }
    frame = _frame(caller)
    if place:
        return f"{place}: an if {simple[kind]}"
    if frame is None:
        return f"it {simple.get(kind, 'asks for the value of a number that is being recorded')}"
    code, line, instruction = frame.f_code, frame.f_lineno, frame.f_lasti
    text = _source(code, line, instruction)
    if kind == "value" and _stores_an_item(code, instruction, text):
        text, what = linecache.getline(code.co_filename, line).strip(), PLAIN_ARRAY
    else:
        what = _value_of(text) if kind == "value" else simple[kind]
    return f"{_at(code, line)}: {text + ' ' if text else 'it '}{what}"


def raised(error: BaseException) -> str:
    """What an exception says, and the line of the user's code it comes from."""
    where: tuple[CodeType, int, int] | None = None
    traceback: TracebackType | None = error.__traceback__
    while traceback is not None:
        if _is_users(traceback.tb_frame):
            where = traceback.tb_frame.f_code, traceback.tb_lineno, traceback.tb_lasti
        traceback = traceback.tb_next
    message = str(error) or type(error).__name__
    is_ours = isinstance(error, Error)
    if not is_ours:
        message = f"raises {type(error).__name__}: {error}" if str(error) else f"raises {message}"
    if "has no callable" in message and "type float" in message:
        message += "; an array of recorded and plain numbers: np.stack([x, 1.0]) makes one that NumPy's functions take"
    if where is None:
        return message
    text = _source(*where)
    colon = ":" if is_ours and message != PLAIN_ARRAY else ""
    return f"{_at(where[0], where[1])}: {f'{text}{colon} ' if text else ''}{message}"


def positional(f: Any) -> tuple[int, int] | tuple[()]:
    """How many arguments f takes by position, at least and at most; () if that is not known."""
    code = getattr(f, "__code__", None)
    if code is not None and not hasattr(f, "__wrapped__") and not hasattr(f, "__self__"):
        most = sys.maxsize if code.co_flags & inspect.CO_VARARGS else code.co_argcount
        return code.co_argcount - len(f.__defaults__ or ()), min(most, 2**31 - 1)
    try:
        parameters = inspect.signature(f).parameters.values()
    except (TypeError, ValueError):
        return ()
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    named = [p for p in parameters if p.kind in kinds]
    least = sum(p.default is inspect.Parameter.empty for p in named)
    takes_more = any(p.kind is inspect.Parameter.VAR_POSITIONAL for p in parameters)
    return least, 2**31 - 1 if takes_more else len(named)


def plain(parameter: str) -> str:
    """Why a parameter is refused where a plain number is taken, and in which line of the user's code."""
    why = f"{parameter} is given where a plain number is taken, and would stay at what it is now"
    fix = "give its .value, and make anew what it is in for each value"
    frame = _frame(None)
    if frame is None:
        return f"{why}; {fix}"
    text = _source(frame.f_code, frame.f_lineno, frame.f_lasti)
    return f"{_at(frame.f_code, frame.f_lineno)}: {f'{text}: ' if text else ''}{why}; {fix}"


def why_not_called_with(f: Any, count: int) -> str:
    """Why f cannot be called with so many arguments, in words after its name; empty if it can, or nobody knows."""
    try:
        signature = inspect.signature(f)
    except (TypeError, ValueError):
        return ""
    try:
        signature.bind(*range(count))
    except TypeError:
        needed = [name for name, p in signature.parameters.items() if p.default is inspect.Parameter.empty]
        return f"takes {len(needed)} arguments ({', '.join(needed)})" if needed else "takes no argument"
    return ""


def parameters(f: Any) -> int:
    """How many arguments f needs; one if that is not known."""
    known = positional(f)
    return known[0] if known else 1
