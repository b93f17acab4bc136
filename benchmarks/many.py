"""Members of a sweep a second: a Python loop over simulate(), simulate_many() on one and on two threads, and executors.

Each row is a scene with 2000 starts or numbers; microseconds a member of the whole call, least of five in turns, and
how many members were planned. `apart`: one after the other on one thread; all other ways but `loop` have members side
by side. `loop` sets what is varied and calls simulate(initial=) for each. `Dask`: Client.get_executor() of a local
cluster of two workers, left out where dask.distributed is not installed.
"""

import contextlib
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial

import numpy as np
import rbdyn as rb

COUNT = 2000
DOWN = [0, 0, -9.8125]


def thrown():
    scene = rb.Scene(gravity=DOWN)
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1], velocity=[1, 0, 4])
    scene.apply(rb.Drag(linear=0.1, quadratic=0.02), ball)
    return scene, {(ball, "velocity"): np.outer(np.linspace(1, 9, COUNT), [1, 0, 1])}, 1.0


def stiffness():
    k = rb.parameter(4.0, "k")
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[0, 1, 0])
    scene.apply(rb.Force(lambda t, r, v: -k * (r @ r) * r), ball)
    return scene, {k: np.linspace(1, 9, COUNT)}, 1.0


def hoop():
    scene = rb.Scene(gravity=DOWN)
    rail = rb.Rail(rb.Circle(1.0, [0, 0, -1], [1, 0, 0]), friction=rb.Coulomb(0.15, 0.1))
    bead = scene.add(rb.Particle(1.0), rail, parameter=2.0)
    return scene, {(bead, "speed"): np.linspace(3, 9, COUNT)}, 10.0


def body():
    scene = rb.Scene(gravity=DOWN)
    unequal = rb.RigidBody(0.5, [0.0022, 0.0019, 0.001])
    it = scene.add(unequal, rb.Spherical(point=[0.01, 0, -0.05]))
    return scene, {(it, "angular_velocity"): np.outer(np.linspace(20, 40, COUNT), [0.01, 0.02, 1])}, 0.5


def top():
    scene = rb.Scene(gravity=DOWN)
    symmetric = rb.RigidBody(0.5, [0.0008, 0.0008, 0.001], com=[0, 0, 0.05])
    it = scene.add(symmetric, rb.Spherical(), attitude=rb.EulerAngles(0.3, 0, 0))
    return scene, {(it, "angular_velocity"): np.outer(np.linspace(200, 400, COUNT), [0, 0, 1])}, 1.0


def pendulum():
    bar = rb.RigidBody(1.0, [0.5, 0.5, 0.25], com=[0, 0, -0.5])
    scene = rb.Scene(gravity=DOWN)
    upper = scene.add(bar, rb.Revolute([0, 1, 0]))
    lower = scene.add(bar, rb.Revolute([0, 1, 0], at=[0, 0, -1]), parent=upper)
    return scene, {(upper, "angle"): np.linspace(0, 1, COUNT), (lower, "rate"): np.linspace(0, 1, COUNT)}, 0.25


SCENES = {
    "particle with drag, starts": thrown,
    "particle, a number of its force": stiffness,
    "rough hoop, starts": hoop,
    "body on a ball joint, starts": body,
    "top in closed form, spins": top,
    "double pendulum, starts": pendulum,
}


def loop(scene, vary, until, **options):
    runs = []
    for i in range(COUNT):
        for key, values in vary.items():
            if not isinstance(key, tuple):
                key.value = values[i]
        initial = {key: values[i] for key, values in vary.items() if isinstance(key, tuple)}
        runs.append(rb.simulate(scene, until, initial=initial, **options))
    return runs


@contextlib.contextmanager
def dask_executor():
    """That of a local cluster of two workers; none where there is no dask.distributed."""
    try:
        from dask.distributed import Client, LocalCluster
    except ImportError:
        yield None
        return
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
        client.get_executor() as executor,
    ):
        yield executor


def least(ways, repeats=5):
    """Microseconds of one member by each of some functions, in turns, and what came of the last."""
    best, results = [np.inf] * len(ways), [None] * len(ways)
    for _ in range(repeats):
        for i, way in enumerate(ways):
            results[i] = None
            began = time.perf_counter()
            results[i] = way()
            best[i] = min(best[i], (time.perf_counter() - began) / COUNT * 1e6)
    return best, results


def main():
    with ThreadPoolExecutor(2) as threads, ProcessPoolExecutor(2) as processes, dask_executor() as dask:
        many = rb.simulate_many
        ways = [
            ("loop", loop, {}),
            ("apart", many, {"threads": 1, "lanes": False}),
            ("1 thread", many, {"threads": 1}),
            ("2 threads", many, {"threads": 2}),
            ("pool of 2 threads", many, {"executor": threads}),
            ("2 processes", many, {"executor": processes}),
        ]
        if dask is not None:
            ways.append(("Dask", many, {"executor": dask}))
        for options in ({"error": 1e-9}, {"rtol": 1e-9}):
            print(f"microseconds a member, {COUNT} members, {options}")
            print(f"  {'':34}" + "".join(f"{name:>19}" for name, _, _ in ways) + f"{'planned':>9}")
            for name, make in SCENES.items():
                scene, vary, until = make()
                row, results = least([partial(run, scene, vary, until, **options, **how) for _, run, how in ways])
                planned = sum(s.planned for s in results[1].statistics)
                print(f"  {name:34}" + "".join(f"{x:19.1f}" for x in row) + f"{planned:9}", flush=True)


if __name__ == "__main__":
    main()
