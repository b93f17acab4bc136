"""Values in messages: short, in letters that every terminal takes, also of what raises when it is looked at."""

from __future__ import annotations

import reprlib
from typing import Any

_repr = reprlib.Repr()
_repr.maxstring = _repr.maxother = 60


def shown(value: Any) -> str:
    """repr(value), shortened; the name of its class where that raises."""
    try:
        text = _repr.repr(value)
    except Exception:
        text = f"a {type(value).__name__}"
    return text.encode("utf-8", "backslashreplace").decode().replace("\0", "\\x00")
