"""What slides on without end stays on its surface: rounded forces leave accelerations of some 1e-16 m/s^2 towards it,
which one step of a day would add up to micrometres. Against uniform motion.
"""

import numpy as np
import pytest
import rbdyn as rb

G = 9.8125


def frame(up):
    up = np.array(up, float) / np.linalg.norm(up)
    along = np.cross(up, [0.3, 0.1, 0.9])
    along /= np.linalg.norm(along)
    return along, np.cross(up, along), up


def box(up, speed, spin=0.0, corners=4):
    """A box on its feet, on a smooth floor that is level."""
    along, across, up = frame(up)
    scene = rb.Scene(gravity=-G * up)
    body = scene.add(
        rb.RigidBody(2.0, [0.1, 0.2, 0.25]),
        position=0.1 * up,
        attitude=np.column_stack([along, across, up]),
        velocity=speed * along,
        angular_velocity=[0, 0, spin],
    )
    feet = [[-0.2, -0.3, -0.1], [0.2, -0.3, -0.1], [0.2, 0.3, -0.1], [-0.2, 0.3, -0.1]]
    touch = [scene.contact(body.point(p), rb.Plane(up)) for p in feet[:corners]]
    return scene, body, touch, along


@pytest.mark.parametrize("until", [300.0, 1e5])
@pytest.mark.parametrize("up", [[0, 0, 1], [1, 2, 3], [-3, 1, 0.2]])
def test_a_box_that_slides_for_a_day_stays_on_its_floor(up, until):
    speed = 0.25
    scene, body, touch, along = box(up, speed)
    run = rb.simulate(scene, until, rtol=1e-10)
    assert run.status == "reached end" and not len(run.events)
    size, where = 0.36, speed * until
    for t in until * np.array([0.01, 0.3, 0.77, 1.0]):
        gaps = [run[c].gap(t) for c in touch]
        # 1e-12 of the size, and the rounding of where it is
        assert np.abs(gaps).max() < 1e-12 * size + 8 * np.finfo(float).eps * where
        assert sum(np.linalg.norm(run[c].force(t)) for c in touch) == pytest.approx(2.0 * G, rel=1e-12)
    # what gravity and the normal as they are rounded have along the floor is the scene's own: eps g t^2 / 2
    off = run[body].position(until) - run[body].position(0.0) - speed * until * along
    assert np.abs(off).max() < 4 * np.finfo(float).eps * (G * until**2 / 2 + where)


def test_level_floors_take_nothing_from_the_error_that_is_asked_for():
    speed, until = 0.25, 1e5
    scene, body, touch, along = box([0, 0, 1], speed)
    run = rb.simulate(scene, until, error=1e-9)
    off = run[body].position(until) - run[body].position(0.0) - speed * until * along
    assert np.abs(off).max() <= 1e-9 * speed * until
    assert run.error <= 1e-9


def test_a_ball_that_rolls_for_a_day_stays_on_its_floor():
    up = frame([1, 2, 3])[2]
    along = frame([1, 2, 3])[0]
    scene = rb.Scene(gravity=-G * up)
    ball = scene.add(
        rb.shapes.sphere(1.0, 0.1),
        position=0.1 * up,
        velocity=0.2 * along,
        angular_velocity=2.0 * np.cross(up, along),
    )
    touch = scene.contact(ball.sphere(0.1), rb.Plane(up), friction=rb.Coulomb(0.5))
    until = 3000.0
    run = rb.simulate(scene, until, rtol=1e-10)
    assert run.status == "reached end" and not len(run.events)
    for t in (1.0, 1000.0, until):
        assert abs(run[touch].gap(t)) < 1e-12 * 0.1 + 8 * np.finfo(float).eps * 0.2 * until


