"""What is dropped flat and bounces on several corners at once, against the laws of impact written down by themselves.

A body whose corners all strike at once, straight below its centre of mass or on a level with it, moves up and down as a
ball does: with speeds e^k sqrt(2 g h), until sqrt(2 h / g) (1 + 2 e / (1 - e)) where what it falls on does not move so.
Along the surface each impact has an impulse of at most mu times that across it, against the slip, or what ends it.
"""

import math

import numpy as np
import pytest
import rbdyn as rb

G = 9.81


def dropped(seed, corners, *, mu, along=None, thick=False):
    """A body 1 m above a floor, or above a plate that is driven by a sin(w t) along a direction."""
    draw = np.random.default_rng(seed)
    m, b, h = draw.uniform(0.1, 5), draw.uniform(0.1, 2), draw.uniform(0.1, 2) if thick else 0.0
    e, a, w = float(draw.choice([0.3, 0.5, 0.7])), draw.uniform(0.02, 0.2), draw.uniform(0.5, 3)
    moment = m * draw.uniform(0.1, 1) * (b * b + h * h) / 3
    scene = rb.Scene(gravity=[0, 0, -G])
    floor = rb.Plane([0, 0, 1])
    if along is not None:
        slide = rb.Prismatic(along, motion=lambda t: a * np.sin(w * t))
        floor = scene.add(rb.RigidBody(1.0, [1, 1, 1]), slide).plane([0, 0, 1])
    body = rb.RigidBody(m, [moment] * 3)
    if len(corners) == 2:
        falls = scene.add(body, rb.Planar([1, 0, 0], [0, 0, 1]), position=[0, h + 1])
    else:
        falls = scene.add(body, position=[0, 0, h + 1])
    friction = rb.Coulomb(mu) if mu else None
    for x, y in corners:
        scene.contact(falls.point([x * b, y * b, -h]), floor, friction=friction, restitution=e)
    return scene, falls, e, lambda t: a * w * math.cos(w * t)


TWO, THREE, FOUR = ((-1, 0), (1, 0)), ((-1, 0), (0.5, -0.8), (0.5, 0.8)), ((-1, -1), (1, -1), (1, 1), (-1, 1))


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_a_box_on_a_floor_bounces_to_rest_where_the_series_ends(mu):
    for seed in range(30):
        scene, box, e, _ = dropped(seed, TWO, mu=mu, thick=True)
        run = rb.simulate(scene, 5.0)
        (last,) = (event for event in run.events if event.kind == "accumulation")
        exact = math.sqrt(2 / G) * (1 + 2 * e / (1 - e))
        assert abs(last.time - exact) < max(run.error, 1e-13) * exact
        assert abs(run[box].angle(5.0)) < 1e-12 and not run[box].velocity(5.0).any()


def slowed(speed, e, mu, surface):
    """The velocity along the surface, and when, as the bounces end: impact by impact."""
    fall, t = math.sqrt(2 * G), math.sqrt(2 / G)
    while fall > 1e-17:
        slip = speed - surface(t)
        most = mu * (1 + e) * fall
        speed = surface(t) if abs(slip) <= most else speed - math.copysign(most, slip)
        fall *= e
        t += 2 * fall / G
    return speed, t


# four legs share their friction, and rounding decides which of them strikes first: some of these are refused
@pytest.mark.parametrize("corners", [TWO, THREE])
@pytest.mark.parametrize("mu", [0.0, 0.05, 0.3])
def test_a_plate_on_a_slide_that_is_driven_along_itself(mu, corners):
    for seed in range(12):
        scene, plate, e, surface = dropped(seed, corners, mu=mu, along=[1, 0, 0])
        speed, t = slowed(0.0, e, mu, surface)
        run = rb.simulate(scene, t + 0.5)
        (last,) = (event for event in run.events if event.kind == "accumulation")
        assert abs(last.time - t) < 1e-9 * t
        assert np.abs(run[plate].velocity(t + 1e-9) - [speed, 0, 0]).max() < 1e-8, seed


