"""Watch actions that change the state of bodies joined to bodies: loops, contacts and friction included."""

import numpy as np
import pytest
import rbdyn as rb

scipy_integrate = pytest.importorskip("scipy.integrate")
GRAVITY = 9.8125


def rods(**starts):
    """A double pendulum of two uniform rods, 1 kg and 1 m each, in the plane x, y; angles from the vertical."""
    scene = rb.Scene(gravity=[0, -GRAVITY, 0])
    rod = rb.RigidBody(1.0, [1 / 12, 1 / 12, 1 / 12], com=[0, -0.5, 0])
    upper = scene.add(rod, rb.Revolute([0, 0, 1]), name="upper", **starts.get("upper", {"angle": 1.2}))
    lower = scene.add(
        rod,
        rb.Revolute([0, 0, 1], at=[0, -1, 0]),
        parent=upper,
        name="lower",
        **starts.get("lower", {"angle": 0.4, "rate": 0.5}),
    )
    return scene, upper, lower


def rods_motion(t, y):
    """Its equations in absolute angles: (4/3) a'' + (1/2) cos(a - b) b'' = ..., written down apart."""
    a, b, u, v = y
    c, s = np.cos(a - b), np.sin(a - b)
    matrix = np.array([[4 / 3, c / 2], [c / 2, 1 / 3]])
    force = [-s / 2 * v**2 - 1.5 * GRAVITY * np.sin(a), s / 2 * u**2 - 0.5 * GRAVITY * np.sin(b)]
    return [u, v, *np.linalg.solve(matrix, force)]


def test_a_double_pendulum_is_struck_where_its_angle_says():
    scene, upper, lower = rods()
    scene.watch(
        "struck",
        lambda now: now[upper].angle - 0.3,
        direction="falling",
        action=lambda now: {upper: {"rate": -now[upper].rate}},
    )
    run = rb.simulate(scene, until=2.0, error=1e-11)

    def event(t, y):
        return y[0] - 0.3

    event.terminal, event.direction = True, -1
    y, t, times = np.array([1.2, 1.6, 0.0, 0.5]), 0.0, []
    while t < 2.0:
        part = scipy_integrate.solve_ivp(
            rods_motion, (t, 2.0), y, "DOP853", events=event, rtol=1e-13, atol=1e-14, dense_output=True
        )
        y, t = part.y[:, -1].copy(), part.t[-1]
        if part.status == 1:
            times.append(t)
            relative = y[3] - y[2]
            y[2] = -y[2]
            y[3] = y[2] + relative  # the rate of the lower hinge stays
    assert len(times) >= 1
    assert run.events.times("struck") == pytest.approx(times, abs=1e-10)
    assert run[upper].angle(2.0) == pytest.approx(y[0], abs=1e-10)
    assert run[lower].angle(2.0) == pytest.approx(y[1] - y[0], abs=1e-10)
    first = run.events.times("struck")[0]
    assert run[upper].rate(first) == pytest.approx(-run[upper].rate(first, side="before"), rel=1e-14)
    # what the action did not name stays: what is read before is read off a piece, and rounded
    assert run[lower].rate(first) == pytest.approx(run[lower].rate(first, side="before"), rel=1e-14)
    assert run[lower].angle(first) == pytest.approx(run[lower].angle(first, side="before"), rel=1e-14)


def test_what_a_changed_state_makes_is_what_a_scene_that_starts_there_makes():
    scene, upper, lower = rods()

    def change(now):
        return {upper: {"angle": now[upper].angle + 0.25}, lower: {"rate": 2.0}}

    scene.watch("at", lambda now: now.time - 0.7, action=change)
    run = rb.simulate(scene, until=2.0, error=1e-11)
    still, first, second = rods()
    before = rb.simulate(still, until=0.7, error=1e-12)
    elsewhere, one, two = rods(
        upper={"angle": before[first].angle(0.7) + 0.25, "rate": before[first].rate(0.7)},
        lower={"angle": before[second].angle(0.7), "rate": 2.0},
    )
    after = rb.simulate(elsewhere, until=1.3, error=1e-12)
    for handle, other in ((upper, one), (lower, two)):
        assert run[handle].angle(2.0) == pytest.approx(after[other].angle(1.3), abs=1e-10)
        assert run[handle].rate(2.0) == pytest.approx(after[other].rate(1.3), abs=1e-10)


