"""Friction in joints and on rails beside contacts: against laws written down apart (joints_at_contacts_by_hand.py), and
by what impulses and friction may do at all."""

import math

import numpy as np
import pytest
import rbdyn as rb
from joints_at_contacts_by_hand import Cart, Wedge, g
from scipy.integrate import solve_ivp


def wedge(masses, slope, friction, pull, restitution, height, rate):
    scene = rb.Scene(gravity=[0, -g, 0])
    slides = [rb.Prismatic(axis, friction=rb.Coulomb(*mu)) for axis, mu in zip(np.eye(3)[:2], friction, strict=True)]
    a = scene.add(rb.RigidBody(masses[0], [0.1] * 3), slides[0], rate=rate, name="A")
    b = scene.add(rb.RigidBody(masses[1], [0.1] * 3), slides[1], displacement=height, name="B")
    scene.apply(rb.JointForce(lambda t, q, w: pull + 0.0 * t), a)
    incline = a.plane([-math.sin(slope), math.cos(slope), 0])
    return scene, a, b, scene.contact(b.point([0, 0, 0]), incline, restitution=restitution)


@pytest.mark.parametrize("seed", range(40))
def test_a_block_on_a_rough_slide_strikes_another(seed):
    """Both slide, stick, are held by their friction and the contact together, and are struck while they do."""
    rng = np.random.default_rng(seed)
    masses, slope = rng.uniform(0.5, 3, 2), rng.uniform(0.2, 1.3)
    dynamic = rng.uniform(0.02, 0.6, 2)
    friction = [(mu * rng.uniform(1, 1.5), mu) for mu in dynamic]
    pull, e, height = rng.uniform(-8, 4), rng.choice([0, 0, 0.3, 0.6]), rng.uniform(0.05, 0.6)
    rate = rng.choice([0, rng.uniform(-1, 1)])
    by_hand = Wedge(masses, slope, friction, pull, e)
    end, place, events, impacts = by_hand.run([0, height], [rate, 0], 1.0)
    scene, a, b, touch = wedge(masses, slope, friction, pull, e, height, rate)
    run = rb.simulate(scene, until=1.0, error=1e-9)
    assert run.error <= 1e-9
    assert abs(run[a].displacement(end) - place[0]) < 2e-10 and abs(run[b].displacement(end) - place[1]) < 2e-10
    strikes = [f for f in run.events if f.kind in ("impact", "land") and np.linalg.norm(f.impulse) > 0]
    for found, (normal, t) in zip(strikes, impacts, strict=False):
        assert abs(found.time - t) < 1e-10
        # where all of it stops the impulses are one choice of many
        if run[a].rate(t + 1e-12) or run[b].rate(t + 1e-12):
            assert abs(np.linalg.norm(found.impulse) - normal) < 1e-9
    rubs = [(f.kind, f.time) for f in run.events if f.kind in ("stick", "slip", "reverse") and f.time < end - 1e-9]
    told = [(kind, t) for kind, _, t in events if t < end - 1e-9]
    assert sorted(kind for kind, _ in rubs) == sorted(kind for kind, _ in told)
    assert max((abs(x[1] - y[1]) for x, y in zip(rubs, told, strict=True)), default=0.0) < 1e-10
    # what sticks stays
    later = rb.simulate(scene, until=1e3, rtol=1e-10, max_steps=100000)
    if run[a].rate(1.0) == 0.0 and run[b].rate(1.0) == 0.0:
        assert later[a].displacement(1e3) == later[a].displacement(1.0)
        assert later[b].displacement(1e3) == later[b].displacement(1.0)


