"""No call, whatever it is given, crashes, hangs, or ends in anything but an exception that says what."""

import pickle
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import rbdyn as rb

HERE = Path(__file__).resolve().parent


def made_up(program, seed, count, seconds=120):
    """A program of its own, so that a crash is a failure here, with what was under way."""
    done = subprocess.run(
        [sys.executable, HERE / program, str(seed), str(count)], capture_output=True, text=True, timeout=seconds
    )
    last = done.stderr.strip().splitlines()[-1:]
    assert done.returncode == 0, f"seed {seed} ended with {done.returncode} in {last}"
    return done.stdout


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_made_up_calls_end_in_an_exception_that_says_what(seed):
    told = made_up("bad_calls.py", seed, 8000)
    assert told.strip().endswith("WRONG 0"), told
    counts = {
        kind: int(number)
        for number, kind in (line.split() for line in told.splitlines() if "WRONG" not in line and line)
    }
    assert sum(counts.values()) == 8000 and counts["InvalidInput"] > 300


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_states_that_were_changed_do_no_harm(seed):
    told = made_up("tampered.py", seed, 1200)
    assert told.strip().endswith("WRONG 0"), told
    counts = {
        kind: int(number)
        for number, kind in (line.split() for line in told.splitlines() if "WRONG" not in line and line)
    }
    assert sum(counts.values()) == 1200 and counts["InvalidInput"] > 300


def classes():
    return sorted(
        name for name in rb.__all__ if isinstance(getattr(rb, name), type) and "_core" in getattr(rb, name).__module__
    )


def test_what_new_alone_made_has_no_value_and_says_so():
    """In a program of its own: each class, each of its methods and properties."""
    program = """
import copy, pickle, rbdyn as rb, sys
for name in sys.argv[1:]:
    made = getattr(rb, name)
    thing = made.__new__(made)
    words = [w for w in dir(made) if not w.startswith("__")]
    for look in [repr, str, hash, copy.copy, pickle.dumps, *(lambda x, w=w: getattr(x, w)() for w in words)]:
        try:
            look(thing)
        except (TypeError, AttributeError, rb.Error) as error:
            if "__new__ alone" in str(error):
                print(name)
    for use in (lambda: rb.simulate(thing, 1.0), lambda: rb.Scene().add(thing), lambda: rb.Scene().apply(thing, thing)):
        try:
            use()
        except (TypeError, rb.Error):
            pass
"""
    names = classes()
    assert len(names) > 70
    done = subprocess.run([sys.executable, "-c", program, *names], capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stderr[-2000:]
    # what has neither a text nor a property of its own has nothing to be asked for
    assert len(set(done.stdout.split())) > len(names) - 8


def test_half_pickled_things_say_so_too():
    data = pickle.dumps(rb.Spring(3.0), protocol=2)
    made = data[: data.index(b"\x81") + 1] + b"."  # up to where __new__ was called
    with pytest.raises(TypeError, match="__new__ alone"):
        print(pickle.loads(made).stiffness)


def test_a_run_within_a_run_within_a_run_ends_with_a_reason():
    depth = 0

    def within(t, x):
        nonlocal depth
        depth += 1
        rb.simulate(rb.System(within, [1.0], trace=False), 1.0, rtol=1e-3)
        return [1.0]

    for runs in (lambda f: f(), lambda f: in_a_thread(f)):
        depth = 0
        with pytest.raises(rb.InvalidInput, match="called within itself 20 deep"):
            runs(lambda: rb.simulate(rb.System(within, [1.0], trace=False), 1.0, rtol=1e-3))
        assert depth == 20
    # and what comes after is as before
    assert rb.simulate(rb.System(lambda t, x: -x, [1.0]), 1.0).x(1.0) == pytest.approx(np.exp(-1))


def in_a_thread(f):
    raised = []

    def run():
        try:
            f()
        except Exception as error:
            raised.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    if raised:
        raise raised[0]


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda s: rb.Particle(), "Particle: mass is missing; it is a number or a Parameter"),
        (lambda s: s.add(3), "Scene.add: body is 3; it is a Particle or a RigidBody"),
        (lambda s: s.add(rb.Particle(1.0), name=3), "Scene.add: name is 3; it is a string or None"),
        (lambda s: s.add(rb.Particle(1.0), name=b"x"), "Scene.add: name is b'x'; it is a string or None"),
        (lambda s: rb.Sample(3), "Sample: run is 3; it is a Trajectory"),
        (lambda s: rb.SystemSample(3), "SystemSample: run is 3; it is a SystemRun"),
        (lambda s: rb.simulate(s, until="x"), "simulate: until is 'x'; it is a number"),
        (lambda s: rb.simulate(s, 1.0, 2.0), "simulate: 3 arguments are given by place, and it takes 2 arguments so"),
        (lambda s: rb.simulate(s, 1.0, tol=2), "simulate: there is no argument 'tol'; it takes scene, until, start="),
        (lambda s: rb.simulate(s, 1.0, until=2.0), "simulate: until is given twice, by its place and by its name"),
        (lambda s: rb.simulate(s, 1.0, max_steps=2**70), "which is out of range; it is a whole number below 2**63"),
        (lambda s: rb.plan(3), "plan: scene is 3; it is a Scene or a System"),
        (lambda s: rb.cost(s, 1.0, engines=[3]), "cost: engines is [3]; it is a list, each item"),
        (lambda s: s.watch("a\ud800", print), "half a character (a surrogate) in it; give text that UTF-8 can write"),
        (
            lambda s: rb.simulate(s, 1.0, error=np.array([1e-6, 1e-7])),
            "simulate: error is array([1.e-06, 1.e-07]); it is",
        ),
        (lambda s: rb.shapes.sphere(1, np.array([1, 2])), "sphere: radius is array([1, 2]); it is a number"),
        (lambda s: rb.Curve(lambda u: [u, u, u], domain=[1]), "Curve: domain is [1]; it is 2 numbers or None"),
        (lambda s: s.connect(1, 2, 3), "Scene.connect: coupling is 1; it is a Spring, a Gravitation"),
    ],
)
def test_a_call_that_no_signature_takes_names_argument_rule_and_fix(call, sentence):
    with pytest.raises(TypeError) as caught:
        call(rb.Scene())
    assert sentence in str(caught.value) and "\n" not in str(caught.value)