WORDS = [
    (rb.Universal([1, 0, 0], [0, 1, 0]), {"angles": [0.1, 0.2], "rates": [1.0, 2.0]}),
    (rb.Cylindrical([0, 0, 1]), {"angle": 0.5, "displacement_rate": 3.0}),
    (rb.Cylindrical([0, 0, 1]), {"displacement": 0.25, "rate": -1.0}),
    (rb.Planar([1, 0, 0], [0, 0, 1]), {"position": [0.5, 0.25], "rate": 2.0}),
    (rb.Planar([1, 0, 0], [0, 0, 1]), {"velocity": [-1.0, 2.0], "angle": 0.125}),
]


@pytest.mark.parametrize("joint, words", WORDS)
def test_each_joint_takes_its_own_words(joint, words):
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    base = scene.add(rb.shapes.box(2.0, [1, 1, 1]), rb.Revolute([0, 0, 1]), rate=0.5)
    body = scene.add(rb.RigidBody(1.0, [0.1, 0.2, 0.25], com=[0.1, 0, 0]), joint, parent=base)
    scene.watch("at", lambda now: now.time - 0.5, action=lambda now: {body: words})
    run = rb.simulate(scene, until=0.75, error=1e-10)
    names = {
        rb.Universal: ["angles", "rates"],
        rb.Cylindrical: ["angle", "rate", "displacement", "displacement_rate"],
        rb.Planar: ["position", "velocity", "angle", "rate"],
    }[type(joint)]
    for name in names:
        if not hasattr(run[body], name) or (name == "position" and "position" not in words):
            continue
        if isinstance(joint, rb.Planar) and name in ("position", "velocity"):
            continue  # those of the body are in the world
        value, before = getattr(run[body], name)(0.5), getattr(run[body], name)(0.5, side="before")
        expected = words.get(name, before)
        if name in words:
            assert np.array_equal(np.asarray(value), np.asarray(expected)), name
        else:
            assert value == pytest.approx(expected, abs=1e-14), name
    assert run[base].angle(0.5) == pytest.approx(run[base].angle(0.5, side="before"), abs=1e-14)


def test_a_ball_joint_on_what_is_changed_keeps_how_it_lies_to_it():
    scene = rb.Scene()
    base = scene.add(rb.shapes.box(2.0, [1, 1, 1]), rb.Revolute([0, 0, 1]), rate=0.5)
    arm = scene.add(
        rb.shapes.box(1.0, [1.0, 0.25, 0.125]),
        rb.Spherical(at=[1, 0, 0], point=[-0.5, 0, 0]),
        parent=base,
        attitude=rb.EulerAngles(0.5, 0.25, 0.125),
        angular_velocity=[0.1, 0.2, 0.3],
    )
    scene.watch("at", lambda now: now.time - 0.5, action=lambda now: {base: {"angle": 2.0, "rate": -1.0}})
    run = rb.simulate(scene, until=1.0, error=1e-10)

    def relative(side):
        about = run[base].rotation_matrix(0.5, side=side).T
        spin = run[arm].angular_velocity_world(0.5, side=side) - run[base].angular_velocity_world(0.5, side=side)
        return about @ run[arm].rotation_matrix(0.5, side=side), about @ spin

    for after, before in zip(relative("after"), relative("before"), strict=True):
        assert after == pytest.approx(before, abs=1e-14)
    assert run[base].rate(0.5) == -1.0


