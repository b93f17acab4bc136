"""Plane mechanisms of one freedom with several frictions: all bodies apart, each with its own place and angle, forces
of all pins, slides and of a floor unknown (Newton, Euler), integrated by DOP853. A reference that shares nothing with
the library."""

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

g = 9.8


def turned(angle, a):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * a[0] - s * a[1], s * a[0] + c * a[1]])


class Mechanism:
    """`bodies`: mass, inertia about the centre. `pins`: (body or -1, place there, body, place there, mu r), places from
    centres; `slides`: (body, normal, mu), it does not turn; `floor`: (body, place there, mu). `torque(t)` on the first
    body."""

    def __init__(self, bodies, pins, slides=(), floor=None, torque=None, length=1.0):
        self.bodies, self.pins, self.slides, self.floor = bodies, pins, slides, floor
        self.torque, self.length = torque, length
        self.frictions = [p[4] for p in pins] + [s[2] for s in slides] + ([floor[2]] if floor else [])

    def rows(self, y):
        """What closes it, as rows on all velocities, and the accelerations that velocities ask for."""
        n = 3 * len(self.bodies)
        q, v = y[:n].reshape(-1, 3), y[n:].reshape(-1, 3)
        rows, bend = [], []
        for i, a, j, b, _ in self.pins:
            two, ask = np.zeros((2, n)), np.zeros(2)
            for body, place, sign in ((i, a, -1.0), (j, b, 1.0)):
                if body < 0:
                    continue
                r = turned(q[body, 2], place)
                two[0, 3 * body] = two[1, 3 * body + 1] = sign
                two[:, 3 * body + 2] = -sign * r[1], sign * r[0]
                ask += sign * v[body, 2] ** 2 * r
            rows += list(two)
            bend += list(ask)
        for j, normal, _ in self.slides:
            two = np.zeros((2, n))
            two[0, 3 * j : 3 * j + 2], two[1, 3 * j + 2] = normal, 1
            rows += list(two)
            bend += [0.0, 0.0]
        if self.floor:
            j, place, _ = self.floor
            r, row = turned(q[j, 2], place), np.zeros(n)
            row[3 * j + 1], row[3 * j + 2] = 1, r[0]
            rows.append(row)
            bend.append(v[j, 2] ** 2 * r[1])
        return np.array(rows), np.array(bend)

    def resisting(self, y):
        """Rows of the rates that friction is against: of pins, slides, the floor."""
        n, q, rows = 3 * len(self.bodies), y.reshape(2, -1, 3)[0], []
        for i, _, j, _, _ in self.pins:
            row = np.zeros(n)
            row[3 * j + 2] = 1
            if i >= 0:
                row[3 * i + 2] = -1
            rows.append(row)
        for j, normal, _ in self.slides:
            row = np.zeros(n)
            row[3 * j : 3 * j + 2] = -normal[1], normal[0]
            rows.append(row)
        if self.floor:
            j, place, _ = self.floor
            row = np.zeros(n)
            row[3 * j], row[3 * j + 2] = 1, -turned(q[j, 2], place)[1]
            rows.append(row)
        return np.array(rows)

    def rates(self, y):
        return self.resisting(y) @ y[y.size // 2 :]

    def solve(self, t, y, signs):
        """All accelerations, and forces of what closes it, the friction of each against its sign."""
        n = 3 * len(self.bodies)
        rows, bend = self.rows(y)
        resisting, count = self.resisting(y), len(rows)
        mass = np.array([x for m, i in self.bodies for x in (m, m, i)])
        load = np.array([x for m, _ in self.bodies for x in (0.0, -m * g, 0.0)])
        if self.torque:
            load[2] += self.torque(t)
        # what presses each: the rows of its force
        pressing = [(2 * k, 2 * k + 1) for k in range(len(self.pins))]
        pressing += [(2 * k,) for k in range(len(self.pins), len(self.pins) + len(self.slides))]
        pressing += [(count - 1,)] if self.floor else []
        along = [np.zeros(len(p)) for p in pressing]
        for _ in range(60):
            a = np.zeros((n + count, n + count))
            a[:n, :n], a[:n, n:], a[n:, :n] = np.diag(mass), -rows.T, rows
            for e, own in enumerate(pressing):
                for c, part in zip(own, along[e], strict=True):
                    a[:n, n + c] += signs[e] * self.frictions[e] * part * resisting[e]
            # in units in which all of it is of one size
            scale = 1 / np.abs(a).max(axis=1)
            columns = 1 / np.abs(a * scale[:, None]).max(axis=0)
            x = columns * np.linalg.solve(a * scale[:, None] * columns, scale * np.concatenate([load, bend]))
            forces = [x[n + np.array(own)] for own in pressing]
            now = [f / max(np.linalg.norm(f), 1e-300) for f in forces]
            turn = max(np.abs(p - q).max() for p, q in zip(now, along, strict=True))
            along = now
            if turn < 1e-14:
                break
        return x[:n], x[n:]

    def way(self, y):
        """The one motion that it has, and the rates that friction is against then."""
        units = np.tile([self.length, self.length, 1.0], len(self.bodies))
        rows = self.rows(y)[0] * units
        one = np.linalg.svd(rows / np.linalg.norm(rows, axis=1)[:, None])[2][-1] * units
        return one, self.resisting(y) @ one

    def pushed(self, t, y, way):
        """From rest: the acceleration along that motion, all frictions against it."""
        one, rates = self.way(y)
        return self.solve(t, y, np.sign(way * rates))[0] @ one / (one @ one)

    def leaves(self, t, y, end):
        """When what rests is pushed by more than all frictions together; None: not until the end."""
        times = np.linspace(t, end, 400)
        found = []
        for way in (1, -1):
            over = [way * self.pushed(s, y, way) for s in times]
            for k in range(len(times) - 1):
                if over[k] <= 0 < over[k + 1]:
                    found.append((brentq(lambda s, w=way: w * self.pushed(s, y, w), times[k], times[k + 1]), way))
                    break
        return min(found, default=None)

    def run(self, y, end, unit):
        """What happens, (time, what), and the state at any time until then. `unit` of time."""
        t, told, pieces = 0.0, [], []
        n = y.size // 2
        rates = self.rates(y)
        signs = np.sign(rates)
        scale = np.tile([self.length, self.length, 1.0], len(self.bodies))
        while t < end:
            used = [e for e, k in enumerate(self.frictions) if k > 0]

            def ends(e, now=signs):
                def f(t, x):
                    return now[e] * self.rates(x)[e]

                f.terminal, f.direction = True, -1
                return f

            sol = solve_ivp(
                lambda t, x, now=signs: np.concatenate([x[n:], self.solve(t, x, now)[0]]),
                (t, end),
                y,
                method="DOP853",
                rtol=1e-12,
                atol=np.concatenate([scale, scale / unit]) * 1e-14,
                events=[ends(e) for e in used],
                dense_output=True,
                max_step=unit / 20,
            )
            pieces.append((t, sol.t[-1], sol.sol))
            t, y = sol.t[-1], sol.y[:, -1].copy()
            if sol.status == 0:
                break
            which = used[next(k for k, times in enumerate(sol.t_events) if len(times))]
            signs = signs.copy()
            if np.abs(y[n:] / scale).max() * unit > 1e-6:
                signs[which] *= -1
                told.append((t, "turns back"))
                continue
            y[n:] = 0
            ways = [way for way in (1, -1) if way * self.pushed(t, y, way) > 0]
            told.append((t, "reverses" if ways else "rests"))
            if not ways:
                leaves = self.leaves(t, y, end)
                # from where it has begun to
                later = end if leaves is None else leaves[0] + 1e-9 * unit
                pieces.append((t, later, lambda s, there=y: there))
                t = later
                if leaves is None:
                    break
                told.append((leaves[0], "leaves"))
                ways = [leaves[1]]
            signs = np.sign(ways[0] * self.way(y)[1])
        return told, lambda s: next(p(s) for a, b, p in pieces if a <= s <= b)
