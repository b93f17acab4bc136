"""What is wrong with a call that no signature of a function takes, in one sentence: argument, rule and fix."""

from __future__ import annotations

import re
from typing import Any

from rbdyn import _core
from rbdyn.quantities import RULE, has_unit
from rbdyn.shown import shown

_HEAD = re.compile(r"^([\w.]+)\(\): incompatible (function|constructor) arguments")
_LINE = re.compile(r"^    \d+\. (?:[\w.]+)?\((.*)\)(?: -> .*)?$", re.MULTILINE)
_TOKEN = re.compile(r"'[^']*'|\"[^\"]*\"|[\[({<]|[\])}>]|, |: | = ")
_NUMBER = "typing.SupportsFloat | typing.SupportsIndex"
_WHOLE = "typing.SupportsInt | typing.SupportsIndex"
_WORDS = {
    "float": "a number",
    "int": "a whole number",
    "bool": "True or False",
    "str": "a string",
    "bytes": "bytes",
    "None": "None",
    "tuple": "a tuple",
    "dict": "a dict",
    "list": "a list",
    "numpy.typing.ArrayLike": "an array of numbers",
    "collections.abc.Callable": "a function",
    "collections.abc.Sequence": "a list",
    "collections.abc.Mapping": "a mapping",
    "typing.Any": "anything",
    "object": "anything",
}
# what functions are called by whoever calls them
_CALLED = {"_sweep": "simulate_many", "_check_sweep": "simulate_many"}


class _Argument:
    """One argument of a signature: its name, what it is, whether it may be left out, whether only its name gives it."""

    def __init__(self, name: str, kind: str, optional: bool, named: bool) -> None:
        self.name, self.kind, self.optional, self.named = name, kind, optional, named


def _parts(text: str) -> list[str]:
    """What stands between the outer commas."""
    parts, depth, begin = [], 0, 0
    for token in _TOKEN.finditer(text):
        mark = token[0]
        depth += (mark in "[({<") - (mark in "])}>")
        if mark == ", " and depth == 0:
            parts.append(text[begin : token.start()])
            begin = token.end()
    return [*parts, text[begin:]] if text else []


def _signature(text: str, is_method: bool) -> list[_Argument]:
    arguments, named = [], False
    for i, part in enumerate(_parts(text)):
        if part in ("*", "/"):
            named = named or part == "*"
            continue
        name, _, rest = part.partition(": ")
        kind, has_default, _ = rest.partition(" = ")
        if i == 0 and is_method and name == "self":
            continue
        arguments.append(_Argument(name, kind, bool(has_default) or name.startswith("*"), named))
    return arguments


def _alternatives(kind: str) -> list[str]:
    kind = kind.replace(_NUMBER, "float").replace(_WHOLE, "int")
    parts, depth, begin = [], 0, 0
    for at, mark in enumerate(kind):
        depth += (mark in "[(") - (mark in "])")
        if mark == "|" and depth == 0:
            parts.append(kind[begin:at].strip())
            begin = at + 1
    return [*parts, kind[begin:].strip()]


def _is_number(value: Any) -> bool:
    """Whether it is one number, of whatever size: an array of several has the means, and no value."""
    if not hasattr(value, "__float__") and not hasattr(value, "__index__"):
        return False
    try:
        float(value)
    except OverflowError:
        return True
    except Exception:
        return False
    return True


def _fits(value: Any, kind: str) -> bool:
    """Whether a value may be of a kind, as far as can be told."""
    base, _, inner = kind.partition("[")
    if base.startswith("rbdyn._core.") or base.startswith("rbdyn."):
        known = getattr(_core, base.rpartition(".")[2], None)
        return known is None or isinstance(value, known)
    if base == "float":
        return _is_number(value)
    if base == "int":
        return hasattr(value, "__index__") and -(2**63) <= value.__index__() < 2**63
    if base == "bool":
        return isinstance(value, bool) or type(value).__name__ in ("bool_", "bool")
    if base == "str":
        return isinstance(value, str) and not _lone(value)
    if base == "None":
        return value is None
    if base == "typing.Literal":
        return isinstance(value, str)
    if base == "tuple" and inner and hasattr(value, "__len__"):
        items = _parts(inner[:-1])
        return items[-1] == "..." or (len(value) == len(items) and all(map(_fits, value, items)))
    if base in ("tuple", "dict", "list", "bytes"):
        return type(value).__name__ == base or isinstance(value, (tuple, dict, list, bytes))
    if base == "collections.abc.Callable":
        return callable(value)
    if base == "collections.abc.Sequence":
        if isinstance(value, (str, bytes)) or not hasattr(value, "__len__") or not hasattr(value, "__getitem__"):
            return False
        return all(any(_fits(item, k) for k in _alternatives(inner[:-1])) for item in value) if inner else True
    return True


def _may_be(value: Any, kind: str) -> bool:
    """The same of things that raise when they are looked at."""
    try:
        return _fits(value, kind)
    except Exception:
        return False


def _has_unit(value: Any) -> bool:
    """The same of a quantity with a unit."""
    try:
        return has_unit(value)
    except Exception:
        return False


