"""The file that a command is about: a scene as JSON, a Python file that builds `scene`, or a run to go on with."""

from __future__ import annotations

import argparse
import contextlib
import os
import runpy
import sys
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rbdyn._core import Scene, Trajectory
from rbdyn.errors import Error, InvalidInput
from rbdyn.files import RUNS, SCENES, load

SUFFIXES = (".py", *SCENES, *RUNS)
LISTED = f"{', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}"


class FileFailed(Exception):
    """A Python file raised an exception of its own; the message has its line, `run` what there was of one."""

    run: Trajectory | None = None


@dataclass
class Found:
    """What a file has."""

    thing: Scene | Trajectory
    until: float | None = None  # of a Python file, if it says so


def add_file(parser: argparse.ArgumentParser, what: str) -> None:
    """The argument for the file."""
    parser.add_argument("file", metavar="FILE", help=what)


def add_times(parser: argparse.ArgumentParser) -> None:
    """The arguments for start and end."""
    parser.add_argument(
        "--until", type=float, metavar="T", help="end of the motion [s]; else what a Python file calls `until`"
    )
    parser.add_argument("--start", type=float, metavar="T", help="start of the motion [s], 0 by default")


def add_json(parser: argparse.ArgumentParser) -> None:
    """The argument for JSON."""
    parser.add_argument("--json", action="store_true", help="JSON for programs in place of a table")


def read(path: str) -> Found:
    """Reads a file. Raises InvalidInput for what is none, FileFailed for an exception of a Python file's own."""
    if Path(path).suffix.lower() == ".py":
        return _built_by(path)
    if not Path(path).suffix:
        raise InvalidInput(f"{path}: it has no suffix; give a file that ends in {LISTED}")
    if Path(path).suffix.lower() not in SUFFIXES:
        raise InvalidInput(f"{path}: it ends in {Path(path).suffix!r}; give a file that ends in {LISTED}")
    return Found(load(path))


def scene_of(path: str) -> tuple[Scene, float | None]:
    """The scene of a file, and the end it names."""
    found = read(path)
    if not isinstance(found.thing, Scene):
        raise InvalidInput(f"{path}: it has a run, and this command takes a scene: a .json file, or a .py file")
    return found.thing, found.until


def end_of(arguments: argparse.Namespace, until: float | None) -> float:
    """The end that was asked for, else the one that the file names."""
    if arguments.until is not None:
        return float(arguments.until)
    if until is None:
        raise InvalidInput(f"{arguments.file}: it names no `until`; give --until T, the end of the motion in s")
    return until


@contextlib.contextmanager
def called_back(path: str) -> Iterator[None]:
    """While functions of a file are called back: what they raise is FileFailed, as if the file had raised it."""
    try:
        yield
    except (KeyboardInterrupt, Error):
        raise
    except BaseException as problem:
        raise _failed(path, problem) from None


def _failed(path: str, problem: BaseException) -> FileFailed:
    said = f"{type(problem).__name__}: {problem}" if str(problem) else type(problem).__name__
    failed = FileFailed(f"{_place(path, problem)}: {said}")
    failed.run = getattr(problem, "run", None)
    return failed


def _built_by(path: str) -> Found:
    if not os.path.isfile(path):
        raise InvalidInput(f"{path}: there is no such file")
    folder = os.path.dirname(os.path.abspath(path))
    sys.path.insert(0, folder)
    try:
        # what it prints is no part of a table, nor of JSON
        with contextlib.redirect_stdout(sys.stderr):
            names = runpy.run_path(path, run_name="rbdyn_scene_file")
    except KeyboardInterrupt:
        raise
    except BaseException as problem:
        if isinstance(problem, InvalidInput):
            raise InvalidInput(f"{_place(path, problem)}: {problem}") from None
        raise _failed(path, problem) from None
    finally:
        sys.path.remove(folder)
    scene = names.get("scene")
    if not isinstance(scene, Scene):
        has = "builds no `scene`" if scene is None else f"`scene` is {scene!r}, no Scene"
        raise InvalidInput(f"{path}: {has}; assign an rbdyn.Scene to the name scene")
    until = names.get("until")
    if until is not None and not isinstance(until, (int, float)):
        raise InvalidInput(f"{path}: `until` is {until!r}; it is a number, the end of the motion in s")
    return Found(scene, None if until is None else float(until))


def _place(path: str, problem: BaseException) -> str:
    """The file, and its line that the exception comes from."""
    if isinstance(problem, SyntaxError) and problem.lineno is not None:
        return f"{problem.filename}, line {problem.lineno}"
    lines = [
        frame.lineno
        for frame in traceback.extract_tb(problem.__traceback__)
        if os.path.abspath(frame.filename) == os.path.abspath(path)
    ]
    return f"{path}, line {lines[-1]}" if lines else path
