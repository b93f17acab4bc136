"""The automatic choice beside each engine by itself: what simulate(error=) takes on the suite of scenes.

Milliseconds of processor time of the whole call, the plan kept from before, the least of several in turns; what takes
more than the limit is given up. The last column is how many times as long as the quickest named engine "auto" takes,
bits and steps of which are those of the engine it begins with wherever it changes nothing. Named engines are held
against a better run of their own or of the series, as simulate() does.
"""

import statistics
import sys
import time

import rbdyn as rb
from scenes import SMOOTH, STIFF

ERRORS = (1e-3, 1e-6, 1e-9, 1e-12)
LIMIT, REPEATS = 4.0, 5


def once(scene, until, error, engine):
    """Seconds of one call; none where the engine cannot do it, does not reach the error or takes too long."""
    began = time.thread_time()

    def watch(_):
        if time.thread_time() - began > LIMIT:
            raise TimeoutError

    try:
        run = rb.simulate(scene, until, error=error, engine=engine, keep="end", progress=watch)
    except (rb.AccuracyError, rb.IntegrationError, rb.InvalidInput, TimeoutError):
        return None
    return time.thread_time() - began if run.status != "step limit" else None


def measured(make, error):
    scene, until = make()
    rb.plan(scene)
    times = {engine: [once(scene, until, error, engine)] for engine in ("auto", *rb.engines())}
    times = {engine: found for engine, found in times.items() if found[0] is not None}
    for _ in range(REPEATS - 1):
        for engine, found in times.items():
            # twice, for the first may find the caches full of another engine's numbers
            if sum(found) < LIMIT / 4:
                found += [once(scene, until, error, engine) for _ in range(2)]
    return {engine: min(found) for engine, found in times.items()}


def main():
    suite = {**SMOOTH, **STIFF}
    names = ("auto", *rb.engines())
    print("| scene | error | " + " | ".join(names) + " | auto / best |\n|---|---|" + "---|" * (len(names) + 1))
    ratios = []
    for name in sys.argv[1:] or suite:
        for error in ERRORS:
            times = measured(suite[name], error)
            cells = [f"{1e3 * times[engine]:.3g}" if engine in times else "-" for engine in names]
            others = [seconds for engine, seconds in times.items() if engine != "auto"]
            ratio = ""
            if "auto" in times and others:
                ratios.append(times["auto"] / min(others))
                ratio = f"{ratios[-1]:.2f}"
            print(f"| {name} | {error:.0e} | " + " | ".join(cells) + f" | {ratio} |", flush=True)
    print(f"\nauto over the quickest named engine: worst {max(ratios):.2f}, median {statistics.median(ratios):.2f}")


if __name__ == "__main__":
    main()
