"""States of pickled things, changed from a seed, given back and used: run as a program it prints what came of them.

    python tampered.py SEED COUNT

Before each use its text goes to stderr, so that of a crash the state is known.
"""

import copy
import inspect
import random
import sys
import warnings

import rbdyn as rb
from bad_calls import things

NUMBERS = [
    -1,
    0,
    1,
    2,
    7,
    255,
    2**31 - 1,
    -(2**31),
    2**40,
    -(2**63),
    0.0,
    -1.0,
    1e308,
    5e-324,
    float("nan"),
    float("inf"),
]
OTHERS = [None, True, "", "x", "a\0b", "\ud800", b"", b"\x00" * 8, (), [], (1, 2, 3), {}, "add", "input", "where"]


def zoo():
    """One of each thing that is pickled."""
    found = [thing for name, thing in things().items() if name not in ("equilibria", "user")]
    found += [
        rb.Function(lambda x, y: abs(x) + (y if y > 0 else x * y)),
        rb.Spring(3.0, 0.5),
        rb.Drag(1.0),
        rb.Coulomb(0.3),
    ]
    found += [
        rb.Rail(rb.Helix(1.0, 0.2, [1, 0, 0], [0, 1, 0])),
        rb.Revolute([0, 0, 1]),
        rb.Universal([1, 0, 0], [0, 1, 0]),
    ]
    found += [
        rb.Gravitation(1.0),
        rb.Central(lambda r: -r),
        rb.Potential(lambda r: r @ r),
        rb.PointOnPlane(rb.Plane([0, 0, 1])),
    ]
    found += things()["equilibria"]
    watched = rb.System(lambda t, x: [-abs(x[0])], [1.0])
    watched.watch("half", lambda now: now.x[0] - 0.5, action="stop")
    return [*found, watched]


def pickled(thing):
    """What pickle would keep: a callable with its arguments, or a class and a state."""
    try:
        made = thing.__reduce_ex__(2)
    except Exception:
        return None
    return made if isinstance(made, tuple) else None


def changed(value, chance):
    """The same with one thing in it changed."""
    if isinstance(value, tuple | list) and len(value) > 0 and chance.random() < 0.93:
        items = list(value)
        place = chance.randrange(len(items))
        what = chance.random()
        if what < 0.8:
            items[place] = changed(items[place], chance)
        elif what < 0.87:
            del items[place]
        elif what < 0.94:
            items.insert(place, copy.copy(items[place]))
        else:
            chance.shuffle(items)
        return type(value)(items)
    if isinstance(value, bytes) and len(value) > 0 and chance.random() < 0.8:
        data = bytearray(value)
        data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
        return bytes(data)
    if isinstance(value, str) and value and chance.random() < 0.6:
        place = chance.randrange(len(value))
        return (
            value[:place]
            + chance.choice(["", "9", "-", "\0", "[", "1e999", '"'])
            + value[place + chance.choice([0, 1]) :]
        )
    if isinstance(value, int | float) and chance.random() < 0.8:
        return chance.choice(NUMBERS)
    return chance.choice(NUMBERS + OTHERS)


def used(thing):
    """Asks a thing for all it says by itself."""
    for look in (repr, str, hash, len, lambda x: x == x, copy.copy, lambda x: x.__reduce_ex__(2)):
        try:
            look(thing)
        except Exception:
            pass
    for name in dir(type(thing)):
        if name.startswith("_") or name in ("save", "plot", "view", "animate", "plot_path", "phase_portrait", "to_csv"):
            continue
        try:
            part = getattr(thing, name)
            if callable(part) and not inspect.isclass(part):
                for given in ((), (0.1,), (0.1, 0.2)):
                    part(*given)
        except Exception:
            pass
    try:
        if isinstance(thing, rb.Scene | rb.System):
            rb.simulate(thing, 0.02, rtol=1e-4, max_steps=50)
        elif isinstance(thing, rb.Function):
            thing(*[0.5] * min(thing.inputs, 40))
            rb.simulate(rb.System(thing, [0.5] * min(thing.outputs, 10)), 0.02, rtol=1e-4, max_steps=50)
    except Exception:
        pass


def made_up(seed, count):
    """How many of the states were refused, by the type of the error, and those that were refused without a reason."""
    chance = random.Random(seed)
    known = [made for made in map(pickled, zoo()) if made is not None]
    kinds, wrong = {}, []
    for _ in range(count):
        maker, arguments, *states = chance.choice(known)
        state = states[0] if states else None
        if state is None:
            arguments = changed(arguments, chance)
        else:
            state = changed(state, chance)
        told = ascii((getattr(maker, "__name__", maker), arguments if state is None else (arguments, state)))[:2000]
        print(told, file=sys.stderr)
        try:
            thing = maker(*arguments)
            if state is not None:
                thing.__setstate__(state)
            kind = "taken"
        except Exception as error:
            kind = type(error).__name__
            if kind in ("SystemError", "RuntimeError", "MemoryError") or not str(error):
                wrong.append(f"{told[:300]}: {kind}: {str(error)[:100]!a}")
        else:
            used(thing)
        kinds[kind] = kinds.get(kind, 0) + 1
    return kinds, wrong


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    found, bad = made_up(int(sys.argv[1]), int(sys.argv[2]))
    for what, number in sorted(found.items(), key=lambda item: -item[1]):
        print(number, what)
    print(*(f"WRONG {one}" for one in bad[:40]), sep="\n")
    print("WRONG", len(bad))
