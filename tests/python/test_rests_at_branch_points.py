"""Rests of one coordinate at and beyond branch points of its force, where no Taylor series holds, and where it touches
zero; places and signs are closed forms."""

import math

import numpy as np
import pytest
import rbdyn as rb

ONE_BODY = rb.RigidBody(1.0, [1.0, 1.0, 1.0])


def on_slide(force, start, unit=1.0):
    scene = rb.Scene()
    body = scene.add(ONE_BODY, rb.Prismatic([1, 0, 0]), displacement=start * unit)
    scene.apply(rb.JointForce(lambda t, q, rate: force(q / unit)), body)
    return rests(scene, unit)


def on_hinge(torque, start):
    scene = rb.Scene()
    body = scene.add(ONE_BODY, rb.Revolute([1, 0, 0]), angle=start)
    scene.apply(rb.JointTorque(lambda t, q, rate: torque(q)), body)
    return rests(scene)


def on_rail(force, start):
    scene = rb.Scene()
    bead = scene.add(rb.Particle(1.0), rb.Rail(rb.Line([1, 0, 0])), parameter=start)
    scene.apply(rb.Force(lambda t, r, v: [force(r[0]), 0.0, 0.0]), bead)
    return rests(scene)


def rests(scene, unit=1.0):
    found = rb.equilibria(scene)
    assert all(e.decided and e.interval is None for e in found), found
    return [(e.coordinates[0] / unit, e.stable) for e in found]


def same(found, expected, within=1e-9):
    assert [stable for _, stable in found] == [stable for _, stable in expected], (found, expected)
    for (x, _), (place, _) in zip(found, expected, strict=True):
        assert abs(x - place) <= within, (found, expected)


# force, its rests, whether they are stable
BRANCHES = {
    "root": (lambda x: 1 - np.sqrt(abs(x)), [(-1, False), (1, True)]),
    "five halves": (lambda x: 1 - abs(x) ** 2.5, [(-1, False), (1, True)]),
    "well": (lambda x: -(abs(x) ** 2.5) * np.sign(x), [(0, True)]),
    "hill": (lambda x: abs(x) ** 3.7 * np.sign(x), [(0, False)]),
    "touches": (lambda x: np.sqrt(abs(x)) - x, [(0, False), (1, True)]),
    "cube root": (lambda x: -np.cbrt(x - 1) + 0.5, [(1.125, True)]),
    "at its root": (lambda x: -np.cbrt(x - 0.7), [(0.7, True)]),
    "far below": (lambda x: 1e-9 - np.sqrt(abs(x)), [(-1e-18, False), (1e-18, True)]),
    "two": (lambda x: np.cbrt(x + 0.5) * abs(x - 1.3) ** 1.5, [(-0.5, False), (1.3, False)]),
}


@pytest.mark.parametrize("name", BRANCHES)
@pytest.mark.parametrize("start", [0.5, -0.5, 0.0, 1.0, 1e-9, -1e-4])
def test_a_branch_point_hides_nothing(name, start):
    """Series about any place end at a branch point; signs of the force on both sides go on."""
    force, expected = BRANCHES[name]
    same(on_slide(force, start), expected)


@pytest.mark.parametrize("name", BRANCHES)
@pytest.mark.parametrize("unit", [1e-9, 1e-3, 1e9])
def test_a_branch_point_hides_nothing_in_any_unit(name, unit):
    force, expected = BRANCHES[name]
    for start in (0.5, 0.0):
        same(on_slide(force, start, unit), expected)


@pytest.mark.parametrize("name", ["root", "well", "touches", "cube root"])
def test_a_branch_point_hides_nothing_on_hinges_and_rails(name):
    force, expected = BRANCHES[name]
    for start in (0.5, 0.0):
        same(on_hinge(force, start), expected)
        same(on_rail(force, start), expected)


def test_a_branch_point_far_from_zero_hides_nothing():
    """A million from zero doubles tell places to 1e-10."""
    for start in (1e6, 1e6 + 0.3, 1e6 - 2.0):
        same(on_slide(lambda x: 1 - np.sqrt(abs(x - 1e6)), start), [(1e6 - 1, False), (1e6 + 1, True)], 1e-8)
        same(on_slide(lambda x: -np.cbrt(x - 1e6), start), [(1e6, True)], 1e-8)


def test_a_pole_of_a_root_is_no_rest():
    """1/cbrt(x) changes sign where it is infinite."""
    same(on_slide(lambda x: -1 / np.cbrt(x - 0.3) + 0.25, 0.5), [(64.3, False)])


def turns(places):
    return sorted(math.remainder(place, 2 * math.pi) for place in places)


@pytest.mark.parametrize("start", [0.1, 0.7, 3.0])
def test_a_torque_that_touches_zero_rests_a_hinge_there(start):
    """1 - cos(q - 0.7) is zero at 0.7 and positive beside it: the critical pendulum under a constant torque, which is
    m g l (1 - sin q), written as a torque of the angle."""
    same(on_hinge(lambda q: 4.905 * (1 - np.cos(q - 0.7)), start), [(0.7, False)], 1e-7)
    same(on_hinge(lambda q: 2 * np.sin(0.5 * (q - 0.7)) ** 2, start), [(0.7, False)], 1e-7)


@pytest.mark.parametrize("start", [0.1, 0.7])
def test_a_force_that_touches_zero_rests_a_slide_there(start):
    """At 0.7 and whole turns from there, as far as is searched."""
    found = on_slide(lambda q: 1 - np.cos(q - 0.7), start)
    assert not any(stable for _, stable in found)
    numbers = np.array([(x - 0.7) / (2 * math.pi) for x, _ in found])
    assert np.allclose(numbers, np.arange(round(numbers[0]), round(numbers[0]) + len(numbers)), atol=1e-6)
    assert numbers[0] < -3 and numbers[-1] > 3


@pytest.mark.parametrize("power", [0.5, 1.0, 2.3])
def test_roots_of_a_sine_rest_a_hinge_at_each(power):
    """|sin y|^p with the sign of sin y, and without: y = 0 and pi."""
    for start in (0.4, 0.0, 2.0):
        signed = on_hinge(lambda q: -(abs(np.sin(q - 0.4)) ** power) * np.sign(np.sin(q - 0.4)), start)
        same(signed, [(0.4 - math.pi, False), (0.4, True)])
        same(on_hinge(lambda q: abs(np.sin(q - 0.4)) ** power, start), [(0.4 - math.pi, False), (0.4, False)])


@pytest.mark.parametrize("power", [9, 15, 16, 17, 18, 19, 20, 21])
def test_a_zero_of_any_order_is_a_rest(power):
    """-x^n brings back for odd n, whatever the order, which series of twenty terms do not have to reach."""
    for start in (0.1, 3.0, 0.0):
        same(on_slide(lambda x: -(x**power), start), [(0.0, power % 2 == 1)], 1e-6)


@pytest.mark.parametrize("steep", [1e2, 1e4, 1e6, 1e9])
def test_a_steep_step_hides_nothing_beyond_it(steep):
    """tanh(k (x - 0.3)) - x / 2 is -1 - x / 2 below the step and 1 - x / 2 above it: -2, in the step, 2."""
    for start in (0.1, 0.0, 1.5):
        found = on_slide(lambda x: np.tanh(steep * (x - 0.3)) - 0.5 * x, start)
        inside = 0.3 + math.atanh(0.15) / steep
        same(found, [(-2, True), (inside, False), (2, True)], 1e-3 / steep + 1e-12)
