"""How honest estimates are: the true error of simulate(error=) over what it tells, and its inverse, by scene.

Errors of 1e-3 to 1e-11 are asked for. The true one is the largest difference of places, velocities, attitudes and
angular velocities from this library's tightest run (in closed form where there is one; its own estimate is a thirtieth
of what is told at most, else the run does not count) at 40 times, each over the scale of its body: the extent of its
way, its largest speeds, 1 rad. Estimates are of reactions and events too, so a true error that is smaller is no fault;
more than 1 is one. A dash: too small to be told from rounding.
"""

import statistics
import sys
import time

import numpy as np
import rbdyn as rb
from scenes import SMOOTH, STIFF

ASKED = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11)
LIMIT = 3.0


def run_of(scene, until, **options):
    began = time.thread_time()

    def watch(_):
        if time.thread_time() - began > LIMIT:
            raise TimeoutError

    try:
        return rb.simulate(scene, until, progress=watch, **options)
    except (rb.AccuracyError, rb.IntegrationError, rb.InvalidInput, TimeoutError):
        return None


def tightest(scene, until):
    for error in (1e-14, 1e-13, 3e-13, 1e-12, 1e-10):
        run = run_of(scene, until, error=error)
        if run is not None:
            return run
    return None


def true_error(run, exact):
    """Times next to events are left out: velocities jump there, and errors of events are told over the time."""
    t = np.linspace(0.0, exact.end, 42)[1:-1]
    near = [e.time for e in exact.events]
    t = np.array([x for x in t if all(abs(x - e) > 1e-3 * exact.end / 42 for e in near)])
    # scales are of the whole motion: what begins fast may be slow at all of these times
    whole = np.linspace(exact.start, exact.end, 2001)
    worst = 0.0

    def compare(found, wanted, scale):
        nonlocal worst
        if scale > 0.0:
            worst = max(worst, np.max(np.linalg.norm(found - wanted, axis=1)) / scale)

    for body in exact.bodies:
        one, other = exact[body], run[body]
        compare(other.position(t), one.position(t), np.linalg.norm(np.ptp(one.position(whole), axis=0)))
        compare(other.velocity(t), one.velocity(t), np.max(np.linalg.norm(one.velocity(whole), axis=1)))
        try:
            fastest = np.max(np.linalg.norm(one.angular_velocity(whole), axis=1))
        except (AttributeError, rb.InvalidInput):
            continue  # a particle
        compare(other.angular_velocity(t), one.angular_velocity(t), fastest)
        # the angle between two attitudes [rad]; a quaternion and its opposite are one
        wanted, found = one.quaternion(t), other.quaternion(t)
        found = found * np.sign(np.sum(found * wanted, axis=1))[:, None]
        compare(2.0 * found, 2.0 * wanted, 1.0)
    return worst


def main():
    suite = {**SMOOTH, **STIFF}
    print("| scene | engine | runs | true / told: worst | median | told / true: worst | median |")
    print("|---|---|---|---|---|---|---|")
    everything = []
    for name in sys.argv[1:] or suite:
        scene, until = suite[name]()
        exact = tightest(scene, until)
        for engine in ("auto", *rb.engines()):
            ratios = []
            for error in ASKED:
                run = run_of(scene, until, error=error, engine=engine) if exact is not None else None
                if run is None or run.error < 30.0 * exact.error:
                    continue
                ratios.append(true_error(run, exact) / run.error)
            ratios = [r for r in ratios if r > 0.0]
            if not ratios:
                continue
            everything += ratios
            inverse = [1.0 / r for r in ratios]
            print(
                f"| {name} | {engine} | {len(ratios)} | {max(ratios):.2f} | {statistics.median(ratios):.2f} "
                f"| {max(inverse):.3g} | {statistics.median(inverse):.3g} |",
                flush=True,
            )
    more = sum(r > 1.0 for r in everything)
    print(f"\n{len(everything)} runs: true over told {max(everything):.2f} at worst, median ", end="")
    print(f"{statistics.median(everything):.2f}; more than 1 in {more}")


if __name__ == "__main__":
    main()
