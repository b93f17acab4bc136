"""Random scenes with watched functions whose roots are known: none missed, none doubled, none false, none out of order.

The truth is computed apart from the library: motions in powers of time in exact rational arithmetic, oscillations and
drag by their closed forms in 50 digits. What a scene leaves open is not counted either way: a root that rounding of
the function's own terms, or the error asked for, cannot tell from the start, from the end or from a graze.

    python tests/random/events.py --count 20000 --seed 1
"""

import argparse
import math
import random
import sys
from collections import Counter
from dataclasses import dataclass, field
from decimal import Decimal, getcontext
from fractions import Fraction

import numpy as np
import rbdyn as rb

getcontext().prec = 50
EPSILON = 2.0**-52
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")


def decimal(x) -> Decimal:
    """Of a float or a fraction, to 50 digits."""
    x = Fraction(x)
    return Decimal(x.numerator) / Decimal(x.denominator)


@dataclass
class Root:
    """Where a function passes zero: time since the start [s], direction, and how sharply it is known."""

    time: float
    direction: str
    doubt: float  # [s]
    certain: bool = True


# --- functions of time with known roots ---------------------------------------------------------------------------


@dataclass
class Quadratic:
    """a + b s + c s^2, `terms`: what its constant is a difference of."""

    a: Fraction
    b: Fraction
    c: Fraction
    terms: float

    def shifted(self, by: float) -> "Quadratic":
        return Quadratic(self.a - Fraction(by), self.b, self.c, self.terms + abs(by))

    def size(self, s: float) -> float:
        return self.terms + abs(float(self.b) * s) + abs(float(self.c) * s * s)

    def roots(self, until: float, noise: float, spread: float) -> list[Root]:
        a, b, c = self.a, self.b, self.c
        if c == 0:
            times = [] if b == 0 else [decimal(-a / b)]
        else:
            square = b * b - 4 * a * c
            if square < 0:
                # a lobe that misses zero by rounding may be seen to pass it
                depth, place = abs(float(a - b * b / (4 * c))), float(-b / (2 * c))
                if 0 <= place <= until * (1 + 1e-6) and depth <= noise * self.size(place) + spread:
                    width = math.sqrt((noise * self.size(place) + spread) / abs(float(c)))
                    return [Root(place, "?", 2 * width, False)] * 2
                return []
            if square == 0:
                place = float(-b / (2 * c))
                width = math.sqrt((noise * self.size(place) + spread) / abs(float(c)))
                return [Root(place, "?", 2 * width, False)] * 2
            root = decimal(square).sqrt()
            q = -(decimal(b) + (root if b >= 0 else -root)) / 2
            times = sorted(t for t in (q / decimal(c), decimal(a) / q if q != 0 else Decimal(0)))
        found = []
        for t in times:
            s = float(t)
            slope = float(decimal(b) + 2 * decimal(c) * t)
            width = noise * self.size(s) + spread
            doubt = width / abs(slope) if slope else math.inf
            certain = True
            if c != 0 and len(times) == 2:
                depth = abs(float(a - b * b / (4 * c)))
                certain = depth > 4 * (noise * self.size(float(-b / (2 * c))) + spread)
                if not certain:
                    doubt = max(doubt, 2 * math.sqrt(width / abs(float(c))))
            found.append(Root(s, "rising" if slope > 0 else "falling", doubt, certain))
        return found


@dataclass
class Oscillation:
    """c + x cos(w s) + (v / w) sin(w s)."""

    c: float
    x: float
    v: float
    w: Decimal
    terms: float

    def shifted(self, by: float) -> "Oscillation":
        return Oscillation(self.c - by, self.x, self.v, self.w, self.terms + abs(by))

    def roots(self, until: float, noise: float, spread: float) -> list[Root]:
        w = float(self.w)
        amplitude = math.hypot(self.x, self.v / w)
        width = noise * (self.terms + amplitude) + spread
        level = -self.c / amplitude
        if abs(level) > 1 + 4 * width / amplitude:
            return []
        certain = abs(abs(level) - 1) > 8 * width / amplitude
        turn = math.acos(max(-1.0, min(1.0, level)))
        phase = math.atan2(self.v / w, self.x)
        slope = max(amplitude * w * math.sin(turn), math.sqrt(2 * width * amplitude) * w)
        found = []
        for n in range(-2, int(w * until / (2 * math.pi)) + 3):
            for sign in (-1, 1):
                # in the decimals of a long time
                s = float((Decimal(phase + sign * turn) + 2 * PI * n) / self.w)
                doubt = width / slope + 8 * EPSILON * (2 + abs(w * s)) / w
                if certain:
                    found.append(Root(s, "rising" if sign < 0 else "falling", doubt))
                else:
                    found.append(Root(s, "?", 4 * doubt, False))
        return sorted(found, key=lambda r: r.time)


