"""Random planar scenes of up to six contacts, and their motion by time stepping, which shares nothing with the
library.

Time stepping (J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988; D. E. Stewart and J.
C. Trinkle, An implicit time-stepping scheme for rigid body dynamics, 1996): half a step of the positions, impulses of
all contacts that are closed there, with Newton's restitution and Coulomb's law, half a step more. It finds no events;
as its step goes to zero its motion goes to that of the laws.
"""

import math
from dataclasses import dataclass, field

import numpy as np
import rbdyn as rb

GRAVITY = 9.81


@dataclass
class Body:
    """In the plane: place and angle, and what its outline touches with: points of the body with a radius each."""

    mass: float
    moment: float
    start: tuple[float, float, float]
    velocity: tuple[float, float, float]
    points: list[tuple[float, float]]
    radius: float


@dataclass
class Contact:
    """A point of a body on a line n.x = c, or on another body, both round."""

    body: int
    point: int
    normal: tuple[float, float] = (0.0, 1.0)
    level: float = 0.0
    other: int = -1
    restitution: float = 0.0
    mu: float = 0.0


@dataclass
class Planar:
    """Bodies under a weight that leans by `slope`, and their contacts."""

    bodies: list[Body] = field(default_factory=list)
    contacts: list[Contact] = field(default_factory=list)
    slope: float = 0.0

    @property
    def weight(self):
        return GRAVITY * math.sin(self.slope), -GRAVITY * math.cos(self.slope)

    def scene(self):
        scene = rb.Scene(gravity=[*self.weight, 0])
        handles = []
        for b in self.bodies:
            handles.append(
                scene.add(
                    rb.RigidBody(b.mass, [b.moment / 2, b.moment / 2, b.moment]),
                    rb.Planar([1, 0, 0], [0, 1, 0]),
                    position=b.start[:2],
                    angle=b.start[2],
                    velocity=b.velocity[:2],
                    rate=b.velocity[2],
                )
            )
        contacts = []
        for c in self.contacts:
            body = self.bodies[c.body]
            place = [*body.points[c.point], 0]
            a = handles[c.body].sphere(body.radius, place) if body.radius > 0 else handles[c.body].point(place)
            if c.other >= 0:
                b = handles[c.other].sphere(self.bodies[c.other].radius)
            else:
                b = rb.Plane([*c.normal, 0], [c.level * n for n in c.normal] + [0])
            friction = rb.Coulomb(c.mu) if c.mu > 0 else None
            contacts.append(scene.contact(a, b, restitution=c.restitution, friction=friction))
        return scene, handles, contacts


def random_scene(seed, *, rough):
    """Balls, rods and boxes above a floor that may lean, some beside a wall, some of the balls to strike each other."""
    random = np.random.default_rng(seed)
    planar = Planar(slope=float(random.choice([0.0, 0.0, 0.2, 0.5])))
    x = -1.0
    wall = random.random() < 0.3
    for _ in range(random.integers(1, 4)):
        kind, mass = random.integers(3), random.uniform(0.5, 3.0)
        if kind == 0:
            radius = random.uniform(0.1, 0.3)
            points, moment, reach = [(0.0, 0.0)], mass * radius**2 * random.uniform(0.3, 0.9), radius
        elif kind == 1:
            reach, radius = random.uniform(0.2, 0.5), 0.0
            points, moment = [(-reach, 0.0), (reach, 0.0)], mass * reach**2 / 3
        else:
            b, h = random.uniform(0.1, 0.4, 2)
            reach, radius = math.hypot(b, h), 0.0
            points, moment = [(-b, -h), (b, -h), (b, h), (-b, h)], mass * reach**2 / 3
        x += reach + 0.05
        start = (x, reach + random.uniform(0.02, 0.6), random.uniform(-3, 3))
        velocity = (random.normal(), random.normal(), 2.0 * random.normal())
        planar.bodies.append(Body(mass, moment, start, velocity, points, radius))
        x += reach + 0.05
    law = {
        "restitution": lambda: float(random.choice([0.0, 0.0, 0.3, 0.7, 1.0])),
        "mu": lambda: float(random.choice([0.1, 0.3, 0.7])) if rough else 0.0,
    }

    def touch(**where):
        planar.contacts.append(Contact(**where, **{name: draw() for name, draw in law.items()}))

    balls = [i for i, b in enumerate(planar.bodies) if b.radius > 0]
    for i in range(len(balls) - 1):
        touch(body=balls[i], point=0, other=balls[i + 1])
    for i, body in enumerate(planar.bodies):
        for k in range(len(body.points)):
            touch(body=i, point=k)
        if wall:
            touch(body=i, point=0, normal=(-1.0, 0.0), level=-(x + 0.3))
    # six at most
    for k in sorted(random.permutation(len(planar.contacts))[6:])[::-1]:
        del planar.contacts[k]
    return planar


