"""Watched functions with poles, corners, infinite slopes and ends, at random; their roots are known.

A particle moves along x by a law in closed form, and what is watched is a function of x whose roots, poles and end are
drawn: every root is an event, no pole is one, and where the function ceases to be a number the run says so.

    python rough_watches.py [number of scenes] [seed]
"""

import sys
from collections import Counter

import numpy as np
import rbdyn as rb

ENGINES = ("auto", "taylor", "dop853", "cvode-adams", "cvode-bdf")
UNTIL = 3.0


def path(random):
    """A scene whose particle moves along x from 0, its time at a place, and the place at UNTIL."""
    speed, k = random.uniform(0.3, 2.0), random.uniform(0.1, 1.0)
    scene = rb.Scene()
    body = scene.add(rb.Particle(1.0), position=[0, 0, 0], velocity=[speed, 0, 0])
    kind = random.integers(3)
    if kind == 0:
        return scene, body, lambda x: x / speed, speed * UNTIL
    if kind == 1:  # v = v0 exp(-k t)
        scene.apply(rb.Drag(linear=k), body)
        return scene, body, lambda x: -np.log1p(-k * x / speed) / k, speed * -np.expm1(-k * UNTIL) / k
    scene.apply(rb.Drag(quadratic=k), body)  # x = log(1 + k v0 t) / k
    return scene, body, lambda x: np.expm1(k * x) / (k * speed), np.log1p(k * speed * UNTIL) / k


def places(random, count, end):
    """Places well apart within (0, end)."""
    return random.permutation(np.linspace(0.0, end, count + 2)[1:-1]) + random.uniform(-0.2, 0.2) * end / (count + 1)


def watched(random, end):
    """A function of x, its roots before `end`, and where it ceases to be a number; its name."""
    kind = random.integers(9)
    if kind <= 2:  # roots and poles, and perhaps infinite or without slope at the start
        roots, poles = np.split(places(random, 5, end), [random.integers(1, 5)])
        power = (0.0, 0.5, -1.0, 1.5)[random.integers(4)]

        def rational(x):
            y = x**power if power else 1.0
            for r in roots:
                y = y * (x - r)
            for p in poles:
                y = y / (x - p)
            return y

        return rational, sorted(roots), None, f"rational, x**{power}"
    if kind == 3:
        rate, phase = random.uniform(2, 12) / end, random.uniform(0.1, 1.4)
        k = np.arange(1, 20)
        roots = (np.pi * k - phase) / rate
        return lambda x: np.tan(rate * x + phase), roots[roots < end], None, "tan"
    (a,) = places(random, 1, end)
    if kind == 4:
        return lambda x: np.log(x) - np.log(a), [a], None, "log"
    if kind == 5:
        power = random.choice([0.1, 1 / 3, 0.5, 1.5, 2.5])
        return lambda x: x**power - a**power, [a], None, f"x**{power}"
    if kind == 6:
        b = a * random.uniform(0.1, 0.9)
        return lambda x: abs(x - a) - b, [r for r in (a - b, a + b) if r < end], None, "abs"
    if kind == 7:
        b = a * random.uniform(0.1, 0.9)
        return lambda x: np.log(a - x) - np.log(a - b), [b], a, "log to its end"
    b = a * random.uniform(0.1, 0.9)
    return lambda x: np.sqrt(a - x) - np.sqrt(a - b), [b], a, "sqrt to its end"


def check(seed):
    """What is wrong with one scene; empty if nothing is."""
    random = np.random.default_rng(seed)
    scene, body, time_at, end = path(random)
    f, roots, ends, name = watched(random, end)
    engine, is_called = ENGINES[random.integers(len(ENGINES))], random.random() < 0.3
    if is_called:

        def function(now):
            with np.errstate(all="ignore"):
                return float(f(np.float64(now[body].position[0])))
    else:

        def function(now):
            return f(now[body].position[0])

    scene.watch("w", function)
    what = f"{seed}: {name}, {engine}, {'called back' if is_called else 'recorded'}: "
    try:
        run = rb.simulate(scene, until=UNTIL, error=1e-7, engine=engine)
        if ends is not None:
            return what + f"no error, and its end is at {time_at(ends)}"
    except rb.IntegrationError as error:
        run = error.run
        if ends is None or '"w"' not in str(error) or abs(run.end - time_at(ends)) > 1e-6:
            return what + str(error)
    except rb.Error as error:
        return what + str(error)
    found = run.events.times("w")
    expected = time_at(np.array(roots, dtype=float))
    if len(found) != len(expected) or (len(found) and np.max(np.abs(found - expected)) > 1e-6):
        return what + f"{found}, not {expected}"
    return ""


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    wrong = Counter()
    for seed in range(first, first + count):
        message = check(seed)
        if message:
            wrong[message.split(":")[1].split(",")[0]] += 1
            if sum(wrong.values()) <= 20:
                print(message)
    print(f"{count} scenes, {sum(wrong.values())} wrong", dict(wrong))