@dataclass
class Decay:
    """c + x exp(-rate s)."""

    c: float
    x: float
    rate: float
    terms: float

    def shifted(self, by: float) -> "Decay":
        return Decay(self.c - by, self.x, self.rate, self.terms + abs(by))

    def roots(self, until: float, noise: float, spread: float) -> list[Root]:
        if self.x == 0 or self.c == 0 or (self.x > 0) == (self.c > 0):
            return []
        ratio = decimal(-self.x) / decimal(self.c)
        s = float(ratio.ln() / decimal(self.rate))
        slope = abs(self.c) * self.rate
        width = noise * (self.terms + abs(self.x)) + spread
        certain = abs(self.c) > 8 * width
        return [Root(s, "falling" if self.x > 0 else "rising", width / slope, certain)]


# --- what is watched of such a function ---------------------------------------------------------------------------


def opposite(direction: str) -> str:
    return {"rising": "falling", "falling": "rising"}.get(direction, direction)


def merged(*lists: list[Root]) -> list[Root]:
    """Of a product: the direction of each root by the number of those before it is set by the caller."""
    return sorted((r for roots in lists for r in roots), key=lambda r: r.time)


@dataclass
class Watch:
    name: str
    of: object  # of the present moment
    roots: list[Root]
    direction: str = "either"
    action: str = "record"


@dataclass
class Motion:
    scene: object
    functions: list  # (what it is of the present moment, its function of time, the extent of it)
    exact: bool  # a polynomial of low degree
    time: float  # its own [s]; infinite if none
    until: float
    start: float
    label: str
    engines: list = field(default_factory=lambda: ["auto"])


def log_uniform(r: random.Random, low: float, high: float) -> float:
    return 10 ** r.uniform(math.log10(low), math.log10(high))


def number(r: random.Random) -> float:
    """Of every kind: whole, dyadic, with all digits."""
    return r.choice([float(r.randint(-4, 4)), r.randint(-64, 64) / 16, r.uniform(-3, 3), r.gauss(0, 1)])


def start_for(r: random.Random, until: float) -> float:
    return r.choice([0.0, 0.0, 0.0, until * r.randint(-8, 8), until * r.uniform(-100, 100)])


def free_fall(r: random.Random) -> Motion:
    length, time = 10.0 ** r.randint(-6, 6), 10.0 ** r.randint(-4, 4)
    gravity = [0.0, 0.0, r.choice([0.0, -9.81, -1.0, number(r)]) * length / time**2]
    scene = rb.Scene(gravity=gravity if any(gravity) else None)
    x = [number(r) * length for _ in range(3)]
    v = [number(r) * length / time for _ in range(3)]
    ball = scene.add(rb.Particle(10.0 ** r.randint(-3, 3)), position=x, velocity=v)
    functions = []
    for i in range(3):
        half = Fraction(gravity[i]) / 2
        if v[i] or half:
            place = Quadratic(Fraction(x[i]), Fraction(v[i]), half, abs(x[i]))
            functions.append((lambda now, i=i: now[ball].position[i], place, length))
        if half:
            speed = Quadratic(Fraction(v[i]), 2 * half, Fraction(0), abs(v[i]))
            functions.append((lambda now, i=i: now[ball].velocity[i], speed, length / time))
    if any(v) and not any(gravity):
        # the square of the distance from the origin
        exact = [Fraction(c) for c in x], [Fraction(c) for c in v]
        square = Quadratic(
            sum(c * c for c in exact[0]),
            2 * sum(c * d for c, d in zip(*exact, strict=True)),
            sum(c * c for c in exact[1]),
            2 * sum(c * c for c in x),
        )
        functions.append((lambda now: now[ball].position @ now[ball].position, square, length**2))
    until = log_uniform(r, 1e-9, 1e9)
    engines = ["auto", "auto", "taylor", "dop853"]
    return Motion(scene, functions, True, math.inf, until, start_for(r, until), "free fall", engines)


