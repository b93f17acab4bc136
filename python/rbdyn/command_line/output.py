"""What commands print."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np


def as_json(value: Any) -> str:
    """JSON, with null for what is not finite."""
    return json.dumps(_plain(value), indent=2, allow_nan=False)


def fields(thing: Any, names: tuple[str, ...]) -> dict[str, Any]:
    """Attributes by name."""
    return {name: getattr(thing, name) for name in names}


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _plain(one) for key, one in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
