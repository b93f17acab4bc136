"""What comes of a sweep: many runs, and what they have in common as arrays over them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping
from types import NoneType
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from rbdyn import _core
from rbdyn.errors import Error, InvalidInput
from rbdyn.shown import shown

if TYPE_CHECKING:
    import numpy.typing as npt

    from rbdyn._core import BodyPoint, Handle, Parameter, Trajectory


def _stacked(values: list[Any]) -> Any:
    """Values of all members as one array if they are numbers of one shape (nan where there are none), else a list."""
    there = [np.asarray(v) for v in values if v is not None]
    if not there or any(a.dtype.kind not in "fiu" or a.shape != there[0].shape for a in there):
        return values
    return np.array([np.full(there[0].shape, np.nan) if v is None else v for v in values])


class Many:
    """What simulate_many() came to: a sequence of runs, and what they have in common as arrays over the members.

    many[i] is the run of member i; it raises what simulate() would have raised. many.runs has all of them, also partial
    ones. many[handle], and many["ball"], is their motion: what run[handle] has, with one more dimension before the
    others, as in many[ball].position(t): (n, 3), or (n, m, 3) for m times. What a run has is an array or a list over
    the members, too: many.status, many.error, many.end, many.engine, many.energy(t). Beyond the end of a member that
    ended before the others its quantities are nan.
    """

    def __init__(self, runs: list[Any], errors: list[Any], vary: dict[Any, Any], start: float, until: float) -> None:
        if not isinstance(runs, list) or not all(isinstance(run, (_core.Trajectory, NoneType)) for run in runs):
            raise TypeError(f"Many: runs is {shown(runs)}; it is a list of runs, or None for one that did not begin")
        if not isinstance(errors, list) or not all(isinstance(error, (BaseException, NoneType)) for error in errors):
            raise TypeError(
                f"Many: errors is {shown(errors)}; it is a list of exceptions, or None where nothing failed"
            )
        if len(errors) != len(runs):
            raise InvalidInput(f"Many: errors has {len(errors)} members and runs {len(runs)}; give one for each run")
        if not isinstance(vary, Mapping):
            raise TypeError(f"Many: vary is {shown(vary)}; it is the mapping that simulate_many() takes")
        self._runs, self._errors, self._vary = runs, errors, vary
        self._start, self._until = start, until

    @property
    def runs(self) -> list[Trajectory | None]:
        """The runs, whole or partial; None of a member that did not begin."""
        return list(self._runs)

    @property
    def errors(self) -> list[BaseException | None]:
        """What went wrong with each member, as simulate() would have raised it; None where nothing did."""
        return list(self._errors)

    @property
    def failed(self) -> npt.NDArray[np.intp]:
        """The numbers of the members that something went wrong with, or that did not begin."""
        return np.array(
            [i for i, run in enumerate(self._runs) if run is None or self._errors[i] is not None], dtype=np.intp
        )

    @property
    def vary(self) -> dict[tuple[Handle, str] | Parameter, Any]:
        """What was varied: the mapping that simulate_many() was given, with handles for names, its values as arrays."""
        return dict(self._vary)

    @property
    def status(self) -> list[str]:
        """Of each member: a status of a run, "refused" if it broke a rule as it started, "not begun"."""
        return [
            run.status if run is not None else "refused" if error is not None else "not begun"
            for run, error in zip(self._runs, self._errors, strict=True)
        ]

    @property
    def error(self) -> npt.NDArray[np.float64]:
        """Estimated global errors (n,); nan with rtol, and of a member that did not begin."""
        errors = [None if run is None else run.error for run in self._runs]
        return np.array([np.nan if error is None else error for error in errors])

    @property
    def end(self) -> npt.NDArray[np.float64]:
        """Where they ended (n,) [s]; nan of a member that did not begin."""
        return np.array([np.nan if run is None else run.end for run in self._runs])

    def __len__(self) -> int:
        return len(self._runs)

    def __iter__(self) -> Iterator[Trajectory]:
        return (self[i] for i in range(len(self)))

    @overload
    def __getitem__(self, key: int) -> Trajectory: ...
    @overload
    def __getitem__(self, key: Handle | BodyPoint | str) -> Any: ...
    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, (int, np.integer)):
            n = len(self)
            if not -n <= key < n:
                raise IndexError(f"Many: there are {n} members")
            if self._errors[key] is not None:
                raise self._errors[key]
            if self._runs[key] is None:
                raise Error(f"Many: member {key} was not begun, for all were stopped before")
            return self._runs[key]
        return _Quantities(self, lambda run: run[key])

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(f"Many: it has no {name!r}; simulate_many() makes one that is whole")
        return self._over(name, lambda run: run)

    def __dir__(self) -> list[str]:
        # also of one that __new__ made, which has none
        some = next((run for run in vars(self).get("_runs", []) if run is not None), None)
        return sorted({*super().__dir__(), *(n for n in dir(some) if not n.startswith("_"))})

    def _over(self, name: str, part: Callable[[Any], Any]) -> Any:
        """What parts of all runs have by a name: their values, or a method that gives those of all."""
        known = [None if run is None else part(run) for run in self._runs]
        some = next((p for p in known if p is not None), None)
        if some is None:
            raise Error("Many: no member has a run; Many.errors says why")
        if not callable(getattr(some, name)):
            return _stacked([None if p is None else getattr(p, name) for p in known])

        @functools.wraps(getattr(some, name))
        def of_all(*args: Any, **kwargs: Any) -> Any:
            results = [
                None if p is None else self._at(run, getattr(p, name), args, kwargs)
                for run, p in zip(self._runs, known, strict=True)
            ]
            first = next((r for r in results if r is not None), None)
            if isinstance(first, tuple):
                parts = [_stacked([None if r is None else r[k] for r in results]) for k in range(len(first))]
                return _like(first, parts)
            return _stacked(results)

        return of_all

    def _at(self, run: Any, method: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
        """A quantity of one member; nan at times that it did not come to."""
        try:
            return method(*args, **kwargs)
        except InvalidInput:
            if run.end >= self._until:
                raise
        t = kwargs["t"] if "t" in kwargs else args[0] if args else None
        times = np.asarray(t, dtype=float)
        beyond = (times > run.end) & (times <= self._until)
        if not times.ndim or not beyond.any():
            return None
        within = np.where(beyond, run.end, times)
        there = method(**{**kwargs, "t": within}) if "t" in kwargs else method(within, *args[1:], **kwargs)
        if isinstance(there, tuple):
            parts = [_without(part, beyond) for part in there]
            return _like(there, parts)
        return _without(there, beyond)

    def to_xarray(self, times: npt.ArrayLike) -> Any:
        """An xarray.Dataset over member and t, of all quantities of all bodies and couplings at times (m,) [s].

        Variables are named "name.quantity"; what was varied is there, too, as are status and error. Raises ImportError
        if xarray is missing.
        """
        try:
            import xarray as xr  # type: ignore[import-not-found,unused-ignore]
        except ImportError as missing:
            raise ImportError("Many.to_xarray needs xarray: pip install xarray") from missing
        from rbdyn.sample import AXES, axes_of

        t = np.atleast_1d(np.asarray(times, dtype=float))
        some = next((run for run in self._runs if run is not None), None)
        if some is None:
            raise Error("Many: no member has a run; Many.errors says why")
        variables: dict[str, Any] = {"status": ("member", self.status), "error": ("member", self.error)}
        for handle in [*some.bodies, *some.couplings]:
            for quantity in some[handle].quantities:
                value: Any = getattr(self[handle], quantity)(t)
                for field, array in _fields(value).items():
                    name = f"{handle.name}.{quantity}" + (f".{field}" if field else "")
                    variables[name] = (("member", "t", *axes_of(quantity, array[0])), array)
        for key, values in self._vary.items():
            if isinstance(values, np.ndarray) and values.ndim <= 2:
                name = f"vary {key[0].name}.{key[1]}" if isinstance(key, tuple) else f"vary {key.name or 'parameter'}"
                axes = ("component",) if values.ndim == 2 and values.shape[1] == 3 else (f"{name} component",)
                variables[name] = (("member", *axes[: values.ndim - 1]), values)
        used = {dimension for dimensions, _ in variables.values() for dimension in np.atleast_1d(dimensions)}
        return xr.Dataset(variables, {"t": t, **{axis: AXES[axis] for axis in AXES if axis in used}})

    def __repr__(self) -> str:
        return f"<Many: {len(self)} members, {len(self.failed)} failed>"

    def __str__(self) -> str:
        count: dict[str, int] = {}
        for status in self.status:
            count[status] = count.get(status, 0) + 1
        lines = [f"Many: {len(self)} members: " + ", ".join(f"{n} {status}" for status, n in count.items())]
        names = [f"{key[0].name} {key[1]}" if isinstance(key, tuple) else shown(key) for key in self._vary]
        lines.append("  varied " + ", ".join(names))
        if len(self.failed) < len(self):
            good = np.delete(self.error, self.failed)
            if np.isfinite(good).any():
                lines.append(f"  largest estimated global error of those that did not fail {np.nanmax(good):.2g}")
        for i in self.failed[:3]:
            if self._errors[i] is not None:
                lines.append(f"  member {i}: {self._errors[i]}")
        if len(self.failed) > 3:
            lines.append(f"  and {len(self.failed) - 3} more that failed: Many.failed, Many.errors")
        return "\n".join(lines)


class _Quantities:
    """The quantities of one body, coupling, constraint, contact or watch in all members: many[handle]."""

    def __init__(self, many: Many, part: Callable[[Any], Any]) -> None:
        self._many, self._part = many, part
        some = next((run for run in many.runs if run is not None), None)
        self._some = part(some) if some is not None else None  # raises what a run raises for what it does not have

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name == "quantities" and self._some is not None:
            return self._some.quantities
        return self._many._over(name, self._part)

    def __dir__(self) -> list[str]:
        return [name for name in dir(self._some) if not name.startswith("_")]

    def __repr__(self) -> str:
        return f"<Many: {len(self._many)} of {self._some!r}>"


def _like(one: Any, parts: list[Any]) -> Any:
    """A tuple of parts, or a named one as `one` is."""
    kind: Any = type(one)
    return kind(*parts) if hasattr(one, "_fields") else tuple(parts)


def _fields(value: Any) -> dict[str, Any]:
    """The fields of a named tuple by name; of anything else itself, without one."""
    return value._asdict() if hasattr(value, "_asdict") else {"": value}


def _without(values: Any, beyond: npt.NDArray[np.bool_]) -> Any:
    """A quantity at times with nan, or None in place of a word, where `beyond`."""
    result = np.array(values)
    if result.dtype.kind != "f":
        result = result.astype(object)
    result[beyond] = np.nan if result.dtype.kind == "f" else None
    return result
