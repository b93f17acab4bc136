"""The command line: what each command prints, JSON, files written, and exit codes with errors of one line."""

import importlib.metadata
import json
import os
import signal
import subprocess
import sys
import time
import warnings

import pytest
import rbdyn as rb
from rbdyn.command_line import COMMANDS, main

HOOP = """
import rbdyn as rb

scene = rb.Scene(gravity=[0, 0, -9.81])
circle = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0])
hoop = rb.Rail(circle, friction=rb.Coulomb(mu_static=0.4, mu_dynamic=0.1))
bead = scene.add(rb.Particle(mass=0.5), hoop, parameter=0.0, speed=7.0, name="bead")
"""


@pytest.fixture
def hoop(tmp_path):
    """A Python file that builds a scene, and prints."""
    path = tmp_path / "hoop.py"
    path.write_text(HOOP + 'print("a word of the file\'s own")\n')
    return str(path)


@pytest.fixture
def said(capsys):
    """What a command line printed: (code, stdout, stderr)."""

    def run(*arguments):
        code = main([str(a) for a in arguments])
        out, err = capsys.readouterr()
        return code, out, err

    return run


def line_of(err):
    """The only line of stderr."""
    (line,) = err.splitlines()
    return line


def scene_of_hoop():
    names = {}
    exec(HOOP, names)
    return names["scene"]


# --- run ---


def test_run_tells_events_and_where_the_motion_ends(hoop, said):
    code, out, err = said("run", hoop, "--until", 6, "--error", 1e-10)
    run = rb.simulate(scene_of_hoop(), 6.0, error=1e-10)
    assert code == 0 and out.startswith("Run: reached end at t = 6 s")
    assert [str(event) for event in run.events] == [line.strip() for line in out.splitlines() if "(bead)" in line]
    assert "bead: parameter" in out
    # what the file prints is not in the way
    assert err == "a word of the file's own\n"


def test_run_gives_json_that_programs_read(hoop, said):
    code, out, _ = said("run", hoop, "--until", 2, "--error", 1e-10, "--json")
    data = json.loads(out)
    run = rb.simulate(scene_of_hoop(), 2.0, error=1e-10)
    assert code == 0 and data["status"] == "reached end" and data["engine"] == "taylor"
    assert [event["time"] for event in data["events"]] == [event.time for event in run.events]
    assert data["at_end"]["bead"]["position"] == run["bead"].position(2.0).tolist()
    assert data["error"] == run.error and data["statistics"]["steps"] == run.statistics.steps


def test_a_run_is_saved_and_gone_on_with(hoop, said, tmp_path):
    first, table, figure = tmp_path / "a.npz", tmp_path / "a.csv", tmp_path / "a.svg"
    assert said("run", hoop, "--until", 1, "--save", first, "--save", table, "--plot", figure)[0] == 0
    assert rb.load(first).end == 1.0
    assert table.read_text().startswith("t [s],bead.position.x [m]")
    assert figure.stat().st_size > 10_000
    code, out, _ = said("run", first, "--until", 2, "--json")
    data = json.loads(out)
    assert code == 0 and (data["start"], data["end"]) == (1.0, 2.0)
    code, _, err = said("run", first, "--until", 2, "--start", 0.5)
    assert code == 2 and "goes on from its end, t = 1.0 s" in line_of(err)


def test_a_scene_file_is_run_like_the_scene(said, tmp_path):
    path = tmp_path / "hoop.json"
    rb.save(scene_of_hoop(), path)
    code, out, _ = said("run", path, "--until", 2, "--json", "--engine", "dop853")
    assert code == 0 and json.loads(out)["engine"] == "dop853"


def test_a_python_file_may_name_the_end(said, tmp_path):
    path = tmp_path / "hoop.py"
    path.write_text(HOOP + "until = 1.5\n")
    assert json.loads(said("run", path, "--json")[1])["end"] == 1.5
    # what is asked for counts more
    assert json.loads(said("run", path, "--json", "--until", 0.5)[1])["end"] == 0.5


