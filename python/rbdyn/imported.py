"""Functions that another process finds by their names, or has the parts of."""

from __future__ import annotations

import io
import pickle
from typing import Any


class _Looking(pickle.Pickler):
    """Refuses functions of the program itself, which only its own processes find."""

    def reducer_override(self, thing: Any) -> Any:
        if getattr(thing, "__module__", None) == "__main__" and isinstance(getattr(thing, "__qualname__", None), str):
            raise pickle.PicklingError(f"{thing.__qualname__} is of the program itself")
        return NotImplemented


def can_be(action: Any, in_program: bool) -> bool:
    """Whether an action is found elsewhere, as pickle finds it: in modules, or in the program itself, too."""
    try:
        (pickle.Pickler if in_program else _Looking)(io.BytesIO()).dump(action)
    except Exception:
        return False
    return True
