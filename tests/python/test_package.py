"""The package itself: it imports, knows its version, and carries stubs that are up to date."""

import importlib.metadata
import importlib.resources
import runpy

import rbdyn


def test_the_version_is_that_of_the_distribution():
    assert rbdyn.__version__ == importlib.metadata.version("rbdyn")


def test_every_public_name_exists():
    assert [name for name in rbdyn.__all__ if not hasattr(rbdyn, name)] == []


def test_the_types_are_installed():
    files = {file.name for file in importlib.resources.files(rbdyn).iterdir()}
    assert {"py.typed", "_core.pyi"} <= files


def test_the_stubs_are_up_to_date(root):
    committed = (root / "python" / "rbdyn" / "_core.pyi").read_text()
    generated = runpy.run_path(str(root / "bindings" / "stubs.py"))["generated"]()
    assert generated == committed, "the module has changed since its stubs were written: ./run stubs"
