"""Euler's disc: a coin that settles, its contact running round ever faster, with a stated rolling friction.

Without rolling friction it never falls: it goes round at the tilt it has, for as long as one waits. A torque rho N
against rolling takes the energy 3/2 m g R sin(tilt) of the steady motion at the rate rho m g times the turning along
the table. For small tilts sqrt(tilt) and 1/rate then fall linearly, 1/rate by rho/(3 R), and it all ends at a finite
time with an infinite rate. (Which friction real discs have: R. I. Leine, Experimental and theoretical investigation of
the energy dissipation of a rolling disk during its final stage of motion, Arch. Appl. Mech. 79, 2009.)
"""

import math
from typing import Any

import matplotlib.pyplot
import numpy as np
import numpy.typing as npt
import rbdyn as rb

GRAVITY, RADIUS, MASS, TILT, ROLLING = 9.8125, 0.0375, 0.4, 0.3, 2e-4
Numbers = npt.NDArray[np.float64]


def settled(rolling: float, until: float) -> tuple[rb.Trajectory, rb.BodyHandle]:
    """The disc in its steady motion, centre of mass at rest: rate^2 sin(tilt) = 4 g/R."""
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    rate = math.sqrt(4 * GRAVITY / (RADIUS * math.sin(TILT)))
    disc = scene.add(
        rb.shapes.disc(MASS, RADIUS, [0, 0, 1]),
        position=[0, 0, RADIUS * math.sin(TILT)],
        attitude=rb.EulerAngles(theta=TILT, psi=0.0, phi=0.0),
        angular_velocity=[0, rate * math.sin(TILT), 0],
    )
    touching = rb.Coulomb(math.inf, rolling=rolling)
    scene.contact(disc.disc(RADIUS, [0, 0, 1]), rb.Plane([0, 0, 1]), friction=touching)
    return rb.simulate(scene, until, error=1e-9), disc


def tilt_and_rate(run: rb.Trajectory, disc: rb.BodyHandle, t: Numbers) -> tuple[Numbers, Numbers]:
    """The tilt, and how fast the place of contact runs round: the axis's rate about the vertical."""
    axes, w = run[disc].rotation_matrix(t), run[disc].angular_velocity(t)
    axis, turn = axes[:, :, 2], w[:, 1, None] * axes[:, :, 0] - w[:, 0, None] * axes[:, :, 1]
    level = np.hypot(axis[:, 0], axis[:, 1])
    return np.arcsin(level), (axis[:, 0] * turn[:, 1] - axis[:, 1] * turn[:, 0]) / level**2


steady, disc = settled(0.0, 10.0)
tilt, rate = tilt_and_rate(steady, disc, np.linspace(0, 10, 1001))
print(f"without rolling friction: tilt {np.degrees(tilt[0]):.9f} degrees, after 10 s {np.degrees(tilt[-1]):.9f}")
assert np.ptp(tilt) < 1e-12 and np.ptp(rate) < 1e-9

END = 1.5 * RADIUS / ROLLING * math.sqrt(TILT * RADIUS / GRAVITY)  # where sqrt(tilt) has fallen to 0, for small tilts
run, disc = settled(ROLLING, 0.95 * END)
print(run)
t = np.linspace(0, run.end, 4001)
tilt, rate = tilt_and_rate(run, disc, t)
print(f"rate {rate[0]:.3f} rad/s at {np.degrees(tilt[0]):.3f} degrees; {rate[-1]:.3f} at {np.degrees(tilt[-1]):.3f}")
late = t > 0.9 * run.end  # it is the law of small tilts
line = np.polyfit(t[late], 1 / rate[late], 1)
slope, level = float(line[0]), float(line[1])
print(f"1/rate falls by {-slope:.7f}, rho/(3 R) is {ROLLING / 3 / RADIUS:.7f}; it ends at {-level / slope:.4f} s")
assert abs(-slope / (ROLLING / 3 / RADIUS) - 1) < 0.03 and abs(-level / slope / END - 1) < 0.01
assert rate[-1] > 20 * rate[0] and tilt[-1] < 0.003 * tilt[0]
# in the end it is the steady motion of each tilt
assert abs(rate[-1] ** 2 * math.sin(tilt[-1]) * RADIUS / (4 * GRAVITY) - 1) < 0.01

plt: Any = matplotlib.pyplot
figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4), layout="constrained")
left.plot(t, np.degrees(tilt))
left.set(xlabel="t [s]", ylabel="tilt [degrees]")
middle.plot(t, rate)
middle.set(xlabel="t [s]", ylabel="rate of the place of contact [rad/s]")
right.plot(t, 1 / rate)
right.plot(t, ROLLING / 3 / RADIUS * (-level / slope - t), "--", label="falls by rho/(3 R)")
right.set(xlabel="t [s]", ylabel="1/rate [s]")
right.legend()
figure.savefig("eulers_disc.png")
