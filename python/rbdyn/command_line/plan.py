"""rbdyn plan: what of a scene is simulated."""

from __future__ import annotations

import argparse
from typing import Any

from rbdyn._core import Plan
from rbdyn._core import plan as plan_of
from rbdyn.command_line import output
from rbdyn.command_line.scene_file import add_file, add_json, called_back, scene_of

HELP = "tells what of a scene is simulated, what is left out and why, and with which engine"

FIELDS = ("coordinates", "effects", "guards", "functions", "engine", "reason", "freedom", "integrals", "not_unique")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments after `plan`."""
    add_file(parser, "a scene (.json), or a Python file that builds `scene`")
    add_json(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Plans it. Returns the exit code."""
    scene = scene_of(arguments.file)[0]
    with called_back(arguments.file):
        plan = plan_of(scene)
    print(output.as_json(_contents(plan)) if arguments.json else plan)
    return 0


def _contents(plan: Plan) -> dict[str, Any]:
    return {
        **output.fields(plan, FIELDS),
        "size": output.fields(plan.size, ("variables", "guards", "instructions")),
        "omissions": [output.fields(one, ("what", "why")) for one in plan.omissions],
        "parts": [_contents(part) for part in plan.parts],
    }
