"""States of rest of random scenes against what is known of them: python tests/random/equilibria.py [scenes] [seed].

Potentials with a minimum, a maximum or an inflection of known order at a known place, of any scale; forces with known
zeros of known orders, their signs in exact fractions; rods on torsion springs as near to their critical stiffness as
1e-10, and under torques that go up and down up to sixty times a turn; valleys of two freedoms, bent, at whose floor the
potential goes as a power. Prints what is missed, false, or judged wrongly; exits with their number.
"""

import math
import sys
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


def wrong(kind, random):
    if kind is valley:
        return valley(random)
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


KINDS = [one_power, wells, marginal, upright_rod, valley, ripples]


def main(scenes=2000, seed=1):
    random = np.random.default_rng(seed)
    faults = {kind.__name__: 0 for kind in KINDS}
    for k in range(scenes):
        kind = KINDS[k % len(KINDS)]
        fault = wrong(kind, random)
        if fault is not None:
            faults[kind.__name__] += 1
            print(kind.__name__, fault)
    print(f"{scenes} scenes, seed {seed}; wrong: {faults}")
    return sum(faults.values())


if __name__ == "__main__":
    sys.exit(min(main(*map(int, sys.argv[1:])), 255))
