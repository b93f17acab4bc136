"""The Earth as a rigid body: what free motion gives, what the Moon and the Sun give, and what has 13,000 years.

Free, the Earth is a gyroscope (7.56): its axis of rotation circles the axis of figure in some 300 days, and both circle
K in a day. That moves summer nowhere. What exchanges winter and summer is the precession of the equinoxes, a forced
motion: the Moon and the Sun pull at the equatorial bulge, K itself turns, once in about 25,800 years, and after half of
that, 12,900 years, the axis leans the other way.
"""

import math
from typing import Any

import numpy as np
import rbdyn as rb

DAY, YEAR = 86164.0905, 365.25 * 86400.0  # sidereal day, Julian year [s]
OMEGA = 2 * math.pi / DAY
MASS, C = 5.972e24, 8.0345e37  # kg, kg m^2
OBLIQUITY = math.radians(23.4393)
OFF = 1e-6  # of the pole of rotation from the pole of figure [rad]: 6 m on the ground


def free_motion(ratio: float) -> tuple[float, float]:
    """Periods of the pole in the Earth and of the axis about K, in sidereal days, with I1 = ratio I3."""
    alpha = (1 - ratio) / ratio
    scene = rb.Scene()
    start = [OFF * OMEGA, 0.0, OMEGA]
    earth = scene.add(rb.RigidBody(MASS, [ratio * C, ratio * C, C]), angular_velocity=start, name="Earth")
    scene.watch("round", lambda now: now[earth].angular_velocity[1], direction="falling")
    run = rb.simulate(scene, until=3.2 / alpha * DAY, error=1e-12)
    rounds = run.events.times("round")
    in_body = float(np.diff(rounds).mean()) / DAY
    assert math.isclose(in_body, 1 / alpha, rel_tol=1e-9)
    # e3 about K, by the angle it has gone round in an hour
    momentum = run.angular_momentum(0.0, of=earth)
    axis = run[earth].rotation_matrix(np.array([0.0, 3600.0]))[:, :, 2]
    side = np.cross(momentum / np.linalg.norm(momentum), axis)
    angle = math.atan2(np.linalg.norm(np.cross(side[0], side[1])), side[0] @ side[1])
    return in_body, 2 * math.pi * 3600.0 / angle / DAY


def forced_motion(bulge: float, years: float = 20.0) -> tuple[float, rb.Trajectory]:
    """Period of the precession [years] of an Earth with H = (C - A)/C = bulge, from the turn of its axis in `years`.

    The torque is averaged over the orbits of Moon and Sun, taken as rings in the ecliptic: 3/2 S (C - A) (e3.n) e3 x n
    with S the sum of G m/a^3, for the Moon less what its inclination of 5.145 degrees takes.
    """
    sun = (2 * math.pi / (365.25636 * 86400.0)) ** 2
    moon = (2 * math.pi / (27.321661 * 86400.0)) ** 2 / 82.3 * (1 - 1.5 * math.sin(math.radians(5.145)) ** 2)
    strength = 1.5 * (sun + moon) * bulge * C

    def pull(t: Any, rotation_matrix: Any, angular_velocity: Any) -> list[Any]:
        x, y, z = rotation_matrix[2]  # the ecliptic's pole n, in body axes
        return [-strength * z * y, strength * z * x, 0.0]  # e3 x n = (-y, x, 0)

    scene = rb.Scene()
    body = rb.RigidBody(MASS, [(1 - bulge) * C, (1 - bulge) * C, C])
    tilt = rb.EulerAngles(theta=OBLIQUITY, psi=0.0, phi=0.0)
    # without a nutation of its own: it starts with the precession it will have
    rate = -strength * math.cos(OBLIQUITY) / (C * OMEGA)
    start = [0.0, rate * math.sin(OBLIQUITY), OMEGA]
    earth = scene.add(body, attitude=tilt, angular_velocity=start, name="Earth")
    scene.apply(rb.Torque(pull), earth)
    run = rb.simulate(scene, until=years * YEAR, error=1e-8)
    theta, psi, _ = run[earth].euler_angles(run.end)
    assert psi < 0 and math.isclose(psi / run.end, rate, rel_tol=1e-4)  # backwards, as the formula says
    assert math.isclose(theta, OBLIQUITY, abs_tol=1e-7)  # the lean itself stays
    return -2 * math.pi * run.end / psi / YEAR, run


for ratio in (0.9966, 1 - 0.0032737):
    in_body, about_k = free_motion(ratio)
    print(
        f"I1 = {ratio:.6f} I3: the pole goes round in the Earth in {in_body:.2f} sidereal days"
        f" = {in_body * DAY / YEAR:.3f} years, the axis round K in {about_k:.4f} sidereal days"
    )
    if ratio == 0.9966:
        assert round(in_body, 2) == 293.12 and round(about_k, 4) == 0.9966
print("(observed: about 430 days, because the Earth yields)")

for bulge in (0.0034, 0.0032737):
    years, run = forced_motion(bulge)
    print(f"H = {bulge}: precession of the equinoxes in {years:.0f} years, winter becomes summer in {years / 2:.0f}")
    print(f"  {run.engine}, {run.statistics.steps} steps in {run.statistics.integration_seconds:.2f} s")
    assert 24500 < years < 26000
