"""Contacts and trees that begin exactly on their guards: in other units, in a mirror, and until 1e-15 to 1e15 seconds.

python tests/random/contact_starts.py [--scenes 200] [--seed 1] [--kinds ball,box,...] [--only NUMBER]

Each scene begins where something is zero: a gap, a slip, a rate, a watched angle, a force at the edge of its cone. It
is run for two seconds, and again

    two      with lengths, times and masses in units of 2^-100 to 2^100 (1e-30 to 1e30),
    ten      with those in units of 1e-30 to 1e30,
    mirror   with left and right exchanged,
    span     until 1e-15 to 1e15 seconds.

The truth is symmetry: the same events and places, up to the error that was asked for; and what a longer run was on the
way to its end is what a shorter one is there. Printed are, by kind of scene and by way, how many agree, to the bit or
not, in how many both or one alone were refused or told that they are not certain, and of what is wrong the first. The
exit code is the number of wrong ones, 255 at most.
"""

import argparse
import collections
import math
import signal
import sys
import time
from dataclasses import dataclass

import numpy as np
import rbdyn as rb

UNTIL, ERROR = 2.0, 1e-9
G = 9.8125
WAYS = ("two", "ten", "mirror", "span")


@dataclass(frozen=True)
class Telling:
    """How a scene is told: so many of its units in a metre, a second and a kilogram, and in a mirror or not."""

    length: float = 1.0
    time: float = 1.0
    mass: float = 1.0
    side: float = 1.0  # -1: left is right

    def place(self, x, y):
        return [self.side * x * self.length, y * self.length]

    def point(self, x, y):
        return [*self.place(x, y), 0.0]

    def velocity(self, x, y):
        return [self.side * x * self.length / self.time, y * self.length / self.time]

    def angle(self, a):
        return self.side * a

    def rate(self, a):
        return self.side * a / self.time

    def body(self, mass, moment, com=(0.0, 0.0)):
        moment = moment * self.mass * self.length**2
        return rb.RigidBody(mass * self.mass, [moment / 2, moment / 2, moment], com=self.point(*com))

    def scene(self, slope=0.0):
        g = G * self.length / self.time**2
        return rb.Scene(gravity=[self.side * g * math.sin(slope), -g * math.cos(slope), 0])


def few_bits(random, low, high):
    """A multiple of 1/64: sums of such are exact."""
    return float(random.integers(round(64 * low), round(64 * high) + 1)) / 64


def law(random):
    friction = random.choice(["none", "rough", "rough", "edge"])
    return {"restitution": float(random.choice([0.0, 0.0, 0.5, 0.75, 1.0])), "mu": friction}


def touch(scene, a, b, restitution, mu, slope):
    # at the edge of the cone: as much as the slope asks for
    mu = {"none": 0.0, "rough": 0.375, "edge": math.tan(slope)}[mu]
    scene.contact(a, b, restitution=restitution, friction=rb.Coulomb(mu) if mu > 0 else None)


def flat(scene, tell, body, x, y, angle=0.0, velocity=(0.0, 0.0), rate=0.0):
    return scene.add(
        body,
        rb.Planar([1, 0, 0], [0, 1, 0]),
        position=tell.place(x, y),
        angle=tell.angle(angle),
        velocity=tell.velocity(*velocity),
        rate=tell.rate(rate),
    )


def ball(random):
    """On the floor: at rest, rolling, sliding, thrown up or down; the floor may lean."""
    r, slope = few_bits(random, 0.25, 1), float(random.choice([0.0, 0.0, 0.25]))
    up = float(random.choice([0.0, 0.0, 1.0, -1.0])) * few_bits(random, 0.25, 2)
    across = float(random.choice([0.0, 1.0, -1.0]))
    spin = float(random.choice([0.0, -across / r, 2.0]))
    rule = law(random)

    def build(tell):
        scene = tell.scene(slope)
        one = flat(scene, tell, tell.body(2.0, 2.0 * r * r * 0.375), 0.0, r, 0.0, (across, up), spin)
        touch(scene, one.sphere(r * tell.length), rb.Plane([0, 1, 0]), slope=slope, **rule)
        return scene, [one]

    return build, rule["restitution"]