def test_arrays_that_cannot_be_broadcast_are_refused_with_their_shapes():
    line = rb.Line([1, 0, 0])
    assert line.length([0.0, 1.0], 2.0) == pytest.approx([2.0, 1.0])
    with pytest.raises(rb.InvalidInput, match=r"u0 has shape \(3,\) and u1 \(0,\)"):
        line.length([0, 0, 1], [])


def test_words_with_half_a_character_are_refused_as_others_are():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0))
    run = rb.simulate(scene, 1.0)
    with pytest.raises(rb.InvalidInput, match=r'side is "\\ud800"; it is "after" or "before"'):
        run[ball].position(0.5, side="\ud800")


@pytest.mark.parametrize(
    ("nodes", "outputs", "names"),
    [
        ([("input", 0, -1, -1, -1, 0.0), ("add", 0, -1, -1, -1, 0.0)], [1], []),
        ([("input", 0, -1, -1, -1, 0.0), ("sin", -1, -1, -1, -1, 0.0)], [1], []),
        ([("input", 0, -1, -1, -1, 0.0), ("norm", 0, 0, -1, -1, 0.0)], [1], []),
        ([("input", 0, -1, -1, -1, 0.0), ("sin", 0, 0, -1, -1, 0.0)], [1], []),
        ([("input", 1, -1, -1, -1, 0.0)], [0], []),
        ([("input", 0, -1, -1, -1, 0.0)], [-1], []),
        ([("input", 0, -1, -1, -1, 0.0), ("sign", 0, -1, -1, 1, 0.0)], [1], ["a"]),
        ([("cell", 0, -1, -1, -1, 0.0)], [0], []),
    ],
)
def test_operations_that_read_what_is_not_there_are_refused(nodes, outputs, names):
    with pytest.raises(rb.InvalidInput, match="a node uses earlier nodes, inputs, names and parameters"):
        rb._core._function(1, nodes, outputs, names, [])


def test_names_and_numbers_that_are_given_twice_are_one():
    nodes = [("input", 0, -1, -1, -1, 0.0), ("sign", 0, -1, -1, 1, 0.0)]
    assert rb._core._function(1, nodes, [1], ["a", "a"], [])(-2.0) == -1.0
    k = rb.parameter(3.0, "k")
    assert rb._core._function(0, [("cell", 1, -1, -1, -1, 0.0)], [0], [], [k, k])() == 3.0


def test_none_is_no_number():
    """NumPy makes NaN of it."""
    with pytest.raises(rb.InvalidInput, match="gravity is"):
        rb.Scene(gravity=[None, 0, 0])
    with pytest.raises(rb.InvalidInput, match="f is None"):
        rb.JointTorque(None)


def test_a_list_that_contains_itself_is_no_vector():
    endless = [1.0, 2.0]
    endless.append(endless)
    for call in (lambda: rb.Line(endless), lambda: rb.Line([1, 0, 0]).position(endless), lambda: rb.Spring(endless)):
        with pytest.raises(rb.InvalidInput, match=r"is \[1.0, 2.0, \[...\]\]; give numbers"):
            call()


