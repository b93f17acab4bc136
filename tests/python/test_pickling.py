"""What travels between processes: runs and what they are made of, errors with theirs."""

import copy
import math
import pickle
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
import rbdyn as rb

HERE = Path(__file__).resolve().parent
ERROR = 1e-10
DOWN = [0, 0, -9.8125]


def hoop():
    scene = rb.Scene(gravity=DOWN)
    circle = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0])
    rail = rb.Rail(circle, friction=rb.Coulomb(0.4, 0.1))
    scene.add(rb.Particle(0.5), rail, parameter=0.0, speed=7.0)
    return scene


def belt():
    scene = rb.Scene(gravity=DOWN)
    rail = rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(0.5, 0.25), drive=lambda t: 0.25 + 0.125 * np.sin(t))
    block = scene.add(rb.Particle(1.0), rail)
    scene.connect(rb.Spring(stiffness=16.0), block, [0, 0, 0])
    scene.watch("middle", lambda now: now[block].position[0] - 0.2)
    return scene


def leaving():
    scene = rb.Scene(gravity=DOWN)
    sphere = rb.Circle(radius=1.0, start=[0, 0, 1], toward=[1, 0, 0])
    scene.add(rb.Particle(1.0), rb.Rail(sphere, side="-"), parameter=0.1, speed=0.5)
    return scene


def switching():
    k = rb.parameter(20.0, "k")
    scene = rb.Scene(gravity=DOWN)
    ball = scene.add(rb.Particle(0.5), position=[0, 0, 1], velocity=[1, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [0, 0, np.maximum(-k * r[2], 0.0) * 10 if t < 1.5 else -k * r[2]]), ball)
    scene.integral("x velocity", lambda now: now[ball].velocity[0])
    return scene


def sliding():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[0.5, 0, 0], velocity=[0, 1, 0])
    scene.apply(rb.Force(lambda t, r, v: [-2.0 * np.sign(r[0] + 0.3 * v[0]), 0.1, 0]), ball)
    return scene


def top():
    scene = rb.Scene(gravity=DOWN)
    body = rb.shapes.cone(1.0, 0.5, 1.0, [0, 0, 1])
    scene.add(body, rb.Spherical(), attitude=rb.EulerAngles(0.5, 0.1, 0.2), angular_velocity=[0, 0, 30.0])
    return scene


def compound():
    scene = rb.Scene(gravity=DOWN)
    body = rb.RigidBody(1.0, [0.1, 0.2, 0.25], com=[0.1, 0, -0.3])
    scene.add(body, rb.Spherical(), attitude=rb.EulerAngles(0.5, 0.1, 0.2), angular_velocity=[0.5, 0.1, 3.0])
    return scene


def several():
    scene = rb.Scene(gravity=DOWN)
    circle = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0])
    scene.add(rb.Particle(0.5), rb.Rail(circle, friction=rb.Coulomb(0.4, 0.1)), speed=5.0)
    scene.add(rb.RigidBody(1.0, [0.1, 0.2, 0.25]), velocity=[0, 1, 5], angular_velocity=[0.1, 2, 0])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 2])
    scene.apply(rb.Drag(0.1, 0.2), ball)
    scene.connect(rb.Spring(5.0, rest_length=0.5), ball, [0.3, 0, 0])
    return scene


SCENES = [hoop, belt, leaving, switching, sliding, top, compound, several]


def everything_of(run, times):
    values = [run.energy(times), run.power(times), run.momentum(times), run.angular_momentum(times)]
    for handle in (*run.bodies, *run.couplings):
        motion = run[handle]
        for name in motion.quantities:
            value = getattr(motion, name)(times)
            values += list(value) if isinstance(value, tuple) else [value]
    return values


def assert_same(run, other, times=None):
    times = np.linspace(run.start, run.end, 33) if times is None else times
    for a, b in zip(everything_of(run, times), everything_of(other, times), strict=True):
        np.testing.assert_array_equal(a, b)
    assert run.events == other.events and str(run) == str(other)
    assert run.statistics == other.statistics
    assert (run.error, run.certain_until, run.status, run.engine) == (
        other.error,
        other.certain_until,
        other.status,
        other.engine,
    )
    assert str(run.plan) == str(other.plan)
    np.testing.assert_array_equal(run.t, other.t)


