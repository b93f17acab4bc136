"""What would go wrong later is refused when it is given."""

import math

import numpy as np
import pytest
import rbdyn as rb


@pytest.fixture
def thrown():
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1], velocity=[1, 0, 2], name="ball")
    return scene, ball


# --- names ---


def test_names_given_twice_are_refused(thrown):
    scene, ball = thrown
    with pytest.raises(rb.InvalidInput, match='"ball" already; names differ'):
        scene.add(rb.Particle(1.0), name="ball")
    scene.watch("apex", lambda now: now[ball].velocity[2])
    with pytest.raises(rb.InvalidInput, match='a watch named "apex"'):
        scene.add(rb.Particle(1.0), name="apex")
    with pytest.raises(rb.InvalidInput, match='a body named "ball"'):
        scene.watch("ball", lambda now: now[ball].velocity[2])
    scene.connect(rb.Spring(1.0), ball, [0, 0, 0])
    with pytest.raises(rb.InvalidInput, match='a coupling named "spring 1"'):
        scene.add(rb.Particle(1.0), name="spring 1")


def test_names_that_are_found_differ_from_those_that_are_given(thrown):
    scene, ball = thrown
    scene.add(rb.Particle(1.0), name="particle 3")
    scene.add(rb.Particle(1.0))
    scene.add(rb.Particle(1.0), name="spring 1")
    scene.connect(rb.Spring(1.0), ball, [0, 0, 0])
    names = [h.name for h in (*scene.bodies, *rb.simulate(scene, 0.5).couplings)]
    assert len(set(names)) == len(names) == 5


def test_a_table_has_a_column_for_every_body(thrown):
    pandas = pytest.importorskip("pandas")
    scene, _ = thrown
    scene.add(rb.Particle(1.0), name="particle 3")
    scene.add(rb.Particle(1.0))
    frame = rb.simulate(scene, 1.0).sample([0.0, 1.0]).to_pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert len(frame.columns.get_level_values("name").unique()) == 3


def test_an_integral_that_has_the_name_of_one_the_scene_has_is_refused(thrown):
    scene, ball = thrown
    scene.integral("energy", lambda now: now[ball].kinetic_energy)
    with pytest.raises(rb.InvalidInput, match='integral: "energy" is one that this scene has by itself'):
        rb.simulate(scene, 1.0)
    # with drag the energy is none
    scene.apply(rb.Drag(0.1), ball)
    assert rb.simulate(scene, 1.0).drift["energy"] > 0


# --- watched functions ---

WRONG = {
    "attribute": (lambda now, b: now[b].pos, "BodyNow has no pos; it has acceleration, angle"),
    "attribute of now": (lambda now, b: now.t, "Now has no t; it has time"),
    "component after it": (lambda now, b: now[b].posiiton[2], "BodyNow has no posiiton"),
    "on one side": (lambda now, b: now[b].pos if now.time > 1 else 1.0, "BodyNow has no pos"),
    "of a rail": (lambda now, b: now[b].parameter, "ball is free"),
}


@pytest.mark.parametrize("what", WRONG)
@pytest.mark.parametrize("trace", [None, True, False])
def test_a_watch_that_asks_for_what_there_is_not_is_refused_when_it_is_given(thrown, what, trace):
    scene, ball = thrown
    function, message = WRONG[what]
    if trace is False and what in ("on one side", "of a rail"):
        pytest.skip("found when it is called: only one side is tried, and the scene may still change")
    with pytest.raises(rb.InvalidInput, match=message):
        scene.watch("w", lambda now: function(now, ball), trace=trace)
    with pytest.raises(rb.InvalidInput, match=message):
        scene.integral("i", lambda now: function(now, ball))


def test_a_watch_that_is_called_back_is_tried_out(thrown):
    scene, ball = thrown
    with pytest.raises(rb.InvalidInput, match="BodyNow has no pos"):
        scene.watch("w", lambda now: math.sin(now.time) + now[ball].pos[2])
    # what fails there for another reason may be right in a motion
    scene.watch("w", lambda now: math.sqrt(0.25 - now.time), trace=False)
    # and whoever asks first is answered
    scene.watch("v", lambda now: now[ball].pos if hasattr(now[ball], "pos") else now[ball].position[2])
    assert rb.simulate(scene, 0.1).events.times("v").size == 0