@pytest.mark.parametrize(("corners", "along"), [(TWO, [1, 0, 1]), (THREE, [1, 0, 1]), (FOUR, [0, 0, 1])])
@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_a_plate_on_one_that_is_driven_up_and_down_goes_with_it_in_the_end(mu, along, corners):
    for seed in range(6):
        scene, plate, _, surface = dropped(seed, corners, mu=mu, along=along)
        run = rb.simulate(scene, 4.0)
        up = np.array([0, 0, 1.0])
        rise = np.array(along)[2] / np.linalg.norm(along)
        assert abs(run[plate].velocity(4.0) @ up - surface(4.0) * rise) < 1e-9


@pytest.mark.parametrize("friction", [None, rb.Coulomb(0.5)])
@pytest.mark.parametrize("height", [0.5, 0.0])
def test_a_disc_that_comes_down_flat_ends_by_that_reason(height, friction):
    scene = rb.Scene(gravity=[0, 0, -G])
    disc = scene.add(rb.shapes.disc(1.0, 0.5, [0, 0, 1]), position=[0, 0, height])
    scene.contact(disc.disc(0.5, [0, 0, 1]), rb.Plane([0, 0, 1]), friction=friction)
    with pytest.raises(rb.IntegrationError, match="the disc of contact 1 has come to lie flat") as ended:
        rb.simulate(scene, 1.0)
    assert ended.value.run.status == "inconsistent"
    assert abs(ended.value.run.end - math.sqrt(2 * height / G)) < 1e-12


def test_a_disc_that_is_not_flat_by_1e_10_strikes_with_its_lowest_point():
    """P = (1 + e) v / (1/m + R^2/I) with I = m R^2 / 4 turns it at 4 P / (m R)."""
    radius, tilt, fall = 0.5, 1e-10, 0.5
    scene = rb.Scene(gravity=[0, 0, -G])
    leans = rb.EulerAngles(theta=tilt, psi=0.0, phi=0.0)
    disc = scene.add(rb.shapes.disc(1.0, radius, [0, 0, 1]), position=[0, 0, fall], attitude=leans)
    scene.contact(disc.disc(radius, [0, 0, 1]), rb.Plane([0, 0, 1]), restitution=0.5)
    run = rb.simulate(scene, 0.4, rtol=1e-12)
    first = run.events[0]
    assert first.kind == "impact" and abs(first.time - math.sqrt(2 * (fall - radius * tilt) / G)) < 1e-14
    turns = np.linalg.norm(run[disc].angular_velocity(first.time, side="after"))
    assert abs(turns - 4 * 1.5 / 5 * G * first.time / radius) < 1e-8


def test_bounces_without_loss_that_are_more_than_asked_for_are_a_step_limit():
    scene = rb.Scene(gravity=[0, 0, -G])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1e-6])
    scene.contact(ball, rb.Plane([0, 0, 1]), restitution=1.0)
    run = rb.simulate(scene, 1.0, max_steps=500, rtol=1e-9)
    assert run.status == "step limit" and 499 <= len(run.events) <= 501
    between = 2 * math.sqrt(2e-6 / G)
    assert abs(run.events[-1].time - (len(run.events) - 0.5) * between) < 1e-9 * run.end
    # and goes on
    later = rb.simulate(run, 0.9)
    assert later.status == "reached end" and abs(later.energy(0.9) - run.energy(0.0)) < 1e-12


