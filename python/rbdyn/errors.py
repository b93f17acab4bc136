"""What goes wrong: every message names the object, the number, the rule and the fix."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rbdyn._core import Trajectory


class Error(Exception):
    """Base of every error of this library."""


class InvalidInput(Error, ValueError):
    """A value that breaks a rule of the interface."""


class AccuracyError(Error):
    """The error asked for was not reached. `run` is what is there, certain up to `run.certain_until`."""

    run: Trajectory


class IntegrationError(Error):
    """The motion could not be continued. `run` is what is there."""

    run: Trajectory
