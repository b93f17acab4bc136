"""What commands print."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from rbdyn.destinations import PICTURES, require_place
from rbdyn.errors import InvalidInput


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


def require_picture(path: str | None, option: str) -> None:
    """Raises InvalidInput for a file that no picture is written to, before time is spent on it."""
    if path is None:
        return
    if Path(path).suffix.lower() not in PICTURES:
        raise InvalidInput(f"{option} {path}: a picture is written to a file that ends in {', '.join(PICTURES)}")
    require_place(path, option)
