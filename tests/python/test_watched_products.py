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


def moved(function, speed=1.0, start=-1.0, until=2.5, **options):
    system = rb.System(lambda t, x: [speed], [start], names=["x"])
    system.watch("w", lambda now: function(now["x"]), **options)
    return rb.simulate(system, until=until)


LEVELS = {
    # what is watched, and where x passes through with which direction, on its way from -1 to 1.5
    "x where |x| > 0.1": (lambda x: x * np.where(abs(x) < 0.1, 0.0, 1.0), [(0.1, "rising")]),
    "a dead zone": (lambda x: np.maximum(x - 0.1, 0) + np.minimum(x + 0.1, 0), [(0.1, "rising")]),
    "a dead zone (x + 2)": (
        lambda x: (np.maximum(x - 0.1, 0) + np.minimum(x + 0.1, 0)) * (x + 2),
        [(0.1, "rising")],
    ),
    "a dead zone x": (lambda x: (np.maximum(x - 0.1, 0) + np.minimum(x + 0.1, 0)) * x, []),
    "max(x, 0) x": (lambda x: np.maximum(x, 0) * x, []),
    "max(x, 0) (x - 0.5)": (lambda x: np.maximum(x, 0) * (x - 0.5), [(0.5, "rising")]),
    "min(x, 0) (x + 0.5)": (lambda x: np.minimum(x, 0) * (x + 0.5), [(-0.5, "falling")]),
    "min(x, 0) (x - 0.5)": (lambda x: np.minimum(x, 0) * (x - 0.5), []),
}


@pytest.mark.parametrize("name", LEVELS)
def test_a_level_at_zero_holds_the_product(name):
    function, expected = LEVELS[name]
    events = [event for event in moved(function).events if event.kind == "watch"]
    assert [event.direction for event in events] == [direction for _, direction in expected]
    assert [event.time - 1.0 for event in events] == pytest.approx([x for x, _ in expected], abs=1e-12)


def test_what_friction_holds_at_zero_holds_the_product():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    block = scene.add(rb.Particle(1.0), rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(0.5)), speed=5.0)
    scene.watch("speed", lambda now: now[block].speed * (now.time - 3.0))
    scene.watch("energy", lambda now: now[block].kinetic_energy * (now.time - 3.0))
    run = rb.simulate(scene, until=5.0, error=1e-9)
    stopped = 5.0 / (0.5 * 9.81)
    assert run.events.times("speed") == pytest.approx([stopped], rel=1e-12)
    assert all(time < 3.0 - 1e-6 for time in run.events.times("energy"))


@pytest.mark.parametrize("start", [-300.0, -1.0, 0.75, 10.0])
@pytest.mark.parametrize("rate", [0.01, 1.0, 30.0])
def test_a_pole_where_doubles_of_the_state_stand_still_is_an_instant(start, rate):
    draw = random.Random(f"{start} {rate}")
    for _ in range(12):
        pole = start + draw.uniform(0.1, 0.9)
        for function in (
            lambda x, c=pole: 1 / (x - c),
            lambda x, c=pole: 1 / (x - c) ** 2,
            lambda x, c=pole: 1 / np.cbrt(x - c),
            lambda x, c=pole: 1 / abs(x - c),
        ):
            assert list(moved(function, rate, start, 1.0 / rate).events.times("w")) == []
        events = moved(lambda x, c=pole: (x - c - 0.05) / (x - c), rate, start, 1.0 / rate).events
        assert events.times("w") == pytest.approx([(pole + 0.05 - start) / rate], rel=1e-11)


BESIDE_POLES = {
    "sqrt|z tan|": lambda z: np.sqrt(abs(z * np.tan(z / 2))),
    "sqrt|z log|": lambda z: np.sqrt(abs(z * np.log1p(z / 3))),
    "|z|^0.3 log, squared": lambda z: (abs(z) ** 0.3 * np.log1p(z / 3)) ** 2,
    "expm1(z log)": lambda z: np.expm1(z * np.log1p(z / 3)),
    "z log cbrt^2": lambda z: z * np.log1p(z / 3) * np.cbrt(z) ** 2,
    "arctan of arctanh": lambda z: abs(np.arctan(z * np.arctanh(z / 3))),
}


@pytest.mark.parametrize("name", BESIDE_POLES)
def test_even_zeros_of_logarithms_and_tangents_pass_nothing(name):
    for zero in (0.1, 0.3922, 0.4677):
        assert list(moved(lambda x, c=zero: BESIDE_POLES[name](x - c)).events.times("w")) == []


def test_high_powers_of_what_has_no_polynomial_are_at_their_zeros():
    for function, zero in [
        (lambda z: (z**8 * np.arcsinh(z)) ** 3, 0.0),
        (lambda z: (z**8 * np.arctanh(z / 3)) ** 3, 0.0),
        (lambda z: z**3 * np.sign(z) * abs(z) ** 1.5 * z / (2 + np.cos(z)), 0.0),
    ]:
        for c in (0.0, 0.3):
            events = moved(lambda x, f=function, c=c: f(x - c)).events
            assert events.times("w") == pytest.approx([1.0 + c + zero], abs=1e-11)


@pytest.mark.parametrize("near", [1e-5, 1e-6, 1e-7, 1e-8])
def test_a_case_on_a_product_of_near_roots_is_the_right_one(near):
    events = moved(lambda x: np.where((x - 0.3) * (x - 0.3 - near) > 0, x - 0.3, x - 0.3 - near)).events
    assert events.times("w") == pytest.approx([1.3 + near], abs=1e-13)


def test_a_run_that_goes_on_from_a_jump_of_a_factor_has_all_the_others():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[-1, 0, 0], velocity=[1, 0, 0])
    scene.watch("w", lambda now: (now[ball].position[0] - 0.7) * np.copysign(2.0, now[ball].position[0] + 0.49))
    first = rb.simulate(scene, until=0.51, error=1e-9)
    assert first.events.times("w") == pytest.approx([0.51])
    assert rb.simulate(first, until=2.0).events.times("w") == pytest.approx([1.7])
