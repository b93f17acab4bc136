"""Chains of n bodies: what a mass and a step cost as n grows.

Springs of a length in space and hinged links, the first body kicked, and springs of which every other one is 1e6
times as stiff. Microseconds of processor time: of the plan per body; of an integration at a local tolerance, per body
and step; of simulate(error=1e-9) beside one such integration; of energy(t); and the peak of memory by then. Numbers of
bodies can be given: chains.py 10 1000.
"""

import resource
import sys
import time

import rbdyn as rb

UNTIL, SIZES, HINGED, STIFF = 1.0, (10, 100, 1000, 10000, 100000), (10, 100, 1000), (10, 100, 1000, 4000)


def hinged_until(n):
    """Until when a chain of n links is followed: its time goes with the length of a link, and its steps are as many."""
    return 20.0 / n


def seconds(call):
    began = time.thread_time()
    result = call()
    return time.thread_time() - began, result


def springs(n, stiff=False):
    scene = rb.Scene()
    last = None
    for i in range(n):
        velocity = [0.3, 0.4, 0.2] if i == 0 else [0.0, 0.0, 0.0]
        body = scene.add(rb.Particle(mass=1.0), position=[float(i), 0.0, 0.0], velocity=velocity)
        if last is not None:
            factor = (1e6 if i % 2 else 1.0) if stiff else 100.0
            scene.connect(rb.Spring(stiffness=factor, damping=factor if stiff else 0.0, rest_length=1.0), last, body)
        last = body
    return scene


def links(n, joint):
    """A heavy chain that hangs, 1 m and 1 kg in all."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    length = 1.0 / n
    across = length**2 / (12 * n)
    rod = rb.RigidBody(mass=1.0 / n, inertia=[across, across, across])
    last = {}
    for i in range(n):
        place = {"at": [0, 0, -length / 2 if i else 0.0], "point": [0, 0, length / 2]}
        if joint == "revolute":
            body = scene.add(rod, rb.Revolute(axis=[0, 1, 0], **place), rate=0.5 if i == 0 else 0.0, **last)
        else:
            turn = [0.3, 0.5, 0.1] if i == 0 else [0, 0, 0]
            body = scene.add(rod, rb.Spherical(**place), angular_velocity_world=turn, **last)
        last = {"parent": body}
    return scene


def measured(n, scene, until, engine="auto", rtol=1e-10, error=1e-9):
    planned, _ = seconds(lambda: rb.plan(scene))

    def integrate():
        return rb.simulate(scene, until, rtol=rtol, engine=engine, keep="end")

    # the least of many where one is short: the first ones compile
    once, run = seconds(integrate)
    for _ in range(max(2, min(300, int(0.3 / once)))):
        once, run = min((once, run), seconds(integrate), key=lambda pair: pair[0])
    judged = "-"
    if error is not None:
        judging = min(
            seconds(lambda: rb.simulate(scene, until, error=error, keep="end"))[0]
            for _ in range(max(1, min(100, int(0.1 / once))))
        )
        judged = f"{judging / once:.1f}"
    energy, _ = seconds(lambda: run.energy(until))
    steps = run.statistics.steps
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"| {n} | {1e6 * planned / n:.0f} | {steps} | {1e6 * once / n / steps:.2f} | {judged} | {1e3 * energy:.2f} "
        f"| {memory:.0f} |",
        flush=True,
    )


def table(name, sizes, make, until, *options, **more):
    wanted = [int(n) for n in sys.argv[1:] if n.isdigit()]
    print(f"\n{name}\n\n| n | plan, us a body | steps | us a body and step | error= over rtol= | energy, ms | MB |")
    print("|---|---|---|---|---|---|---|")
    for n in sizes:
        if not wanted or n in wanted:
            measured(n, make(n), until(n) if callable(until) else until, *options, **more)


def main():
    table("springs of a length, in space", SIZES, springs, UNTIL)
    table("hinged in a plane", HINGED, lambda n: links(n, "revolute"), hinged_until)
    table(
        "on ball joints, in space", HINGED, lambda n: links(n, "spherical"), lambda n: 0.2 * hinged_until(n), error=None
    )
    if "cvode-bdf" in rb.engines():
        stiff = {"rtol": 1e-6, "error": None}
        for engine in ("cvode-bdf", "auto"):
            table(f"stiff, {engine}", STIFF, lambda n: springs(n, stiff=True), UNTIL, engine, **stiff)


if __name__ == "__main__":
    main()
