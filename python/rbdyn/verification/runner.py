"""verify(): runs the cases with every engine."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable
from time import perf_counter

from rbdyn.errors import AccuracyError, Error, IntegrationError, InvalidInput
from rbdyn.progress import Bar
from rbdyn.shown import shown
from rbdyn.verification import (
    bodies,
    contacts,
    events,
    linkages,
    mechanisms,
    metamorphic,
    on_spheres,
    rails,
    rolling,
    systems,
    trees,
)
from rbdyn.verification.case import CASES, ENGINES, ROUNDING, Answer, Case, Engine, Solve, Unfinished
from rbdyn.verification.scorecard import Row, Scorecard

# importing them enters their cases
SUBJECTS = (rails, bodies, systems, trees, mechanisms, linkages, contacts, rolling, on_spheres, events, metamorphic)


def verify(
    full: bool = False,
    *,
    case: str | None = None,
    engine: Engine | None = None,
    progress: bool | Callable[[float], object] = False,
) -> Scorecard:
    """Runs hard cases with known answers on this machine, with every engine, and returns a Scorecard.

    full: all of them; by default those that take less than a minute together. case: one alone, or all whose names
    begin so. engine: one of "closed form", "taylor", "dop853", "cvode-adams", "cvode-bdf"; by default each. progress:
    a bar on stderr, or a function that gets the fraction done. An interruption (Ctrl-C) ends it with what there is:
    card.interrupted. Raises InvalidInput where no case or engine is called so, and for a full that is neither True nor
    False.
    """
    if not isinstance(full, bool):
        raise InvalidInput(f"verify: full is {shown(full)}; it is True or False, and case= names one case")
    chosen = _chosen(full, case)
    if engine is not None and engine not in ENGINES:
        raise InvalidInput(f"verify: engine is {shown(engine)}; it is one of {', '.join(ENGINES)}")
    bar = Bar() if progress is True else None
    tell = bar if bar is not None else progress if callable(progress) else None
    began, rows, interrupted = perf_counter(), [], False
    try:
        for k, one in enumerate(chosen):
            engines: tuple[Engine, ...] = (engine,) if engine else ENGINES if one.holds else ("auto",)
            for which in engines:
                rows.append(judged(one, which))
            if tell is not None:
                tell((k + 1) / len(chosen))
    except KeyboardInterrupt:
        interrupted = True
    finally:
        if bar is not None:
            bar.close()
    return Scorecard(tuple(rows), perf_counter() - began, interrupted)


def judged(case: Case, engine: Engine) -> Row:
    """One case with one engine."""
    solve = Solve(engine, case.asked(engine))
    worst: Answer | None = None
    status, reason = "held", ""
    try:
        for answer in case.answers(solve):
            if worst is None or not _excess(answer) <= _excess(worst):
                worst = answer
        if worst is None:
            status, reason = "failed", "the case gave no answer"
        elif worst.error > solve.error + worst.given:
            status, reason = "missed", f"{worst.what} is off by {worst.error:.1e}, asked was {solve.error:.0e}"
        elif solve.estimate is not None and worst.error > solve.estimate + worst.given + ROUNDING:
            status, reason = "missed", f"{worst.what} is off by {worst.error:.1e}, told was {solve.estimate:.1e}"
    except (InvalidInput, Unfinished, AccuracyError) as problem:
        status, reason = "refused", _sentence(str(problem))
    except IntegrationError as problem:
        # a motion that ends where it does not is no refusal of an engine that is to hold it
        status = "failed" if engine in case.holds or engine == "auto" else "refused"
        reason = _sentence(str(problem))
    except (Error, AssertionError, ValueError, TypeError, IndexError) as problem:
        status, reason = "failed", f"{type(problem).__name__}: {_sentence(str(problem))}"
    if status in ("refused", "failed"):
        worst = None
    return Row(
        case=case.name,
        subject=case.subject,
        engine="-" if engine == "auto" else engine,
        what=worst.what if worst else "",
        known=worst.known if worst else None,
        ours=worst.ours if worst else None,
        error=worst.error if worst else math.nan,
        asked=solve.error,
        estimate=math.nan if solve.estimate is None else solve.estimate,
        seconds=solve.seconds,
        status=status,
        reason=reason,
    )


def _excess(answer: Answer) -> float:
    return answer.error - answer.given


def _chosen(full: bool, name: str | None) -> list[Case]:
    if name is None:
        return [one for one in CASES.values() if full or one.quick]
    if name in CASES:
        return [CASES[name]]
    found = [one for one in CASES.values() if one.name.startswith(name)]
    if not found:
        near = difflib.get_close_matches(name, CASES, 1, 0.4)
        hint = f"; the nearest is {near[0]!r}" if near else ""
        raise InvalidInput(f"verify: no case is called {shown(name)}, nor begins so{hint}")
    return found


def _sentence(text: str) -> str:
    """The first sentence of a message."""
    line = " ".join(text.split())
    return line.split("; ")[0].split(". ")[0].rstrip(".")