def box(random):
    """Two feet on the floor: at rest, sliding, tipping, at rest where it just slides."""
    b, h = few_bits(random, 0.25, 1), few_bits(random, 0.25, 1)
    slope = float(random.choice([0.0, 0.0, 0.25]))
    across = float(random.choice([0.0, 0.0, 1.0, -1.0]))
    tips = float(random.choice([0.0, 0.0, 0.25, -0.25]))
    up = abs(tips) * b
    rule = law(random)

    def build(tell):
        scene = tell.scene(slope)
        # tipping about one foot: that has no velocity along the floor's normal
        one = flat(scene, tell, tell.body(2.0, 2.0 * (b * b + h * h) / 3), 0.0, h, 0.0, (across, up), tips)
        for foot in (-b, b):
            touch(scene, one.point(tell.point(foot, -h)), rb.Plane([0, 1, 0]), slope=slope, **rule)
        return scene, [one]

    return build, rule["restitution"]


def balls(random):
    """Two or three in a row that touch, in free space or on the floor."""
    count, heavy = int(random.integers(2, 4)), bool(random.integers(2))
    r = few_bits(random, 0.25, 0.5)
    masses = [few_bits(random, 0.5, 2) for _ in range(count)]
    speeds = [float(random.choice([0.0, 0.0, 1.0, -1.0])) * few_bits(random, 0.25, 2) for _ in range(count)]
    rule, between = law(random), law(random)

    def build(tell):
        scene = tell.scene() if heavy else rb.Scene()
        allengthof_them = [
            flat(scene, tell, tell.body(m, m * r * r * 0.375), 2 * r * k, r, 0.0, (v, 0.0))
            for k, (m, v) in enumerate(zip(masses, speeds, strict=True))
        ]
        for a, b in zip(allengthof_them, allengthof_them[1:], strict=False):
            touch(scene, a.sphere(r * tell.length), b.sphere(r * tell.length), slope=0.0, **between)
        for one in allengthof_them if heavy else []:
            touch(scene, one.sphere(r * tell.length), rb.Plane([0, 1, 0]), slope=0.0, **rule)
        return scene, allengthof_them

    return build, max(rule["restitution"] if heavy else 0.0, between["restitution"])


def pendulum(random):
    """One or two bars, watched angles that are zero at the start, and a stop that the tip begins at."""
    count = int(random.integers(1, 3))
    lengths = [few_bits(random, 0.5, 1) for _ in range(count)]
    rates = [float(random.choice([0.0, 1.0, -1.0])) * few_bits(random, 0.25, 2) for _ in range(count)]
    stop, rule = bool(random.integers(2)), law(random)
    spring = bool(random.integers(2))

    def build(tell):
        scene = tell.scene()
        bars, parent = [], None
        for k, (length, w) in enumerate(zip(lengths, rates, strict=True)):
            at = [0, 0, 0] if parent is None else tell.point(0.0, -lengths[k - 1])
            joint = rb.Revolute([0, 0, 1], at=at)
            more = {} if parent is None else {"parent": parent}
            parent = scene.add(
                tell.body(1.0, length * length / 12, (0.0, -length / 2)), joint, angle=0.0, rate=tell.rate(w), **more
            )
            bars.append(parent)
            scene.watch(f"down {k}", lambda now, bar=parent: now[bar].angle)
        if spring:
            scene.apply(rb.TorsionSpring(2.0 * tell.mass * tell.length**2 / tell.time**2), bars[0])
        if stop:
            tip = bars[-1].point(tell.point(0.0, -lengths[-1]))
            touch(scene, tip, rb.Plane([tell.side, 0, 0]), slope=0.0, **rule)
        return scene, bars

    return build, rule["restitution"] if stop else 0.0