def test_what_memory_does_not_hold_is_no_lack_of_numbers():
    """8 EB of them: NumPy says so, and its error is told as it is."""
    from numpy.lib.stride_tricks import as_strided

    huge = as_strided(np.zeros(1, np.float32), (2**58,), (0,))
    with pytest.raises(MemoryError, match="Unable to allocate .* with shape"):
        rb.Line([1, 0, 0]).position(huge)
    turning = rb.PoinsotMotion(rb.RigidBody(1.0, [1, 2, 2.5]), [1, 1, 1])
    with pytest.raises(rb.InvalidInput, match="count is 1e\\+10; a way has at most 2147483647 points"):
        turning.polhode(10**10)


class Endless:
    """A sequence that says it has more items than memory."""

    def __len__(self):
        return 2**62

    def __getitem__(self, i):
        raise IndexError


def test_a_sequence_of_more_than_memory_is_a_lack_of_memory():
    scene, k = rb.Scene(), rb.parameter(1.0, "k")
    scene.connect(rb.Spring(k), scene.add(rb.Particle(1.0)), [0, 0, 0])
    with pytest.raises(MemoryError, match="there is not the memory for what is asked"):
        scene.assemble(keep=Endless())
    with pytest.raises(MemoryError, match="ask for fewer points, times or members at once"):
        rb.simulate_many(scene, {k: np.broadcast_to(0.5, (2**59,))}, 1.0)


@pytest.mark.parametrize("trace", [None, True, False])
def test_a_watch_that_asks_for_a_body_of_another_scene_is_refused_when_it_is_given(trace):
    scene, other = rb.Scene(), rb.Scene()
    scene.add(rb.Particle(1.0), name="own")
    stranger = other.add(rb.Particle(1.0), name="stranger")
    with pytest.raises(rb.InvalidInput, match='"stranger" is a handle of another scene'):
        scene.watch("low", lambda now: now[stranger].position[2], trace=trace)
    assert not scene.handles.get("low")


def test_a_zero_in_a_word_does_not_cut_the_message():
    scene = rb.Scene()
    scene.add(rb.Particle(1.0))
    run = rb.simulate(scene, 1.0)
    for ask in (lambda: run["a\0b"], lambda: run.events.times("a\0b")):
        with pytest.raises(rb.InvalidInput, match=r'"a\\x00b".* there are|"a\\x00b".*the kinds are'):
            ask()
    with pytest.raises(rb.InvalidInput, match=r'"a\\x00b"; it is one of "com", "origin"'):
        rb.RigidBody(1.0, [1, 2, 2.5], inertia_about="a\0b")


def test_a_whole_number_that_numpy_has_no_type_for_is_named():
    with pytest.raises(rb.InvalidInput, match="where: 18446744073709551616 or False is a whole number"):
        rb.where("a", 2**64, False)


def in_a_program_of_its_own(program):
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.splitlines()


def test_a_keyword_with_half_a_character_is_refused_by_its_name():
    """What tells of a call writes its keywords in UTF-8."""
    told = in_a_program_of_its_own(
        r"""
import rbdyn as rb
odd, scene = {"\ud800": 1}, rb.Scene()
for call in (
    lambda: rb.Particle(1.0, **odd),
    lambda: rb.Polynomial([[1, 0, 0], [0, 1, 0]], **odd),
    lambda: rb.Scene(**odd),
    lambda: rb.simulate(scene, 1.0, **odd),
    lambda: rb.parameter(1.0, **odd),
    lambda: rb.Circle(**odd),
    lambda: rb.Free(**odd),
    lambda: rb.cost(scene, 1.0, **odd),
    lambda: rb.plan(scene, **odd),
    lambda: scene.add(rb.Particle(1.0), **odd),
    lambda: rb.Spring.stiffness.fget(rb.Spring(1.0), **odd),
    lambda: rb.Spring.__new__(rb.Spring).__setstate__(**odd),
):
    try:
        call()
    except (TypeError, rb.InvalidInput) as refused:
        print(str(refused).replace("\n", " "))
"""
    )
    assert len(told) == 12 and all("\\ud800" in line for line in told), told
    assert told[0].startswith("Particle: there is no argument '\\ud800'; it takes mass")
    assert told[9].startswith('Scene.add: unexpected keyword "\\ud800"; a particle that is free starts with position')


class Uncounted:
    """A sequence that says it has more items than a machine counts."""

    def __len__(self):
        return 2**70

    def __getitem__(self, i):
        raise IndexError


def test_a_sequence_that_no_machine_counts_is_named():
    scene = rb.Scene()
    scene.add(rb.Particle(1.0))
    for call in (lambda: scene.assemble(Uncounted()), lambda: scene.assemble(keep=Uncounted())):
        with pytest.raises(
            TypeError, match=r"Scene.assemble: keep is <.*, whose length is 2\*\*63 or more; give a list"
        ):
            call()
    with pytest.raises(TypeError, match=r"cost: engines is <.*Uncounted"):
        rb.cost(scene, 1.0, engines=Uncounted())

    def overflows(t, x):
        raise OverflowError("of the function's own")

    # one that a function of the user's raises stays what it is
    with pytest.raises(OverflowError, match="of the function's own"):
        rb.simulate(rb.System(overflows, [1.0], trace=False), 1.0)


