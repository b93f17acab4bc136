"""What compiling costs: processor seconds and memory of the compiler, one file after the other, without a cache.

    ./run bench compile

In both ways of use where there are two: with the library that is compiled once (rbdyn::rbdyn), and with all
definitions in the headers (rbdyn::header_only). The first row is the calibration: an empty file with Eigen.
"""

import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

root = Path(__file__).resolve().parent.parent
build = root / "build" / "all"
compiler = os.environ.get("CXX", "g++")
common = ["-std=c++20", "-O2", "-ffp-contract=off", f"-I{root}/cpp/include", "-isystem", "/usr/include/eigen3"]
ways = {"library": [], "header only": ["-DRBDYN_HEADER_ONLY=1", "-DRBDYN_WITH_SUNDIALS=1"]}
three_lines = """#include <rbdyn/rbdyn.hpp>
rbdyn::Scene scene({0, 0, -9.81});
int main() { return rbdyn::simulate(scene, {.until = 1.0}).end() > 0.5 ? 0 : 1; }
"""


def price(command: list[str], folder: Path = root) -> tuple[float, float]:
    """Processor seconds and largest memory [MB] of a command."""
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"failed: {shlex.join(command)}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1e3


def row(name: str, *figures: tuple[float, float] | None) -> None:
    cells = [
        f"{seconds:7.1f} s {memory:6.0f} MB" if f else " " * 19 for f in figures for seconds, memory in [f or (0, 0)]
    ]
    print(f"{name:44}" + "   ".join(cells), flush=True)


def objects(target: str) -> list[list[str]]:
    """The commands that compile a target's own files."""
    text = subprocess.run(["ninja", "-t", "commands", target], cwd=build, capture_output=True, text=True, check=True)
    folder = f"/{target}.dir/"
    return [
        [word for word in shlex.split(line) if word != "ccache"]
        for line in text.stdout.splitlines()
        if folder in line and re.search(r" -c ", line)
    ]


def whole(target: str) -> tuple[float, float]:
    prices = [price(command, build) for command in objects(target)]
    return sum(seconds for seconds, _ in prices), max(memory for _, memory in prices)


def main() -> None:
    print(f"{'':44}{'library':>19}   {'header only':>19}")
    with tempfile.TemporaryDirectory() as scratch:
        out = ["-o", f"{scratch}/out.o"]

        def of(path: Path, flags: list[str]) -> tuple[float, float]:
            return price([compiler, *common, *flags, "-c", str(path), *out])

        empty, three = Path(scratch) / "empty.cpp", Path(scratch) / "three.cpp"
        empty.write_text("#include <Eigen/Geometry>\n")
        three.write_text(three_lines)
        row("empty, with Eigen (calibration)", of(empty, []))
        files = {"three lines": three, "examples/hoop.cpp": root / "examples" / "hoop.cpp"}
        files["a functor: examples/own_model.cpp"] = root / "examples" / "own_model.cpp"
        for name, path in files.items():
            row(name, *(of(path, flags) for flags in ways.values()))
        sources = sorted((root / "cpp" / "src").glob("*.cpp"))
        prices = [of(path, ["-fPIC", "-DRBDYN_WITH_SUNDIALS=1"]) for path in sources]
        for path, figures in zip(sources, prices, strict=True):
            row(f"the library: {path.name}", figures)
        row("the library, all of it", (sum(seconds for seconds, _ in prices), max(memory for _, memory in prices)))
    row("the Python module", whole("_core"))
    listed = subprocess.run(["ninja", "-t", "targets", "all"], cwd=build, capture_output=True, text=True, check=True)
    tests = sorted(set(re.findall(r"^tests/cpp/(test_\w+):", listed.stdout, re.M)))
    prices = [whole(test) for test in tests]
    row("the tests, all of them", (sum(seconds for seconds, _ in prices), max(memory for _, memory in prices)))


main()