def cart(random):
    """A slide with a ball or a bar on it, a wall that it touches, and a spring that is loose at the start."""
    speed = float(random.choice([0.0, 1.0, -1.0]))
    rate = float(random.choice([0.0, 1.0, -1.0]))
    stiff = few_bits(random, 1, 20)
    walls, rule = bool(random.integers(2)), law(random)
    length = few_bits(random, 0.5, 1)

    def build(tell):
        scene = tell.scene()
        base = scene.add(
            tell.body(2.0, 1.0), rb.Prismatic([tell.side, 0, 0]), displacement=0.0, rate=speed * tell.length / tell.time
        )
        bar_itself = tell.body(1.0, length * length / 12, (0.0, -length / 2))
        bar = scene.add(bar_itself, rb.Revolute([0, 0, 1]), angle=0.0, rate=tell.rate(rate), parent=base)
        spring = rb.Spring(stiff * tell.mass / tell.time**2, rest_length=tell.length)
        scene.connect(spring, base, tell.point(-1.0, 0.0))
        scene.watch("middle", lambda now: now[base].displacement / tell.length)
        scene.watch("down", lambda now: now[bar].angle)
        if walls:
            touch(scene, base.point([0, 0, 0]), rb.Plane([-tell.side, 0, 0]), slope=0.0, **rule)
        return scene, [base, bar]

    return build, rule["restitution"] if walls else 0.0


KINDS = {kind.__name__: kind for kind in (ball, box, balls, pendulum, cart)}


@dataclass
class Outcome:
    """A run told in plain units: its events, and places at instants; or why there is none."""

    why: str = ""
    certain: float = math.inf
    end: float = 0.0
    events: tuple = ()
    run: object = None
    bodies: tuple = ()
    tell: Telling = Telling()
    until: float = UNTIL
    seconds: float = 0.0

    def places(self, t):
        here = min(t * self.tell.time, self.run.end)
        found = []
        for body in self.bodies:
            x, y, _ = self.run[body].position(here)
            found += [self.tell.side * x / self.tell.length, y / self.tell.length]
            r = self.run[body].rotation_matrix(here)
            found += [r[0, 0], self.tell.side * r[1, 0]]
        return np.array(found)


def run(build, tell, until, limit):
    begun = time.process_time()
    outcome = Outcome(tell=tell, until=until)

    def too_long(*_):
        raise KeyboardInterrupt

    # of the processor
    signal.signal(signal.SIGVTALRM, too_long)
    try:
        scene, outcome.bodies = build(tell)
        signal.setitimer(signal.ITIMER_VIRTUAL, limit)
        outcome.run = rb.simulate(scene, until * tell.time, error=ERROR, max_steps=4000)
    except (rb.AccuracyError, rb.IntegrationError) as told:
        outcome.why, outcome.run = f"{type(told).__name__}: {told}", told.run
        outcome.certain = told.run.certain_until / tell.time if isinstance(told, rb.AccuracyError) else math.inf
    except rb.InvalidInput as refused:
        outcome.why = f"InvalidInput: {refused}"
    except KeyboardInterrupt:
        outcome.why = "no end"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    outcome.seconds = time.process_time() - begun
    if outcome.run is not None:
        outcome.end = min(outcome.run.end / tell.time, outcome.certain)
        outcome.events = tuple((e.kind, e.name, e.time / tell.time) for e in outcome.run.events)
        if not outcome.why and outcome.run.status != "reached end":
            outcome.why = f"status: {outcome.run.status}"
    return outcome


