"""What the package says of itself: types for checkers, signatures, docstrings."""

import importlib.util
import inspect
import json
import shutil
import subprocess
import sys

import numpy as np
import pytest
import rbdyn as rb


def members(owner):
    """The public names of a module or class and what they are, classes of the package with their own."""
    for name, thing in vars(owner).items():
        if name.startswith("_") or inspect.ismodule(thing):
            continue
        yield f"{owner.__name__}.{name}", thing
        if inspect.isclass(thing) and thing.__module__.startswith("rbdyn"):
            yield from members(thing)


def public():
    for name in rb.__all__:
        thing = getattr(rb, name)
        if name.startswith("_") or inspect.ismodule(thing):
            continue
        yield name, thing
        if inspect.isclass(thing):
            yield from members(thing)
    yield from members(rb.shapes)


def is_function(thing):
    return callable(thing) and not inspect.isclass(thing)


def test_every_function_and_method_has_a_signature():
    for name, thing in public():
        if is_function(thing):
            signature = inspect.signature(thing)
            assert "args" not in signature.parameters or name.endswith(("without", "register")), (name, signature)


def test_signatures_are_those_of_the_verbs():
    assert str(inspect.signature(rb.simulate)) == (
        "(scene, until, *, start=0.0, error=None, rtol=None, engine='auto', keep='all', max_steps=100000000, "
        "progress=False, initial=None, events='all')"
    )
    assert str(inspect.signature(rb.simulate_many)).startswith(
        "(scene: 'Scene', vary: 'Mapping[Any, Any]', until: 'float', *, start: 'float' = 0.0"
    )
    assert str(inspect.signature(rb.Scene.watch)) == (
        "(self, name, function, *, direction='either', action='record', trace=None)"
    )
    assert list(inspect.signature(rb.Scene().add).parameters) == ["body", "joint", "parent", "name", "kwargs"]
    assert str(inspect.signature(rb.Spring)) == "(stiffness, rest_length=0.0, damping=0.0)"
    assert str(inspect.signature(rb.shapes.rod)) == "(mass, length, along)"
    for verb in (rb.plan, rb.cost, rb.effects, rb.equilibria, rb.rail_potential, rb.parameter, rb.where):
        assert inspect.signature(verb).parameters


def test_docstrings_are_still_there():
    assert rb.simulate.__doc__.startswith("1. simulate(") and "global" in rb.simulate.__doc__
    assert "Adds a body" in rb.Scene.add.__doc__


def test_every_public_member_has_a_docstring():
    bare = []
    for name, thing in public():
        if isinstance(thing, (int, float, str, tuple)):
            continue
        doc = (inspect.getdoc(thing) or "").strip()
        # what pybind11 writes by itself is a line with the signature
        says = doc.partition("\n\n")[2] if doc.startswith(name.rpartition(".")[2] + "(") else doc
        if not says:
            bare.append(name)
    assert bare == []


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
def test_the_examples_and_the_package_pass_mypy_in_strict_mode(root, tmp_path):
    examples = sorted((root / "examples").glob("*.py"))
    assert len(examples) > 8
    # one module a run: each of them is a program
    checked = [["-p", "rbdyn"], *([str(path)] for path in examples)]
    for what in checked:
        done = subprocess.run(
            [sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path / "cache", *what],
            capture_output=True,
            text=True,
            cwd=tmp_path,
        )
        assert done.returncode == 0, f"{what}: {done.stdout}"


@pytest.mark.skipif(importlib.util.find_spec("pyright") is None, reason="pyright is not installed")
def test_the_examples_pass_pyright_in_strict_mode(root, tmp_path):
    # copied, for pyright takes no files from outside of its settings' folder, and finds no mistake in none
    examples = sorted((root / "examples").glob("*.py"))
    for path in examples:
        shutil.copy(path, tmp_path)
    settings = {"typeCheckingMode": "strict", "include": [path.name for path in examples]}
    # of an argument of any type NumPy 2.5 says nothing about the type of linalg.norm, which the examples give back
    if tuple(int(part) for part in np.__version__.split(".")[:2]) >= (2, 5):
        settings |= {"reportUnknownLambdaType": False, "reportUnknownVariableType": False}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings))
    done = subprocess.run(
        [sys.executable, "-m", "pyright", "--outputjson", "--pythonpath", sys.executable],
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    said = json.loads(done.stdout)
    assert said["summary"]["filesAnalyzed"] == len(examples), done.stdout + done.stderr
    assert said["generalDiagnostics"] == [] and done.returncode == 0, done.stdout


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
def test_types_tell_one_time_from_several_and_words_from_others(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(
        "import numpy as np\n"
        "import rbdyn as rb\n"
        "scene = rb.Scene()\n"
        "ball = scene.add(rb.Particle(1.0))\n"
        "k = rb.parameter(1.0)\n"
        "scene.apply(rb.Force([k, 0, 0]), ball)\n"
        "scene.apply(rb.Drag(k), ball)\n"
        "spring = scene.connect(rb.Spring(k), ball, [0, 0, 0])\n"
        "run = rb.simulate(scene, 1.0)\n"
        "reveal_type(run[spring].length(0.5))\n"
        "reveal_type(run[spring].length(np.linspace(0, 1, 3)))\n"
        "reveal_type(run.energy([0.0, 1.0]))\n"
        'rb.simulate(scene, 1.0, engine="tailor")\n'
        'scene.watch("w", lambda now: now[ball].position[2], direction="up")\n'
        "scene.apply(rb.Drag(0.1), spring)\n"
        'rb.simulate(scene, 1.0, initial={(ball, "position"): [1, 0, 0], ("ball", "velocity"): np.ones(3)})\n'
        'handles, names = {(ball, "position"): np.ones(3)}, {("ball", "position"): np.ones(3)}\n'
        "rb.simulate(scene, 1.0, initial=handles)\n"
        "rb.simulate(scene, 1.0, initial=names)\n"
        'wrong = {"ball": np.ones(3)}\n'
        "rb.simulate(scene, 1.0, initial=wrong)\n"
        "one, other = (scene.add(rb.RigidBody(1.0, [1, 1, 1])) for _ in range(2))\n"
        "scene.constrain(rb.Ball(), one.point([1, 0, 0]), other)\n"
        "scene.constrain(rb.Rod(2.0), ball, np.zeros(3))\n"
        "scene.constrain(rb.Ball(), spring)\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path / "cache", program],
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    lines = [line for line in done.stdout.splitlines() if ": error:" in line or ": note: Revealed" in line]
    numbers = [int(line.split(":")[1]) for line in lines]
    assert numbers == [10, 11, 12, 13, 14, 15, 21, 25], done.stdout
    assert lines[0].endswith('"float"') or lines[0].endswith('"builtins.float"')
    assert all("ndarray" in line for line in lines[1:3])