@pytest.mark.parametrize("scene_of", SCENES, ids=lambda f: f.__name__)
@pytest.mark.parametrize("engine", ["auto", "dop853"])
def test_a_run_that_was_pickled_answers_all_questions_as_before(scene_of, engine):
    run = rb.simulate(scene_of(), 3.0, error=ERROR if engine == "auto" else 1e-8, engine=engine)
    assert_same(run, pickle.loads(pickle.dumps(run)))
    assert run.drift == pickle.loads(pickle.dumps(run)).drift
    assert_same(run, copy.deepcopy(run))


@pytest.mark.parametrize("scene_of", SCENES, ids=lambda f: f.__name__)
def test_a_run_that_kept_less_is_pickled_with_what_it_kept(scene_of):
    end = rb.simulate(scene_of(), 3.0, error=1e-8, keep="end")
    assert_same(end, pickle.loads(pickle.dumps(end)), np.array([end.end]))
    times = np.array([0.5, 1.0, 2.0])
    some = rb.simulate(scene_of(), 3.0, error=1e-8, keep=times)
    assert_same(some, pickle.loads(pickle.dumps(some)), times)


def test_a_run_is_pickled_with_the_numbers_it_ran_with():
    k = rb.parameter(4.0, "k")
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: -k * r), ball)
    scene.apply(rb.Drag(k), ball)
    run = rb.simulate(scene, 1.0, error=ERROR)
    k.value = 9.0
    other = pickle.loads(pickle.dumps(run))
    assert_same(run, other)
    np.testing.assert_allclose(other[ball].acceleration(0.0), [-4.0, 0, 0])


@pytest.mark.parametrize(("stiffness", "rest_length"), [("k", 0.2), (3.0, "k"), ("k", "l"), ("k", 0.0)])
def test_a_run_is_pickled_whatever_its_numbers_are_multiplied_with(stiffness, rest_length):
    # 3 times 0.2 is no double
    numbers = {"k": rb.parameter(3.0, "k"), "l": rb.parameter(0.7, "l")}
    spring = rb.Spring(numbers.get(stiffness, stiffness), numbers.get(rest_length, rest_length))
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.connect(spring, ball, [0, 0, 0])
    run = rb.simulate(scene, until=1.0)
    assert_same(run, pickle.loads(pickle.dumps(run)))


def test_handles_are_good_for_a_run_that_was_pickled():
    scene = belt()
    run = pickle.loads(pickle.dumps(rb.simulate(scene, 3.0)))
    assert run[scene.bodies[0]].position(1.0).shape == (3,)
    assert run[scene.couplings[0]].length(1.0) > 0
    assert run.events[0].subject == scene.bodies[0] or run.events[0].subject is None


def test_events_and_plans_are_pickled_alone():
    run = rb.simulate(belt(), 6.0)
    events = pickle.loads(pickle.dumps(run.events))
    assert events == run.events and str(events) == str(run.events) and len(events) > 4
    np.testing.assert_array_equal(events.times("middle"), run.events.times("middle"))
    for event in run.events:
        other = pickle.loads(pickle.dumps(event))
        assert other == event and hash(other) == hash(event) and repr(other) == repr(event)
        assert other.subject == event.subject
    assert run.events[0] != run.events[1]
    for scene_of in SCENES:
        plan = rb.plan(scene_of())
        other = pickle.loads(pickle.dumps(plan))
        assert str(other) == str(plan) and other.size == plan.size and other.omissions == plan.omissions
        assert [str(p) for p in other.parts] == [str(p) for p in plan.parts]
    assert pickle.loads(pickle.dumps(run.statistics)) == run.statistics


def test_tables_and_motions_without_torque_are_pickled():
    table = rb.effects(hoop(), 1.0)
    other = pickle.loads(pickle.dumps(table))
    assert str(other) == str(table) and other["gravity"].difference == table["gravity"].difference
    price = rb.cost(hoop(), 0.2, errors=[1e-6], engines=["taylor"], budget=0.1)
    assert str(pickle.loads(pickle.dumps(price))) == str(price)
    racket = rb.RigidBody(1.0, [1.0, 2.0, 3.0], com=[0.1, 0, 0])
    for point in (None, [0, 0.25, 0]):
        motion = rb.PoinsotMotion(racket, [0.1, 1.0, 0.3], point=point)
        other = pickle.loads(pickle.dumps(motion))
        assert (other.kind, other.period, other.tilt) == (motion.kind, motion.period, motion.tilt)
        np.testing.assert_array_equal(other.polhode(20), motion.polhode(20))


