"""Joints with friction beside contacts, by laws written down here: a reference that shares nothing with the library.

Both find what happens next by trying every way that joints and contact may go on, and keep the one that obeys all laws.
"""

import itertools
import math

import numpy as np
from scipy.integrate import solve_ivp

g = 9.8125


class Wedge:
    """A block A of mass M on a rough horizontal slide carries an incline, a block B of mass m on a rough vertical slide
    falls on it: between events all accelerations are constant. `friction`: (static, dynamic) of A and of B."""

    def __init__(self, masses, slope, friction, pull, restitution):
        (self.M, self.m), self.mu, self.pull, self.e = masses, friction, pull, restitution
        self.s, self.c = math.sin(slope), math.cos(slope)

    def balance(self, signs, closed, before=None):
        """X'', y'', both frictions and N; impulses, from velocities before, if they are given. A sign 0 sticks."""
        a, b = np.zeros((5, 5)), np.zeros(5)
        a[0], a[1] = [self.M, 0, -1, 0, -self.s], [0, self.m, 0, -1, -self.c]
        if before is None:
            b[:2] = self.pull, -self.m * g
        for k, part in enumerate((self.c, self.s)):
            if signs[k] == 0:
                a[2 + k, k], b[2 + k] = 1, 0 if before is None else -before[k]
            else:
                a[2 + k, 2 + k], a[2 + k, 4] = 1, signs[k] * self.mu[k][1] * part
        if signs[0] and before is None:
            b[2] = -signs[0] * self.mu[0][1] * self.M * g
        a[4] = [self.s, self.c, 0, 0, 0] if closed else [0, 0, 0, 0, 1]
        if closed and before is not None:
            b[4] = -(1 + self.e) * (self.s * before[0] + self.c * before[1])
        return None if abs(np.linalg.det(a)) < 1e-12 else np.linalg.solve(a, b)

    def limit(self, k, normal, which, weight):
        return self.mu[k][which] * (self.c * normal + weight if k == 0 else self.s * normal)

    def can_be_held(self):
        """Whether any N >= 0 holds both blocks on each other: each limit is an interval of N."""
        low, high = 0.0, math.inf
        a, b = self.mu[0][0], self.mu[1][0]
        for slope, most in (
            (self.s - a * self.c, a * self.M * g - self.pull),
            (-self.s - a * self.c, a * self.M * g + self.pull),
            (self.c - b * self.s, self.m * g),
            (-self.c - b * self.s, -self.m * g),
        ):
            if slope > 0:
                high = min(high, most / slope)
            else:
                low = max(low, most / slope)
        return low <= high

    def decide(self, v, touching):
        ways = [[int(np.sign(v[k]))] if v[k] else [0, 1, -1] for k in range(2)]
        for closed in [True, False] if touching else [False]:
            for signs in itertools.product(*ways):
                if closed and not any(signs):
                    if self.can_be_held():
                        return signs, True, np.zeros(5)
                    continue
                z = self.balance(signs, closed)
                if z is None or (z[4] < 0 if closed else touching and self.s * z[0] + self.c * z[1] < 0):
                    continue
                if all(
                    abs(z[2 + k]) <= self.limit(k, z[4], 0, self.M * g)
                    if signs[k] == 0
                    else v[k] or signs[k] * z[k] > 1e-12
                    for k in range(2)
                ):
                    return signs, closed, z
        raise RuntimeError("no way to go on")

    def strike(self, v):
        for signs in itertools.product([1, -1, 0], repeat=2):
            z = self.balance(signs, True, v)
            if z is None or z[4] < 0:
                continue
            after = np.where(np.array(signs) == 0, 0.0, v + z[:2])
            after[abs(after) < 1e-13] = 0.0
            if all(
                abs(z[2 + k]) <= self.limit(k, z[4], 1, 0) if signs[k] == 0 else signs[k] * after[k] >= -1e-15
                for k in range(2)
            ):
                return after, z[4]
        raise RuntimeError("no impulse")

    def run(self, place, v, until, most=8):
        """The time and the places of the last of some impacts, or at the end, and what happens: (kind, whose, time)."""
        t, q, v, events, impacts = 0.0, np.array(place, float), np.array(v, float), [], []
        touching = struck = False
        last = None
        while t < until:
            signs, closed, z = self.decide(v, touching)
            for k in range(2) if last else ():
                change = (bool(last[k]), bool(signs[k]))
                kind = {(True, False): "stick", (False, True): "slip"}.get(change)
                if last[k] * signs[k] < 0:
                    kind = "reverse"
                if kind:
                    events.append((kind, k, t))
            last = signs
            ends = [(until - t, None)]
            ends += [(-v[k] / z[k], k) for k in range(2) if signs[k] and v[k] * z[k] < 0]
            if not closed:
                gap = self.s * q[0] + self.c * q[1]
                rate, bend = self.s * v[0] + self.c * v[1], self.s * z[0] + self.c * z[1]
                if touching or struck:
                    roots = [-2 * rate / bend]
                else:
                    roots = np.roots([bend / 2, rate, gap] if bend else [rate, gap])
                ends += [
                    (r.real, "hit")
                    for r in roots
                    if abs(r.imag) < 1e-14 and r.real > 1e-13 and bend * r.real + rate < 0
                ]
            struck = False
            length, what = min(ends, key=lambda one: one[0])
            q, v, t = q + v * length + z[:2] * length**2 / 2, v + z[:2] * length, t + length
            v[np.array(signs) == 0] = 0.0
            touching = closed
            if what == "hit":
                v, normal = self.strike(v)
                impacts.append((normal, t))
                struck = self.s * v[0] + self.c * v[1] > 1e-12
                touching = not struck
                if len(impacts) == most:
                    break
            elif what is not None:
                v[what] = 0.0
                if closed:
                    v[1 - what] = 0.0
        return t, q, events, impacts