def test_a_free_body_beside_a_tree_is_changed_in_the_world():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    pendulum = scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.1], com=[0, -0.5, 0]), rb.Revolute([1, 0, 0]), angle=1.0)
    thrown = scene.add(rb.RigidBody(1.0, [0.1, 0.2, 0.25], com=[0.1, 0, 0]), position=[1, 0, 3])
    bead = scene.add(rb.Particle(1.0), rb.Rail(rb.Line([0, 0, 1])), parent=pendulum)
    scene.watch(
        "at",
        lambda now: now.time - 0.25,
        action=lambda now: {thrown: {"angular_velocity": [1, 2, 3]}, bead: {"speed": 2.0}},
    )
    run = rb.simulate(scene, until=0.5, error=1e-10)
    assert run[thrown].position(0.25) == pytest.approx(run[thrown].position(0.25, side="before"), abs=1e-14)
    assert run[thrown].velocity(0.25) == pytest.approx(run[thrown].velocity(0.25, side="before"), abs=1e-14)
    assert np.array_equal(run[thrown].angular_velocity(0.25), [1, 2, 3])
    assert run[bead].speed(0.25) == 2.0


def four_bar(action=None):
    def bar(mass, com, moment):
        return rb.RigidBody(mass, [moment / 2, moment / 2, moment], com=com)

    scene = rb.Scene(gravity=[0, -GRAVITY, 0])
    crank = scene.add(bar(1.0, [0.4, 0, 0], 0.05), rb.Revolute([0, 0, 1]), angle=0.5, rate=3.0)
    coupler = scene.add(
        bar(2.0, [1, 0, 0], 0.7), rb.Revolute([0, 0, 1], at=[0.75, 0, 0]), parent=crank, angle=0.1, name="coupler"
    )
    rocker = scene.add(bar(1.5, [0.75, 0, 0], 0.3), rb.Revolute([0, 0, 1], at=[2, 0, 0]), angle=1.4)
    scene.constrain(rb.Ball(), coupler.point([2, 0, 0]), rocker.point([1.5, 0, 0]), name="pin")
    scene.assemble(keep=[crank])
    if action is not None:
        bars = (crank, coupler, rocker)
        scene.watch("turned", lambda now: now.time - 0.75, action=lambda now: action(now, bars))
    return scene, crank, coupler, rocker


def test_a_four_bar_whose_rates_are_turned_runs_back_the_way_it_came():
    scene, *bars = four_bar(lambda now, bars: {b: {"rate": -now[b].rate} for b in bars})
    run = rb.simulate(scene, until=1.5, error=1e-11)
    for t in (0.0, 0.25, 0.6):
        for b in bars:
            assert run[b].angle(1.5 - t) == pytest.approx(run[b].angle(t), abs=1e-10)
            assert run[b].rate(1.5 - t) == pytest.approx(-run[b].rate(t), abs=1e-9)
    for b in bars:
        assert run[b].angle(0.75) == pytest.approx(run[b].angle(0.75, side="before"), abs=1e-14)


def test_a_change_that_opens_a_loop_is_refused_with_its_gap():
    scene, crank, *_ = four_bar(lambda now, bars: {bars[0]: {"rate": 5.0}})
    with pytest.raises(rb.InvalidInput, match=r"pin: rate of its gap is .* the action of watch turned"):
        rb.simulate(scene, until=1.0)
    scene, crank, *_ = four_bar(lambda now, bars: {bars[0]: {"angle": now[bars[0]].angle + 0.01}})
    with pytest.raises(rb.InvalidInput, match=r"pin: gap is .* the action of watch turned"):
        rb.simulate(scene, until=1.0)
    # within 1e-6 it is closed
    scene, crank, *_ = four_bar(lambda now, bars: {bars[0]: {"angle": now[bars[0]].angle + 1e-7}})
    assert rb.simulate(scene, until=1.0, error=1e-9).end == 1.0


REFUSED = [
    ({"speed": 1.0}, "its action changes speed of upper, whose joint has none; give angle, rate"),
    ({"position": [1, 2]}, r"its action changes position \(2\) of upper, whose joint has none"),
    ({"rate": float("nan")}, "rate"),
    ({"angles": [1, 2, 3]}, "angles has 3 numbers; it is two"),
]


