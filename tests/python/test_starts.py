"""Starts that change without building anew, and things found by name."""

import pickle

import numpy as np
import pytest
import rbdyn as rb

DOWN = [0, 0, -9.81]
BRICK = rb.shapes.box(1.0, [0.1, 0.2, 0.3])


def pendulum(**initial):
    scene = rb.Scene(gravity=DOWN)
    bar = rb.shapes.rod(1.0, 1.0, [0, 0, 1])
    return scene, scene.add(bar, rb.Revolute([0, 1, 0], point=[0, 0, 0.5]), name="bar", **initial)


def same(one, other, handle, of=("position", "velocity", "acceleration")):
    times = np.linspace(0.0, min(one.end, other.end), 7)
    assert (one.end, one.error, one.engine, one.status) == (other.end, other.error, other.engine, other.status)
    for name in of:
        assert np.array_equal(getattr(one[handle], name)(times), getattr(other[handle], name)(times)), name


def test_a_run_starts_where_initial_says_and_the_scene_stays_as_it_is():
    scene, bar = pendulum(angle=0.5, rate=-1.0)
    before = pickle.loads(pickle.dumps(scene))
    run = rb.simulate(scene, until=2.0, initial={(bar, "rate"): 3.0})
    built, _ = pendulum(angle=0.5, rate=3.0)
    same(run, rb.simulate(built, until=2.0), "bar")
    same(run, rb.simulate(scene, until=2.0, initial={("bar", "rate"): 3.0}), "bar")
    assert run[bar].rate(0.0) == 3.0 and run[bar].angle(0.0) == 0.5
    assert scene == before
    assert rb.simulate(scene, until=2.0)[bar].rate(0.0) == -1.0


WORDS = [
    (rb.Particle(1.0), rb.Free(), {"position": [1, 2, 3], "velocity": [0.5, 0, 0]}),
    (rb.Particle(1.0), rb.Rail(rb.Circle(1.0, [0, 0, -1], [1, 0, 0])), {"parameter": 0.3, "speed": 2.0}),
    (rb.Particle(1.0), rb.Rail(rb.Parabola(1.0, [1, 0, 0], [0, 0, 1])), {"arc_length": 0.3, "speed": 2.0}),
    (BRICK, rb.Free(), {"position": [1, 2, 3], "velocity": [0.5, 0, 0], "angular_velocity": [1, 2, 3]}),
    (BRICK, rb.Free(), {"attitude": rb.EulerAngles(0.3, 0.2, 0.1), "angular_velocity_world": [1, 2, 3]}),
    (BRICK, rb.Spherical(), {"attitude": [0.8, 0.6, 0, 0], "angular_velocity": [1, 2, 3]}),
    (BRICK, rb.Spherical(point=[0, 0, 0.1]), {"attitude": [0.8, 0.6, 0, 0], "angular_velocity_world": [1, 2, 3]}),
    (BRICK, rb.Revolute([0, 1, 0]), {"angle": 0.3, "rate": 2.0}),
    (BRICK, rb.Prismatic([0, 1, 1]), {"displacement": 0.3, "rate": 2.0}),
    (BRICK, rb.Universal([1, 0, 0], [0, 1, 0]), {"angles": [0.3, 0.2], "rates": [1.0, 2.0]}),
    (
        BRICK,
        rb.Cylindrical([0, 1, 0]),
        {"angle": 0.3, "rate": 2.0, "displacement": 0.1, "displacement_rate": -1.0},
    ),
    (
        BRICK,
        rb.Planar([1, 0, 0], [0, 0, 1]),
        {"position": [0.3, 0.2], "velocity": [1.0, 2.0], "angle": 0.1, "rate": -1.0},
    ),
]


@pytest.mark.parametrize("body, joint, words", WORDS)
def test_every_word_of_add_may_be_replaced_alone(body, joint, words):
    built = rb.Scene(gravity=DOWN)
    wanted = built.add(body, joint, name="it", **words)
    other = rb.Scene(gravity=DOWN)
    it = other.add(body, joint, name="it")
    for word, value in words.items():
        other.replace(it, **{word: value})
    assert other == built
    same(rb.simulate(other, until=0.5), rb.simulate(built, until=0.5), "it")
    # the rest stays as it is, in all its digits
    for word, value in words.items():
        built.replace(wanted, **{word: value})
        assert other == built
    third = rb.Scene(gravity=DOWN)
    third_it = third.add(body, joint, name="it")
    run = rb.simulate(third, until=0.5, initial={(third_it, word): value for word, value in words.items()})
    same(run, rb.simulate(built, until=0.5), "it")
    assert pickle.loads(pickle.dumps(other)) == other


def test_an_angular_velocity_in_the_world_stays_that_where_the_attitude_is_replaced():
    scene = rb.Scene()
    top = scene.add(BRICK, rb.Spherical(), angular_velocity_world=[1, 2, 3])
    scene = pickle.loads(pickle.dumps(scene))
    scene.replace(top, attitude=rb.EulerAngles(0.3, 0.2, 0.1))
    run = rb.simulate(scene, until=0.1)
    assert run[top].angular_velocity_world(0.0) == pytest.approx([1, 2, 3], abs=1e-15)
    scene.replace(top, angular_velocity=[1, 2, 3])
    scene.replace(top, attitude=rb.EulerAngles(1.3, 0.2, 0.1))
    assert rb.simulate(scene, until=0.1)[top].angular_velocity(0.0) == pytest.approx([1, 2, 3], abs=1e-15)


