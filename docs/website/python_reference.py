"""The reference of the Python names: a page a subject, filled from the docstrings by Sphinx's autodoc (conf.py)."""

import re
from pathlib import Path

from rbdyn.signatures import shortened

SUBJECTS = {
    "Scenes": [
        *("Scene", "Handle", "BodyHandle", "BodyPoint", "BodyShape", "CouplingHandle", "ConstraintHandle"),
        *("ContactHandle", "LoadHandle", "WatchHandle"),
    ],
    "Bodies": ["Particle", "RigidBody", "shapes", "EulerAngles", "PrincipalAxes", "Imbalance"],
    "Joints": [
        *("Free", "Rail", "Spherical", "Revolute", "Prismatic", "Universal", "Cylindrical", "Planar", "Fixed"),
    ],
    "Curves": ["Line", "Circle", "Parabola", "Cycloid", "Helix", "Polynomial", "Spline", "Curve", "Frenet"],
    "Loads and couplings": [
        *("Force", "Torque", "Potential", "Drag", "Lorentz", "TorsionSpring", "JointForce", "JointTorque"),
        *("Spring", "Gravitation", "Central", "PairForce"),
    ],
    "Constraints and contacts": [
        "Ball",
        "Rod",
        "Weld",
        "Hinge",
        "PointOnCurve",
        "PointOnPlane",
        "Plane",
        "Sphere",
        "Coulomb",
    ],
    "Functions of your own": [
        *("parameter", "Parameter", "Function", "UserFunction", "Expression", "Condition", "where"),
        *("Watched", "Now", "BodyNow", "CouplingNow"),
    ],
    "Verbs": [
        *("simulate", "simulate_many", "engines", "plan", "equilibria", "normal_modes", "rail_potential"),
        *("save", "load", "scene_schema"),
    ],
    "Plans and rests": [
        *("Plan", "Omission", "Size", "Equilibrium", "NormalModes", "RailPotential", "TurningPoints"),
    ],
    "Runs": [
        *(
            "Trajectory",
            "BodyMotion",
            "BodyPointMotion",
            "CouplingMotion",
            "ConstraintMotion",
            "ContactMotion",
            "PointMotion",
            "Axis",
        ),
        *("Event", "Events", "Statistics", "Sample", "Many"),
    ],
    "Prices and checks": [
        *("cost", "Price", "CostRow", "MissingEngine", "Prediction", "effects", "EffectTable", "EffectRow"),
        *("verify", "Scorecard"),
    ],
    "Equations of your own": ["System", "SystemNow", "SystemPlan", "SystemRun", "SystemSample", "SystemVariable"],
    "Single motions": ["PoinsotMotion", "EulerTop", "StateRun"],
    "Errors": ["Error", "InvalidInput", "AccuracyError", "IntegrationError"],
}


def file_of(subject: str) -> str:
    return subject.lower().replace(" ", "_") + ".rst"


def directive_for(name: str) -> str:
    """How autodoc is asked for a name: a module and functions are in small letters, errors say what they are."""
    if name == "shapes":
        return "automodule"
    if name[0].islower():
        return "autofunction"
    return "autoexception" if SUBJECTS["Errors"].count(name) else "autoclass"


def write_pages(folder: Path) -> list[tuple[str, str]]:
    """Writes a page a subject; (title, file) of each, the index first."""
    folder.mkdir(parents=True)
    index = ["# Python, name by name", "", "| | |", "|---|---|"]
    for subject, names in SUBJECTS.items():
        blocks = [subject, "=" * len(subject)]
        for name in names:
            blocks += ["", name, "-" * len(name), "", f".. {directive_for(name)}:: rbdyn.{name}"]
            if directive_for(name) != "autofunction":
                blocks += ["   :members:", "   :undoc-members:"]
            if directive_for(name) == "autoclass":
                blocks += ["   :special-members: __getitem__"]
        (folder / file_of(subject)).write_text("\n".join(blocks) + "\n")
        links = ", ".join(f"{{py:obj}}`~rbdyn.{name}`" for name in names)
        index.append(f"| {{doc}}`{file_of(subject).removesuffix('.rst')}` | {links} |")
    (folder / "index.md").write_text("\n".join(index) + "\n")
    return [("By subject", "index.md"), *((subject, file_of(subject)) for subject in SUBJECTS)]


def escaped(lines: list[str]) -> list[str]:
    """A docstring, which is plain text, as reStructuredText; signatures of overloads stand as code."""
    text = "\n".join(lines)
    text = re.sub(r"^\w+\(\*args, \*\*kwargs\)\n", "", text)
    text = re.sub(r"^Overloaded function\.\n", "", text)
    parts = re.split(r"^(?:\d\. )(\w+\(.*)$", text, flags=re.MULTILINE)
    for i, part in enumerate(parts):
        if i % 2:
            parts[i] = f"``{shortened(part)}``"
        else:
            parts[i] = re.sub(r"([\\*|`])", r"\\\1", part)
            parts[i] = re.sub(r"(?<=\w)_(?!\w)", r"\\_", parts[i])
    return "".join(parts).splitlines()
