"""Runs benchmarks, those named or all but `compile` and `peers`, one after the other, and prints what they print.

A benchmark is a program that ./run bench has built, or a Python file in this folder. A Python file is given the path of
the program of its name, if there is one, and runs it itself.
"""

import subprocess
import sys
from pathlib import Path

folder = Path(__file__).resolve().parent
build = folder.parent / "build" / "all" / "benchmarks"
programs = {
    path.name.removeprefix("benchmark_"): path
    for path in build.rglob("benchmark_*")
    if path.is_file() and path.stat().st_mode & 0o111
}
if not programs:
    sys.exit("no benchmarks are built: ./run bench builds and runs them")
scripts = {path.stem: path for path in folder.glob("*.py") if path.name != "run.py"}
names = sys.argv[1:] or sorted((programs.keys() | scripts.keys()) - {"compile", "peers"})
for name in names:
    if name not in programs.keys() | scripts.keys():
        sys.exit(f"no benchmark {name}: there are {', '.join(sorted(programs.keys() | scripts.keys()))}")
    print(f"== {name}", flush=True)
    command = [sys.executable, scripts[name]] if name in scripts else []
    subprocess.run([*command, *([programs[name]] if name in programs else [])], check=True)
