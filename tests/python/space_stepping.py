"""Random bodies in space that touch, and their motion by time stepping, which shares nothing with the library.

Balls, discs, ellipsoids and points of bodies over a plane that may lean, some on or inside a fixed sphere, some balls
to strike each other. Where a part is nearest to a plane is found here from its support function, attitudes are rotation
matrices, turned by exp(h omega) (O. Rodrigues), angular momenta follow the moments of forces, and impulses are those of
J. J. Moreau's time stepping (Unilateral contact and dry friction in finite freedom dynamics, 1988): half a step of
positions, impulses of all contacts that are closed there, half a step more. It finds no events; as its step goes to
zero its motion goes to that of the laws.
"""

import math
from dataclasses import dataclass, field

import numpy as np
import rbdyn as rb
from touching_by_hand import disc, ellipsoid

GRAVITY = 9.81


@dataclass
class Body:
    mass: float
    moments: np.ndarray
    place: np.ndarray
    attitude: np.ndarray  # quaternion, scalar first
    velocity: np.ndarray
    omega: np.ndarray  # along the axes of the body


@dataclass
class Contact:
    """A part of a body on the plane z = 0, on a sphere that is fixed, or on another body, which is a ball."""

    body: int
    part: str  # "point", "ball", "disc", "ellipsoid"
    size: np.ndarray  # place of a point; radius; semi-axes
    surface: str  # "plane", "outside", "inside", "ball"
    center: np.ndarray = field(default_factory=lambda: np.zeros(3))
    radius: float = 0.0
    other: int = -1
    restitution: float = 0.0
    mu: float = 0.0


@dataclass
class InSpace:
    gravity: np.ndarray
    bodies: list[Body] = field(default_factory=list)
    contacts: list[Contact] = field(default_factory=list)

    def scene(self):
        scene = rb.Scene(gravity=self.gravity)
        handles, contacts = [], []
        for b in self.bodies:
            handles.append(
                scene.add(
                    rb.RigidBody(b.mass, list(b.moments)),
                    position=b.place,
                    velocity=b.velocity,
                    attitude=b.attitude,
                    angular_velocity=b.omega,
                )
            )
        for c in self.contacts:
            handle = handles[c.body]
            part = {
                "point": lambda h=handle, c=c: h.point(c.size),
                "ball": lambda h=handle, c=c: h.sphere(c.size[0]),
                "disc": lambda h=handle, c=c: h.disc(c.size[0], [0, 0, 1]),
                "ellipsoid": lambda h=handle, c=c: h.ellipsoid(c.size),
            }[c.part]()
            surface = {
                "plane": lambda: rb.Plane([0, 0, 1]),
                "outside": lambda c=c: rb.Sphere(c.center, c.radius),
                "inside": lambda c=c: rb.Sphere(c.center, c.radius, inside=True),
                "ball": lambda c=c: handles[c.other].sphere(c.radius),
            }[c.surface]()
            friction = rb.Coulomb(c.mu) if c.mu > 0 else None
            contacts.append(scene.contact(part, surface, restitution=c.restitution, friction=friction))
        return scene, handles, contacts


