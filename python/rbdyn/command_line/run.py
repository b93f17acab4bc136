"""rbdyn run: the motion of a scene."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from rbdyn import _core
from rbdyn._core import Scene, Trajectory, simulate
from rbdyn.command_line import output
from rbdyn.command_line.scene_file import FileFailed, add_file, add_json, add_times, called_back, end_of, read
from rbdyn.destinations import require_place
from rbdyn.errors import Error, InvalidInput
from rbdyn.files import RUNS

HELP = "runs a scene, or goes on with a run, and tells what happens"

TABLES = (".csv",)

STATISTICS = (
    "seconds",
    "planning_seconds",
    "integration_seconds",
    "judging_seconds",
    "runs",
    "steps",
    "rejected",
    "right_hand_sides",
    "jacobians",
    "guard_evaluations",
    "events",
    "python_calls",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments after `run`."""
    add_file(parser, "a scene (.json), a Python file that builds `scene`, or a run to go on with (.npz, .h5)")
    add_times(parser)
    parser.add_argument("--error", type=float, metavar="E", help="global error, 1e-9 by default")
    parser.add_argument("--rtol", type=float, metavar="R", help="local tolerance instead, no estimate: the cheap way")
    parser.add_argument("--engine", metavar="NAME", help='"auto" by default')
    parser.add_argument("--keep", choices=("all", "end"), help="of the motion; all by default")
    parser.add_argument("--max-steps", type=_steps, metavar="N", help="of each integration")
    parser.add_argument(
        "--save", metavar="PATH", action="append", default=[], help="writes the run: .npz, .h5, or .csv for a table"
    )
    parser.add_argument("--plot", metavar="PATH", help="draws the first body's motion: .png, .svg, .pdf")
    parser.add_argument("--progress", action="store_true", help="a bar on stderr")
    add_json(parser)


def _steps(text: str) -> int:
    """A number of steps, as simulate() takes it."""
    try:
        steps = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"invalid int value: {text!r}") from None
    if steps >= 2**63:
        raise argparse.ArgumentTypeError(f"{text} is out of range; it is a whole number below 2**63")
    return steps


def execute(arguments: argparse.Namespace) -> int:
    """Runs it. Returns the exit code."""
    for path in arguments.save:
        # before hours are spent on it
        if Path(path).suffix.lower() not in RUNS + TABLES:
            raise InvalidInput(f"--save {path}: a run is written to a file that ends in .npz, .h5, .hdf5 or .csv")
        require_place(path, "--save")
    output.require_picture(arguments.plot, "--plot")
    if arguments.plot and arguments.keep == "end":
        raise InvalidInput(
            "--plot: a figure shows the motion, and --keep end keeps its end alone; leave out one of them"
        )
    found = read(arguments.file)
    until = end_of(arguments, found.until)
    names = ("start", "error", "rtol", "engine", "keep", "max_steps")
    options: dict[str, Any] = {name: getattr(arguments, name) for name in names}
    options = {name: value for name, value in options.items() if value is not None}
    if "start" in options and isinstance(found.thing, Trajectory):
        raise InvalidInput(f"{arguments.file}: a run goes on from its end, t = {found.thing.end} s; leave out --start")
    try:
        with called_back(arguments.file):
            _require_saved(found.thing, arguments.save)
            made = simulate(found.thing, until, progress=arguments.progress, **options)
    except (Error, FileFailed, KeyboardInterrupt) as problem:
        partial = getattr(problem, "run", None)
        if isinstance(partial, Trajectory):
            _deliver(partial, arguments)
        raise
    _deliver(made, arguments)
    if made.status in ("reached end", "stopped by event"):
        return 0
    raise Error(f"{made.status} at t = {made.end:.10g} s. {made.advice}")


def _require_saved(thing: Scene | Trajectory, paths: list[str]) -> None:
    """Raises InvalidInput if runs of it go into no file, before hours are spent on one."""
    if isinstance(thing, Scene) and any(Path(path).suffix.lower() in RUNS for path in paths):
        _core._scene_text(thing)


def _deliver(run: Trajectory, arguments: argparse.Namespace) -> None:
    print(output.as_json(_contents(run)) if arguments.json else _text(run))
    sys.stdout.flush()
    for path in arguments.save:
        if Path(path).suffix.lower() in TABLES:
            run.sample().to_csv(path)
        else:
            run.save(path)
    if arguments.plot:
        run.plot(arguments.plot)


def _text(run: Trajectory) -> str:
    lines = [str(run)]
    if len(run.events):
        lines += ["events", *(f"  {event}" for event in run.events)]
    lines.append(f"at t = {run.end:.10g} s")
    for handle in run.bodies:
        motion = run[handle]
        shown: list[str] = [
            name for name in ("parameter", "speed", "angle", "displacement", "rate") if name in motion.quantities
        ]
        shown += [name for name in ("position", "velocity") if not shown and name in motion.quantities]
        values = (f"{name} {_number(getattr(motion, name)(run.end))}" for name in shown)
        lines.append(f"  {handle.name}: {', '.join(values)}")
    lines.append(str(run.statistics))
    return "\n".join(lines)


def _number(value: Any) -> str:
    return f"{value:.10g}" if isinstance(value, float) else "[" + ", ".join(f"{one:.10g}" for one in value) + "]"


def _contents(run: Trajectory) -> dict[str, Any]:
    sample = run.sample([run.end])
    return {
        **output.fields(run, ("status", "advice", "start", "end", "certain_until", "engine", "error")),
        "events": [output.fields(event, ("time", "kind", "name", "direction")) for event in run.events],
        "at_end": {
            handle.name: {quantity: values[0] for quantity, values in sample[handle].items()}
            for handle in [*run.bodies, *run.couplings]
        },
        "statistics": output.fields(run.statistics, STATISTICS),
    }
