"""The event `rest`: a body comes to rest on what it touches."""

import numpy as np
import pytest
import rbdyn as rb

GRAVITY = 9.8125


def told(run):
    return [(e.kind, e.name) for e in run.events]


def block_on_incline(static, until=2.0):
    """Thrown up an incline of slope 3/4 at 3 m/s."""
    scene = rb.Scene(gravity=[0, -GRAVITY, 0])
    block = scene.add(rb.Particle(1.0), velocity=[2.4, 1.8, 0], name="block")
    scene.contact(block, rb.Plane([-3, 4, 0]), friction=rb.Coulomb(static, 0.5), name="touch")
    return block, rb.simulate(scene, until=until, error=1e-11)


def test_a_block_that_slides_to_its_stop_and_stays_comes_to_rest():
    block, run = block_on_incline(0.8)
    stop = 3.0 / 9.8125  # slowed by 0.6 g + 0.5 * 0.8 g = g
    assert [e.kind for e in run.events] == ["stick", "rest"]
    (rest,) = (e for e in run.events if e.kind == "rest")
    assert rest.subject == block and rest.name == "block"
    assert rest.time == pytest.approx(stop, abs=1e-12) and rest.time == run.events.times("stick")[0]
    assert np.array_equal(run[block].velocity(2.0), [0, 0, 0])


def test_a_block_that_turns_back_does_not():
    _, run = block_on_incline(0.7)
    assert [e.kind for e in run.events] == ["reverse"]


@pytest.mark.parametrize("rolling", [0.0, 0.004])
def test_a_ball_that_rolls_is_not_at_rest_until_it_stops(rolling):
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    ball = scene.add(rb.shapes.sphere(mass=0.5, radius=0.1), position=[0, 0, 0.1], velocity=[2, 0, 0], name="ball")
    scene.contact(ball.sphere(0.1), rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.25, rolling=rolling), name="touch")
    run = rb.simulate(scene, until=60.0, error=1e-10)
    kinds = [e.kind for e in run.events]
    assert kinds == (["stick", "stick", "rest"] if rolling else ["stick"])
    if rolling:
        assert run.events[2].time == run.events[1].time and run.events[2].subject == ball


def dropped(restitution, velocity=0.0):
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    stone = scene.add(rb.Particle(1.0), position=[0, 0, 1], velocity=[velocity, 0, 0], name="stone")
    scene.contact(stone, rb.Plane([0, 0, 1]), restitution=restitution, name="touch")
    return rb.simulate(scene, until=5.0, error=1e-10)


def test_what_lands_and_stays_comes_to_rest():
    run = dropped(0.0)
    assert told(run) == [("land", "touch"), ("rest", "stone")]
    assert run.events[1].time == pytest.approx(np.sqrt(2 / GRAVITY), abs=1e-12)


def test_what_lands_and_glides_does_not():
    assert told(dropped(0.0, velocity=1.0)) == [("land", "touch")]


def test_after_bounces_without_end_neither_lands_nor_rests():
    run = dropped(0.5)
    assert {e.kind for e in run.events} == {"impact", "accumulation"}


def test_a_box_comes_to_rest_with_its_last_corner():
    scene = rb.Scene(gravity=[0, -GRAVITY, 0])
    box = scene.add(
        rb.shapes.box(1.0, [1.0, 0.5, 0.5]),
        rb.Planar([1, 0, 0], [0, 1, 0]),
        position=[0, 0.75],
        angle=0.25,
        name="box",
    )
    for side, x in (("left", -0.5), ("right", 0.5)):
        scene.contact(box.point([x, -0.25, 0]), rb.Plane([0, 1, 0]), friction=rb.Coulomb(np.inf), name=side)
    run = rb.simulate(scene, until=3.0, error=1e-10)
    assert run.events[-1].kind == "rest" and run.events[-1].subject == box
    assert run.events[-1].time == run.events.times("land")[-1]
    assert [e.kind for e in run.events].count("rest") == 1


