"""States of rest are the same in every unit of length, from wherever the search begins."""

import numpy as np
import pytest
import rbdyn as rb

UNITS = [1e-20, 1e-9, 1e-6, 1e-3, 10, 1e3, 1e6, 1e9, 1e20]


def on_slide(force, start, unit=1.0, near=None):
    """(place, stable, interval) of every rest under a force of x, all in units."""
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, [0.1] * 3), rb.Prismatic([1, 0, 0]), displacement=start * unit)
    scene.apply(rb.JointForce(lambda t, q, rate: force(q / unit)), body)
    found = rb.equilibria(scene) if near is None else rb.equilibria(scene, near=[near * unit])
    assert all(e.decided for e in found)
    return [
        (e.coordinates[0] / unit, e.stable, None if e.interval is None else tuple(np.divide(e.interval, unit)))
        for e in found
    ]


def in_plane(force, start, unit=1.0, near=None):
    """(place, stable) of the rest found of a particle under a force of (x, y), and of a spring across, in units."""
    scene = rb.Scene()
    body = scene.add(rb.Particle(1.0), position=[start[0] * unit, start[1] * unit, 0.0])
    scene.apply(rb.Force(lambda t, r, v: [*force(r[0] / unit, r[1] / unit), -r[2] / unit]), body)
    found = rb.equilibria(scene) if near is None else rb.equilibria(scene, near=[near[0] * unit, near[1] * unit, 0.0])
    assert all(e.decided for e in found)
    return [(np.divide(e.coordinates, unit)[:2], e.stable) for e in found]


def same(found, expected):
    assert len(found) == len(expected), (found, expected)
    for (x, stable, interval), (place, holds, all_along) in zip(found, expected, strict=True):
        assert np.allclose(x, place, rtol=1e-9, atol=1e-9) and stable == holds, (found, expected)
        assert (interval is None) == (all_along is None), (found, expected)
        if interval is not None:
            assert np.allclose(interval, all_along, rtol=1e-9, atol=1e-9), (found, expected)


@pytest.mark.parametrize("seed", range(20))
def test_a_dead_band_is_all_that_rests(seed):
    """-(x - a) beyond c from a and nothing within rests from a - c to a + c, and nowhere else: the guards of a formula
    with the sign of |x - a| at another place made rests at 1e10 m."""
    rng = np.random.default_rng(seed)
    a, c = rng.uniform(-2, 2), rng.uniform(0.1, 1)
    expected = [(a, False, (a - c, a + c))]
    same(on_slide(lambda x: np.where(abs(x - a) < c, 0 * x, -(x - a)), 0.0), expected)
    same(on_slide(lambda x: np.where(abs(x - a) < c, 0 * x, -(x - a - c * np.sign(x - a))), 0.0), expected)


@pytest.mark.parametrize("unit", [1e-6, 1e-3, 1, 10, 1e3, 1e6, 1e9])
@pytest.mark.parametrize("start", [1e-12, 1e-9, -1e-9, 1e-6, 1e-3, 0.1])
def test_a_square_that_brings_back_is_stable_from_beside_its_border(start, unit):
    """-x |x| brings back from both sides, though x^2 of one of them does not."""
    same(on_slide(lambda x: -x * abs(x), start, unit), [(0.0, True, None)])


@pytest.mark.parametrize("seed", range(40))
def test_forces_of_straight_pieces_rest_where_these_do(seed):
    """Zeros of straight pieces, jumps across zero and pieces that vanish are known in closed form; starts
    beside a border too, down to 1e-13 from it."""
    rng = np.random.default_rng(seed)
    count = rng.integers(1, 5)
    knots = np.arange(count) - rng.uniform(0, 3) + rng.uniform(-0.4, 0.4, count)
    unit = 10.0 ** rng.integers(-6, 7)
    pieces = [
        [(0.0, 0.0), (rng.normal(), 0.0), (rng.normal(), rng.normal())][min(kind, 2)]
        for kind in rng.integers(0, 4, count + 1)
    ]

    def force(x):
        result = pieces[-1][0] + pieces[-1][1] * x
        for knot, (a, b) in zip(knots[::-1], pieces[-2::-1], strict=True):
            result = np.where(x < knot, a + b * x, result)
        return result

    ends = [-np.inf, *knots, np.inf]
    expected, flat = [], []
    for (a, b), low, high in zip(pieces, ends[:-1], ends[1:], strict=True):
        if b != 0 and low < -a / b < high:
            expected.append((-a / b, b < 0, None))
        elif a == b == 0 and flat and flat[-1][1] == low:
            flat[-1] = (flat[-1][0], high)
        elif a == b == 0:
            flat.append((low, high))
    for knot, (a, b), (c, d) in zip(knots, pieces[:-1], pieces[1:], strict=True):
        before, after = a + b * knot, c + d * knot
        if before * after < 0:
            expected.append((knot, before > 0, None))
    expected.sort()
    for start in (0.0, 1.0, rng.uniform(-4, 4), *(knots[-1] + np.array([1e-13, -1e-13, 1e-9, 1e-3]))):
        found = on_slide(force, start, unit)
        same([e for e in found if e[2] is None], expected)
        assert len([e for e in found if e[2]]) == len(flat)
        for (_, stable, interval), other in zip([e for e in found if e[2]], flat, strict=True):
            assert not stable and np.allclose(interval, other, rtol=1e-9, atol=1e-9)


