"""A disc or an ellipsoid that stays on a fixed sphere, or in a bowl, by the distance from the sphere's centre to it.

In the axes of the body the centre of the sphere is at y; F(y) is its distance from the nearest or the farthest point of
the body's surface, x = y - F n, n = grad F. It stays R: F'' = 0 is n.y'' + y'.H y' = 0 with the Hessian H of F; what
rolls has no velocity at x, which moves in the body by y' - R H y'. The root of the multiplier is found by bisection
(Brent's method), and H by differences of n, so nothing here is an equation of the library.
"""

import numpy as np
import rbdyn as rb
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

GRAVITY = np.array([0, 0, -9.81])


def ellipsoid(semi_axes, inside):
    a = np.asarray(semi_axes, dtype=float)

    def gradient(y):
        z = a * y

        def beyond(m):
            return np.linalg.norm(z / (a**2 + m)) - 1

        if inside:
            m = brentq(
                beyond, -np.linalg.norm(z) - a.max() ** 2 - 1e-9, -(a.max() ** 2) * (1 + 1e-12), xtol=1e-300, rtol=1e-15
            )
        else:
            m = brentq(beyond, 0.0, np.linalg.norm(z) + 1e-9, xtol=1e-300, rtol=1e-15)
        away = y - a**2 * y / (a**2 + m)
        return away / np.linalg.norm(away), np.linalg.norm(away)

    return gradient


def disc(radius, inside):
    """Its F is that of a circle, and on its face the height; the third axis of the body is across it."""

    def gradient(y):
        flat = np.array([y[0], y[1], 0])
        across = np.linalg.norm(flat)
        if inside:
            away = y + radius * flat / across
        else:
            away = y - flat * min(1.0, radius / across if across > 0 else 1.0)
        return away / np.linalg.norm(away), np.linalg.norm(away)

    def hessian(y):
        """By the two principal curvatures of what is F away from the circle."""
        across = np.hypot(y[0], y[1])
        n, far = gradient(y)
        if not inside and across <= radius:
            return np.zeros((3, 3))
        around = np.array([-y[1], y[0], 0]) / across
        beside = np.cross(n, around)
        along = n[:2] @ y[:2] / across
        return np.outer(beside, beside) / far + np.outer(around, around) * along / across

    gradient.hessian = hessian
    return gradient


def hessian(gradient, y, step=5e-4):
    """Central differences of sixth order."""
    if hasattr(gradient, "hessian"):
        return gradient.hessian(y)
    weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    columns = []
    for e in step * np.eye(3):
        columns.append(sum(w * (gradient(y + i * e)[0] - gradient(y - i * e)[0]) for i, w in weights.items()) / step)
    return np.array(columns).T


def turned(q):
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def motion(gradient, mass, moments, q, velocity, omega, times, rolls, center):
    """Places of the centre and attitudes at times; omega in the axes of the body. The sphere's centre is the origin."""
    moments = np.asarray(moments, dtype=float)

    def accelerations(c, q, v, w):
        turn = turned(q)
        g, v = turn.T @ GRAVITY, turn.T @ v  # in the axes of the body
        y = -turn.T @ c
        n, far = gradient(y)
        y_rate = -v - np.cross(w, y)
        bend = hessian(gradient, y)
        x = y - far * n
        gyro = np.cross(w, moments * w)
        if rolls:
            x_rate = y_rate - far * (bend @ y_rate)
            # v = -w x x: force = m (a - g), a = -(alpha x x) - w x x' + w x v
            given = -np.cross(w, x_rate) + np.cross(w, v)

            def lack(alpha):
                force = mass * (given - np.cross(alpha, x) - g)
                return moments * alpha + gyro - np.cross(x, force)

            offset = lack(np.zeros(3))
            alpha = np.linalg.solve(np.array([lack(e) - offset for e in np.eye(3)]).T, -offset)
            return turn @ (given - np.cross(alpha, x)), alpha
        # n.y'' = -y'.H y' with y'' = -(a + alpha x y) - 2 w x y' - w x (w x y)
        free = -g - np.cross(-gyro / moments, y) - 2 * np.cross(w, y_rate) - np.cross(w, np.cross(w, y))
        push = -n  # from the sphere to the body along y - x reversed
        turning = np.cross(x, push) / moments
        by_push = -push / mass - np.cross(turning, y)
        size = -(y_rate @ bend @ y_rate + n @ free) / (n @ by_push)
        return turn @ (g + push * size / mass), (np.cross(x, push * size) - gyro) / moments

    def rates(_, state):
        c, q, v, w = state[:3], state[3:7], state[7:10], state[10:]
        a, alpha = accelerations(c, q, v, w)
        s, u = q[0], q[1:]
        return np.concatenate([v, [-0.5 * u @ w], 0.5 * (s * w + np.cross(u, w)), a, alpha])

    start = np.concatenate([center, q, velocity, omega])
    found = solve_ivp(rates, (0, times[-1]), start, method="DOP853", rtol=1e-12, atol=1e-13, t_eval=times)
    return found.y[:3].T, np.array([q / np.linalg.norm(q) for q in found.y[3:7].T])


