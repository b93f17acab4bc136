"""Watched functions that are products, powers and odd functions of what passes zero: each root, however near others."""

import random
from fractions import Fraction

import numpy as np
import pytest
import rbdyn as rb

ENGINES = ["auto", "taylor", "dop853", pytest.param("cvode-adams", marks=pytest.mark.cvode)]
WRAPPED = {
    "": lambda y: y,
    "sign": np.sign,
    "cbrt": np.cbrt,
    "tanh": np.tanh,
    "arctan": np.arctan,
    "sinh": np.sinh,
    "sign sqrt": lambda y: np.sign(y) * np.sqrt(np.abs(y)),
    "quotient": lambda y: y / (2.0 + y * y),
}


def made_up(seed):
    """Roots on [0, 1] with their orders, some of them near others, and what is around their product."""
    draw = random.Random(seed)
    roots, last = [], draw.uniform(0.05, 0.95)
    for _ in range(draw.randint(2, 5)):
        last = draw.choice([draw.uniform(0.05, 0.95), min(last + 10 ** draw.uniform(-9, -1), 0.97)])
        if all(abs(last - root) > 1e-10 for root, _ in roots):
            roots.append((last, draw.choice([1, 1, 2, 3, 4, 5, 7])))
    return roots, draw.choice(list(WRAPPED))


def events_of(roots):
    """Where the product of (t - root)^order changes its sign, and whether it rises there."""
    left, found = sum(order for _, order in roots), []
    for root, order in sorted(roots):
        left -= order
        if order % 2:
            found.append((root, left % 2 == 0))
    return found


def watched(roots, around, speed=1.0, start=0.0, **options):
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), velocity=[speed, 0, 0])

    def product(now):
        y = 1.0
        for root, order in roots:
            y = y * (now[ball].position[0] - root * speed) ** order
        return WRAPPED[around](y)

    scene.watch("w", product, **options)
    return scene


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("seed", range(120))
def test_every_root_is_an_event_and_nothing_else(seed, engine):
    roots, around = made_up(seed)
    run = rb.simulate(watched(roots, around), until=1.0, error=1e-9, engine=engine)
    assert [event.direction for event in run.events] == [
        "rising" if rises else "falling" for _, rises in events_of(roots)
    ]
    assert run.events.times("w") == pytest.approx([root for root, _ in events_of(roots)], abs=1e-11)


@pytest.mark.parametrize("direction", ["rising", "falling"])
@pytest.mark.parametrize("seed", range(40))
def test_a_direction_is_that_of_the_product(seed, direction):
    roots, around = made_up(seed)
    wanted = [root for root, rises in events_of(roots) if rises == (direction == "rising")]
    run = rb.simulate(watched(roots, around, direction=direction), until=1.0, error=1e-9)
    assert run.events.times("w") == pytest.approx(wanted, abs=1e-11)
    stopped = rb.simulate(watched(roots, around, direction=direction, action="stop"), until=1.0, error=1e-9)
    assert stopped.end == pytest.approx(wanted[0] if wanted else 1.0, abs=1e-11)


@pytest.mark.parametrize("seed", range(60))
def test_it_goes_on_from_any_of_its_roots(seed):
    roots, around = made_up(seed)
    for middle, _ in roots:
        first = rb.simulate(watched(roots, around), until=middle, error=1e-9)
        second = rb.simulate(first, until=1.0)
        times = sorted({*first.events.times("w"), *second.events.times("w")})
        assert times == pytest.approx([root for root, _ in events_of(roots)], abs=1e-11)


@pytest.mark.parametrize("seed", range(40))
def test_roots_at_the_end_count(seed):
    roots, around = made_up(seed)
    last = max(root for root, _ in roots)
    run = rb.simulate(watched(roots, around), until=last, error=1e-9)
    assert run.events.times("w") == pytest.approx([root for root, _ in events_of(roots)], abs=1e-11)


