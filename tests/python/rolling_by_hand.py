"""A rigid body on a fixed horizontal plane, written down apart from the library: Newton's and Euler's laws, SciPy.

m a = F - m g k, d(I w)/dt = r x F + T about the centre of mass; r goes from there to the lowest point of the body.
Rolling: v + w x r = 0, differentiated. Sliding: F = N (k - mu u/|u|), u = v + w x r, and the lowest point stays at
height 0. T = -rolling N h/|h|, h what of w is horizontal. Attitudes are matrices, which nothing makes orthogonal.
"""

import numpy as np
from scipy.integrate import solve_ivp

K = np.array([0.0, 0.0, 1.0])


def cross(a):
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def ellipsoid(semi_axes, center=(0.0, 0.0, 0.0)):
    """The lowest point and its rate, body axes, from the upward normal there (unit) and its rate."""
    squares, center = np.square(semi_axes), np.asarray(center)

    def lowest(n, rate):
        p = np.sqrt(n @ (squares * n))
        r = -squares * n / p
        return center + r, -squares * rate / p - r * (n @ (squares * rate)) / p**2

    return lowest


def disc(radius):
    """The same of a disc without thickness about the axis z of the body."""

    def lowest(n, rate):
        flat, flat_rate = n * [1, 1, 0], rate * [1, 1, 0]
        size = np.linalg.norm(flat)
        u = flat / size
        return -radius * u, -radius * (flat_rate - u * (u @ flat_rate)) / size

    return lowest


class Body:
    def __init__(self, mass, inertia, lowest, gravity, mu=None, rolling=0.0):
        self.mass, self.inertia, self.lowest = mass, np.asarray(inertia), lowest
        self.gravity, self.mu, self.rolling = gravity, mu, rolling

    def arm(self, turn, w):
        """r and its rate, world axes; w in body axes."""
        n = turn.T @ K
        r, rate = self.lowest(n, -np.cross(w, n))
        return turn @ r, turn @ (rate + np.cross(w, r))

    def rates(self, t, y):
        turn, v, w = y[:9].reshape(3, 3), y[12:15], y[15:18]  # w in world axes
        own = turn.T @ w
        r, r_rate = self.arm(turn, own)
        inertia = turn @ self.inertia @ turn.T
        h = w * [1, 1, 0]
        torque = -self.rolling * h / np.linalg.norm(h) if self.rolling else np.zeros(3)
        # unknown: a, w', F
        A, b = np.zeros((9, 9)), np.zeros(9)
        A[:3, :3], A[:3, 6:] = self.mass * np.eye(3), -np.eye(3)
        b[:3] = -self.mass * self.gravity * K
        A[3:6, 3:6], A[3:6, 6:] = inertia, -cross(r) - np.outer(torque, K)
        b[3:6] = -np.cross(w, inertia @ w)
        bias = -np.cross(w, r_rate)  # a + w' x r = bias
        if self.mu is None:
            A[6:, :3], A[6:, 3:6], b[6:] = np.eye(3), -cross(r), bias
        else:
            u = v + np.cross(w, r)
            A[6, :3], A[6, 3:6], b[6] = K, (-cross(r))[2], bias[2]
            u = u * [1, 1, 0]
            A[7:9, 6:8] = np.eye(2)
            A[7:9, 8] = self.mu * u[:2] / np.linalg.norm(u)
        found = np.linalg.solve(A, b)
        return np.concatenate([(cross(w) @ turn).ravel(), v, found[:6]])

    def run(self, turn, w, times, v=None):
        """Rows of (attitude 9, place 3, velocity 3, angular velocity 3), world axes; w at the start in body axes."""
        turn = np.asarray(turn, dtype=float)
        r, _ = self.arm(turn, np.asarray(w, dtype=float))
        w = turn @ w
        v = -np.cross(w, r) if v is None else np.asarray(v)
        start = np.concatenate([turn.ravel(), [0, 0, -r[2]], v, w])
        found = solve_ivp(
            self.rates, (0, times[-1]), start, method="DOP853", t_eval=times, rtol=1e-12, atol=1e-13, max_step=0.05
        )
        assert found.success
        return found.y.T
