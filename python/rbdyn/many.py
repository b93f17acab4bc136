"""Many at once: simulate_many(), and what comes of it."""

from __future__ import annotations

import functools
import os
import pickle
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor, wait
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn import _core
from rbdyn.errors import Error, InvalidInput

if TYPE_CHECKING:
    import numpy.typing as npt

    from rbdyn._core import Handle, Parameter, Scene, Trajectory

# chunks a worker of an executor gets: few enough to be cheap, many enough that all end at about one time
CHUNKS_A_WORKER = 4
# how often an executor's work is looked at [s]
LOOKS = 0.05


def simulate_many(
    scene: Scene,
    vary: Mapping[Any, Any],
    until: float,
    *,
    start: float = 0.0,
    error: float | None = None,
    rtol: float | None = None,
    engine: str = "auto",
    keep: Any = "all",
    max_steps: int = 100_000_000,
    progress: bool | Callable[[float], Any] = False,
    threads: int | None = None,
    executor: Executor | None = None,
) -> Many:
    """Runs a scene many times, each with starts and numbers of its own; each member is what simulate() makes of it.

    vary: a mapping of (handle, word), the words of Scene.add() for its joint, and of parameters, to arrays of n values
    each: (n,), (n, 3), ... What is not varied is as in the scene. threads: how many of this process, one for each
    processor by default; functions in Python that are called back run on one. executor: of concurrent.futures or with
    its interface, instead of them; the members are handed to it in chunks. The other arguments are those of simulate();
    progress: of all members together.

    A member that fails does not stop the others: Many.errors has its exception. The results are the same, bit for bit,
    for any number of threads and any executor; scene and parameters stay as they are. Raises InvalidInput, before
    anything runs, for a start or a number that breaks a rule, and for a scene that cannot be sent to other processes.
    KeyboardInterrupt, and what `progress` raises, arrive with what is done as their `.many`.
    """
    arrays, count = _members(vary)
    if threads is not None and (not isinstance(threads, int) or threads < 1):
        raise InvalidInput(f"simulate_many: threads is {threads!r}; it is positive, or None for one a processor")
    if threads is not None and executor is not None:
        raise InvalidInput("simulate_many: both threads and executor are given; one of them says where members run")
    options = {
        "start": start,
        "error": error,
        "rtol": rtol,
        "engine": engine,
        "keep": keep,
        "max_steps": max_steps,
    }
    if executor is None:
        try:
            runs, errors, raised = _core._sweep(
                scene, arrays, count, until, **options, progress=progress, threads=threads or 0
            )
        except KeyboardInterrupt as interrupt:
            # while starts were read: nothing has begun
            runs, errors, raised = [None] * count, [None] * count, interrupt
    else:
        # what breaks a rule is said before anything is sent
        _core._check_sweep(scene, arrays, count, until, **options)
        runs, errors, raised = _on(executor, scene, arrays, count, until, options, progress)
    many = Many(runs, errors, dict(arrays), float(start), float(until))
    if raised is not None:
        raised.many = many
        raise raised
    return many


def _members(vary: Mapping[Any, Any]) -> tuple[dict[Any, Any], int]:
    """What is varied, as sequences of one length, and that length."""
    if not isinstance(vary, Mapping) or not vary:
        raise InvalidInput(
            f"simulate_many: vary is {vary!r}; it is a mapping of (handle, word) or a parameter to arrays, "
            'as in {(ball, "position"): positions}'
        )
    arrays: dict[Any, Any] = {}
    lengths: dict[int, str] = {}
    for key, given in vary.items():
        name = f'"{key[0].name}" {key[1]}' if isinstance(key, tuple) and hasattr(key[0], "name") else repr(key)
        is_rotation = hasattr(given, "as_quat")  # SciPy's, one or several
        values: Any = given if is_rotation or _are_attitudes(given) else np.asarray(given)
        if given.single if is_rotation else isinstance(values, np.ndarray) and not values.ndim:
            raise InvalidInput(f"simulate_many: {name} has one value; it has one for each member, n in all")
        arrays[key] = values
        lengths.setdefault(len(values), name)
    if len(lengths) > 1:
        text = ", ".join(f"{name} has {length}" for length, name in lengths.items())
        raise InvalidInput(f"simulate_many: the numbers of members differ: {text}; arrays have one first length")
    return arrays, next(iter(lengths))


def _are_attitudes(values: Any) -> bool:
    """Whether they are a list of attitudes that are no arrays."""
    return isinstance(values, Sequence) and any(
        isinstance(value, _core.EulerAngles) or hasattr(value, "as_quat") for value in values
    )


# --- through an executor ---


