"""Scenes as Python sees them: what they take, what they refuse and how, and the handles they give back."""

import copy
import math

import numpy as np
import pytest
import rbdyn as rb

CIRCLE = rb.Circle(radius=1.0, start=[0, 0, -1], toward=[1, 0, 0])


def test_a_handle_is_equal_to_itself_alone_and_can_be_a_key():
    scene = rb.Scene()
    a, b = scene.add(rb.Particle(1)), scene.add(rb.Particle(1), name="b")
    other = rb.Scene().add(rb.Particle(1))
    assert a == a and a != b and a != other and a != 0
    assert {a: 1, b: 2}[b] == 2
    assert b.name == "b"
    assert scene.bodies == [a, b]
    assert copy.deepcopy({"bead": a})["bead"] == a


def test_a_handle_of_another_scene_is_refused():
    scene, other = rb.Scene(), rb.Scene()
    a, b = scene.add(rb.Particle(1)), other.add(rb.Particle(1), name="stranger")
    with pytest.raises(rb.InvalidInput, match='"stranger" is a handle of another scene'):
        scene.apply(rb.Drag(1.0), b)
    with pytest.raises(rb.InvalidInput, match="another scene"):
        scene.connect(rb.Spring(1.0), a, b)
    run = rb.simulate(scene, 1.0)
    with pytest.raises(rb.InvalidInput, match="another scene"):
        run[b]
    with pytest.raises(rb.InvalidInput, match="another scene"):
        run.kinetic_energy(0.0, of=b)
    with pytest.raises(rb.InvalidInput, match="another scene"):
        run.events.times("stick", b)


def test_a_load_or_a_spring_is_not_a_body():
    scene = rb.Scene()
    bead = scene.add(rb.Particle(1))
    drag = scene.apply(rb.Drag(1.0), bead)
    spring = scene.connect(rb.Spring(1.0), bead, [1, 0, 0])
    with pytest.raises(rb.InvalidInput, match="not a body"):
        scene.apply(rb.Drag(1.0), spring)
    run = rb.simulate(scene, 1.0)
    with pytest.raises(rb.InvalidInput, match="load"):
        run[drag]


def test_a_copied_scene_is_independent_and_keeps_its_handles():
    scene = rb.Scene(gravity=[0, 0, -10])
    bead = scene.add(rb.Particle(2.0))
    for other in (copy.copy(scene), copy.deepcopy(scene)):
        other.gravity = [0, 0, 0]
        later = other.add(rb.Particle(1.0))
        assert rb.simulate(other, 1.0)[bead].position(1.0)[2] == 0.0
        with pytest.raises(rb.InvalidInput, match="another scene"):
            scene.apply(rb.Drag(1.0), later)
    assert rb.simulate(scene, 1.0)[bead].position(1.0)[2] == pytest.approx(-5.0, rel=1e-12)
    assert len(scene.bodies) == 1


def test_a_run_is_not_touched_by_what_happens_to_its_scene():
    scene = rb.Scene(gravity=[0, 0, -10])
    bead = scene.add(rb.Particle(2.0))
    run = rb.simulate(scene, 1.0)
    scene.gravity = [0, 0, 0]
    scene.add(rb.Particle(1.0))
    assert run[bead].acceleration(0.5)[2] == -10.0
    assert run.bodies == [bead]
    del scene
    assert run.momentum(1.0)[2] == pytest.approx(-20.0, rel=1e-12)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: rb.Scene(gravity=[0, -9.81]), r"Scene: gravity has shape \(2,\); a vector has three components"),
        (lambda: rb.Scene(gravity=[0, 0, np.nan]), "component 2 of gravity is nan"),
        (lambda: rb.Scene(gravity=[0, 0, np.inf]), "component 2 of gravity is inf"),
        (lambda: rb.Scene(gravity=-9.81), r"gravity has shape \(\)"),
        (lambda: rb.Scene(gravity=[[1, 2], [3]]), "gravity is"),
        (lambda: rb.Particle(0.0), "mass is 0"),
        (lambda: rb.Particle(np.nan), "mass is nan"),
        (lambda: rb.Coulomb(0.1, 0.2), "mu_dynamic is 0.2"),
        (lambda: rb.Coulomb(-0.1), "mu_static is -0.1"),
        (lambda: rb.Spring(-1.0), "stiffness is -1"),
        (lambda: rb.Drag(quadratic=-1.0), "quadratic is -1"),
        (lambda: rb.Force([1, 2]), r"Force: f has shape \(2,\)"),
        (lambda: rb.Force([0, 0, 1], frame="rail"), 'frame is "rail"; it is one of "world", "body"'),
        (lambda: rb.Rail(CIRCLE, drive=np.nan), "drive is nan"),
        (lambda: rb.Rail(CIRCLE, drive=[1, 2]), r"drive has shape \(2,\)"),
        (lambda: rb.Rail(CIRCLE, ends="bounce"), "ends"),
        (lambda: rb.Scene().add(rb.Particle(1), position=[0, 0]), r"position has shape \(2,\)"),
        (lambda: rb.Scene().add(rb.Particle(1), name="ball", velocity=[0, 0, np.inf]), "ball: component 2 of velocity"),
        (lambda: rb.Scene().add(rb.Particle(1), rb.Rail(CIRCLE), speed="fast"), "speed is 'fast'"),
        (lambda: rb.Scene().add(rb.Particle(1), rb.Rail(CIRCLE), parameter=1, arc_length=1), "both parameter"),
        (lambda: rb.simulate(rb.Scene(), 1.0), "0 bodies"),
        (lambda: rb.plan(rb.Scene()), "0 bodies"),
    ],
)
def test_a_scene_that_breaks_a_rule_is_refused_in_a_sentence(make, words):
    with pytest.raises(rb.InvalidInput, match=words) as caught:
        make()
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, rb.Error)


