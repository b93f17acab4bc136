"""Nothing unused is paid: the tables of docs/effects.md.

Runs effects.cpp's program twice, for times and, under valgrind's callgrind, for instructions, and holds the scene
without an effect, the scene with the effect present and zero, and the equations written by hand against each other; and
a law that is built in, the same as a functor, and by hand. Prints the tables; with the path of a document they are
written there, between their marks. Ends with an error if what should be equal is not. Without valgrind the instructions
are left out.
"""

import itertools
import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

SAME = 3  # ways to one motion come first in a row
HEADS = {
    "effects": "| motion | effect | state | steps | orders | guards | instructions "
    "| time, without / zero / by hand [us] | on: steps | guards | instructions | time [us] |",
    "laws": "| law | state | steps | orders | guards | instructions | time, built in / functor / by hand [us] |",
}


@dataclass
class Run:
    """One motion, integrated."""

    table: str
    motion: str
    effect: str
    which: str
    state: str
    work: tuple[int, ...]  # steps, orders, guard evaluations
    microseconds: float
    instructions: int = 0


def runs(program, *arguments, before=()):
    """As the program prints them."""
    environment = {**os.environ, "LD_BIND_NOW": "1"}  # no symbol is looked up while instructions are counted
    done = subprocess.run([*before, program, *arguments], check=True, capture_output=True, text=True, env=environment)
    found = []
    for line in done.stdout.splitlines():
        table, motion, effect, which, state, *work, time = line.split(";")
        found.append(Run(table, motion, effect, which, state, tuple(map(int, work)), float(time)))
    return found


def counted(program):
    """The same with instructions: callgrind writes down an interval a motion, and before it one to warm up."""
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


def rows(found):
    """Runs that belong together: by table, motion and effect."""
    return [list(group) for _, group in itertools.groupby(found, lambda r: (r.table, r.motion, r.effect))]


def tables(timed, counts):
    """The rows of each table, and how many places are not as they should be."""
    lines = {name: [head, re.sub(r"[^|]+", "---", head)] for name, head in HEADS.items()}
    wrong = 0

    def one(values):
        """The value that all share, or all of them."""
        nonlocal wrong
        if len(set(values)) == 1:
            return str(values[0])
        wrong += 1
        return "**" + " / ".join(map(str, values)) + "**"

    def no_more(values):
        """The value that all share, or all of them: a functor may cost less than what is built in."""
        nonlocal wrong
        wrong += counts and int(values[1]) > int(values[0])
        return " / ".join(values) if len(set(values)) > 1 else values[0]

    for row, measured in zip(rows(timed), rows(counts) if counts else rows(timed), strict=True):
        three, on = row[:SAME], row[SAME:]
        # callgrind's processor may have other sines: there, too, the three are held against each other
        one([(r.state, r.work) for r in measured[:SAME]])
        same = one([r.state for r in three]) == three[0].state
        instructions = [str(r.instructions) if counts else "-" for r in measured]
        cells = [
            row[0].motion,
            *([row[0].effect] if row[0].effect else []),
            "=" if same else "**differs**",
            *(one([r.work[k] for r in three]) for k in range(3)),
            one(instructions[:SAME]) if on else no_more(instructions),
            " / ".join(f"{r.microseconds:.2f}" for r in three),
        ]
        for r in on:
            cells += [str(r.work[0]), str(r.work[2]), instructions[SAME], f"{r.microseconds:.2f}"]
        lines[row[0].table].append("| " + " | ".join(cells) + " |")
    return {name: "\n".join(text) + "\n" for name, text in lines.items()}, wrong


def main():
    program = Path(sys.argv[1]).resolve()
    timed = runs(program)
    counts = counted(program) if shutil.which("valgrind") else []
    texts, wrong = tables(timed, counts)
    print(*texts.values(), sep="\n")
    what = "states, counts and instructions" if counts else "states and counts (valgrind is not installed)"
    print(f"{len(rows(timed))} rows; {what} are equal in " + (f"all but {wrong} places" if wrong else "all"))
    if len(sys.argv) > 2:
        document = Path(sys.argv[2])
        for name, text in texts.items():
            begin, end = f"<!-- {name}: ./run effects -->\n", f"<!-- end of {name} -->\n"
            before, rest = document.read_text().split(begin)
            document.write_text(before + begin + "\n" + text + "\n" + end + rest.split(end)[1])
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