def cart(masses, radius, wall, bead, slide, restitution, push, angle, rate, speed):
    scene = rb.Scene(gravity=[0, -g, 0])
    car = scene.add(
        rb.RigidBody(masses[0], [0.1] * 3),
        rb.Prismatic([1, 0, 0], friction=rb.Coulomb(*slide)),
        rate=speed,
        name="cart",
    )
    hoop = rb.Circle(radius=radius, start=[0, -1, 0], toward=[1, 0, 0])
    pearl = scene.add(
        rb.Particle(masses[1]),
        rb.Rail(hoop, friction=rb.Coulomb(*bead)),
        parent=car,
        parameter=angle,
        speed=radius * rate,
        name="bead",
    )
    scene.apply(rb.JointForce(lambda t, q, v: push(t, np)), car)
    touch = scene.contact(car.point([0, 0, 0]), rb.Plane([-1, 0, 0], point=[wall, 0, 0]), restitution=restitution)
    return scene, car, pearl, touch


@pytest.mark.parametrize("seed", range(12))
def test_a_rough_bead_on_a_cart_that_is_pushed_against_a_wall(seed):
    rng = np.random.default_rng(seed)
    masses, radius, wall = [rng.uniform(0.5, 3), rng.uniform(0.3, 2)], rng.uniform(0.2, 0.8), rng.uniform(0.02, 0.3)
    mb, ms = rng.uniform(0.1, 0.6), rng.uniform(0.02, 0.3)
    bead, slide = (mb * rng.uniform(1, 1.5), mb), (ms * rng.uniform(1, 1.5), ms)
    e, level, swing, pace = rng.choice([0, 0.5]), rng.uniform(0, 10), rng.uniform(0, 15), rng.uniform(3, 9)

    def push(t, n=math):
        return level + swing * n.sin(pace * t)

    start = rng.uniform(-2.5, 2.5), rng.uniform(-8, 8), rng.uniform(-1, 1)
    by_hand = Cart(masses, radius, wall, bead, slide, e, push)
    end, y, events, impacts = by_hand.run([0, start[0], start[2], start[1]], 2.0)
    scene, car, pearl, touch = cart(masses, radius, wall, bead, slide, e, push, *start)
    run = rb.simulate(scene, until=max(end, 0.1), error=1e-9)
    assert run.error <= 1e-9
    assert abs(run[car].displacement(end) - y[0]) < 1e-9 and abs(run[pearl].parameter(end) - y[1]) < 1e-9
    strikes = [f for f in run.events if f.kind in ("impact", "land") and np.linalg.norm(f.impulse) > 0]
    for found, (force, t) in zip(strikes, impacts, strict=False):
        assert abs(found.time - t) < 1e-9 and abs(np.linalg.norm(found.impulse) - force) < 1e-8
    rubs = [(f.kind, f.time) for f in run.events if f.kind in ("stick", "slip", "reverse") and f.time < end - 1e-7]
    told = [(kind, t) for kind, _, t in events if t < end - 1e-7]
    # at one instant in any order
    rubs, told = (sorted(events, key=lambda one: (round(one[1], 7), one[0])) for events in (rubs, told))
    assert [kind for kind, _ in rubs] == [kind for kind, _ in told]
    assert max((abs(x[1] - z[1]) for x, z in zip(rubs, told, strict=True)), default=0.0) < 1e-9
    # what friction and impacts take is never given back, whatever the push does
    t = np.linspace(0, end, 401)
    work = np.concatenate(
        [[0], np.cumsum(np.diff(t) * (lambda p: (p[1:] + p[:-1]) / 2)(push(t, np) * run[car].rate(t)))]
    )
    assert np.diff(run.energy(t) - work).max() < 1e-3


def rod_over_a_floor(restitution, friction=None, height=0.9, static=0.5, dynamic=0.3, angle=1.3):
    scene = rb.Scene(gravity=[0, -g, 0])
    hinge = rb.Revolute([0, 0, 1], friction=rb.Coulomb(static, dynamic), pin_radius=0.1)
    rod = scene.add(rb.RigidBody(1.3, [0.2, 0.2, 0.4], com=[0, -0.7, 0]), hinge, angle=angle)
    floor = rb.Plane([0, 1, 0], point=[0, -height, 0])
    return scene, rod, scene.contact(rod.point([0, -1.4, 0]), floor, restitution=restitution, friction=friction)