NEVER_NEGATIVE = {
    "sqrt|f|": lambda f, g: np.sqrt(abs(f)),
    "|f|^(1/4)": lambda f, g: np.sqrt(np.sqrt(abs(f))),
    "|f|^0.3": lambda f, g: abs(f) ** 0.3,
    "sqrt|f g|": lambda f, g: np.sqrt(abs(f * g)),
    "|sin 3 f|": lambda f, g: abs(np.sin(3 * f)),
    "hypot": lambda f, g: np.hypot(f, f * g),
    "cbrt(f)^2": lambda f, g: np.cbrt(f) ** 2,
    "f^2 g^4": lambda f, g: f**2 * g**4,
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", NEVER_NEGATIVE)
def test_what_is_never_negative_passes_nothing(name, engine):
    for frequency, zero, start in [(3.0, -0.44, 0.0), (0.7, 0.07, 3.7), (4.3, 0.6, 1000.0)]:
        system = rb.System(lambda t, x, w=frequency: [w * x[1], -w * x[0]], [0.3, 0.9], names=["s", "c"])
        system.watch("w", lambda now, c=zero: NEVER_NEGATIVE[name](now["c"] - c, now["s"] - 0.2))
        run = rb.simulate(
            system, until=start + 5, start=start, error=1e-9 if engine != "cvode-adams" else 1e-6, engine=engine
        )
        assert list(run.events.times("w")) == []


def test_two_factors_that_pass_together_pass_nothing():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), velocity=[1, 2, 0])
    scene.watch("w", lambda now: (now[ball].position[0] - 0.3) * (now[ball].position[1] - 0.6))
    assert list(rb.simulate(scene, until=1.0, error=1e-9).events.times("w")) == []


def test_a_product_with_a_factor_that_stays_zero_passes_nothing():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), velocity=[1, 0, 0])
    scene.watch("w", lambda now: (now[ball].position[0] - 0.3) * now[ball].position[1])
    scene.watch("square", lambda now: (now[ball].position[0] - 0.3) * now[ball].position[1] ** 2)
    assert list(rb.simulate(scene, until=1.0, error=1e-9).events) == []


def test_a_logarithm_of_an_absolute_value_passes_zero_at_one():
    system = rb.System(lambda t, x: [3 * x[1], -3 * x[0]], [0.0, 1.0], names=["s", "c"])
    system.watch("w", lambda now: np.log(abs(2 * now["c"])))
    angles = [np.pi / 3, 2 * np.pi / 3, 4 * np.pi / 3, 5 * np.pi / 3]
    run = rb.simulate(system, until=2.0, error=1e-10)
    assert run.events.times("w") == pytest.approx([angle / 3 for angle in angles], abs=1e-10)


def test_distinctions_by_larger_and_smaller_ones_are_made_by_their_signs():
    system = rb.System(lambda t, x: [3 * x[1], -3 * x[0]], [np.sin(0.3), np.cos(0.3)], names=["s", "c"])
    system.watch("w", lambda now: np.where(np.minimum(now["s"] * now["c"], now["c"]) > 0, 1.0, -1.0))
    run = rb.simulate(system, until=5.0, error=1e-9)
    # sine and cosine are positive together in the first quarter of each turn
    turns = [(k * np.pi / 2 - 0.3) / 3 for k in (1, 4, 5, 8, 9)]
    assert run.events.times("w") == pytest.approx([t for t in turns if 0 < t < 5], abs=1e-9)


def test_an_action_at_a_root_of_a_product_happens_at_each():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), velocity=[1, 0, 0])
    roots = [Fraction(1, 4), Fraction(1, 4) + Fraction(1, 2**24), Fraction(3, 4)]
    scene.watch(
        "turn",
        lambda now: (now.time - float(roots[0])) * (now.time - float(roots[1])) ** 3 * (now.time - float(roots[2])),
        action=lambda now: {ball: {"velocity": -np.asarray(now[ball].velocity)}},
    )
    run = rb.simulate(scene, until=1.0, error=1e-12)
    assert run.events.times("turn") == pytest.approx([float(root) for root in roots], abs=1e-13)
    there = float(roots[0] - (roots[1] - roots[0]) + (roots[2] - roots[1]) - (1 - roots[2]))
    assert run[ball].position(1.0)[0] == pytest.approx(there, abs=1e-12)
