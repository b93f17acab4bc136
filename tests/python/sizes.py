"""What the plan says of the size of a motion is what the statistics of its run count: held of every run that is made.

import compares those of this process from then on; `python sizes.py PROGRAM` those of a program. A run that does not
begin at time 0 is not compared: the plan speaks of the motion from there.
"""

import copy
import functools
import runpy
import sys

import rbdyn as rb

compared, skipped = 0, 0


def announced(simulate):
    """simulate(), and its run held against the plan."""

    @functools.wraps(simulate)
    def compare(scene, *arguments, **options):
        global compared, skipped
        run = simulate(scene, *arguments, **options)
        if not isinstance(scene, rb.Scene) or options.get("start", 0.0) != 0.0:
            skipped += 1
            return run
        compared += 1
        if options.get("initial"):
            scene = copy.copy(scene)
            for (handle, word), value in options["initial"].items():
                scene.replace(scene[handle] if isinstance(handle, str) else handle, **{word: value})
        plan = rb.plan(scene)
        assert run.statistics.size == plan.size, f"{run.statistics.size} is not what the plan says\n{plan}"
        return run

    return compare


rb.simulate = announced(rb.simulate)

if __name__ == "__main__":
    sys.argv = sys.argv[1:]
    runpy.run_path(sys.argv[0], run_name="__main__")
