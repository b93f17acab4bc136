"""The main job in one go: a bead on a rough vertical hoop swings, sticks and stays.

Prints the plan, the events beside their closed form, the estimate of the error beside the true error, and what the
same answer costs; saves a figure.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import rbdyn as rb

RADIUS, GRAVITY, MU_STATIC, MU_DYNAMIC, MASS, SPEED = 0.5, 9.8125, 0.375, 0.125, 0.5, 7.0
Real = np.longdouble
Function = Callable[[Any], Any]  # of extended precision


def closed_form() -> list[tuple[Any, str, Any, Any]]:
    """Times, kinds, angles and v^2 of the events, in extended precision.

    Eq. 7.25 on a circle, theta from the lowest point, is linear in v^2(theta) while c = f_d sign(theta') sign(N) lasts:
        v^2 = P(theta) + (v0^2 - P(theta0)) exp(-2 c (theta - theta0))
        P   = 2 g R ((1 - 2 c^2) cos(theta) - 3 c sin(theta)) / (1 + 4 c^2)
    """
    r, g = Real(RADIUS), Real(GRAVITY)
    v2: Any = Real(SPEED) ** 2
    time, angle, way, side = Real(0), Real(0), 1, 1
    events: list[tuple[Any, str, Any, Any]] = []
    while True:
        c, start = Real(MU_DYNAMIC) * way * side, angle
        v2_start: Any = v2

        def particular(x: Any, c: Any = c) -> Any:
            return 2 * g * r * ((1 - 2 * c**2) * np.cos(x) - 3 * c * np.sin(x)) / (1 + 4 * c**2)

        def square(x: Any, c: Any = c, start: Any = start, v2_start: Any = v2_start) -> Any:
            return particular(x) + (v2_start - particular(start)) * np.exp(-2 * c * (x - start))

        def pressure(x: Any, side: int = side, square: Function = square) -> Any:
            return side * (square(x) / r + g * np.cos(x))

        # the first angle ahead where the speed or the normal reaction vanishes
        step = way * Real(1) / 64
        before = start + step / 64
        while square(before + step) > 0 and pressure(before + step) > 0:
            before += step
        turn, zero = first_zero(square, before, before + step), first_zero(pressure, before, before + step)
        angle = turn if way * (turn - zero) < 0 else zero
        v2 = square(angle) if angle == zero else Real(0)

        def departing(end: Any, v2_end: Any, d: Any, c: Any = c, particular: Function = particular) -> Any:
            """v^2 at a distance d from an end, without cancellation where it vanishes."""
            half = np.sin(d / 2)
            change = -2 * (1 - 2 * c**2) * np.sin(end + d / 2) * half - 6 * c * np.cos(end + d / 2) * half
            return v2_end + 2 * g * r * change / (1 + 4 * c**2) + (v2_end - particular(end)) * np.expm1(-2 * c * d)

        time += r * duration(departing, start, v2_start, angle, v2)
        if angle == zero:
            side = -side
            events.append((time, "normal-zero", angle, v2))
            continue
        way, side = -way, 1 if np.cos(angle) > 0 else -1
        sticks = abs(np.tan(angle)) <= MU_STATIC
        events.append((time, "stick" if sticks else "reverse", angle, v2))
        if sticks:
            return events


def first_zero(f: Function, lo: Any, hi: Any) -> Any:
    """Bisection from a positive value; past the far end if there is no zero."""
    if f(hi) > 0:
        return hi + (hi - lo)
    for _ in range(80):
        middle = (lo + hi) / 2
        lo, hi = (middle, hi) if f(middle) > 0 else (lo, middle)
    return (lo + hi) / 2


def duration(departing: Callable[[Any, Any, Any], Any], lo: Any, v2_lo: Any, hi: Any, v2_hi: Any) -> Any:
    """Integral of |d theta| / v, whose ends may be inverse square roots.

    Double exponential rule: Takahasi and Mori, Publ. RIMS Kyoto 9 (1974) 721-741.
    """
    half, h, total = (hi - lo) / 2, Real(1) / 64, Real(0)
    for k in range(-250, 251):
        u = Real(np.pi) / 2 * np.sinh(k * h)
        d = half * 2 / (1 + np.exp(2 * abs(u)))  # from the nearer end
        square = departing(lo, v2_lo, d) if u < 0 else departing(hi, v2_hi, -d)
        if d != 0 and square > 0:
            total += Real(np.pi) / 2 * np.cosh(k * h) / np.cosh(u) ** 2 / np.sqrt(square)
    return abs(half * h * total)


def digits(value: float, exact: Any, scale: float = 1.0) -> float:
    difference = abs(float(Real(value) - exact)) / scale
    return 16.0 if difference == 0 else min(16.0, -float(np.log10(difference)))


def main() -> None:
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    hoop = rb.Rail(
        rb.Circle(radius=RADIUS, start=[0, 0, -1], toward=[1, 0, 0]),
        friction=rb.Coulomb(mu_static=MU_STATIC, mu_dynamic=MU_DYNAMIC),
    )
    bead = scene.add(rb.Particle(mass=MASS), hoop, parameter=0.0, speed=SPEED, name="bead")
    print(rb.plan(scene))

    run = rb.simulate(scene, until=60.0, error=1e-12)
    exact = closed_form()
    print(run)
    print("Events beside the closed form (digits: of the time, relative; of the angle; of v^2, relative to the start)")
    print(f"  {'time [s]':>20}  {'kind':<12} {'angle [rad]':>20}  {'v^2 [m^2/s^2]':>14}   digits")
    worst = 0.0
    for event, (time, kind, angle, v2) in zip(run.events, exact, strict=True):
        theta, speed = run[bead].parameter(event.time), run[bead].speed(event.time)
        agree = digits(event.time, time, float(time)), digits(theta, angle), digits(speed**2, v2, SPEED**2)
        worst = max(worst, abs(float(Real(event.time) - time)) / float(time))
        assert event.kind == kind, (event.kind, kind)
        shown = "  ".join(f"{d:4.1f}" for d in agree)
        print(f"  {event.time:20.16f}  {kind:<12} {theta:20.16f}  {speed**2:14.10f}   {shown}")
    print(f"Estimated error of the run {run.error:.1e}, true error of its event times {worst:.1e}\n")

    print("What the same answer costs")
    price = rb.cost(scene, until=60.0, errors=[1e-6, 1e-9, 1e-12], budget=3.0)
    print(price)

    path = Path("build") if Path("build").is_dir() else Path()
    path = (path / "hoop.png").resolve()
    rb.simulate(scene, until=1.1 * run.events[-1].time, error=1e-12).plot(path)
    print(f"Figure: {path}")


if __name__ == "__main__":
    main()
