"""Where bounces with friction end: in corners, against walls that nothing presses on, and in flight beside each other.

Truths: what two contacts at right angles leave of a ball's motion (nothing), impact by impact by hand, and free flight.
"""

import math

import numpy as np
import pytest
import rbdyn as rb

G = 9.8125
# below that the events by hand go on
LAST = 1e-15


@pytest.mark.parametrize("seed", range(40))
def test_a_ball_that_lands_in_a_corner_is_at_rest_to_the_bit(seed):
    """It rolls down the wall: floor and wall together stop all of it; it went on rolling at 1e-17 rad/s."""
    rng = np.random.default_rng(seed)
    radius, mass, speed = rng.uniform(0.1, 0.4), rng.uniform(0.5, 3.0), rng.uniform(0.01, 0.2)
    moment = rng.uniform(0.3, 0.9) * mass * radius**2
    scene = rb.Scene(gravity=[0, -G, 0])
    b = scene.add(
        rb.RigidBody(mass, [moment / 2, moment / 2, moment]),
        rb.Planar([1, 0, 0], [0, 1, 0]),
        position=[-radius, radius + rng.uniform(0, 1e-3)],
        velocity=[0, -speed],
        rate=-speed / radius,
    )
    for plane in rb.Plane([0, 1, 0]), rb.Plane([-1, 0, 0]):
        scene.contact(b.sphere(radius), plane, friction=rb.Coulomb(0.7))
    run = rb.simulate(scene, 1e5, rtol=1e-12)
    # what the wall does not press is held by no row, and its acceleration is one of rounding
    assert max(np.abs(run[b].velocity(1e5)).max(), np.abs(run[b].angular_velocity(1e5)).max()) < 1e-25
    assert (run[b].position(0.2) == run[b].position(1e5)).all() and run[b].angle(0.2) == run[b].angle(1e5)


def bounced_to_rest(radius, mass, moment, slope, mu, e, v, omega, gap):
    """When it strikes the wall, and when the last bounce ends, by hand.

    It slides on the floor to the wall, is thrown up by its friction, lands.
    """
    strikes = []
    t, pull, down = 0.0, G * math.sin(slope), G * math.cos(slope)
    while max(abs(v), abs(radius * omega)) > LAST:
        # along the floor, in two parts where its slip turns round
        while True:
            way = math.copysign(1.0, v + radius * omega)
            a, turn = pull - mu[0] * down * way, -way * mu[0] * mass * down * radius / moment
            until = (-v + math.sqrt(v * v + 2 * a * gap)) / a
            stops = -(v + radius * omega) / (a + radius * turn)
            d = min(until, stops) if stops > 0 else until
            gap -= v * d + a * d * d / 2
            v, omega, t = v + a * d, omega + turn * d, t + d
            if d == until:
                break
            # it rolls for an instant, and slips the other way from there, by a bit
            omega = -v / radius
            omega -= way * abs(omega) * 1e-15
        strikes.append(t)
        # the wall pushes it back, and its friction up, until nothing slips there
        assert omega < 0
        rubs = min(mu[1] * (1 + e) * mass * v, -omega * radius / (1 / mass + radius**2 / moment))
        v, up, omega = -e * v, rubs / mass, omega + rubs * radius / moment
        d = 2 * up / down
        gap, v, t = -(v * d + pull * d * d / 2), v + pull * d, t + d
        way = math.copysign(1.0, v + radius * omega)
        v, omega = v - way * mu[0] * up, omega - way * mu[0] * mass * up * radius / moment
        gap = max(gap, 0.0)
    return strikes, t


def test_a_ball_bounces_to_rest_in_a_corner():
    """Every impact on the wall throws it off the floor: what went on were a thousand events within 1e-10 s."""
    radius, mass, moment, slope, mu, e = 0.171875, 2.25, 0.055, 0.5, (0.1, 0.1), 0.7
    scene = rb.Scene(gravity=[G * math.sin(slope), -G * math.cos(slope), 0])
    b = scene.add(
        rb.RigidBody(mass, [moment / 2, moment / 2, moment]),
        rb.Planar([1, 0, 0], [0, 1, 0]),
        position=[-radius - 0.0625, radius],
        velocity=[0.9, 0.0],
        rate=-0.9,
    )
    floor = scene.contact(b.sphere(radius), rb.Plane([0, 1, 0]), friction=rb.Coulomb(mu[0]))
    wall = scene.contact(b.sphere(radius), rb.Plane([-1, 0, 0]), friction=rb.Coulomb(mu[1]), restitution=e)
    run = rb.simulate(scene, 3.0, error=1e-7, max_steps=2000)
    assert run.status == "reached end"
    strikes, end = bounced_to_rest(radius, mass, moment, slope, mu, e, 0.9, -0.9, 0.0625)
    # places of the wall are known to 5e-17 m, and a flight as low takes 5e-9 s
    assert abs(run.events[-1].time / end - 1) < run.error < 1e-7
    # what slides on the floor meanwhile is followed beyond doubles to each of them: they were up to 4e-10 s off
    struck = np.array([x.time for x in run.events if x.kind == "impact"])
    assert struck.size > 30 and np.abs(struck - strikes[: struck.size]).max() < 4e-15
    assert not run[b].velocity(3.0).any() and not run[b].angular_velocity(3.0).any()
    assert [run[contact].state(3.0) for contact in (floor, wall)] == ["sticks", "sticks"]


