"""Gives made-up inputs to every target of the fuzzer, and says what was found.

    python tests/fuzz/fuzz.py PROGRAM [--seconds N] [--targets NAMES] [--jobs N]

Inputs that the fuzzer keeps, and those that are finds, go to build/fuzz; a find is printed as a file of the corpus has
it, so that it can be added there once its cause is mended.
"""

import argparse
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CORPUS = Path(__file__).parent / "corpus"
# targets whose inputs are texts; those of the others stand in the corpus as hexadecimal digits
TEXTS = {"scene_file": "scene_file.dict", "function": "function.dict"}


def bytes_of(path: Path, target: str) -> bytes:
    return path.read_bytes() if target in TEXTS else bytes.fromhex(path.read_text())


def fuzz(program: Path, target: str, seconds: int) -> bool:
    """Whether it finds nothing."""
    folder = ROOT / "build" / "fuzz" / target
    kept, finds = folder / "kept", folder / "finds"
    kept.mkdir(parents=True, exist_ok=True)
    finds.mkdir(exist_ok=True)
    for old in finds.iterdir():
        old.unlink()
    for path in (CORPUS / target).iterdir():
        (kept / path.stem).write_bytes(bytes_of(path, target))
    command = [str(program), f"-max_total_time={seconds}", "-timeout=60", "-rss_limit_mb=3000", "-malloc_limit_mb=2000"]
    command += ["-max_len=4096", "-print_final_stats=1", f"-artifact_prefix={finds}/"]
    if target in TEXTS:
        command.append(f"-dict={Path(__file__).parent / TEXTS[target]}")
    environment = {**os.environ, "RBDYN_FUZZ": target, "ASAN_OPTIONS": "allocator_may_return_null=1"}
    log = folder / "log.txt"
    with log.open("wb") as out:
        code = subprocess.run([*command, str(kept)], env=environment, stdout=out, stderr=out).returncode
    said = log.read_text(errors="replace").splitlines()
    runs = next((line.split()[-1] for line in said if "number_of_executed_units" in line), "?")
    print(f"{target}: {runs} inputs in {seconds} s, {len(list(kept.iterdir()))} kept, exit code {code}", flush=True)
    for find in sorted(finds.iterdir()):
        why = [line for line in said if "ERROR" in line or "runtime error" in line or line.startswith("find:")]
        print(f"  {find.relative_to(ROOT)}: {'; '.join(why)[:400]}")
        data = find.read_bytes()
        print("  " + (data.decode(errors="backslashreplace") if target in TEXTS else data.hex(" "))[:2000])
    return code == 0


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=Path)
    parser.add_argument("--seconds", type=int, default=300)
    parser.add_argument("--targets", default="")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    asked = parser.parse_args()
    targets = asked.targets.split(",") if asked.targets else sorted(path.name for path in CORPUS.iterdir())
    with ThreadPoolExecutor(asked.jobs) as pool:
        good = list(pool.map(lambda target: fuzz(asked.program, target, asked.seconds), targets))
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
