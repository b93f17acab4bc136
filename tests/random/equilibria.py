"""States of rest of random scenes against what is known of them: python tests/random/equilibria.py [scenes] [seed].

Potentials with a minimum, a maximum or an inflection of known order at a known place, of any scale; forces with known
zeros of known orders, their signs in exact fractions; rods on torsion springs as near to their critical stiffness as
1e-10, and under torques that go up and down up to sixty times a turn, or 5000 times, from any start; valleys of two
freedoms and more, bent, turned and moved, at whose floor the potential goes as a power, met from beside; an arm at its
critical load. Prints what is missed, false, or judged wrongly; exits with their number.
"""

import math
import sys
from collections import Counter
from fractions import Fraction

import numpy as np
import rbdyn as rb


def bead_under(potential, start):
    scene = rb.Scene()
    bead = scene.add(rb.Particle(mass=2.0), rb.Rail(rb.Line([1, 0, 0])), parameter=start)
    scene.apply(rb.Potential(lambda r: potential(r[0])), bead)
    return scene


def one_power(random):
    """U = s (x - a)^n: the field's sign, a maximum of U is stable."""
    order = int(random.integers(2, 13))
    sign, place = random.choice([-1.0, 1.0]), random.uniform(-2, 2)
    scale = sign * 2.0 ** random.uniform(-30, 30)
    scene = bead_under(lambda x: scale * (x - place) ** order, place + random.uniform(-3, 3))
    expected = [(place, order % 2 == 0 and sign < 0)]
    return f"{scale} (x - {place})^{order}", scene, expected, 1e-13


def wells(random):
    """F = -s prod (x - r_i)^m_i, zeros apart: stable where F changes from + to -."""
    count = int(random.integers(1, 5))
    roots = np.sort(random.uniform(-2, 2, count))
    if count > 1 and np.diff(roots).min() < 0.3:
        return wells(random)
    orders = random.integers(1, 4, count)
    scale = random.choice([-1.0, 1.0]) * 2.0 ** random.uniform(-20, 20)

    def force(x):
        product = scale
        for root, order in zip(roots, orders, strict=True):
            product = product * (x - root) ** int(order)
        return product

    scene = rb.Scene()
    bead = scene.add(rb.Particle(mass=2.0), rb.Rail(rb.Line([1, 0, 0])), parameter=random.uniform(-3, 3))
    scene.apply(rb.Force(lambda t, r, v: [force(r[0]), 0.0 * r[0], 0.0 * r[0]]), bead)

    def sign_at(x):
        product = Fraction(scale)
        for root, order in zip(roots, orders, strict=True):
            product *= (Fraction(x) - Fraction(root)) ** int(order)
        return product > 0

    expected = []
    for root in roots:
        expected.append((root, sign_at(root - 0.01) and not sign_at(root + 0.01)))
    return f"{scale} prod (x - {roots.tolist()})^{orders.tolist()}", scene, expected, 1e-9


def marginal(random):
    """F = e (x - a) - (x - a)^3: one stable zero, or an unstable one between two stable ones."""
    e = random.choice([-1.0, 1.0]) * 10.0 ** random.uniform(-9, -1)
    place = random.choice([0.0, random.uniform(-1, 1)])
    scene = bead_under(lambda x: 0.5 * e * (x - place) ** 2 - 0.25 * (x - place) ** 4, place + random.uniform(-1, 1))
    expected = [(place, e < 0)]
    if e > 0:
        expected = [(place - math.sqrt(e), True), *expected, (place + math.sqrt(e), True)]
    return f"{e} (x - {place}) - (x - {place})^3", scene, expected, 3e-5 * math.sqrt(abs(e))


def upright_rod(random):
    """k psi = m g d sin psi, k = (1 + e) m g d, |e| from 1e-10 to 0.1."""
    e = random.choice([-1.0, 1.0]) * 10.0 ** random.uniform(-10, -1)
    length, mass = 2.0 ** random.integers(-8, 9, 2).astype(float)
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    rod = rb.shapes.rod(mass, length, along=[0, 0, 1]).shifted([0, 0, 0.5 * length])
    hinge = scene.add(rod, rb.Revolute([0, 1, 0]), angle=random.uniform(-1, 1))
    scene.apply(rb.TorsionSpring(stiffness=(1.0 + e) * mass * 9.8125 * 0.5 * length), hinge)
    expected = [(0.0, e > 0)]
    if e < 0:
        # sin psi / psi = 1 + e
        psi = math.sqrt(-6.0 * e) * (1.0 - 0.15 * e)
        expected = [(-psi, True), *expected, (psi, True)]
    slack = max(1e-15, abs(e) * math.sqrt(abs(e)), 5e-16 / math.sqrt(abs(e)))
    return f"rod of {mass} kg, {length} m at 1 + {e} of its critical stiffness", scene, expected, slack


