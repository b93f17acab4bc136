"""States of rest of one coordinate under random forces with zeros in closed form: at and beside branch points, steps,
places where they touch zero: python tests/random/rests_at_branch_points.py [scenes of each kind] [seed] [kinds].

Products of powers, whole and broken, even and odd, of distances from known places; powers less a constant or a straight
line; steps as steep as 1e8; what touches zero; zeros of orders to 21; periodic torques; kinks; the same far from zero;
on slides, hinges and rails, in units of 1e-9 to 1e9 m, from any start, on the places themselves too. Prints what is
missed, false, misjudged, off or not decided.
"""

import collections
import math
import sys
import time

import numpy as np
import rbdyn as rb


def scene_of(kind, f, start, U):
    s = rb.Scene()
    if kind == "slide":
        b = s.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Prismatic([1, 0, 0]), displacement=start * U)
        s.apply(rb.JointForce(lambda t, q, w: f(q / U)), b)
    elif kind == "hinge":
        b = s.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Revolute([1, 0, 0]), angle=start)
        s.apply(rb.JointTorque(lambda t, q, w: f(q)), b)
    else:
        b = s.add(rb.Particle(1.0), rb.Rail(rb.Line([1, 0, 0])), parameter=start * U)
        s.apply(rb.Force(lambda t, r, v: [f(r[0] / U), 0 * r[0], 0 * r[0]]), b)
    return s


def factor(rng, a):
    k = rng.integers(6)
    if k == 0:
        p = int(rng.choice([1, 3, 5, 7, 9]))
        return (lambda x: (x - a) ** p), -1, f"(x-{a!r})**{p}"
    if k == 1:
        p = int(rng.choice([2, 4, 6]))
        return (lambda x: (x - a) ** p), 1, f"(x-{a!r})**{p}"
    if k == 2:
        p = float(rng.uniform(0.5, 9))
        return (lambda x: abs(x - a) ** p * np.sign(x - a)), -1, f"abs(x-{a!r})**{p!r}*sign(x-{a!r})"
    if k == 3:
        p = float(rng.uniform(0.5, 9))
        return (lambda x: abs(x - a) ** p), 1, f"abs(x-{a!r})**{p!r}"
    if k == 4:
        return (lambda x: np.cbrt(x - a)), -1, f"cbrt(x-{a!r})"
    p = float(rng.choice([0.5, 1.5, 2.5, 3.5]))
    if rng.random() < 0.5:
        return (lambda x: abs(x - a) ** p * np.sign(x - a)), -1, f"abs(x-{a!r})**{p}*sign"
    return (lambda x: abs(x - a) ** p), 1, f"abs(x-{a!r})**{p}"


POS = [
    (lambda x: 1.0, "1"),
    (lambda x: np.exp(0.3 * x), "exp(.3x)"),
    (lambda x: 2 + np.sin(x), "2+sin x"),
    (lambda x: 1 / (1 + x * x), "1/(1+x^2)"),
    (lambda x: 1.5 + np.tanh(3 * x), "1.5+tanh 3x"),
]


def nice(rng):
    return float(rng.choice([0.0, 1.0, -1.0, 0.5])) if rng.random() < 0.4 else float(rng.uniform(-2, 2))


def products(rng):
    n = int(rng.integers(1, 4))
    while True:
        A = sorted(nice(rng) for _ in range(n))
        if all(b - a > 0.3 for a, b in zip(A, A[1:], strict=False)):
            break
    F = [factor(rng, a) for a in A]
    s = float(rng.choice([-1, 1]) * 10 ** rng.uniform(-3, 3))
    g, gn = POS[rng.integers(len(POS))]

    def f(x):
        y = s * g(x)
        for h, _, _ in F:
            y = y * h(x)
        return y

    sign = math.copysign(1, s)
    truth = []
    for _, c, _ in F:
        sign *= c  # sign at -inf
    for a, (_, c, _) in zip(A, F, strict=False):
        after = sign * c
        truth.append((a, sign > 0 > after))
        sign = after
    return f, truth, f"{s}*{gn}*" + "*".join(n for _, _, n in F)


def wells(rng):
    a = nice(rng)
    p = float(rng.choice([0.5, 1.5, 2.5])) if rng.random() < 0.5 else float(rng.uniform(0.5, 9))
    c = 10 ** rng.uniform(-4, 0)
    s = float(rng.choice([-1, 1]))
    r = c ** (1 / p)
    return (lambda x: s * (c - abs(x - a) ** p)), [(a - r, s < 0), (a + r, s > 0)], f"{s}*({c!r}-abs(x-{a!r})**{p!r})"


