"""Random mechanisms told in another order, from another place, in two parts and from another body: the same motion.

RBDYN_TEST_MECHANISMS: how many of each (8); all of it is tests/random/mechanisms.py.
"""

import importlib.util
import os
from pathlib import Path

import pytest

SCENES = int(os.environ.get("RBDYN_TEST_MECHANISMS", "8"))
path = Path(__file__).parents[1] / "random" / "mechanisms.py"
spec = importlib.util.spec_from_file_location("mechanisms", path)
mechanisms = importlib.util.module_from_spec(spec)
spec.loader.exec_module(mechanisms)


@pytest.mark.parametrize("kind", mechanisms.KINDS)
def test_told_otherwise_it_moves_alike(kind):
    compared = 0
    for seed in range(SCENES):
        found = mechanisms.compare(seed, kind)
        if isinstance(found, str):
            continue
        compared += 1
        for what, value in found.items():
            assert value <= mechanisms.ALLOWED.get(what, 0.0), (kind, seed, what, value)
    assert compared >= SCENES // 2
