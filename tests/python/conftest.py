"""What all Python tests share."""

import os
import signal
import threading
from pathlib import Path

import pytest
import rbdyn
import sizes

# Ctrl-C is tested, also where tests run in the background, which ignores it
signal.signal(signal.SIGINT, signal.default_int_handler)

# figures are drawn to files, never to a screen
os.environ.setdefault("MPLBACKEND", "Agg")


# a test that asks a build without SUNDIALS for CVODE has nothing to say of it
LACK = "need SUNDIALS, without which it was built"
REASON = "cvode-adams and cvode-bdf are not in this build"
# documents and notebooks that show what CVODE does, or the plan of a build that has it
SHOW_CVODE = ("docs/plan.md", "docs/verification.md", "2_top")


def pytest_configure(config):
    config.addinivalue_line("markers", "cvode: counts or compares the engines by CVODE with others")
    config.addinivalue_line("markers", "alone: spends a budget of time, and has no other tests beside it")


def pytest_collection_modifyitems(items):
    if "cvode-bdf" in rbdyn.engines():
        return
    for item in items:
        if item.get_closest_marker("cvode") or item.name.partition("[")[2].removesuffix("]") in SHOW_CVODE:
            item.add_marker(pytest.mark.skip(reason=REASON))


def skip_without_cvode(outcome):
    error = outcome.excinfo and outcome.excinfo[1]
    if "cvode-bdf" not in rbdyn.engines() and isinstance(error, rbdyn.InvalidInput) and LACK in str(error):
        outcome.force_exception(pytest.skip.Exception(REASON, _use_item_location=True))


@pytest.hookimpl(hookwrapper=True)
def pytest_pyfunc_call(pyfuncitem):
    skip_without_cvode((yield))


@pytest.hookimpl(hookwrapper=True)
def pytest_fixture_setup(fixturedef, request):
    skip_without_cvode((yield))


def pytest_sessionfinish(session):
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["sizes"] = (sizes.compared, sizes.skipped)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    """What a process of several (pytest -n) has counted, when it ends."""
    compared, skipped = getattr(node, "workeroutput", {}).get("sizes", (0, 0))
    sizes.compared += compared
    sizes.skipped += skipped


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