def falls(dynamic, angle, low):
    """When a rod on a rough pin comes down to an angle, and how fast: the equation of test_joint_friction.py."""
    m, c, moment, k = 1.3, 0.7, 0.4 + 1.3 * 0.7**2, dynamic * 0.1

    def acceleration(phi, w):
        sign = -1
        along, b, p, q = -m * c * w * w - m * g * math.cos(phi), m * c, m * g * math.sin(phi), m * g * c * math.sin(phi)
        a2, a1 = moment**2 - (k * b) ** 2, 2 * (moment * q - k * k * b * p)
        a0 = q * q - k * k * (along * along + p * p)
        return (-a1 - sign * math.sqrt(a1 * a1 - 4 * a2 * a0)) / (2 * a2)

    def lands(_, y):
        return y[0] - low

    lands.terminal = True
    found = solve_ivp(
        lambda _, y: [y[1], acceleration(*y)],
        (0, 9),
        [angle, 0.0],
        method="DOP853",
        rtol=1e-13,
        atol=1e-14,
        events=lands,
    )
    return found.t[-1], found.y[1, -1]


@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("mu", [None, 0.2, math.inf])
def test_a_rod_on_a_rough_hinge_falls_on_a_floor_and_rests(error, mu):
    scene, rod, touch = rod_over_a_floor(0.0, None if mu is None else rb.Coulomb(mu))
    low = math.acos(0.9 / 1.4)
    t, w = falls(0.3, 1.3, low)
    run = rb.simulate(scene, until=1e5, error=error)
    (lands,) = run.events.times("land")
    assert abs(lands - t) < max(error, 1e-12)
    assert abs(run[rod].rate(lands, side="before") - w) < max(10 * error, 1e-11)
    assert run[rod].rate(lands) == 0.0 and run[rod].angle(1e5) == run[rod].angle(lands)
    assert run[touch].state(lands + 1.0) != "open"
    # its forces are one choice of many: the moments about the pin balance, friction there is no more than its limit
    force, pin, torque = run[touch].force(9.0), run[rod].reaction(9.0), run[rod].reaction_torque(9.0)[2]
    arm = np.array([1.4 * math.sin(low), -0.9, 0])
    assert abs(np.cross(arm, force)[2] - 1.3 * g * 0.7 * math.sin(low) + torque) < 1e-9
    assert abs(torque) <= 0.5 * 0.1 * np.linalg.norm(pin[:2]) + 1e-9


def test_a_rod_on_a_rough_hinge_bounces_to_rest():
    """One freedom: an impact leaves e of the rate, whatever friction is; its impulse is that of pin and hinge, too."""
    scene, rod, touch = rod_over_a_floor(0.5)
    run = rb.simulate(scene, until=5.0, error=1e-10)
    first = next(f for f in run.events if f.kind == "impact")
    w = run[rod].rate(first.time, side="before")
    assert abs(run[rod].rate(first.time) + 0.5 * w) < 1e-13 * abs(w)
    # (I + m c^2) (w+ - w-) = x N - s mu r |P|,  P = m c (w+ - w-) along - N up
    low, m, c = run[rod].angle(first.time), 1.3, 0.7
    change, normal = -1.5 * w, first.impulse[1]
    pin = m * c * change * np.array([math.cos(low), math.sin(low)]) - [0, normal]
    friction = -0.3 * 0.1 * np.hypot(*pin)
    assert abs((0.4 + m * c * c) * change - 1.4 * math.sin(low) * normal - friction) < 1e-12
    (ends,) = run.events.times("accumulation")
    assert run[rod].rate(5.0) == 0.0 and run[rod].angle(5.0) == run[rod].angle(ends)


