"""Bodies that several rough contacts hold: they let go together, or one lifts off and the others hold on.

Truths: closed forms, sums of forces by hand, and equations of motion written down apart (SciPy's Radau).
"""

import math

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp

g = 9.8125
FEET = np.array([(-1.0, -0.6), (1.0, -0.6), (0.0, 1.2)])
HEIGHT = 0.05


def block_on_feet(mass, mu, push, second=False, at=(0.0, 0.0)):
    scene = rb.Scene(gravity=[0, 0, -g])
    block = scene.add(rb.RigidBody(mass, [0.3 * mass] * 3), position=[0, 0, HEIGHT])
    for foot in FEET:
        scene.contact(block.point([*foot, -HEIGHT]), rb.Plane([0, 0, 1]), friction=rb.Coulomb(mu))
    if second:
        top = scene.add(rb.RigidBody(1.0, [0.3] * 3), position=[0, 0, 3 * HEIGHT])
        for foot in FEET:
            place = top.point([*(0.8 * foot), -HEIGHT])
            scene.contact(place, block.plane([0, 0, 1], [0, 0, HEIGHT]), friction=rb.Coulomb(5.0))
    scene.apply(rb.Force(lambda t, x, v: [*push(t), 0 * t]), block, at=[*at, -HEIGHT])
    return scene, block


