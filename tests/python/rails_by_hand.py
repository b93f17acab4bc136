"""Rough beads on bodies that move, by Newton's laws written down here and integrated by DOP853: a reference that shares
nothing with the library.

A system gives, for a sign of the slip (0: the bead sticks), its accelerations, what of the reaction lies along the
curve and how large the rest is. Its state is (q, u, q', w), the slip |r'(u)| w less the drive.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

g = 9.81


class Hoop:
    """A hoop that swings about a pin at the origin, its centre at a distance, and a bead on it: all in one plane."""

    def __init__(self, mass, moment, distance, radius, bead, torque=lambda t: 0.0):
        self.mass, self.moment, self.distance, self.radius, self.bead, self.torque = (
            mass,
            moment,  # about the pin
            distance,
            radius,
            bead,
            torque,
        )

    def solve(self, t, y, mu, sign):
        theta, phi, w, rate = y
        psi, m, turn = theta + phi, self.bead, w + rate
        out, along = (lambda a: np.array([math.sin(a), -math.cos(a)])), (lambda a: np.array([math.cos(a), math.sin(a)]))
        p = self.distance * out(theta) + self.radius * out(psi)
        bent = -self.distance * out(theta) * w**2 - self.radius * out(psi) * turn**2

        def moment(force):
            return p[0] * force[1] - p[1] * force[0]

        def found(side):
            # unknown: theta'', psi'', N along out(psi), f along along(psi)
            a, b = np.zeros((4, 4)), np.zeros(4)
            a[:2, 0] = m * self.distance * along(theta)
            a[:2, 1] = m * self.radius * along(psi)
            a[:2, 2], a[:2, 3] = -out(psi), -along(psi)
            b[:2] = -m * bent - [0, m * g]
            a[2] = [self.moment, 0, moment(out(psi)), moment(along(psi))]
            b[2] = -self.mass * g * self.distance * math.sin(theta) + self.torque(t)
            a[3] = [-1, 1, 0, 0] if sign == 0 else [0, 0, mu * sign * side, 1]
            return np.linalg.solve(a, b)

        for side in (1, -1):
            x = found(side)
            if sign == 0 or x[2] * side >= 0:
                break
        return np.array([x[0], x[1] - x[0]]), x[3], abs(x[2]), x[2]

    def slip(self, t, y):
        return self.radius * y[3]

    def rest(self, t, y):
        return np.array([*y[:3], 0.0])


class Turntable:
    """A plate that a torque turns about a pin at the origin, across z, and a bead on a straight groove of it."""

    def __init__(self, mass, moment, com, bead, point, along, gravity, torque):
        self.mass, self.moment, self.com, self.bead = mass, moment, com, bead  # the moment about the pin
        self.point, self.along, self.gravity, self.torque = point, along, gravity, torque

    def solve(self, t, y, mu, sign, side):
        """theta'', u'' and the reaction along n = z x t, friction taken for mu sign side times that."""
        theta, u, w, rate = y
        turned = np.array([[math.cos(theta), -math.sin(theta)], [math.sin(theta), math.cos(theta)]])
        aside = np.array([[0.0, -1.0], [1.0, 0.0]])
        tangent, r = turned @ self.along, turned @ (self.point + self.along * u)
        normal, weight = aside @ tangent, np.array([0, -self.gravity])
        push = normal - mu * sign * side * tangent
        a, b = np.zeros((3, 3)), np.zeros(3)
        a[:2] = self.bead * np.column_stack([aside @ r, tangent, -push / self.bead])
        b[:2] = self.bead * (weight + r * w**2 - 2 * aside @ tangent * w * rate)
        a[2] = [self.moment, 0, (aside @ r) @ push]
        b[2] = (aside @ turned @ self.com) @ weight * self.mass + self.torque(t)
        return np.linalg.solve(a, b)

    def follow(self, y, until, mu):
        """The state at the end, and its events while it never sticks: (kind, sign of the change, time)."""
        t, events, y = 0.0, [], np.array(y, dtype=float)
        sign = int(math.copysign(1, y[3]))
        side = int(math.copysign(1, self.solve(t, y, 0.0, sign, 1)[2]))
        while True:

            def rates(t, y, sign=sign, side=side):
                return [*y[2:], *self.solve(t, y, mu, sign, side)[:2]]

            def stops(t, y):
                return y[3]

            def unloads(t, y, sign=sign, side=side):
                return self.solve(t, y, mu, sign, side)[2]

            stops.terminal = unloads.terminal = True
            stops.direction, unloads.direction = -sign, -side
            watched = [stops, unloads]
            found = solve_ivp(
                rates, (t, until), y, method="DOP853", rtol=3e-14, atol=1e-15, max_step=0.01, events=watched
            )
            t, y = found.t[-1], found.y[:, -1]
            if found.status == 0:
                return y, events
            if len(found.t_events[0]):
                sign = -sign
                events.append(("reverse", sign, t))
            else:
                side = -side
                events.append(("normal-zero", side, t))


class Carriage:
    """Three carriages on each other, along x, y and z, the last one on a spring, and a bead on a curve of that one."""

    def __init__(self, masses, bead, stiffness, curve, drive=lambda t: 0.0, drive_rate=lambda t: 0.0):
        self.mass = np.cumsum(masses[::-1])[::-1]  # what moves along each
        self.bead, self.stiffness, self.curve = bead, stiffness, curve
        self.drive, self.drive_rate = drive, drive_rate

    def solve(self, t, y, mu, sign):
        x, u, w = y[:3], y[3], y[7]
        _, first, second = self.curve(u)
        m, size = self.bead, math.sqrt(first @ first)
        tangent, weight = first / size, np.array([0, 0, -g])
        aside = np.eye(3)[np.argmin(np.abs(tangent))]
        aside = aside - tangent * (tangent @ aside)
        aside = aside / math.sqrt(aside @ aside)
        across = [aside, np.array([tangent[i - 2] * aside[i - 1] - tangent[i - 1] * aside[i - 2] for i in range(3)])]

        def found(friction):
            # unknown: X'', u'', N1, N2, f; the law of f last
            a, b = np.zeros((7, 7)), np.zeros(7)
            a[:3, :3], a[3:6, :3] = np.diag(self.mass), m * np.eye(3)
            for k, way in enumerate([*across, tangent]):
                a[:3, 4 + k], a[3:6, 4 + k] = way, -way
            a[3:6, 3] = m * first
            b[:3] = self.mass[2] * weight - self.stiffness * x
            b[3:6] = m * weight - m * second * w * w
            if friction is None:
                a[6, 3], b[6] = size, self.drive_rate(t) - tangent @ second * w * w
            else:
                a[6, 6], b[6] = 1, friction
            return np.linalg.solve(a, b)

        if sign == 0:
            z = found(None)
        else:
            free, unit = found(0.0), found(1.0)
            p, d = free[4:6], unit[4:6] - free[4:6]
            # f = -mu s |p + d f|: the root that tends to -mu s |p| as d does to zero
            a, b, c = 1 - mu**2 * d @ d, -2 * mu**2 * p @ d, -(mu**2) * p @ p
            root = math.sqrt(b * b - 4 * a * c)
            z = found((-b - sign * root) / (2 * a))
        return z[:4], z[6], math.hypot(z[4], z[5]), z[4]

    def slip(self, t, y):
        return np.linalg.norm(self.curve(y[3])[1]) * y[7] - self.drive(t)

    def rest(self, t, y):
        return np.array([*y[:7], self.drive(t) / np.linalg.norm(self.curve(y[3])[1])])


def follow(system, y, until, static, dynamic, step=0.005, most=200):
    """The state at the end, and what happens: (kind, time). Steps are short for the sake of the short slips, of which
    only the ends of steps tell."""
    t, events, y = 0.0, [], np.array(y, dtype=float)
    n = len(y) // 2

    def decided(t, y):
        """The sign of the slip from rest."""
        _, force, pressing, _ = system.solve(t, y, static, 0)
        return 0 if abs(force) <= static * pressing else -int(math.copysign(1, force))

    slip = system.slip(t, y)
    sign = int(math.copysign(1, slip)) if abs(slip) > 1e-14 else decided(t, y)
    for _ in range(most):

        def rates(t, y, s=sign):
            return [*y[n:], *system.solve(t, y, dynamic, s)[0]]

        if sign == 0:
            y = system.rest(t, y)

            def over(t, y):
                _, force, pressing, _ = system.solve(t, y, static, 0)
                return static**2 * pressing**2 - force**2

            over.terminal, over.direction = True, -1
            watched = [over]
        else:

            def stops(t, y):
                return system.slip(t, y)

            stops.terminal, stops.direction = True, -sign
            watched = [stops]
        found = solve_ivp(rates, (t, until), y, method="DOP853", rtol=3e-14, atol=1e-15, max_step=step, events=watched)
        t, y = found.t[-1], found.y[:, -1]
        if t >= until:
            return y, events
        if sign == 0:
            _, force, _, _ = system.solve(t, y, static, 0)
            sign = -int(math.copysign(1, force))
            events.append(("slip", t))
            continue
        y = system.rest(t, y)
        was, sign = sign, decided(t, y)
        events.append(("stick" if sign == 0 else "reverse", t))
        if sign == was:
            raise RuntimeError("a slip that only touches zero")
    raise RuntimeError("too many events")