def valley(random):
    """U = -(a (x - s y - t y^2)^2 + c y^m) of two slides: the field's sign, a minimum of -U if m is even and c > 0.

    Of a state that is found near the origin: certain only of the truth, and up to a fourth power certain of it where it
    is met exactly, and a minimum found from the start; rounding hides some higher ones.
    """
    power = int(random.integers(2, 9))
    stiff = 2.0 ** random.uniform(-10, 10)
    floor = random.choice([-1.0, 1.0]) * stiff * 10.0 ** random.uniform(-6, 1)
    shear, bend = random.uniform(-1, 1), random.uniform(-1, 1)
    start = random.choice([0.0, 1.0]) * random.uniform(-0.2, 0.2, 2)

    def made(x, y):
        scene = rb.Scene()
        one = scene.add(rb.RigidBody(2.0, [0.1] * 3), rb.Prismatic([1, 0, 0]), displacement=x)
        two = scene.add(rb.RigidBody(1.0, [0.1] * 3), rb.Prismatic([0, 1, 0]), parent=one, displacement=y)
        potential = rb.Potential(
            lambda r: -(stiff * (r[0] - shear * r[1] - bend * r[1] ** 2) ** 2 + floor * r[1] ** power)
        )
        scene.apply(potential, two)
        return scene

    stable = power % 2 == 0 and floor > 0.0
    text = f"{stiff} (x - {shear} y - {bend} y^2)^2 + {floor} y^{power} from {start}"
    found = [*rb.equilibria(made(*start)), *rb.equilibria(made(*start), near=[0, 0])]
    near = [state for state in found if np.abs(state.coordinates).max() < 1e-3]
    if len(near) < 1:
        return f"{text}: the origin is not found near itself"
    for state in near:
        if state.decided and state.stable != stable:
            return f"{text}: stable is {state.stable} at {state.coordinates}, and certain"
    if power > 4:
        return None
    if not near[-1].decided or np.abs(near[-1].coordinates).max() > 1e-12:
        return f"{text}: not decided where it is met exactly"
    if stable and len(near) < 2:
        return f"{text}: the minimum is not found from the start"
    return None


def bent_valley(random):
    """V = sum k_i (x_i - b_i y^2 - c_i y^3)^2 + e y^m in axes turned and moved, in units of 1e-20 to 1e20 m.

    It has one rest, a minimum if m is even and all k_i and e are positive. `near` is beside it by 1e-12 to 0.1 units,
    or is it. Of a particle, of slides on slides, or of a particle that another one follows on a spring.
    """
    kind = random.choice(["particle", "slides", "followed"])
    count = int(random.integers(2, 4))
    power = int(random.choice([2, 3, 4, 4, 5, 6, 6, 8]))
    unit = 10.0 ** random.choice([0.0, 0.0, random.uniform(-5, 5), random.uniform(-20, 20)])
    floor = random.choice([-1.0, 1.0, 1.0, 0.0 if power == 4 else 1.0]) * 10.0 ** random.uniform(-3, 1)
    stiff = 10.0 ** random.uniform(-1, 2, count - 1) * random.choice([1.0] * 9 + [-1.0], count - 1)
    bend = random.uniform(-2, 2, count - 1)
    third = random.choice([0.0, 1.0]) * random.uniform(-2, 2, count - 1)
    axes = np.linalg.qr(random.normal(size=(count, count)))[0] if random.random() < 0.8 else np.eye(count)
    place = random.normal(size=count) * unit * random.choice([0.0, 1.0, 1.0])
    beside = random.choice([0.0, 1.0, 1.0, 1.0]) * 10.0 ** random.uniform(-12, -1)
    near = place + beside * unit * random.uniform(-1, 1, count)

    def potential(r):
        turned = [sum(axes[i, j] * (r[j] - place[j]) for j in range(count)) / unit for i in range(count)]
        y = turned[-1]
        sides = zip(stiff, bend, third, turned[:-1], strict=True)
        return floor * y**power + sum(k * (x - b * y**2 - c * y**3) ** 2 for k, b, c, x in sides)

    scene = rb.Scene()
    if kind == "slides":
        body = scene.add(rb.RigidBody(1.0, [0.1] * 3), rb.Prismatic([1, 0, 0]))
        for axis in np.eye(3)[1:count]:
            body = scene.add(rb.RigidBody(0.5, [0.1] * 3), rb.Prismatic(axis), parent=body)
        scene.apply(rb.Potential(lambda r: -potential(r)), body)
    else:
        body = scene.add(rb.Particle(1.0))
        third_axis = 0.0 if count == 3 else 0.5
        scene.apply(rb.Potential(lambda r: -(potential(r) + third_axis * r[2] ** 2 / unit**2)), body)
        near = [*near, 0.0][:3]
        if kind == "followed":
            other = scene.add(rb.Particle(0.5))
            scene.connect(rb.Spring(3.0 / unit**2), body, other)
            near = [*near, *near]
    stable = bool(power % 2 == 0 and floor > 0.0 and stiff.min() > 0.0)
    text = (
        f"{kind} {floor} y^{power}, {stiff} (x - {bend} y^2 - {third} y^3)^2, unit {unit}, axes {axes.tolist()}, "
        f"about {place.tolist()} from {near}"
    )
    found = rb.equilibria(scene, near=near)
    tally[f"{kind} y^{power}"] += 1
    if not found:
        missed[f"{kind} y^{power}"] += 1
        return None
    (state,) = found
    if not state.decided:
        undecided[f"{kind} y^{power}"] += 1
        return None
    if state.stable != stable:
        return f"{text}: stable is {state.stable}, and certain"
    off = np.abs(state.coordinates[:count] - place).max() / (unit + np.abs(place).max())
    if floor != 0.0 and off > 1e-12:
        return f"{text}: decided {off} units from the rest"
    return None