SLIDES = {
    "sine": lambda x: np.sin(3 * x) - 0.5 * x,
    "cube": lambda x: -((x - 0.3) ** 3),
    "fifth power": lambda x: -((x - 0.3) ** 5) * (x + 1) ** 2,
    "three close": lambda x: -(x - 0.3) * (x - 0.31) * (x - 0.32),
    "square": lambda x: (x - 0.3) ** 2,
    "double well": lambda x: x - x**3,
    "fades": lambda x: -x / (1 + x * x) ** 2 + 0.1,
    "exponential": lambda x: np.exp(-x) - 0.2,
    "corner": lambda x: 0.3 - abs(x - 0.2),
    "jump": lambda x: np.where(x < 0.3, 1 + 0 * x, -1 + 0 * x),
    "jumps": lambda x: np.where(x < -0.5, 1.0, np.where(x < 0.2, -1.0, np.where(x < 0.9, 1.0, -1.0))) + 0 * x,
    "dead band": lambda x: np.where(abs(x - 0.4) < 0.15, 0 * x, -(x - 0.4)),
    "cube and line": lambda x: np.where(x < 0.1, -((x - 0.1) ** 3), -(x - 0.1)),
    "line and cube": lambda x: np.where(x < 0.1, x - 0.1, -((x - 0.1) ** 3)),
    "squares": lambda x: np.where(x < 0.3, (x - 0.3) ** 2, -((x - 0.3) ** 2)),
    "far": lambda x: np.where(x < 1e3, 1 + 0 * x, -(x - 1e3)),
    "wall": lambda x: np.where(x < 1, 0.5 - 0.1 * x, -100 * (x - 1)),
}


@pytest.mark.parametrize("name", SLIDES)
def test_on_a_slide_the_unit_changes_nothing(name):
    for start, near in ((0.0, None), (0.3, None), (-1.7, None), (0.05, 0.2), (0.05, -2.5)):
        expected = on_slide(SLIDES[name], start, near=near)
        assert expected
        for unit in UNITS:
            same(on_slide(SLIDES[name], start, unit, near), expected)


PLANES = {
    # x^4, and beside it what is stiff
    "well": (lambda x, y: (-4 * (x - 1) ** 3, -2 * y), [((1, 0), True)]),
    "sixth power": (lambda x, y: (-6 * (x - 0.3) ** 5, -2 * (y + 0.7)), [((0.3, -0.7), True)]),
    "saddle": (lambda x, y: (4 * (x - 0.3) ** 3, -2 * (y - 0.6)), [((0.3, 0.6), False)]),
    "cubic": (lambda x, y: (3 * (x - 0.3) ** 2, -2 * (y - 0.6)), [((0.3, 0.6), False)]),
    "turned": (
        lambda x, y: (
            -4 * (x + y - 1) ** 3 - 2 * (x - y - 0.3),
            -4 * (x + y - 1) ** 3 + 2 * (x - y - 0.3),
        ),
        [((0.65, 0.35), True)],
    ),
    # of -(x - 0.3)^4 + (x - 0.3) (y - 0.2)^2 / 2 - (y - 0.2)^2
    "coupled": (
        lambda x, y: (-4 * (x - 0.3) ** 3 + 0.5 * (y - 0.2) ** 2, -2 * (y - 0.2) + (x - 0.3) * (y - 0.2)),
        [((0.3, 0.2), True)],
    ),
}