# --- errors ---


def fails():
    """x'' = x^2, which blows up in finite time."""
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[math.sqrt(2 / 3), 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [r[0] ** 2, 0, 0]), ball)
    return rb.simulate(scene, until=10.0, rtol=1e-10)


def test_an_error_travels_between_processes_with_its_text_and_its_run():
    with pytest.raises(rb.IntegrationError) as here:
        fails()
    copied = pickle.loads(pickle.dumps(here.value))
    assert type(copied) is rb.IntegrationError and str(copied) == str(here.value)
    assert_same(here.value.run, copied.run)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        with pytest.raises(rb.IntegrationError) as there:
            pool.submit(fails).result()
    assert str(there.value) == str(here.value)
    assert there.value.run.end == here.value.run.end
    assert there.value.run.status == here.value.run.status != "reached end"


def test_an_accuracy_error_travels_too():
    # a pendulum that all but stops at the top
    scene = rb.Scene(gravity=[0, 0, -1.0])
    circle = rb.Circle(radius=1.0, start=[0, 0, -1], toward=[1, 0, 0])
    scene.add(rb.Particle(1.0), rb.Rail(circle), speed=2.0)
    with pytest.raises(rb.AccuracyError) as here:
        rb.simulate(scene, 200.0, error=1e-12)
    copied = pickle.loads(pickle.dumps(here.value))
    assert str(copied) == str(here.value) and copied.run.certain_until == here.value.run.certain_until
    assert_same(here.value.run, copied.run, np.linspace(0, copied.run.end, 5))


def test_an_error_whose_run_cannot_be_pickled_travels_with_its_text():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [math.nan if t > 1.0 else 0.0, 0, 0], trace=False), ball)
    with pytest.raises(rb.IntegrationError, match="nan") as here:
        rb.simulate(scene, 5.0)
    with pytest.raises(TypeError, match="called back"):
        pickle.dumps(here.value.run)
    copied = pickle.loads(pickle.dumps(here.value))
    assert str(copied) == str(here.value) and not hasattr(copied, "run")


def test_data_of_something_else_are_refused():
    scene, data = rb.simulate(hoop(), 1.0).__getstate__()
    cls = type(rb.simulate(hoop(), 0.1))
    for bad in (b"", data[:100], b"rubbish" + data, data[: len(data) // 2]):
        with pytest.raises(rb.InvalidInput, match="none of a run"):
            cls.__new__(cls).__setstate__((scene, bad))


def test_a_run_is_read_by_another_process(tmp_path):
    run = rb.simulate(sliding(), 3.0, error=ERROR)
    path = tmp_path / "run"
    path.write_bytes(pickle.dumps(run))
    program = (
        f"import pickle, rbdyn as rb; run = pickle.load(open({str(path)!r}, 'rb'))\n"
        "print(repr(run[run.bodies[0]].acceleration(2.0).tolist()), run.energy(2.5))"
    )
    told = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    (ball,) = run.bodies
    assert told.strip() == f"{run[ball].acceleration(2.0).tolist()!r} {run.energy(2.5)}"


def test_what_a_scene_says_at_rest_is_pickled():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    bead = scene.add(rb.Particle(0.5), rb.Rail(rb.Circle(radius=1.0, start=[0, 0, -1], toward=[1, 0, 0])))
    potential = rb.rail_potential(scene, bead)
    scene.apply(rb.Force([1.0, 0.0, 0.0]), bead)  # it is of the scene as that was
    copied = pickle.loads(pickle.dumps(potential))
    u = np.linspace(-3, 3, 7)
    assert np.array_equal(copied.value(u), potential.value(u)) and str(copied) == str(potential)
    turns = potential.turning_points(potential.energy(0.0, 1.0), 0.0)
    assert pickle.loads(pickle.dumps(turns)) == turns
    top = rb.Scene(gravity=[0, 0, -9.81])
    top.add(rb.RigidBody(1.0, [1.0, 2.0, 2.5], com=[0, 0, 0.5]), rb.Spherical())
    for state in [*rb.equilibria(scene), *rb.equilibria(top)]:
        other = pickle.loads(pickle.dumps(state))
        assert other == state and repr(other) == repr(state)


def test_a_run_in_euler_angles_is_pickled():
    top = rb.EulerTop(rb.RigidBody(1.0, [1.0, 1.0, 0.5], com=[0, 0, 0.5], inertia_about="origin"), 9.81)
    run = rb.simulate(top, top.state(rb.EulerAngles(1.0, 0.0, 0.0), [0.5, 0.2, 8.0]), 2.0)
    copied = pickle.loads(pickle.dumps(run))
    t = np.linspace(0, 2, 11)
    assert np.array_equal(copied.state(t), run.state(t))
    for name in ("status", "start", "end", "certain_until", "engine", "error", "events"):
        assert getattr(copied, name) == getattr(run, name)
    with pytest.raises(rb.InvalidInput, match="none of a run"):
        type(run).__new__(type(run)).__setstate__(b"rubbish")


def copied(thing):
    return pickle.loads(pickle.dumps(thing))


def falling(action):
    scene = rb.Scene(gravity=DOWN)
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1], name="ball")
    scene.watch("floor", lambda now: now[ball].position[2], direction="falling", action=action(ball))
    return scene