@pytest.mark.parametrize("until", [100.0, 1e4])
@pytest.mark.parametrize("slope", [0.04424020998586501, 0.2, 0.3])
@pytest.mark.parametrize("mu", [0.0, 0.1])
def test_a_box_that_slides_down_a_slope_neither_turns_nor_sinks(mu, slope, until):
    if np.tan(slope) < mu:
        pytest.skip("it stands")
    scene = rb.Scene(gravity=[G * np.sin(slope), 0, -G * np.cos(slope)])
    body = scene.add(rb.shapes.box(2.0, [1.1, 0.3, 0.3]), rb.Planar(x=[1, 0, 0], y=[0, 0, 1]), position=[0, 0.15])
    friction = rb.Coulomb(mu) if mu else None
    touch = [scene.contact(body.point([s, 0, -0.15]), rb.Plane([0, 0, 1]), friction=friction) for s in (-0.55, 0.55)]
    run = rb.simulate(scene, until, error=1e-9)
    acceleration = G * (np.sin(slope) - mu * np.cos(slope))
    for t in until * np.array([0.1, 0.5, 0.9, 1.0]):
        way = acceleration * t**2 / 2
        rounding = 1e-12 + 8 * np.finfo(float).eps * way
        assert abs(run[body].position(t)[0] - way) < 1e-9 * way
        assert abs(run[body].angle(t)) < rounding
        assert max(abs(run[c].gap(t)) for c in touch) < rounding


@pytest.mark.parametrize("legs", [3, 4])
@pytest.mark.parametrize("up", [[0, 0, 1], [1, 2, 3]])
def test_a_rough_table_slides_down_a_slope_in_space(up, legs):
    up = frame(up)[2]
    slope, mu, until = 0.3, 0.1, 1000.0
    scene, body, touch, along = box(up, 0.0, corners=0)
    scene = rb.Scene(gravity=G * (np.sin(slope) * along - np.cos(slope) * up))
    body = scene.add(
        rb.RigidBody(2.0, [0.1, 0.2, 0.25]),
        position=0.1 * up,
        attitude=np.column_stack([*frame(up)[:2], up]),
    )
    feet = [[-0.2, -0.3, -0.1], [0.2, -0.3, -0.1], [0.2, 0.3, -0.1], [-0.2, 0.3, -0.1]][:legs]
    touch = [scene.contact(body.point(p), rb.Plane(up), friction=rb.Coulomb(mu)) for p in feet]
    run = rb.simulate(scene, until, rtol=1e-10)
    assert run.status == "reached end"
    acceleration = G * (np.sin(slope) - mu * np.cos(slope))
    start = run[body].rotation_matrix(0.0)
    for t in until * np.array([0.1, 0.5, 1.0]):
        way = acceleration * t**2 / 2
        rounding = 1e-12 + 8 * np.finfo(float).eps * way
        off = run[body].position(t) - run[body].position(0.0)
        assert abs(off @ along - way) < 1e-9 * way
        assert max(abs(run[c].gap(t)) for c in touch) < rounding
        assert np.abs(run[body].rotation_matrix(t) @ start.T - np.eye(3)).max() < rounding


def test_a_box_that_slides_on_another_one_tips_it_where_statics_says():
    """Loads move over feet that share them in more than one way, until the lower box tips about its front feet:
    m b / 2 = M (u t - b / 2)."""
    scene, low, high, speed = rb.Scene(gravity=[0, 0, -G]), (1.0, 0.5, 0.4), (1.3, 0.43, 0.35), 0.05
    surface, touch, z = rb.Plane([0, 0, 1]), [], 0.1
    for (mass, b, d), v in ((low, 0.0), (high, speed)):
        body = scene.add(rb.shapes.box(mass, [b, d, 0.2]), position=[0, 0, z], velocity=[v, 0, 0])
        for x in (-b / 2, b / 2):
            touch += [scene.contact(body.point([x, y, -0.1]), surface) for y in (-d / 2, d / 2)]
        surface, z = body.plane([0, 0, 1], [0, 0, 0.1]), z + 0.2
    tips = (low[0] + high[0]) * low[1] / 2 / high[0] / speed
    run = rb.simulate(scene, 1.01 * tips, rtol=1e-10)
    opened = [event for event in run.events if event.kind == "detach"]
    assert [event.subject for event in opened] == touch[:2]
    assert all(event.time == pytest.approx(tips, rel=1e-9) for event in opened)


