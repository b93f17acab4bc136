"""What verify() found: a table of cases and engines, for people, notebooks, programs and figures."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from rbdyn.destinations import write_figure
from rbdyn.shown import shown

# doubles have no more
MOST_DIGITS = 16.0

COLUMNS = ("case", "engine", "answer", "known", "ours", "error", "digits", "asked", "told", "time [ms]")


@dataclass(frozen=True)
class Row:
    """One case with one engine.

    known, ours: the answer that is the farthest off, and what the engine gave; error: relative; asked: the error asked
    for; estimate: the run's own, not a number if it gives none; seconds: of all runs of the case;
    status: "held", "missed" (off by more than was asked or told), "refused" (the engine says that it cannot), "failed".
    """

    case: str
    subject: str
    engine: str
    what: str
    known: Any
    ours: Any
    error: float
    asked: float
    estimate: float
    seconds: float
    status: str
    reason: str

    def __post_init__(self) -> None:
        for name in ("case", "subject", "engine", "what", "status", "reason"):
            if not isinstance(getattr(self, name), str):
                raise TypeError(f"Row: {name} is {shown(getattr(self, name))}; it is a string")
        for name in ("error", "asked", "estimate", "seconds"):
            if not isinstance(getattr(self, name), (int, float, np.integer, np.floating)):
                raise TypeError(f"Row: {name} is {shown(getattr(self, name))}; it is a number")
        for name in ("known", "ours"):
            try:
                np.asarray(0.0 if getattr(self, name) is None else getattr(self, name), float)
            except (TypeError, ValueError):
                said = shown(getattr(self, name))
                raise TypeError(f"Row: {name} is {said}; it is a number, an array of numbers, or None") from None

    @property
    def digits(self) -> float:
        """-log10 of the error, from 0 to 16; not a number where there is none."""
        if math.isnan(self.error):
            return math.nan
        if self.error == 0.0:
            return MOST_DIGITS
        return min(max(-math.log10(self.error), 0.0), MOST_DIGITS)


@dataclass(frozen=True)
class Scorecard:
    """Rows of cases and engines. print() shows it; `passed` is whether every case is held and none is missed."""

    rows: tuple[Row, ...]
    seconds: float
    interrupted: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.rows, tuple) or not all(isinstance(row, Row) for row in self.rows):
            raise TypeError(f"Scorecard: rows is {shown(self.rows)}; it is a tuple of Row")

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def of(self, status: str) -> tuple[Row, ...]:
        """The rows of a status: "held", "missed", "refused", "failed"."""
        return tuple(row for row in self.rows if row.status == status)

    @property
    def cases(self) -> tuple[str, ...]:
        """Names of the cases that were run, in order."""
        return tuple(dict.fromkeys(row.case for row in self.rows))

    @property
    def unheld(self) -> tuple[str, ...]:
        """Cases that no engine holds."""
        held = {row.case for row in self.of("held")}
        return tuple(name for name in self.cases if name not in held)

    @property
    def passed(self) -> bool:
        """Whether at least one engine holds each case, none was missed or failed, and all were run."""
        is_right = not self.unheld and not self.of("missed") and not self.of("failed")
        return bool(self.rows) and is_right and not self.interrupted

    def __str__(self) -> str:
        table = [COLUMNS, *(_cells(row) for row in self.rows if row.status in ("held", "missed"))]
        widths = [max(len(line[k]) for line in table) for k in range(len(COLUMNS))]
        lines = [self._head()]
        for cells in table:
            left = (cell.ljust(widths[k]) if k < 3 else cell.rjust(widths[k]) for k, cell in enumerate(cells))
            lines.append("  ".join(left))
        for status in ("missed", "failed"):
            lines += [f"{status}: {row.case}, {row.engine}: {row.reason}" for row in self.of(status)]
        lines += [f"no engine holds: {name}" for name in self.unheld]
        reasons: dict[tuple[str, str], list[str]] = {}
        for row in self.of("refused"):
            reasons.setdefault((row.case, row.reason), []).append(row.engine)
        lines += [f"refused: {name}: {', '.join(engines)}: {why}" for (name, why), engines in reasons.items()]
        return "\n".join(lines)

    def _head(self) -> str:
        counts = ", ".join(f"{len(self.of(one))} {one}" for one in ("held", "missed", "failed", "refused"))
        verdict = "interrupted" if self.interrupted else "passed" if self.passed else "NOT passed"
        return f"Scorecard: {verdict}, {self._count()}, rows: {counts}"

    def _count(self) -> str:
        return "1 case" if len(self.cases) == 1 else f"{len(self.cases)} cases"

    def _repr_html_(self) -> str:
        heads = "".join(f"<th>{html.escape(head)}</th>" for head in (*COLUMNS, "status"))
        lines = [f"<p>{html.escape(self._head())}</p>", "<table>", f"<tr>{heads}</tr>"]
        for row in self.rows:
            why = f"{row.status}: {row.reason}" if row.reason else row.status
            style = "" if row.status in ("held", "refused") else ' style="font-weight: bold"'
            cells = "".join(f"<td>{html.escape(cell)}</td>" for cell in (*_cells(row), why))
            lines.append(f"<tr{style}>{cells}</tr>")
        return "\n".join([*lines, "</table>"])

    def to_dicts(self) -> list[dict[str, Any]]:
        """A dict a row, plain values, `digits` with them."""
        plain = {"known", "ours"}
        return [
            {key: np.asarray(value).tolist() if key in plain and value is not None else value
             for key, value in asdict(row).items()} | {"digits": row.digits}
            for row in self.rows
        ]  # fmt: skip

    def to_pandas(self) -> Any:
        """A pandas.DataFrame, a line a row."""
        import pandas as pd  # type: ignore[import-untyped,unused-ignore]

        return pd.DataFrame(self.to_dicts())

    def plot(self, path: str | None = None) -> Any:
        """A figure of digits over time, a colour an engine; returns it, and writes it to path if one is given."""
        from matplotlib.figure import Figure

        figure = Figure(figsize=(7.0, 4.5), layout="constrained")
        axes = figure.subplots()
        drawn = [row for row in self.rows if row.status in ("held", "missed")]
        for name in dict.fromkeys(row.engine for row in drawn):
            its = [row for row in drawn if row.engine == name]
            axes.plot([row.seconds * 1e3 for row in its], [row.digits for row in its], "o", label=name, alpha=0.7)
        missed = [row for row in drawn if row.status == "missed"]
        axes.plot([row.seconds * 1e3 for row in missed], [row.digits for row in missed], "rx", label=None)
        axes.set(xscale="log", xlabel="time [ms]", ylabel="digits of the worst answer", title=self._head())
        if drawn:
            axes.legend()
        write_figure(figure, path, "Scorecard.plot")
        return figure


def _cells(row: Row) -> tuple[str, ...]:
    digits = "-" if math.isnan(row.digits) else str(math.floor(row.digits))
    return (
        row.case,
        row.engine,
        row.what,
        _value(row.known),
        _value(row.ours),
        _error(row.error),
        digits,
        _error(row.asked),
        _error(row.estimate),
        f"{row.seconds * 1e3:.1f}",
    )


def _error(value: float) -> str:
    return "-" if math.isnan(value) else "0" if value == 0.0 else f"{value:.1e}"


def _value(value: Any) -> str:
    """A number as it is, of several how many there are beside the first."""
    if value is None:
        return "-"
    numbers = np.ravel(np.asarray(value, float))
    if not len(numbers):
        return "none"
    return f"{numbers[0]:.13g}" + (f"_(+{len(numbers) - 1})" if len(numbers) > 1 else "")
