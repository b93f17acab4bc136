"""A run of a System at given times, as arrays and tables."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn import _core
from rbdyn.comma_separated import write_table
from rbdyn.errors import InvalidInput
from rbdyn.sample import times_of
from rbdyn.shown import shown

if TYPE_CHECKING:
    import numpy.typing as npt

    from rbdyn._core import SystemRun


class SystemSample:
    """All variables of a run of a System at times `t` (k,): `x` (k, n), and sample["theta"] or sample[0] (k,)."""

    def __init__(self, run: SystemRun, times: npt.ArrayLike | None = None) -> None:
        if not isinstance(run, _core.SystemRun):
            raise TypeError(
                f"SystemSample: run is {shown(run)}; it is a SystemRun, what simulate() of a System returns"
            )
        self.t: npt.NDArray[np.float64] = np.array(run.t) if times is None else times_of(times, "SystemSample")
        if self.t.ndim != 1:
            raise InvalidInput(f"SystemSample: times has shape {self.t.shape}; give a list of times")
        self.x: npt.NDArray[np.float64] = run.x(self.t)
        self.names = run.names or [f"x[{i}]" for i in range(self.x.shape[1])]
        self.attributes: dict[str, Any] = {
            "engine": run.engine,
            "error": np.nan if run.error is None else run.error,
            "certain_until": run.certain_until,
            "status": run.status,
        }

    def __getitem__(self, variable: str | int) -> npt.NDArray[np.float64]:
        self._require_fit()
        if isinstance(variable, str):
            if variable not in self.names:
                raise InvalidInput(
                    f"SystemSample: there is no variable named {shown(variable)}; there are {', '.join(self.names)}"
                )
            return self.x[:, self.names.index(variable)]
        n = len(self.names)
        if isinstance(variable, (bool, np.bool_)) or not isinstance(variable, (int, np.integer)):
            raise InvalidInput(f"SystemSample: a variable is {shown(variable)}; it is a name or a place, from 0")
        if not -n <= variable < n:
            # an IndexError, which ends iteration
            raise IndexError(
                f"SystemSample: there is no variable at {shown(variable)}; there are {n}: {', '.join(self.names)}"
            )
        return self.x[:, variable]

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"SystemSample: it has no {name!r}; run.sample(times) makes one that is whole")

    def _require_fit(self) -> None:
        """Raises InvalidInput for arrays that were changed, and have no number for each time and variable."""
        shape = (np.size(self.t), len(self.names))
        if np.ndim(self.t) != 1 or not isinstance(self.x, np.ndarray) or self.x.shape != shape:
            has = f"has shape {self.x.shape}" if isinstance(self.x, np.ndarray) else f"is {shown(self.x)}"
            raise InvalidInput(
                f"SystemSample: x {has}; of {shape[0]} times and {shape[1]} variables it is {shape}, one row a time"
            )

    def __repr__(self) -> str:
        return f"<SystemSample: {self.t.size} times, {', '.join(self.names)}>"

    def to_pandas(self) -> Any:
        """A pandas.DataFrame over t, a column a variable; frame.attrs has the engine and the estimated error."""
        import pandas as pd  # type: ignore[import-untyped,unused-ignore]

        self._require_fit()
        frame = pd.DataFrame(self.x, columns=self.names, index=pd.Index(self.t, name="t"))
        frame.attrs = dict(self.attributes)
        return frame

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes a line a time, comma-separated, every number so that it reads back as itself."""
        self._require_fit()
        write_table(path, ["t", *self.names], [self.t, self.x])
