"""Runs the tests against each mutant, and prints which are caught: a test fails, or takes far longer than it did.

    python tests/mutants/run.py BUILD [--only NUMBERS] [--jobs N] [--module FOLDER] [--which FILTER] [--least PERCENT]

BUILD: a build of the library as mutate.py writes it, with its C++ tests. Each test is run once alone, to know what it
meets and how long it takes (kept in BUILD/met.json as long as the programs are the same); each mutant is then run
against the tests that meet it, the quick ones first. Times are those of the processor: other work on the machine makes
no test too long. --module: a folder with the Python module of that build; what no C++ test catches is run against the
files of Python tests that meet it, each of which is run once alone as well (BUILD/met_in_python.json). The exit code is
1 if fewer than PERCENT (95) are caught.
"""

import argparse
import hashlib
import json
import os
import resource
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from mutate import ROOT, Mutant, mutants

# what measures time, or builds and fetches things, tells nothing of a mutant
PYTHON_LEFT_OUT = ["test_notebooks.py", "test_website.py", "test_types.py", "test_package.py", "test_documents.py"]
# what is quick is run before what is not: seconds that the tests of a round take at most, each
ROUNDS = [0.02, 0.2, 2.0, 20.0, float("inf")]


@dataclass
class Outcome:
    good: bool
    seconds: float  # of the processor
    why: str


def run(command: list[str], mutant: int, limit: float, **more: str) -> Outcome:
    """A command with a mutant at work, which may take so many seconds of the processor."""
    environment = {**os.environ, "RBDYN_MUTANT": str(mutant), **more}
    with tempfile.TemporaryFile("w+", errors="replace") as out:
        process = subprocess.Popen(command, env=environment, stdout=out, stderr=out)
        seconds = int(limit) + 1
        resource.prlimit(process.pid, resource.RLIMIT_CPU, (seconds, seconds))
        # what waits for ever takes no time of the processor
        ends = threading.Timer(60.0 + 40.0 * limit, process.kill)
        ends.start()
        _, status, used = os.wait4(process.pid, 0)
        ends.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        failed = [line.split()[3].rstrip(",") for line in out if line.startswith("[  FAILED  ] ") and "." in line]
    took = used.ru_utime + used.ru_stime
    why = failed[0] if failed else "it takes too long" if took >= limit else f"exit code {process.returncode}"
    return Outcome(process.returncode == 0, took, why)


@dataclass
class Test:
    """One test of a C++ program, or a file of Python tests, as it is without a mutant."""

    program: Path
    name: str
    seconds: float
    met: set[int]


def command(program: Path, names: list[str]) -> list[str]:
    return [str(program), "--gtest_brief=1", "--gtest_fail_fast", f"--gtest_filter={':'.join(names)}"]


