"""What the generated stubs do not know: one time or several, closed lists of words, handles, types of functions."""

import re

# of a name of an argument, the words it takes
WORDS = {
    "direction": ("either", "rising", "falling"),
    "frame": ("world", "body"),
    "ends": ("stop", "release"),
    "inertia_about": ("com", "origin"),
    "engine": ("auto", "closed form", "taylor", "dop853", "cvode-adams", "cvode-bdf"),
}
SIDES = ("both", "+", "-")

ALIASES = """
class _HasAddress(typing.Protocol):
    @property
    def address(self) -> int: ...
# a mapping whose keys are all handles, all names, or some of both: Mapping takes keys of its very type alone
class _Starts(typing.Protocol):
    def keys(self) -> collections.abc.Iterable[tuple[BodyHandle | str, str]]: ...
    def __getitem__(self, key: typing.Any, /) -> typing.Any: ...
_Number: typing.TypeAlias = float | numpy.floating[typing.Any] | numpy.integer[typing.Any]
_Numbers: typing.TypeAlias = (
    numpy.typing.NDArray[typing.Any]
    | collections.abc.Sequence[float]
    | collections.abc.Sequence[collections.abc.Sequence[float]]
)
_Attitude: typing.TypeAlias = numpy.typing.ArrayLike | EulerAngles | Rotation
_End: typing.TypeAlias = BodyHandle | BodyPoint | numpy.typing.ArrayLike
_Vector: typing.TypeAlias = numpy.typing.ArrayLike | collections.abc.Sequence[typing.Any]
_Function: typing.TypeAlias = collections.abc.Callable[..., typing.Any]
_Of1: typing.TypeAlias = collections.abc.Callable[[typing.Any], typing.Any]
_Of3: typing.TypeAlias = collections.abc.Callable[[typing.Any, typing.Any, typing.Any], typing.Any]
_Of7: typing.TypeAlias = collections.abc.Callable[
    [typing.Any, typing.Any, typing.Any, typing.Any, typing.Any, typing.Any, typing.Any], typing.Any
]
_Of5: typing.TypeAlias = collections.abc.Callable[
    [typing.Any, typing.Any, typing.Any, typing.Any, typing.Any], typing.Any
]
_Of13: typing.TypeAlias = collections.abc.Callable[
    [
        typing.Any, typing.Any, typing.Any, typing.Any, typing.Any, typing.Any, typing.Any,
        typing.Any, typing.Any, typing.Any, typing.Any, typing.Any, typing.Any
    ],
    typing.Any,
]
_Compiled: typing.TypeAlias = Function | _HasAddress | tuple[typing.Any, ...]
_Pole: typing.TypeAlias = numpy.typing.ArrayLike | _Of1 | Function | BodyHandle | BodyPoint
_Watched: typing.TypeAlias = collections.abc.Callable[[Now], typing.Any]
_WatchedState: typing.TypeAlias = collections.abc.Callable[[SystemNow], typing.Any]
_Of2: typing.TypeAlias = collections.abc.Callable[[typing.Any, typing.Any], typing.Any]
_Engine: typing.TypeAlias = typing.Literal[{engines}]
"""

ONE_OR_SEVERAL = "float | numpy.typing.NDArray[numpy.float64]"


def _literal(words: tuple[str, ...]) -> str:
    return "typing.Literal[" + ", ".join(f"'{word}'" for word in words) + "]"


def _overloads(text: str) -> str:
    """Methods that give a number for one argument and an array for several."""

    def both(found: re.Match[str]) -> str:
        indent, name, inside, returned = found.groups()
        if returned != ONE_OR_SEVERAL or "numpy.typing.ArrayLike" not in inside:
            return found[0]
        several = re.sub(r"\b(t|u|u0|u1): numpy\.typing\.ArrayLike", r"\1: _Numbers", inside)
        one = re.sub(r"\b(t|u|u0|u1|speed): numpy\.typing\.ArrayLike", r"\1: _Number", inside)
        array = "numpy.typing.NDArray[numpy.float64]"
        return (
            f"{indent}@typing.overload\n{indent}def {name}({several}) -> {array}:\n{indent}    ...\n"
            f"{indent}@typing.overload\n{indent}def {name}({one}) -> float:\n"
        )

    return re.sub(r"^( *)def (\w+)\((.*)\) -> (.*):\n", both, text, flags=re.MULTILINE)


def _of_class(text: str, name: str, change: tuple[str, str]) -> str:
    """A change within the stubs of one class."""
    found = re.search(rf"^class {name}\b.*?(?=^class |^def |\Z)", text, flags=re.MULTILINE | re.DOTALL)
    assert found is not None, f"the stubs have no class {name}"
    return text[: found.start()] + re.sub(*change, found[0]) + text[found.end() :]


def _present(text: str) -> str:
    """Quantities of the present moment, by the shapes that their docstrings name."""

    def typed(found: re.Match[str]) -> str:
        is_array = re.search(r"\((2|3|4|3, 3)(,\)|\))", found[2]) is not None
        kind = "numpy.typing.NDArray[numpy.float64]" if is_array else "float"
        return f"{found[1]}{kind}:{found[2]}"

    for name in ("BodyNow", "CouplingNow", "Now", "SystemNow"):
        text = _of_class(text, name, (r'(def \w+\(self\) -> )typing\.Any:(\n\s*"""\n[^"]*""")', typed))
    return text