def stack(speeds):
    """Boxes on each other, ever smaller, on a smooth floor; of each mass and width."""
    scene, bodies, touch, sizes, z = rb.Scene(gravity=[0, 0, -G]), [], [], [], 0.0
    for k, speed in enumerate(speeds):
        mass, b, d = 1.0 + 0.3 * k, 0.5 - 0.07 * k, 0.4 - 0.05 * k
        surface = bodies[-1].plane([0, 0, 1], [0, 0, 0.1]) if bodies else rb.Plane([0, 0, 1])
        body = scene.add(rb.shapes.box(mass, [b, d, 0.2]), position=[0, 0, z + 0.1], velocity=[speed, 0, 0])
        touch.append(
            [scene.contact(body.point([x, y, -0.1]), surface) for x in (-b / 2, b / 2) for y in (-d / 2, d / 2)]
        )
        bodies.append(body)
        sizes.append((mass, b))
        z += 0.2
    return scene, bodies, touch, sizes


@pytest.mark.parametrize(
    "speeds", [[0.3] * 2, [0.3] * 4, [0.01, 0.011], [0.01, 0.011, 0.009], [0.01, 0.011, 0.009, 0.01]]
)
def test_boxes_that_slide_on_each_other_do_so_uniformly(speeds):
    """A tilt of one by rounded forces pulls those on it along: 2e-10 m after 10 s, 10,000 times that after 100."""
    scene, bodies, touch, _ = stack(speeds)
    until = 100.0
    run = rb.simulate(scene, until, error=1e-9)
    for t in until * np.array([0.1, 0.5, 1.0]):
        for body, speed in zip(bodies, speeds, strict=True):
            off = run[body].position(t) - run[body].position(0.0) - [speed * t, 0, 0]
            assert np.abs(off).max() < 8 * np.finfo(float).eps * (1.0 + abs(speed) * t)
            assert np.abs(run[body].angular_velocity(t)).max() < 1e-25
        for contacts in touch:
            assert max(abs(run[c].gap(t)) for c in contacts) < 1e-15


@pytest.mark.parametrize("speeds", [[0.1, 0.2, -0.1], [0.1, 0.2, -0.1, 0.05], [0.01, 0.011, 0.009, 0.01]])
def test_of_boxes_that_slide_on_each_other_the_one_tips_that_statics_says(speeds):
    """Where it and what lies on it have their centre of mass above two of its feet. Those above stand on as they are
    carried: their feet share what they bear anew."""
    scene, bodies, touch, sizes = stack(speeds)
    tips = []
    for k, (_, width) in enumerate(sizes[:-1]):
        above = range(k, len(speeds))
        moves = sum(sizes[j][0] * (speeds[j] - speeds[k]) for j in above)
        tips.append((width / 2 * sum(sizes[j][0] for j in above) / abs(moves), k, moves > 0))
    time, lowest, forward = min(tips)
    run = rb.simulate(scene, time + 0.06, rtol=1e-10)
    assert run.status == "reached end"
    opened = [event for event in run.events if event.kind == "detach"]
    rear = touch[lowest][:2] if forward else touch[lowest][2:]
    assert {event.subject for event in opened} == set(rear)
    assert all(event.time == pytest.approx(time, rel=1e-12) for event in opened)
    # those below do not turn, those above turn with it
    after = time + 0.05
    turning = [abs(run[body].angular_velocity(after)[1]) for body in bodies]
    assert max(turning[:lowest], default=0.0) < 1e-20
    assert turning[lowest] > 1e-6
    assert turning[lowest:] == pytest.approx([turning[lowest]] * len(turning[lowest:]), rel=1e-6)