def test_what_is_below_main_is_not_run_and_neighbours_are_imported(said, tmp_path):
    (tmp_path / "neighbour_of_main.py").write_text("MASS = 0.5\n")
    path = tmp_path / "guarded.py"
    path.write_text(
        "import rbdyn as rb\nfrom neighbour_of_main import MASS\nscene = rb.Scene()\n"
        "scene.add(rb.Particle(MASS), velocity=[1, 0, 0])\n"
        "if __name__ == '__main__':\n    raise SystemExit('run')\n"
    )
    before = list(sys.path)
    assert said("run", path, "--until", 1)[0] == 0
    assert sys.path == before


def test_a_motion_that_is_not_as_accurate_as_asked_is_shown_and_saved_all_the_same(said, tmp_path):
    path, kept = tmp_path / "x.py", tmp_path / "x.npz"
    path.write_text(
        "import numpy as np\nimport rbdyn as rb\nscene = rb.Scene()\n"
        "ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])\n"
        "scene.apply(rb.Force(lambda t, r, v: [r[0] ** 2, 0, 0]), ball)\n"
    )
    code, out, err = said("run", path, "--until", 10, "--save", kept, "--json")
    assert code == 1 and "not finite" in line_of(err)
    assert json.loads(out)["status"] == "not finite" and rb.load(kept).status == "not finite"


# --- plan, cost, effects ---


def test_plan_prints_the_plan(hoop, said):
    code, out, _ = said("plan", hoop)
    assert code == 0 and out == str(rb.plan(scene_of_hoop())) + "\n"
    data = json.loads(said("plan", hoop, "--json")[1])
    plan = rb.plan(scene_of_hoop())
    assert data["effects"] == plan.effects and data["size"]["variables"] == plan.size.variables
    assert [one["what"] for one in data["omissions"]] == [one.what for one in plan.omissions]


def test_cost_prints_the_list_and_predicts(hoop, said, tmp_path):
    figure = tmp_path / "cost.png"
    options = ["--until", 1, "--errors", 1e-4, 1e-8, "--engines", "taylor", "dop853", "--budget", 1, "--plot", figure]
    code, out, _ = said("cost", hoop, *options, "--predict", 1e-6)
    assert code == 0 and out.startswith("engine") and "error 1e-06: " in out and figure.stat().st_size > 10_000
    data = json.loads(said("cost", hoop, *options, "--predict", 1e-6, "--json")[1])
    assert {row["engine"] for row in data["rows"]} == {"taylor", "dop853"}
    assert min(row["error"] for row in data["rows"]) <= 1e-8
    (prediction,) = data["predictions"]
    assert prediction["error"] == 1e-6 and prediction["seconds"] > 0
    # one that nothing reaches leaves the others and the list
    code, out, _ = said("cost", hoop, *options, "--predict", 1e-6, 1e-30, "--json")
    reached, refused = json.loads(out)["predictions"]
    assert code == 2 and reached["seconds"] > 0 and refused["error"] == 1e-30 and "1e-30" in refused["refused"]


def test_effects_prints_the_table(hoop, said):
    code, out, _ = said("effects", hoop, "--until", 2)
    assert code == 0 and out.startswith("without") and "gravity" in out
    data = json.loads(said("effects", hoop, "--until", 2, "--json")[1])
    table = rb.effects(scene_of_hoop(), 2.0)
    assert [(row["effect"], row["lost"]) for row in data["rows"]] == [(row.effect, row.lost) for row in table]


# --- what goes wrong, in one line ---


