"""What is paid before and beside the integration: import, a call of simulate(), memory of scenes and runs.

Import: median of whole processes, with the time of the interpreter and of NumPy alone beside it. Calls: median of 401.
Memory: resident size over many scenes or runs that are kept, a number that depends on the allocator. Estimates: what a
call with error= takes, its plan kept from before, in integrations of the run that it returns, least over least; alone
with the argument `estimates`.
"""

import math
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import rbdyn as rb
from scenes.beside_peers import PROBLEMS


def median_of(f, *arguments, count=401, **options):
    """Median time of a call [us]."""
    times = []
    for _ in range(count):
        start = time.perf_counter()
        f(*arguments, **options)
        times.append(time.perf_counter() - start)
    return statistics.median(times) * 1e6


def process(program):
    """Median time of a process of Python's [ms]."""
    return median_of(subprocess.run, [sys.executable, "-c", program], count=21, check=True) * 1e-3


def resident():
    """Bytes of memory in use."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


KEPT = []  # so that no memory is used twice


def bytes_of(count, f, *arguments, **options):
    """Bytes of each of many objects that are kept."""
    before = resident()
    KEPT.append([f(*arguments, **options) for _ in range(count)])
    return (resident() - before) / count


def thrown():
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    scene.add(rb.Particle(1.0), velocity=[1, 0, 4])
    return scene


def hoop():
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    rail = rb.Rail(rb.Circle(1.0, [0, 0, -1], [1, 0, 0]), friction=rb.Coulomb(0.15, 0.1))
    scene.add(rb.Particle(1.0), rail, parameter=2.0, speed=6.0)
    return scene


def body():
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    unequal = rb.RigidBody(0.5, [0.0022, 0.0019, 0.001])
    scene.add(unequal, rb.Spherical(point=[0.01, 0, -0.05]), angular_velocity=[0, 0, 30])
    return scene


SCENES = (("particle, 1 s", thrown, 1.0), ("rough hoop, 30 s", hoop, 30.0), ("body, 1 s", body, 1.0))


def in_integrations(scene, until, error, keep):
    """A call with this error over the integration of the run it returns; none where the series do not reach it."""
    least = [math.inf, math.inf]
    began = time.thread_time()
    for count in range(200):
        try:
            paid = rb.simulate(scene, until, error=error, engine="taylor", keep=keep).statistics
        except rb.AccuracyError:
            return None
        least = [min(least[0], paid.seconds), min(least[1], paid.integration_seconds)]
        if count >= 5 and time.thread_time() - began > 0.4:
            break
    return least[0] / least[1]


def show_estimates():
    print("calls by taylor in integrations, all kept (the end alone)")
    errors = (1e-6, 1e-9, 1e-12)
    print("| scene | " + " | ".join(f"{e:.0e}" for e in errors) + " |\n|---|" + "---|" * len(errors))
    made = {name: problem.scene for name, problem in PROBLEMS.items()}
    found = {"all": [], "end": []}
    for name, make in made.items():
        scene, until = make()
        cells = []
        for error in errors:
            two = [in_integrations(scene, until, error, keep) for keep in found]
            cells.append("-" if None in two else f"{two[0]:.2f} ({two[1]:.2f})")
            for kept, ratio in zip(found.values(), two, strict=True):
                kept += [] if None in two else [ratio]
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)
    means = [math.exp(statistics.fmean(map(math.log, kept))) for kept in found.values()]
    print(f"geometric mean {means[0]:.2f} ({means[1]:.2f})")


def main():
    if sys.argv[1:] == ["estimates"]:
        show_estimates()
        return
    print("import: whole process [ms]")
    for program in ("pass", "import numpy", "import rbdyn"):
        print(f"  {program:14} {process(program):8.1f}")

    # memory first, while none has been given back
    print("\nmemory [bytes]")
    print(f"  scene of a particle      {bytes_of(20000, thrown):8.0f}")
    for name, make, until in SCENES:
        scene = make()
        whole = bytes_of(2000, rb.simulate, scene, until)
        end = bytes_of(2000, rb.simulate, scene, until, keep="end")
        print(f"  run of {name:17} {whole:8.0f}, its end alone {end:.0f}")

    print("\ncalls [us] with rtol 1e-9: the first for a scene, a later one, its integration; later with error 1e-9")
    for name, make, until in SCENES:
        scene = make()
        first = [rb.simulate(make(), until, rtol=1e-9).statistics.seconds for _ in range(401)]
        alone = [rb.simulate(scene, until, rtol=1e-9).statistics.integration_seconds for _ in range(401)]
        row = [
            statistics.median(first) * 1e6,
            median_of(rb.simulate, scene, until, rtol=1e-9),
            statistics.median(alone) * 1e6,
            median_of(rb.simulate, scene, until),
        ]
        print(f"  {name:18}" + "".join(f"{x:9.1f}" for x in row))

    print()
    show_estimates()

    stiffness = rb.parameter(1.0, "stiffness")
    scene = thrown()
    scene.apply(rb.Force(lambda t, position, velocity: -stiffness * position), scene.bodies[0])
    values = iter(np.linspace(1.0, 30.0, 1000))

    def changed():
        stiffness.value = float(next(values))
        return rb.simulate(scene, 1.0, rtol=1e-9)

    print(f"\nsweep of a traced parameter, one run of 1 s [us]: {median_of(changed):.1f}")


if __name__ == "__main__":
    main()
