"""Lists of prices for other programs: rows as plain values, as a data frame, as HTML for notebooks."""

from __future__ import annotations

import html
import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rbdyn._core import CostRow, Price

FIELDS = (
    "engine",
    "tolerance",
    "error",
    "motion_error",
    "event_error",
    "events",
    "events_expected",
    "has_all_events",
    "seconds",
    "spread",
    "total",
    "steps",
    "right_hand_sides",
)


def price_rows(price: Price) -> list[dict[str, Any]]:
    """A dict a row, its fields by name, `on_front` and `is_automatic` with them."""
    front = {_key(row) for row in price.front()}
    return [
        {name: getattr(row, name) for name in FIELDS}
        | {"on_front": _key(row) in front, "is_automatic": row.engine == price.automatic}
        for row in price
    ]


def price_frame(price: Price) -> Any:
    """A pandas.DataFrame of a price list; times in s. frame.attrs has the reference and what is missing."""
    import pandas as pd  # type: ignore[import-untyped,unused-ignore]

    frame = pd.DataFrame(price_rows(price), columns=[*FIELDS, "on_front", "is_automatic"])
    frame.attrs = {
        "automatic": price.automatic,
        "reference": price.reference,
        "missing": {one.engine: one.reason for one in price.missing},
    }
    return frame


def price_html(price: Price) -> str:
    """A price list as an HTML table; rows on the front are bold, what simulate() takes by itself is marked."""
    heads = [
        "engine",
        "tolerance",
        "error of motion",
        "of events",
        "events found",
        "integration [ms]",
        "spread",
        "whole call [ms]",
        "steps",
        "right-hand sides",
    ]
    lines = ["<table>", "<tr>" + "".join(f"<th>{head}</th>" for head in heads) + "</tr>"]
    for row in price_rows(price):
        has_events = row["events_expected"] > 0 or not row["has_all_events"]
        found = f"{row['events']} of {row['events_expected']}" + ("" if row["has_all_events"] else " (others)")
        cells = [
            html.escape(row["engine"]) + (" (auto)" if row["is_automatic"] and row["engine"] != "auto" else ""),
            _number(row["tolerance"], "{:.0e}") if row["tolerance"] > 0 else "-",
            _number(row["motion_error"], "{:.1e}"),
            _number(row["event_error"], "{:.1e}") if has_events else "-",
            found if has_events else "-",
            _number(row["seconds"] * 1e3, "{:.4f}"),
            _number(row["spread"] * 1e2, "{:.0f} %"),
            _number(row["total"] * 1e3, "{:.4f}"),
            str(row["steps"]),
            str(row["right_hand_sides"]),
        ]
        style = ' style="font-weight: bold"' if row["on_front"] else ""
        lines.append(f"<tr{style}>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    lines.append("</table>")
    lines += [f"<p>Missing: {html.escape(one.engine)}: {html.escape(one.reason)}</p>" for one in price.missing]
    takes = "taylor, and cvode-bdf where that is stiff" if price.automatic == "auto" else price.automatic
    lines.append(
        f"<p>Bold: none is as accurate and quicker. auto takes {html.escape(takes)}. "
        f"Errors against {html.escape(price.reference)}.</p>"
    )
    return "\n".join(lines)


def _key(row: CostRow) -> tuple[str, float]:
    return row.engine, row.tolerance


def _number(value: float, form: str) -> str:
    return form.format(value) if math.isfinite(value) else "-"
