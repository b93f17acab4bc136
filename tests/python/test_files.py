"""Scenes and runs as files: equal to the bit when they come back, and errors that say where a file is wrong."""

import copy
import io
import json
import math
import os
import random
import re
import sys
import threading
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
import rbdyn as rb
from test_going_on import SCENES, oscillator, state
from test_pickling import assert_same, hoop, switching

names = pytest.mark.parametrize("scene_of", SCENES, ids=lambda f: f.__name__)


def everything():
    """A scene with one of each."""
    k, mu = rb.parameter(0.1 + 0.2, "k"), rb.parameter(0.3)
    scene = rb.Scene(gravity=[0.1, -0.0, -9.81])
    curves = [
        rb.Line([1, 2, 3], [0.1, 0.2, 0.3]),
        rb.Circle(radius=1 / 3, start=[1, 0, 0], toward=[0, 1, 0.1], center=[0, 0, 1e-300]),
        rb.Parabola(0.3, [1, 0, 0], [0, 0, 1]),
        rb.Cycloid(0.7, [1, 0, 0], [0, 0, 1], vertex=[0, 1, 0]),
        rb.Helix(0.5, -0.1, [1, 0, 0], [0, 1, 0]),
        rb.Polynomial([[0, 0, 0], [1, 0, 0.1], [0, 0.3, 0]], domain=(-2, math.inf)),
        rb.Spline([[0, 0, 0], [1, 0, 0.1], [2, 1, 0], [3, 0, 0]], slopes={0: [1, 0, 0]}),
        rb.Spline([[0, 0, 0], [1, 0, 0.1], [1, 1, 0]], closed=True),
        rb.Curve(lambda u: [u, np.sin(3 * u), 0.2 * u**2], domain=(-4, 4)),
    ]
    beads = []
    for i, curve in enumerate(curves):
        options = [
            {},
            {"friction": rb.Coulomb(0.5, mu)},
            {"drive": lambda t: np.abs(np.sin(t))},
            {"drive": 0.1, "ends": "release"},
            {"motion": lambda t: [0, 0, k * np.sin(t)]},
            {"friction": rb.Coulomb(0.25)},
            {},
            {},
            {},
        ][i]
        beads.append(scene.add(rb.Particle(0.1 * (i + 1)), rb.Rail(curve, **options), arc_length=0.01, speed=1 / 7))
    scene.add(rb.Particle(k), rb.Rail(curves[1], side="+", up=[0, 1, 0]), parameter=1.5, name="one side")
    free = scene.add(rb.shapes.box(1.0, [0.1, 0.2, 0.3]), position=[5, 0, 0], attitude=rb.EulerAngles(0.1, 7.0, -3.0))
    wide = rb.shapes.cylinder(2.0, 0.1, 0.3, [1, 1, 0.3]).shifted([0.1, 0, 0]) + rb.shapes.sphere(1.0, 0.1)
    ball = scene.add(wide, rb.Spherical(at=[0, 3, 0]), attitude=[1, 2, 3, 4] / np.sqrt(30), angular_velocity=[1, 2, 3])
    hinge = scene.add(rb.RigidBody(1.0, [1, 2, 2.5]), rb.Revolute([0, 1, 0.1], at=[7, 0, 0]), angle=0.1, rate=-0.2)
    slide = scene.add(rb.RigidBody(1.0, [1, 2, 2.5]), rb.Prismatic([1, 0, 0], at=[7, 5, 0]), displacement=0.1)
    cross = scene.add(rb.RigidBody(1, [1, 1, 1]), rb.Universal([1, 0, 0], [0, 1, 0]), parent=hinge, angles=[0.1, 0.2])
    drill = scene.add(rb.RigidBody(1, [1, 1, 1]), rb.Cylindrical([0, 0, 1], at=[9, 0, 0]), rate=3.0, displacement=2.0)
    plate = scene.add(rb.RigidBody(1, [1, 1, 1]), rb.Planar([1, 0, 0], [0, 0, 1], at=[11, 0, 0]), position=[0, 1])
    scene.add(rb.RigidBody(1, [1, 1, 1]), rb.Fixed(attitude=rb.EulerAngles(0.3, 0, 0)), parent=plate)
    scene.add(rb.RigidBody(1, [1, 1, 1]), rb.Revolute([0, 0, 1], motion=lambda t: np.sin(t)), parent=drill)
    scene.apply(rb.Force([1, 0, 0]), free, at=[0, 0.1, 0])
    scene.apply(
        rb.Force(lambda t, r, v: [np.where(r[0] > 0, -k * r[0], 0), np.floor(t), np.arctan2(v[1], 2)]), beads[0]
    )
    scene.apply(
        rb.Force(lambda t, r, v: -0.1 * np.linalg.norm(v) * v + np.sqrt(1 + t * t) * np.exp(-r), frame="body"), free
    )
    scene.apply(rb.Potential(lambda r: -((r @ r) ** 0.75) + np.tanh(r[0])), beads[1])
    scene.apply(rb.Lorentz(k, [0, 0, 1]), beads[2])
    scene.apply(rb.Drag(k, 0.2), free)
    scene.apply(rb.Torque(lambda t, r, w: [np.cosh(t), r[0, 1], -w[2]]), ball)
    scene.apply(rb.Torque([0, 0, 1], frame="world"), free)
    scene.apply(rb.TorsionSpring(k, 0.1), hinge)
    scene.apply(rb.JointTorque(k), hinge)
    scene.apply(rb.JointForce(lambda t, q, rate: -q - np.log(2 + rate**2)), slide)
    scene.connect(rb.Spring(k, 0.1, damping=0.3), free.point([0, 0, 0.1]), [0, 0, 1])
    scene.connect(rb.Gravitation(1e-3), free, ball)
    scene.connect(rb.Central(lambda d: -d / (1 + d**3)), beads[0], beads[1])
    spring = scene.connect(rb.PairForce(lambda t, a, b, u, v: (b - a) * k + (v - u) * 0.1), beads[3], free)
    scene.constrain(rb.Rod(2.0), free, [5, 0, 2.0], name="thread")
    scene.constrain(rb.PointOnPlane(rb.Plane([0, 0, 1])), cross.point([0, 0, 0]), name="table")
    scene.contact(free.sphere(0.1), rb.Plane([0, 0, 1], [0, 0, -3]), restitution=0.5, name="floor")
    scene.contact(drill.disc(0.1, [0, 0, 1]), plate.plane([0, 0, 1], [0, 0, -9]))
    scene.contact(plate.ellipsoid([1, 2, 3], attitude=rb.EulerAngles(1, 0, 0)), rb.Plane([0, 1, 0.1], [0, -50, 0]))
    scene.contact(ball.sphere(0.1), free.sphere(0.2))
    scene.contact(ball.point([0, 0, 1]), rb.Sphere([0, 0, 0], 1e4, inside=True))
    scene.watch("high", lambda now: now[free].position[2] - now.time * k, direction="rising")
    scene.watch("taut", lambda now: now[spring].force[0] - now[hinge].angle, action="stop")
    scene.integral("turning", lambda now: now[ball].rotation_matrix[2, 1] + now[ball].quaternion[3])
    return scene