@pytest.mark.parametrize("near", [None, (0.7, 0.3), (0.0, 0.5), (-1.3, 2.0)])
@pytest.mark.parametrize("name", PLANES)
def test_of_degenerate_rests_in_a_plane_the_unit_changes_nothing(name, near):
    """Such a rest is none of the doubles in most units: there slopes vanish, not what is left of the force."""
    force, expected = PLANES[name]
    for unit in (1.0, *UNITS):
        found = in_plane(force, (0.5, 0.4), unit, near)
        assert len(found) == 1, (unit, found)
        assert np.allclose(found[0][0], expected[0][0], rtol=0, atol=1e-9) and found[0][1] == expected[0][1], unit


@pytest.mark.parametrize("near", [(0.7, 0.3), (0.0, 0.5), (-1.3, 2.0)])
def test_a_rest_at_zero_of_all_coordinates_is_found_in_every_unit(near):
    """Without a potential: det of ((1, -0.3), (0.2, -1)) is negative, a saddle, and the next rests are 3 away."""
    for unit in (1.0, *UNITS):
        found = in_plane(lambda x, y: (np.sin(x) - 0.3 * y, -y + 0.2 * x), (0.5, 0.4), unit, near)
        assert len(found) == 1 and np.allclose(found[0][0], 0, atol=1e-9) and not found[0][1], (unit, found)


@pytest.mark.parametrize("start", [0.0, 0.3, 3.0, -2.0, np.pi])
def test_a_jump_at_the_seam_of_a_turn_is_one(start):
    """-sign(sin q) jumps at 0, where a turn begins and ends, and at pi."""
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, [0.1] * 3), rb.Revolute(axis=[0, 0, 1]), angle=start)
    scene.apply(rb.JointTorque(lambda t, q, rate: np.where(np.sin(q) > 0, -1 + 0 * q, 1 + 0 * q)), body)
    found = [(e.coordinates[0], e.stable) for e in rb.equilibria(scene)]
    assert np.allclose([x for x, _ in found], [0, np.pi], atol=1e-9) and [s for _, s in found] == [True, False]


@pytest.mark.parametrize("start", [1 + 1e-13, 1 - 1e-9, -1 + 1e-13, 1e-13])
def test_from_beside_a_rest_the_others_are_found(start):
    """32 stretches from beside a zero are as long as those from elsewhere."""
    same(on_slide(lambda x: x - x**3, start), [(-1, True, None), (0, False, None), (1, True, None)])


@pytest.mark.parametrize("seed", range(30))
def test_products_of_roots_rest_where_these_are(seed):
    """Roots up to threefold and the signs between them are known; searches begin at one, beside it, and elsewhere."""
    rng = np.random.default_rng(seed)
    count = rng.integers(1, 6)
    roots = np.arange(count) - rng.uniform(0, 4) + rng.uniform(-0.4, 0.4, count)
    orders = rng.integers(1, 4, count)
    sign, unit = rng.choice([-1, 1]), 10.0 ** rng.integers(-9, 10)

    def force(x):
        result = sign
        for root in np.repeat(roots, orders):
            result = result * (x - root)
        return result

    expected = []
    for i, (root, order) in enumerate(zip(roots, orders, strict=True)):
        above = sign * (-1) ** orders[i + 1 :].sum()
        expected.append((root, bool(order % 2 == 1 and above < 0), None))
    beside = roots[0] + 10 ** rng.uniform(-14, -2, 4) * [1, -1, 1, -1]
    for start in (roots[0], roots[-1], rng.uniform(-4, 4), 0.0, *beside):
        same(on_slide(force, start, unit), expected)


def test_a_search_of_two_coordinates_that_begins_on_a_border_is_one_of_the_scene():
    """A band of rests is met in every unit: what a border at the start bends at once is no length of the scene."""
    for unit in (1.0, *UNITS):
        scene = rb.Scene()
        body = scene.add(rb.Particle(1.0), position=[0.5 * unit, 0.4 * unit, 0.0])

        def force(t, r, v, unit=unit):
            x = r[0] / unit
            return [np.where(abs(x - 0.3) < 0.2, 0 * x, 0.3 - x), -2 * r[1] / unit, -r[2] / unit]

        scene.apply(rb.Force(force), body)
        (found,) = rb.equilibria(scene, near=[0.7 * unit, 0.3 * unit, 0.0])
        x, y, _ = np.divide(found.coordinates, unit)
        assert 0.1 - 1e-9 <= x <= 0.5 + 1e-9 and abs(y) < 1e-9 and not found.stable
