"""What all Python tests share."""

import os
from pathlib import Path

import pytest

# figures are drawn to files, never to a screen
os.environ.setdefault("MPLBACKEND", "Agg")


@pytest.fixture(scope="session")
def root() -> Path:
    """The folder of the project."""
    return Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def reference(root: Path) -> Path:
    """The folder of the reference solutions."""
    return root / "tests" / "reference"
