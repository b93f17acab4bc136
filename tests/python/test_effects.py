"""Scenes without some of their effects, and what each effect does."""

import math
import pickle
import subprocess
import sys

import numpy as np
import pytest
import rbdyn as rb

EFFECTS = (
    "gravity, rotation, spring, damper, drag, gravitation, central force, user force, user torque, drive, moving rail, "
    "dynamic friction, static friction, contact, impact"
)


@pytest.fixture
def swing():
    """A ball on a damped spring, with drag, a push and gravity."""
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    scene.add(rb.Particle(0.5), position=[1, 0, 0], velocity=[0, 1, 0])
    return scene


def test_a_scene_without_an_effect_moves_as_if_it_had_never_had_it(swing):
    never = rb.simulate(swing, 2.0)
    (ball,) = swing.bodies
    swing.apply(rb.Drag(quadratic=0.25), ball)
    spring = swing.connect(rb.Spring(stiffness=2.0, damping=0.5), ball, [0, 0, 1])
    run = rb.simulate(swing.without("drag", spring), 2.0)
    for t in np.linspace(0.0, 2.0, 7):
        assert np.array_equal(run[ball].position(t), never[ball].position(t))
    assert run.statistics.size == never.statistics.size
    assert run.statistics.steps == never.statistics.steps
    assert rb.plan(swing.without("spring")).effects == ["gravity", "damper", "drag"]
    assert rb.plan(swing).effects == ["gravity", "spring", "damper", "drag"]


def test_handles_stay_good_in_a_scene_with_less(swing):
    (ball,) = swing.bodies
    drag = swing.apply(rb.Drag(linear=0.25), ball)
    push = swing.apply(rb.Force([1.0, 0.0, 0.0]), ball)
    first = swing.connect(rb.Spring(stiffness=2.0), ball, [0, 0, 1])
    second = swing.connect(rb.Spring(stiffness=4.0), ball, [0, 1, 0])
    less = pickle.loads(pickle.dumps(swing.without(drag, first)))
    run = rb.simulate(less, 1.0)
    assert run.power(1.0, of=drag) == 0.0
    assert run.power(1.0, of=push) == pytest.approx(run[ball].velocity(1.0)[0], rel=1e-12)
    assert np.array_equal(run[first].force(1.0), [0, 0, 0])
    assert np.linalg.norm(run[second].force(1.0)) == pytest.approx(4.0 * run[second].length(1.0), rel=1e-12)


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ("drive", "without: this scene has no drive; it has gravity, drag"),
        ("contact", "without: this scene has no contact; it has gravity, drag"),
        ("wind", f'without: "wind" is no effect; the effects are {EFFECTS}; this scene has gravity, drag'),
        (3.0, "Scene.without: 3.0 is neither the name of an effect nor the handle of a load, coupling or contact"),
    ],
)
def test_what_a_scene_does_not_have_is_refused(swing, what, message):
    swing.apply(rb.Drag(linear=0.25), swing.bodies[0])
    with pytest.raises(rb.InvalidInput) as refused:
        swing.without(what)
    assert str(refused.value) == message


def test_a_handle_of_another_scene_is_refused(swing):
    other = rb.Scene()
    drag = other.apply(rb.Drag(linear=0.25), other.add(rb.Particle(1.0)))
    with pytest.raises(rb.InvalidInput, match="handle of another scene"):
        swing.without(drag)


def test_effects_tells_what_each_does(swing):
    swing.apply(rb.Force([1.0, 0.0, 0.0]), swing.bodies[0])
    table = rb.effects(swing, 1.0)
    assert [row.effect for row in table] == ["gravity", "user force"]
    assert len(table) == 2 and table[-1].effect == "user force"
    # x = 1 + t^2 and y = t; without the push x stays: 1 m of the extent, 2 m/s of the speed
    end = np.array([2.0, 1.0, -0.5 * 9.8125])
    extent = np.linalg.norm(end - [1, 0, 0])
    speed = math.hypot(2.0, 1.0, 9.8125)
    assert table["user force"].difference == pytest.approx(max(1.0 / extent, 2.0 / speed), rel=1e-9)
    assert table["gravity"].note == "" and table["gravity"].seconds > 0.0
    assert "user force" in str(table)
    with pytest.raises(rb.InvalidInput, match="no row"):
        table["drag"]


def test_events_are_gained_and_lost_by_friction():
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    belt = rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(0.5, 0.25), drive=0.25)
    block = scene.add(rb.Particle(1.0), belt)
    scene.connect(rb.Spring(stiffness=16.0), block, [0, 0, 0])
    scene.watch("middle", lambda now: now[block].position[0] - 0.2)
    table = rb.effects(scene, 20.0)
    # on a belt at rest the block stays where the spring is slack
    assert table["drive"].gained == table.events > 10
    assert table["drive"].lost == 0
    # without the surplus it does not jerk, but swings about the pull of the dynamic friction
    assert table["static friction"].difference > 0.1
    smooth = rb.simulate(scene.without("static friction", "dynamic friction"), 20.0)
    assert list(smooth.events) == []


def test_contacts_and_impacts_can_be_taken_away():
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1], velocity=[1, 0, 0])
    floor = scene.contact(ball, rb.Plane([0, 0, 1]), restitution=0.5, friction=rb.Coulomb(0.25))
    assert rb.plan(scene).effects == ["gravity", "dynamic friction", "static friction", "contact", "impact"]
    without = scene.without(floor)
    assert without == scene.without("contact") != scene
    assert rb.plan(without).effects == ["gravity"] and rb.plan(without).guards == []
    run = rb.simulate(pickle.loads(pickle.dumps(without)), 2.0)
    assert run[floor].gap(2.0) == pytest.approx(1 - 2 * 9.8125, rel=1e-14)
    assert run[floor].state(2.0) == "open" and list(run.events) == []
    soft = rb.simulate(scene.without("impact"), 2.0)
    # mu times the impulse of the landing is 1.1 m/s, more than it has
    (lands,) = soft.events.times("land", floor)
    assert soft[ball].velocity(np.nextafter(lands, 2.0)) == pytest.approx([0, 0, 0], abs=1e-9)
    table = rb.effects(scene, 0.5)
    assert table["contact"].gained == 1 and table["impact"].gained == 1
    with pytest.raises(rb.InvalidInput, match="handle of another scene"):
        rb.Scene().without(floor)


def test_an_exception_in_a_force_arrives_as_it_was_raised(swing):
    def fails(t, position, velocity):
        raise ZeroDivisionError("as it was raised")

    swing.apply(rb.Force(fails, trace=False), swing.bodies[0])
    with pytest.raises(ZeroDivisionError, match="as it was raised"):
        rb.effects(swing, 1.0)


def test_a_parameter_of_zero_takes_its_effect_out_of_the_plan(swing):
    k = rb.parameter(0.0, "k")
    (ball,) = swing.bodies
    without = rb.plan(swing)
    swing.apply(rb.Force(lambda t, position, velocity: -k * position), ball)
    for k.value in (0.0, 2.0, 0.0):
        plan = rb.plan(swing)
        assert ("user force" in plan.effects) == (k.value != 0.0)
        assert (plan.size == without.size) == (k.value == 0.0)
        assert rb.simulate(swing, 1.0).statistics.size == plan.size


def test_importing_rbdyn_loads_no_optional_package():
    program = "import sys, rbdyn; print(*{name.split('.')[0] for name in sys.modules})"
    loaded = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split()
    assert not {"matplotlib", "xarray", "pandas", "scipy", "numba", "tqdm", "rich"} & set(loaded)
