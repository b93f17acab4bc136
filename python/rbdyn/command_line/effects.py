"""rbdyn effects: what each effect of a scene does to its motion and its price."""

from __future__ import annotations

import argparse
from typing import Any

from rbdyn._core import EffectTable
from rbdyn._core import effects as effects_of
from rbdyn.command_line import output
from rbdyn.command_line.scene_file import add_file, add_json, add_times, called_back, end_of, scene_of

HELP = "tells what each effect of a scene does to its motion and its price"

FIELDS = ("effect", "difference", "time", "gained", "lost", "seconds", "steps", "note")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments after `effects`."""
    add_file(parser, "a scene (.json), or a Python file that builds `scene`")
    add_times(parser)
    parser.add_argument("--error", type=float, metavar="E", help="global error of each run, 1e-9 by default")
    parser.add_argument("--rtol", type=float, metavar="R", help="local tolerance instead, no estimate")
    parser.add_argument("--engine", metavar="NAME", help='"auto" by default')
    add_json(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Runs the scene with and without each. Returns the exit code."""
    scene, until = scene_of(arguments.file)
    options: dict[str, Any] = {name: getattr(arguments, name) for name in ("start", "error", "rtol", "engine")}
    options = {name: value for name, value in options.items() if value is not None}
    end = end_of(arguments, until)
    with called_back(arguments.file):
        table = effects_of(scene, end, **options)
    print(output.as_json(_contents(table)) if arguments.json else table)
    return 0


def _contents(table: EffectTable) -> dict[str, Any]:
    return {
        **output.fields(table, ("seconds", "steps", "events")),
        "rows": [output.fields(row, FIELDS) for row in table],
    }
