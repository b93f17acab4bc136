"""Functions of _core as help() shows them: signatures that inspect.signature() reads, types as a reader names them."""

from __future__ import annotations

import ast
import functools
import inspect
import os
import re
from collections.abc import Callable
from typing import Any, TypeVar, cast

from rbdyn import _core

# what matters in a list of arguments: brackets, quoted words, and what stands between arguments and their parts
_TOKEN = re.compile(r"'[^']*'|\"[^\"]*\"|->|[\[({<]|[\])}>]|, |: | = ")


# types as a reader would name them
_SHORT: list[tuple[str, str | Callable[[re.Match[str]], str]]] = [
    (r"\brbdyn\._core\.", ""),
    (r"\btyping\.Supports(Float|Int) \| typing\.SupportsIndex", lambda found: found[1].lower()),
    (r"\bnumpy\.typing\.ArrayLike", "array_like"),
    (r"\bnumpy\.typing\.NDArray\[[\w.]+\]", "array"),
    (r"\b(?:typing|collections\.abc|os)\.", ""),
    (r"\bself(?:: [\w.]+)?(?:, )?", ""),
]

Verb = TypeVar("Verb", bound=Callable[..., Any])


def shortened(signature: str) -> str:
    """A signature with such types, without self."""
    for pattern, short in _SHORT:
        signature = re.sub(pattern, short, signature)
    return signature


def readable(name: str, doc: str) -> str:
    """A docstring of pybind11's with its signatures shortened, without its words on overloads."""
    doc = doc.removeprefix(f"{name}(*args, **kwargs)\nOverloaded function.\n\n")
    return re.sub(rf"^(\d+\. )?{re.escape(name)}\(.*$", lambda line: shortened(line[0]), doc, flags=re.MULTILINE)


def verb(function: Verb) -> Verb:
    """A function of _core as one of Python's own, which help() names by its module."""

    @functools.wraps(function)
    def call(*arguments: Any, **options: Any) -> Any:
        return function(*arguments, **options)

    # by which pickle finds it, too: a pool of processes is given it as it is
    call.__module__, call.__qualname__ = "rbdyn", function.__name__
    return cast(Verb, call)


def _default(text: str) -> str:
    """A default as it is written; one that is no literal as `...`."""
    try:
        ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return "..."
    return text


def text_of(name: str, doc: str) -> str | None:
    """name(self, a, b=1) from the first signature of a docstring; None if there is none."""
    first = f"{name}("
    start = doc.find(f"\n1. {first}") + 4 if doc.startswith(f"{name}(*args, **kwargs)\nOverloaded") else 0
    if not doc.startswith(first, start):
        return None
    arguments: list[list[str]] = []
    depth, begin, word, typed = 0, start + len(first), "", False
    for token in _TOKEN.finditer(doc, start + len(name)):
        mark = token[0]
        if mark in "([{<":
            depth += 1
        elif mark in ")]}>":
            depth -= 1
        if depth > 1 or (mark in ")]}>" and depth == 1):
            continue
        part = doc[begin : token.start()]
        if mark == ": " and not typed:
            word, typed, begin = part, True, token.end()
        elif mark == " = ":
            word, begin = f"{word if typed else part}\0", token.end()
        elif mark == ", " or depth == 0:
            called, has_default, _ = (word if word else part).partition("\0")
            arguments.append([called.strip(), _default(part) if has_default else ""])
            begin, word, typed = token.end(), "", False
            if depth == 0:
                break
    words = [f"{called}={default}" if default else called for called, default in arguments if called]
    return f"{name}({', '.join(words)})"


def _not_called(self: Any, *_: Any, **__: Any) -> None:
    """What is made by functions alone, and says so."""
    name = type(self).__name__
    maker = "rbdyn.parameter(value) makes one" if name == "Parameter" else "functions of rbdyn return them"
    raise TypeError(f"{name}: it is not made by a call of its class; {maker}")


def give() -> None:
    """Gives each function and method of _core its signature, but for whoever reads the types in docstrings."""
    if "RBDYN_TYPES_IN_DOCSTRINGS" in os.environ:
        return
    for thing in list(vars(_core).values()):
        is_class = inspect.isclass(thing) and thing.__module__ == _core.__name__
        # a class without a constructor has the one of all, which says that there is none
        if is_class and type(vars(thing).get("__init__")) is type(object.__init__):
            thing.__init__ = _not_called
        functions: dict[str, Any] = vars(thing) if is_class else {getattr(thing, "__name__", ""): thing}
        for name, function in functions.items():
            if type(function).__name__ == "staticmethod":
                function = function.__func__
            if type(function).__name__ not in ("instancemethod", "builtin_function_or_method", "pybind11_static"):
                continue
            text = text_of(name, function.__doc__ or "")
            if text is not None:
                _core._describe(function, text, readable(name, function.__doc__ or ""))