def roots(rng):
    a = nice(rng)
    p = float(rng.choice([0.5, 1 / 3, 1.5, 2.5, 0.7]))
    s = float(rng.choice([-1, 1]))
    k = 10 ** rng.uniform(-1, 1)
    # s (|y|^p - k y), zeros 0 and k^(1/(p-1))
    r = k ** (1 / (p - 1))
    t = [(a, False), (a + r, (s > 0) == (p < 1))]
    if p < 1:
        pass  # |y|^p dominates at 0: touches
    else:
        t[0] = (a, s > 0)  # -k y at 0
    return (lambda x: s * (abs(x - a) ** p - k * (x - a))), t, f"{s}*(|y|**{p}-{k!r}*y), y=x-{a!r}"


def steps(rng):
    a = float(rng.uniform(-1, 1))
    k = 10 ** rng.uniform(1, 8)
    b = float(rng.uniform(0.1, 1))
    s = float(rng.choice([-1, 1]))
    x = 1 / b
    for _ in range(200):
        x = math.tanh(k * x) / b
    return (
        (lambda q: s * (np.tanh(k * (q - a)) - b * (q - a))),
        [(a - x, s > 0), (a, s < 0), (a + x, s > 0)],
        f"{s}*(tanh({k!r}y)-{b!r}y), y=x-{a!r}",
    )


def touches(rng):
    a = nice(rng)
    s = float(rng.choice([-1, 1]))
    k = rng.integers(5)
    if k == 0:
        return (lambda q: s * (np.exp(q - a) - 1 - (q - a))), [(a, False)], f"{s}(e^y-1-y), y=x-{a!r}"
    if k == 1:
        return (lambda q: s * (np.cosh(q - a) - 1)), [(a, False)], f"{s}(cosh y-1), y=x-{a!r}"
    if k == 2:
        return (lambda q: s * (np.sqrt(1 + (q - a) ** 2) - 1)), [(a, False)], f"{s}(sqrt(1+y^2)-1), y=x-{a!r}"
    if k == 3:
        b = a + float(rng.uniform(0.5, 1.5))
        return (lambda q: s * ((q - a) * (q - b)) ** 2), [(a, False), (b, False)], f"{s}((x-{a!r})(x-{b!r}))^2"
    return (lambda q: s * (1 - np.exp(-((q - a) ** 2)))), [(a, False)], f"{s}(1-exp(-y^2)), y=x-{a!r}"


def flatter(rng):
    a = nice(rng)
    n = int(rng.integers(5, 22))
    s = float(rng.choice([-1, 1]))
    return (lambda q: s * (q - a) ** n), [(a, n % 2 == 1 and s < 0)], f"{s}*(x-{a!r})**{n}"


def periodic(rng):
    a = float(rng.uniform(-3, 3))
    k = rng.integers(6)
    s = float(rng.choice([-1, 1]))
    pi = math.pi
    if k == 0:
        n = int(rng.integers(1, 5))
        return (
            (lambda q: s * (1 - np.cos(n * (q - a)))),
            [(a + 2 * pi * i / n, False) for i in range(n)],
            f"{s}(1-cos({n}(q-{a!r})))",
        )
    if k == 1:
        p = float(rng.uniform(0.5, 5))
        return (
            (lambda q: s * abs(np.sin(q - a)) ** p * np.sign(np.sin(q - a))),
            [(a, s < 0), (a + pi, s > 0)],
            f"{s}|sin y|^{p!r} sign sin y, y=q-{a!r}",
        )
    if k == 2:
        p = float(rng.uniform(0.5, 5))
        return (lambda q: s * abs(np.sin(q - a)) ** p), [(a, False), (a + pi, False)], f"{s}|sin y|^{p!r}, y=q-{a!r}"
    if k == 3:
        c = float(rng.uniform(0.1, 0.9))
        r = math.asin(c * c)
        return (
            (lambda q: s * (np.sqrt(abs(np.sin(q - a))) - c)),
            [(a + r, s < 0), (a + pi - r, s > 0), (a + pi + r, s < 0), (a - r, s > 0)],
            f"{s}(sqrt|sin y|-{c!r}), y=q-{a!r}",
        )
    if k == 4:
        kk = 10 ** rng.uniform(1, 5)
        return (
            (lambda q: s * np.tanh(kk * np.sin(q - a))),
            [(a, s < 0), (a + pi, s > 0)],
            f"{s}tanh({kk!r} sin y), y=q-{a!r}",
        )
    return (lambda q: s * np.cbrt(np.sin(q - a))), [(a, s < 0), (a + pi, s > 0)], f"{s}cbrt(sin y), y=q-{a!r}"


