"""Nothing unused is paid: the table of docs/effects.md.

Runs effects.cpp's program twice, for times and, under valgrind's callgrind, for instructions, and holds the scene
without an effect, the scene with the effect present and zero, and the equations written by hand against each other.
Prints the table; with the path of a document it is written there, between its marks. Ends with an error if what should
be equal is not. Without valgrind the instructions are left out.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

MARKS = ("<!-- table: ./run effects -->\n", "<!-- end of table -->\n")
MODELS = ("without", "zero", "bare", "on")


@dataclass
class Run:
    """One integration of one of the four models."""

    kind: str
    effect: str
    state: str
    work: tuple[int, ...]  # steps, orders, guard evaluations
    microseconds: float
    instructions: int = 0


def runs(program, *arguments, before=()):
    """Four runs for each kind and effect, as the program prints them."""
    environment = {**os.environ, "LD_BIND_NOW": "1"}  # no symbol is looked up while instructions are counted
    done = subprocess.run([*before, program, *arguments], check=True, capture_output=True, text=True, env=environment)
    found = []
    for line in done.stdout.splitlines():
        kind, effect, _, state, *work, time = line.split(";")
        found.append(Run(kind, effect, state, tuple(map(int, work)), float(time)))
    return found


def counted(program):
    """The same with instructions: callgrind writes down an interval a run, and before it one to warm up."""
    toggles = [f"--toggle-collect={name}" for name in ("counted_integration", "*Aside::begin*", "*Aside::next*")]
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        callgrind = ["valgrind", "-q", "--tool=callgrind", "--collect-atstart=no", *toggles]
        callgrind += ["--dump-after=integration_is_over", f"--callgrind-out-file={out}"]
        found = runs(program, "count", before=callgrind)
        for i, run in enumerate(found):
            text = Path(f"{out}.{2 * i + 2}").read_text()
            run.instructions = int(re.search(r"^totals: (\d+)", text, re.MULTILINE)[1])
    return found


def table(timed, counts):
    """The rows, and how many of them are not as they should be."""
    lines = [
        "| motion | effect | state | steps | orders | guards | instructions | time, without / zero / by hand [us] "
        "| on: steps | guards | instructions | time [us] |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    wrong = 0

    def one(values):
        """The value that three share, or all of them."""
        nonlocal wrong
        if len(set(values)) == 1:
            return str(values[0])
        wrong += 1
        return "**" + " / ".join(map(str, values)) + "**"

    for i in range(0, len(timed), len(MODELS)):
        without, zero, bare, on = timed[i : i + len(MODELS)]
        three = (without, zero, bare)
        counted_four = counts[i : i + len(MODELS)] if counts else None
        # callgrind's processor may have other sines: there, too, the three are held against each other
        if counted_four:
            one([(r.state, r.work) for r in counted_four[:3]])
        same = one([r.state for r in three]) == without.state
        instructions = [f"{r.instructions}" for r in counted_four] if counted_four else ["-"] * 4
        cells = [
            without.kind,
            without.effect,
            "=" if same else "**differs**",
            *(one([r.work[k] for r in three]) for k in range(3)),
            one(instructions[:3]),
            " / ".join(f"{r.microseconds:.2f}" for r in three),
            str(on.work[0]),
            str(on.work[2]),
            instructions[3],
            f"{on.microseconds:.2f}",
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n", wrong


def main():
    program = Path(sys.argv[1]).resolve()
    timed = runs(program)
    counts = counted(program) if shutil.which("valgrind") else []
    text, wrong = table(timed, counts)
    print(text)
    rows = len(timed) // len(MODELS)
    what = "states, counts and instructions" if counts else "states and counts (valgrind is not installed)"
    print(f"{rows} rows; {what} are equal in " + (f"all but {wrong} places" if wrong else "all"))
    if len(sys.argv) > 2:
        document = Path(sys.argv[2])
        begin, end = MARKS
        before, rest = document.read_text().split(begin)
        document.write_text(before + begin + "\n" + text + "\n" + end + rest.split(end)[1])
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
