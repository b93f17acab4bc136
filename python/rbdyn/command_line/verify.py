"""rbdyn verify: hard cases with known answers, on this machine."""

from __future__ import annotations

import argparse
import sys

from rbdyn.command_line import output
from rbdyn.command_line.scene_file import add_json
from rbdyn.verification import Scorecard
from rbdyn.verification import verify as verified
from rbdyn.verification.case import ENGINES

HELP = "runs hard cases with known answers on this machine, with every engine, and tells the digits reached"

PASSED, NOT_PASSED, INTERRUPTED = 0, 1, 130


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments after `verify`."""
    parser.add_argument("--full", action="store_true", help="all cases; by default those that are quick")
    parser.add_argument("--case", metavar="NAME", help="one case, or all whose names begin so")
    parser.add_argument("--engine", choices=ENGINES, help="one engine; by default each")
    parser.add_argument("--figure", metavar="FILE", help="writes a figure of digits over time")
    add_json(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Verifies. Returns the exit code: 1 if a case is not held."""
    output.require_picture(arguments.figure, "--figure")
    progress = sys.stderr.isatty()
    card = verified(arguments.full, case=arguments.case, engine=arguments.engine, progress=progress)
    print(output.as_json(_contents(card)) if arguments.json else card)
    if arguments.figure:
        card.plot(arguments.figure)
    if card.interrupted:
        return INTERRUPTED
    return PASSED if card.passed else NOT_PASSED


def _contents(card: Scorecard) -> dict[str, object]:
    return {
        "passed": card.passed,
        "interrupted": card.interrupted,
        "seconds": card.seconds,
        "unheld": list(card.unheld),
        "rows": card.to_dicts(),
    }
