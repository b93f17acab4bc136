"""simulate_many(): a scene for many starts and numbers, on threads or through an executor."""

from __future__ import annotations

import functools
import os
import pickle
import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor, wait
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn import _core
from rbdyn.errors import Error, InvalidInput
from rbdyn.many import Many
from rbdyn.shown import shown

if TYPE_CHECKING:
    from rbdyn._core import Scene

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
    lanes: bool = True,
    events: str = "all",
) -> Many:
    """Runs a scene many times, each with starts and numbers of its own; each member is what simulate() makes of it.

    vary: a mapping of (handle, word) or (name, word), the words of Scene.add() for its joint, and of parameters, to
    arrays of n values each: (n,), (n, 3), ... What is not varied is as in the scene. threads: how many of this process,
    one for each processor by default; functions in Python that are called back run on one. executor: of
    concurrent.futures or with its interface, instead of them; the members are handed to it in chunks. The other
    arguments are those of simulate(); progress: of all members together; events: "all" or "last", no function. lanes:
    whether members go side by side through a processor that computes several numbers at once; that changes how long
    they take, and no bit of them.

    A member that fails does not stop the others: Many.errors has its exception. The results are the same, bit for bit,
    for any number of threads and any executor; scene and parameters stay as they are. Raises InvalidInput, before
    anything runs, for a start or a number that breaks a rule, and for a scene that cannot be sent to other processes.
    KeyboardInterrupt, and what `progress` raises, arrive with what is done as their `.many`.
    """
    if not isinstance(scene, _core.Scene):
        raise TypeError(f"simulate_many: scene is {shown(scene)}; it is a Scene")
    arrays, count = _members(scene, vary)
    if threads is not None and (not isinstance(threads, int) or threads < 1):
        raise InvalidInput(f"simulate_many: threads is {shown(threads)}; it is positive, or None for one a processor")
    if threads is not None and executor is not None:
        raise InvalidInput("simulate_many: both threads and executor are given; one of them says where members run")
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise InvalidInput(
            f"simulate_many: executor is {shown(executor)}; it is one of concurrent.futures, as "
            "in ProcessPoolExecutor(4), or what else has its submit()"
        )
    options = {
        "start": start,
        "error": error,
        "rtol": rtol,
        "engine": engine,
        "keep": keep,
        "max_steps": max_steps,
        "events": events,
    }
    if not isinstance(events, str):
        raise InvalidInput(
            f'simulate_many: events is {shown(events)}; it is "all" or "last": members run at once, in no order that a '
            "function could be called in; Many.events has those of each"
        )
    if not isinstance(lanes, bool):
        raise InvalidInput(f"simulate_many: lanes is {shown(lanes)}; it is True or False")
    if executor is None:
        try:
            runs, errors, raised = _core._sweep(
                scene, arrays, count, until, **options, progress=progress, threads=threads or 0, lanes=lanes
            )
        except KeyboardInterrupt as interrupt:
            # while starts were read: nothing has begun
            runs, errors, raised = [None] * count, [None] * count, interrupt
    else:
        # what breaks a rule is said before anything is sent
        _core._check_sweep(scene, arrays, count, until, **options)
        runs, errors, raised = _on(executor, scene, arrays, count, until, options, progress, lanes)
    many = Many(runs, errors, dict(arrays), float(start), float(until))
    if raised is not None:
        raised.many = many
        raise raised
    return many


def _members(scene: Scene, vary: Mapping[Any, Any]) -> tuple[dict[Any, Any], int]:
    """What is varied, as sequences of one length, by parameter or handle and word; and that length."""
    if not isinstance(vary, Mapping) or not vary:
        raise InvalidInput(
            f"simulate_many: vary is {shown(vary)}; it is a mapping of (handle, word) or a parameter to arrays, "
            'as in {(ball, "position"): positions}'
        )
    arrays: dict[Any, Any] = {}
    lengths: dict[int, str] = {}
    known: dict[str, Any] = scene.handles
    for said, given in vary.items():
        key = said
        if isinstance(said, tuple) and len(said) == 2 and isinstance(said[0], str):
            # a name that there is not is left to what reads the starts: it lists those that there are
            key = (known.get(said[0], said[0]), said[1])
        name = f'"{key[0].name}" {key[1]}' if isinstance(key, tuple) and hasattr(key[0], "name") else shown(key)
        is_rotation = hasattr(given, "as_quat")  # SciPy's, one or several
        try:
            values: Any = given if is_rotation or _are_attitudes(given) else np.asarray(given)
        except ValueError:  # lists of several lengths
            raise InvalidInput(f"simulate_many: {name} is {shown(given)}; give an array, one row a member") from None
        if given.single if is_rotation else isinstance(values, np.ndarray) and not values.ndim:
            raise InvalidInput(f"simulate_many: {name} has one value; it has one for each member, n in all")
        if key in arrays:
            raise InvalidInput(f"simulate_many: {name} is given twice, by its handle and by its name; give it once")
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

    def __init__(self, scene: Scene, keys: list[Any], until: float, options: dict[str, Any], lanes: bool) -> None:
        self.scene, self.keys, self.until, self.options, self.lanes = scene, keys, until, options, lanes

    def run(self, values: list[Any], go_on: Callable[[float], Any]) -> tuple[list[Any], list[Any], Any]:
        vary = dict(zip(self.keys, values, strict=True))
        return _core._sweep(
            self.scene, vary, len(values[0]), self.until, **self.options, progress=go_on, threads=1, lanes=self.lanes
        )


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
    lanes: bool,
) -> tuple[list[Any], list[Any], Any]:
    """The members, in chunks through an executor: runs, errors, and what interrupted them."""
    workers = getattr(executor, "_max_workers", None) or os.cpu_count() or 1
    size = max(1, -(-count // (CHUNKS_A_WORKER * workers)))
    places = [(first, min(first + size, count)) for first in range(0, count, size)]
    sweep = _Sweep(scene, list(arrays), until, options, lanes)
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
