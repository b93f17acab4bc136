"""Random scenes in space of up to six contacts.

Balls, rods, tetrahedra, discs and ellipsoids over a floor that may lean, some beside a wall, some of the balls to
strike each other.
"""

import math

import numpy as np
import rbdyn as rb

GRAVITY = 9.81


class Space:
    """A scene, its bodies, and its contacts: handle, static coefficient, and normal, None between two balls."""

    def __init__(self, seed, *, rough):
        random = np.random.default_rng(seed)
        slope, ways = float(random.choice([0.0, 0.0, 0.2, 0.5])), random.uniform(0, 2 * math.pi)
        down = [math.sin(slope) * math.cos(ways), math.sin(slope) * math.sin(ways), -math.cos(slope)]
        self.scene = rb.Scene(gravity=GRAVITY * np.array(down))
        self.bodies, self.contacts = [], []
        touching, self.far = [], -1.0
        wall = random.random() < 0.3
        for _ in range(random.integers(1, 4)):
            touching.append(self.add_body(random, int(random.integers(5))))
        balls = [shapes[0] for kind, shapes in touching if kind == 0]
        wanted = [(a, b, None) for a, b in zip(balls, balls[1:], strict=False)]
        for _, shapes in touching:
            wanted += [(shape, rb.Plane([0, 0, 1]), [0, 0, 1]) for shape in shapes]
            if wall:
                wanted.append((shapes[0], rb.Plane([-1, 0, 0], [self.far + 0.3, 0, 0]), [-1, 0, 0]))
        # six at most
        for k in sorted(random.permutation(len(wanted))[:6]):
            a, b, normal = wanted[k]
            mu = float(random.choice([0.1, 0.3, 0.7])) if rough else 0.0
            friction = rb.Coulomb(mu, mu * float(random.choice([0.6, 1.0]))) if rough else None
            restitution = float(random.choice([0.0, 0.0, 0.3, 0.7, 1.0]))
            self.contacts.append((self.scene.contact(a, b, restitution=restitution, friction=friction), mu, normal))

    def add_body(self, random, kind):
        """Beside those that are there; its kind and what it touches with."""
        mass, reach = random.uniform(0.5, 3.0), random.uniform(0.1, 0.3)
        sides = random.uniform(0.1, 0.3, 3)
        if kind == 0:
            body = rb.shapes.sphere(mass=mass, radius=reach)
        elif kind == 1:
            body = rb.shapes.box(mass, [2 * reach, 0.02, 0.02])
        elif kind == 2:
            body, reach = rb.shapes.box(mass, 2 * sides), float(np.linalg.norm(sides))
        elif kind == 3:
            body = rb.shapes.disc(mass, reach, [0, 0, 1])
        else:
            body, reach = rb.shapes.ellipsoid(mass, sides), float(sides.max())
        quaternion = random.normal(size=4)
        handle = self.scene.add(
            body,
            position=[self.far + reach + 0.05, 0.02 * random.normal(), reach + random.uniform(0.02, 0.6)],
            velocity=random.normal(size=3),
            attitude=quaternion / np.linalg.norm(quaternion),
            angular_velocity=2.0 * random.normal(size=3),
        )
        self.far += 2 * reach + 0.1
        self.bodies.append(handle)
        corners = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
        if kind == 0:
            return kind, [handle.sphere(reach)]
        if kind == 1:
            return kind, [handle.point([reach, 0, 0]), handle.point([-reach, 0, 0])]
        if kind == 2:
            return kind, [handle.point(sides * corner) for corner in corners]
        if kind == 3:
            return kind, [handle.disc(reach, [0, 0, 1])]
        return kind, [handle.ellipsoid(sides)]
