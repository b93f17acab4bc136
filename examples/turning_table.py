"""A ball that rolls on a turning table runs in circles, with 2/7 of the table's rate.

Without slip v' = 2/7 Omega x v: circles, wherever it starts and however fast (J. A. Burns, Ball rolling on a turntable:
analog for charged particle dynamics, Am. J. Phys. 49, 1981).
A second ball is put down without spin: it slides until it sticks, and then runs in a circle of its own.
"""

import math
from typing import Any

import matplotlib.pyplot
import numpy as np
import rbdyn as rb

RADIUS, RATE, TOP = 0.02, 3.0, 0.01
scene = rb.Scene(gravity=[0, 0, -9.8125])
table = scene.add(
    rb.shapes.cylinder(2.0, 0.5, 2 * TOP, axis=[0, 0, 1]),
    rb.Revolute([0, 0, 1], motion=lambda t: RATE * t),
    name="table",
)


def put(
    name: str, x: float, velocity: list[float], spin: list[float], mu: float
) -> tuple[rb.BodyHandle, rb.ContactHandle]:
    """A ball on the table."""
    ball = scene.add(
        rb.shapes.sphere(0.1, RADIUS),
        position=[x, 0, TOP + RADIUS],
        velocity=velocity,
        angular_velocity=spin,
        name=name,
    )
    return ball, scene.contact(ball.sphere(RADIUS), table.plane([0, 0, 1], [0, 0, TOP]), friction=rb.Coulomb(mu))


# what rolls has the table's velocity where it touches: v - R w x k = Omega k x r
START, SPEED = 0.2, 0.15
rolling, _ = put("rolls", START, [0, SPEED, 0], [(RATE * START - SPEED) / RADIUS, 0, 0], math.inf)
sliding, touch = put("slides first", -0.1, [0, 0.1, 0], [0, 0, 0], 0.05)
run = rb.simulate(scene, until=30.0, error=1e-10)
print(run, *run.events, sep="\n")

t = np.linspace(0, run.end, 2001)
part = 2 / 7 * RATE
center = START - SPEED / part
x, y, z = run[rolling].position(t).T
assert np.allclose(x, center + SPEED / part * np.cos(part * t), rtol=0, atol=1e-9)
assert np.allclose(y, SPEED / part * np.sin(part * t), rtol=0, atol=1e-9) and np.ptp(z) < 1e-14
print(f"circle of {SPEED / part:.6f} m about {center:.6f} m, one turn in {2 * math.pi / part:.6f} s")

(sticks,) = map(float, run.events.times("stick", touch))
later = np.linspace(sticks, run.end, 500)[1:]
place, v = run[sliding].position(later), run[sliding].velocity(later)
speeds = np.linalg.norm(v, axis=1)
about = place[:, :2] - np.column_stack([v[:, 1], -v[:, 0]]) / part
print(f"sticks after {sticks:.12f} s and goes on at {speeds[0]:.9f} m/s about {about[0]}")
assert np.ptp(speeds) < 1e-9 and np.ptp(about, axis=0).max() < 1e-9

plt: Any = matplotlib.pyplot
figure, axes = plt.subplots(figsize=(6, 6), layout="constrained")
for ball in (rolling, sliding):
    path = run[ball].position(t)
    axes.plot(path[:, 0], path[:, 1], label="rolls" if ball == rolling else "slides first")
axes.add_patch(plt.Circle((0, 0), 0.5, fill=False, color="gray"))
axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", title="seen from above, at rest")
axes.legend()
figure.savefig("turning_table.png")
