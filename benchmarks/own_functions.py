"""Quadratic drag, built in and in every way to write it oneself: what a law of one's own costs.

The scene of own_functions.cpp, whose program is run for the rows from C++. Times are of the whole call of simulate(),
median of the runs; the ratio is to the C++ functor with the same engine. All run with an allocator that keeps the
memory it is given back: else a third of the time of a short run is the system's, for pages that are new each time.
"""

import math
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import rbdyn as rb

DRAG = 0.05  # kg/m
KEEPING = {  # settings of glibc's allocator
    "MALLOC_TRIM_THRESHOLD_": "1000000000",
    "MALLOC_MMAP_THRESHOLD_": "30000000",
    "MALLOC_TOP_PAD_": "100000000",
}


def traced(t, position, velocity):
    return -DRAG * np.linalg.norm(velocity) * velocity


def seven(t, x, y, z, vx, vy, vz):
    k = -DRAG * math.sqrt(vx * vx + vy * vy + vz * vz)
    return k * vx, k * vy, k * vz


def arrays(t, position, velocity):
    return -DRAG * math.sqrt(velocity.dot(velocity)) * velocity


def compiled():
    import numba

    doubles = numba.types.CPointer(numba.float64)

    @numba.cfunc(numba.void(numba.float64, doubles, doubles, doubles))
    def drag(t, position, velocity, force):
        k = -DRAG * math.sqrt(velocity[0] ** 2 + velocity[1] ** 2 + velocity[2] ** 2)
        for i in range(3):
            force[i] = k * velocity[i]

    return rb.Force(drag)


def scene_with(load):
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(mass=0.5), position=[1, 0, 0], velocity=[0, 2, 1])
    scene.connect(rb.Spring(stiffness=20.0), ball, [0, 0, 0])
    scene.apply(load, ball)
    return scene


def medians(loads):
    """Microseconds a run, of each load and engine; they take turns, so that all have the same machine."""
    scenes = {(name, engine): scene_with(load) for name, (load, engines) in loads.items() for engine in engines}
    times = {key: [] for key in scenes}
    for _ in range(101):
        for (name, engine), scene in scenes.items():
            start = time.perf_counter()
            rb.simulate(scene, until=20.0, rtol=1e-10, engine=engine)
            times[name, engine].append((time.perf_counter() - start) * 1e6)
    return [(name, engine, statistics.median(t)) for (name, engine), t in times.items()]


def main():
    program = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    rows = []
    if program:
        lines = subprocess.run([program, "rows"], check=True, capture_output=True, text=True).stdout.splitlines()
        numbers = {tuple(line.split(";")[:2]): float(line.split(";")[2]) for line in lines}
        print(f"calibration: {numbers.pop(('calibration', '')):.3f} us")
        free, chained = (1000 * numbers.pop((name, "")) for name in ("evaluation", "chained"))
        print(f"one evaluation of the recorded law: {free:.1f} ns, {chained:.1f} ns where each waits for the last\n")
        rows += [
            ("built in, from C++" if name == "built in" else name, *rest, t) for (name, *rest), t in numbers.items()
        ]
    loads = {
        "built in, from Python": (rb.Drag(quadratic=DRAG), ("taylor", "dop853")),
        "Python, traced": (rb.Force(traced, trace=True), ("taylor", "dop853")),
        "Python, seven floats, called back": (rb.Force(seven, trace=False), ("dop853",)),
        "Python, arrays, called back": (rb.Force(arrays, trace=False), ("dop853",)),
    }
    try:
        loads["numba cfunc, called back"] = (compiled(), ("dop853",))
    except ImportError:
        print("numba is not installed\n")
    rows += medians(loads)

    base = {engine: t for name, engine, t in rows if name == "C++ functor"}
    print(f"{'drag':<34} {'engine':<8} {'time [us]':>10} {'ratio':>8}")
    for name, engine, t in sorted(rows, key=lambda row: (row[1] != "taylor", row[2])):
        ratio = f"{t / base[engine]:8.2f}" if engine in base else ""
        print(f"{name:<34} {engine:<8} {t:10.1f} {ratio}")


if __name__ == "__main__":
    if not KEEPING.items() <= os.environ.items():
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **KEEPING})
    main()
