"""A run of a System at given times, as arrays and tables."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn import _core
from rbdyn.destinations import place_of
from rbdyn.errors import InvalidInput
from rbdyn.sample import times_of

if TYPE_CHECKING:
    import numpy.typing as npt

    from rbdyn._core import SystemRun


class SystemSample:
    """All variables of a run of a System at times `t` (k,): `x` (k, n), and sample["theta"] or sample[0] (k,)."""

    def __init__(self, run: SystemRun, times: npt.ArrayLike | None = None) -> None:
        if not isinstance(run, _core.SystemRun):
            raise TypeError(f"SystemSample: run is {run!r}; it is a SystemRun, what simulate() of a System returns")
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
        if isinstance(variable, str):
            if variable not in self.names:
                raise InvalidInput(f'SystemSample: there is no variable named "{variable}"; there are {self.names}')
            variable = self.names.index(variable)
        return self.x[:, variable]

    def __repr__(self) -> str:
        return f"<SystemSample: {self.t.size} times, {', '.join(self.names)}>"

    def to_pandas(self) -> Any:
        """A pandas.DataFrame over t, a column a variable; frame.attrs has the engine and the estimated error."""
        import pandas as pd  # type: ignore[import-untyped,unused-ignore]

        frame = pd.DataFrame(self.x, columns=self.names, index=pd.Index(self.t, name="t"))
        frame.attrs = dict(self.attributes)
        return frame

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes a line a time, comma-separated, every number so that it reads back as itself."""
        quoted = [f'"{n.replace(chr(34), chr(34) * 2)}"' if set(n) & set(',"\n') else n for n in ["t", *self.names]]
        lines = [",".join(quoted), *(",".join(map(repr, row)) for row in np.column_stack([self.t, self.x]).tolist())]
        try:
            place_of(path, "to_csv").write_text("\n".join(lines) + "\n")
        except OSError as problem:
            raise InvalidInput(f"to_csv: {str(path)!r} cannot be written: {problem.strerror}") from None