def align(direction, wanted, turn):
    """A quaternion that turns one unit vector to another, and then about it."""
    half = np.concatenate([[1 + direction @ wanted], np.cross(direction, wanted)])
    half /= np.linalg.norm(half)
    about = np.concatenate([[np.cos(turn / 2)], np.sin(turn / 2) * wanted])
    s, v, t, w = about[0], about[1:], half[0], half[1:]
    return np.concatenate([[s * t - v @ w], s * w + t * v + np.cross(v, w)])


class Touching:
    """A random body that touches a sphere near its top, or a bowl near its bottom, and slides or rolls there."""

    def __init__(self, seed, kind, inside, rolls, radius_of_ball=None):
        random = np.random.default_rng(seed)
        self.inside, self.rolls = inside, rolls
        self.mass = random.uniform(0.5, 3)
        self.moments = self.mass * random.uniform(0.05, 0.08, 3)
        if kind == "ellipsoid":
            axes = random.uniform(0.3, 0.6, 3)
            self.radius = random.uniform(1.1, 2) * axes.max() ** 2 / axes.min() if inside else random.uniform(0.2, 1.5)
            self.distance = ellipsoid(axes, inside)
            self.shape = lambda body: body.ellipsoid(axes)
            x = random.normal(size=3)
            x *= axes / np.linalg.norm(x)
            n = x / axes**2
        else:
            radius = random.uniform(0.3, 0.6)
            self.radius = radius * random.uniform(1.3, 3) if inside else random.uniform(0.3, 1.5)
            self.distance = disc(radius, inside)
            self.shape = lambda body: body.disc(radius, [0, 0, 1])
            # in a bowl the other side of the rim is nearer to the bowl where it lies flatter
            steepest = np.arccos(radius / self.radius) if inside else np.pi / 2
            around, tilt = random.uniform(0, 2 * np.pi), random.uniform(-0.8, 0.8) * steepest
            x = radius * np.array([np.cos(around), np.sin(around), 0])
            n = np.array([np.cos(around) * np.cos(tilt), np.sin(around) * np.cos(tilt), np.sin(tilt)])
            self.radius = radius_of_ball or self.radius
            if kind == "face":
                x, n = x * random.uniform(0, 0.6), np.array([0, 0, 1])
        n = n / np.linalg.norm(n)
        self.y = x - self.radius * n if inside else x + self.radius * n
        up = np.array([random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 1])
        self.attitude = align(-n, up / np.linalg.norm(up), random.uniform(0, 6))
        turn = turned(self.attitude)
        self.center = -turn @ self.y
        self.omega = random.normal(size=3)
        normal, _ = self.distance(self.y)
        velocity = random.normal(size=3) * 0.5
        velocity -= normal * (normal @ (velocity + np.cross(self.omega, x)))
        self.velocity = turn @ (-np.cross(self.omega, x) if rolls else velocity)

    def scene(self):
        scene = rb.Scene(gravity=GRAVITY)
        body = scene.add(
            rb.RigidBody(self.mass, list(self.moments)),
            position=self.center,
            attitude=self.attitude,
            velocity=self.velocity,
            angular_velocity=self.omega,
        )
        friction = rb.Coulomb(np.inf) if self.rolls else None
        contact = scene.contact(
            self.shape(body), rb.Sphere([0, 0, 0], self.radius, inside=self.inside), friction=friction
        )
        return scene, body, contact

    def motion(self, times):
        """Places of the centre of mass and matrices of the attitude."""
        places, attitudes = motion(
            self.distance,
            self.mass,
            self.moments,
            self.attitude,
            self.velocity,
            self.omega,
            times,
            self.rolls,
            self.center,
        )
        return places, np.array([turned(q) for q in attitudes])