def test_a_lever_that_a_floor_and_its_hinge_hold_together_breaks_when_neither_can():
    """The floor takes what it can as the torque grows that lifts the rod; then the hinge alone, up to its limit."""
    scene, rod, touch = rod_over_a_floor(0.0, angle=math.acos(0.9 / 1.4))
    scene.apply(rb.JointTorque(lambda t, q, w: t), rod)
    run = rb.simulate(scene, until=12.0, error=1e-10)
    low = math.acos(0.9 / 1.4)
    moment = 1.3 * g * 0.7 * math.sin(low)
    (slips,) = run.events.times("slip")
    # the torque beyond the weight's moment is what the hinge resists: mu r times the weight on its pin
    assert abs(slips - (moment + 0.5 * 0.1 * 1.3 * g)) < 1e-9
    assert run[rod].angle(slips) == run[rod].angle(0.0) and run[rod].rate(slips + 0.1) > 0.0


def test_a_bead_that_lands_on_a_rough_rail_is_slowed_along_it():
    """Coulomb's law of impulses: against the slip after it, mu times what of the impulse is across the rail."""
    m, mass = 0.5, 2.0
    for mu in (0.1, 0.3, 5.0):
        scene = rb.Scene(gravity=[0, 0, -g])
        car = scene.add(rb.RigidBody(mass, [0.1] * 3), rb.Prismatic([1, 0, 0]))
        bowl = rb.Rail(rb.Parabola(1.0, [1, 0, 0], [0, 0, 1]), side="+", up=[0, 0, 1], friction=rb.Coulomb(mu))
        bead = scene.add(rb.Particle(m), bowl, parent=car, parameter=-0.4, speed=1.0)
        scene.apply(rb.Force(lambda t, r, v: [0, 0, 30 * np.exp(-(((t - 0.2) / 0.05) ** 2))]), bead)
        run = rb.simulate(scene, until=2.0, error=1e-10)
        lands = run.events.times("land")[0]
        before, after = (run[bead].velocity(lands, side=s) for s in ("before", "after"))
        slow, fast = (run[car].rate(lands, side=s) for s in ("before", "after"))
        u = run[bead].parameter(lands)
        normal, along = np.array([-2 * u, 0, 1]) / math.hypot(1, 2 * u), np.array([1, 0, 2 * u]) / math.hypot(1, 2 * u)
        impulse = m * (after - before)
        assert abs(mass * (fast - slow) + impulse[0]) < 1e-12
        slip = (after - [fast, 0, 0]) @ along
        assert abs((after - [fast, 0, 0]) @ normal) < 1e-12 and impulse @ normal > 0
        if mu < 1:
            assert abs(impulse @ along + math.copysign(mu, slip) * (impulse @ normal)) < 1e-12
        else:
            assert abs(slip) < 1e-14 and abs(impulse @ along) < mu * (impulse @ normal)


def test_alone_it_is_slowed_by_the_same_law():
    scene = rb.Scene(gravity=[0, 0, -g])
    floor = rb.Rail(rb.Line([1, 0, 0]), side="+", up=[0, 0, 1], friction=rb.Coulomb(0.25))
    bead = scene.add(rb.Particle(0.5), floor, parameter=0.0, speed=3.0)
    scene.apply(rb.Force(lambda t, r, v: [0, 0, 10 * np.exp(-(((t - 0.2) / 0.05) ** 2))]), bead)
    run = rb.simulate(scene, until=2.0, error=1e-11)
    lands = run.events.times("land")[0]
    before, after = (run[bead].velocity(lands, side=s) for s in ("before", "after"))
    assert before[2] < -0.1 and after[2] == 0.0
    assert abs(after[0] - (before[0] + 0.25 * before[2])) < 1e-14


@pytest.mark.parametrize("mu", [1e-3, 0.1, 0.3, 0.8])
@pytest.mark.parametrize("height", [0.0, -0.05])
def test_what_a_joint_has_held_over_its_contact_rises_where_it_breaks(mu, height):
    """A rod on a rough pin, lifted ever harder: its tip is let go, the pin holds on, then it rises. By statics."""
    mass, g, radius, growth = 2.0, 10.0, 0.05, 4.0
    angle = math.asin(height / 0.9)
    scene = rb.Scene(gravity=[0, -g, 0])
    pin = rb.Revolute([0, 0, 1], friction=rb.Coulomb(mu), pin_radius=radius)
    rod = scene.add(rb.RigidBody(mass, [0.01, 0.2, 0.2], com=[0.5, 0, 0]), pin, angle=angle)
    tip = scene.contact(rod.point([0.9, 0, 0]), rb.Plane([0, 1, 0], [0, height, 0]))
    scene.apply(rb.JointTorque(lambda t, q, w: growth * t), rod)
    run = rb.simulate(scene, 3.2)
    slips = (0.5 * mass * g * math.cos(angle) + mu * radius * mass * g) / growth
    assert abs(run.events.times("slip")[-1] - slips) < 1e-11
    assert run[tip].state(3.2) == "open" and run[rod].rate(3.2) > 0