def test_what_spins_about_the_vertical_and_comes_down_flat_goes_on_spinning():
    """On smooth legs all around, that strike at one instant, whatever rounding has made of how the body lies by then:
    it goes up with e times its speed. One leg after another would turn it over."""
    for seed, error in [(seed, 1e-11) for seed in range(120)] + [(s, e) for s in range(60) for e in (1e-6, 1e-9)]:
        draw = np.random.default_rng(seed)
        up = draw.normal(size=3)
        up /= np.linalg.norm(up)
        one = np.cross(up, [1, 0, 0])
        one /= np.linalg.norm(one)
        e, spin, h, m = (
            float(draw.choice([0.3, 0.6, 1.0])),
            draw.uniform(-30, 30),
            draw.uniform(0.3, 2),
            draw.uniform(0.5, 3),
        )
        scene = rb.Scene(gravity=-G * up)
        plate = scene.add(
            rb.RigidBody(m, [0.3 * m, 0.3 * m, 0.5 * m]),
            position=up * (h + 0.3),
            attitude=np.stack([one, np.cross(up, one), up], 1),
            angular_velocity=[0, 0, spin],
        )
        legs = 3 + seed % 2
        for k in range(legs):
            angle = 2 * math.pi * (k + 0.5) / legs
            scene.contact(plate.point([math.cos(angle), math.sin(angle), -0.3]), rb.Plane(up), restitution=e)
        # where it is highest again
        top = math.sqrt(2 * h / G) * (1 + e)
        run = rb.simulate(scene, top, error=error)
        allowed = max(1e-9, 10 * error * math.sqrt(2 * G * h))
        assert abs(run[plate].velocity(top) @ up) < allowed, (seed, error)
        assert np.abs(run[plate].angular_velocity(top) - [0, 0, spin]).max() < allowed, (seed, error)


def ridden(e, mass, aside, in_plane, is_ball):
    """A plate above a floor, on it a body that does not bounce on it."""
    scene, height = rb.Scene(gravity=[0, 0, -G]), 0.1
    joint = (rb.Planar([1, 0, 0], [0, 0, 1]),) if in_plane else ()

    def at(x, z):
        return [x, z] if in_plane else [x, 0, z]

    plate = scene.add(rb.shapes.box(1.0, [1, 1, 0.1]), *joint, position=at(0, height + 0.05))
    for x, y in TWO if in_plane else FOUR:
        scene.contact(plate.point([x / 2, y / 2, -0.05]), rb.Plane([0, 0, 1]), restitution=e)
    top = plate.plane([0, 0, 1], [0, 0, 0.05])
    if is_ball:
        rider = scene.add(rb.shapes.sphere(mass, 0.1), *joint, position=at(aside, height + 0.2))
        scene.contact(rider.sphere(0.1), top)
    else:
        rider = scene.add(rb.Particle(mass), position=[aside, 0, height + 0.1])
        scene.contact(rider, top)
    return scene, plate, rider, height


@pytest.mark.parametrize("e", [0.3, 0.5])
@pytest.mark.parametrize(
    ("mass", "aside", "in_plane", "is_ball"),
    [(1.0, 0.0, False, True), (1.0, 0.0, False, False), (1e-3, 0.1, False, True), (1.0, 0.0, True, True)]
    + [(1.0, 0.1, True, True)],
)
def test_what_rides_on_a_plate_bounces_with_it(e, mass, aside, in_plane, is_ball):
    """In each flight nothing presses it on the plate: forces of rounding made contacts open and close without end."""
    scene, plate, rider, height = ridden(e, mass, aside, in_plane, is_ball)
    run = rb.simulate(scene, 1.0, error=1e-8)
    (last,) = (event for event in run.events if event.kind == "accumulation")
    exact = math.sqrt(2 * height / G) * (1 + 2 * e / (1 - e))
    assert abs(last.time - exact) < max(run.error, 1e-12) * exact
    assert not any(event.kind == "detach" for event in run.events)
    first, n = math.sqrt(2 * height / G), 3
    # at the top of the third bounce
    t = first * (1 + 2 * e + 2 * e**2 + e**n)
    raised = height * e ** (2 * n)
    up = run[rider].position(t)[2] - run[rider].position(1.0)[2], run[plate].position(t)[2] - 0.05
    assert up == pytest.approx((raised, raised), rel=1e-8)