@pytest.mark.parametrize("words, message", REFUSED)
def test_words_that_are_none_of_the_joint_are_refused(words, message):
    scene, upper, _ = rods()
    scene.watch("at", lambda now: now.time - 0.1, action=lambda now: {upper: words})
    with pytest.raises(rb.InvalidInput, match=message):
        rb.simulate(scene, until=1.0)


def test_a_driven_joint_cannot_be_changed():
    scene = rb.Scene()
    wheel = scene.add(rb.shapes.disc(1.0, 1.0, [0, 0, 1]), rb.Revolute([0, 0, 1], motion=lambda t: t), name="wheel")
    scene.add(rb.shapes.rod(1.0, 1.0, [1, 0, 0]), rb.Revolute([0, 0, 1], at=[1, 0, 0]), parent=wheel, rate=1.0)
    scene.watch("at", lambda now: now.time - 0.1, action=lambda now: {wheel: {"rate": 2.0}})
    with pytest.raises(rb.InvalidInput, match="wheel, whose joint is driven"):
        rb.simulate(scene, until=1.0)


def ball(action, watch, restitution=0.5, height=1.0, direction="either", **how):
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    stone = scene.add(rb.Particle(2.0), position=[0, 0, height])
    touch = scene.contact(stone, rb.Plane([0, 0, 1]), restitution=restitution, **how)
    scene.watch("hit", lambda now: watch(now, stone), direction=direction, action=lambda now: action(now, stone))
    return scene, stone, touch


def test_a_ball_that_is_struck_down_in_flight_comes_to_the_floor_sooner():
    # struck at half a metre with what it has and 1 m/s more
    scene, stone, touch = ball(
        lambda now, b: {b: {"velocity": now[b].velocity + [0, 0, -1.0]}},
        lambda now, b: now[b].position[2] - 0.5,
        direction="falling",
    )
    run = rb.simulate(scene, until=1.0, error=1e-11)
    fall, speed = np.sqrt(1.0 / GRAVITY), np.sqrt(GRAVITY) + 1.0
    landing = fall + (np.sqrt(speed**2 + GRAVITY) - speed) / GRAVITY
    assert run.events.times("hit")[0] == pytest.approx(fall, abs=1e-11)
    assert run.events.times("impact")[0] == pytest.approx(landing, abs=1e-11)
    assert run.events[1].impulse[2] == pytest.approx(2.0 * 1.5 * np.sqrt(speed**2 + GRAVITY), rel=1e-11)


def test_what_rests_is_thrown_up_and_comes_down_again():
    scene, stone, touch = ball(
        lambda now, b: {b: {"velocity": [1.0, 0, 3.0]}}, lambda now, b: now.time - 0.25, restitution=0.0, height=0.0
    )
    run = rb.simulate(scene, until=2.0, error=1e-11)
    assert [e.kind for e in run.events] == ["watch", "detach", "land"]
    assert run.events.times("detach") == [0.25]
    assert run.events.times("land")[0] == pytest.approx(0.25 + 6.0 / GRAVITY, abs=1e-11)
    assert run[touch].state(0.1) == "slides" and run[touch].state(0.5) == "open" and run[touch].state(1.5) == "slides"
    assert run[stone].position(2.0) == pytest.approx([1.75, 0, 0], abs=1e-11)


def test_what_rests_and_is_struck_down_bounces():
    scene, stone, touch = ball(
        lambda now, b: {b: {"velocity": [0, 0, -2.0]}}, lambda now, b: now.time - 0.25, height=0.0
    )
    run = rb.simulate(scene, until=0.3, error=1e-11)
    assert run[stone].velocity(0.25)[2] == pytest.approx(1.0, abs=1e-14)
    (left,) = (e for e in run.events if e.kind == "detach")
    assert left.time == 0.25 and left.impulse[2] == pytest.approx(2.0 * 3.0, rel=1e-13)


