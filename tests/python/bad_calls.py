"""Calls that break rules, made up from a seed: run as a program it prints what came of them, a line a kind.

    python bad_calls.py SEED COUNT

Before each call its text goes to stderr, so that of a crash the call is known.
"""

import inspect
import random
import signal
import sys
import threading
import warnings

import numpy as np
import rbdyn as rb


def things():
    """One of each thing there is, by name: what methods are called of, and what is given where it does not belong."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    bead = scene.add(rb.Particle(0.5), rb.Rail(rb.Circle(0.5, [0, 0, -1], [1, 0, 0])), parameter=0.1, speed=1.0)
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 1], velocity=[0, 0, 0])
    wheel = scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.2]), rb.Revolute([0, 0, 1]), rate=1.0)
    spring = scene.connect(rb.Spring(4.0), ball, [0, 0, 1])
    load = scene.apply(rb.Force(lambda t, position, velocity: -0.1 * velocity), ball)
    watch = scene.watch("low", lambda now: now[ball].position[2])
    run = rb.simulate(scene, 0.5, rtol=1e-6)
    system = rb.System(lambda t, x: [x[1], -x[0]], [1.0, 0.0], names=["a", "b"])
    own = rb.simulate(system, 0.5, rtol=1e-6)
    other = rb.Scene()
    stranger = other.add(rb.Particle(1.0))
    swing = rb.Scene(gravity=[0, 0, -9.81])
    swing.add(rb.RigidBody(1.0, [0.1, 0.2, 0.2], com=[0, 0, -0.3]), rb.Revolute([1, 0, 0]), angle=0.2)
    found = {
        "scene": scene, "bead": bead, "ball": ball, "wheel": wheel, "spring": spring, "load": load, "watch": watch,
        "run": run, "motion": run[ball], "beads": run[bead], "wheels": run[wheel], "coupling": run[spring],
        "events": run.events, "statistics": run.statistics, "plan": rb.plan(scene), "system": system, "own": own,
        "variable": own["a"], "stranger": stranger, "function": rb.Function(lambda x, y: x * y + 1),
        "parameter": rb.parameter(2.0, "k"), "circle": rb.Circle(1.0, [1, 0, 0], [0, 1, 0]), "line": rb.Line([1, 0, 0]),
        "spline": rb.Spline([[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 1]]), "body": rb.shapes.box(1.0, [1, 2, 3]),
        "particle": rb.Particle(1.0), "angles": rb.EulerAngles(0.1, 0.2, 0.3), "point": wheel.point([1, 0, 0]),
        "sphere": wheel.sphere(0.1), "plane": rb.Plane([0, 0, 1]), "coulomb": rb.Coulomb(0.3), "swing": swing,
        "equilibria": rb.equilibria(swing), "modes": rb.normal_modes(swing, rb.equilibria(swing)[0]),
        "sample": run.sample([0.1, 0.2]), "user": rb.System(lambda t, x: -x, [1.0], trace=False).f,
    }  # fmt: skip
    return found


def raises(*_):
    raise ZeroDivisionError("of the user's")


def oddities():
    """What nobody should give."""
    strided = np.arange(12.0).reshape(3, 4)[:, ::2]
    endless = []
    endless.append(endless)
    return [
        None, True, 0, 1, -1, 2**31, 2**70, -(2**70), 0.5, -0.5, 1e308, 5e-324, float("nan"), float("inf"), 1j, "", "x",
        "a\0b", "\ud800", "é" * 50, b"bytes", [], [1.0], [1, 0, 0], [0, 0, 0], [float("nan")] * 3, ["a", "b", "c"],
        [[1, 2], [3]], endless, (1, 2, 3, 4), {}, {"a": 1}, {1, 2}, range(3), np.zeros(0), np.ones(3), np.ones((3, 3)),
        np.zeros((3, 3)), strided, np.ones(3, "f4"), np.ones(3, ">f8"), np.array([1, 2, 3], object), 1j * np.ones(3),
        np.full((2, 3), np.inf), np.datetime64("2020"), np.ma.masked, lambda *a: 1.0, lambda: None, lambda x: [x, x, x],
        lambda t, x, v: x, raises, len, object(), type, rb, rb.Scene, Ellipsis, NotImplemented,
    ]  # fmt: skip


# what runs for as long as it is told to, or writes where it is told to
SLOW = {"simulate_many", "load", "save", "plot", "to_csv", "view", "animate", "plot_path", "phase_portrait", "verify"}


def targets(zoo):
    """Every public thing that can be called, with its name."""
    found = [
        (f"rb.{name}", getattr(rb, name)) for name in rb.__all__ if callable(getattr(rb, name)) and name not in SLOW
    ]
    found += [(f"rb.shapes.{n}", f) for n, f in vars(rb.shapes).items() if callable(f) and not n.startswith("_")]
    for name, thing in zoo.items():
        if isinstance(thing, list):
            continue
        for word in dir(type(thing)):
            dunder = word.startswith("_") and word not in (
                "__getitem__",
                "__call__",
                "__eq__",
                "__add__",
                "__contains__",
            )
            if dunder or word in SLOW or not callable(inspect.getattr_static(type(thing), word, None)):
                continue
            found.append((f"{name}.{word}", (thing, word)))
    return found


def text_of(value):
    try:
        return ascii(value)[:60]
    except Exception:
        return f"a {type(value).__name__}"


def made_up(seed, count):
    """What came of so many calls: {kind: count}, and the texts of those that went wrong."""
    chance = random.Random(seed)
    zoo = things()
    pool = oddities() + list(zoo.values())
    fine = [0.5, 1.0, [1, 0, 0], [0, 0, 1], "x", zoo["scene"], zoo["ball"], zoo["particle"], zoo["circle"]]
    called = targets(zoo)
    kinds, wrong = {}, []
    for _ in range(count):
        name, target = chance.choice(called)
        function = target if not isinstance(target, tuple) else getattr(*target)
        try:
            words = [p for p in inspect.signature(function).parameters if p not in ("self", "args", "kwargs")]
        except (TypeError, ValueError):
            words = []
        given = [chance.choice(chance.choice([pool, fine])) for _ in range(chance.choice([0, 1, 1, 2, 2, 3, 4]))]
        named = {w: chance.choice(pool) for w in chance.sample(words, min(len(words), chance.choice([0, 0, 1, 2])))}
        if "until" in words or name.endswith("simulate"):
            named = {"until": 0.01, **named, "max_steps": 200} if chance.random() < 0.7 else named
        if name in ("rb.cost",):
            named |= {"budget": 0.01}
        call = f"{name}({', '.join([*map(text_of, given), *(f'{w}={text_of(v)}' for w, v in named.items())])})"
        print(call, file=sys.stderr)
        try:
            function(*given, **named)
            kind = "fine"
        except BaseException as error:
            kind = type(error).__name__
            message = str(error)
            if "incompatible" in message and "arguments" in message:
                kind = "dump"
            if kind in ("SystemError", "RuntimeError", "RecursionError", "MemoryError", "SystemExit") or kind == "dump":
                wrong.append(f"{call}: {kind}: {message[:120]!a}")
        kinds[kind] = kinds.get(kind, 0) + 1
    return kinds, wrong


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    # a call that does not come back is stopped with its place
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    threading.stack_size(0)
    found, bad = made_up(int(sys.argv[1]), int(sys.argv[2]))
    for what, number in sorted(found.items(), key=lambda item: -item[1]):
        print(number, what)
    print(*(f"WRONG {one}" for one in bad[:40]), sep="\n")
    print("WRONG", len(bad))
