"""Bodies in the plane that strike two rough surfaces at once and jam: what restitution is lowered to, and impulses
that do it. Against each choice of what contacts may do, in exact fractions."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
import rbdyn as rb

JAM = {
    "mass": 1.563980462854751,
    "moment": 0.7226434924282991,
    "velocity": (-2.132836976879234, -0.16983783795841978),
    "points": [(-0.30147977377386903, -0.5507237954002984), (-0.420611247127668, -0.05763680504738874)],
    "normals": [(0.23965042576490808, 0.9708592449117938), (0.6117692305119845, -0.7910362877888564)],
    "mu": [1.2786448238705646, 1.0283213947331264],
    "e": [0.5, 0.5],
}


def solved(a, b):
    """x of a x = b; None where it is not unique."""
    n = len(b)
    m = [[*row, right] for row, right in zip(a, b, strict=True)]
    for k in range(n):
        pivot = next((i for i in range(k, n) if m[i][k] != 0), None)
        if pivot is None:
            return None
        m[k], m[pivot] = m[pivot], m[k]
        m[k] = [x / m[k][k] for x in m[k]]
        for i in range(n):
            if i != k and m[i][k] != 0:
                m[i] = [x - m[i][k] * y for x, y in zip(m[i], m[k], strict=True)]
    return [row[n] for row in m]


class Struck:
    """It flies without turning, and strikes at one instant."""

    def __init__(self, mass, moment, velocity, points, normals, mu, e):
        self.mass, self.moment, self.velocity, self.mu, self.e = mass, moment, velocity, mu, e
        self.points, self.normals = points, normals
        exact = [[tuple(map(Fraction, v)) for v in vectors] for vectors in (points, normals)]
        along = [(n[1], -n[0]) for n in exact[1]]
        self.rows = [
            (n[0], n[1], n[1] * p[0] - n[0] * p[1]) for p, n in zip(exact[0] * 2, exact[1] + along, strict=True)
        ]
        inverse = (1 / Fraction(mass), 1 / Fraction(mass), 1 / Fraction(moment))
        self.matrix = [
            [sum(x * y * w for x, y, w in zip(r, s, inverse, strict=True)) for s in self.rows] for r in self.rows
        ]
        self.before = [r[0] * Fraction(velocity[0]) + r[1] * Fraction(velocity[1]) for r in self.rows]

    @classmethod
    def draw(cls, generator, mu):
        while True:
            points, angles = generator.uniform(-1, 1, (2, 2)), generator.uniform(0, 2 * np.pi, 2)
            normals, velocity = np.c_[np.sin(angles), np.cos(angles)], generator.uniform(-2.5, 2.5, 2)
            if (normals @ velocity).max() < -0.05:
                break
        mass, moment = generator.uniform(0.3, 5), generator.uniform(0.02, 1)
        lists = [list(map(tuple, v.tolist())) for v in (points, normals)]
        return cls(mass, moment, tuple(velocity), *lists, list(generator.uniform(*mu, 2)), [0.5, 0.9])

    def does(self, part):
        """Whether any impulses inside their cones give the part of all restitution, and gain no energy."""
        part, zero, one = Fraction(part), Fraction(0), Fraction(1)
        back = [-part * Fraction(e) * u for e, u in zip(self.e, self.before, strict=False)]
        for ways in itertools.product("open stuck forward backward".split(), repeat=2):
            a, b = [], []
            for i, way in enumerate(ways):
                normal, along = ([one if j == k else zero for j in range(4)] for k in (i, 2 + i))
                a.append(normal if way == "open" else self.matrix[i])
                b.append(zero if way == "open" else back[i] - self.before[i])
                slides = {"forward": 1, "backward": -1}.get(way, 0) * Fraction(self.mu[i])
                a.append(
                    self.matrix[2 + i]
                    if way == "stuck"
                    else [x + slides * y for x, y in zip(along, normal, strict=True)]
                )
                b.append(-self.before[2 + i] if way == "stuck" else zero)
            impulse = solved(a, b)
            if impulse is None:
                continue
            after = [
                u + sum(x * y for x, y in zip(r, impulse, strict=True))
                for u, r in zip(self.before, self.matrix, strict=True)
            ]

            def is_lawful(i, way, impulse=impulse, after=after):
                normal, along = impulse[i], impulse[2 + i]
                if way == "open":
                    return after[i] >= back[i]
                if way == "stuck":
                    return normal >= 0 and abs(along) <= Fraction(self.mu[i]) * normal
                return normal >= 0 and (after[2 + i] >= 0 if way == "forward" else after[2 + i] <= 0)

            gains = sum(p * (u + v) for p, u, v in zip(impulse, self.before, after, strict=True))
            if gains <= 0 and all(is_lawful(i, way) for i, way in enumerate(ways)):
                return True
        return False

    def run(self, unit=1.0, weight=1.0):
        scene = rb.Scene()
        velocity = np.array(self.velocity) * unit
        body = scene.add(
            rb.RigidBody(self.mass * weight, [self.moment * weight * unit**2] * 3),
            rb.Planar([1, 0, 0], [0, 0, 1]),
            position=-velocity,
            velocity=velocity,
        )
        contacts = []
        for k in range(2):
            (x, z), (nx, nz) = np.array(self.points[k]) * unit, self.normals[k]
            surface = rb.Plane([nx, 0, nz], [x, 0, z])
            contacts.append(
                scene.contact(body.point([x, 0, z]), surface, friction=rb.Coulomb(self.mu[k]), restitution=self.e[k])
            )
        return rb.simulate(scene, 2.0), body, contacts


def jams(run, body, contacts, struck, unit=1.0, weight=1.0):
    """It comes to rest and stays, by impulses that are no larger than what it brings with it by far."""
    momentum = struck.mass * weight * unit * np.hypot(*struck.velocity)
    impulses = [e.impulse for e in run.events if e.kind == "land"]
    assert all("restitution lowered to 0" in e.note for e in run.events if e.kind == "land")
    assert np.abs(run[body].velocity(1.5)).max() <= 1e-14 * unit
    assert np.abs(run[body].position(2.0)).max() <= 1e-14 * unit
    assert np.abs(run[body].angular_velocity_world(1.5)).max() <= 1e-14
    assert len(impulses) == 2 and np.linalg.norm(impulses, axis=1).max() < 1e3 * momentum
    asked = -struck.mass * weight * unit * np.array([struck.velocity[0], 0, struck.velocity[1]])
    np.testing.assert_allclose(sum(impulses), asked, rtol=0, atol=1e-12 * momentum)
    assert {run[c].state(1.5) for c in contacts} <= {"sticks", "stuck", "held"}, [run[c].state(1.5) for c in contacts]


@pytest.mark.parametrize("unit, weight", [(1.0, 1.0), (1e-3, 1e-6), (1e4, 1e3)])
def test_a_body_that_jams_has_no_restitution_left(unit, weight):
    """It went on with 6e-5 m/s by impulses of 2e8 N s, told to 2e-15."""
    struck = Struck(**JAM)
    parts = [Fraction(1), *(Fraction(1, 10**k) for k in range(1, 9))]
    assert not any(struck.does(part) for part in parts) and struck.does(0)
    run, body, contacts = struck.run(unit, weight)
    jams(run, body, contacts, struck, unit, weight)
    assert run.error < 1e-12


def test_restitution_of_random_bodies_that_jam_is_lowered_as_far_as_the_laws_ask():
    """Of 60 some jam; where a part of restitution can be done, it is, and a little more cannot."""
    draw = np.random.default_rng(18)
    jammed = lowered = 0
    for _ in range(60):
        struck = Struck.draw(draw, (1.5, 5.0))
        if struck.does(1):
            continue
        parts = [Fraction(k, 50) for k in range(1, 50)] + [Fraction(1, 10**k) for k in range(2, 9)]
        feasible = [part for part in parts if struck.does(part)]
        run, body, contacts = struck.run()
        if not feasible:
            jammed += 1
            jams(run, body, contacts, struck)
            continue
        lowered += 1
        told = next(e for e in run.events if e.note)
        part = float(told.note.split()[3].rstrip(":")) / struck.e[contacts.index(told.subject)]
        assert struck.does(part * (1 - 1e-9)) and not struck.does(part * (1 + 1e-6) + 1e-9), part
    assert (jammed, lowered) == (8, 4)