def test_a_watch_of_two_arguments_is_refused_when_it_is_given(thrown):
    scene, ball = thrown
    for function in (lambda now, t: now.time, lambda: 1.0, lambda now, *, t: t, np.cross):
        for trace in (None, True, False):
            with pytest.raises(rb.InvalidInput, match='watch "w": function .* it is called with one, now'):
                scene.watch("w", function, trace=trace)
        with pytest.raises(rb.InvalidInput, match='integral "i": function .* it is called with one, now'):
            scene.integral("i", function)
        with pytest.raises(rb.InvalidInput, match='watch "w": action: function .* it is called with one, now'):
            scene.watch("w", lambda now: now[ball].position[2], action=function)
    scene.watch("w", lambda now, level=0.5: now[ball].position[2] - level)


# --- error and rtol ---


def test_error_beside_rtol_is_refused(thrown):
    scene, _ = thrown
    for verb in (rb.simulate, rb.effects):
        with pytest.raises(rb.InvalidInput, match="both error 1e-09 and rtol 1e-06 are given"):
            verb(scene, 1.0, error=1e-9, rtol=1e-6)
    assert rb.simulate(scene, 1.0, rtol=1e-6).error is None
    assert rb.simulate(scene, 1.0).error <= 1e-9
    with pytest.raises(rb.InvalidInput, match="both error"):
        rb.simulate(rb.EulerTop(rb.RigidBody(1.0, [1, 2, 3]), 9.8), [0.5, 0, 0, 1, 1, 1], 1.0, error=1e-9, rtol=1e-6)


# --- what is said ---


def test_rotation_makes_a_difference_to_a_body_that_spins():
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    scene.add(rb.RigidBody(1.0, [1.0, 1.0, 2.0]), velocity=[1, 0, 2], angular_velocity=[0, 0, 3.0])
    # 3 rad after 1 s, and no turning instead of all there is
    assert rb.effects(scene, 1.0)["rotation"].difference == pytest.approx(3.0, rel=1e-9)
    # after a whole turn the attitude is what it was, but not the angular velocity
    assert rb.effects(scene, 2 * math.pi / 3)["rotation"].difference == pytest.approx(1.0, rel=1e-9)


def test_a_rotation_about_an_axis_that_was_computed_is_permanent():
    attitude = rb.EulerAngles(theta=0.7, psi=1.1, phi=-0.4)
    racket = rb.RigidBody(1.0, [1.0, 2.0, 3.0])
    turned = racket.rotated(attitude)
    axes = turned.principal().axes
    for k in range(3):
        motion = rb.PoinsotMotion(turned, 5.0 * axes[:, k])
        assert motion.is_permanent and motion.kind == "permanent"
        assert (motion.growth_rate > 0.0) == (k == 1)
    assert not rb.PoinsotMotion(racket, [1e-9, 1.0, 0.0]).is_permanent
    assert rb.PoinsotMotion(racket, [0.0, 0.0, 0.0]).kind == "rest"


def closed_form_of(scene):
    (line,) = (line for line in str(rb.plan(scene)).splitlines() if "closed form" in line)
    return line.strip()


def test_the_plan_says_why_equations_have_no_modes():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], name="ball")
    scene.connect(rb.Spring(4.0), ball, [0, 0, 0])
    assert "engine" in closed_form_of(scene)
    forced, varying, curved = (pickled(scene) for _ in range(3))
    forced.apply(rb.Force(lambda t, r, v: [np.tanh(t), 0, 0]), ball)
    assert "the equations of ball are linear, but what forces them varies in time otherwise" in closed_form_of(forced)
    varying.apply(rb.Force(lambda t, r, v: np.cos(t) * r), ball)
    assert "the equations of ball are linear, but their coefficients vary in time" in closed_form_of(varying)
    curved.apply(rb.Force(lambda t, r, v: -(r @ r) * r), ball)
    assert "the equations of ball are not linear" in closed_form_of(curved)


def pickled(scene):
    import pickle

    return pickle.loads(pickle.dumps(scene))


def test_the_plan_of_a_stiff_scene_does_not_praise_its_engine():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.connect(rb.Spring(1e8, rest_length=0.5, damping=1e8), ball, [0, 0, 0])
    scene.apply(rb.Drag(quadratic=0.1), ball)
    assert "cheapest" not in str(rb.plan(scene))