class Module:
    """An action that is found by its name, with what it needs: this file is a module to other processes."""

    def __init__(self, ball):
        self.ball = ball

    def __call__(self, now):
        return {self.ball: {"velocity": [0.0, 0.0, abs(float(now[self.ball].velocity[2])) / 2]}}


def recordable(ball):
    return lambda now: {ball: {"velocity": -0.5 * now[ball].velocity}}


def of_this_process(ball):
    return lambda now: {ball: {"velocity": [0, 0, abs(float(now[ball].velocity[2])) / 2]}}


@pytest.mark.parametrize("action", [Module, recordable], ids=["imported", "recorded"])
def test_scenes_and_runs_with_actions_are_pickled(action):
    scene = falling(action)
    run = rb.simulate(scene, 1.2)
    assert len(run.events) > 2
    again, loaded = copied(scene), copied(run)
    assert [e.time for e in rb.simulate(again, 1.2).events] == [e.time for e in run.events]
    assert [e.time for e in loaded.events] == [e.time for e in run.events]
    assert rb.simulate(loaded, 1.3).events[0].time == rb.simulate(run, 1.3).events[0].time
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        there = pool.submit(rb.simulate, scene, 1.2).result()
    assert [e.time for e in there.events] == [e.time for e in run.events]


def test_an_action_that_is_neither_recorded_nor_imported_is_refused():
    with pytest.raises(
        TypeError, match="only what is recorded can be saved or pickled, or, to be pickled, what is imp"
    ):
        pickle.dumps(falling(of_this_process))


def test_verbs_are_found_by_their_names():
    for name in rb.__all__:
        thing = getattr(rb, name)
        if callable(thing):
            assert pickle.loads(pickle.dumps(thing)) is thing, name
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        (run,) = pool.map(rb.simulate, [hoop()], [1.0])
    assert run.end == 1.0


def run_apart(program):
    """Of what may end the process: in one of its own, with this folder's modules."""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=100, cwd=HERE)
    assert done.returncode == 0, done.stdout[-500:] + done.stderr[-2000:]
    return done.stdout


def test_every_protocol_of_pickle_keeps_the_same():
    """Protocols 0 and 1 would make the base of a class anew, which ends the process (copyreg._reduce_ex)."""
    told = run_apart("""
import pickle
import rbdyn as rb
from test_pickling import one_of_each
things = one_of_each()
base = rb.Particle.__mro__[-2]
known = {type(thing) for thing in things}
for name in rb.__all__:
    one = getattr(rb, name)
    is_pickled = isinstance(one, type) and issubclass(one, base) and (
        hasattr(one, "__setstate__") or one.__reduce__ is not object.__reduce__)
    if is_pickled and one not in known:
        print("none of", name)
for thing in things:
    try:
        kept = pickle.loads(pickle.dumps(thing, 2))
    except TypeError as error:
        for protocol in (0, 1):
            try:
                pickle.dumps(thing, protocol)
            except TypeError as other:
                if str(other) == str(error):
                    continue
            print("another refusal of", thing, protocol)
        continue
    for protocol in (0, 1):
        other = pickle.loads(pickle.dumps(thing, protocol))
        if type(other) is not type(thing) or repr(other) != repr(kept) or (kept == thing and other != thing):
            print("another", thing, protocol, other)
print("done")
""")
    assert told == "done\n"