def test_the_same_mistakes_are_refused_with_the_same_words_as_by_add():
    bad = [
        (rb.Particle(1.0), rb.Free(), {"position": [0, np.nan, 0]}),
        (rb.Particle(1.0), rb.Free(), {"position": [0, 1]}),
        (rb.Particle(1.0), rb.Free(), {"velocity": "fast"}),
        (rb.Particle(1.0), rb.Rail(rb.Circle(1.0, [0, 0, -1], [1, 0, 0])), {"parameter": 1.0, "arc_length": 1.0}),
        (rb.Particle(1.0), rb.Rail(rb.Polynomial([[0, 0, 0], [1, 0, 0]])), {"speed": np.inf}),
        (BRICK, rb.Free(), {"attitude": [1, 1, 0, 0]}),
        (BRICK, rb.Free(), {"angular_velocity": [1, 0, 0], "angular_velocity_world": [1, 0, 0]}),
        (BRICK, rb.Revolute([0, 0, 1]), {"rate": np.nan}),
        (BRICK, rb.Universal([1, 0, 0], [0, 1, 0]), {"angles": [1, 2, 3]}),
    ]
    for body, joint, words in bad:
        with pytest.raises(rb.InvalidInput) as added:
            rb.Scene().add(body, joint, name="it", **words)
        scene = rb.Scene()
        it = scene.add(body, joint, name="it")
        before = pickle.loads(pickle.dumps(scene))
        with pytest.raises(rb.InvalidInput) as replaced:
            scene.replace(it, **words)
        assert str(replaced.value) == str(added.value)
        with pytest.raises(rb.InvalidInput) as started:
            rb.simulate(scene, until=1.0, initial={(it, word): value for word, value in words.items()})
        assert str(started.value) == str(added.value)
        assert scene == before


def test_words_of_other_joints_and_keys_that_are_none_are_refused():
    scene, bar = pendulum()
    with pytest.raises(TypeError, match='unexpected keyword "speed"; a body on a hinge starts with angle, rate'):
        scene.replace(bar, speed=1.0)
    with pytest.raises(rb.InvalidInput, match='bar has no "speed"; a body on a hinge starts with angle, rate'):
        rb.simulate(scene, until=1.0, initial={(bar, "speed"): 1.0})
    with pytest.raises(rb.InvalidInput, match='there is nothing named "rod"; there are "bar"'):
        rb.simulate(scene, until=1.0, initial={("rod", "rate"): 1.0})
    for key in (bar, "rate", (bar,), (bar, 3)):
        with pytest.raises(rb.InvalidInput, match="it is a handle or a name, and a word of add"):
            rb.simulate(scene, until=1.0, initial={key: 1.0})
    with pytest.raises(rb.InvalidInput, match="initial is 3.0; it is a mapping"):
        rb.simulate(scene, until=1.0, initial=3.0)
    _, other = pendulum()
    with pytest.raises(rb.InvalidInput, match="handle of another scene"):
        rb.simulate(scene, until=1.0, initial={(other, "rate"): 1.0})
    with pytest.raises(rb.InvalidInput, match="handle of another scene"):
        scene.replace(other, rate=1.0)


def test_a_plan_is_kept_where_only_the_start_changes():
    scene, bar = pendulum(angle=0.5)
    scene.apply(rb.Drag(linear=0.1), bar)
    assert rb.simulate(scene, until=0.5).statistics.planned
    for rate in (1.0, 2.0, -3.0):
        run = rb.simulate(scene, until=0.5, initial={(bar, "rate"): rate})
        assert not run.statistics.planned
        built, anew = pendulum(angle=0.5, rate=rate)
        built.apply(rb.Drag(linear=0.1), anew)
        same(run, rb.simulate(built, until=0.5), "bar")


def test_scenes_and_runs_are_asked_by_name():
    scene = rb.Scene(gravity=DOWN)
    ball = scene.add(rb.Particle(1.0), name="ball", position=[0, 0, 1])
    wall = scene.add(rb.Particle(2.0), position=[1, 0, 1])
    spring = scene.connect(rb.Spring(1.0), ball, wall)
    low = scene.watch("low", lambda now: now[ball].position[2])
    drag = scene.apply(rb.Drag(0.1), ball)
    assert scene["ball"] == ball and scene["low"] == low
    for handle in (ball, wall, spring, low, drag):
        assert scene[handle.name] == handle
    run = rb.simulate(scene, until=1.0)
    assert np.array_equal(run["ball"].position(0.5), run[ball].position(0.5))
    assert run["low"].value(0.5) == run[low].value(0.5)
    assert run[spring.name].length(0.5) == run[spring].length(0.5)
    for thing, name in ((scene, "Scene"), (run, "Trajectory")):
        with pytest.raises(rb.InvalidInput, match=f'{name}: there is nothing named "bell"; there are "ball", '):
            thing["bell"]
    with pytest.raises(rb.InvalidInput, match="the scene is empty"):
        rb.Scene()["ball"]
    copy = pickle.loads(pickle.dumps(scene))
    assert copy["ball"] == ball
