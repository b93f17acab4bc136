"""A double pendulum one wrote oneself, x' = f(t, x): beside SciPy, and what each of them takes."""

import importlib
import time
from typing import Any

import numpy as np
import rbdyn as rb

G, M1, M2, L1, L2 = 9.81, 1.0, 0.7, 1.0, 0.6


def double_pendulum(t: Any, x: Any) -> list[Any]:
    a, b, p, q = x  # angles from the vertical [rad], and their rates
    d, m = a - b, M1 + M2
    first = -M2 * L2 * q**2 * np.sin(d) - m * G * np.sin(a)
    second = L1 * p**2 * np.sin(d) - G * np.sin(b)
    scale = L1 * L2 * (m - M2 * np.cos(d) ** 2)
    return [
        p,
        q,
        (first * L2 - M2 * L2 * np.cos(d) * second) / scale,
        (m * L1 * second - L1 * np.cos(d) * first) / scale,
    ]


start = [1.0, 1.5, 0.0, 0.0]
system = rb.System(double_pendulum, start, names=["upper", "lower", "upper rate", "lower rate"])
system.watch("upper hangs", lambda now: now["upper"], direction="rising")
print(rb.plan(system), "\n")

began = time.perf_counter()
run = rb.simulate(system, until=10.0, error=1e-11)
seconds = time.perf_counter() - began
print(run, *run.events, "", sep="\n")
assert run.statistics.python_calls == 0

integrate: Any = importlib.import_module("scipy.integrate")
began = time.perf_counter()
scipys = integrate.solve_ivp(double_pendulum, (0, 10), start, method="DOP853", rtol=1e-13, atol=1e-14)
print(f"rbdyn, with an estimate of its error: {1e3 * seconds:.1f} ms")
print(f"SciPy's DOP853 at 1e-13, without one: {1e3 * (time.perf_counter() - began):.1f} ms")
print("differences at the end:", run.x(10.0) - scipys.y[:, -1])
assert np.abs(run.x(10.0) - scipys.y[:, -1]).max() < 1e-10  # of numbers up to 12