def kinks(rng):
    a = nice(rng)
    b = a + float(rng.uniform(0.4, 2))
    s = float(rng.choice([-1, 1]))
    k = rng.integers(4)
    c = float(rng.uniform(0.1, 1))
    if k == 0:
        return (lambda q: s * (abs(q - a) - c)), [(a - c, s > 0), (a + c, s < 0)], f"{s}(|y|-{c!r}) y=x-{a!r}"
    if k == 1:
        return (lambda q: s * np.minimum(q - a, b - q)), [(a, s < 0), (b, s > 0)], f"{s}min(x-{a!r},{b!r}-x)"
    if k == 2:
        return (
            (lambda q: s * np.where(q < a, np.sqrt(abs(q - a)), -((q - a) ** 2))),
            [(a, s > 0)],
            f"{s}where(x<{a!r}, sqrt, -y^2)",
        )
    return (lambda q: s * (np.sqrt(abs(q - a)) + abs(q - b) - abs(b - a))), None, f"{s}(sqrt|x-{a!r}|+|x-{b!r}|-...)"


def far(rng):
    f, t, n = [products, wells, roots, touches][rng.integers(4)](rng)
    off = float(rng.choice([1e3, 1e6, -1e6]))
    return (lambda q: f(q - off)), [(x + off, st) for x, st in t], n + f"  x=q-{off}"


FAM = dict(
    products=products,
    wells=wells,
    roots=roots,
    steps=steps,
    touches=touches,
    flatter=flatter,
    periodic=periodic,
    kinks=kinks,
    far=far,
)


def distance(e, x, unit, turn):
    """Of a rest from a place in units, without whole turns; none if the place lies in its interval."""
    if e.interval is not None and e.interval[0] / unit - 1e-9 <= x <= e.interval[1] / unit + 1e-9:
        return 0.0
    d = e.coordinates[0] / unit - x
    return abs(math.remainder(d, turn) if turn else d)


def main():
    cases = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    names = sys.argv[3:] or list(FAM)
    total = collections.Counter()
    for name in names:
        count = collections.Counter()
        begun = time.time()
        for i in range(cases):
            rng = np.random.default_rng([seed, i, sum(map(ord, name))])
            f, truth, text = FAM[name](rng)
            if truth is None:
                continue
            kind = "hinge" if name == "periodic" else str(rng.choice(["slide", "slide", "hinge", "bead"]))
            U = 1.0 if kind == "hinge" else float(rng.choice([1e-9, 1e-6, 1e-3, 1, 1, 1e3, 1e9]))
            base = truth[0][0] if name == "far" else 0.0
            w = rng.integers(5)
            at = truth[rng.integers(len(truth))][0]
            start = [
                base + float(rng.uniform(-3, 3)),
                at,
                at + float(rng.choice([-1, 1])) * 10 ** rng.uniform(-10, -2),
                base + float(rng.uniform(-0.5, 0.5)),
                base if name == "far" else 0.0,
            ][w]
            label = f"{name} {i} {kind} U={U} start={start!r} {text}"
            count["cases"] += 1
            count["rests"] += len(truth)
            try:
                found = rb.equilibria(scene_of(kind, f, start, U))
            except Exception as e:
                count["refused"] += 1
                print("REFUSED", label, type(e).__name__, str(e)[:150])
                continue
            scale = max(1.0, abs(base))
            left = list(found)
            lines = []
            turn = 2 * math.pi if name == "periodic" else 0
            for x, st in truth:
                near = sorted(left, key=lambda e, x=x, U=U, turn=turn: distance(e, x, U, turn))
                if not near or not distance(near[0], x, U, turn) < 1e-3 * scale**0.5:
                    count["missed"] += 1
                    lines.append(f"missed {x!r}")
                    continue
                e = near[0]
                left.remove(e)
                d = distance(e, x, U, turn)
                if e.interval is not None or not e.decided:
                    count["unsure"] += 1
                    lines.append(f"unsure {x!r} {e}")
                elif e.stable != st:
                    count["misjudged"] += 1
                    lines.append(f"misjudged {x!r} {st}: {e}")
                if d > 1e-9 * scale:
                    count["inexact"] += 1
                    lines.append(f"off by {d:.1e} at {x!r}")
            for e in left:
                count["false"] += 1
                lines.append(f"false {e.coordinates[0] / U!r} {e.stable} {e.decided} {e.interval}")
            if lines:
                print("  ", label, "|", "; ".join(lines[:6]))
        print(name, dict(count), f"{time.time() - begun:.1f} s")
        total.update(count)
    print("TOTAL", dict(total))


if __name__ == "__main__":
    main()
