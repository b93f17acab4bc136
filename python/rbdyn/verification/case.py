"""What a case is: a function that builds scenes, has them solved, and yields answers beside what is known."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import perf_counter
from typing import Any, Literal, cast

import numpy as np

from rbdyn._core import Trajectory, simulate
from rbdyn.errors import AccuracyError, IntegrationError, InvalidInput

Engine = Literal["auto", "closed form", "taylor", "dop853", "cvode-adams", "cvode-bdf"]

ENGINES: tuple[Engine, ...] = ("closed form", "taylor", "dop853", "cvode-adams", "cvode-bdf")

# engines of lower order are asked for no more than they reach in the time of a quick run
LEAST = {"dop853": 1e-9, "cvode-adams": 1e-6, "cvode-bdf": 1e-5}

# of an answer rounded to a double, and of the difference that is formed with it
ROUNDING = 4 * float(np.finfo(float).eps)


class Unfinished(Exception):
    """A run that did not come to where the case asks it for an answer, for a reason that an engine may have."""


@dataclass(frozen=True)
class Answer:
    """Something known of a motion, and what a run says of it.

    The error is the largest difference over `scale`, by default the largest magnitude of what is known; without either
    the answer is exact, and any difference is infinite. `given`: relative error that the case itself leaves, in the
    digits its answer has or in a time that is rounded.
    """

    what: str
    ours: Any
    known: Any
    scale: float | None = None
    given: float = 0.0

    @property
    def error(self) -> float:
        """Of ours, relative."""
        ours, known = np.asarray(self.ours, float), np.asarray(self.known, float)
        if known.ndim and ours.shape != known.shape:
            # another number of them
            return float("inf")
        if not ours.size:
            return 0.0
        difference = float(np.max(np.abs(ours - known)))
        scale = float(np.max(np.abs(known))) if self.scale is None else self.scale
        if difference == 0.0:
            return 0.0
        return difference / scale if np.isfinite(difference) and scale > 0.0 else float("inf")


class Solve:
    """simulate() for a case, with the engine and the error that are being tried; counts time and keeps estimates."""

    def __init__(self, engine: Engine, error: float) -> None:
        self.engine: Engine = engine
        self.error = error
        self.seconds = 0.0
        self.estimate: float | None = None

    def __call__(self, scene: Any, until: float, **options: Any) -> Trajectory:
        """The run, which came to its end or where an event stopped it."""
        run = self._timed(scene, until, options)
        if run.error is not None:
            self.estimate = max(run.error, self.estimate or 0.0)
        return run

    def ending(self, scene: Any, until: float, **options: Any) -> tuple[Trajectory, str]:
        """The run of a motion that cannot go on, and what is said of it."""
        try:
            self._timed(scene, until, options)
        except IntegrationError as problem:
            return problem.run, str(problem)
        raise AssertionError("the motion went on where none is")

    def refusal(self, act: Callable[[], Any]) -> str:
        """What is said of input that breaks a rule; empty if nothing is."""
        began = perf_counter()
        try:
            act()
        except InvalidInput as problem:
            return str(problem)
        finally:
            self.seconds += perf_counter() - began
        return ""

    def _timed(self, scene: Any, until: float, options: dict[str, Any]) -> Trajectory:
        began = perf_counter()
        chosen: dict[str, Any] = {"engine": self.engine, "max_steps": 100_000} | options
        if "rtol" not in chosen:
            chosen["error"] = self.error
        try:
            run = cast(Trajectory, simulate(scene, until, **chosen))
            if run.status not in ("reached end", "stopped by event"):
                raise Unfinished(f"{run.status} after {run.statistics.steps} steps, at t = {run.end:.6g}")
            return run
        except AccuracyError as problem:
            raise Unfinished(str(problem)) from problem
        finally:
            self.seconds += perf_counter() - began


Answers = Iterator[Answer]


@dataclass(frozen=True)
class Case:
    """A hard case.

    subject, row: where it stands in the list of hard cases; hard: what breaks; source: of its answers; error: asked of
    the best engines; holds: the engines that hold it, of which the others' refusals are told, none if it needs no
    engine; quick: whether it is part of the quick set.
    """

    name: str
    subject: str
    row: str
    hard: str
    source: str
    error: float
    holds: tuple[Engine, ...]
    quick: bool
    answers: Callable[[Solve], Answers]

    def asked(self, engine: str) -> float:
        """The error asked of an engine."""
        return max(self.error, LEAST.get(engine, 0.0))


CASES: dict[str, Case] = {}

ALL: tuple[Engine, ...] = ENGINES
STEPS: tuple[Engine, ...] = ENGINES[1:]
TAYLOR: tuple[Engine, ...] = ("taylor",)


def case(
    name: str,
    *,
    subject: str,
    row: str,
    hard: str,
    source: str = "closed form",
    error: float = 1e-10,
    holds: tuple[Engine, ...] = STEPS,
    quick: bool = True,
) -> Callable[[Callable[[Solve], Answers]], Callable[[Solve], Answers]]:
    """Enters a function in the list of cases."""

    def enter(answers: Callable[[Solve], Answers]) -> Callable[[Solve], Answers]:
        if name in CASES:
            raise ValueError(f"two cases are called {name!r}")
        CASES[name] = Case(name, subject, row, hard, source, error, holds, quick, answers)
        return answers

    return enter


def says(message: str, *words: str) -> Answer:
    """That a message has the words it is to have: the object, the numbers, the rule."""
    return Answer("the message names it", sum(word in message for word in words), len(words))


def kinds(run: Trajectory, *expected: str) -> Answer:
    """That a run has these kinds of events, in order."""
    found = [event.kind for event in run.events]
    agree = sum(a == b for a, b in zip(found, expected, strict=False))
    return Answer("kinds of events", [agree, len(found)], [len(expected), len(expected)], scale=0.0)