@pytest.mark.parametrize("scene_of", [*SCENES, everything], ids=lambda f: f.__name__)
def test_a_scene_comes_back_equal(scene_of, tmp_path):
    scene, path = scene_of(), tmp_path / "scene.json"
    rb.save(scene, path)
    loaded = rb.load(path)
    assert loaded == scene and rb._core._scene_text(loaded) == path.read_text()
    assert [h.name for h in (*loaded.bodies, *loaded.couplings, *loaded.loads, *loaded.contacts)] == [
        h.name for h in (*scene.bodies, *scene.couplings, *scene.loads, *scene.contacts)
    ]
    assert list(loaded.handles) == list(scene.handles)
    assert np.array_equal(np.signbit(loaded.gravity), np.signbit(scene.gravity))


def test_functions_come_back_that_were_written_before_their_operations_had_names(tmp_path):
    scene = rb.Scene()
    bead = scene.add(rb.Particle(1.0), position=[0.5, 0, 0])
    law = lambda t, r, v: [np.arcsinh(r[0]) - np.log1p(t) + np.expm1(r[0]) * np.arctanh(v[1]), (2 + t) ** r[0], 0]  # noqa: E731
    scene.apply(rb.Force(law), bead)
    text = rb._core._scene_text(scene)
    assert all(f"= {word} n" in text for word in ("arcsinh", "log1p", "expm1", "arctanh"))
    rb.save(scene, tmp_path / "new.json")
    assert rb.load(tmp_path / "new.json") == scene
    # as versions before this one wrote arsinh
    composed = rb.Scene()
    bead = composed.add(rb.Particle(1.0), position=[0.5, 0, 0])
    old = lambda t, r, v: [-np.log(abs(r[0]) + np.sqrt(r[0] * r[0] + 1.0)), 0, 0]  # noqa: E731
    composed.apply(rb.Force(old), bead)
    rb.save(composed, tmp_path / "old.json")
    assert rb.load(tmp_path / "old.json") == composed


