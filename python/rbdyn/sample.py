"""A run at given times, as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from rbdyn._core import Handle, Trajectory


class Sample:
    """All quantities of all bodies and springs of a run at times `t` (n,) [s].

    sample[handle] is a dict: names of quantities to arrays, (n,) for scalars and (n, 3) for vectors, world axes.
    """

    def __init__(self, run: Trajectory, times: npt.ArrayLike) -> None:
        self.t: npt.NDArray[np.float64] = np.atleast_1d(np.array(times, dtype=float))
        self._values: dict[Handle, dict[str, npt.NDArray[np.float64]]] = {}
        motions: dict[Handle, Any] = {body: run[body] for body in run.bodies}
        motions |= {coupling: run[coupling] for coupling in run.couplings}
        for handle, motion in motions.items():
            self._values[handle] = {name: getattr(motion, name)(self.t) for name in motion.quantities}

    def __getitem__(self, handle: Handle) -> dict[str, npt.NDArray[np.float64]]:
        try:
            return self._values[handle]
        except KeyError:
            from rbdyn.errors import InvalidInput

            raise InvalidInput(
                f'Sample: "{getattr(handle, "name", handle)}" is no body or coupling of this run; '
                "use what add() or connect() of its scene returned"
            ) from None

    def __repr__(self) -> str:
        return f"<Sample: {self.t.size} times, {', '.join(handle.name for handle in self._values)}>"

    def to_pandas(self) -> Any:
        """A pandas.DataFrame over t; columns (name, quantity, component), component "" for scalars."""
        import pandas as pd

        columns: dict[tuple[str, str, str], npt.NDArray[np.float64]] = {}
        for handle, values in self._values.items():
            for quantity, array in values.items():
                if array.ndim == 1:
                    columns[handle.name, quantity, ""] = array
                else:
                    parts = _components(quantity)
                    columns.update({(handle.name, quantity, part): array[:, i] for i, part in enumerate(parts)})
        frame = pd.DataFrame(columns, index=pd.Index(self.t, name="t"))
        frame.columns.names = ["name", "quantity", "component"]
        return frame

    def to_xarray(self) -> Any:
        """An xarray.Dataset over t; variables "name.quantity", vectors along "component" or "frenet" too."""
        import xarray as xr

        variables = {}
        for handle, values in self._values.items():
            for quantity, array in values.items():
                along = "frenet" if quantity.endswith("_frenet") else "component"
                variables[f"{handle.name}.{quantity}"] = (("t",) if array.ndim == 1 else ("t", along), array)
        axes = {"component": _components(""), "frenet": _components("_frenet")}
        used = {dimension for dimensions, _ in variables.values() for dimension in dimensions}
        return xr.Dataset(variables, {"t": self.t, **{axis: parts for axis, parts in axes.items() if axis in used}})


def _components(quantity: str) -> list[str]:
    return ["tangent", "normal", "binormal"] if quantity.endswith("_frenet") else ["x", "y", "z"]
