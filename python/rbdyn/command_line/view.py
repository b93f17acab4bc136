"""rbdyn view: the motion of a scene in space."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from rbdyn._core import Scene, simulate
from rbdyn.command_line.scene_file import add_file, add_times, called_back, end_of, read
from rbdyn.destinations import ANIMATIONS, PAGES, require_place
from rbdyn.errors import InvalidInput

HELP = "shows the motion of a scene or a run: a page to be opened by a browser, or a .gif or .mp4"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments after `view`."""
    add_file(parser, "a scene (.json), a Python file that builds `scene`, or a run (.npz, .h5)")
    add_times(parser)
    parser.add_argument("--error", type=float, metavar="E", help="global error, 1e-9 by default")
    parser.add_argument(
        "--output", metavar="PATH", help=".html, .gif or .mp4; by default the file's name with .html, in this folder"
    )
    parser.add_argument("--fps", type=float, metavar="N", help="frames a second of playing, 25 by default")
    parser.add_argument("--speed", type=float, metavar="X", help="seconds of motion in a second of playing")


def execute(arguments: argparse.Namespace) -> int:
    """Runs a scene if it is one, and writes its picture. Returns the exit code."""
    path = arguments.output or Path(arguments.file).with_suffix(".html").name
    suffix = Path(path).suffix.lower()
    if suffix not in PAGES + ANIMATIONS:
        raise InvalidInput(f"--output {path}: a picture is written to a file that ends in .html, .gif or .mp4")
    require_place(path, "--output")
    found = read(arguments.file)
    if isinstance(found.thing, Scene):
        options: dict[str, Any] = {name: getattr(arguments, name) for name in ("start", "error")}
        options = {name: value for name, value in options.items() if value is not None}
        end = end_of(arguments, found.until)
        with called_back(arguments.file):
            run = simulate(found.thing, end, **options)
    else:
        given = [f"--{name}" for name in ("until", "start", "error") if getattr(arguments, name) is not None]
        if given:
            raise InvalidInput(f"{arguments.file}: a run is shown as it is; leave out {given[0]}")
        run = found.thing
    shown = {name: getattr(arguments, name) for name in ("fps", "speed") if getattr(arguments, name) is not None}
    if suffix in PAGES:
        run.view(path, **shown)
    else:
        run.animate(path, **shown)
    print(f"wrote {path}")
    return 0
