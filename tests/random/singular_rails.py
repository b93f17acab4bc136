"""Random beads on rails whose parameter has singular points, against the same rails by a regular one.

    r(u) = p(g(u)), g with g' = 0 or g' infinite somewhere; p a line, a circle, a parabola or a wave
The motion along p is integrated by SciPy. The library may end a run with an error where the parameter is singular;
what it returns must be right.

    python tests/random/singular_rails.py [count] [first seed]
"""

import math
import sys

import numpy as np
import rbdyn as rb
from scipy.integrate import solve_ivp

# u -> g, and where it is used
PARAMETERS = {
    "cube": (lambda u: u**3, (-3, 3), np.cbrt),
    "fifth": (lambda u: u**5, (-3, 3), lambda x: np.sign(x) * abs(x) ** 0.2),
    "sine": (lambda u: 2 * np.sin(u), (-math.pi / 2, math.pi / 2), lambda x: math.asin(x / 2)),
    "almost": (lambda u: u + 0.9999 * np.sin(u), (-6, 6), None),
    "touching": (lambda u: u + np.sin(u), (-6, 6), None),
    "root": (lambda u: 1 - np.sqrt(2 - u), (-4, 2), lambda x: 2 - (1 - x) ** 2),
    "square": (lambda u: u**2, (0, 2), math.sqrt),
}


def shapes(rng):
    a, k = rng.uniform(0.2, 1.5), rng.uniform(0.5, 2)
    return [
        (lambda s: (s, 0.3 * s), lambda s: (1.0, 0.3), lambda s: (0.0, 0.0)),
        (
            lambda s: (a * np.sin(s / a), -a * np.cos(s / a)),
            lambda s: (math.cos(s / a), math.sin(s / a)),
            lambda s: (-math.sin(s / a) / a, math.cos(s / a) / a),
        ),
        (lambda s: (s, a * s * s), lambda s: (1.0, 2 * a * s), lambda s: (0.0, 2 * a)),
        (
            lambda s: (s, a * np.sin(k * s)),
            lambda s: (1.0, a * k * math.cos(k * s)),
            lambda s: (0.0, -a * k * k * math.sin(k * s)),
        ),
    ][rng.integers(4)]


def check(seed, until=2.0, error=1e-8):
    """Nothing, "ended" if the library ended the run, or what is wrong."""
    rng = np.random.default_rng(seed)
    name = list(PARAMETERS)[rng.integers(len(PARAMETERS))]
    g, (low, high), _ = PARAMETERS[name]
    place, first, second = shapes(rng)
    u = rng.uniform(low + 0.05 * (high - low), high - 0.05 * (high - low))
    s = float(g(np.float64(u)))
    field = rng.normal(size=2) * 6 if rng.random() < 0.8 else np.zeros(2)
    speed = rng.normal() * 3
    if rng.random() < 0.3:
        speed = 0.0
    growing = float(g(np.float64(u + 1e-6)) - g(np.float64(u - 1e-6))) > 0
    v = speed if growing else -speed  # along growing s

    def rates(t, y):
        s, w = y
        d, b = np.array(first(s)), np.array(second(s))
        return [w, (d @ field - d @ b * w * w) / (d @ d)]

    d = np.array(first(s))
    sol = solve_ivp(
        rates, (0, until), [s, v / np.hypot(*d)], method="DOP853", rtol=1e-12, atol=1e-13, dense_output=True
    )
    curve = rb.Curve(lambda u: [place(g(u))[0], 0 * u, place(g(u))[1]])
    scene = rb.Scene(gravity=[field[0], 0, field[1]])
    bead = scene.add(rb.Particle(1.0), rb.Rail(curve), parameter=u, speed=speed)
    try:
        run = rb.simulate(scene, until, error=error)
    except (rb.IntegrationError, rb.AccuracyError) as ended:
        run = ended.run
        until = run.certain_until * (1 - 1e-6)
        what = "ended"
    else:
        what = None
        until = run.end
    # below the last of a root or a square there is no rail
    times = np.linspace(0, until, 201)
    true = np.array([place(x) for x in sol.sol(times)[0]])
    size = 1 + abs(true).max()
    off = abs(run[bead].position(times)[:, [0, 2]] - true).max()
    if off > 3e-5 * size if what else off > 1e-6 * size:
        k = int(np.argmax(abs(run[bead].position(times)[:, [0, 2]] - true).max(axis=1) > 1e-6 * size))
        return f"{name}: off by {off} of {size}, first at {times[k]} of {until}, {what}, told {run.error}"
    return what


if __name__ == "__main__":
    count, first_seed = (int(a) for a in (sys.argv[1:] + ["200", "0"][len(sys.argv) - 1 :]))
    results = [(seed, check(seed)) for seed in range(first_seed, first_seed + count)]
    for seed, what in results:
        if what and what != "ended":
            print(seed, what)
    print(
        f"{count} scenes, {sum(w == 'ended' for _, w in results)} ended, "
        f"{sum(w not in (None, 'ended') for _, w in results)} wrong"
    )
