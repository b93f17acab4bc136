"""Motions that rest for long and move at once: what is told of them is told of the short phases, too."""

import functools

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp


def van_der_pol(mu):
    return lambda t, x: [x[1], mu * (1 - x[0] ** 2) * x[1] - x[0]]


def oregonator(t, y):
    return [
        77.27 * (y[1] + y[0] * (1 - 8.375e-6 * y[0] - y[1])),
        (y[2] - (1 + y[0]) * y[1]) / 77.27,
        0.161 * (y[0] - y[2]),
    ]


# the law, where it starts, and its end
SYSTEMS = {
    "van der Pol, mu 1000": (van_der_pol(1000.0), [2.0, 0.0], 1000.0),
    "van der Pol, mu 300": (van_der_pol(300.0), [2.0, 0.0], 500.0),
    "van der Pol, mu 50": (van_der_pol(50.0), [2.0, 0.0], 200.0),
    "Oregonator": (oregonator, [1.0, 2.0, 3.0], 360.0),
}


@functools.cache
def truth(name):
    """SciPy's Radau: at its own steps, which are many where the motion is quick, and in between."""
    law, start, until = SYSTEMS[name]
    x = solve_ivp(law, (0, until), start, method="Radau", rtol=1e-10, atol=1e-13, dense_output=True)
    times = np.union1d(np.linspace(0, until, 2001), x.t[::3])
    return times, x.sol(times).T


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("engine", ["auto", "cvode-bdf"])
@pytest.mark.parametrize("error", [1e-3, 1e-5])
def test_short_phases_are_within_the_error_that_is_told(name, engine, error):
    times, x = truth(name)
    law, start, until = SYSTEMS[name]
    run = rb.simulate(rb.System(law, start), until, error=error, engine=engine)
    off = (abs(run.x(times) - x) / abs(x).max(axis=0)).max()
    # the truth itself is known to 1e-8
    assert off <= run.error + 2e-8 and run.error <= error


def test_their_prices_are_told_with_the_errors_of_short_phases():
    name = "van der Pol, mu 1000"
    times, x = truth(name)
    law, start, until = SYSTEMS[name]
    system = rb.System(law, start)
    price = rb.cost(system, until, budget=3.0)
    rows = [row for row in price.rows if row.engine in ("cvode-bdf", "auto") and row.error > 1e-7]
    assert len(rows) > 5
    for row in rows:
        run = rb.simulate(system, until, rtol=row.tolerance, engine=row.engine)
        off = (abs(run.x(times) - x) / abs(x).max(axis=0)).max()
        # of what differs as much as it can, how much is chance
        assert min(off, 1.0) <= 10.0 * row.error
