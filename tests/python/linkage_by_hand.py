"""Two bars on rough pins whose tip slides on a floor: Newton's and Euler's equations of both, with all forces unknown,
written down here: a reference that shares nothing with the library."""

import itertools

import numpy as np
from scipy.integrate import solve_ivp

g = 9.81


def moment(arm, force):
    """About y of a force in the plane of x and z."""
    return arm[1] * force[0] - arm[0] * force[1]


class Linkage:
    """Bars of mass m and length 1, their centres halfway, inertia about them; pins (static, dynamic, radius), the first
    at the origin; a floor at z = -height, its friction `mu`; or the tip `stays` on it, pulled too. State: angles of
    both bars from x towards -z, rates."""

    inertia = 0.09

    def __init__(self, masses, pins, height, mu, stays=False):
        self.m, self.pins, self.height, self.mu, self.stays = masses, pins, height, mu, stays

    def solve(self, y, signs, closed, way):
        """Angular accelerations, forces of both pins, N, torques of both pins. A sign 0 holds; `way`: of the tip."""
        angles, rates = y[:2], y[2:]
        u = [np.array([np.cos(a), -np.sin(a)]) for a in angles]
        n = [np.array([-np.sin(a), -np.cos(a)]) for a in angles]
        along = [np.zeros(2), np.zeros(2)]
        # alpha_1, alpha_2, R_1, R_2, N, T_1, T_2
        for _ in range(200):
            a, b = np.zeros((9, 9)), np.zeros(9)
            bend = [-(rates[k] ** 2) * u[k] for k in range(2)]
            tip_force = np.array([-self.mu * way, 1.0])
            for i in range(2):
                # the first bar: m (alpha n + bend) / 2 = R_1 - R_2 + m g
                a[i, 0], a[i, 2 + i], a[i, 4 + i] = 0.5 * self.m[0] * n[0][i], -1, 1
                b[i] = -0.5 * self.m[0] * bend[0][i] - (self.m[0] * g if i == 1 else 0)
                # the second: R_2 and what the floor exerts
                a[2 + i, 0], a[2 + i, 1] = self.m[1] * n[0][i], 0.5 * self.m[1] * n[1][i]
                a[2 + i, 4 + i], a[2 + i, 6] = -1, -tip_force[i]
                b[2 + i] = -self.m[1] * (bend[0][i] + 0.5 * bend[1][i]) - (self.m[1] * g if i == 1 else 0)
            for i, e in enumerate(np.eye(2)):
                a[4, 2 + i], a[4, 4 + i] = -moment(-0.5 * u[0], e), moment(0.5 * u[0], e)
                a[5, 4 + i] = -moment(-0.5 * u[1], e)
            a[4, 0], a[4, 7], a[4, 8] = self.inertia, -1, 1
            a[5, 1], a[5, 6], a[5, 8] = self.inertia, -moment(0.5 * u[1], tip_force), -1
            if closed:
                a[6, 0], a[6, 1], b[6] = n[0][1], n[1][1], -bend[0][1] - bend[1][1]
            else:
                a[6, 6] = 1
            for k, (_, mu, radius) in enumerate(self.pins):
                if signs[k] == 0:
                    a[7 + k, 0], a[7 + k, 1] = (1, 0) if k == 0 else (-1, 1)
                else:
                    a[7 + k, 7 + k] = 1
                    a[7 + k, 2 + 2 * k : 4 + 2 * k] = signs[k] * mu * radius * along[k]
            if np.linalg.cond(a) > 1e9:
                return None
            x = np.linalg.solve(a, b)
            last, along = along, [x[2 + 2 * k : 4 + 2 * k] / np.linalg.norm(x[2 + 2 * k : 4 + 2 * k]) for k in range(2)]
            if max(np.abs(along[k] - last[k]).max() for k in range(2)) < 1e-14:
                return x
        raise ArithmeticError("no loads of the pins found")

    @staticmethod
    def slips(y):
        return np.array([y[2], y[3] - y[2]])

    def tip(self, y):
        """Its height over the floor, and its velocity."""
        z = self.height - np.sin(y[0]) - np.sin(y[1])
        return z, np.array([-np.sin(y[:2]) @ y[2:], -np.cos(y[:2]) @ y[2:]])

    def lifts(self, y, x):
        return -np.cos(y[:2]) @ x[:2] + np.sin(y[:2]) @ y[2:] ** 2

    def decide(self, y, signs, way):
        """Each way that the pins at rest (sign 0) and the contact may go on; the one that obeys all laws."""
        found = []
        ways = [(s,) if s else (0, 1, -1) for s in signs]
        for s1, s2, closed in itertools.product(*ways, (True,) if self.stays else (True, False)):
            x = self.solve(y, (s1, s2), closed, way)
            if x is None or not (self.stays or (x[6] >= 0 if closed else self.lifts(y, x) >= 0)):
                continue
            relative = (x[0], x[1] - x[0])
            limits = [mu * radius * np.hypot(*x[2 + 2 * k : 4 + 2 * k]) for k, (mu, _, radius) in enumerate(self.pins)]
            is_right = all(
                signs[k] != 0 or (abs(x[7 + k]) <= limits[k] if s == 0 else s * relative[k] > 0)
                for k, s in enumerate((s1, s2))
            )
            if is_right:
                found.append(((s1, s2), closed))
        assert len(found) == 1
        return found[0]

    def run(self, y, end):
        """From a start with a closed contact to `end`, or to where the contact opens or the tip stops: the time, the
        state, and what reverses, sticks, opens and stops."""
        t, told = 0.0, []
        way = np.sign(self.tip(y)[1][0])
        signs, closed = self.decide(y, [int(np.sign(s)) for s in self.slips(y)], way)
        while t < end and closed:
            rates = lambda t, y, signs=signs: np.concatenate((y[2:], self.solve(y, signs, True, way)[:2]))  # noqa: E731
            events = [lambda t, y, k=k, s=s: s * self.slips(y)[k] for k, s in enumerate(signs)]
            events.append(lambda t, y: way * self.tip(y)[1][0])
            if not self.stays:
                events.append(lambda t, y, signs=signs: self.solve(y, signs, True, way)[6])
            for e in events:
                e.terminal, e.direction = True, -1
            run = solve_ivp(rates, (t, end), y, "DOP853", rtol=1e-13, atol=1e-14, events=events)
            t, y = run.t[-1], run.y[:, -1]
            fired = [i for i, times in enumerate(run.t_events) if len(times)]
            if not fired:
                break
            if fired[0] == 2 or np.abs(y[2:]).max() < 1e-7:
                told.append(("stop", t))
                break
            if fired[0] == 3:
                told.append(("detach", t))
                break
            k = fired[0]
            signs, closed = self.decide(y, [0 if i == k else s for i, s in enumerate(signs)], way)
            told.append(("reverse" if signs[k] else "stick", t))
            if not closed:
                told.append(("detach", t))
        return t, y, told


def start(height, x, speed, knee):
    """Angles and rates where the tip is on the floor at x, and moves along it."""
    a = np.arctan2(height, x)
    half = np.arccos(0.5 * np.hypot(height, x))
    angles = np.array([a - knee * half, a + knee * half])
    return angles, np.linalg.solve([-np.sin(angles), -np.cos(angles)], [speed, 0.0])