def test_an_action_at_the_very_instant_of_an_impact_does_not_hide_it():
    scene, stone, touch = ball(
        lambda now, b: {b: {"velocity": now[b].velocity + [1.0, 0, 0]}},
        lambda now, b: now[b].position[2],
        direction="falling",
    )
    run = rb.simulate(scene, until=0.6, error=1e-11)
    assert [e.kind for e in run.events][:2] == ["watch", "impact"]
    speed = np.sqrt(2.0 * GRAVITY)
    assert run[stone].velocity(run.events[1].time) == pytest.approx([1.0, 0, 0.5 * speed], abs=1e-12)


def test_bounces_that_an_action_makes_ever_sooner_end_by_name():
    scene, stone, touch = ball(
        lambda now, b: {b: {"velocity": -0.5 * now[b].velocity}},
        lambda now, b: now[b].position[2] - 0.25,
        direction="falling",
    )
    with pytest.raises(rb.IntegrationError, match="ever sooner") as caught:
        rb.simulate(scene, until=5.0)
    run = caught.value.run
    assert run.status == "inconsistent" and run.events[-1].kind == "accumulation"
    first = np.sqrt(1.5 / GRAVITY)
    limit = first + 2.0 * (0.5 * GRAVITY * first) / GRAVITY / 0.5
    assert run.events[-1].time == pytest.approx(limit, rel=1e-8)


def test_a_block_that_sticks_is_pushed_and_slides_to_its_stop():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    block = scene.add(rb.Particle(2.0))
    touch = scene.contact(block, rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.5, 0.25))
    scene.watch("push", lambda now: now.time - 1.0, action=lambda now: {block: {"velocity": [0.6, 0.8, 0]}})
    run = rb.simulate(scene, until=3.0, error=1e-11)
    assert [e.kind for e in run.events][:3] == ["watch", "slip", "stick"]
    stop = 1.0 / (0.25 * GRAVITY)
    assert run.events.times("stick")[0] == pytest.approx(1.0 + stop, abs=1e-11)
    assert run[block].position(3.0) == pytest.approx(np.array([0.6, 0.8, 0]) * stop / 2, abs=1e-11)
    assert run[touch].state(0.5) == "sticks" and run[touch].state(1.1) == "slides"


def test_another_body_is_changed_and_what_is_held_stays_held():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    block = scene.add(rb.Particle(2.0))
    flying = scene.add(rb.Particle(1.0), position=[0, 0, 5])
    touch = scene.contact(block, rb.Plane([0.1, 0, 1]), friction=rb.Coulomb(0.5, 0.25))
    scene.contact(flying, rb.Plane([0, 0, 1]))
    scene.watch("push", lambda now: now.time - 0.25, action=lambda now: {flying: {"velocity": [1, 0, 0]}})
    run = rb.simulate(scene, until=0.5, error=1e-11)
    assert [e.kind for e in run.events] == ["watch"]
    assert run[touch].state(0.5) == "sticks" and np.array_equal(run[block].position(0.5), [0, 0, 0])


def test_a_hinge_that_friction_holds_is_turned_and_stops():
    scene = rb.Scene()
    wheel = scene.add(
        rb.RigidBody(2.0, [0.1, 0.1, 0.2]),
        rb.Revolute([0, 0, 1], friction=rb.Coulomb(0.5, 0.25), pin_radius=0.05),
    )
    scene.apply(rb.Force([0, -20.0, 0]), wheel)
    scene.watch("turn", lambda now: now.time - 1.0, action=lambda now: {wheel: {"rate": 3.0}})
    run = rb.simulate(scene, until=4.0, error=1e-11)
    assert [e.kind for e in run.events] == ["watch", "slip", "stick"]
    slows = 0.25 * 0.05 * 20.0 / 0.2
    assert run.events.times("stick")[0] == pytest.approx(1.0 + 3.0 / slows, abs=1e-10)
    assert run[wheel].angle(4.0) == pytest.approx(4.5 / slows, abs=1e-10)