@pytest.mark.parametrize("feet", [0.0, 0.3])
@pytest.mark.parametrize("restitution", [0.0, 0.25])
def test_what_slides_on_a_block_that_bounces_flat_bounces_with_it(restitution, feet):
    """Nothing presses a bead on a block that flies: what strikes the block strikes both, and they go on together, as
    fast as the block's feet throw it back."""
    g, fall, half, e = 1.0, 0.75, 0.25, 0.5
    scene = rb.Scene(gravity=[0, -g, 0])
    block = scene.add(rb.RigidBody(1.0, [0.1] * 3), rb.Planar([1, 0, 0], [0, 1, 0]), position=[0, half + fall])
    bead = scene.add(rb.Particle(2.0), position=[0, 2 * half + fall, 0], velocity=[0.125, 0, 0])
    for x in (-0.5, 0.5):
        friction = rb.Coulomb(feet) if feet > 0 else None
        scene.contact(block.point([x, -half, 0]), rb.Plane([0, 1, 0]), restitution=e, friction=friction, name=f"{x}")
    top = block.plane([0, 1, 0], [0, half, 0])
    scene.contact(bead, top, restitution=restitution, friction=rb.Coulomb(1e-3))
    first = math.sqrt(2 * fall / g)
    run = rb.simulate(scene, 2.3 * first, rtol=1e-12)
    strikes = [event.time for event in run.events if event.kind == "impact" and event.name == "0.5"]
    assert len(strikes) == 2 and abs(strikes[0] - first) < 1e-13 and abs(strikes[1] - 2 * first) < 1e-13
    for flights, strike in enumerate(strikes, 1):
        for body in (block, bead):
            speed = run[body].velocity(strike, side="after")[1]
            assert abs(speed - g * first * e**flights) < 1e-12
    assert abs(run[bead].position(run.end)[1] - run[block].position(run.end)[1] - half) < 1e-12


@pytest.mark.parametrize("speed", [0.125, -0.5])
@pytest.mark.parametrize("mu", [0.1, 0.3, 0.6])
@pytest.mark.parametrize("restitution", [0.0, 0.25, 0.8])
@pytest.mark.parametrize("e", [0.2, 0.5, 0.7])
def test_what_sticks_to_a_block_that_bounces_flat_bounces_on_with_it(speed, mu, restitution, e):
    """An impact stops the bead on the block; then neither presses the other in flight, and both bounce as one does.
    It went on switching there, for rounding said that a force of zero had come to the edge of its cone."""
    g, fall, half = 1.0, 0.75, 0.25
    scene = rb.Scene(gravity=[0, -g, 0])
    block = scene.add(rb.RigidBody(1.0, [0.1] * 3), rb.Planar([1, 0, 0], [0, 1, 0]), position=[0, half + fall])
    bead = scene.add(rb.Particle(2.0), position=[0, 2 * half + fall, 0], velocity=[speed, 0, 0])
    for x in (-0.5, 0.5):
        scene.contact(block.point([x, -half, 0]), rb.Plane([0, 1, 0]), restitution=e, name=f"{x}")
    top = block.plane([0, 1, 0], [0, half, 0])
    scene.contact(bead, top, restitution=restitution, friction=rb.Coulomb(mu), name="bead")
    first = math.sqrt(2 * fall / g)
    end = first * (1 + 2 * e / (1 - e))
    run = rb.simulate(scene, end + 0.5, rtol=1e-12, max_steps=5000)
    assert run.status == "reached end"
    flights = first * (1 + 2 * np.cumsum(e ** np.arange(1, 8)))
    strikes = [event.time for event in run.events if event.kind == "impact" and event.name == "0.5"]
    assert strikes[1:7] == pytest.approx(flights[:6], rel=1e-12)
    assert max(event.time for event in run.events) == pytest.approx(end, rel=1e-9)
    for body in (block, bead):
        assert run[body].velocity(run.end) == pytest.approx([2 * speed / 3, 0, 0], abs=1e-12)
    assert run[bead].position(run.end)[1] == pytest.approx(2 * half, abs=1e-12)