def held_column(random):
    """An arm upright on a cart, its tip held to a line, its joint's spring at the critical load and a q^4/4 beside.

    U of the arm alone is m g L (cos q + q^2/2) + a q^4/4: it goes as (m g L/6 + a) q^4/4. The constants are rounded, so
    that the second derivative is zero within rounding only.
    """
    mass, length = random.uniform(0.5, 2.0, 2) if random.random() < 0.5 else 2.0 ** random.integers(-2, 3, 2)
    load = float(mass) * 9.8125 * float(length)
    fourth = random.choice([-1.0, 1.0]) * load * 10.0 ** random.uniform(-2, 1) - load / 6.0
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    cart = scene.add(rb.RigidBody(1.0, [0.1] * 3), rb.Prismatic([1, 0, 0]))
    arm = rb.RigidBody(float(mass), [0.01] * 3, com=[0, 0, float(length)])
    arm = scene.add(arm, rb.Revolute([0, 1, 0]), parent=cart)
    stiff = load * 10.0 ** random.uniform(-1, 3)
    scene.apply(rb.Potential(lambda r: -stiff * r[0] ** 2), arm, at=[0, 0, float(length)])
    scene.apply(rb.JointTorque(lambda t, q, w: -load * q - fourth * q**3), arm)
    beside = random.choice([0.0, 1.0, 1.0]) * 10.0 ** random.uniform(-12, -2)
    near = beside * random.uniform(-1, 1, 2)
    stable = bool(load / 6.0 + fourth > 0.0)
    text = f"arm of {mass} kg, {length} m, {fourth} q^4/4, tip held by {stiff} N/m, from {near}"
    tally["column"] += 1
    found = rb.equilibria(scene, near=near)
    if not found:
        missed["column"] += 1
        return None
    (state,) = found
    if not state.decided:
        undecided["column"] += 1
        return None
    if np.abs(state.coordinates).max() > 1e-3:
        return None  # what is rounded may have buckled
    if state.stable != stable:
        return f"{text}: stable is {state.stable} at {state.coordinates}, and certain"
    if np.abs(state.coordinates).max() > 1e-12 and math.log2(mass) % 1 == 0 == math.log2(length) % 1:
        return f"{text}: decided at {state.coordinates}"
    return None


tally, undecided, missed = Counter(), Counter(), Counter()


def wrong(kind, random):
    if kind in (valley, bent_valley, held_column):
        return kind(random)
    text, scene, expected, slack = kind(random)
    found = rb.equilibria(scene)
    if len(found) != len(expected):
        return f"{text}: {len(found)} found, {len(expected)} are there: {[float(f.coordinates[0]) for f in found]}"
    for state, (place, stable) in zip(found, expected, strict=True):
        if abs(state.coordinates[0] - place) > slack:
            return f"{text}: {state.coordinates[0]} instead of {place}"
        if not state.decided:
            return f"{text}: not decided at {place}"
        if state.stable != stable:
            return f"{text}: stable is {state.stable} at {place}"
    return None


