"""What contacts cost: a step, an event, friction, and a contact that never closes, beside the same scene without.

Each motion is integrated with rtol=1e-12, the least of as many runs as fit into half a second; of the events' price the
motion is run with twice as many of them. Prints a table; docs/benchmarks.md has one.
"""

import time

import numpy as np
import rbdyn as rb

GRAVITY, FLOOR = 9.8125, rb.Plane([0, 0, 1])


def integrated(scene, until):
    """Microseconds, steps, events and the size of the equations."""
    run = rb.simulate(scene, until, rtol=1e-12, engine="taylor")
    best, began = np.inf, time.perf_counter()
    while time.perf_counter() - began < 0.5:
        best = min(best, rb.simulate(scene, until, rtol=1e-12, engine="taylor").statistics.integration_seconds)
    return 1e6 * best, run.statistics.steps, len(run.events), run.statistics.size


def weight(slope=0.0):
    return rb.Scene(gravity=[GRAVITY * np.sin(slope), 0, -GRAVITY * np.cos(slope)])


def thrown(contact):
    """A body thrown up high, its corner never on the floor."""
    scene = weight()
    box = scene.add(
        rb.shapes.box(1.0, [0.3, 0.4, 0.5]), position=[0, 0, 50], velocity=[1, 0, 5], angular_velocity=[1, 2, 3]
    )
    if contact:
        scene.contact(box.point([0.15, 0.2, 0.25]), FLOOR)
    return scene, 2.0


def on_floor(contact, friction=None):
    """A ball that slides along an incline: held there by a joint, or by contact."""
    scene = weight(0.5)
    ball = rb.shapes.sphere(mass=1.0, radius=0.1)
    start = {"velocity": [1, 0.2, 0], "angular_velocity": [1, 2, 3]}
    if not contact:
        scene.add(ball, position=[0, 0, 0.1], **start)
        return scene, 1.0
    handle = scene.add(ball, position=[0, 0, 0.1], **start)
    scene.contact(handle.sphere(0.1), FLOOR, friction=friction)
    return scene, 1.0


def box(contact, friction=None):
    """A box that slides down an incline on its four corners."""
    scene = weight(0.5)
    handle = scene.add(rb.shapes.box(1.0, [0.4, 0.4, 0.2]), position=[0, 0, 0.1], velocity=[1, 0.0, 0])
    for x in (-0.2, 0.2):
        for y in (-0.2, 0.2):
            if contact:
                scene.contact(handle.point([x, y, -0.1]), FLOOR, friction=friction)
    return scene, 1.0


def rod(contact, friction=None):
    """A rod that slides down in a plane, one end on the floor."""
    scene = weight()
    handle = scene.add(
        rb.shapes.rod(mass=1.0, length=1.0, along=[1, 0, 0]),
        rb.Planar([1, 0, 0], [0, 0, 1]),
        position=[0, 0.5 * np.sin(1.0)],
        angle=-1.0,
        rate=0.5,
        velocity=[1.0, -0.25 * np.cos(1.0)],
    )
    if contact:
        scene.contact(handle.point([0.5, 0, 0]), FLOOR, friction=friction)
    return scene, 0.2


def bouncing(impacts, friction=None):
    """A ball that bounces without loss."""
    scene = weight()
    ball = scene.add(rb.shapes.sphere(mass=1.0, radius=0.1), position=[0, 0, 1.1], velocity=[1, 0, 0])
    scene.contact(ball.sphere(0.1), FLOOR, restitution=1.0, friction=friction)
    return scene, (2 * impacts - 0.5) * np.sqrt(2.0 / GRAVITY)


ROUGH = rb.Coulomb(0.2)
ROWS = [
    ("body thrown", thrown(False)),
    ("the same, a contact that never closes", thrown(True)),
    ("rod in a plane, falling free", rod(False)),
    ("the same, an end slides on a smooth floor", rod(True)),
    ("the same, on a rough floor", rod(True, ROUGH)),
    ("ball, falling free", on_floor(False)),
    ("the same, slides down a smooth incline", on_floor(True)),
    ("the same, down a rough incline, its slip turning", on_floor(True, ROUGH)),
    ("box, falling free", box(False)),
    ("the same, down a smooth incline on four corners", box(True)),
    ("the same, down a rough incline", box(True, ROUGH)),
    ("ball, 20 bounces, smooth", bouncing(20)),
    ("the same, 40 bounces", bouncing(40)),
    ("ball, 20 bounces, rough", bouncing(20, ROUGH)),
    ("the same, 40 bounces", bouncing(40, ROUGH)),
]


def main():
    print("| motion | instructions | guards | steps | events | time [us] | a step [us] |")
    print("|---|---|---|---|---|---|---|")
    times = []
    for name, (scene, until) in ROWS:
        spent, steps, events, size = integrated(scene, until)
        times.append((spent, events))
        counts = (size.instructions, size.guards, steps, events)
        print(f"| {name} | {' | '.join(map(str, counts))} | {spent:.1f} | {spent / steps:.2f} |", flush=True)
    for name, first in (("smooth", 11), ("rough", 13)):
        (a, n), (b, m) = times[first], times[first + 1]
        print(f"\nan impact, {name}, with the step after it: {(b - a) / (m - n):.2f} us", end="")
    # friction is in the equations of what is rough, and of nothing else
    smooth = rb.plan(box(True)[0]).size
    assert rb.plan(box(True, rb.Coulomb(0.0))[0]).size == smooth
    print()


if __name__ == "__main__":
    main()