def test_an_action_that_changes_nothing_leaves_every_bit():
    scene, upper, lower = rods()
    plain = rb.simulate(scene, until=1.0, rtol=1e-10)
    scene.watch("looks", lambda now: now.time - 0.5, action=lambda now: None)
    run = rb.simulate(scene, until=1.0, error=1e-11)
    assert run.events.times("looks") == [0.5]
    assert run[upper].angle(1.0) == pytest.approx(plain[upper].angle(1.0), abs=1e-9)


@pytest.mark.parametrize("trace", [True, False])
@pytest.mark.parametrize(
    "joint, start, names",
    [
        (rb.Universal([1, 0, 0], [0, 1, 0]), {"angles": [0.1, 0.2], "rates": [0.3, -0.4]}, ["angles", "rates"]),
        (
            rb.Cylindrical([0, 0, 1]),
            {"angle": 0.2, "rate": 1.0, "displacement": 0.5, "displacement_rate": 2.0},
            ["angle", "rate", "displacement", "displacement_rate"],
        ),
        (rb.Planar([1, 0, 0], [0, 1, 0]), {"angle": 0.3, "rate": 2.0}, ["angle", "rate"]),
        (rb.Revolute([0, 0, 1], motion=lambda t: np.sin(3 * t)), {}, ["angle", "rate"]),
        (rb.Prismatic([0, 0, 1], motion=lambda t: np.sin(3 * t)), {}, ["displacement", "rate"]),
    ],
)
def test_the_present_moment_has_every_number_of_a_joint_that_runs_have(joint, start, names, trace):
    box = rb.RigidBody(2.0, [0.3, 0.4, 0.5], com=[0.1, -0.5, 0.2])
    t = 0.375

    def scene():
        made = rb.Scene(gravity=[0, -GRAVITY, 0])
        return made, made.add(box, joint, **start)

    still, body = scene()
    run = rb.simulate(still, until=1.0, error=1e-11)
    for name in names:
        watched, body_too = scene()
        known = getattr(run[body], name)(t)

        def function(now, body=body_too, name=name, known=known):
            # what it is there, and what grows with the time besides
            return np.sum((getattr(now[body], name) - known) * np.array([1.0, 2.0])[: np.size(known)]) + 3.0 * (
                now.time - t
            )

        seen = {}
        watched.watch("at", function, trace=trace)
        watched.watch(
            "then",
            lambda now: now.time - 0.5,
            action=lambda now, name=name, seen=seen, body=body_too: seen.update({name: getattr(now[body], name)}),
        )
        again = rb.simulate(watched, until=1.0, error=1e-11)
        assert min(abs(time - t) for time in again.events.times("at")) < (1e-10 if trace else 1e-8)
        assert seen[name] == pytest.approx(getattr(run[body], name)(0.5), abs=1e-10)


def test_numbers_that_a_joint_has_not_are_refused_with_the_joints_that_have_them():
    scene, upper, _ = rods()
    with pytest.raises(rb.InvalidInput, match="has no angles about two axes; a body on a Universal joint has"):
        scene.watch("at", lambda now: now[upper].angles[0])
    with pytest.raises(rb.InvalidInput, match="has no displacement_rate; a body on a Cylindrical joint has"):
        scene.watch("at", lambda now: now[upper].displacement_rate)


def test_a_watched_function_of_a_universal_joint_comes_back_from_its_file(tmp_path):
    scene = rb.Scene()
    body = scene.add(rb.shapes.box(1.0, [1, 2, 3]), rb.Universal([1, 0, 0], [0, 1, 0]), rates=[1.0, 0.5])
    scene.watch("at", lambda now: now[body].angles[1] - 0.1 + 0 * now[body].rates[0])
    rb.save(scene, tmp_path / "scene.json")
    assert rb.load(tmp_path / "scene.json") == scene
