"""Hard cases with known answers, for users on their own machine: verify() runs them and shows what was reached."""

from rbdyn.verification.runner import verify
from rbdyn.verification.scorecard import Row, Scorecard

__all__ = ["Row", "Scorecard", "verify"]
