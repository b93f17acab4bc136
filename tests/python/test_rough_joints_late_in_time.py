"""A block on a rough slide and a wheel on a rough pin, broken away by a force B + A sin(w (t - t0) + p) where static
and dynamic friction are the same: what they do is known in closed form between events, and the same at any time t0.
Where the time is rounded the force at which one breaks away is, too, by more than forces themselves are."""

import math

import numpy as np
import pytest
import rbdyn as rb

optimize = pytest.importorskip("scipy.optimize")
G, END = 9.8125, 3.0


class Block:
    """x'' = B + A sin(w t + p) - mu g sign x', and what happens, from rest."""

    def __init__(self, a, w, p, b, mu):
        self.a, self.w, self.p, self.b, self.limit = a, w, p, b, mu * G

    def force(self, t):
        return self.b + self.a * np.sin(self.w * t + self.p)

    def speed(self, t, since, way):
        """Of what has slid that way since then, from rest."""
        turned = self.a / self.w * (np.cos(self.w * since + self.p) - np.cos(self.w * t + self.p))
        return turned + (self.b - way * self.limit) * (t - since)

    def way_on(self, t):
        """0: held. At the limit what comes next decides."""
        f = self.force(t)
        if abs(abs(f) - self.limit) > 1e-9:
            return int(np.sign(f)) if abs(f) > self.limit else 0
        return int(np.sign(f)) if f * self.w * np.cos(self.w * t + self.p) * self.a > 0 else 0

    def next_root(self, f, t):
        times = np.linspace(t + 1e-6, END, 20001)
        signs = np.sign(f(times))
        changes = np.flatnonzero(signs[1:] != signs[:-1])
        if len(changes) == 0:
            return END
        k = changes[0]
        return optimize.brentq(f, times[k], times[k + 1], xtol=1e-15, rtol=1e-15)

    def run(self):
        told, t, way = [], 0.0, self.way_on(0.0)
        while True:
            was, begun = way, t
            beyond = (
                (lambda u: np.abs(self.force(u)) - self.limit)
                if way == 0
                else (lambda u, begun=begun, way=way: self.speed(u, begun, way))
            )
            t = self.next_root(beyond, t)
            if t == END:
                return told, 0.0 if way == 0 else self.speed(END, begun, way)
            way = int(np.sign(self.force(t))) if was == 0 else self.way_on(t)
            if way != was:
                told.append((t, "slip" if was == 0 else "stick" if way == 0 else "reverse"))


def drawn(seed):
    rng = np.random.default_rng([41, seed])
    return rng.uniform(2, 12), rng.uniform(1, 6), rng.uniform(0, 6), rng.uniform(-3, 3), rng.uniform(0.1, 0.7)


@pytest.mark.parametrize("kind", ["slide", "pin"])
@pytest.mark.parametrize("late", [0.0, -50.0, 1e2, 1e3, 1e4, 1e5])
def test_what_breaks_away_at_the_limit_does_so_at_any_time(kind, late):
    for seed in range(12):
        a, w, p, b, mu = drawn(seed)
        told, speed = Block(a, w, p, b, mu).run()
        scene = rb.Scene(gravity=[0, -G, 0])
        body = rb.RigidBody(1.0, [0.1, 0.1, 0.1])
        force = lambda t: b + a * np.sin(w * (t - late) + p)  # noqa: B023, E731
        if kind == "slide":
            block = scene.add(body, rb.Prismatic([1, 0, 0], friction=rb.Coulomb(mu)))
            scene.apply(rb.JointForce(lambda t, q, rate: force(t)), block)  # noqa: B023
        else:
            block = scene.add(body, rb.Revolute([0, 0, 1], friction=rb.Coulomb(mu), pin_radius=0.1))
            scene.apply(rb.JointTorque(lambda t, q, rate: 0.1 * force(t)), block)  # noqa: B023
        run = rb.simulate(scene, start=late, until=late + END, error=1e-8)
        events = [e for e in run.events if e.kind != "rest"]
        assert [e.kind for e in events] == [kind for _, kind in told]
        # the force is known to w times the rounding of the time
        rounding = 1e-9 + 1e3 * math.ulp(late)
        assert all(abs(e.time - late - time) < rounding for e, (time, _) in zip(events, told, strict=True))
        assert abs(run[block].rate(late + END) - speed) < 1e-8 + rounding