@pytest.mark.parametrize("turns", [1e-7, 1e-6, 1e-5, 1e-3])
@pytest.mark.parametrize("way", [0.1, 1.0, 2.0, 3.0])
def test_balls_that_fly_along_touching_do_not_hold_each_other(way, turns):
    """Rolling on each other they part as what flies straight on does; a contact that pulled held them together."""
    radii, masses = np.array([0.2, 0.3]), (1.0, 2.0)
    normal = np.array([math.cos(way), math.sin(way)])
    across = np.array([-normal[1], normal[0]])
    scene = rb.Scene(gravity=[1.0, -G, 0])
    starts = np.array([0.0, 1.0]), np.array([0.0, 1.0]) + radii.sum() * normal
    speeds = np.array([1.0, 2.0]), np.array([1.0, 2.0]) + turns * radii.sum() * across
    balls = [
        scene.add(
            rb.RigidBody(m, [0.01 * m, 0.01 * m, 0.02 * m]),
            rb.Planar([1, 0, 0], [0, 1, 0]),
            position=list(x),
            velocity=list(v),
            rate=turns,
        )
        for m, x, v in zip(masses, starts, speeds, strict=True)
    ]
    contact = scene.contact(balls[0].sphere(0.2), balls[1].sphere(0.3), friction=rb.Coulomb(0.3))
    run = rb.simulate(scene, 0.3, rtol=1e-12)
    t = np.linspace(0.01, 0.3, 30)
    assert not run[contact].force(t).any()
    for b, x, v in zip(balls, starts, speeds, strict=True):
        free = x[:, None] + np.outer(v, t) + np.outer([1.0, -G], t * t / 2)
        assert np.abs(run[b].position(t)[:, :2].T - free).max() < 1e-15
        assert np.allclose(run[b].angular_velocity(t)[:, 2], turns, rtol=1e-8)
    # (r^2 + (u t)^2)^(1/2) - r
    apart = (turns * t) ** 2 * radii.sum() / 2
    assert np.abs(run[contact].gap(t) / apart - 1).max() < 1e-6 + 2e-15 / apart.min()


@pytest.mark.parametrize("apex", [(0.0, 0.0), (0.25, 0.5)])
@pytest.mark.parametrize("e", [0.0, 0.5, 0.7, 0.8])
@pytest.mark.parametrize(("left", "right"), [((1, 0.25), (-1, 0.5)), ((1, 0.2), (-1, 0.2)), ((1, 0.17), (-1, 4.7))])
def test_a_particle_that_has_come_to_rest_in_a_corner_stays_there(left, right, e, apex):
    """What rounding left of its acceleration had no size beside it at the origin: steps of 6e-9 s went on without end,
    and it moved by bits."""
    scene = rb.Scene(gravity=[0, -9.8125, 0])
    ball = scene.add(rb.Particle(1.0), position=[apex[0] + 0.1, apex[1] + 1.0, 0], velocity=[0.3, 0, 0])
    for normal in (left, right):
        scene.contact(ball, rb.Plane([*normal, 0], [*apex, 0]), restitution=e)
    run = rb.simulate(scene, 1e5, max_steps=3000)
    assert run.status == "reached end"
    assert np.array_equal(run[ball].velocity(1e5), [0, 0, 0])
    assert np.abs(run[ball].position(1e5) - [*apex, 0]).max() <= 4e-16
    assert np.array_equal(run[ball].position(1e5), run[ball].position(100.0))


@pytest.mark.parametrize("seed", [0, 3, 4, 8, 9, 11, 14])
def test_a_corner_that_never_slips_bounces_to_an_end_and_slides_where_it_would_have_to_be_pulled(seed):
    """As with a very large coefficient. The impulse along the surface is that of a least speed, below which what comes
    is thrown back quicker than it came, as often slower: its bounces had no end (5 of 8 such boxes)."""
    rng = np.random.default_rng(seed)
    size = np.array([0.9, 0.32, 0.53]) * (1 + 0.05 * rng.normal(size=3))
    spin = np.array([0.7, -4.1, 3.8]) * (1 + 0.05 * rng.normal(size=3))
    square = size**2
    corners = [np.array([x, y, z]) * size / 2 for z in (-1, 1) for x in (-1, 1) for y in (-1, 1)]

    def events(friction):
        scene = rb.Scene(gravity=[4.7, 0, -8.6])
        box = scene.add(
            rb.RigidBody(2.0, np.diag(square.sum() - square) / 6),
            position=[0, 0, size[2] / 2],
            velocity=-np.cross(spin, corners[0]),
            angular_velocity_world=spin,
        )
        for corner in corners:
            scene.contact(box.point(corner), rb.Plane([0, 0, 1]), friction=rb.Coulomb(friction), restitution=0.5)
        run = rb.simulate(scene, 0.3, rtol=1e-9, max_steps=1500)
        assert run.status == "reached end"
        return [e for e in run.events if e.kind != "impact"]

    without, much = events(np.inf), events(1e6)
    assert "accumulation" in [e.kind for e in without]
    assert [(e.kind, e.name) for e in without] == [(e.kind, e.name) for e in much]
    # one over the coefficient apart, which grows
    assert [e.time for e in without] == pytest.approx([e.time for e in much], abs=1e-5)