@names
def test_a_scene_that_was_read_moves_alike(scene_of, tmp_path):
    rb.save(scene_of(), tmp_path / "scene.json")
    here, there = rb.simulate(scene_of(), until=2.0), rb.simulate(rb.load(tmp_path / "scene.json"), until=2.0)
    assert [e.time for e in here.events] == [e.time for e in there.events] and here.error == there.error
    for t in np.linspace(0, 2, 5):
        assert np.array_equal(state(here, t), state(there, t))


def test_scenes_that_differ_are_not_equal():
    texts = set()
    for scene_of in [*SCENES, everything]:
        texts.add(rb._core._scene_text(scene_of()))
        assert scene_of() == scene_of()
    assert len(texts) == len(SCENES) + 1
    text = rb._core._scene_text(everything())
    for old, new in [
        ("0.30000000000000004", "0.3"),
        ('"rising"', '"falling"'),
        ("1e-300", "0.0"),
        ("n1 * n", "n1 + n"),
    ]:
        assert old in text
        assert rb._core._scene_from(text.replace(old, new, 1), "changed") != everything(), old


def test_a_number_of_the_users_stays_one_number():
    scene = rb._core._scene_from(rb._core._scene_text(everything()), "scene")
    assert {p.name: p.value for p in scene.parameters} == {"k": 0.1 + 0.2, "": 0.3} and len(scene.parameters) == 2
    spring = switching()
    (k,) = spring.parameters
    loaded = rb._core._scene_from(rb._core._scene_text(spring), "scene")
    (other,) = loaded.parameters
    assert other is not k
    other.value = 3.0
    assert loaded != spring
    k.value = 3.0
    assert loaded == spring
    assert np.array_equal(state(rb.simulate(loaded, 1.0), 1.0), state(rb.simulate(spring, 1.0), 1.0))


def test_what_is_called_back_is_refused(tmp_path):
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0))
    scene.apply(rb.Force(lambda t, r, v: [0, 0, 1], trace=False), ball)
    for thing, suffix in ((scene, "json"), (rb.simulate(scene, 1.0), "npz")):
        with pytest.raises(rb.InvalidInput, match="called back .*, and only what is recorded can be saved"):
            rb.save(thing, tmp_path / f"x.{suffix}")
    other = rb.Scene()
    ball = other.add(rb.Particle(1.0))
    other.watch("high", lambda now: now[ball].position[2] - 1, action=lambda now: {ball: {"speed": float(now.time)}})
    with pytest.raises(rb.InvalidInput, match='action of watch "high" is a function that is called back'):
        rb.save(other, tmp_path / "x.json")
    assert not list(tmp_path.iterdir())


