"""The reference of the C++ names: what rbdyn/rbdyn.hpp declares, header by header, as it reads, but what is private.

The headers say what a name means in comments above it and define little, so a listing of them is the reference.
"""

import re
from pathlib import Path

SUBJECTS = {
    "Verbs": [
        "simulate",
        "options",
        "simulate_many",
        "cost",
        "price",
        "effects",
        "own_motion",
        "file/scene_file",
        "file/schema",
    ],
    "Scenes": [
        *("scene/scene", "scene/handles", "scene/starts", "scene/joints", "scene/loads", "scene/torque"),
        *("scene/joint_loads", "scene/couplings", "scene/spring", "scene/pair_laws", "scene/constraints"),
        *("scene/contacts", "scene/surfaces", "scene/rigid_motion", "scene/watch"),
    ],
    "Bodies": [
        *("body/particle", "body/rigid_body", "body/mass_properties", "body/momentum", "body/principal_axes"),
        *("body/shapes", "rotation/attitude", "rotation/euler_angles", "rotation/quaternion"),
    ],
    "Curves": [
        *("curve/curve", "curve/line", "curve/circle", "curve/parabola", "curve/cycloid", "curve/helix"),
        *("curve/polynomial", "curve/spline", "curve/function_curve", "curve/point"),
    ],
    "Runs": [
        *("trajectory/any_run", "trajectory/trajectory", "trajectory/body_motion", "trajectory/events"),
        *("trajectory/pole", "trajectory/statistics", "event/event", "event/keep", "plan/plan"),
    ],
    "At rest": ["statics/equilibria", "statics/equilibrium", "statics/normal_modes", "statics/rail_potential"],
    "Functions and equations of your own": [
        *("expression/expression", "expression/condition", "expression/function", "expression/parameter"),
        *("expression/elementary", "model/own_model", "system/system", "system/system_plan", "system/system_run"),
        "model/euler_top",
    ],
    "Basics": ["basics/vector", "basics/direction", "basics/error"],
}
# what these stand on, which a program that uses rbdyn has no need to know
INNER = [
    *("basics/dense", "basics/double_double", "basics/double_double_vector", "basics/form", "basics/instant"),
    "basics/shared",
    *("basics/interruption", "expression/functor"),
    *("closed_form/symmetric_modes", "curve/axes", "curve/checks", "curve/own_axes", "curve/polynomial_piece"),
    *("curve/stretch", "engine/work", "expression/callback", "expression/derivative", "expression/given"),
    *("expression/kept_series", "expression/node", "expression/numbers", "expression/own_function"),
    *(
        "expression/program",
        "expression/code_memory",
        "expression/value_code",
        "series/lanes",
    ),
    *("expression/recorder", "expression/recording", "expression/rounded", "expression/time_function"),
    *("model/equations", "model/equations_writer", "model/hybrid", "model/omission", "model/recorded_model"),
    *("model/size", "model/sliding", "model/system_report", "model/variables_model", "rbdyn", "scene/plan_slot"),
    "series/piece",
]


def reachable(include: Path) -> set[str]:
    """The headers that rbdyn/rbdyn.hpp includes, without folder and ending."""
    found: set[str] = set()
    waiting = ["rbdyn"]
    while waiting:
        name = waiting.pop()
        if name not in found and name != "implementation":
            found.add(name)
            text = (include / "rbdyn" / f"{name}.hpp").read_text()
            waiting += re.findall(r'#include "rbdyn/([^"]+)\.hpp"', text)
    return found


def split(text: str) -> tuple[str, str]:
    """What a header says of itself, as text, and its declarations."""
    head, _, rest = text.partition("#pragma once\n")
    said = "\n".join(line.removeprefix("//").removeprefix(" ") for line in head.splitlines())
    lines: list[str] = []
    hidden = None  # how far the `private:` is indented that hides what follows
    for line in rest.splitlines():
        word, indent = line.strip(), len(line) - len(line.lstrip())
        if word in ("private:", "protected:"):
            hidden = indent
        elif indent == hidden and word in ("public:", "};"):
            hidden = None
        if hidden is None and not line.startswith(("#", "namespace rbdyn", "}  // namespace rbdyn")):
            lines.append(line)
    text = re.sub(r"\n\n+(\s*};)", r"\n\1", "\n".join(lines))
    return said.strip(), re.sub(r"\n{3,}", "\n\n", text).strip()


def place_of(header: str) -> str:
    """What links to a header lead to."""
    return "header-" + header.replace("/", "-").replace("_", "-")


def write_pages(include: Path, folder: Path) -> list[tuple[str, str]]:
    """Writes a page a subject; (title, file) of each, the index first."""
    folder.mkdir(parents=True)
    index = [
        "# C++, header by header",
        "",
        "`#include <rbdyn/rbdyn.hpp>` declares all of it, in the namespace `rbdyn`.",
        "",
    ]
    pages = [("By subject", "index.md")]
    for subject, headers in SUBJECTS.items():
        file = subject.lower().replace(" ", "_") + ".md"
        text = [f"# {subject}"]
        for header in headers:
            said, declared = split((include / "rbdyn" / f"{header}.hpp").read_text())
            quoted = "\n".join(f"> {line}" for line in said.replace("<", "&lt;").splitlines())
            text += [f"({place_of(header)})=\n## {header}.hpp", quoted, f"```cpp\n{declared}\n```"]
        (folder / file).write_text("\n\n".join(text) + "\n")
        links = ", ".join(f"[`{header}.hpp`](#{place_of(header)})" for header in headers)
        index.append(f"* [{subject}]({file}): {links}")
        pages.append((subject, file))
    (folder / "index.md").write_text("\n".join(index) + "\n")
    return pages
