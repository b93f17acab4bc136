"""Watched functions with poles, corners, infinite slopes and ends: a few of those of tests/random."""

import importlib.util
from pathlib import Path

import pytest


@pytest.fixture(scope="module")
def rough_watches():
    path = Path(__file__).parents[1] / "random" / "rough_watches.py"
    spec = importlib.util.spec_from_file_location("rough_watches", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.cvode
def test_of_functions_with_poles_and_ends_every_root_is_found_and_nothing_else(rough_watches):
    assert [message for seed in range(60) if (message := rough_watches.check(seed))] == []
