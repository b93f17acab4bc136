"""The command line, rbdyn: a module a subcommand, each with HELP, add_arguments(parser) and execute(arguments).

Tables go to stdout, or JSON with --json; what goes wrong goes to stderr in one line, and sets the exit code.
"""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Sequence
from typing import Any, NoReturn, TextIO

from rbdyn import __version__
from rbdyn.command_line import cost, effects, plan, run, verify, view
from rbdyn.command_line.scene_file import FileFailed
from rbdyn.errors import Error, InvalidInput

# in the order in which --help lists them
COMMANDS: dict[str, Any] = {
    "run": run,
    "plan": plan,
    "cost": cost,
    "effects": effects,
    "verify": verify,
    "view": view,
}

DONE, MOTION_FAILED, REFUSED, FILE_FAILED, INTERRUPTED = 0, 1, 2, 3, 130

EXIT_CODES = """exit codes:
  0    done
  1    the motion did not come to its end as asked; what there is of it is shown and saved;
       of verify: a case is not held
  2    the command line, the file or the scene is refused
  3    the Python file raised an exception of its own, also while its functions are called back
  130  interrupted
"""


class Parser(argparse.ArgumentParser):
    """One whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(REFUSED, f"{self.prog}: {message}; {self.prog} --help says more\n")


def parser() -> argparse.ArgumentParser:
    """The parser of the whole command line."""
    formats: dict[str, Any] = {"formatter_class": argparse.RawDescriptionHelpFormatter, "epilog": EXIT_CODES}
    whole = Parser(prog="rbdyn", description="Dynamics of points and rigid bodies.", **formats)
    whole.add_argument("--version", action="version", version=f"rbdyn {__version__}")
    commands = whole.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, module in COMMANDS.items():
        one = commands.add_parser(name, help=module.HELP, description=module.HELP, **formats)
        module.add_arguments(one)
        one.set_defaults(execute=module.execute)
    return whole


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command line, that of the process by default, and returns its exit code."""
    try:
        chosen = parser().parse_args(arguments)
    except SystemExit as left:
        return int(left.code or 0)
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _warned
            code = int(chosen.execute(chosen))
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        return _failed("interrupted", INTERRUPTED)
    except FileFailed as problem:
        return _failed(str(problem), FILE_FAILED)
    except BrokenPipeError:
        # whoever reads has enough; nothing is left to be flushed at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except InvalidInput as problem:
        return _failed(str(problem), REFUSED)
    except Error as problem:
        return _failed(str(problem), MOTION_FAILED)
    except ImportError as problem:
        return _failed(str(problem), REFUSED)


def _warned(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """A warning of this library as a line without its source, which is not the user's; others as they are."""
    own = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    if os.path.abspath(filename).startswith(own + os.sep):
        print(f"rbdyn: warning: {' '.join(str(message).split())}", file=sys.stderr)
    else:
        print(warnings.formatwarning(message, category, filename, lineno), end="", file=sys.stderr)


def _failed(message: str, code: int) -> int:
    print(f"rbdyn: {' '.join(message.split())}", file=sys.stderr)
    return code
