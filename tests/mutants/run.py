"""Runs the tests against each mutant, and prints which are caught: a test fails, or takes far longer than it did.

    python tests/mutants/run.py BUILD [--only NUMBERS] [--jobs N] [--module FOLDER] [--which FILTER] [--least PERCENT]

BUILD: a build of the library as mutate.py writes it, with its C++ tests. Each mutant is run against the programs that
meet it, the quick ones first. --module: a folder with the Python module of that build; what no C++ test catches is run
against the Python tests too. The exit code is 1 if fewer than PERCENT (95) are caught.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from mutate import ROOT, Mutant, mutants

# what measures time, or builds and fetches things, tells nothing of a mutant
PYTHON_LEFT_OUT = ["test_notebooks.py", "test_website.py", "test_types.py", "test_package.py", "test_documents.py"]


def run(command: list[str], mutant: int, limit: float, **more: str) -> tuple[bool, float, str]:
    """Whether it passes with a mutant at work, how long it took, and what it said of the first failure."""
    environment = {**os.environ, "RBDYN_MUTANT": str(mutant), **more}
    start = time.monotonic()
    with tempfile.TemporaryFile("w+", errors="replace") as out:
        try:
            code = subprocess.run(command, env=environment, stdout=out, stderr=out, timeout=limit).returncode
        except subprocess.TimeoutExpired:
            return False, time.monotonic() - start, "it takes too long"
        out.seek(0)
        failed = [line.split()[3].rstrip(",") for line in out if line.startswith("[  FAILED  ] ") and "." in line]
    return code == 0, time.monotonic() - start, failed[0] if failed else f"exit code {code}"


def tests_of(program: Path, which: str = "*") -> list[str]:
    return [str(program), "--gtest_brief=1", "--gtest_fail_fast", f"--gtest_filter={which}"]


class Programs:
    """The C++ test programs of a build, as they are without a mutant."""

    def __init__(self, build: Path, which: str) -> None:
        self.which = which
        self.seconds: dict[Path, float] = {}
        self.met: dict[Path, set[int]] = {}
        for program in sorted((build / "tests" / "cpp").glob("test_*")):
            if program.suffix or not os.access(program, os.X_OK):
                continue
            with tempfile.NamedTemporaryFile("r") as file:
                good, self.seconds[program], why = run(tests_of(program, which), 0, 3600.0, RBDYN_MUTANTS_MET=file.name)
                self.met[program] = {int(line) for line in file}
            if not good:
                raise SystemExit(f"{program.name} fails without a mutant: {why}")

    def catch(self, mutant: Mutant) -> str:
        """By what it is caught, or nothing."""
        for program in sorted(self.seconds, key=lambda p: self.seconds[p]):
            if mutant.number not in self.met[program]:
                continue
            limit = 20.0 + 6.0 * self.seconds[program]
            good, _, why = run(tests_of(program, self.which), mutant.number, limit)
            if not good and self.is_confirmed(program, why, mutant, limit):
                return f"{program.name}: {why}"
        return ""

    def is_confirmed(self, program: Path, test: str, mutant: Mutant, limit: float) -> bool:
        """Whether a test that failed fails again, and does not without the mutant: what measures time may do either."""
        if "." not in test:
            return True
        again, alone = (run(tests_of(program, test), number, limit)[0] for number in (mutant.number, 0))
        return alone and not again

    def is_met(self, mutant: Mutant) -> bool:
        return any(mutant.number in met for met in self.met.values())


def catch_in_python(mutant: Mutant, module: Path) -> str:
    left_out = [f"--ignore=tests/python/{name}" for name in PYTHON_LEFT_OUT]
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *left_out]
    good, _, why = run(["env", "-C", str(ROOT), *command], mutant.number, 3600.0, PYTHONPATH=str(module))
    return "" if good else f"Python: {why}"


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--module", type=Path)
    parser.add_argument("--which", default="*", help="a filter of GoogleTest")
    parser.add_argument("--least", type=float, default=95.0)
    asked = parser.parse_args()
    wanted = {int(number) for number in asked.only.split(",") if number}
    chosen = [m for m in mutants() if not wanted or m.number in wanted]
    programs = Programs(asked.build, asked.which)
    print(
        f"{len(programs.seconds)} programs pass without a mutant in {sum(programs.seconds.values()):.0f} s", flush=True
    )

    def judge(mutant: Mutant) -> bool:
        by = programs.catch(mutant)
        if not by and asked.module is not None:
            by = catch_in_python(mutant, asked.module)
        verdict = f"caught   {by}" if by else "SURVIVED" if programs.is_met(mutant) else "SURVIVED, no test meets it"
        print(f"{mutant.number:4} {mutant.subject:12} {mutant.name:85} {verdict}", flush=True)
        return bool(by)

    with ThreadPoolExecutor(asked.jobs) as pool:
        caught = sum(pool.map(judge, chosen))
    percent = 100.0 * caught / len(chosen)
    print(f"{caught} of {len(chosen)} caught, {percent:.1f} %")
    return 0 if percent >= asked.least else 1


if __name__ == "__main__":
    sys.exit(main())