def _lone(text: str) -> bool:
    """Whether there is half a character in it, which no file and no terminal takes."""
    return any("\ud800" <= letter <= "\udfff" for letter in text)


def _told(kind: str) -> str:
    base, _, inner = kind.partition("[")
    if base == "tuple" and set(_parts(inner[:-1])) == {"float"}:
        return f"{len(_parts(inner[:-1]))} numbers"
    if base in _WORDS:
        if base == "collections.abc.Sequence" and inner:
            return f"a list, each item {_rule(inner[:-1])}"
        return _WORDS[base]
    if base == "typing.Literal":
        return inner[:-1].replace("'", '"').replace(", ", " or ")
    name = base.rpartition(".")[2]
    return f"{'an' if name[0] in 'AEIO' else 'a'} {name}"


def _rule(kind: str) -> str:
    told = list(dict.fromkeys(_told(k) for k in _alternatives(kind)))
    return told[0] if len(told) == 1 else ", ".join(told[:-1]) + " or " + told[-1]


def _takes(arguments: list[_Argument]) -> str:
    if not arguments:
        return "it takes none"
    return "it takes " + ", ".join(a.name + ("=" if a.optional else "") for a in arguments)


def _complaint(arguments: list[_Argument], given: list[Any], named: dict[str, Any]) -> tuple[int, str]:
    """How far a signature goes with what is given, and what is wrong there."""
    takes_more, takes_words = (any(a.name == stars for a in arguments) for stars in ("*args", "**kwargs"))
    arguments = [a for a in arguments if not a.name.startswith("*")]
    by_place = [a for a in arguments if not a.named]
    pairs = list(zip(by_place, given, strict=False))
    known = {a.name: a for a in arguments}
    pairs += [(known[word], value) for word, value in named.items() if word in known]
    for far, (argument, value) in enumerate(pairs):
        if not any(_may_be(value, kind) for kind in _alternatives(argument.kind)):
            what = f"{argument.name} is {shown(value)}"
            if _has_unit(value):
                return far, f"{what}; {RULE}"
            if "int" in _alternatives(argument.kind) and hasattr(value, "__index__"):
                return far, f"{what}, which is out of range; it is {_rule(argument.kind)} below 2**63"
            if isinstance(value, str) and _lone(value):
                return far, f"{what}, which has half a character (a surrogate) in it; give text that UTF-8 can write"
            return far, f"{what}; it is {_rule(argument.kind)}"
    far = len(pairs)
    for word in named:
        if word not in known and not takes_words:
            return far, f"there is no argument {shown(word)}; {_takes(arguments)}"
        if any(a.name == word for a, _ in zip(by_place, given, strict=False)):
            return far, f"{word} is given twice, by its place and by its name; give it once"
    if len(given) > len(by_place) and not takes_more:
        count = "no arguments" if not by_place else "1 argument" if len(by_place) == 1 else f"{len(by_place)} arguments"
        return far, f"{len(given)} arguments are given by place, and it takes {count} so; {_takes(arguments)}"
    for argument in arguments:
        is_given = argument.name in named or any(a is argument for a, _ in pairs)
        if not argument.optional and not is_given:
            rule = _rule(argument.kind)
            return far, f"{argument.name} is missing; {'give one' if rule == 'anything' else f'it is {rule}'}"
    for argument, value in pairs:
        if _has_unit(value):
            return far, f"{argument.name} is {shown(value)}; {RULE}"
    # what it is cannot be told from the signature: a number out of range, or a list with one
    listed = ", ".join(f"{a.name} {shown(v)}" for a, v in pairs)
    rules = ", ".join(f"{a.name} is {_rule(a.kind)}" for a in arguments if not a.optional)
    return far, f"a value is out of range: {listed}" + (f"; {rules}" if rules else "")


def sentence(message: str, given: list[Any], named: dict[str, Any]) -> str:
    """What is wrong, from pybind11's own message and what was given; the message itself where that is not clear."""
    head = _HEAD.match(message)
    shown = message.partition("\n\nInvoked with")[0]
    lines = _LINE.findall(shown)
    if head is None or not lines:
        return message
    name = _CALLED.get(head[1], head[1])
    methods = [line.startswith("self: ") or line == "self" for line in lines]
    own = given[1:] if given and (methods[0] or name == "__init__") else given
    if given and (methods[0] or name == "__init__"):
        kind = type(given[0]).__name__
        name = kind if name == "__init__" else f"{kind}.{name}"
    complaints = [_complaint(_signature(line, True), own, named) for line in lines]
    best = max(far for far, _ in complaints)
    told = list(dict.fromkeys(text for far, text in complaints if far == best))
    # several signatures ask for different things in one place
    asked = [re.fullmatch(r"(\w+) is (.*); it is (.*)", text, re.DOTALL) for text in told]
    found = [one for one in asked if one is not None]
    if len(told) > 1 and len(found) == len(told) and len({one[2] for one in found}) == 1:
        kinds = list(dict.fromkeys(kind for one in found for kind in re.split(", | or ", one[3])))
        return f"{name}: {found[0][1]} is {found[0][2]}; it is {', '.join(kinds[:-1])} or {kinds[-1]}"
    return f"{name}: {told[0]}"
