"""Quantities with a unit, of pint, astropy, unyt and others: refused, for NumPy drops the unit without a word."""

from __future__ import annotations

from typing import Any

RULE = (
    "it has a unit, and numbers here are plain ones in SI units, angles in radians: give its size in those, of pint's "
    "quantities .to_base_units().magnitude, of astropy's .si.value"
)


def has_unit(value: Any) -> bool:
    """Whether a value, or an item of a list or tuple, is a quantity with a unit."""
    kind = type(value)
    if kind in (list, tuple):
        return any(has_unit(item) for item in value)
    # of the class, for arrays with names (xarray) may have any attribute
    return hasattr(kind, "units") and hasattr(kind, "magnitude") or hasattr(kind, "to_value") and hasattr(kind, "unit")