def bouncing():
    """A ball that an action sends up again, and another body whose words change with it."""
    kept = rb.parameter(0.75, "kept")
    scene = rb.Scene(gravity=[0, 0, -10])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1], velocity=[1, 0, 0], name="ball")
    wheel = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Revolute([1, 0, 0]), rate=1.0)
    body = scene.add(rb.RigidBody(1.0, [1, 2, 3]), position=[9, 0, 0], angular_velocity=[0, 1, 0])

    def bounce(now):
        velocity = now[ball].velocity
        return {
            ball: {"velocity": [velocity[0], velocity[1], -kept * velocity[2]]},
            wheel: {"rate": now[wheel].rate + np.where(now.time > 1, 0.5, 0.25)},
            body: {"attitude": now[body].quaternion, "angular_velocity": [0, now.time, 1]},
        }

    scene.watch("floor", lambda now: now[ball].position[2], direction="falling", action=bounce)
    return scene


def test_an_action_that_can_be_recorded_is_in_the_file(tmp_path):
    scene = bouncing()
    rb.save(scene, tmp_path / "scene.json")
    loaded = rb.load(tmp_path / "scene.json")
    assert rb._core._scene_text(loaded) == (tmp_path / "scene.json").read_text()
    assert loaded == rb.load(tmp_path / "scene.json")
    # nobody knows what a function does that is called back: it equals none, as files.md says
    assert loaded != scene and copy.deepcopy(scene) != scene
    here, there = rb.simulate(scene, 3.0), rb.simulate(loaded, 3.0)
    assert len(here.events) > 3 and [e.time for e in here.events] == [e.time for e in there.events]
    assert np.array_equal(state(here, 3.0), state(there, 3.0))
    here.save(tmp_path / "run.npz")
    on = rb.simulate(rb.load(tmp_path / "run.npz"), until=3.1)
    assert [e.time for e in on.events] == pytest.approx(
        [e.time for e in rb.simulate(scene, 3.1).events if e.time > 3.0]
    )


@pytest.mark.parametrize(
    "path, value, message",
    [
        (("changes", 0, "word"), "colour", 'an action changes "colour", which no joint has'),
        (("changes", 0, "body"), "nobody", "it is the name of a body"),
        (("function", "results"), ["n0"], "results for what it changes"),
        (("asks",), [], "it has one input for each of the 0 it asks for"),
    ],
)
def test_an_action_in_a_file_is_checked(path, value, message, tmp_path):
    text = changed(rb._core._scene_text(bouncing()), ("watches", 0, "action", *path), value)
    (tmp_path / "x.json").write_text(text)
    with pytest.raises(rb.InvalidInput, match=re.escape(message)):
        rb.load(tmp_path / "x.json")


SCHEMA = Path(__file__).parents[2] / "docs" / "scene.schema.json"


def test_the_schema_is_that_of_the_library():
    # rewritten by: python -c "import rbdyn; print(rbdyn._core._scene_schema(), end='')" > docs/scene.schema.json
    assert SCHEMA.read_text() == rb._core._scene_schema()
    assert rb.scene_schema() == json.loads(SCHEMA.read_text())


@pytest.mark.parametrize("scene_of", [*SCENES, everything, bouncing], ids=lambda f: f.__name__)
def test_scenes_are_as_the_schema_says(scene_of):
    jsonschema = pytest.importorskip("jsonschema")
    validator = jsonschema.Draft202012Validator(rb.scene_schema())
    document = json.loads(rb._core._scene_text(scene_of()))
    validator.validate(document)
    document["$schema"] = "scene.schema.json"
    assert rb._core._scene_from(json.dumps(document), "x").bodies
    # what the library refuses for its form the schema refuses, too
    for path, value in [
        (("bodies", 0, "colour"), "red"),
        (("bodies", 0, "joint", "kind"), "elastic"),
        (("bodies", 0, "body", "mass"), "heavy"),
        (("gravity",), [0, 0]),
        (("version",), 2),
    ]:
        wrong = changed(json.dumps(document), path, value)
        assert not validator.is_valid(json.loads(wrong)), path
        with pytest.raises(rb.InvalidInput):
            rb._core._scene_from(wrong, "x")


