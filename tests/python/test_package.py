"""The package itself: it imports, knows its version, and carries stubs that are up to date."""

import importlib.metadata
import importlib.resources
import pydoc
import runpy
import subprocess
import sys

import pytest
import rbdyn


def test_the_version_is_that_of_the_distribution():
    assert rbdyn.__version__ == importlib.metadata.version("rbdyn")


def test_every_public_name_exists():
    assert [name for name in rbdyn.__all__ if not hasattr(rbdyn, name)] == []


def test_the_types_are_installed():
    files = {file.name for file in importlib.resources.files(rbdyn).iterdir()}
    assert {"py.typed", "_core.pyi"} <= files


def test_python_runs_the_package_as_the_command_line():
    for arguments, code, said in (
        (["--version"], 0, f"rbdyn {rbdyn.__version__}\n"),
        ([], 2, "rbdyn: the following arguments are required: COMMAND; rbdyn --help says more\n"),
    ):
        done = subprocess.run([sys.executable, "-m", "rbdyn", *arguments], capture_output=True, text=True)
        assert (done.returncode, done.stdout + done.stderr) == (code, said)


def test_the_engines_of_the_build_are_told_and_listed_in_errors():
    engines = rbdyn.engines()
    assert engines[:3] == ["closed form", "taylor", "dop853"]
    assert engines[3:] in ([], ["cvode-adams", "cvode-bdf"])
    scene = rbdyn.Scene()
    ball = scene.add(rbdyn.Particle(1.0))
    listed = f'engine is "rk4"; this build has {", ".join(["auto", *engines])}$'
    vary = {(ball, "velocity"): [[1.0, 0.0, 0.0]]}
    for call in (
        lambda: rbdyn.simulate(scene, 1.0, engine="rk4"),
        lambda: rbdyn.simulate(rbdyn.System(lambda t, x: [1.0], [0.0]), 1.0, engine="rk4"),
        lambda: rbdyn.simulate(
            rbdyn.EulerTop(rbdyn.shapes.box(1.0, [1, 1, 2]), 9.81), [0, 0, 1, 0, 0, 1], 1.0, engine="rk4"
        ),
        lambda: rbdyn.cost(scene, 1.0, engines=["rk4"]),
        lambda: rbdyn.effects(scene, 1.0, engine="rk4"),
        lambda: rbdyn.simulate_many(scene, vary, 1.0, engine="rk4"),
    ):
        with pytest.raises(rbdyn.InvalidInput, match=listed):
            call()


@pytest.mark.skipif("cvode-bdf" in rbdyn.engines(), reason="this build has SUNDIALS")
def test_a_build_without_sundials_says_so_and_how_to_get_it():
    scene = rbdyn.Scene()
    scene.add(rbdyn.Particle(1.0))
    with pytest.raises(rbdyn.InvalidInput, match="need SUNDIALS.*libsundials-dev.*-DRBDYN_SUNDIALS=ON"):
        rbdyn.simulate(scene, 1.0, engine="cvode-bdf")
    assert ("cvode-adams, cvode-bdf", "this build of rbdyn is without SUNDIALS") in [
        (o.what, o.why) for o in rbdyn.plan(scene).omissions
    ]


def test_help_is_in_the_words_of_the_field():
    for name in ("simulate", "plan", "cost", "equilibria", "parameter"):
        text = pydoc.plain(pydoc.render_doc(getattr(rbdyn, name)))
        assert text.startswith(f"Python Library Documentation: function {name} in module rbdyn\n\n{name}(")
        for word in ("pybind11", "typing.", "_core", "*args", "Overloaded"):
            assert word not in text, f"help({name}) has {word}"
    text = pydoc.plain(pydoc.render_doc(rbdyn.Trajectory.energy))
    assert "typing." not in text and "_core.Trajectory" not in text.partition("\n\n")[2].partition("\n")[2]


def test_the_stubs_are_up_to_date(root):
    committed = (root / "python" / "rbdyn" / "_core.pyi").read_text()
    generated = runpy.run_path(str(root / "bindings" / "stubs.py"))["generated"]()
    assert generated == committed, "the module has changed since its stubs were written: ./run stubs"