class _Sweep:
    """What all chunks share, in this process or as it arrives in another one."""

    def __init__(self, scene: Scene, keys: list[Any], until: float, options: dict[str, Any]) -> None:
        self.scene, self.keys, self.until, self.options = scene, keys, until, options

    def run(self, values: list[Any], go_on: Callable[[float], Any]) -> tuple[list[Any], list[Any], Any]:
        vary = dict(zip(self.keys, values, strict=True))
        return _core._sweep(self.scene, vary, len(values[0]), self.until, **self.options, progress=go_on, threads=1)


class _Stopped(Exception):
    """Nobody waits for the rest."""


@functools.lru_cache(maxsize=4)
def _arrived(payload: bytes) -> _Sweep:
    """A sweep in another process; kept, for its scene keeps the plans that its members are run by."""
    sweep: _Sweep = pickle.loads(payload)
    return sweep


def _chunk(payload: bytes, values: list[Any]) -> tuple[list[Any], list[Any]]:
    """Some members in another process: their runs as data without their scenes, and what went wrong."""
    sweep = _arrived(payload)
    runs, errors, raised = sweep.run(values, lambda fraction: None)
    if raised is not None:
        raise raised
    return [None if run is None else _core._bytes_of(run) for run in runs], [_plain(error) for error in errors]


def _plain(error: Any) -> Any:
    """An error without its run, which travels by itself."""
    if error is not None:
        vars(error).pop("run", None)
    return error


def _cut(arrays: dict[Any, Any], first: int, last: int) -> list[Any]:
    return [values[first:last] for values in arrays.values()]


def _on(
    executor: Executor,
    scene: Scene,
    arrays: dict[Any, Any],
    count: int,
    until: float,
    options: dict[str, Any],
    progress: bool | Callable[[float], Any],
) -> tuple[list[Any], list[Any], Any]:
    """The members, in chunks through an executor: runs, errors, and what interrupted them."""
    workers = getattr(executor, "_max_workers", None) or os.cpu_count() or 1
    size = max(1, -(-count // (CHUNKS_A_WORKER * workers)))
    places = [(first, min(first + size, count)) for first in range(0, count, size)]
    sweep = _Sweep(scene, list(arrays), until, options)
    stopped = threading.Event()

    def go_on(fraction: float) -> None:
        if stopped.is_set():
            raise _Stopped

    here = isinstance(executor, ThreadPoolExecutor)
    if not here:
        payload = _sent(sweep)
    futures: dict[Any, tuple[int, int]] = {}
    runs: list[Any] = [None] * count
    errors: list[Any] = [None] * count
    raised: Any = None

    def take(future: Future[Any]) -> None:
        first, last = futures[future]
        done = future.result()
        runs[first:last], errors[first:last] = done[0], done[1]
        if not here:
            again = _core._runs_from(scene, dict(zip(arrays, _cut(arrays, first, last), strict=True)), done[0])
            runs[first:last] = again
            for error, run in zip(errors[first:last], again, strict=True):
                if error is not None and run is not None:
                    error.run = run

    bar = _bar(progress)
    try:
        for first, last in places:
            values = _cut(arrays, first, last)
            future = executor.submit(sweep.run, values, go_on) if here else executor.submit(_chunk, payload, values)
            futures[future] = (first, last)
        waiting = set(futures)
        while waiting:
            ended, waiting = wait(waiting, timeout=LOOKS)
            for future in ended:
                take(future)
            if bar is not None:
                bar(1.0 - sum(futures[f][1] - futures[f][0] for f in waiting) / max(count, 1))
    except BaseException as exception:
        raised = exception
        stopped.set()
        for future in futures:
            future.cancel()
        # chunks of this process stop and hand back what they have
        if here:
            for future in wait([f for f in futures if not f.cancelled()]).done:
                if future.exception() is None:
                    take(future)
    finally:
        if bar is not None and hasattr(bar, "close"):
            bar.close()
    return runs, errors, raised


def _bar(progress: bool | Callable[[float], Any]) -> Any:
    if progress is True:
        from rbdyn.progress import Bar

        return Bar()
    return progress if callable(progress) else None


def _sent(sweep: _Sweep) -> bytes:
    try:
        return pickle.dumps(sweep)
    except (TypeError, AttributeError, pickle.PicklingError, Error) as reason:
        raise InvalidInput(
            f"simulate_many: this scene cannot be sent to another process: {reason}; use threads=, or a "
            "ThreadPoolExecutor, or write the function so that it can be recorded"
        ) from reason


# --- results ---


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
        """What was varied: the mapping that simulate_many() was given, its values as arrays."""
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
            raise AttributeError(name)
        return self._over(name, lambda run: run)

    def __dir__(self) -> list[str]:
        some = next((run for run in self._runs if run is not None), None)
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
        names = [f"{key[0].name} {key[1]}" if isinstance(key, tuple) else repr(key) for key in self._vary]
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