def oscillator(r: random.Random) -> Motion:
    length, time = 10.0 ** r.randint(-6, 6), 10.0 ** r.randint(-6, 6)
    mass = 10.0 ** r.randint(-3, 3)
    stiffness = mass / time**2 * r.choice([1.0, 2.0, r.uniform(0.3, 3)])
    scene = rb.Scene()
    x, v = number(r) * length, number(r) * length / time
    if x == 0 and v == 0:
        x = length
    ball = scene.add(rb.Particle(mass), position=[x, 0, 0], velocity=[v, 0, 0])
    scene.connect(rb.Spring(stiffness), ball, [0, 0, 0])
    w = (decimal(stiffness) / decimal(mass)).sqrt()
    size = math.hypot(x, v / float(w))
    functions = [
        (lambda now: now[ball].position[0], Oscillation(0.0, x, v, w, abs(x)), size),
        (
            lambda now: now[ball].velocity[0],
            Oscillation(0.0, v, -x * float(w) ** 2, w, abs(v)),
            size * float(w),
        ),
    ]
    until = min(log_uniform(r, 1e-9, 1e9), r.choice([1e1, 1e2, 1e3]) / float(w))
    engines = ["auto", "auto", "taylor", "dop853", "cvode-adams"]
    return Motion(scene, functions, False, 1 / float(w), until, start_for(r, until), "oscillator", engines)


def drag(r: random.Random) -> Motion:
    length, time = 10.0 ** r.randint(-6, 6), 10.0 ** r.randint(-6, 6)
    mass = 10.0 ** r.randint(-3, 3)
    linear = mass / time * r.choice([1.0, r.uniform(0.3, 3)])
    scene = rb.Scene()
    x, v = number(r) * length, (number(r) or 1.0) * length / time
    ball = scene.add(rb.Particle(mass), position=[x, 0, 0], velocity=[v, 0, 0])
    scene.apply(rb.Drag(linear=linear), ball)
    rate = linear / mass
    way = v / rate
    functions = [
        (lambda now: now[ball].position[0], Decay(x + way, -way, rate, abs(x) + abs(way)), abs(way)),
        (lambda now: now[ball].velocity[0], Decay(0.0, v, rate, abs(v)), abs(v)),
    ]
    until = min(log_uniform(r, 1e-9, 1e9), r.choice([1.0, 5.0, 20.0]) / rate)
    engines = ["auto", "taylor", "dop853", "cvode-bdf"]
    return Motion(scene, functions, False, 1 / rate, until, start_for(r, until), "drag", engines)


def turning(r: random.Random) -> Motion:
    """A bead at constant speed round a circle."""
    length, time = 10.0 ** r.randint(-6, 6), 10.0 ** r.randint(-6, 6)
    radius, speed = length * r.choice([1.0, r.uniform(0.3, 3)]), (number(r) or 1.0) * length / time
    scene = rb.Scene()
    rail = rb.Rail(rb.Circle(radius=radius, start=[1, 0, 0], toward=[0, 1, 0]))
    bead = scene.add(rb.Particle(1.0), rail, parameter=0.0, speed=speed)
    w = abs(decimal(speed)) / decimal(radius)
    functions = [
        (lambda now: now[bead].position[0], Oscillation(0.0, radius, 0.0, w, radius), radius),
        (
            lambda now: now[bead].position[1],
            Oscillation(0.0, 0.0, math.copysign(float(w) * radius, speed), w, 0.0),
            radius,
        ),
        (
            lambda now: now[bead].parameter,
            Quadratic(Fraction(0), Fraction(speed) / Fraction(radius), Fraction(0), 0.0),
            1.0,
        ),
    ]
    until = min(log_uniform(r, 1e-9, 1e9), r.choice([1e1, 1e2, 1e3]) / float(w))
    return Motion(
        scene, functions, False, 1 / float(w), until, start_for(r, until), "turning", ["auto", "taylor", "dop853"]
    )


MOTIONS = [free_fall, free_fall, oscillator, drag, turning]


