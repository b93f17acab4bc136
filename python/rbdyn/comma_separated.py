"""Tables as comma-separated text, every number so that it reads back as itself."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn.destinations import place_of
from rbdyn.errors import InvalidInput

if TYPE_CHECKING:
    import numpy.typing as npt


def write_table(path: str | os.PathLike[str], names: Sequence[str], columns: Sequence[npt.NDArray[Any]]) -> None:
    """Writes a line of names and a line for each number of the columns, which are of one length."""
    place = place_of(path, "to_csv")
    quoted = ['"' + name.replace('"', '""') + '"' if set(name) & set(',"\n') else name for name in names]
    lines = [",".join(quoted), *(",".join(map(repr, row)) for row in np.column_stack(columns).tolist())]
    try:
        place.write_text("\n".join(lines) + "\n", encoding="utf-8")
    except OSError as problem:
        raise InvalidInput(f"to_csv: {str(path)!r} cannot be written: {problem.strerror}") from None