def listed(program: Path, which: str) -> list[str]:
    """The names of its tests."""
    lines = subprocess.run(
        [str(program), "--gtest_list_tests", f"--gtest_filter={which}"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    names, suite = [], ""
    for line in lines:
        if line.startswith("  "):
            names.append(suite + line.split()[0])
        elif line.split("#")[0].strip().endswith("."):
            suite = line.split("#")[0].strip()
    return names


def looked_at(program: Path, name: str) -> Test:
    """Runs it without a mutant."""
    with tempfile.NamedTemporaryFile("r") as file:
        outcome = run(command(program, [name]), 0, 3600.0, RBDYN_MUTANTS_MET=file.name)
        if not outcome.good:
            raise SystemExit(f"{program.name}: {name} fails without a mutant: {outcome.why}")
        return Test(program, name, outcome.seconds, {int(line) for line in file})


def tests_of(build: Path, which: str, jobs: int) -> list[Test]:
    """All tests, with what they meet."""
    programs = [p for p in sorted((build / "tests" / "cpp").glob("test_*")) if not p.suffix and os.access(p, os.X_OK)]
    kept = build / "met.json"
    known = json.loads(kept.read_text()) if kept.exists() else {}
    tests, now = [], {}
    with ThreadPoolExecutor(jobs) as pool:
        for program in programs:
            digest = hashlib.sha256(program.read_bytes()).hexdigest()
            of_program = known.get(program.name, {})
            if of_program.get("digest") != digest:
                of_program = {"digest": digest, "tests": {}}
            asked = listed(program, which)
            lack = [name for name in asked if name not in of_program["tests"]]
            for test in pool.map(lambda name, program=program: looked_at(program, name), lack):
                of_program["tests"][test.name] = [test.seconds, sorted(test.met)]
            now[program.name] = of_program
            kept.write_text(json.dumps({**known, **now}))
            for name in asked:
                seconds, met = of_program["tests"][name]
                tests.append(Test(program, name, seconds, set(met)))
    return tests


def catch(mutant: Mutant, tests: list[Test]) -> str:
    """By which C++ test it is caught, or nothing."""
    meeting = sorted((t for t in tests if mutant.number in t.met), key=lambda t: t.seconds)
    least = 0.0
    for most in ROUNDS:
        of_program: dict[Path, list[Test]] = {}
        for test in meeting:
            if least <= test.seconds < most:
                of_program.setdefault(test.program, []).append(test)
        least = most
        for program, some in of_program.items():
            names, limit = [t.name for t in some], 20.0 + 6.0 * sum(t.seconds for t in some)
            outcome = run(command(program, names), mutant.number, limit)
            if not outcome.good and is_confirmed(program, names, outcome.why, mutant, limit):
                return f"{program.name}: {outcome.why}"
    return ""


def is_confirmed(program: Path, names: list[str], why: str, mutant: Mutant, limit: float) -> bool:
    """Whether what failed fails again, and does not without the mutant: what measures time may do either."""
    again = [why] if why in names else names
    return run(command(program, again), 0, limit).good and not run(command(program, again), mutant.number, limit).good


class PythonFiles:
    """The files of Python tests, with a module."""

    def __init__(self, module: Path, kept: Path):
        self.module = module
        self.tests = self.looked_at(kept)

    def run(self, file: Path, mutant: int, limit: float, **more: str) -> Outcome:
        pytest = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", str(file)]
        return run(["env", "-C", str(ROOT), *pytest], mutant, limit, PYTHONPATH=str(self.module), **more)

    def looked_at(self, kept: Path) -> list[Test]:
        """All of them as they are without a mutant."""
        (core,) = (self.module / "rbdyn").glob("_core*.so")
        of_module = hashlib.sha256(core.read_bytes()).digest()
        known = json.loads(kept.read_text()) if kept.exists() else {}
        now, tests = {}, []
        for path in sorted((ROOT / "tests" / "python").glob("test_*.py")):
            if path.name in PYTHON_LEFT_OUT:
                continue
            digest = hashlib.sha256(of_module + path.read_bytes()).hexdigest()
            if known.get(path.name, {}).get("digest") != digest:
                with tempfile.NamedTemporaryFile("r") as file:
                    outcome = self.run(path, 0, 3600.0, RBDYN_MUTANTS_MET=file.name)
                    if not outcome.good:
                        raise SystemExit(f"{path.name} fails without a mutant: {outcome.why}")
                    met = sorted({int(line) for line in file})
                known[path.name] = {"digest": digest, "seconds": outcome.seconds, "met": met}
                kept.write_text(json.dumps(known))
            now[path.name] = known[path.name]
            tests.append(Test(path, path.name, now[path.name]["seconds"], set(now[path.name]["met"])))
        kept.write_text(json.dumps(now))
        return tests

    def catch(self, mutant: Mutant) -> str:
        for test in sorted((t for t in self.tests if mutant.number in t.met), key=lambda t: t.seconds):
            limit = 60.0 + 6.0 * test.seconds
            outcome = self.run(test.program, mutant.number, limit)
            # as with those of C++: what measures time may fail without the mutant, too
            if not outcome.good and self.run(test.program, 0, limit).good:
                return f"{test.name}: {outcome.why}"
        return ""


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
    tests = tests_of(asked.build, asked.which, asked.jobs)
    print(f"{len(tests)} tests pass without a mutant in {sum(t.seconds for t in tests):.0f} s", flush=True)
    files = PythonFiles(asked.module, asked.build / "met_in_python.json") if asked.module is not None else None
    if files is not None:
        seconds = sum(t.seconds for t in files.tests)
        print(f"{len(files.tests)} files of Python tests pass without a mutant in {seconds:.0f} s", flush=True)

    def judge(mutant: Mutant) -> bool:
        by = catch(mutant, tests)
        if not by and files is not None:
            by = files.catch(mutant)
        is_met = any(mutant.number in test.met for test in [*tests, *(files.tests if files is not None else [])])
        verdict = f"caught   {by}" if by else "SURVIVED" if is_met else "SURVIVED, no test meets it"
        print(f"{mutant.number:4} {mutant.subject:12} {mutant.name:85} {verdict}", flush=True)
        return bool(by)

    with ThreadPoolExecutor(asked.jobs) as pool:
        caught = sum(pool.map(judge, chosen))
    percent = 100.0 * caught / len(chosen)
    print(f"{caught} of {len(chosen)} caught, {percent:.1f} %")
    return 0 if percent >= asked.least else 1


if __name__ == "__main__":
    sys.exit(main())