def random_scene(seed, *, rough):
    random = np.random.default_rng(seed)
    slope, ways = float(random.choice([0.0, 0.2, 0.5])), random.uniform(0, 2 * math.pi)
    down = [math.sin(slope) * math.cos(ways), math.sin(slope) * math.sin(ways), -math.cos(slope)]
    space = InSpace(GRAVITY * np.array(down))
    surface = str(random.choice(["plane", "plane", "outside", "inside"]))
    far, balls = 0.0, []

    def law():
        return {
            "restitution": float(random.choice([0.0, 0.3, 0.7, 1.0])),
            "mu": float(random.choice([0.1, 0.3, 0.7])) if rough else 0.0,
        }

    for i in range(random.integers(1, 4) if surface == "plane" else 1):
        kind = str(random.choice(["ball", "disc", "ellipsoid", "points"]))
        if surface != "plane":
            kind = str(random.choice(["ball", "points", "disc", "ellipsoid"]))
        mass, sides, reach = random.uniform(0.5, 3.0), random.uniform(0.1, 0.3, 3), random.uniform(0.1, 0.3)
        moments = (
            mass
            * 0.2
            * np.array([sides[1] ** 2 + sides[2] ** 2, sides[0] ** 2 + sides[2] ** 2, sides[0] ** 2 + sides[1] ** 2])
        )
        size, points = np.array([reach]), [np.zeros(3)]
        if kind == "ball":
            moments = np.full(3, 0.4 * mass * reach**2)
            balls.append((i, reach))
        elif kind == "disc":
            moments = mass * reach**2 * np.array([0.25, 0.25, 0.5])
        elif kind == "ellipsoid":
            size, reach = sides, float(sides.max())
        else:
            reach = float(np.linalg.norm(sides))
            points = [sides * c for c in ([1, 1, 1], [1, -1, -1], [-1, 1, -1])][: random.integers(1, 4)]
        quaternion = random.normal(size=4)
        above = reach + random.uniform(0.02, 0.6)
        place = np.array([far + reach + 0.05, 0.02 * random.normal(), above])
        where = {}
        if surface == "outside":
            where = {"center": np.array([0.0, 0.0, -1.5]), "radius": 1.5}
            place[:2] = 0.2 * random.normal(size=2)
        elif surface == "inside":
            where = {"center": np.array([0.0, 0.0, 2.0]), "radius": 2.0}
            place = np.array([*(0.3 * random.normal(size=2)), 2.0])
        far += 2 * reach + 0.1
        space.bodies.append(
            Body(
                mass,
                moments,
                place,
                quaternion / np.linalg.norm(quaternion),
                random.normal(size=3),
                2 * random.normal(size=3),
            )
        )
        for point in points:
            part, extent = ("point", point) if kind == "points" else (kind, size)
            space.contacts.append(Contact(i, part, extent, surface, **where, **law()))
    for (i, _), (j, radius) in zip(balls, balls[1:], strict=False):
        reach = next(r for k, r in balls if k == i)
        space.contacts.append(Contact(i, "ball", np.array([reach]), "ball", radius=radius, other=j, **law()))
    return space


def matrix_of(q):
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def turned(a, by):
    """exp(by) a, the columns of a being axes."""
    angle = math.sqrt(by @ by)
    if angle == 0.0:
        return a
    n = by / angle
    cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    return a + math.sin(angle) * (cross @ a) + (1 - math.cos(angle)) * (cross @ (cross @ a))


def touching(space, c, places, axes):
    """Gap, normal, and where the contact is from the body's centre, and from the other's."""
    place, a = places[c.body], axes[c.body]
    if c.part == "point":
        middle, reach = place + a @ c.size, 0.0
    else:
        middle, reach = place, c.size[0]
    if c.surface == "plane":
        n = np.array([0.0, 0.0, 1.0])
        # the lowest place of the part, by its support function
        if c.part == "disc":
            across = n - a[:, 2] * a[2, 2]
            low = -across * (reach / math.sqrt(across @ across))
        elif c.part == "ellipsoid":
            stretched = a @ (c.size**2 * (a.T @ n))
            low = -stretched / math.sqrt(n @ stretched)
        else:
            low = -reach * n
        lowest = middle + low
        return lowest[2], n, lowest - place, None
    if c.part in ("disc", "ellipsoid"):
        inside = c.surface == "inside"
        y = a.T @ (c.center - middle)
        n, far = (disc(reach, inside) if c.part == "disc" else ellipsoid(c.size, inside))(y)
        out = 1.0 if inside else -1.0
        return -out * (far - c.radius), out * (a @ n), a @ (y - far * n), None
    away = middle - (places[c.other] if c.other >= 0 else c.center)
    far = math.sqrt(away @ away)
    if c.surface == "inside":
        n = -away / far
        return c.radius - far - reach, n, middle - reach * n - place, None
    n = away / far
    on_other = c.radius * n if c.other >= 0 else None
    return far - reach - c.radius, n, middle - reach * n - place, on_other


def slip(v, w, c, arm, on_other):
    """The velocity of the point of a part against its surface."""
    u = v[c.body] + np.cross(w[c.body], arm)
    return u if on_other is None else u - v[c.other] - np.cross(w[c.other], on_other)