def test_a_block_comes_to_rest_on_one_that_moves_on():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    lower = scene.add(rb.RigidBody(3.0, [1, 1, 1]), rb.Prismatic([1, 0, 0]), rate=4.0, name="lower")
    post = scene.add(rb.Particle(1.0), position=[0, 0, 0.5], velocity=[4.0, 0, 0], name="upper")
    scene.contact(post, lower.plane([0, 0, 1], point=[0, 0, 0.5]), friction=rb.Coulomb(0.5), name="on")
    scene.watch("kick", lambda now: now.time - 0.1, action=lambda now: {post: {"velocity": [5.0, 0, 0]}})
    run = rb.simulate(scene, until=2.0, error=1e-10)
    # on a lower one that nothing slows: relative speed 1, slowed by mu g (1 + 1/3)
    stop = 0.1 + 1.0 / (0.5 * GRAVITY * (1 + 1 / 3))
    assert told(run) == [("watch", "kick"), ("slip", "on"), ("stick", "on"), ("rest", "upper")]
    assert run.events.times("rest", post) == pytest.approx([stop], abs=1e-11)
    assert run[lower].rate(2.0) == pytest.approx((3 * 4.0 + 5.0) / 4.0, abs=1e-11)


def test_what_rested_already_is_not_told_again():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    table = scene.add(rb.Particle(5.0), name="table")
    stone = scene.add(rb.Particle(1.0), position=[0, 0, 2.0], name="stone")
    scene.contact(table, rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.5), name="floor")
    scene.contact(stone.sphere(0.0), table.sphere(0.5), friction=rb.Coulomb(0.5), name="top")
    run = rb.simulate(scene, until=0.6, error=1e-10)
    assert told(run) == [("land", "top"), ("rest", "stone")]


def test_what_an_action_stops_comes_to_rest():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    block = scene.add(rb.Particle(1.0), velocity=[5, 0, 0], name="block")
    scene.contact(block, rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.3), name="touch")
    scene.watch("stop", lambda now: now.time - 0.5, action=lambda now: {block: {"velocity": [0, 0, 0]}})
    run = rb.simulate(scene, until=1.0, error=1e-11)
    assert told(run) == [("watch", "stop"), ("stick", "touch"), ("rest", "block")]


def test_nothing_fires_at_the_start():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    block = scene.add(rb.Particle(1.0))
    scene.contact(block, rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.3))
    assert len(rb.simulate(scene, until=1.0).events) == 0


@pytest.mark.parametrize("seed", range(12))
def test_what_lands_on_a_plate_that_shakes_comes_to_rest_on_it(seed):
    """A particle straight above the plate's own point: nothing there has a size but their speeds."""
    draw = np.random.default_rng(seed)
    w, ratio = 10 ** draw.uniform(-1, 2), draw.uniform(1.05, 1.6)
    a = ratio * GRAVITY / w**2
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    plate = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Prismatic([0, 0, 1], motion=lambda t: a * np.sin(w * t)))
    stone = scene.add(rb.Particle(draw.uniform(0.1, 3)), position=[0, 0, 0], velocity=[0, 0, a * w], name="stone")
    scene.contact(stone, plate.plane([0, 0, 1]), friction=rb.Coulomb(0.2), name="touch")
    # it leaves where the plate falls faster than it, and lands once in the next turn
    for options in ({}, {"rtol": 1e-7}, {"rtol": 1e-9}):
        run = rb.simulate(scene, 6.5 / w, **options)
        kinds = told(run)
        assert kinds[0] == ("detach", "touch")
        assert abs(run.events[0].time - np.arcsin(1 / ratio) / w) < 1e-7 * run.events[0].time
        lands = [i for i, one in enumerate(kinds) if one == ("land", "touch")]
        assert lands and all(kinds[i + 1] == ("rest", "stone") for i in lands)