def test_a_function_of_more_than_a_million_numbers_is_refused_at_once():
    for inputs, told in ((10**9, r"1e\+09"), (10**6 + 1, "1000001"), (-1, "-1")):
        with pytest.raises(rb.InvalidInput, match=f"Function: inputs is {told}; it takes from 0 to 1000000 numbers"):
            rb.Function(lambda *x: x[0], inputs)
    assert rb.Function(lambda *x: x[-1], 20_000).inputs == 20_000
    assert rb.Function(lambda: 2.0, 0)() == 2.0


def test_no_name_has_a_zero_in_it():
    """Files in HDF5 have none, and messages and tables would end there."""
    scene = rb.Scene()
    ball, other = scene.add(rb.Particle(1.0)), scene.add(rb.Particle(1.0), position=[1, 0, 0])
    system = rb.System(lambda t, x: -x, [1.0])
    odd = "a\0b"
    for call in (
        lambda: scene.add(rb.Particle(1.0), name=odd),
        lambda: scene.constrain(rb.Rod(1.0), ball, other, name=odd),
        lambda: scene.contact(ball, rb.Plane([0, 0, 1], [0, 0, -1]), name=odd),
        lambda: scene.watch(odd, lambda now: now.time - 1.0),
        lambda: rb.System(lambda t, x: -x, [1.0], names=[odd]),
        lambda: system.watch(odd, lambda t, x: x[0]),
        lambda: rb.parameter(1.0, odd),
    ):
        with pytest.raises(rb.InvalidInput, match=r'name is "a\\x00b"; no name has a zero in it, give another'):
            call()
    assert scene.handles == {"particle 1": ball, "particle 2": other}
    with pytest.raises(rb.InvalidInput, match="no name has a zero in it"):
        text = rb._core._scene_text(scene).replace("particle 1", "a\\u0000b")
        rb._core._scene_from(text, "scene")


class Evil:
    def __repr__(self):
        raise ZeroDivisionError


def test_what_cannot_tell_what_it_is_is_refused_all_the_same():
    scene, evil = rb.Scene(), Evil()
    ball = scene.add(rb.Particle(1.0))
    run = rb.simulate(scene, 1.0)
    vary = {(ball, "position"): np.zeros((2, 3))}
    for call in (
        lambda: rb.save(evil, "scene.json"),
        lambda: rb.save(scene, evil),
        lambda: rb.load(evil),
        lambda: rb.simulate_many(evil, vary, 1.0),
        lambda: rb.simulate_many(scene, evil, 1.0),
        lambda: rb.simulate_many(scene, {evil: 1.0}, 1.0),
        lambda: rb.simulate_many(scene, vary, 1.0, threads=evil),
        lambda: rb.simulate_many(scene, vary, 1.0, executor=evil),
        lambda: rb.simulate_many(scene, vary, 1.0, events=evil),
        lambda: rb.simulate_many(scene, vary, 1.0, lanes=evil),
        lambda: run.sample(times=evil),
        lambda: run.sample()[evil],
        lambda: run.sample().unit(ball, evil),
        lambda: rb.Sample(evil),
        lambda: rb.SystemSample(evil),
        lambda: rb.Many([evil], [None], {}, 0.0, 1.0),
        lambda: rb.Scorecard(evil, 0.0),
        lambda: rb.verify(full=evil),
    ):
        with pytest.raises((TypeError, rb.InvalidInput), match="Evil"):
            call()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (([True, False], [1, 2, 3], 0), r"condition has shape \(2,\), a \(3,\) and b \(\); give arrays of one shape"),
        (([1, [2]], 1, 2), r"condition is \[1, \[2\]\]; give numbers, or an array of numbers"),
        ((True, "a", 2.0), "a is of type <U1 and b of float64; give numbers, or arrays of them"),
    ],
)
def test_choices_that_do_not_fit_are_named(arguments, sentence):
    with pytest.raises(rb.InvalidInput, match="where: " + sentence):
        rb.where(*arguments)


def test_an_arc_length_that_no_double_holds_says_so():
    curve = rb.Curve(lambda u: [u, u * u, u])
    with pytest.raises(rb.Error, match="from -1e\\+308 to 10 is not known: some numbers on the way are not finite"):
        curve.length(-1e308, 10)
    with pytest.raises(rb.InvalidInput, match="from -1e\\+308 to 1e\\+308 is inf; no double holds it"):
        rb.Line([1, 0, 0]).length(-1e308, 1e308)
