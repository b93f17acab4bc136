"""Springs with a rest length whose ends are at one place: what has a direction moves, what has none is named.

At distance zero the force has its size, stiffness times rest length, and the direction in which the ends part: that of
their velocity, or, at rest, that in which everything else accelerates them, for motions from close by all turn there.
"""

import numpy as np
import pytest
import rbdyn as rb

STIFFNESS, LENGTH = 20.0, 0.5
ENGINES = [e for e in rb.engines() if e != "closed form"]


def spring(damping=0.0):
    return rb.Spring(STIFFNESS, rest_length=LENGTH, damping=damping)


def along(gravity, speed, t):
    """x'' = g - k (x - l) on the positive side, from x = 0."""
    omega = np.sqrt(STIFFNESS)
    middle = LENGTH + gravity / STIFFNESS
    return middle - middle * np.cos(omega * t) + speed / omega * np.sin(omega * t)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("damping", [0.0, 1.0])
def test_at_rest_with_nothing_else_there_is_no_direction_and_the_run_says_of_what(engine, damping):
    scene = rb.Scene()
    bead = scene.add(rb.Particle(1.0), name="bead")
    scene.connect(spring(damping), bead, [0, 0, 0])
    with pytest.raises(rb.IntegrationError) as caught:
        rb.simulate(scene, until=2.0, error=1e-6, engine=engine)
    message = str(caught.value)
    assert "the spring of bead and a point of the world" in message
    assert "force of 10 N has no direction" in message
    assert "a little apart, or part with a velocity" in message
    # named where it is, not after a million steps that lead nowhere
    assert caught.value.run.end < 1e-5
    assert caught.value.run.statistics.steps < 100


def test_two_bodies_that_move_on_together_are_named():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    one = scene.add(rb.Particle(1.0), velocity=[1, 0.3, 0], name="one")
    other = scene.add(rb.Particle(2.0), velocity=[1, 0.3, 0], name="other")
    scene.connect(spring(), one, other)
    with pytest.raises(rb.IntegrationError, match="the spring of one and other, whose ends are at one place"):
        rb.simulate(scene, until=2.0)


def test_a_body_of_a_mechanism_is_named():
    scene = rb.Scene()
    arm = scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.1]), rb.Revolute([0, 1, 0], at=[0, 0, 1]), name="arm")
    bob = scene.add(rb.Particle(1.0), rb.Free(), position=[1, 0, 0], name="bob")
    scene.connect(spring(), arm.point([0, 0, -1]), [0, 0, 0])
    scene.constrain(rb.Rod(length=1.0), bob, [2, 0, 0])
    with pytest.raises(rb.IntegrationError, match="the spring of arm and a point of the world, whose ends"):
        rb.simulate(scene, until=2.0)


def test_a_central_force_is_named_too():
    scene = rb.Scene()
    bead = scene.add(rb.Particle(1.0), name="bead")
    scene.connect(rb.Central(lambda r: 3.0 - r), bead, [0, 0, 0])
    with pytest.raises(rb.IntegrationError, match="force of 3 N has no direction"):
        rb.simulate(scene, until=2.0)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("gravity", [1.0, 30.0])
def test_at_rest_it_leaves_the_way_everything_else_pulls(engine, gravity):
    # across no axis, so that no component is zero
    down = np.array([1.0, -2.0, 2.0]) / 3.0
    scene = rb.Scene(gravity=gravity * down)
    bead = scene.add(rb.Particle(1.0))
    scene.connect(spring(), bead, [0, 0, 0])
    until, error = 1.2, 1e-6
    run = rb.simulate(scene, until=until, error=error, engine=engine)
    reach = 2 * (LENGTH + gravity / STIFFNESS)
    for t in np.linspace(0.1, until, 12):
        expected = along(gravity, 0.0, t) * down
        assert np.linalg.norm(run[bead].position(t) - expected) <= error * reach


@pytest.mark.parametrize("engine", ENGINES)
def test_with_a_velocity_it_leaves_along_that_and_may_pass_again(engine):
    way = np.array([2.0, 1.0, -2.0]) / 3.0
    scene = rb.Scene()
    bead = scene.add(rb.Particle(1.0), velocity=1.5 * way)
    scene.connect(spring(), bead, [0, 0, 0])
    period, error = 2 * np.pi / np.sqrt(STIFFNESS), 1e-6
    # half an oscillation about the middle and what is beyond it, then the same on the other side
    omega = np.sqrt(STIFFNESS)
    back = (np.pi + 2 * np.arctan(LENGTH * omega / 1.5)) / omega
    assert abs(along(0.0, 1.5, back)) < 1e-12
    run = rb.simulate(scene, until=back + 0.5 * period, error=error, engine=engine)
    for t in np.linspace(0.05, back + 0.5 * period, 20):
        x = along(0.0, 1.5, t) if t <= back else -along(0.0, 1.5, t - back)
        assert np.linalg.norm(run[bead].position(t) - x * way) <= 3 * error


def test_a_force_that_begins_later_says_the_direction():
    scene = rb.Scene()
    bead = scene.add(rb.Particle(1.0))
    scene.connect(spring(), bead, [0, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [0.0, 3 * t**2, 0.0]), bead)
    run = rb.simulate(scene, until=1.0, error=1e-9)
    x, y, z = run[bead].position(1.0)
    # x'' = 3 t^2 - k (x - l): a parabola and an oscillation
    omega = np.sqrt(STIFFNESS)
    late = 6 / STIFFNESS**2
    expected = 3 / STIFFNESS - late + LENGTH + (late - LENGTH) * np.cos(omega)
    assert abs(y - expected) <= 1e-9 and x == z == 0.0