def ripples(random):
    """A pendulum under a torque a sin(k q + p), k to 60, alone or with a torsion spring: where the moment changes sign
    on a grid of 1e-5 of a radian, found by halving. Scenes with two zeros within 1e-4 of each other are drawn anew."""
    wave, size, phase = int(random.integers(1, 61)), random.uniform(0.3, 3.0), random.uniform(0, 2 * math.pi)
    stiffness = random.choice([0.0, random.uniform(0.5, 3.0)])
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    rod = rb.shapes.rod(1.0, 1.0, along=[0, 0, 1])
    hinge = scene.add(rod, rb.Revolute([0, 1, 0], point=[0, 0, 0.5]), angle=random.uniform(-1, 1))
    scene.apply(rb.JointTorque(lambda t, q, rate: size * np.sin(wave * q + phase)), hinge)
    if stiffness > 0:
        scene.apply(rb.TorsionSpring(stiffness), hinge)

    def moment(q):
        return -0.5 * 9.8125 * np.sin(q) + size * np.sin(wave * q + phase) - stiffness * q

    reach = math.pi if stiffness == 0 else (5.0 + size) / stiffness
    q = np.linspace(-reach, reach, round(2e5 * reach)) + 1e-7
    changes = np.nonzero(np.diff(np.sign(moment(q))))[0]
    low, high = q[changes].copy(), q[changes + 1].copy()
    rises = moment(low) < 0
    for _ in range(60):
        middle = 0.5 * (low + high)
        is_below = (moment(middle) < 0) == rises
        low, high = np.where(is_below, middle, low), np.where(is_below, high, middle)
    if np.diff(low).size and np.diff(low).min() < 1e-4:
        return ripples(random)
    expected = [(place, not rise) for place, rise in zip(low, rises, strict=True)]
    return f"rod under {size} sin({wave} q + {phase}), spring {stiffness}", scene, expected, 1e-10


def quick_ripples(random):
    """A rod under a sin(k q + p) + b sin(m q + r) and its weight, k to 5000, |b| + weight less than a/2.

    Zeros are where the first has more than 0.866 of its slope, which outdoes those of the others: one a half wave,
    found by halving.
    """
    wave = int(round(10.0 ** random.uniform(1.3, 3.7)))
    slow = int(random.integers(1, max(2, wave // 4)))
    size, phase, other = 10.0 ** random.uniform(-2, 2), random.uniform(-3, 3), random.uniform(-3, 3)
    weight, small = random.uniform(0, 0.25, 2) * size * random.choice([0.0, 1e-4, 1.0], 2)
    scene = rb.Scene(gravity=[0, 0, -weight])
    body = rb.RigidBody(1.0, [1, 1, 1], com=[0, 0, -1.0])
    hinge = scene.add(body, rb.Revolute([0, 1, 0]), angle=random.uniform(-1, 1) * 10.0 ** random.uniform(-1, 2))
    scene.apply(
        rb.JointTorque(lambda t, q, rate: size * np.sin(wave * q + phase) + small * np.sin(slow * q + other)), hinge
    )

    def moment(q):
        return size * np.sin(wave * q + phase) + small * np.sin(slow * q + other) - weight * np.sin(q)

    # between the extrema of the first
    least = math.ceil((-wave * math.pi + phase) / math.pi - 0.5)
    extrema = (math.pi * (np.arange(least - 1, least + 2 * wave + 2) + 0.5) - phase) / wave
    low, high = extrema[:-1].copy(), extrema[1:].copy()
    falls = moment(low) > 0
    for _ in range(60):
        middle = 0.5 * (low + high)
        is_before = (moment(middle) > 0) == falls
        low, high = np.where(is_before, middle, low), np.where(is_before, high, middle)
    inside = (low > -math.pi) & (low <= math.pi)
    expected = list(zip(low[inside], falls[inside], strict=True))
    return (
        f"rod under {size} sin({wave} q + {phase}) + {small} sin({slow} q + {other}) - {weight} sin q",
        scene,
        expected,
        1e-10,
    )


KINDS = [one_power, wells, marginal, upright_rod, valley, bent_valley, bent_valley, held_column, ripples]
# slower
RARE = quick_ripples


def main(scenes=2000, seed=1):
    random = np.random.default_rng(seed)
    faults = {kind.__name__: 0 for kind in [*KINDS, RARE]}
    for k in range(scenes):
        kind = RARE if k % 40 == 39 else KINDS[k % len(KINDS)]
        fault = wrong(kind, random)
        if fault is not None:
            faults[kind.__name__] += 1
            print(kind.__name__, fault)
    for name in sorted(tally):
        print(f"{name}: {tally[name]}, not decided {undecided[name]}, none found {missed[name]}")
    print(f"{scenes} scenes, seed {seed}; wrong: {faults}")
    return sum(faults.values())


if __name__ == "__main__":
    sys.exit(min(main(*map(int, sys.argv[1:])), 255))