@pytest.mark.parametrize("mu", [0.05, 0.2, 0.5])
def test_a_block_on_a_rough_slide_is_lifted_off_its_floor(mu):
    scene = rb.Scene(gravity=[0, 0, -10.0])
    block = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Prismatic([0, 0, 1], friction=rb.Coulomb(mu)))
    scene.contact(block.point([0, 0, 0]), rb.Plane([0, 0, 1]))
    scene.apply(rb.Force([2.0, 0, 0]), block)
    scene.apply(rb.JointForce(lambda t, q, v: 4 * t), block)
    run = rb.simulate(scene, 4.0)
    slips = (10 + 2 * mu) / 4
    assert abs(run.events.times("slip")[-1] - slips) < 1e-11
    # a = 4 (t - slips)
    assert abs(run[block].displacement(4.0) - 4 * (4 - slips) ** 3 / 6) < 1e-9


@pytest.mark.parametrize("pin", [(0.6, 0.1), (0.5, 0.1), (0.5, 0.2), (0.6, 0.2)])
@pytest.mark.parametrize(
    ("angle", "normal"), [(0.3, [0, 1, 0]), (0.7, [0, 1, 0]), (1.0, [-1, 0, 0]), (-0.5, [0, 1, 0])]
)
@pytest.mark.parametrize("mu", [0.5, 0.6])
def test_a_rod_on_a_rough_pin_is_lifted_off_a_rough_wall(pin, angle, normal, mu):
    """The push of the wall ends at the very instant at which the pin breaks away, its friction mu r m g."""
    rough, radius = pin
    m, c, moment, most, pace = 1.0, 0.5, 1 / 3, 12.0, 3.0
    scene = rb.Scene(gravity=[0, -g, 0])
    hinge = rb.Revolute([0, 0, 1], friction=rb.Coulomb(rough), pin_radius=radius)
    body = rb.RigidBody(m, [0.01, moment, moment], com=[c, 0, 0], inertia_about="origin")
    rod = scene.add(body, hinge, angle=angle)
    scene.apply(rb.JointTorque(lambda t, q, w: most * np.sin(pace * t)), rod)
    wall = rb.Plane(normal, point=[math.cos(angle), math.sin(angle), 0])
    touch = scene.contact(rod.point([1, 0, 0]), wall, friction=rb.Coulomb(mu))
    begins = math.asin(m * g * (c * math.cos(angle) + rough * radius) / most) / pace

    def acceleration(t, q, w):
        a = 0.0
        for _ in range(60):
            across = m * (c * a + g * math.cos(q))
            along = m * (g * math.sin(q) - c * w * w)
            rubs = rough * radius * math.hypot(across, along)
            a = (most * math.sin(pace * t) - m * g * c * math.cos(q) - rubs) / moment
        return a

    by_hand = solve_ivp(
        lambda t, y: [y[1], acceleration(t, *y)], (begins, 0.5), [angle, 0], method="DOP853", rtol=1e-13, atol=1e-15
    )
    run = rb.simulate(scene, 0.5, error=1e-9)
    for kind in ("detach", "slip"):
        (at,) = run.events.times(kind)
        assert abs(at - begins) < 1e-11
    assert run.events.times("detach", touch).size == 1
    assert abs(run[rod].angle(0.5) - by_hand.y[0, -1]) < 1e-9
    assert abs(run[rod].rate(0.5) - by_hand.y[1, -1]) < 1e-9
