"""What goes wrong: every message names the object, the number, the rule and the fix."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rbdyn._core import Trajectory


class Error(Exception):
    """Base of every error of this library."""


class InvalidInput(Error, ValueError):
    """A value that breaks a rule of the interface."""


class _WithRun(Error):
    """An error that brings what there is of a run, to other processes too if the run can be pickled."""

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]:
        brought = dict(self.__dict__)
        try:
            pickle.dumps(brought.get("run"))
        except (TypeError, pickle.PicklingError):
            # a function of its scene is called back; where the error arrives it has its text alone
            del brought["run"]
        return type(self), self.args, brought


class AccuracyError(_WithRun):
    """The error asked for was not reached. `run` is what is there, certain up to `run.certain_until`."""

    run: Trajectory


class IntegrationError(_WithRun):
    """The motion could not be continued. `run` is what is there."""

    run: Trajectory
