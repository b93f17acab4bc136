"""Strikes and stops that follow each other more closely than is known: told as one, or as not certain."""

import pytest
import rbdyn as rb

RADIUS = 0.25


def into_a_corner(wall, mu, spin=3.0):
    """A ball that falls beside the top of a hill, which is 1e-10 away: what rounding makes of that grows half a billion
    times until it strikes the floor, and at about that time the wall at x = `wall`. None: there is no wall."""
    scene = rb.Scene(gravity=[0, -9.8125, 0])
    body = rb.RigidBody(1.0, [0.4 * RADIUS**2] * 3)
    ball = scene.add(body, rb.Planar([1, 0, 0], [0, 1, 0]), position=[1 + 1e-10, 12.0], rate=spin)
    scene.apply(rb.Force(lambda t, r, v: [169.0 * (r[0] - 1) / (1 + (r[0] - 1) ** 2), 0, 0]), ball)
    friction = rb.Coulomb(mu) if mu > 0 else None
    scene.contact(ball.sphere(RADIUS), rb.Plane([0, 1, 0]), restitution=0.5, friction=friction)
    if wall is not None:
        scene.contact(ball.sphere(RADIUS), rb.Plane([-1, 0, 0], [wall, 0, 0]), restitution=0.5, friction=friction)
    return scene, ball


def floor_and_wall():
    scene, ball = into_a_corner(None, 0.0)
    run = rb.simulate(scene, 2.0, rtol=1e-14)
    (floor, *_) = run.events.times("impact")
    return floor, float(run[ball].position(floor)[0]) + RADIUS


@pytest.mark.parametrize("apart", [3e-11, 1e-10, 3e-10])
@pytest.mark.parametrize("side", [1, -1])
def test_which_of_two_that_feel_each_other_by_friction_alone_is_first_may_not_be_known(apart, side):
    """Their normals are at right angles through the centre: without friction either order is the same motion."""
    until, wall = floor_and_wall()
    with pytest.raises(rb.AccuracyError, match="cannot tell which events") as told:
        rb.simulate(into_a_corner(wall + side * apart, 0.3)[0], until + 0.1, error=1e-5)
    assert abs(told.value.run.certain_until - until) < 1e-8
    smooth = rb.simulate(into_a_corner(wall + side * apart, 0.0)[0], until + 0.05, error=1e-5)
    assert len(smooth.events.times("impact")) == 2


def test_and_the_motion_depends_on_it():
    until, wall = floor_and_wall()
    spins = []
    for side in (1, -1):
        scene, ball = into_a_corner(wall + side * 1e-5, 0.3)
        run = rb.simulate(scene, until + 0.01, error=1e-5)
        spins.append(run[ball].rate(until + 0.01))
    assert abs(spins[0] - spins[1]) > 0.1


@pytest.mark.parametrize("later", [1e-12, 3e-12])
def test_what_stops_within_the_rounding_of_speeds_stops_at_once(later):
    """Two particles that friction slows alike, one of them faster by so much: they would stop as much apart."""
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    bodies = [
        scene.add(rb.Particle(1.0), position=[0, y, 0], velocity=[speed, 0, 0]) for y, speed in ((0, 1), (1, 1 + later))
    ]
    for body in bodies:
        scene.contact(body, rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.25))
    # one motion of both
    scene.connect(rb.Spring(1e-3, rest_length=1.0), *bodies)
    run = rb.simulate(scene, 1.0, rtol=1e-12)
    first, second = run.events.times("stick")
    assert first == second and abs(first - 1 / (0.25 * 9.8125)) < 1e-14
