"""Tables in notebooks: what scenes, plans, runs, events and effects show there (prices: tables.py)."""

from __future__ import annotations

import html
import json
import math
from collections.abc import Iterable, Sequence
from typing import Any

from rbdyn import _core
from rbdyn._core import EffectTable, Event, Events, Plan, Scene, SystemPlan, SystemRun, Trajectory
from rbdyn.errors import InvalidInput

METHOD = "_repr_html_"  # what notebooks ask for
LONGEST = 50  # rows of events; what is left out is counted


def give() -> None:
    """Makes them methods of the classes whose tables they are."""
    tables = {
        Scene: scene_html,
        Plan: plan_html,
        SystemPlan: plan_html,
        Trajectory: run_html,
        SystemRun: run_html,
        Event: event_html,
        Events: events_html,
        EffectTable: effects_html,
    }
    for kind, table in tables.items():
        setattr(kind, METHOD, table)


def scene_html(self: Scene) -> str:
    """A row for each thing in a scene: what it is, its numbers, how it starts."""
    try:
        content = json.loads(_core._scene_text(self))
    except InvalidInput:  # functions that are called back are no data: names alone
        return _paragraph(repr(self)[1:-1]) + _table(["name"], [[name] for name in self.handles])
    rows = []
    for body in content.get("bodies", []):
        parent = f" on {body['parent']}" if "parent" in body else ""
        rows.append([body["name"], _words(body["body"]), _words(body["joint"]) + parent, _words(body.get("start", {}))])
    for group, words in (("loads", "on"), ("couplings", "b"), ("constraints", "b"), ("contacts", "b"), ("watches", "")):
        for thing in content.get(group, []):
            inner = thing.get("constraint", {})
            ends = [_end(thing[end]) for end in ("a", words) if end in thing]
            numbers = {key: value for key, value in thing.items() if key not in ("name", "a", "b", "on", "function")}
            numbers.pop("constraint", None)
            rows.append([thing.get("name", group[:-1]), _words(inner | numbers), " - ".join(ends), ""])
    return _paragraph(repr(self)[1:-1]) + _table(["name", "what", "where", "start"], rows)


def plan_html(self: Plan | SystemPlan) -> str:
    """What is simulated, what is left out and why."""
    rows = []
    for name in ("coordinates", "variables", "effects", "guards", "functions", "integrals", "not_unique"):
        said = getattr(self, name, None)
        if said:
            rows.append([name.replace("_", " "), "; ".join(said)])
    rows.append(["engine", f"{self.engine}: {self.reason}"])
    rows.append(["size", repr(self.size).removeprefix("<Size: ").removesuffix(">")])
    rows += [["left out", f"{one.what}: {one.why}"] for one in getattr(self, "omissions", [])]
    parts = [part for part in getattr(self, "parts", []) if len(self.parts) > 1]  # type: ignore[union-attr]
    return _table(["plan", ""], rows) + "".join(plan_html(part) for part in parts)


def run_html(self: Trajectory | SystemRun) -> str:
    """How a run ended, with which engine, at which price, and its events."""
    statistics = self.statistics
    error = "not estimated" if self.error is None else f"{self.error:.1e}"
    rows = [
        ["status", f"{self.status} at t = {self.end} s"],
        ["engine", self.engine],
        ["estimated global error", error],
        ["steps", str(statistics.steps)],
        ["time", f"{statistics.seconds * 1e3:.3g} ms"],
    ]
    if self.certain_until < self.end:
        rows.insert(1, ["certain until", f"t = {self.certain_until} s"])
    drift = getattr(self, "drift", None)
    if drift:
        rows.append(["drift", ", ".join(f"{name} {size:.1e}" for name, size in drift.items())])
    return _table(["run", ""], rows) + (events_html(self.events) if len(self.events) else "")


def event_html(self: Event) -> str:
    """One line of a table of events."""
    return _events([self])


def events_html(self: Events) -> str:
    """A row an event, the first of them."""
    left = len(self) - LONGEST
    return _events(list(self)[:LONGEST]) + (_paragraph(f"and {left} more") if left > 0 else "")


def effects_html(self: EffectTable) -> str:
    """What a scene is without each of its effects: the motion, its events, its price."""
    rows = [["nothing", str(self.steps), f"{self.seconds * 1e3:.4f}", "-", "0", "0", f"{self.events} events"]]
    for row in self.rows:
        difference = f"{row.difference:.1e}" if math.isfinite(row.difference) else "-"
        seconds = f"{row.seconds * 1e3:.4f}" if math.isfinite(row.seconds) else "-"
        rows.append([row.effect, str(row.steps), seconds, difference, str(row.gained), str(row.lost), row.note])
    return _table(["without", "steps", "time [ms]", "difference", "gained", "lost", ""], rows)


def _events(events: Iterable[Event]) -> str:
    rows = []
    for event in events:
        pushed = [f"{size:g}" for size in _numbers(event.impulse)]
        impulse = ", ".join(pushed) if any(_numbers(event.impulse)) else ""
        rows.append([repr(event.time), event.kind, event.name, event.direction, impulse, event.note])
    return _table(["t [s]", "event", "of", "direction", "impulse [N s]", "note"], rows)


def _numbers(value: Any) -> list[float]:
    return [float(number) for number in (value if hasattr(value, "__len__") else [value])]


def _words(said: dict[str, Any]) -> str:
    """The kind of a thing and its numbers in a line."""
    parts = [str(said["kind"])] if "kind" in said else []
    for key, value in said.items():
        if key == "kind":
            continue
        parts.append(f"{key} {_value(value)}" if not isinstance(value, dict) else f"{key} ({_words(value)})")
    return ", ".join(parts)


def _value(value: Any) -> str:
    """Numbers to six digits; of a pair of 32 digits the first half."""
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, list):
        if len(value) == 2 and all(isinstance(one, float) for one in value) and abs(value[1]) < 1e-15 * abs(value[0]):
            return f"{value[0]:g}"
        return "[" + ", ".join(_value(one) for one in value[:6]) + (", ..." if len(value) > 6 else "") + "]"
    return str(value)


def _end(said: Any) -> str:
    """An end of a coupling, a constraint or a contact; the body of a load."""
    if not isinstance(said, dict):
        return str(said)
    body = str(said.get("body", ""))
    return ", ".join(filter(None, [body, _words({key: value for key, value in said.items() if key != "body"})]))


def _paragraph(text: str) -> str:
    return f"<p>{html.escape(text)}</p>"


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; columns in which no row has anything are left out."""
    rows = list(rows)
    used = [i for i in range(len(heads)) if not rows or any(row[i] for row in rows)]
    lines = ["<table>", "<tr>" + "".join(f"<th>{html.escape(heads[i])}</th>" for i in used) + "</tr>"]
    lines += ["<tr>" + "".join(f"<td>{html.escape(row[i])}</td>" for i in used) + "</tr>" for row in rows]
    return "\n".join([*lines, "</table>"])
