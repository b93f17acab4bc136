"""Kater's reversible pendulum: gravity from a length and a period, and what the bearing carries meanwhile.

A bar with two weights swings about either of two edges. Where both periods are equal the distance of the edges is the
length of the simple pendulum of that period, whatever the bar's inertia (Huygens, 7.60). A screw off the plane of the
swing then loads the bearing with a torque that does not show in the motion.
"""

import math

import numpy as np
import numpy.typing as npt
import rbdyn as rb

Vector = npt.NDArray[np.float64]

GRAVITY, AMPLITUDE = 9.80665, math.radians(5)


def pendulum(where: float) -> rb.RigidBody:
    """A bar from 0 to -1.2 m with a heavy weight near its lower end and a light one at `where`."""
    bar = rb.shapes.box(mass=1.1, size=[0.03, 0.01, 1.2]).shifted([0, 0, -0.6])
    heavy = rb.shapes.cylinder(mass=2.5, radius=0.05, height=0.02, axis=[0, 1, 0]).shifted([0, 0, -1.1])
    light = rb.shapes.cylinder(mass=0.8, radius=0.04, height=0.02, axis=[0, 1, 0]).shifted([0, 0, where])
    return bar + heavy + light


EDGES = (np.array([0, 0, -0.05]), np.array([0, 0, -1.0]))  # 0.95 m apart


def swing(body: rb.RigidBody, edge: Vector, until: float = 20.0) -> tuple[rb.Trajectory, rb.BodyHandle]:
    """Hung on an edge, let go 5 degrees from the lowest place; upside down on the lower edge."""
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    lowest = 0.0 if body.com[2] < edge[2] else math.pi
    handle = scene.add(body, rb.Revolute(axis=[0, 1, 0], point=edge), angle=lowest + AMPLITUDE)
    scene.watch("passes", lambda now: now[handle].angle - lowest)
    return rb.simulate(scene, until=until, error=1e-12), handle


def period(body: rb.RigidBody, edge: Vector) -> float:
    """Of small oscillations: the measured one over the elliptic integral 2 K(sin(amplitude/2))/pi."""
    run, _ = swing(body, edge)
    times = run.events.times("passes")
    x, y = 1.0, math.cos(AMPLITUDE / 2)
    while abs(x - y) > 1e-15 * x:
        x, y = (x + y) / 2, math.sqrt(x * y)
    return float(2 * (times[-1] - times[0]) / (len(times) - 1) * x)


def difference(where: float) -> float:
    body = pendulum(where)
    return period(body, EDGES[0]) - period(body, EDGES[1])


# the light weight is moved until both periods are equal
low, high = -0.45, -0.2
assert difference(low) * difference(high) < 0
for _ in range(50):
    middle = (low + high) / 2
    low, high = (middle, high) if difference(low) * difference(middle) > 0 else (low, middle)
body = pendulum(low)
t0, t1 = (period(body, edge) for edge in EDGES)
measured = 4 * math.pi**2 * 0.95 / t0**2
print(f"light weight at {low:.12f} m: periods {t0:.13f} and {t1:.13f} s")
print(f"g from the period and the distance of the edges: {measured:.12f} m/s^2, true {GRAVITY} m/s^2")
assert math.isclose(t0, t1, rel_tol=1e-12) and math.isclose(measured, GRAVITY, rel_tol=1e-11)

# the arms multiply to the square of the radius of gyration
arms = [abs(body.com[2] - edge[2]) for edge in EDGES]
assert math.isclose(arms[0] * arms[1], body.inertia()[1, 1] / body.mass, rel_tol=1e-10)

# the bearing at the lowest place: m g + m h psi'^2, with psi'^2 from the energy
run, handle = swing(body, EDGES[0])
lowest = run.events.times("passes")
moment = body.inertia(EDGES[0])[1, 1]
rate_squared = 2 * body.mass * GRAVITY * arms[0] * (1 - math.cos(AMPLITUDE)) / moment
carried = body.mass * (GRAVITY + arms[0] * rate_squared)
print(f"the bearing carries {run[handle].reaction(lowest[0])[2]:.10f} N at the lowest place, {carried:.10f} N expected")
assert np.allclose(run[handle].reaction(lowest)[:, 2], carried, rtol=1e-12, atol=0)
assert abs(run[handle].reaction_torque(np.linspace(0, 20, 101))).max() < 1e-12

# a screw off the plane: the same motion about an axis that is no longer principal, and a torque on the bearing
screw = rb.shapes.points([0.05], [[0, 0.04, -1.1]])
counter = rb.shapes.points([0.05], [[0, -0.04, -0.2]])
skew, skewed = swing(body + screw + counter, EDGES[0])
torque = skew[skewed].reaction_torque(np.linspace(0, 20, 2001))
print(f"with two screws off its plane it takes {abs(torque).max(axis=0).round(6)} N m about x, y, z from the bearing")
assert abs(torque[:, 2]).max() > 1e-3 and abs(torque[:, 1]).max() < 1e-14  # none about the axis: the hinge is ideal
about = (body + screw + counter).inertia(EDGES[0])
turn = skew[skewed].rotation_matrix(2.5)
rate, push = skew[skewed].rate(2.5), skew[skewed].angular_acceleration(2.5)
spin = np.array([0, rate, 0])
arm = (body + screw + counter).com - EDGES[0]
needed = turn @ (about @ push + np.cross(spin, about @ spin))
weight = np.cross(turn @ arm, [0, 0, -GRAVITY * (body.mass + 0.1)])
assert np.allclose(skew[skewed].reaction_torque(2.5), needed - weight, rtol=0, atol=1e-13)  # 7.48
