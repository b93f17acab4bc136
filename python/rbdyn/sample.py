"""A run at given times, as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from rbdyn._core import Handle, Trajectory

# dimensions of arrays, and the names along them; of a matrix: rows, columns
AXES = {
    "component": ["x", "y", "z"],
    "body_axis": ["e1", "e2", "e3"],
    "frenet": ["tangent", "normal", "binormal"],
    "quaternion": ["w", "x", "y", "z"],
    "euler": ["theta", "psi", "phi"],
}


class Sample:
    """All quantities of all bodies and springs of a run at times `t` (n,) [s].

    sample[handle] is a dict: names of quantities to arrays, (n,) for scalars, (n, 3) for vectors, (n, 4) for
    quaternions and (n, 3, 3) for matrices. Of a named tuple each field is an entry: "instantaneous_axis.point".
    """

    def __init__(self, run: Trajectory, times: npt.ArrayLike) -> None:
        given = np.array(times)
        if given.dtype == object:
            from rbdyn.errors import InvalidInput

            raise InvalidInput(f"Sample: times is {times!r}; give numbers, of a parameter its .value")
        self.t: npt.NDArray[np.float64] = np.atleast_1d(given.astype(float))
        self._values: dict[Handle, dict[str, npt.NDArray[np.float64]]] = {}
        motions: dict[Handle, Any] = {body: run[body] for body in run.bodies}
        motions |= {coupling: run[coupling] for coupling in run.couplings}
        for handle, motion in motions.items():
            values: dict[str, npt.NDArray[np.float64]] = {}
            self._values[handle] = values
            for name in motion.quantities:
                value: Any = getattr(motion, name)(self.t)
                if isinstance(value, tuple):
                    fields: Any = type(value)._fields  # type: ignore[attr-defined]
                    values |= {f"{name}.{field}": part for field, part in zip(fields, value, strict=True)}
                else:
                    values[name] = value

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
        import pandas as pd  # type: ignore[import-untyped,unused-ignore]

        columns: dict[tuple[str, str, str], npt.NDArray[np.float64]] = {}
        for handle, values in self._values.items():
            for quantity, array in values.items():
                labels = [AXES[axis] for axis in axes_of(quantity, array)]
                for index in np.ndindex(*array.shape[1:]):
                    component = " ".join(label[i] for label, i in zip(labels, index, strict=True))
                    columns[handle.name, quantity, component] = array[(slice(None), *index)]
        frame = pd.DataFrame(columns, index=pd.Index(self.t, name="t"))
        frame.columns.names = ["name", "quantity", "component"]
        return frame

    def to_xarray(self) -> Any:
        """An xarray.Dataset over t; variables "name.quantity", along the dimensions of AXES."""
        import xarray as xr  # type: ignore[import-not-found,unused-ignore]

        variables = {
            f"{handle.name}.{quantity}": (("t", *axes_of(quantity, array)), array)
            for handle, values in self._values.items()
            for quantity, array in values.items()
        }
        used = {dimension for dimensions, _ in variables.values() for dimension in dimensions}
        return xr.Dataset(variables, {"t": self.t, **{axis: AXES[axis] for axis in AXES if axis in used}})


def axes_of(quantity: str, array: npt.NDArray[np.float64]) -> tuple[str, ...]:
    """What an array runs along, after time."""
    if array.ndim == 3:
        return ("component", "body_axis")
    if array.ndim == 1:
        return ()
    if quantity == "quaternion":
        return ("quaternion",)
    if quantity in ("euler_angles", "euler_rates"):
        return ("euler",)
    return ("frenet",) if quantity.endswith("_frenet") else ("component",)