def gap_and_rows(planar, c, q):
    """The gap of a contact, and the rows of its velocities along the normal and across it."""
    x, y, angle = q[c.body]
    body = planar.bodies[c.body]
    px, py = body.points[c.point]
    co, si = math.cos(angle), math.sin(angle)
    rx, ry = co * px - si * py, si * px + co * py
    if c.other >= 0:
        ox, oy, _ = q[c.other]
        dx, dy = x + rx - ox, y + ry - oy
        far = math.hypot(dx, dy)
        nx, ny = dx / far, dy / far
        gap = far - body.radius - planar.bodies[c.other].radius
    else:
        nx, ny = c.normal
        gap = nx * (x + rx) + ny * (y + ry) - c.level - body.radius
    ax, ay = rx - body.radius * nx, ry - body.radius * ny
    rows = []
    for ux, uy in ((nx, ny), (-ny, nx)):
        row = [(c.body, ux, uy, ax * uy - ay * ux)]
        if c.other >= 0:
            reach = planar.bodies[c.other].radius
            row.append((c.other, -ux, -uy, -(reach * nx * uy - reach * ny * ux)))
        rows.append(row)
    return gap, rows


def stepped(planar, until, steps):
    """Places, angles and velocities (bodies, 6) at a time, in equal steps."""
    h = until / steps
    q = [list(b.start) for b in planar.bodies]
    v = [list(b.velocity) for b in planar.bodies]
    inverse = [(1 / b.mass, 1 / b.mass, 1 / b.moment) for b in planar.bodies]
    gx, gy = planar.weight
    impulses = {}
    for _ in range(steps):
        for place, rate in zip(q, v, strict=True):
            for k in range(3):
                place[k] += 0.5 * h * rate[k]
        closed = []
        for index, c in enumerate(planar.contacts):
            gap, rows = gap_and_rows(planar, c, q)
            if gap <= 0.0:
                closed.append((index, c, rows))
        before = [sum(b * s for i, *r in rows[0] for b, s in zip(r, v[i], strict=True)) for _, _, rows in closed]
        for rate in v:
            rate[0] += h * gx
            rate[1] += h * gy
        if closed:
            impulses = solve_contacts(closed, before, v, inverse, impulses)
        else:
            impulses = {}
        for place, rate in zip(q, v, strict=True):
            for k in range(3):
                place[k] += 0.5 * h * rate[k]
    return np.hstack([q, v])


def solve_contacts(closed, before, v, inverse, last):
    """Impulses of what is closed, contact after contact until hardly any changes; v changes with them."""

    def push(row, by):
        for i, *r in row:
            for k in range(3):
                v[i][k] += inverse[i][k] * r[k] * by

    def speed(row):
        return sum(r[0] * v[i][0] + r[1] * v[i][1] + r[2] * v[i][2] for i, *r in row)

    masses = [
        [sum(inverse[i][k] * r[k] ** 2 for i, *r in row for k in range(3)) for row in rows] for _, _, rows in closed
    ]
    found = [list(last.get(index, (0.0, 0.0))) for index, _, _ in closed]
    for (_, _, rows), pair in zip(closed, found, strict=True):
        push(rows[0], pair[0])
        push(rows[1], pair[1])
    for _ in range(300):
        change, size = 0.0, 1e-300
        for k, (_, c, rows) in enumerate(closed):
            aim = c.restitution * min(before[k], 0.0)
            normal = max(0.0, found[k][0] - (speed(rows[0]) + aim) / masses[k][0])
            push(rows[0], normal - found[k][0])
            change = max(change, abs(normal - found[k][0]))
            found[k][0] = normal
            size = max(size, normal)
            if c.mu == 0.0:
                continue
            across = found[k][1] - speed(rows[1]) / masses[k][1]
            across = max(-c.mu * normal, min(c.mu * normal, across))
            push(rows[1], across - found[k][1])
            change = max(change, abs(across - found[k][1]))
            found[k][1] = across
        if change <= 1e-9 * size:
            break
    return {index: tuple(pair) for (index, _, _), pair in zip(closed, found, strict=True)}