class Cart:
    """A cart on a rough horizontal slide, pushed against a wall, with a rough bead on a hoop of it: friction of each
    depends on that of the other. Coordinates X, phi from the lowest point of the hoop, X', phi'."""

    def __init__(self, masses, radius, wall, bead, slide, restitution, push):
        (self.M, self.m), self.r, self.d, self.bead, self.slide = masses, radius, wall, bead, slide
        self.e, self.push = restitution, push

    def solve(self, t, y, signs, impulse=False):
        """X'', phi'', N, f, the slide's friction, the wall's force, by the signs of both slips; how it is pressed."""
        (s, sc), (_, phi, V, w) = signs, y
        out, way = np.array([math.sin(phi), -math.cos(phi)]), np.array([math.cos(phi), math.sin(phi)])
        weight = 0 if impulse else self.M * g
        for side, press in itertools.product((1, -1), repeat=2):
            a, b = np.zeros((6, 6)), np.zeros(6)
            a[:2, 0], a[:2, 1], a[:2, 2], a[:2, 3] = [self.m, 0], self.m * self.r * way, out, -way
            a[2] = [self.M, 0, -out[0], way[0], -1, 1]
            if not impulse:
                b[:2], b[2] = self.m * self.r * w * w * out - [0, self.m * g], self.push(t)
            if s == 0:
                a[3, 1], b[3] = 1, -w if impulse else 0
            else:
                a[3, 3], a[3, 2] = 1, self.bead[1] * s * side
            if sc == 0:
                a[4, 0], b[4] = 1, -V if impulse else 0
            else:
                k = self.slide[1] * sc * press
                a[4, 4], a[4, 2], a[4, 3], b[4] = 1, k * math.cos(phi), k * math.sin(phi), -k * weight
            if impulse:
                a[5, 0], b[5] = 1, -(1 + self.e) * V
            else:
                a[5, 5] = 1
            if abs(np.linalg.det(a)) < 1e-12:
                continue
            z = np.linalg.solve(a, b)
            up = weight + z[2] * math.cos(phi) + z[3] * math.sin(phi)
            if (s == 0 or z[2] * side >= -1e-15) and (sc == 0 or up * press >= -1e-15):
                return z, up
        return None

    def decide(self, t, y, at_wall, broken):
        """Whether the wall holds the cart, and the signs of both slips. `broken`: what has left its rest just now."""
        _, _, V, w = y
        of_bead = [int(np.sign(w))] if w else [1, -1] if "bead" in broken else [0, 1, -1]
        of_cart = [int(np.sign(V))] if V else [1, -1] if "cart" in broken else [0, 1, -1]
        for held in [True, False] if at_wall and V == 0 and "cart" not in broken else [False]:
            for s, sc in itertools.product(of_bead, [0] if held else of_cart):
                found = self.solve(t, y, (s, sc))
                if found is None or (at_wall and V == 0 and sc == 1):
                    continue
                z, up = found
                is_right = abs(z[3]) <= self.bead[0] * abs(z[2]) + 1e-12 if s == 0 else w or s * z[1] > 1e-12
                # the wall pushes, the slide pulls up to its limit
                most = self.slide[0] * abs(up) + 1e-12
                if sc == 0:
                    is_right = is_right and (z[4] <= most if held else abs(z[4]) <= most)
                elif V == 0:
                    is_right = is_right and sc * z[0] > 1e-12
                if is_right:
                    return held, s, sc
        raise RuntimeError("no way to go on")

    def strike(self, t, y):
        for s, sc in itertools.product([1, -1, 0], [1, -1]):
            found = self.solve(t, y, (s, sc), impulse=True)
            if found is None:
                continue
            z, _ = found
            V, w = y[2] + z[0], y[3] + z[1]
            slides = abs(z[3]) <= self.bead[1] * abs(z[2]) + 1e-14 if s == 0 else s * w >= -1e-14
            if slides and sc * V >= -1e-14 and z[5] >= 0:
                return np.array([self.d, y[1], V if abs(V) > 1e-12 else 0.0, w if s else 0.0]), z[5]
        raise RuntimeError("no impulse")

    def run(self, y, until, most=6):
        """The time and state at the end, or of the last of some impacts, and what happens to joints."""
        t, y, events, impacts = 0.0, np.array(y, float), [], []
        at_wall, last, broken = False, None, ()
        for _ in range(200):
            held, s, sc = self.decide(t, y, at_wall, broken)
            for k, name in enumerate(("bead", "cart")) if last else ():
                now = (s, sc)[k]
                kind = (
                    "reverse"
                    if last[k] * now < 0
                    else {(True, False): "stick", (False, True): "slip"}.get((bool(last[k]), bool(now)))
                )
                if kind:
                    events.append((kind, name, t))
            last = (s, sc)

            def rates(t, y, signs=(s, sc)):
                z, _ = self.solve(t, y, signs)
                return [
                    y[2] if signs[1] else 0.0,
                    y[3] if signs[0] else 0.0,
                    z[0] * bool(signs[1]),
                    z[1] * bool(signs[0]),
                ]

            def over(t, y, signs=(s, sc)):
                z, _ = self.solve(t, y, signs)
                return self.bead[0] ** 2 * z[2] ** 2 - z[3] ** 2

            def leaves(t, y, signs=(s, sc), held=held):
                z, up = self.solve(t, y, signs)
                return self.slide[0] * abs(up) - z[4] if held else self.slide[0] ** 2 * up**2 - z[4] ** 2

            watched = [
                ((lambda _, y: y[3]), -s) if s else (over, -1),
                ((lambda _, y: y[2]), -sc) if sc else (leaves, -1),
                ((lambda _, y: self.d - y[0]), -1),
            ]
            if at_wall and not sc:
                watched.pop()
            for f, way in watched:
                f.terminal, f.direction = True, way
            found = solve_ivp(
                rates,
                (t, until),
                y,
                method="DOP853",
                rtol=3e-14,
                atol=1e-15,
                max_step=0.01,
                events=[f for f, _ in watched],
            )
            t, y = found.t[-1], found.y[:, -1].copy()
            if found.status == 0:
                break
            which = next(k for k, times in enumerate(found.t_events) if len(times))
            broken = () if which == 2 or (s, sc)[which] else (("bead", "cart")[which],)
            if which < 2 and (s, sc)[which]:
                y[3 - which] = 0.0
            if which == 2 and y[2] > 0:
                y, force = self.strike(t, y)
                impacts.append((force, t))
                if len(impacts) == most:
                    break
                at_wall = y[2] == 0.0
            elif which == 2:
                # it has just left
                y[0] = self.d - 1e-14
            if sc and which != 2:
                at_wall = False
        return t, y, events, impacts
