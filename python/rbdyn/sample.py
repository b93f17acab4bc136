"""A run at given times, as arrays and tables, each with its units."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn import _core
from rbdyn.comma_separated import write_table
from rbdyn.errors import InvalidInput
from rbdyn.shown import shown

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
    "angle": ["first", "second"],
}

# of each quantity the unit, and the axes that its components are along
QUANTITIES = {
    "position": ("m", "world"),
    "velocity": ("m/s", "world"),
    "acceleration": ("m/s^2", "world"),
    "force": ("N", "world"),
    "parameter": ("", ""),
    "arc_length": ("m", ""),
    "speed": ("m/s", ""),
    "tangential_force": ("N", ""),
    "reaction": ("N", "world"),
    "reaction_frenet": ("N", "frenet"),
    "reaction_torque": ("N m", "world"),
    "center_of_mass": ("m", "world"),
    "center_of_mass_velocity": ("m/s", "world"),
    "center_of_mass_acceleration": ("m/s^2", "world"),
    "quaternion": ("1", "body to world"),
    "rotation_matrix": ("1", "body to world"),
    "euler_angles": ("rad", "body to world"),
    "euler_rates": ("rad/s", "body to world"),
    "angular_velocity": ("rad/s", "body"),
    "angular_velocity_world": ("rad/s", "world"),
    "angular_acceleration": ("rad/s^2", "body"),
    "poisson_vector": ("1", "body"),
    "instantaneous_axis.point": ("m", "world"),
    "instantaneous_axis.direction": ("1", "world"),
    "angle": ("rad", ""),
    "angles": ("rad", ""),
    "rates": ("rad/s", ""),
    "displacement": ("m", ""),
    "displacement_rate": ("m/s", ""),
    "length": ("m", ""),
    "gap": ("m", ""),
    "slip": ("m/s", "world"),
    "torque": ("N m", "world"),
}


class Sample:
    """All quantities of all bodies and couplings of a run at times `t` (n,) [s].

    sample[handle] is a dict: names of quantities to arrays, (n,) for scalars, (n, 3) for vectors, (n, 4) for
    quaternions and (n, 3, 3) for matrices. Of a named tuple each field is an entry: "instantaneous_axis.point".
    """

    def __init__(self, run: Trajectory, times: npt.ArrayLike | None = None) -> None:
        if not isinstance(run, _core.Trajectory):
            raise TypeError(f"Sample: run is {shown(run)}; it is a Trajectory, what simulate() of a Scene returns")
        self.t: npt.NDArray[np.float64] = np.array(run.t) if times is None else times_of(times, "Sample")
        self.attributes: dict[str, Any] = {
            "engine": run.engine,
            "error": np.nan if run.error is None else run.error,
            "certain_until": run.certain_until,
            "status": run.status,
        }
        self._values: dict[Handle, dict[str, npt.NDArray[np.float64]]] = {}
        motions: dict[Handle, Any] = {body: run[body] for body in run.bodies}
        motions |= {coupling: run[coupling] for coupling in run.couplings}
        self._slides = {handle for handle, motion in motions.items() if "displacement" in motion.quantities}
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
        values = self._values.get(handle) if isinstance(handle, _core.Handle) else None
        if values is None:
            said = f'"{handle.name}"' if isinstance(handle, _core.Handle) else shown(handle)
            raise InvalidInput(
                f"Sample: {said} is no body or coupling of this run; use what add() or connect() of its scene returned"
            )
        return values

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"Sample: it has no {name!r}; run.sample(times) makes one that is whole")

    def __repr__(self) -> str:
        return f"<Sample: {self.t.size} times, {', '.join(handle.name for handle in self._values)}>"

    def unit(self, handle: Handle, quantity: str) -> str:
        """Of a quantity of a body or coupling: "m/s"; "1" for what has none, "" where it is the curve's own."""
        values = self[handle]
        if not isinstance(quantity, str) or quantity not in values:
            raise InvalidInput(
                f"Sample.unit: {handle.name} has no quantity {shown(quantity)}; it has {', '.join(values)}"
            )
        if quantity == "rate":
            # of an angle, or of the displacement of a slide
            return "m/s" if handle in self._slides and "angle" not in values else "rad/s"
        return QUANTITIES[quantity][0]

    def to_pandas(self) -> Any:
        """A pandas.DataFrame over t; columns (name, quantity, component), component "" for scalars.

        frame.attrs has the engine, the estimated error of the run and, by name and quantity, units.
        """
        import pandas as pd  # type: ignore[import-untyped,unused-ignore]

        columns = {(name, quantity, component): array for name, quantity, component, array in self._columns()}
        frame = pd.DataFrame(columns, index=pd.Index(self.t, name="t"))
        frame.columns.names = ["name", "quantity", "component"]
        units = {
            f"{handle.name}.{quantity}": self.unit(handle, quantity)
            for handle, values in self._values.items()
            for quantity in values
        }
        frame.attrs = {**self.attributes, "t": "s", "units": units}
        return frame

    def to_xarray(self) -> Any:
        """An xarray.Dataset over t; variables "name.quantity", along the dimensions of AXES.

        Attributes of each: units, and frame, the axes its components are along; of the dataset: engine, error.
        """
        import xarray as xr  # type: ignore[import-not-found,unused-ignore]

        self._require_fit()
        variables = {}
        for handle, values in self._values.items():
            for quantity, array in values.items():
                attributes = {"units": self.unit(handle, quantity)}
                if frame := QUANTITIES.get(quantity, ("", ""))[1]:
                    attributes["frame"] = frame
                variables[f"{handle.name}.{quantity}"] = (("t", *axes_of(quantity, array)), array, attributes)
        used = {dimension for variable in variables.values() for dimension in variable[0]}
        coordinates = {"t": ("t", self.t, {"units": "s"}), **{axis: AXES[axis] for axis in AXES if axis in used}}
        return xr.Dataset(variables, coordinates, self.attributes)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes a line a time, comma-separated, every number so that it reads back as itself.

        The first line names the columns, "name.quantity.component [unit]". Raises InvalidInput where the system
        refuses.
        """
        units = {(handle.name, q): self.unit(handle, q) for handle, values in self._values.items() for q in values}
        columns = self._columns()
        names, arrays = ["t [s]"], [self.t]
        for name, quantity, component, array in columns:
            unit = units[name, quantity]
            names.append(f"{name}.{quantity}{'.' if component else ''}{component}{f' [{unit}]' if unit else ''}")
            arrays.append(array)
        write_table(path, names, arrays)

    def _columns(self) -> list[tuple[str, str, str, npt.NDArray[np.float64]]]:
        """Name, quantity, component and values, number by number. Raises InvalidInput where arrays do not fit."""
        self._require_fit()
        columns = []
        for handle, values in self._values.items():
            for quantity, array in values.items():
                labels = [AXES[axis] for axis in axes_of(quantity, array)]
                for index in np.ndindex(*array.shape[1:]):
                    component = " ".join(label[i] for label, i in zip(labels, index, strict=True))
                    columns.append((handle.name, quantity, component, array[(slice(None), *index)]))
        return columns

    def _require_fit(self) -> None:
        """Raises InvalidInput for arrays that were changed, and have no row for each time or other components."""
        if not isinstance(self.t, np.ndarray) or self.t.ndim != 1:
            raise InvalidInput(f"Sample: t is {shown(self.t)}; it is an array of times, (n,)")
        for handle, values in self._values.items():
            for quantity, array in values.items():
                name, n = f"{handle.name}.{quantity}", self.t.size
                if not isinstance(array, np.ndarray) or array.ndim not in (1, 2, 3):
                    raise InvalidInput(f"Sample: {name} is {shown(array)}; it is an array with a row for each time")
                shape = (n, *(len(AXES[axis]) for axis in axes_of(quantity, array)))
                if array.shape != shape:
                    raise InvalidInput(
                        f"Sample: {name} has shape {array.shape}; of {n} times it is {shape}, one row for each"
                    )


def times_of(times: npt.ArrayLike, user: str) -> npt.NDArray[np.float64]:
    """Times that were given, (n,). Raises InvalidInput for what are no numbers."""
    try:
        given = np.array(times)
    except ValueError:  # lists of several lengths
        given = np.array(None)
    if given.dtype.kind not in "biuf":
        raise InvalidInput(f"{user}: times is {shown(times)}; give numbers, of a parameter its .value")
    return np.atleast_1d(given.astype(float, copy=False))


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
    if array.shape[1] == 2:
        return ("angle",)
    return ("frenet",) if quantity.endswith("_frenet") else ("component",)
