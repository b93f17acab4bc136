"""The racket that turns over: rotation about the intermediate axis does not stay (intermediate axis theorem).

A hoop welded to a handle, thrown with its face up and spinning about the axis in the face across the handle. It turns
over about the handle, again and again, at equal times: half periods of the elliptic functions of Euler's equations
(7.53). About the other two axes the same disturbance stays as small as it was.
"""

import math
from typing import Any

import matplotlib.pyplot
import numpy as np
import numpy.typing as npt
import rbdyn as rb

Vector = npt.NDArray[np.float64]

hoop = rb.shapes.ring(mass=0.15, radius=0.13, normal=[0, 0, 1]).shifted([0.13, 0, 0])
handle = rb.shapes.rod(mass=0.12, length=0.4, along=[1, 0, 0]).shifted([-0.2, 0, 0])
racket = hoop + handle
moments, axes = racket.principal()
print("moments along the handle, across it, along the normal of the face:", np.round(moments, 6), "kg m^2")
assert moments[0] < moments[1] < moments[2] and np.allclose(np.diag(moments), racket.inertia(), atol=1e-17)


def from_flip_to_flip(inertia: Vector, omega: Vector) -> float:
    """2 K(m)/mu by the arithmetic-geometric mean, for K around the axis of the largest moment or of the least."""
    a, b, c = inertia
    beyond = c * (c - b) * omega[2] ** 2 - a * (b - a) * omega[0] ** 2  # K^2 - 2 E I2
    if beyond < 0:  # the least: 1 and 3 change places
        a, c, omega, beyond = c, a, omega[::-1], -beyond
    around = (c - b) * (b * (b - a) * omega[1] ** 2 + c * (c - a) * omega[2] ** 2)
    x, y = math.sqrt(abs(around / (a * b * c))), math.sqrt(abs((c - a) * beyond / (a * b * c)))  # mu, mu sqrt(1 - m)
    while abs(x - y) > 1e-15 * x:
        x, y = (x + y) / 2, math.sqrt(x * y)
    return math.pi / x


def thrown(
    axis: int, speed: float = 12.0, disturbance: float = 0.02, until: float = 20.0
) -> tuple[rb.Trajectory, rb.BodyHandle, Vector]:
    """In weightlessness, about one of the axes, a little disturbed about the others."""
    omega = np.full(3, disturbance)
    omega[axis] = speed
    scene = rb.Scene()
    body = scene.add(racket, angular_velocity=omega, name="racket")
    scene.watch("turns over", lambda now: now[body].angular_velocity[axis])
    return rb.simulate(scene, until=until, error=1e-12), body, omega


run, body, omega = thrown(axis=1)
print(run, f"  {run.plan.engine}: {run.plan.reason}", sep="\n")
times = run.events.times("turns over")
exact = from_flip_to_flip(moments, omega)
print(f"turns over every {np.diff(times).mean():.13f} s; 2 K/mu = {exact:.13f} s")
assert len(times) > 5 and np.allclose(np.diff(times), exact, rtol=1e-13, atol=0)

# between two passages the face is the other way round: up and down, while K and the energy stay
middles = (times[:-1] + times[1:]) / 2
assert np.all(np.sign(run[body].angular_velocity(middles)[:, 1]) == np.resize([-1, 1], len(middles)))
assert max(run.drift.values()) < 1e-14

# about the axes of the least and the largest moment: never
t = np.linspace(0, 20, 2001)
for axis in (0, 2):
    steady, other, _ = thrown(axis)
    sideways = np.delete(steady[other].angular_velocity(t), axis, axis=1)
    print(f"about axis {axis + 1} the disturbance of 0.02 rad/s stays below {abs(sideways).max():.3f} rad/s")
    assert not steady.events and abs(sideways).max() < 0.2

# thrown up for real: in a flight of one second the face that was up comes down
scene = rb.Scene(gravity=[0, 0, -9.81])
real = scene.add(racket, position=[0, 0, 1], velocity=[0, 0, 4.9], angular_velocity=[0.1, 12, 0.1])
flight = rb.simulate(scene, until=1.0, error=1e-12)
print(f"a throw of a second turns it over {np.count_nonzero(times < 1.0)} times")
assert np.allclose(np.diff(flight[real].center_of_mass_velocity([0, 1.0])[:, 2]), -9.81)

plt: Any = matplotlib.pyplot
figure = plt.figure(figsize=(11, 4), layout="constrained")
left, right = figure.add_subplot(121), figure.add_subplot(122, projection="3d")
t = np.linspace(0, 8, 4000)
path = run[body].angular_velocity(t)
left.plot(t, path, label=["along the handle", "across it", "normal to the face"])
left.plot(times[times < 8], 0 * times[times < 8], "o", color="k")
left.set(xlabel="t [s]", ylabel="angular velocity, body axes [rad/s]")
left.legend(loc="lower right")
right.plot(*path.T)
right.set(xlabel="along", ylabel="across", zlabel="normal", title="its path in the body: the polhode")
figure.savefig("racket.png")