def level_for(r: random.Random, function, motion: Motion, extent: float) -> float:
    """Of every kind: passed soon after the start, at the very end, somewhere, never; or no offset."""
    s = motion.until * r.choice([1.0, r.random(), 10.0 ** -r.uniform(1, 16), 10.0 ** -r.uniform(1, 6)])
    if isinstance(function, Quadratic):
        exact = function.a + function.b * Fraction(s) + function.c * Fraction(s) ** 2
    elif isinstance(function, Oscillation):
        w = float(function.w)
        exact = function.c + function.x * math.cos(w * s) + function.v / w * math.sin(w * s)
    else:
        exact = function.c + function.x * math.exp(-function.rate * s)
    return r.choice([0.0, float(exact), float(exact), float(exact), number(r) * extent])


def watches_for(r: random.Random, motion: Motion, noise: float, accuracy: float) -> list[Watch]:
    watches = []
    for k in range(r.randint(1, 4)):
        of, function, extent = r.choice(motion.functions)
        level = level_for(r, function, motion, extent)
        spread = accuracy * extent
        until = motion.until
        single = function.shifted(level)
        roots = single.roots(until, noise, spread)
        kind = r.choice(["plain", "plain", "plain", "scaled", "power", "square", "abs", "product", "called back"])
        if kind == "plain":

            def asked(now, of=of, c=level):
                return of(now) - c
        elif kind == "scaled":
            factor = r.choice([-1.0, 2.0**-20, 3.0, -7e9])

            def asked(now, of=of, c=level, f=factor):
                return f * (of(now) - c)

            if factor < 0:
                roots = [Root(x.time, opposite(x.direction), x.doubt, x.certain) for x in roots]
        elif kind == "power":
            power = r.choice([3, 5, 7])

            def asked(now, of=of, c=level, p=power, e=extent):
                return ((of(now) - c) / e) ** p

            # all of a power is rounding in an interval as wide as its root
            wide = (64 * noise + accuracy) ** (1 / power) if not motion.exact else (64 * noise) ** (1 / power)
            wider = single.roots(until, noise, spread + wide * extent)
            roots = (
                [
                    Root(x.time, x.direction if y.certain else "?", y.doubt, y.certain)
                    for x, y in zip(roots, wider, strict=False)
                ]
                if len(roots) == len(wider)
                else [Root(y.time, "?", y.doubt, False) for y in wider]
            )
        elif kind == "square":

            def asked(now, of=of, c=level, e=extent):
                return ((of(now) - c) / e) ** 2

            roots = []
        elif kind == "abs":

            def asked(now, of=of, c=level):
                return abs(of(now) - c)

            roots = []
        elif kind == "product":
            other = level_for(r, function, motion, extent)
            second = function.shifted(other)

            def asked(now, of=of, c=level, d=other):
                return (of(now) - c) * (of(now) - d)

            more = second.roots(until, noise, spread)
            roots = product_of(roots, more, single, second, abs(level - other), noise, spread)
        else:

            def asked(now, of=of, c=level):
                return float(of(now)) - c

            noise_here = max(noise, 1e-13)
            roots = single.roots(until, noise_here, spread)
        direction = r.choice(["either", "either", "either", "rising", "falling"])
        watches.append(Watch(f"{r.choice('abcdxyz')}{k} {kind}", asked, roots, direction))
    return watches


def product_of(first, second, f, g, apart, noise, spread):
    """Roots of f g, f and g of one motion; those of one that cannot be told from one of the other are open."""
    roots = []
    for mine, others in ((first, second), (second, first)):
        for x in mine:
            near = [y for y in others if abs(y.time - x.time) <= 8 * (x.doubt + y.doubt)]
            roots.append((x, bool(near)))
    roots.sort(key=lambda p: p[0].time)
    result = []
    for x, is_open in roots:
        result.append(Root(x.time, "?", 8 * x.doubt if is_open else x.doubt, x.certain and not is_open))
    return result


# --- what a run makes of it ---------------------------------------------------------------------------------------


@dataclass
class Count:
    scenes: int = 0
    expected: int = 0
    open: int = 0
    missed: int = 0
    false: int = 0
    doubled: int = 0
    misordered: int = 0
    refused: Counter = field(default_factory=Counter)
    examples: list = field(default_factory=list)

    @property
    def wrong(self) -> int:
        return self.missed + self.false + self.doubled + self.misordered


