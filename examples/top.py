"""A top let go with its axis at rest: it falls, is carried round and rises to rest again, in a cusp of its axis's path.

A solid cone on its apex. Nutation between the two roots of Lagrange's cubic, its period, and the reaction at a cusp are
compared with their closed forms; the picture shows the path of the axis from above, the angles and the reaction.
"""

import math
from typing import Any

import matplotlib.pyplot
import numpy as np
import rbdyn as rb

MASS, RADIUS, HEIGHT, GRAVITY, TILT, SPIN = 0.2, 0.04, 0.06, 9.81, 0.6, 250.0
cone = rb.shapes.cone(MASS, RADIUS, HEIGHT, axis=[0, 0, 1])
across, along = cone.inertia("origin")[0, 0], cone.inertia("origin")[2, 2]
arm = cone.com[2]
assert cone.is_gyroscope() and math.isclose(arm, 0.75 * HEIGHT)

scene = rb.Scene(gravity=[0, 0, -GRAVITY])
start = rb.EulerAngles(theta=TILT, psi=0.0, phi=0.0)
top = scene.add(cone, rb.Spherical(), attitude=start, angular_velocity=[0, 0, SPIN], name="top")


def climb(now: rb.Now) -> Any:
    """d(cos theta)/dt, from R' = R [omega]x."""
    r, w = now[top].rotation_matrix, now[top].angular_velocity
    return r[2, 0] * w[1] - r[2, 1] * w[0]


scene.watch("cusp", climb, direction="falling")
scene.watch("lowest", climb, direction="rising")
run = rb.simulate(scene, until=2.0, error=1e-12)
print(rb.plan(scene), run, sep="\n")
motion = run[top]

# u = cos(theta): u'^2 = beta (u0 - u) (1 - u^2 - 2 a (u0 - u)), zero at u0, lowest and highest
beta, a = 2 * MASS * GRAVITY * arm / across, (along * SPIN) ** 2 / (4 * across * MASS * GRAVITY * arm)
u0 = math.cos(TILT)
root = math.sqrt(a * a - 2 * a * u0 + 1)
lowest, highest = a - root, a + root
x, y = 1.0, math.sqrt(1 - (u0 - lowest) / (highest - lowest))
while abs(x - y) > 1e-15 * x:
    x, y = (x + y) / 2, math.sqrt(x * y)
period = 2 * math.pi / x / math.sqrt(beta * (highest - lowest))  # 4 K(k)/sqrt(beta (highest - lowest))

cusps, lows = run.events.times("cusp"), run.events.times("lowest")
theta = motion.euler_angles(lows)[:, 0]
print(f"falls to {math.degrees(theta[0]):.10f} degrees; the cubic says {math.degrees(math.acos(lowest)):.10f}")
print(f"a cusp every {np.diff(cusps).mean():.14f} s; elliptic integral {period:.14f} s")
assert len(cusps) > 8 and np.allclose(cusps, period * np.arange(1, len(cusps) + 1), rtol=1e-13, atol=0)
assert np.allclose(np.cos(theta), lowest, rtol=0, atol=1e-13)

# at a cusp the axis is at rest and where it began, but for the precession
assert np.allclose(motion.euler_angles(cusps)[:, 0], TILT, rtol=0, atol=1e-12)
assert abs(motion.angular_velocity(cusps)[:, :2]).max() < 1e-9 * SPIN
psi = motion.euler_angles(cusps)[:, 1]
print(
    f"precession {psi[0] / period:.9f} rad/s; of a fast top m g l/(C omega) {MASS * GRAVITY * arm / along / SPIN:.9f}"
)
assert np.allclose(psi, psi[0] * np.arange(1, len(cusps) + 1), rtol=1e-12, atol=0)

# there the centre of mass only begins to fall: a = l theta'', A theta'' = m g l sin(theta)
fall = arm * MASS * GRAVITY * arm * math.sin(TILT) / across
held = motion.reaction(cusps)
print(f"the ground carries {held[0, 2]:.12f} N at a cusp, {motion.reaction(lows[0])[2]:.12f} N at the lowest place")
assert np.allclose(held[:, 2], MASS * (GRAVITY - fall * math.sin(TILT)), rtol=1e-11, atol=0)
assert np.allclose(np.hypot(held[:, 0], held[:, 1]), MASS * fall * math.cos(TILT), rtol=1e-9, atol=0)
assert abs(motion.reaction_torque(cusps)).max() < 1e-15

print("first integrals, largest departure:", {name: f"{size:.1e}" for name, size in run.drift.items()})
assert set(run.drift) == {"energy", "vertical angular momentum", "spin"} and max(run.drift.values()) < 1e-13

plt: Any = matplotlib.pyplot
figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4), layout="constrained")
t = np.linspace(0, run.end, 4000)
tip = motion.rotation_matrix(t)[:, :, 2]
left.plot(tip[:, 0], tip[:, 1])
at_cusps = motion.rotation_matrix(cusps)[:, :, 2]
left.plot(at_cusps[:, 0], at_cusps[:, 1], "o", markersize=3)
left.set(title="the axis from above", xlabel="x", ylabel="y", aspect="equal")
middle.plot(t, np.degrees(motion.euler_angles(t)[:, :2]), label=["nutation", "precession"])
middle.set(xlabel="t [s]", ylabel="[degrees]")
middle.legend()
right.plot(t, motion.reaction(t), label=["x", "y", "z"])
right.set(xlabel="t [s]", ylabel="reaction of the ground [N]")
right.legend()
figure.savefig("top.png")