def compared(a, b, until):
    """What two outcomes say of the same motion until then: "same bits", "same", or what differs."""
    if a.run is None or b.run is None:
        return "both refused" if a.run is None and b.run is None else f"one refused: {a.why or b.why}"
    if bool(a.why) != bool(b.why):
        return f"one told: {a.why or b.why}"
    shared = min(until, a.end, b.end)
    slack = 4 * ERROR
    # times are as good as their run is long
    late = slack * max(1.0, shared, a.until, b.until)
    clear = shared - late
    # how many bounces there are where they end is rounding
    ends = [e[2] for o in (a, b) for e in o.events if e[0] == "accumulation"]

    def is_told(e):
        return e[2] <= clear and (e[0] != "impact" or all(abs(e[2] - end) > late for end in ends))

    ea, eb = ([e for e in o.events if is_told(e)] for o in (a, b))
    if collections.Counter(x[:2] for x in ea) != collections.Counter(x[:2] for x in eb):
        extra = collections.Counter(x[:2] for x in ea)
        extra.subtract(collections.Counter(x[:2] for x in eb))
        return f"events: {[(k, n) for k, n in extra.items() if n]}"
    for name in {x[:2] for x in ea}:
        ta, tb = (np.array([x[2] for x in e if x[:2] == name]) for e in (ea, eb))
        off = np.abs(np.sort(ta) - np.sort(tb)).max()
        if off > late:
            return f"times of {name}: {off:.1e}"
    bits = ea == eb
    # places are as good as their run goes far
    extent = max(1.0, *(np.abs(o.places(o.run.end / o.tell.time)).max() for o in (a, b)))
    for t in np.linspace(0, 1, 7) * shared:
        pa, pb = a.places(t), b.places(t)
        if not np.isfinite(pa).all() or not np.isfinite(pb).all():
            return f"not a number at {t}"
        size = max(extent, np.abs(pa).max())
        if np.abs(pa - pb).max() > slack * size:
            return f"places at {t:.3g}: {np.abs(pa - pb).max():.1e}"
        bits = bits and np.array_equal(pa, pb)
    if a.why:
        return "both told"
    return "same bits" if bits else "same"


def tellings(random):
    exponents = random.integers(-100, 101, 3)
    tens = random.integers(-30, 31, 3)
    return {
        "two": Telling(*(2.0 ** float(k) for k in exponents)),
        "ten": Telling(*(10.0 ** float(k) for k in tens)),
        "mirror": Telling(side=-1.0),
    }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--limit", type=int, default=20)
    parser.add_argument("--only", type=int, default=-1)
    asked = parser.parse_args()
    wrong = 0
    for name in asked.kinds.split(","):
        tally = {way: collections.Counter() for way in WAYS}
        shown = collections.Counter()
        for k in range(asked.scenes) if asked.only < 0 else [asked.only]:
            random = np.random.default_rng([asked.seed, k, sorted(KINDS).index(name)])
            build, restitution = KINDS[name](random)
            plain = run(build, Telling(), UNTIL, asked.limit)
            others = {way: (run(build, tell, UNTIL, asked.limit), UNTIL) for way, tell in tellings(random).items()}
            # what bounces without loss does so for ever
            last = 15 if restitution < 1.0 else 1
            span = 10.0 ** float(random.integers(-15, last + 1)) * random.uniform(1, 9)
            others["span"] = (run(build, Telling(), span, asked.limit), min(UNTIL, span))
            # in such units balls that touch do so but for rounding, and which strike first is another motion; so it is
            # of what rocks without loss, thousands of times a second
            rocks = name == "box" and restitution == 1.0
            if name == "balls" or rocks:
                del others["ten"]
            if rocks:
                del others["span"]
            for way, (other, until) in others.items():
                verdict = compared(plain, other, until)
                kind = verdict.split(":")[0]
                tally[way][kind] += 1
                is_wrong = kind.startswith(("events", "times", "places", "not a number"))
                wrong += is_wrong or other.why == "no end"
                if (is_wrong or kind in ("one told", "one refused")) and shown[way, kind] < 6:
                    shown[way, kind] += 1
                    print(f"  {name} {k} {way} {other.tell if way != 'span' else span}: {verdict[:300]}", flush=True)
        for way in WAYS:
            print(f"{name:9} {way:7} " + ", ".join(f"{n} {what}" for what, n in tally[way].most_common()), flush=True)
    print(f"wrong: {wrong}")
    return min(wrong, 255)


if __name__ == "__main__":
    sys.exit(main())