def changed(text, path, value):
    document = json.loads(text)
    place = document
    *way, last = path
    for step in way:
        place = place[step]
    if value is ...:
        del place[last]
    else:
        place[last] = value
    return json.dumps(document)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (["bodies", 0, "body", "mass"], -1, r"bodies\[0\]: Particle: mass is -1"),
        (["bodies", 0, "body", "mass"], "x", r'bodies\[0\].body.mass is "x"; it is a number'),
        (["bodies", 0, "body", "mass"], {"parameter": 7}, r"mass.parameter is 7; it is a whole number from 0 to"),
        (["bodies", 0, "joint", "curve", "direction"], [1, 0], r"curve.direction is \[1,0\]; it has 3 elements"),
        (["bodies", 0, "joint", "curve", "kind"], "ellipse", r'curve.kind is "ellipse"; it is one of "line", "circle"'),
        (["bodies", 0, "joint", "curve"], ..., r'bodies\[0\].joint: it has no "curve"'),
        (["bodies", 0, "start", "sped"], 1, r'bodies\[0\].start: there is a "sped", and what there may be is param'),
        (["bodies", 1, "name"], "bead 1", r"bodies\[1\]: .*differ"),
        (["loads", 0, "on"], "nobody", r'loads\[0\].on is "nobody"; it is the name of a body'),
        (
            ["loads", 1, "function", "operations", 0],
            "n0 = sin n5",
            r"operations\[0\] is .*it is an operation on earlier",
        ),
        (["loads", 1, "function", "operations", 1], "system", r'operations\[1\] is "system"; it begins with "n1 = "'),
        (["loads", 1, "function", "results", 0], "n999", r"results\[0\] is .*the name of an operation"),
        (["loads", 1, "function", "inputs"], 1e99, r"inputs is 1e\+99; it is a whole number"),
        (["watches", 0, "direction"], "up", r'direction is "up"; it is one of "either", "rising", "falling"'),
        (["watches", 0, "action"], "change", r"action is .*is an object, with what it changes and a function"),
        (["integrals", 0, "function", "asks", 0, "component"], 99, r"component is 99; .* from 0 to 8"),
        (["gravity"], [0, 0, "nan"], r"gravity: .*is finite"),
        (["version"], 2, r"version is 2; this version of the library reads 1"),
        (["format"], "other", r"it is no scene"),
        (["more"], 1, r'there is a "more"'),
        (["parameters"], [], r"from|none"),
    ],
)
def test_an_error_names_the_place_in_the_file(path, value, message, tmp_path):
    place = tmp_path / "wrong.json"
    place.write_text(changed(rb._core._scene_text(everything()), path, value))
    with pytest.raises(rb.InvalidInput, match=message) as wrong:
        rb.load(place)
    assert str(wrong.value).startswith(str(place))


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"[" * 100000,
        b'{"a": ' * 100000,
        b"\xff\xfe",
        b"null",
        b"1e999",
        b"{}{}",
        b'{"format": "rbdyn scene"}',
    ],
    ids=lambda c: repr(c[:12]),
)
def test_what_is_no_scene_is_refused(content, tmp_path):
    (tmp_path / "x.json").write_bytes(content)
    with pytest.raises(rb.InvalidInput, match="x.json"):
        rb.load(tmp_path / "x.json")


def test_files_that_are_not_there(tmp_path):
    with pytest.raises(rb.InvalidInput, match="cannot be read: No such file"):
        rb.load(tmp_path / "none.json")
    with pytest.raises(rb.InvalidInput, match="cannot be written: No such file"):
        rb.save(hoop(), tmp_path / "no" / "x.json")
    with pytest.raises(rb.InvalidInput, match="ends with '.txt'; a scene is a file that ends with .json"):
        rb.save(hoop(), tmp_path / "x.txt")
    with pytest.raises(rb.InvalidInput, match="a run is a file that ends with .npz, .h5"):
        rb.save(rb.simulate(hoop(), 0.1), tmp_path / "x.json")
    with pytest.raises(rb.InvalidInput, match="neither a scene nor a run"):
        rb.save(3, tmp_path / "x.json")


