"""What all Python tests share."""

import os
import signal
import threading
from pathlib import Path

import pytest
import sizes

# Ctrl-C is tested, also where tests run in the background, which ignores it
signal.signal(signal.SIGINT, signal.default_int_handler)

# figures are drawn to files, never to a screen
os.environ.setdefault("MPLBACKEND", "Agg")


def pytest_terminal_summary(terminalreporter):
    terminalreporter.write_line(
        f"sizes of {sizes.compared} runs are what their plans say; {sizes.skipped} not compared"
    )


@pytest.fixture(scope="session")
def root() -> Path:
    """The folder of the project."""
    return Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def reference(root: Path) -> Path:
    """The folder of the reference solutions."""
    return root / "tests" / "reference"


@pytest.fixture
def interrupt():
    """Sends SIGINT after a while; Python's own handler, also where the tests were started in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    yield timer.start
    timer.cancel()
    timer.join()
    signal.signal(signal.SIGINT, before)
