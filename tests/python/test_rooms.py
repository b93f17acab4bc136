"""How the library is laid out: rooms see one another one way, and the special laws have one door."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
INCLUDE = ROOT / "cpp" / "include" / "rbdyn"
# the verbs, which stand in no room, see all rooms; what a run keeps of how it was asked sees them, and a scene the plan
# that was made of it
VERBS = "verbs"
KNOWN = {("scene", "plan"), ("trajectory", VERBS), ("system", VERBS)}
DOORS = {"special/door.hpp", "special/lone_body.hpp"}


def room(name: str) -> str:
    return name.split("/")[0] if "/" in name else VERBS


def includes() -> list[tuple[str, str]]:
    """Each header or file of definitions with what it includes."""
    found = []
    for path in sorted(INCLUDE.rglob("*.?pp")):
        name = path.relative_to(INCLUDE).as_posix()
        if name not in ("implementation.hpp", "rbdyn.hpp"):
            found += [(name, to) for to in re.findall(r'#include "rbdyn/([^"]+)"', path.read_text())]
    return found


def test_rooms_see_one_another_one_way():
    pairs = {(room(a), room(b)) for a, b in includes()}
    assert pairs >= KNOWN, "one that is known is gone: take it off the list"
    sees = {a: {b for x, b in pairs if x == a and b != a and (a, b) not in KNOWN} for a, _ in pairs}
    order: list[str] = []
    while len(order) < len(sees):
        ready = [a for a in sees if a not in order and sees[a] <= set(order)]
        assert ready, f"these see one another in a circle: {sorted(set(sees) - set(order))}"
        order += ready


def test_the_special_laws_have_one_door():
    """Nothing outside knows what single bodies there are laws for, but for what the door says."""
    past = [
        f"{a} includes {b}" for a, b in includes() if room(b) == "special" and room(a) != "special" and b not in DOORS
    ]
    assert past == []
