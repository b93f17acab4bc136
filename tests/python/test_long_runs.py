"""Short forms of the runs over a million periods: tests/random/long_runs.py has all of it.

RBDYN_TEST_PERIODS: how many periods of each (300).
"""

import importlib.util
import os
import sys
from pathlib import Path

import pytest

PERIODS = int(os.environ.get("RBDYN_TEST_PERIODS", "300"))
path = Path(__file__).parents[1] / "random" / "long_runs.py"
spec = importlib.util.spec_from_file_location("long_runs", path)
long_runs = importlib.util.module_from_spec(spec)
# dataclasses look for the module that they are of
sys.modules["long_runs"] = long_runs
spec.loader.exec_module(long_runs)

# of the phase after n periods [rad]: what is held leaves roundings that add up as n^1.5 at most, rolling is not held
ALLOWED = {"rolling disc": 1e-9}


@pytest.mark.parametrize("name", long_runs.MOTIONS)
def test_phases_and_first_integrals_stay(name):
    found = long_runs.measured(name, PERIODS)
    # more are taken where rounding says how long they are: of the disc, whose centre has no motion but that
    assert found["periods"] == PERIODS and 2 * PERIODS < found["steps"] < 100 * PERIODS
    if found["phase"] is not None:
        assert abs(found["phase"]) < ALLOWED.get(name, 1e-15 * PERIODS**1.5), found
    # energy of the linkage, the double pendulum and the spring is not held, but lost by roundings
    held = name in ("pendulum", "free body", "symmetric top")
    if found["integral"]:
        assert found["drift"] < (2e-15 if held else 2e-15 * PERIODS), found
    assert long_runs.line(name, found).startswith(f"| {name} | {PERIODS} | ")


def test_as_many_periods_as_there_is_time_for():
    motion = long_runs.four_bar()
    assert long_runs.as_many(motion, 10, 60.0) == 10
    few = long_runs.as_many(motion, 10**9, 0.2)
    assert 10 <= few < 10**5 and set(str(few)[1:]) == {"0"}