@pytest.mark.parametrize(
    ("content", "code", "message"),
    [
        ("x = 1\n", 2, "builds no `scene`; assign an rbdyn.Scene"),
        ("scene = 3\n", 2, "`scene` is 3, no Scene"),
        ("x = 1\ny = 1 / 0\n", 3, "line 2: ZeroDivisionError: division by zero"),
        ("def f(:\n", 3, "line 1: SyntaxError"),
        ("raise SystemExit(5)\n", 3, "line 1: SystemExit: 5"),
        ("import rbdyn as rb\nscene = rb.Scene()\nscene.add(rb.Particle(-1.0))\n", 2, "line 3: Particle: mass is -1"),
        ("import rbdyn as rb\nscene = rb.Scene()\n", 2, "Scene: it has 0 bodies"),
        ("import rbdyn as rb\nscene = rb.Scene()\nuntil = 'noon'\n", 2, "`until` is 'noon'"),
    ],
)
def test_a_python_file_that_is_none_is_named_with_its_line(content, code, message, said, tmp_path):
    path = tmp_path / "wrong.py"
    path.write_text(content)
    until = () if "noon" in content else ("--until", 1)
    found, out, err = said("run", path, *until)
    assert (found, out) == (code, "") and message in line_of(err)
    assert err.startswith("rbdyn: ")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "nowhere.py", "--until", "1"], "nowhere.py: there is no such file"),
        (["run", "nowhere.json", "--until", "1"], "cannot be read"),
        (["run", "nowhere", "--until", "1"], "it has no suffix"),
        (["plan", "nowhere.txt"], "nowhere.txt: it ends in '.txt'; give a file that ends in .py, .json, .npz"),
        (["run", "HOOP"], "give --until T"),
        (["run", "HOOP", "--until", "-1"], "until is -1"),
        (["run", "HOOP", "--until", "soon"], "invalid float value: 'soon'"),
        (["run", "HOOP", "--until", "1", "--error", "1e-3", "--rtol", "1e-3"], "both error 0.001 and rtol 0.001"),
        (["run", "HOOP", "--until", "1", "--engine", "euler"], 'engine is "euler"'),
        (["run", "HOOP", "--until", "1", "--save", "run.txt"], "--save run.txt"),
        (
            ["run", "HOOP", "--until", "1", "--max-steps", "99999999999999999999"],
            "argument --max-steps: 99999999999999999999 is out of range; it is a whole number below 2**63",
        ),
        (["run", "HOOP", "--until", "1", "--max-steps", "1.5"], "invalid int value: '1.5'"),
        (
            ["run", "HOOP", "--until", "1", "--save", "nowhere/a.npz"],
            "--save nowhere/a.npz: there is no folder",
        ),
        (
            ["run", "HOOP", "--until", "1", "--plot", "nowhere/a.png"],
            "--plot nowhere/a.png: there is no folder",
        ),
        (["run", "HOOP", "--until", "1", "--keep", "end", "--plot", "a.png"], "--plot: a figure shows the motion"),
        (["run", "HOOP", "--until", "1", "--plot", "a.foo"], "--plot a.foo: a picture is written to"),
        (["cost", "HOOP", "--until", "1", "--plot", "nowhere/a.png"], "there is no folder 'nowhere'"),
        (["view", "HOOP", "--until", "1", "--output", "nowhere/a.html"], "--output nowhere/a.html: there is no folder"),
        (["verify", "--figure", "a.foo"], "--figure a.foo: a picture is written to"),
        (["verify", "--figure", "nowhere/a.png"], "--figure nowhere/a.png: there is no folder"),
        (["cost", "HOOP", "--until", "1", "--budget", "0"], "budget is 0"),
        (["fly", "HOOP"], "invalid choice: 'fly'"),
        ([], "required: COMMAND"),
    ],
)
def test_a_command_line_that_breaks_a_rule_is_refused(arguments, message, hoop, said):
    code, out, err = said(*[hoop if a == "HOOP" else a for a in arguments])
    assert (code, out) == (2, "")
    assert message in err.splitlines()[-1] and len(err.replace("a word of the file's own\n", "").splitlines()) == 1


MINE = """
import math
import rbdyn as rb

scene = rb.Scene()
ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], name="ball")


def pull(t, r, v):
    if t > 0.5:
        raise RuntimeError("mine")
    return [-math.sin(r[0]), 0, 0]


scene.apply(rb.Force(pull), ball)
"""


