"""Kapitza's pendulum: how far must a hoop be shaken so that a bead stays at its top? One scene, one number swept."""

import numpy as np
import rbdyn as rb

gravity, radius, rate = 9.81, 0.1, 300.0  # m/s^2, m, rad/s
shake = rb.parameter(0.0, "shake")  # m; runs take it as it is when they start

scene = rb.Scene(gravity=[0, 0, -gravity])
circle = rb.Circle(radius, start=[0, 0, 1], toward=[1, 0, 0])  # parameter 0 is the top
hoop = rb.Rail(circle, motion=lambda t: [0.0, 0.0, shake * np.sin(rate * t)])
bead = scene.add(rb.Particle(mass=0.01), hoop, parameter=0.05)


def run_with(value: float) -> rb.Trajectory:
    shake.value = value
    return rb.simulate(scene, 5.0, error=1e-6)


def strays(run: rb.Trajectory) -> float:
    """The largest angle from the top [rad]."""
    return float(np.max(np.abs(run[bead].parameter(np.linspace(0.0, run.end, 2001)))))


planned = 0
for value in np.linspace(0.002, 0.008, 13):
    run = run_with(value)
    planned += run.statistics.planned
    angle = min(strays(run), np.pi)
    print(f"shaken by {1e3 * value:.1f} mm it strays {angle:5.3f} rad from the top  {'#' * round(12 * angle)}")
print(f"planned {planned} time, for all these values")
assert planned == 1  # no effect came or went

low, high = 0.002, 0.008
while high - low > 1e-5:
    middle = 0.5 * (low + high)
    low, high = (low, middle) if strays(run_with(middle)) < 1.0 else (middle, high)
least = np.sqrt(2 * gravity * radius) / rate
print(f"it stays from {1e3 * high:.2f} mm on; for small angles and fast shaking theory says {1e3 * least:.2f} mm")
assert least < high < 1.1 * least
