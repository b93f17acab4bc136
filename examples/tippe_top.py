"""A tippe top: spun about the vertical it turns over, stands on its other end, and turns the other way about its axis.

A ball whose centre of mass lies below its middle, on a table it slides on. Friction at the contact takes spin about the
axis and leaves the angular momentum about the line from the centre of mass to the contact, Jellett's integral (J. H.
Jellett, A treatise on the theory of friction, 1872); where (1 - e) < A/C < 1 + e the top turns over (A. C. Or, The
dynamics of a tippe top, SIAM J. Appl. Math. 54, 1994).
"""

import math
from typing import Any

import matplotlib.pyplot
import numpy as np
import rbdyn as rb

RADIUS, MASS, LOW, RATIO, FRICTION, TILT, SPIN = 0.02, 0.015, 0.15, 0.95, 0.1, 0.3, 200.0
along = 0.4 * MASS * RADIUS**2
scene = rb.Scene(gravity=[0, 0, -9.8125])
top = scene.add(
    rb.RigidBody(MASS, [RATIO * along, RATIO * along, along]),
    position=[0, 0, RADIUS * (1 - LOW * math.cos(TILT))],
    attitude=rb.EulerAngles(theta=TILT, psi=0.0, phi=0.0),
    angular_velocity=[0, SPIN * math.sin(TILT), SPIN * math.cos(TILT)],
)
touch = scene.contact(top.sphere(RADIUS, [0, 0, LOW * RADIUS]), rb.Plane([0, 0, 1]), friction=rb.Coulomb(FRICTION))
run = rb.simulate(scene, until=6.0, error=1e-8)
print(run, *run.events, sep="\n")

t = np.linspace(0, run.end, 4001)
axes, w = run[top].rotation_matrix(t), run[top].angular_velocity(t)
tilt = np.degrees(np.arccos(axes[:, 2, 2]))
momentum = w * [RATIO * along, RATIO * along, along]
arm = LOW * np.array([0, 0, 1.0]) - axes[:, 2, :]  # to the contact, over the radius, axes of the top
jellett = np.einsum("ni,ni->n", momentum, arm)
print(f"tilt {tilt[0]:.3f} degrees at first, {tilt[-1]:.3f} at last; spin about its axis {w[0, 2]:.1f}, {w[-1, 2]:.1f}")
print(f"Jellett's integral stays within {np.ptp(jellett) / abs(jellett[0]):.1e}")
assert tilt[0] < 20 and tilt[-1] > 175 and np.sign(w[-1, 2]) == -np.sign(w[0, 2])
assert np.ptp(jellett) < 1e-8 * abs(jellett[0])
height = run[top].position(t)[:, 2]
assert np.allclose(height, RADIUS * (1 - LOW * axes[:, 2, 2]), rtol=0, atol=1e-14)
(sticks,) = map(float, run.events.times("stick", touch))
energy = run.energy(t)
assert (np.diff(energy[t < sticks]) < 1e-12 * energy[0]).all() and np.ptp(energy[t > sticks]) < 1e-8 * energy[0]

plt: Any = matplotlib.pyplot
figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4), layout="constrained")
left.plot(t, tilt)
left.set(xlabel="t [s]", ylabel="tilt [degrees]")
middle.plot(t, w[:, 2])
middle.set(xlabel="t [s]", ylabel="spin about its own axis [rad/s]")
right.plot(t, 1e3 * height)
right.set(xlabel="t [s]", ylabel="height of the centre of mass [mm]")
figure.savefig("tippe_top.png")