@pytest.mark.parametrize("command", ["run", "cost", "effects", "view"])
def test_what_a_function_raises_while_it_is_called_back_is_the_files_own_exception(command, said, tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(MINE)
    output = ("--output", tmp_path / "a.html") if command == "view" else ()
    code, _, err = said(command, path, "--until", 3, *output)
    assert (code, line_of(err)) == (3, f"rbdyn: {path}, line 11: RuntimeError: mine")


def test_what_there_was_when_a_function_raised_is_shown_and_saved(said, tmp_path):
    path, table = tmp_path / "mine.py", tmp_path / "a.csv"
    path.write_text(MINE)
    code, out, err = said("run", path, "--until", 3, "--rtol", 1e-6, "--save", table, "--json")
    shown = json.loads(out)
    assert code == 3 and shown["status"] == "stopped by user" and "mine" in line_of(err)
    last = table.read_text().splitlines()[-1].split(",")
    assert [float(x) for x in last[:4]] == [shown["end"], *shown["at_end"]["ball"]["position"]]


def test_what_no_file_takes_is_refused_before_it_is_run(said, tmp_path):
    path, kept = tmp_path / "mine.py", tmp_path / "a.npz"
    path.write_text(MINE)
    # it would raise of itself where it is run
    code, out, err = said("run", path, "--until", 3, "--save", kept)
    assert (code, out) == (2, "") and 'function "pull" is called back' in line_of(err) and not kept.exists()


@pytest.mark.filterwarnings("always")
def test_a_warning_is_one_line_without_a_source(hoop, said, monkeypatch):
    def warned(*arguments, **options):
        warnings.warn("a run that would need 9 GB", RuntimeWarning, stacklevel=2)
        return rb.simulate(*arguments, **options)

    monkeypatch.setattr("rbdyn.command_line.run.simulate", warned)
    code, _, err = said("run", hoop, "--until", 1)
    assert code == 0 and err.splitlines()[1:] == ["rbdyn: warning: a run that would need 9 GB"]


def test_a_run_is_no_scene_for_plan(hoop, said, tmp_path):
    kept = tmp_path / "a.npz"
    said("run", hoop, "--until", 1, "--save", kept)
    code, _, err = said("plan", kept)
    assert code == 2 and "it has a run, and this command takes a scene" in line_of(err)


def test_help_lists_commands_and_exit_codes(said):
    code, out, _ = said("--help")
    assert code == 0 and all(f"\n    {name} " in out for name in COMMANDS) and "130  interrupted" in out
    assert said("--version") == (0, f"rbdyn {rb.__version__}\n", "")


# --- as a process ---


def start(*arguments, **options):
    command = [sys.executable, "-m", "rbdyn", *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)


def test_the_program_is_the_module(hoop):
    process = start("run", hoop, "--until", 1)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 0 and out.startswith("Run: reached end")


def test_the_program_is_installed():
    (script,) = [one for one in importlib.metadata.entry_points(group="console_scripts") if one.name == "rbdyn"]
    assert script.load() is main


def test_an_interruption_shows_what_there_is(tmp_path):
    path, kept = tmp_path / "endless.py", tmp_path / "part.npz"
    path.write_text(
        "import rbdyn as rb\nscene = rb.Scene()\nball = scene.add(rb.Particle(1.0), position=[1, 0, 0])\n"
        "scene.connect(rb.Spring(4.0, rest_length=0.5), ball, [0, 0, 0])\nprint('read')\n"
    )
    process = start("run", path, "--until", 1e12, "--rtol", 1e-12, "--keep", "end", "--save", kept, "--json")
    assert process.stderr.readline() == "read\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130 and line_of(err) == "rbdyn: interrupted"
    data = json.loads(out)
    assert data["status"] == "stopped by user" and 0 < data["end"] < 1e12 and rb.load(kept).end == data["end"]


def test_a_reader_that_has_enough_is_no_error(hoop):
    read, write = os.pipe()
    os.close(read)
    process = subprocess.run(
        [sys.executable, "-m", "rbdyn", "plan", hoop], stdout=write, stderr=subprocess.PIPE, text=True, timeout=60
    )
    os.close(write)
    assert (process.returncode, process.stderr) == (0, "a word of the file's own\n")