@pytest.mark.parametrize("second", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_pushed_straight_three_feet_let_go_together(seed, second):
    """Each bears its part, of which only the sum is known well: steps of 1e-7 s went on without end."""
    rng = np.random.default_rng(seed)
    mass, mu, k = rng.uniform(0.5, 3), rng.uniform(0.1, 0.6), rng.uniform(3, 20)
    error = (1e-6, 1e-9, 1e-11)[seed % 3]
    scene, block = block_on_feet(mass, mu, lambda t: [k * t, 0 * t], second)
    whole = mass + second
    start = mu * whole * g / k
    run = rb.simulate(scene, 1.3 * start, error=error, max_steps=2000)
    assert run.status == "reached end"
    assert [e.kind for e in run.events] == ["slip"] * 3
    assert np.allclose(run.events.times("slip"), start, rtol=error, atol=0)
    # m v' = k (t - start)
    d = 0.3 * start
    assert abs(run[block].velocity(run.end)[0] / (k * d * d / 2 / whole) - 1) < error
    assert abs(run[block].position(run.end)[0] / (k * d**3 / 6 / whole) - 1) < error
    assert np.abs(run[block].position(run.end)[1]) < 1e-12
    assert np.abs(run[block].angular_velocity(run.end)).max() < 1e-12


def slid(mass, mu, push, at, t0, until):
    """(v, omega) of the block, by hand: what each foot bears follows from the three balances across the plane."""

    def rates(t, y):
        v, turn, omega = y[:2], y[2], y[3]
        c, s = np.cos(turn), np.sin(turn)
        turned = np.array([[c, -s], [s, c]])
        arms = FEET @ turned.T
        slips = v + omega * np.column_stack([-arms[:, 1], arms[:, 0]])
        ways = slips / np.linalg.norm(slips, axis=1)[:, None]
        force, place = np.array(push(t)), turned @ np.array(at)
        # sums of N, and of moments about x and y: y N + h f_y and -x N - h f_x, f = -mu N d, the push as low
        balance = np.array([np.ones(3), arms[:, 1] - HEIGHT * mu * ways[:, 1], -arms[:, 0] + HEIGHT * mu * ways[:, 0]])
        normal = np.linalg.solve(balance, [mass * g, -HEIGHT * force[1], HEIGHT * force[0]])
        friction = -mu * normal[:, None] * ways
        moment = (arms[:, 0] @ friction[:, 1] - arms[:, 1] @ friction[:, 0]) + place[0] * force[1] - place[1] * force[0]
        return [*((force + friction.sum(axis=0)) / mass), omega, moment / (0.3 * mass)]

    # whatever it begins with is drawn to the way that it goes
    first, h = 1e-3, 1e-6
    slope = (np.array(push(t0 + h)) - np.array(push(t0 - h))) / (2 * h)
    start = [*(slope * first**2 / 2 / mass), 0, (at[0] * slope[1] - at[1] * slope[0]) * first**2 / mass]
    return solve_ivp(rates, (t0 + first, until), start, method="Radau", rtol=1e-8, atol=1e-12).y[:, -1]


@pytest.mark.parametrize(
    "push, at",
    [
        (lambda t: [4.0 * t, 0.5 * t + 0.5 * t * t], (0.0, 0.0)),
        (lambda t: [4.0 * t, 0 * t], (0.0, 0.4)),
    ],
)
def test_three_feet_that_turn_as_they_let_go(push, at):
    scene, block = block_on_feet(1.0, 0.4, push, at=at)
    run = rb.simulate(scene, 2.0, error=1e-8, max_steps=20000)
    assert run.status == "reached end"
    (t0,) = set(np.round(run.events.times("slip"), 9))
    vx, vy, _, omega = slid(1.0, 0.4, push, at, t0, 2.0)
    assert np.hypot(vx, vy) > 0.1
    assert np.allclose(run[block].velocity(2.0)[:2], [vx, vy], atol=2e-6)
    assert abs(run[block].angular_velocity(2.0)[2] - omega) < 2e-6


def test_two_feet_let_go_and_the_third_is_turned_about():
    """Their ways are along circles about it, to which nothing but the third holds them."""
    mass, mu, at, until = 1.0, 0.4, np.array([0.2, -0.5]), 1.3

    def push(t):
        return np.array([3.0 * t, 0.7 * t * t])

    scene, block = block_on_feet(mass, mu, lambda t: [3.0 * t, 0.7 * t * t], at=at)
    run = rb.simulate(scene, until, error=1e-8)
    start, other = run.events.times("slip")
    assert start == other and len(run.events) == 2

    def rates(t, y):
        # unknown are the angular acceleration, what holds the third foot, and what each of them bears
        omega, c, s = y[1], np.cos(y[0]), np.sin(y[0])
        turned = np.array([[c, -s], [s, c]])
        arms, force, place = FEET @ turned.T, push(t), turned @ at
        about = arms - arms[2]
        ways = np.column_stack([-about[:2, 1], about[:2, 0]]) / np.linalg.norm(about[:2], axis=1)[:, None]
        rub = -mu * ways
        m = np.zeros((6, 6))
        # the centre is at -arms[2] from the foot
        m[0, :3], m[1, :3] = [mass * arms[2][1], -1, 0], [-mass * arms[2][0], 0, -1]
        m[0, 3:5], m[1, 3:5] = -rub[:, 0], -rub[:, 1]
        m[2, :3] = [0.3 * mass, arms[2][1], -arms[2][0]]
        m[2, 3:5] = -(arms[:2, 0] * rub[:, 1] - arms[:2, 1] * rub[:, 0])
        m[3, 3:] = 1.0
        m[4, 2], m[4, 3:] = HEIGHT, arms[:, 1] + HEIGHT * np.append(rub[:, 1], 0)
        m[5, 1], m[5, 3:] = -HEIGHT, -arms[:, 0] - HEIGHT * np.append(rub[:, 0], 0)
        known = [
            force[0] - mass * omega**2 * arms[2][0],
            force[1] - mass * omega**2 * arms[2][1],
            place[0] * force[1] - place[1] * force[0],
            mass * g,
            -HEIGHT * force[1],
            HEIGHT * force[0],
        ]
        return [omega, np.linalg.solve(m, known)[0]]

    assert abs(rates(start, [0.0, 0.0])[1]) < 1e-9
    turn, omega = solve_ivp(rates, (start, until), [0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-15).y[:, -1]
    assert omega > 0.05
    assert abs(run[block].angular_velocity(until)[2] - omega) < 1e-9
    c, s = np.cos(turn), np.sin(turn)
    center = FEET[2] - np.array([[c, -s], [s, c]]) @ FEET[2]
    assert np.allclose(run[block].position(until)[:2], center, rtol=0, atol=1e-10)


@pytest.mark.parametrize("error", [1e-2, 1e-3, 1e-5, 1e-9])
@pytest.mark.parametrize("seed", range(4))
def test_a_pencil_slips_at_a_loose_error_as_at_a_tight_one(error, seed):
    """What the tolerance had left of a speed where the tip lets go threw it back: refused at 1e-2, computed at 1e-9."""
    rng = np.random.default_rng(seed)
    length, mu, tilt = rng.uniform(0.2, 5), rng.uniform(0.3, 0.5), rng.uniform(0.05, 0.3)
    inertia = 0.33 * length**2
    rate = g * length / (inertia + length**2)

    def excess(t, y):
        a, w = y[0], y[1]
        turn = rate * np.sin(a)
        along = length * (turn * np.cos(a) - w * w * np.sin(a))
        normal = g - length * (turn * np.sin(a) + w * w * np.cos(a))
        return abs(along) - mu * normal

    excess.terminal = True
    fall = solve_ivp(
        lambda t, y: [y[1], rate * np.sin(y[0])], (0, 99), [tilt, 0], events=excess, rtol=1e-12, atol=1e-14
    )
    scene = rb.Scene(gravity=[0, 0, -g])
    center = length * np.array([np.sin(tilt), 0, np.cos(tilt)])
    pencil = scene.add(rb.RigidBody(1.0, [inertia] * 3), position=center)
    scene.contact(pencil.point(-center), rb.Plane([0, 0, 1]), friction=rb.Coulomb(mu))
    (start,) = fall.t_events[0]
    run = rb.simulate(scene, 1.02 * start, error=error)
    assert run.events[0].kind == "slip"
    assert abs(run.events[0].time / start - 1) < max(error, 1e-10)


def board_and_ball(velocity, spin, feet, friction, order=(0, 1, 2)):
    scene = rb.Scene(gravity=[0, 0, -9.81])
    board = scene.add(rb.RigidBody(2, [0.02, 0.02, 0.04]), position=[0, 0, 0.05])
    ball = scene.add(rb.RigidBody(1, [0.004] * 3), position=[0, 0, 0.2], velocity=[*velocity, 0], angular_velocity=spin)
    touching = {}
    for i in order:
        foot = [(-0.3, -0.3), (0.3, -0.3), (0, 0.4)][i]
        touching[i] = scene.contact(
            board.point([*foot, -0.05]), rb.Plane([0, 0, 1]), friction=rb.Coulomb(feet), name=f"foot {i + 1}"
        )
    scene.contact(ball.sphere(0.1), board.plane([0, 0, 1], [0, 0, 0.05]), friction=friction)
    return scene, board, touching


@pytest.mark.parametrize("error", [1e-6, 1e-9])
@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_where_one_foot_lifts_the_others_hold(order, error):
    """A ball rolls over the edge of what a board stands on. Two feet need 2 % of what they bear along the floor."""
    velocity, spin = [-0.663009533084391, 0.6474856934569663], [-15.15694043264092, -6.5415102652358295, 0]
    scene, board, feet = board_and_ball(velocity, spin, 0.5075225182721732, rb.Coulomb(0.25), order)
    run = rb.simulate(scene, 0.6, error=error)
    kinds = [(e.kind, e.subject) for e in run.events if "foot" in str(e.subject)]
    assert [kind for kind, _ in kinds] == ["detach"] and "foot 2" in str(kinds[0][1])
    after = run.events.times("detach")[0] + 1e-6
    assert [run[feet[i]].state(after) for i in range(3)] == ["sticks", "open", "sticks"]
    for i in (0, 2):
        force = run[feet[i]].force(after)
        assert np.hypot(*force[:2]) < 0.4 * force[2]
    # what holds does not creep
    assert abs(run[feet[0]].slip(after)).max() < 1e-15 and abs(run[feet[2]].slip(after)).max() < 1e-15


@pytest.mark.parametrize("mu", [math.inf, 0.3])
def test_a_ball_that_begins_to_roll_does_not_strike(mu):
    """v = omega x r but for rounding: it is set to be so, and nothing is told of what stands under it."""
    for n in range(40):
        way = np.array([math.cos(0.157 * n), math.sin(0.157 * n)])
        velocity = 0.5 * way
        scene, board, _ = board_and_ball(velocity, [-velocity[1] / 0.1, velocity[0] / 0.1, 0], 0.5, rb.Coulomb(mu))
        run = rb.simulate(scene, 0.2)
        assert not len(run.events)
        assert np.abs(run[board].velocity(0.1)).max() < 1e-15


def test_what_no_friction_lets_slide_does_not_begin_so():
    def scene_of(friction, velocity, spin):
        scene = rb.Scene(gravity=[0, 0, -g])
        ball = scene.add(rb.RigidBody(1, [0.004] * 3), position=[0, 0, 0.1], velocity=velocity, angular_velocity=spin)
        scene.contact(ball.sphere(0.1), rb.Plane([0, 0, 1]), friction=friction, name="the ground")
        return scene, ball

    for spin, slip in (([0, 0, 0], "is 1;"), ([0, -10, 0], "is 2;"), ([0, 10.00001, 0], "e-07;")):
        with pytest.raises(rb.InvalidInput, match=f"the ground: slip as the scene starts.*{slip}.*Coulomb"):
            rb.simulate(scene_of(rb.Coulomb(math.inf), [1, 0, 0], spin)[0], 1.0)
    # one that it slides with is one
    scene, ball = scene_of(rb.Coulomb(math.inf, 0.2), [1, 0, 0], [0, 0, 0])
    run = rb.simulate(scene, 1.0)
    assert run[ball].velocity(0.0)[0] == 1.0
    assert [e.kind for e in run.events] == ["stick"]
    assert abs(run.events[0].time / (2 / (7 * 0.2 * g)) - 1) < 1e-13
    assert abs(run[ball].velocity(1.0)[0] - 5 / 7) < 1e-14


@pytest.mark.parametrize("v", [1.0, 1e-6, 1e-11, 1e-12])
def test_a_slow_ball_rolls_on_and_does_not_rest(v):
    """Its motion is that of a fast one, scaled: it sticks at 2 v / (7 mu g) and keeps 5/7 of its speed."""
    scene = rb.Scene(gravity=[0, 0, -g])
    ball = scene.add(rb.RigidBody(1, [0.004] * 3), position=[0, 0, 0.1], velocity=[v, 0, 0])
    scene.contact(ball.sphere(0.1), rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.3))
    run = rb.simulate(scene, 2.0, rtol=1e-12)
    assert [e.kind for e in run.events] == ["stick"]
    assert abs(run.events[0].time / (2 * v / (7 * 0.3 * g)) - 1) < 1e-14
    assert abs(run[ball].velocity(2.0)[0] / (5 / 7 * v) - 1) < 1e-14


def sledge_across(slope, mu, turn, feet, speed):
    """A sledge on feet, on an incline that falls along x, thrown across it."""
    scene = rb.Scene(gravity=[g * math.sin(slope), 0, -g * math.cos(slope)])
    c, s = math.cos(turn), math.sin(turn)
    sledge = scene.add(
        rb.RigidBody(2.0, [0.1, 0.2, 0.25]),
        position=[0, 0, 0.125],
        velocity=[0, speed, 0],
        attitude=[[c, -s, 0], [s, c, 0], [0, 0, 1]],
    )
    for x, y in feet:
        scene.contact(sledge.point([x, y, -0.125]), rb.Plane([0, 0, 1]), friction=rb.Coulomb(mu))
    return scene, sledge


CORNERS = [(0.5, 0.25), (0.5, -0.25), (-0.5, 0.25), (-0.5, -0.25)]


@pytest.mark.parametrize("feet", [CORNERS, [*CORNERS, (0.0, 0.1), (0.2, -0.3)]], ids=len)
@pytest.mark.parametrize("turn", [0.0, 0.3, 2.4])
@pytest.mark.parametrize(("slope", "mu"), [(0.5, 0.1), (0.9, 0.3)])
def test_a_sledge_thrown_across_an_incline_slides_as_a_point_does(feet, turn, slope, mu):
    """More feet than it needs, whose forces are one choice of many, in a direction that turns: what slides as a whole
    has one direction, so that its motion is that of a point. It ended as Painleve's at the first turn."""
    scene, sledge = sledge_across(slope, mu, turn, feet, 1.0)
    run = rb.simulate(scene, 3.0, error=1e-10)

    def point(_, y):
        u, v = y[2:]
        friction = mu * g * math.cos(slope) / math.hypot(u, v)
        return [u, v, g * math.sin(slope) - friction * u, -friction * v]

    exact = solve_ivp(point, (0, 3.0), [0, 0, 0, 1.0], method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    assert run.status == "reached end" and not run.events
    assert np.allclose(run[sledge].position(3.0), [*exact[:2], 0.125], rtol=1e-11, atol=1e-11)
    assert np.allclose(run[sledge].velocity(3.0), [*exact[2:], 0.0], rtol=1e-11, atol=1e-11)
    assert np.abs(run[sledge].angular_velocity(3.0)).max() < 1e-12
    names = [f"contact {k + 1}" for k in range(len(feet))]
    assert run.plan.not_unique == names
    # each presses, and they balance what presses on the whole
    forces = [run[name].force(1.0) for name in names]
    assert min(force[2] for force in forces) > 0
    assert sum(force[2] for force in forces) == pytest.approx(2.0 * g * math.cos(slope), rel=1e-12)


@pytest.mark.parametrize("turn", [0.0, 1.1])
def test_a_sledge_thrown_across_an_incline_that_is_too_rough_stops(turn):
    slope, mu = 0.4, 0.7
    scene, sledge = sledge_across(slope, mu, turn, CORNERS, 1.0)
    run = rb.simulate(scene, 2.0, error=1e-9)
    # v = tan(phi/2)^k / sin phi, phi from the line of fall, k = mu cot(slope) > 1, and phi' = -g sin(slope) sin phi / v
    k = mu / math.tan(slope)
    half = solve_ivp(
        lambda s, y: [math.tan(s / 2) ** k / math.sin(s) ** 2], (1e-12, math.pi / 2), [0.0], rtol=1e-12, atol=1e-15
    )
    stop = half.y[0, -1] / (g * math.sin(slope))
    assert [e.kind for e in run.events if e.kind == "stick"] == ["stick"] * 4
    assert np.allclose(run.events.times("stick"), stop, rtol=1e-8, atol=0)
    assert np.abs(run[sledge].velocity(2.0)).max() < 1e-12
