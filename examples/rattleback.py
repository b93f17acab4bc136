"""A rattleback: spun one way it goes on for long, spun the other it begins to rattle, stops, and turns back.

An ellipsoid that rolls without slip, its axes turned by a small angle against those of its inertia (H. Bondi, The
rigid body dynamics of unidirectional spin, Proc. R. Soc. A 405, 1986). Nothing is lost: what the spin loses, the
rattling has, so in time it turns back from the other sense too, far later, since there the slower oscillation grows.
"""

from typing import Any

import matplotlib.pyplot
import numpy as np
import rbdyn as rb

MASS, SEMI_AXES, LOW, SKEW, SPIN, WOBBLE = 1.0, [0.2, 0.03, 0.02], 0.01, 0.05, 3.0, 0.01
c, s = np.cos(SKEW), np.sin(SKEW)
axes = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
stone = rb.RigidBody(MASS, axes @ np.diag([2e-4, 1.6e-3, 1.7e-3]) @ axes.T)


def spun(spin: float) -> tuple[rb.Trajectory, Any, Any]:
    """The run, and the spin at times."""
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    height = SEMI_AXES[2] - LOW  # its centre of mass lies below the centre of the ellipsoid
    turning = [WOBBLE, WOBBLE, spin]
    body = scene.add(
        stone,
        position=[0, 0, height],
        angular_velocity=turning,
        velocity=np.cross(turning, [0, 0, height]),
    )
    surface = body.ellipsoid(SEMI_AXES, [0, 0, LOW])
    scene.contact(surface, rb.Plane([0, 0, 1]), friction=rb.Coulomb(np.inf))
    scene.watch("turns back", lambda now: (now[body].rotation_matrix @ now[body].angular_velocity)[2])
    run = rb.simulate(scene, until=20.0, error=1e-8)
    t = np.linspace(0, run.end, 4001)
    w = np.einsum("nij,nj->ni", run[body].rotation_matrix(t), run[body].angular_velocity(t))[:, 2]
    energy = run.energy(t[::400])
    assert np.ptp(energy) < 1e-9 * energy[0]
    return run, t, w


against, t, w_against = spun(-SPIN)
along, _, w_along = spun(SPIN)
first, late = against.events.times("turns back")[0], along.events.times("turns back")[0]
print(against, f"spun clockwise it turns back after {first:.9f} s, spun the other way after {late:.9f} s", sep="\n")
assert first < 3.0 and late > 5 * first
assert w_against.max() > 0.99 * SPIN and w_along[t < 5].min() > 0.99 * SPIN

plt: Any = matplotlib.pyplot
figure, axis = plt.subplots(figsize=(9, 4), layout="constrained")
axis.plot(t, w_against, label="spun clockwise")
axis.plot(t, w_along, label="spun anticlockwise")
axis.axhline(0, color="gray", linewidth=0.5)
axis.set(xlabel="t [s]", ylabel="spin about the vertical [rad/s]")
axis.legend()
figure.savefig("rattleback.png")