def one_of_each():
    """One thing at least of each public class that is pickled."""
    scene = hoop()
    swing = rb.Scene(gravity=DOWN)
    rod = swing.add(rb.RigidBody(1.0, [0.1, 0.2, 0.2], com=[0, 0, -0.3]), rb.Revolute([1, 0, 0]), angle=0.2)
    drag = swing.apply(rb.TorsionSpring(1.0), rod)
    ball = swing.add(rb.RigidBody(1.0, [1, 2, 2.5]), position=[0, 0, 9])
    thread = swing.constrain(rb.Rod(9.0), ball, [0, 0, 0])
    contact = swing.contact(ball.sphere(0.1), rb.Plane([0, 0, 1], [0, 0, -5]))
    start = rb.EulerTop.state(rb.EulerAngles(1.0, 0.1, 0.2), [0, 0, 9.0])
    top = rb.EulerTop(rb.RigidBody(1.0, [0.5, 0.5, 0.25], com=[0, 0, 0.5], inertia_about="origin"), 9.81)
    price = rb.cost(scene, 0.2, budget=0.05)
    table = rb.effects(scene, 0.2)
    run = rb.simulate(scene, 2.0)
    body = rb.RigidBody(1.0, [1, 2, 2.5])
    potential = rb.rail_potential(*beads())
    x, y, origin = [1, 0, 0], [0, 1, 0], [0, 0, 0]
    found = [
        scene, run, swing, rod, drag, ball, thread, contact, price, table, *price.rows, *table.rows, *run.events,
        price.predict(1e-6), *price.missing, *rb.plan(swing).omissions, rb.simulate(top, start, 0.1), potential,
        potential.turning_points(1.0, 0.0), rb.PoinsotMotion(body, [0.1, 1, 0.2]),
        rb.Ball(), rb.Hinge(x), rb.Weld(), rb.Rod(1.0), rb.PointOnCurve(rb.Line(x)), rb.PointOnPlane(rb.Plane(x)),
        rb.Free(), rb.Fixed(), rb.Spherical(), rb.Planar(x, y), rb.Prismatic(x), rb.Cylindrical(x), rb.Universal(x, y),
        rb.Force(lambda t, r, v: [0, 0, t]), rb.Torque([0, 0, 1]), rb.JointForce(1.0), rb.JointTorque(1.0),
        rb.Lorentz(1.0, x), rb.TorsionSpring(1.0), rb.PairForce(lambda t, a, b, u, v: b - a), rb.Sphere(origin, 1.0),
        rb.Curve(lambda u: [u, np.sin(u), 0]), rb.Cycloid(1.0, x, y), rb.Helix(1.0, 0.2, x, y), rb.Parabola(1.0, x, y),
        rb.Polynomial([origin, x, y]), rb.plan(scene).size,
    ]  # fmt: skip
    from bad_calls import things
    from tampered import zoo

    return [*found, *things().values(), *zoo()]


def beads():
    scene = rb.Scene(gravity=DOWN)
    return scene, scene.add(rb.Particle(1.0), rb.Rail(rb.Circle(1.0, [0, 0, -1], [1, 0, 0])), parameter=0.1)


def test_the_base_of_all_classes_makes_nothing_and_says_so():
    """As object.__reduce__, and the protocols before the second, would have it do."""
    told = run_apart("""
import rbdyn as rb
base = rb.Particle(1.0).__class__.__mro__[-2]
derived = type(base)("Derived", (base,), {})
thing = rb.Scene()
calls = [base, lambda: base(thing), lambda: base.__new__(base), derived, lambda: derived.__new__(derived)]
classes = [getattr(rb, name) for name in rb.__all__ if isinstance(getattr(rb, name), type)]
ours = [one for one in classes if issubclass(one, base)]
calls += [one.__new__(one).__reduce__ for one in ours if one.__reduce__ is object.__reduce__]
for call in calls:
    try:
        print("made", call())
    except TypeError as error:
        assert "makes no objects" in str(error), error
    for one in ours[:1]:
        made = one.__new__(one)
        for protocol in (0, 1, 2):
            try:
                made.__reduce_ex__(protocol)
            except TypeError:
                pass
print(len(ours))
""")
    assert int(told) > 70


def test_what_is_derived_in_python_is_pickled_by_every_protocol():
    again = [pickle.loads(pickle.dumps(Lead(11.0), protocol)) for protocol in range(pickle.HIGHEST_PROTOCOL + 1)]
    assert [(type(one), one.mass) for one in again] == [(Lead, 11.0)] * len(again)


class Lead(rb.Particle):
    """A class of the user's."""