@pytest.mark.parametrize("suffix", ["json", "npz", "h5"])
def test_links_and_modes_stay_what_they_are(suffix, tmp_path):
    thing = hoop() if suffix == "json" else rb.simulate(hoop(), 0.1)
    there, link = tmp_path / f"there.{suffix}", tmp_path / f"link.{suffix}"
    there.write_bytes(b"old")
    there.chmod(0o600)
    link.symlink_to(there.name)
    rb.save(thing, link)
    assert link.is_symlink() and there.stat().st_mode & 0o777 == 0o600
    assert rb.load(there) is not None and sorted(tmp_path.iterdir()) == [link, there]


def test_a_pipe_is_written_into_while_others_run(tmp_path):
    pipe, read = tmp_path / "pipe.json", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    rb.save(hoop(), pipe)
    reader.join(10)
    assert pipe.is_fifo() and '"format": "rbdyn scene"' in read[0]


# --- runs ---


@names
@pytest.mark.parametrize("suffix", ["npz", "h5"])
def test_a_run_comes_back_with_all_its_answers(scene_of, suffix, tmp_path):
    scene = scene_of()
    run = rb.simulate(scene, until=1.5, error=1e-9)
    run.save(tmp_path / f"run.{suffix}")
    loaded = rb.load(tmp_path / f"run.{suffix}")
    assert_same(run, loaded)
    assert loaded.drift == run.drift
    assert np.array_equal(loaded[scene.bodies[0]].position(1.0), run[scene.bodies[0]].position(1.0))


def test_other_programs_read_what_there_is_of_a_run(tmp_path):
    run = rb.simulate(hoop(), until=6.0)
    run.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz", allow_pickle=False) as file:
        assert json.loads(str(file["about"]))["status"] == "reached end"
        assert str(file["plan"]) == str(run.plan) and np.array_equal(file["t"], run.t)
        assert np.array_equal(file["event_time"], [e.time for e in run.events])
        assert list(file["event_kind"]) == [e.kind for e in run.events]
        assert json.loads(str(file["statistics"]))["steps"] == run.statistics.steps
        assert rb._core._scene_from(str(file["scene"]), "scene") == hoop()
    h5py = pytest.importorskip("h5py")
    run.save(tmp_path / "run.h5")
    with h5py.File(tmp_path / "run.h5") as file:
        assert file.attrs["engine"] == "taylor" and file.attrs["error"] == run.error
        assert np.array_equal(file["t"], run.t) and file["event_kind"].asstr()[0] == run.events[0].kind


def test_without_h5py_the_error_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(ImportError, match="pip install h5py"):
        rb.simulate(oscillator(), until=1.0).save(tmp_path / "run.h5")


@pytest.mark.parametrize("suffix", ["npz", "h5"])
def test_a_file_that_was_changed_or_cut_short_is_refused(suffix, tmp_path):
    run = rb.simulate(hoop(), until=2.0)
    place = tmp_path / f"run.{suffix}"
    run.save(place)
    whole = place.read_bytes()
    chance = random.Random(1)
    refused = 0
    for i in range(1000):
        content = bytearray(whole)
        if i % 4 == 0:
            del content[chance.randrange(len(content)) :]
        else:
            for _ in range(chance.choice([1, 1, 3, 20])):
                content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
        place.write_bytes(content)
        try:
            other = rb.load(place)
        except rb.InvalidInput as problem:
            assert str(place) in str(problem)
            refused += 1
        else:
            # of what is not read, or has no meaning
            assert np.array_equal(state(other, 1.5), state(run, 1.5)) and other.events == run.events
    assert refused > 500


def members_of(place):
    """The arrays of a file of a run, by name."""
    with np.load(place, allow_pickle=False) as archive:
        return {name: archive[name] for name in archive}


def written(place, members):
    np.savez(place, **members)
    return place


MEMBERS = {
    "plan": lambda a: np.array(str(a).replace("taylor", "dop853")),
    "statistics": lambda a: np.array(str(a).replace('"steps": ', '"steps": 1')),
    "scene": lambda a: np.array(str(a).replace("0.5", "0.6")),
    "handles": lambda a: np.array(str(a).replace("bead 1", "bead 2")),
    "state": lambda a: np.concatenate((a[:-1], a[-1:] ^ 1)),
    "t": lambda a: a * 1.5,
    "event_time": lambda a: a + 1.0,
    "event_kind": lambda a: np.where(a == "reverse", "stick", a),
    "event_name": lambda a: np.where(a == a[0], "other", a),
    "event_direction": lambda a: np.where(a == a[0], "x", a),
    "about": lambda a: np.array(str(a).replace('"certain_until": ', '"certain_until": 1')),
}