def test_a_wrong_keyword_names_the_right_ones():
    with pytest.raises(TypeError, match='unexpected keyword "angle".*position, velocity'):
        rb.Scene().add(rb.Particle(1), angle=1.0)
    with pytest.raises(TypeError, match='unexpected keyword "velocity".*parameter, arc_length, speed'):
        rb.Scene().add(rb.Particle(1), rb.Rail(CIRCLE), velocity=1.0)


def test_both_ends_of_a_spring_cannot_be_the_world():
    scene = rb.Scene()
    bead = scene.add(rb.Particle(1))
    with pytest.raises(rb.InvalidInput, match="both ends"):
        scene.connect(rb.Spring(1.0), [0, 0, 0], [1, 0, 0])
    with pytest.raises(rb.InvalidInput, match="same body"):
        scene.connect(rb.Spring(1.0), bead, bead)


def test_arc_length_places_a_bead_where_the_parameter_would():
    scene = rb.Scene()
    hoop = rb.Rail(rb.Circle(radius=2.0, start=[1, 0, 0], toward=[0, 1, 0]))
    a = scene.add(rb.Particle(1), hoop, parameter=0.75, speed=1.0)
    b = scene.add(rb.Particle(1), hoop, arc_length=1.5, speed=1.0)
    run = rb.simulate(scene, 1.0)
    assert run[a].parameter(0.0) == run[b].parameter(0.0) == 0.75
    assert run[b].arc_length(0.0) == 1.5


def test_everything_says_what_it_is():
    scene = rb.Scene(gravity=[0, 0, -1])
    bead = scene.add(rb.Particle(1.5), rb.Rail(CIRCLE, friction=rb.Coulomb(0.5), drive=2.0))
    assert repr(scene) == "<Scene: gravity [0, 0, -1], 1 body, 0 loads, 0 couplings>"
    assert repr(bead) == "<Handle: bead 1>"
    assert repr(rb.Particle(1.5)) == "Particle(mass=1.5)"
    assert repr(rb.Coulomb(0.5)) == "Coulomb(mu_static=0.5, mu_dynamic=0.5)"
    assert repr(rb.Spring(1, damping=2)) == "Spring(stiffness=1, rest_length=0, damping=2)"
    assert repr(rb.Drag(1, 2)) == "Drag(linear=1, quadratic=2)"
    assert repr(rb.Force([0, 0, 1])) == "Force([0, 0, 1])"
    assert "drive=2" in repr(rb.Rail(CIRCLE, friction=rb.Coulomb(0.5), drive=2.0))


def test_the_plan_names_what_the_scene_calls_for_and_what_it_does_not():
    scene = rb.Scene(gravity=[0, 0, -1])
    scene.add(rb.Particle(1.5), rb.Rail(CIRCLE, friction=rb.Coulomb(0.5, 0.25)))
    plan = rb.plan(scene)
    assert plan.effects == ["gravity", "dynamic friction", "static friction"]
    assert "rotation" in [omission.what for omission in plan.omissions]
    assert plan.engine == "taylor" and plan.integrals == []
    assert str(plan).startswith("Plan\n") and not str(plan).endswith("\n")
    assert rb.simulate(scene, 1.0).plan.effects == plan.effects


def thrown(**velocity):
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(1.0), position=[0, 7, 10], name="ball", **velocity)
    scene.apply(rb.Drag(linear=0.1, quadratic=0.02), ball)
    return scene, ball


def test_a_throw_in_a_plane_is_simulated_in_two_coordinates_and_seen_in_three():
    scene, ball = thrown(velocity=[20, 0, 15])
    plan = rb.plan(scene)
    assert plan.coordinates == ["ball: x, z in the world"]
    why = {omission.what: omission.why for omission in plan.omissions}
    assert why["y, vy of ball"] == "stay as they start; a force, velocity or start along y brings them in"
    assert "  state       4 of 6 variables are simulated\n" in str(plan)
    run = rb.simulate(scene, 3.0)
    positions = run[ball].position(np.linspace(0, 3, 7))
    assert positions.shape == (7, 3) and np.all(positions[:, 1] == 7.0)
    # turned out of its plane the motion is the same
    scene, ball = thrown(velocity=[12, 16, 15])
    assert rb.plan(scene).coordinates == ["ball: x, y, z in the world"]
    turned = rb.simulate(scene, 3.0)[ball].position(3.0) - [0, 7, 0]
    assert [np.hypot(*turned[:2]), turned[2]] == pytest.approx(positions[-1][[0, 2]], rel=1e-9)


def test_what_is_called_back_may_be_anything():
    scene, ball = thrown(velocity=[20, 0, 15])
    scene.apply(rb.Force(lambda t, r, v: [0, math.cos(t), 0]), ball)
    assert rb.plan(scene).coordinates == ["ball: x, y, z in the world"]
    assert rb.simulate(scene, 3.0)[ball].position(3.0)[1] > 7.5


def test_where_nothing_moves_the_plan_says_what_would():
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, [1, 2, 3]), name="body")
    plan = rb.plan(scene)
    assert plan.coordinates == ["body: none, it stays as it starts"]
    assert "rotation" not in plan.effects
    assert "motion of body: it stays as it starts; a force, a moment or a velocity brings it in" in str(plan)
    run = rb.simulate(scene, 2.0)
    assert run.status == "reached end" and run.end == 2.0
    assert run[body].quaternion(1.0).tolist() == [1, 0, 0, 0]
