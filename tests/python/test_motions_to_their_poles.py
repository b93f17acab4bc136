"""What is told of a motion that ends just before its pole, where rounding has grown ten million times.

x' = x^p from 1 is (1 - (p - 1) t)^(-1 / (p - 1)): how far a value is from it is told by the time at which it is
reached, in fractions of whole numbers. A rounding early on is as much of the time, and near the pole that is what
counts: two runs may come near each other by chance where both are far from the truth.
"""

from fractions import Fraction

import numpy as np
import pytest
import rbdyn as rb


def off(value, power, end):
    """How far a value at a time is from the truth, beside it: to first order in the time that it is too early."""
    reached = (1 - 1 / Fraction(value) ** (power - 1)) / (power - 1)
    left = Fraction(1, power - 1) - Fraction(end)
    return abs(float((reached - Fraction(end)) / left)) / (power - 1)


def ended(power, end, error, engine):
    system = rb.System(lambda t, x: [x[0] ** power], [1.0])
    try:
        run = rb.simulate(system, end, error=error, engine=engine)
    except rb.AccuracyError:
        return None
    return run.error, off(float(run.x(end)[0]), power, end)


# two runs agreed a hundred times better than either with the truth
BY_CHANCE = [
    (2, 0.999999974175792, 5.420376594425639e-10, "dop853"),
    (3, 0.49999997825542686, 1.2827840611031019e-09, "dop853"),
    (4, 0.333332860906781, 1.6973199738131996e-09, "dop853"),
    (3, 0.4999979835158277, 2.487144840114131e-10, "auto"),
    (3, 0.4999998334316715, 2.2753252778539696e-10, "auto"),
]


@pytest.mark.parametrize("power, end, error, engine", BY_CHANCE)
def test_two_runs_that_agree_by_chance_are_no_proof(power, end, error, engine):
    result = ended(power, end, error, engine)
    assert result is None or result[1] <= 3 * result[0]


@pytest.mark.parametrize("engine", ["auto", "dop853"])
def test_nothing_is_told_that_is_not_so(engine):
    rng = np.random.default_rng(11)
    returned = 0
    for _ in range(150):
        power = int(rng.integers(2, 5))
        end = 1 / (power - 1) - 10 ** rng.uniform(-8, -2)
        result = ended(power, end, 10 ** rng.uniform(-10, -6), engine)
        if result is not None:
            returned += 1
            assert result[1] <= 3 * result[0], (power, end)
    assert returned > 100