@pytest.mark.parametrize("name", MEMBERS)
def test_every_part_of_a_runs_file_is_under_its_checksum(name, tmp_path):
    """Also what is there for other programs and is not read here: a changed file is refused, says files.md."""
    rb.simulate(hoop(), until=6.0).save(tmp_path / "run.npz")
    members = members_of(tmp_path / "run.npz")
    assert set(members) == set(MEMBERS)
    assert rb.load(written(tmp_path / "same.npz", members)).end == 6.0
    changed = MEMBERS[name](members[name])
    assert changed.dtype.kind == members[name].dtype.kind and not np.array_equal(changed, members[name])
    with pytest.raises(rb.InvalidInput, match="it was changed or cut short: its checksum is not that of what is in it"):
        rb.load(written(tmp_path / "changed.npz", members | {name: changed}))
    left = {other: array for other, array in members.items() if other != name}
    with pytest.raises(rb.InvalidInput, match="it was changed or cut short|it is no run that save"):
        rb.load(written(tmp_path / "left.npz", left))


def test_runs_of_the_format_before_are_read(tmp_path):
    """Version 1 had a checksum of scene, handles and state alone."""
    run = rb.simulate(hoop(), until=2.0)
    run.save(tmp_path / "run.npz")
    members = members_of(tmp_path / "run.npz")
    value = 0
    for name in ("scene", "handles", "state"):
        value = zlib.crc32(members[name].tobytes() if members[name].ndim else str(members[name]).encode(), value)
    about = json.loads(str(members["about"])) | {"version": 1, "checksum": value}
    old = {name: members[name] for name in ("scene", "handles", "state")}
    assert_same(run, rb.load(written(tmp_path / "old.npz", old | {"about": np.array(json.dumps(about))})))
    other = old | {"about": np.array(json.dumps(about | {"version": 2}))}
    with pytest.raises(rb.InvalidInput, match="it was changed or cut short"):
        rb.load(written(tmp_path / "mixed.npz", other))


def test_a_key_that_is_there_twice_is_refused_with_its_place(tmp_path):
    """One of its values would go unread, and which is not said by JSON."""
    text = rb._core._scene_text(hoop())
    for old, new, place in (
        ('"gravity"', '"gravity": [0, 0, 0], "gravity"', 'the key "gravity" is there twice'),
        ('"mass"', '"mass": 1.0, "mass"', r'bodies\[0\].body: the key "mass" is there twice; give it once'),
    ):
        assert old in text
        (tmp_path / "x.json").write_text(text.replace(old, new, 1))
        with pytest.raises(rb.InvalidInput, match=rf"x.json: {place}"):
            rb.load(tmp_path / "x.json")


def test_a_path_with_a_zero_in_it_is_refused(tmp_path):
    scene = hoop()
    run = rb.simulate(scene, 0.1)
    for call in (
        lambda: rb.load("a\0.json"),
        lambda: rb.save(scene, tmp_path / "a\0.json"),
        lambda: run.save(str(tmp_path / "a\0.npz")),
        lambda: run.sample([0.0]).to_csv("a\0.csv"),
    ):
        with pytest.raises(rb.InvalidInput, match=r"a\\x00.*; no path has a zero in it, give another"):
            call()
    assert not list(tmp_path.iterdir())


def test_a_state_with_a_checksum_of_its_own_does_no_harm_either():
    for scene_of in (hoop, switching, oscillator):
        run = rb.simulate(scene_of(), until=2.0)
        scene, data = run.__getstate__()
        head = data.index(b"rbdyn run") + len(b"rbdyn run 4")
        payload = data[head + 8 :]
        assert zlib.crc32(payload) == int.from_bytes(data[head + 4 : head + 8], "little")
        chance = random.Random(2)
        refused = 0
        for _ in range(1500):
            content = bytearray(payload)
            for _ in range(chance.choice([1, 2, 8])):
                content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
            sealed = data[: head + 4] + zlib.crc32(content).to_bytes(4, "little") + bytes(content)
            other = type(run).__new__(type(run))
            try:
                other.__setstate__((scene, sealed))
                _ = state(other, 1.0), other.energy(1.0), str(other)
                rb.simulate(other, until=other.end + 0.1, rtol=1e-6, max_steps=50)
            except (rb.Error, ValueError):
                refused += 1
        assert 0 < refused < 1500