def judge(count: Count, motion: Motion, watches: list[Watch], run, slack: float, text: str) -> None:
    end = run.end - motion.start
    time_rounding = 8 * EPSILON * (abs(motion.start) + motion.until)
    previous = -math.inf
    for event in run.events:
        if event.time < previous or event.time > run.end or event.time < motion.start:
            count.misordered += 1
            count.examples.append((text, "misordered", event.name, event.time, run.end))
        previous = event.time
    for watch in watches:
        seen = [(e.time - motion.start, e.direction) for e in run.events if e.kind == "watch" and e.name == watch.name]
        roots = []
        for x in watch.roots:
            doubt = 4 * x.doubt + time_rounding + slack * abs(x.time)
            if x.time + doubt < 0 or x.time - doubt > end:
                continue
            wanted = watch.direction == "either" or x.direction in ("?", watch.direction)
            if not wanted:
                continue
            certain = x.certain and x.time > doubt and x.time <= end and end - x.time > -0.0
            # an event at the very end is one; nearer to it than can be told it is open
            if certain and x.time > end - doubt and x.time != motion.until:
                certain = False
            certain = certain and (x.direction != "?" or watch.direction == "either")
            roots.append([x, doubt, certain, False])
        for time, direction in seen:
            near = [p for p in roots if abs(p[0].time - time) <= p[1]]
            right = [p for p in near if p[0].direction in ("?", direction)]
            free = [p for p in right if not p[3]]
            if free:
                min(free, key=lambda p: abs(p[0].time - time))[3] = True
            elif near and not all(p[2] for p in near):
                pass
            elif near:
                count.doubled += 1
                count.examples.append((text, "doubled", watch.name, watch.direction, time, direction))
            else:
                count.false += 1
                count.examples.append((text, "false", watch.name, watch.direction, time, direction))
        for x, doubt, certain, found in roots:
            count.expected += certain
            count.open += not certain
            if certain and not found:
                count.missed += 1
                count.examples.append((text, "missed", watch.name, watch.direction, x, doubt))


def one(r: random.Random, count: Count) -> None:
    motion = r.choice(MOTIONS)(r)
    engine = r.choice(motion.engines)
    error = r.choice([1e-6, 1e-9, 1e-9, 1e-11]) if not engine.startswith("cvode") else 1e-6
    exact = motion.exact
    noise = 64 * EPSILON
    watches = watches_for(r, motion, noise, 0.0 if exact else 8 * error)
    r.shuffle(watches)
    stopping = r.random() < 0.2
    for k, watch in enumerate(watches):
        if stopping and k == 0:
            watch.action = "stop"
        motion.scene.watch(watch.name, watch.of, direction=watch.direction, action=watch.action)
    until = motion.start + motion.until
    motion.until = until - motion.start
    if not motion.until > 0:
        return
    keep = r.choice(["all", "all", "end", sorted(r.uniform(motion.start, until) for _ in range(3))])
    count.scenes += 1
    text = f"{motion.label}, {engine}, error {error:g}, from {motion.start!r} to {until!r}, keep {keep}"
    try:
        run = rb.simulate(motion.scene, until, start=motion.start, error=error, engine=engine, keep=keep)
    except (rb.AccuracyError, rb.IntegrationError, rb.InvalidInput) as e:
        count.refused[f"{motion.label}, {engine}: {type(e).__name__}"] += 1
        return
    if stopping and watches[0].roots and run.status != "stopped by event":
        pass  # a root that should have stopped it is missed, and is counted so
    judge(count, motion, watches, run, 0.0 if exact else 4 * error, text)


def tried(count: int, seed: int, show: bool = False) -> Count:
    result = Count()
    for k in range(count):
        r = random.Random(f"{seed} {k}")
        before = result.wrong
        one(r, result)
        if show and result.wrong > before and len(result.examples) < 400:
            for example in result.examples[-(result.wrong - before) :][:3]:
                print(k, *example, sep=" | ", flush=True)
    return result


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=20000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    np.seterr(all="ignore")
    c = tried(options.count, options.seed, show=True)
    print(
        f"{c.scenes} scenes, {c.expected} events expected, {c.open} left open: {c.missed} missed, {c.false} false, "
        f"{c.doubled} doubled, {c.misordered} out of order"
    )
    for what, times in sorted(c.refused.items()):
        print(f"  {times} refused: {what}")
    return 1 if c.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