def typed(text: str) -> str:
    """Generated stubs, with the types that type checkers need."""
    bare = {
        "collections.abc.Callable": "_Function",
        "collections.abc.Sequence": "collections.abc.Sequence[typing.Any]",
        "collections.abc.Iterator": "collections.abc.Iterator[typing.Any]",
        "tuple": "tuple[typing.Any, ...]",
        "dict": "dict[typing.Any, typing.Any]",
        "list": "list[typing.Any]",
    }
    for name, full in bare.items():
        pattern = rf"(: |> |\| |, |\[){re.escape(name)}(?=[,:)\]\n]| =| \||$)"
        text = re.sub(pattern, rf"\g<1>{full}", text, flags=re.MULTILINE)
    text = re.sub(r"(\*args|\*\*kwargs)(?=[,)])", r"\1: typing.Any", text)
    text = text.replace(
        "__hash__: typing.ClassVar[None] = None", "__hash__: typing.ClassVar[None]  # type: ignore[assignment]"
    )
    attitude = "numpy.typing.ArrayLike | EulerAngles | scipy.spatial.transform.Rotation"
    text = text.replace(attitude, "_Attitude")
    text = _of_class(text, "Force", (r"numpy\.typing\.ArrayLike \| _Function", "_Vector | _Of3 | _Of7 | _Compiled"))
    text = _of_class(text, "Torque", (r"numpy\.typing\.ArrayLike \| _Function", "_Vector | _Of3 | _Compiled"))
    text = _of_class(text, "Potential", (r"U: typing\.Any", "U: _Of1 | _Of3 | Function"))
    text = _of_class(text, "Curve", (r"function: typing\.Any", "function: _Of1 | Function"))
    text = text.replace("drive: float | _Function", "drive: float | Parameter | _Of1 | Function")
    text = text.replace("motion: _Function | None", "motion: _Of1 | Function | None")
    text = text.replace("density: float | _Function", "density: float | _Of3")
    for name, functions in {"Central": "_Of1", "PairForce": "_Of5 | _Of13"}.items():
        text = _of_class(text, name, (r"f: typing\.Any", f"f: {functions} | _Compiled"))
    # words
    kinetic = _literal(("world", "center of mass"))
    text = re.sub(r"(def kinetic_energy\(.*frame: )str\b", rf"\1{kinetic}", text)
    for name, words in WORDS.items():
        kind = "_Engine" if name == "engine" else _literal(words)
        text = re.sub(rf"\b{name}: str\b", f"{name}: {kind}", text)
    text = text.replace("engines: collections.abc.Sequence[str]", "engines: collections.abc.Sequence[_Engine]")
    text = re.sub(r"\bside: str\b", f"side: {_literal(SIDES)}", text)
    text = re.sub(r"\bkeep: str\b", f"keep: {_literal(('all', 'end'))}", text)
    text = re.sub(r"\baction: str \| _Function", f"action: {_literal(('record', 'stop'))} | _Watched", text)
    text = text.replace("pole: numpy.typing.ArrayLike | _Function | BodyHandle | BodyPoint", "pole: _Pole")
    text = text.replace("about: str | ", f"about: {_literal(('com', 'origin'))} | ")
    # handles and functions
    text = text.replace(
        "a: numpy.typing.ArrayLike, b: numpy.typing.ArrayLike) -> CouplingHandle", "a: _End, b: _End) -> CouplingHandle"
    )
    text = re.sub(
        r"(def constrain\(.*, a: )numpy\.typing\.ArrayLike, b: numpy\.typing\.ArrayLike \| None",
        r"\1_End, b: _End | None",
        text,
    )
    text = re.sub(r"(def apply\(.*?)handle: Handle", r"\1handle: BodyHandle", text)
    text = re.sub(r"(def (?:watch|integral)\(self, name: str, function: )typing\.Any", r"\1_Watched", text)
    text = re.sub(r"(def parameter\(value: )typing\.Any(.*\) -> )typing\.Any", r"\1float\2Parameter", text)
    text = _of_class(text, "System", (r"\b_Watched\b", "_WatchedState"))
    text = _of_class(text, "System", (r"f: typing\.Any", "f: _Of2 | _Compiled"))
    text = re.sub(
        r"(def simulate\(system: .*initial: )typing\.Any",
        r"\1numpy.typing.ArrayLike | collections.abc.Mapping[str | int, float] | None",
        text,
    )
    for name in ("SystemNow", "SystemRun"):
        text = _of_class(text, name, (r"variable: typing\.Any", "variable: str | int"))
    text = re.sub(r"initial: typing\.Any", "initial: _Starts | None", text)
    handed_on = f"{_literal(('all', 'last'))} | collections.abc.Callable[[Event], typing.Any]"
    text = re.sub(r"events: typing\.Any", f"events: {handed_on}", text)
    text = re.sub(r"progress: typing\.Any", "progress: bool | collections.abc.Callable[[float], typing.Any]", text)
    text = re.sub(r"(def plot\(self, path: )typing\.Any", r"\1str | os.PathLike[str] | None", text)
    text = text.replace(
        "def without(self, *args: typing.Any)", "def without(self, *args: str | LoadHandle | CouplingHandle)"
    )
    text = text.replace(
        "of: Handle | collections.abc.Sequence[Handle] | None", "of: Handle | collections.abc.Sequence[Handle] | None"
    )
    text = _overloads(_present(text))
    aliases = ALIASES.format(engines=", ".join(f"'{word}'" for word in WORDS["engine"]))
    text = text.replace("import scipy.spatial.transform\n", "")
    text = text.replace("import os\n", "").replace("import numpy.typing\n", "import numpy.typing\nimport os\n", 1)
    aliases = aliases.replace("Rotation", "typing.Any")
    return re.sub(r"(?m)^(__all__: .*\n)", lambda found: found[1] + aliases.lstrip("\n"), text, count=1)