def test_a_state_of_another_scene_is_refused():
    run, other = rb.simulate(hoop(), until=1.0), rb.simulate(oscillator(), until=1.0)
    with pytest.raises(rb.InvalidInput, match="of another scene"):
        type(run).__new__(type(run)).__setstate__((other.__getstate__()[0], run.__getstate__()[1]))


def test_a_run_of_another_version_is_refused_by_its_name(tmp_path):
    place = tmp_path / "run.npz"
    rb.simulate(oscillator(), until=1.0).save(place)
    with zipfile.ZipFile(place) as archive:
        arrays = {name: np.load(io.BytesIO(archive.read(name))) for name in archive.namelist()}
    about = json.loads(str(arrays["about.npy"])) | {"rbdyn": "9.9.9"}
    arrays["about.npy"] = np.array(json.dumps(about))
    np.savez(place, **{name.removesuffix(".npy"): array for name, array in arrays.items()})
    with pytest.raises(rb.InvalidInput, match="written by rbdyn 9.9.9"):
        rb.load(place)


# --- tables ---


def sampled():
    run = rb.simulate(hoop(), until=2.0)
    return run, run.sample(np.linspace(0, 2, 11))


def test_a_table_reads_back_as_itself(tmp_path):
    run, sample = sampled()
    sample.to_csv(tmp_path / "hoop.csv")
    first, *rest = (tmp_path / "hoop.csv").read_text().splitlines()
    columns = first.split(",")
    assert columns[:3] == ["t [s]", "bead 1.position.x [m]", "bead 1.position.y [m]"]
    assert "bead 1.speed [m/s]" in columns and "bead 1.reaction_frenet.normal [N]" in columns
    table = np.array([[float(x) for x in line.split(",")] for line in rest])
    assert np.array_equal(table[:, 0], sample.t)
    assert np.array_equal(table[:, columns.index("bead 1.position.x [m]")], sample[run.bodies[0]]["position"][:, 0])


def test_tables_say_their_units(tmp_path):
    run, sample = sampled()
    (bead,) = run.bodies
    assert sample.unit(bead, "acceleration") == "m/s^2"
    frame = pytest.importorskip("pandas").DataFrame(sample.to_pandas())
    attributes = sample.to_pandas().attrs
    assert attributes["engine"] == "taylor" and attributes["error"] == run.error
    assert attributes["units"]["bead 1.speed"] == "m/s" and frame.shape[0] == 11
    pytest.importorskip("xarray")
    data = sample.to_xarray()
    assert data["bead 1.position"].attrs == {"units": "m", "frame": "world"} and data["t"].attrs == {"units": "s"}
    assert data.attrs["engine"] == "taylor" and data.attrs["error"] == run.error


def test_every_quantity_has_its_unit():
    for scene_of in SCENES:
        run = rb.simulate(scene_of(), until=0.5)
        sample = run.sample()
        assert np.array_equal(sample.t, run.t)
        for handle in (*run.bodies, *run.couplings):
            for quantity in sample[handle]:
                assert isinstance(sample.unit(handle, quantity), str)
    scene = rb.Scene()
    slide = scene.add(rb.RigidBody(1, [1, 1, 1]), rb.Prismatic([1, 0, 0]), rate=1.0)
    hinge = scene.add(rb.RigidBody(1, [1, 1, 1]), rb.Cylindrical([1, 0, 0]), rate=1.0)
    sample = rb.simulate(scene, until=0.5).sample()
    assert (sample.unit(slide, "rate"), sample.unit(hinge, "rate")) == ("m/s", "rad/s")
