"""Runs every benchmark that ./run bench has built, one after the other, and prints what they print."""

import subprocess
import sys
from pathlib import Path

build = Path(__file__).resolve().parent.parent / "build" / "benchmarks"
programs = sorted(path for path in build.rglob("benchmark_*") if path.is_file() and path.stat().st_mode & 0o111)
if not programs:
    sys.exit("no benchmarks are built: ./run bench builds and runs them")
for program in programs:
    print(f"== {program.name.removeprefix('benchmark_')}", flush=True)
    subprocess.run([program], check=True)
