"""Quantities with a unit, of pint, astropy, unyt and others: refused, for NumPy drops the unit without a word."""

from __future__ import annotations

from typing import Any

RULE = (
    "it has a unit, and numbers here are plain ones in SI units, angles in radians: give its size in those, of pint's "
    "quantities .to_base_units().magnitude, of astropy's .si.value"
)


# quantities in lists of at most so many levels are seen: one that contains itself has no last
DEEPEST = 4


def has_unit(value: Any, depth: int = 0) -> bool:
    """Whether a value, or an item of a list or tuple, is a quantity with a unit."""
    kind = type(value)
    if kind in (list, tuple):
        return depth < DEEPEST and any(has_unit(item, depth + 1) for item in value)
    # of the class, for arrays with names (xarray) may have any attribute
    return hasattr(kind, "units") and hasattr(kind, "magnitude") or hasattr(kind, "to_value") and hasattr(kind, "unit")
