"""A bead slides off a smooth sphere at acos(2/3) and falls to the ground; another leaves a loop and lands again.

A rail with side="-" only pushes against the normal of its curve, which points to the center of a circle: outward,
like a sphere. With side="+" it pushes inward, like a loop. Where it would have to pull, the bead leaves it ("detach")
and flies; where it meets the curve again from that side it lands ("land").
"""

import math
from typing import Any

import numpy as np
import rbdyn as rb

RADIUS, GRAVITY = 1.0, 9.81


def sphere() -> tuple[rb.Trajectory, rb.BodyHandle]:
    """Off the sphere and down to the ground, with the closed form beside it."""
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    circle = rb.Circle(radius=RADIUS, start=[0, 0, 1], toward=[1, 0, 0])
    speed = 0.1 * math.sqrt(GRAVITY * RADIUS)
    bead = scene.add(rb.Particle(mass=0.2), rb.Rail(circle, side="-"), parameter=0.0, speed=speed)
    ground = scene.watch("ground", lambda now: now[bead].position[2] + RADIUS, direction="falling", action="stop")
    run = rb.simulate(scene, until=10.0, error=1e-11)

    # g cos(angle) = v^2/R with v^2 = v0^2 + 2 g R (1 - cos(angle)); from rest that is acos(2/3)
    (leaves,) = run.events.times("detach", bead)
    angle = math.acos(2 / 3 + speed**2 / (3 * GRAVITY * RADIUS))
    x, _, z = run[bead].position(leaves)
    print(f"leaves at {math.degrees(math.atan2(x, z)):.9f} degrees; from rest {math.degrees(math.acos(2 / 3)):.9f}")
    assert math.isclose(math.atan2(x, z), angle, rel_tol=1e-10)

    # flight: a parabola to the ground
    v = math.sqrt(GRAVITY * RADIUS * math.cos(angle))
    down, height = v * math.sin(angle), RADIUS * math.cos(angle) + RADIUS
    fall = (math.sqrt(down**2 + 2 * GRAVITY * height) - down) / GRAVITY
    assert math.isclose(run.end - leaves, fall, rel_tol=1e-9)
    assert abs(run[ground].value(run.end)) < 1e-9
    return run, bead


def loop() -> tuple[rb.Trajectory, rb.BodyHandle]:
    """Round the inside of a loop, too slow for its top: the bead leaves, flies across, and lands on the loop again."""
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    circle = rb.Circle(radius=RADIUS, start=[0, 0, -1], toward=[1, 0, 0])
    speed = math.sqrt(3.5 * GRAVITY * RADIUS)
    bead = scene.add(rb.Particle(mass=0.2), rb.Rail(circle, side="+"), parameter=0.0, speed=speed)
    run = rb.simulate(scene, until=2.0, error=1e-11)
    print(*run.events, sep="\n")

    # -cos(angle) = (v0^2/(g R) - 2)/3 at the angle where it leaves; the parabola then meets the circle at 3 times the
    # angle from the top, on the other side
    (leaves, *_), (lands, *_) = run.events.times("detach"), run.events.times("land")
    above = math.asin((3.5 - 2) / 3)  # over the horizontal
    x, _, z = run[bead].position(leaves)
    assert math.isclose(math.atan2(z, x), above, rel_tol=1e-9)
    x, _, z = run[bead].position(lands)
    assert math.isclose(math.remainder(math.atan2(z, x) - (-3 * above), 2 * math.pi), 0.0, abs_tol=1e-9)
    return run, bead


def figure(motions: dict[str, tuple[rb.Trajectory, rb.BodyHandle]], path: str) -> None:
    try:
        import matplotlib
        import matplotlib.pyplot
    except ImportError:
        print("no figure: matplotlib is not installed")
        return
    matplotlib.use("Agg")
    plt: Any = matplotlib.pyplot
    figure, axes = plt.subplots(1, len(motions), figsize=(9, 4.5), layout="constrained")
    for ax, (title, (run, bead)) in zip(axes, motions.items(), strict=True):
        around = np.linspace(0, 2 * np.pi, 200)
        ax.plot(RADIUS * np.sin(around), RADIUS * np.cos(around), color="0.7")
        position = run[bead].position(np.linspace(0, run.end, 400))
        ax.plot(position[:, 0], position[:, 2])
        for event in run.events:
            at = run[bead].position(event.time)
            ax.plot(at[0], at[2], "o", color="C1")
            ax.annotate(event.kind, at[[0, 2]], xytext=(5, 5), textcoords="offset points")
        ax.set(title=title, xlabel="x [m]", ylabel="z [m]", aspect="equal")
    figure.savefig(path)


figure({"off a sphere": sphere(), "inside a loop": loop()}, "leaving_the_sphere.png")