def stepped(space, until, steps):
    """Places, rotation matrices, velocities, angular velocities (along the world's axes) at a time, in equal steps."""
    h = until / steps
    places = [b.place.copy() for b in space.bodies]
    axes = [matrix_of(b.attitude) for b in space.bodies]
    v = [b.velocity.copy() for b in space.bodies]
    w = [a @ b.omega for a, b in zip(axes, space.bodies, strict=True)]
    momenta = [a @ (b.moments * b.omega) for a, b in zip(axes, space.bodies, strict=True)]
    last = {}
    for _ in range(steps):
        for i in range(len(places)):
            places[i] = places[i] + 0.5 * h * v[i]
            # the momentum stays, the angular velocity that belongs to it turns with the body: by the midpoint
            half = turned(axes[i], 0.25 * h * w[i])
            middle = half @ ((half.T @ momenta[i]) / space.bodies[i].moments)
            axes[i] = turned(axes[i], 0.5 * h * middle)
        inverse = [a @ ((1.0 / b.moments)[:, None] * a.T) for a, b in zip(axes, space.bodies, strict=True)]
        w = [m @ o for m, o in zip(inverse, momenta, strict=True)]
        closed = []
        for index, c in enumerate(space.contacts):
            gap, n, arm, on_other = touching(space, c, places, axes)
            if gap <= 0.0:
                closed.append((index, c, n, arm, on_other))

        before = [n @ slip(v, w, c, arm, on_other) for _, c, n, arm, on_other in closed]
        for i in range(len(v)):
            v[i] = v[i] + h * space.gravity
        last = solve_contacts(space, closed, before, v, w, inverse, momenta, last)
        for i in range(len(places)):
            places[i] = places[i] + 0.5 * h * v[i]
            half = turned(axes[i], 0.25 * h * w[i])
            middle = half @ ((half.T @ momenta[i]) / space.bodies[i].moments)
            axes[i] = turned(axes[i], 0.5 * h * middle)
            w[i] = axes[i] @ ((axes[i].T @ momenta[i]) / space.bodies[i].moments)
    return places, axes, v, w


def solve_contacts(space, closed, before, v, w, inverse, momenta, last):
    """Impulses of what is closed, contact after contact until hardly any changes; velocities change with them."""
    if not closed:
        return {}

    def push(c, arm, on_other, impulse):
        v[c.body] = v[c.body] + impulse / space.bodies[c.body].mass
        momenta[c.body] = momenta[c.body] + np.cross(arm, impulse)
        w[c.body] = inverse[c.body] @ momenta[c.body]
        if on_other is not None:
            v[c.other] = v[c.other] - impulse / space.bodies[c.other].mass
            momenta[c.other] = momenta[c.other] - np.cross(on_other, impulse)
            w[c.other] = inverse[c.other] @ momenta[c.other]

    masses = []
    for _, c, n, arm, on_other in closed:
        # of the normal, and a bound of those across it
        own = 1 / space.bodies[c.body].mass + n @ np.cross(inverse[c.body] @ np.cross(arm, n), arm)
        bound = 1 / space.bodies[c.body].mass + np.trace(inverse[c.body]) * (arm @ arm)
        if on_other is not None:
            other = space.bodies[c.other]
            own += 1 / other.mass
            bound += 1 / other.mass + np.trace(inverse[c.other]) * (on_other @ on_other)
        masses.append((own, bound))
    found = [last.get(index, np.zeros(3)) for index, *_ in closed]
    for (_, c, _, arm, on_other), impulse in zip(closed, found, strict=True):
        push(c, arm, on_other, impulse)
    for _ in range(400):
        change, size = 0.0, 1e-300
        for k, (_, c, n, arm, on_other) in enumerate(closed):
            u = slip(v, w, c, arm, on_other)
            own, bound = masses[k]
            pressed = n @ found[k]
            normal = max(0.0, pressed - (n @ u + c.restitution * min(before[k], 0.0)) / own)
            push(c, arm, on_other, n * (normal - pressed))
            across = found[k] - n * pressed
            if c.mu > 0.0:
                u = slip(v, w, c, arm, on_other)
                wanted = across - (u - n * (n @ u)) / bound
                most = c.mu * normal
                length = math.sqrt(wanted @ wanted)
                if length > most:
                    wanted = wanted * (most / length)
                push(c, arm, on_other, wanted - across)
            else:
                wanted = np.zeros(3)
            now = n * normal + wanted
            change = max(change, float(abs(now - found[k]).max()))
            found[k] = now
            size = max(size, normal)
        if change <= 1e-9 * size:
            break
    return {index: impulse for (index, *_), impulse in zip(closed, found, strict=True)}
