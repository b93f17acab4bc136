"""Rails that beads leave, beside bodies that are joined: against the same rail without a tree, and against laws of a
bead on a cart that gives way, written down apart."""

import math

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp

g = 9.81
dome = rb.Circle(radius=1.0, start=[0, 0, 1], toward=[1, 0, 0])
bowl = rb.Parabola(1.0, [1, 0, 0], [0, 0, 1])
floor = rb.Line([1, 0, 0])
hills = rb.Spline([[0, 0, 1], [1, 0, 0.2], [2, 0, 0.8], [3, 0, 0], [4, 0, 0.7], [5, 0, 0]])
track = rb.Polynomial([[0, 0, 0], [1, 0, 0.4]])


def in_both(rail, until=3.0, load=None, **start):
    """A bead on a rail of the world: alone, and held together with a tree by a load that is called with both."""
    runs = []
    for joined in (False, True):
        scene = rb.Scene(gravity=[0, 0, -g])
        if joined:
            rod = scene.add(rb.shapes.rod(1.0, 1.0, [0, 0, 1]), rb.Revolute([0, 1, 0], at=[50, 0, 0]), angle=0.3)
            part = scene.add(rb.shapes.rod(1.0, 1.0, [0, 0, 1]), rb.Revolute([0, 1, 0]), parent=rod, angle=0.3)
        bead = scene.add(rb.Particle(0.5), rail, **start)
        if joined:
            # what watches both keeps them in one model
            scene.watch("both", lambda now, a=part, b=bead: now[a].angle + now[b].position[0] - 1e6)
        if load is not None:
            scene.apply(load, bead)
        runs.append((rb.simulate(scene, until=until, error=1e-11), bead))
    return runs


THROWN = {
    "off a dome": (rb.Rail(dome, side="+", up=[0, 0, 1]), {"parameter": 0.1, "speed": 0.1}, None),
    "off a rough dome": (
        rb.Rail(dome, side="+", up=[0, 0, 1], friction=rb.Coulomb(0.3, 0.2)),
        {"parameter": 0.3, "speed": 1.5},
        None,
    ),
    "over hills": (rb.Rail(hills, side="+", up=[0, 0, 1]), {"parameter": 0.05, "speed": 3.0}, None),
    "over rough hills": (
        rb.Rail(hills, side="+", up=[0, 0, 1], friction=rb.Coulomb(0.1, 0.05)),
        {"parameter": 0.05, "speed": 4.0},
        None,
    ),
    "from the start": (rb.Rail(bowl, side="-", up=[0, 0, 1]), {"parameter": 0.2, "speed": 1.0}, None),
    "up from a floor": (
        rb.Rail(floor, side="+", up=[0, 0, 1]),
        {"parameter": 0.0, "speed": 1.0},
        lambda t, r, v: [0, 0, 10 * np.sin(3 * t)],
    ),
    "off an end": (
        rb.Rail(rb.Spline([[0, 0, 0], [1, 0, 0], [2, 0, 0.5]]), ends="release"),
        {"parameter": 1.0, "speed": 6.0},
        None,
    ),
}


@pytest.mark.parametrize("name", THROWN)
def test_a_bead_leaves_a_rail_and_lands_as_it_does_without_a_tree(name):
    rail, start, force = THROWN[name]
    (alone, first), (tree, second) = in_both(rail, load=None if force is None else rb.Force(force), **start)
    said = [[(e.kind, e.direction) for e in run.events] for run in (alone, tree)]
    assert said[0] == said[1] and (said[0] or name == "from the start")
    for a, b in zip(alone.events, tree.events, strict=True):
        assert abs(a.time - b.time) < 1e-12 and abs(a.impulse - b.impulse) < 1e-11
    for t in np.linspace(0.03, alone.end - 0.03, 29):
        for what in ("position", "velocity", "acceleration", "parameter", "speed", "reaction"):
            one, other = (np.asarray(getattr(run[bead], what)(t)) for run, bead in ((alone, first), (tree, second)))
            assert np.abs(one - other).max() < 1e-10 * max(1.0, np.abs(one).max()), (what, t)


def cart_with(rail, mass=2.0, force=None, **start):
    scene = rb.Scene(gravity=[0, 0, -g])
    cart = scene.add(rb.RigidBody(mass, [0.1, 0.1, 0.1]), rb.Prismatic([1, 0, 0]), name="cart")
    bead = scene.add(rb.Particle(0.5), rail, parent=cart, name="bead", **start)
    if force is not None:
        scene.apply(rb.Force(force), cart)
    return scene, cart, bead


@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("mass", [0.5, 2.0, 1e6])
def test_a_bead_leaves_a_dome_that_slides_away_under_it(mass, error):
    """The dome is free along x: a text-book problem whose angle is a root of a cubic."""
    run_scene, cart, bead = cart_with(rb.Rail(dome, side="+", up=[0, 0, 1]), mass=mass, parameter=1e-3)
    m = 0.5
    run = rb.simulate(run_scene, until=3.0, error=error)
    (leaves,) = run.events.times("detach")
    u = run[bead].parameter(leaves)
    # from rest at u0: cos u solves k c^3 - 3 c + 2 c0 = 0 (at u0 = 0 k c^3 - 3 c + 2 = 0), k = m / (m + M)
    k, c0 = m / (m + mass), math.cos(1e-3)
    root = [x.real for x in np.roots([k, 0, -3, 2 * c0]) if abs(x.imag) < 1e-12 and 0 < x.real < 1]
    assert abs(math.cos(u) - root[0]) < max(error, 1e-13)
    # before: momentum along x and energy stay; after: the cart keeps its velocity and the bead falls freely
    last = min(run.end, leaves + 0.5)
    assert abs(mass * run[cart].rate(last) + m * run[bead].velocity(last)[0]) < 1e-9
    v, place = run[bead].velocity(leaves), run[bead].position(leaves)
    d = last - leaves
    falls = place + v * d + np.array([0, 0, -0.5 * g * d * d])
    assert np.abs(run[bead].position(last) - falls).max() < max(error, 1e-12)
    assert run[cart].rate(last) == run[cart].rate(leaves)
    assert np.all(run[bead].reaction(last) == 0.0) and run[bead].speed(last) == 0.0
    assert run.error <= error


def test_a_bead_lands_in_a_bowl_that_gives_way_and_leaves_its_momentum():
    """Thrown off one side of a parabola that is free along x, it comes back: what is lost is the energy across it."""
    m, mass = 0.5, 2.0
    lift = rb.Force(lambda t, r, v: [0, 0, 30 * np.exp(-(((t - 0.2) / 0.05) ** 2))])
    scene, cart, bead = cart_with(rb.Rail(bowl, side="+", up=[0, 0, 1]), mass=mass, parameter=-0.4, speed=1.0)
    scene.apply(lift, bead)
    run = rb.simulate(scene, until=3.0, error=1e-10)
    leaves, lands = run.events.times("detach")[0], run.events.times("land")[0]
    assert leaves < lands
    before, after = (run[bead].velocity(lands, side=s) for s in ("before", "after"))
    slow, fast = (run[cart].rate(lands, side=s) for s in ("before", "after"))
    u = run[bead].parameter(lands)
    place = run[bead].position(lands)
    x = place[0] - run[cart].displacement(lands)
    assert abs(place[2] - x * x) < 1e-13 and abs(u - x) < 1e-13
    normal = np.array([-2 * u, 0, 1]) / math.hypot(1, 2 * u)
    # the impulse is along the normal, on both, and leaves no velocity of one against the other across the rail
    impulse = m * (after - before)
    assert np.abs(impulse - (impulse @ normal) * normal).max() < 1e-12 and impulse @ normal > 0
    assert abs(mass * (fast - slow) + impulse[0]) < 1e-12
    assert abs((after - [fast, 0, 0]) @ normal) < 1e-13
    assert abs(run.events[[e.kind for e in run.events].index("land")].impulse - impulse @ normal) < 1e-12
    # the heights of its flight, in the cart's axes, by Newton's law of a free bead
    flight = np.linspace(leaves, lands, 11)[1:-1]
    assert all(run[bead].position(t)[2] > (run[bead].position(t)[0] - run[cart].displacement(t)) ** 2 for t in flight)
    # energy: what lift and landing did; without either none
    assert run.energy(3.0) < run.energy(lands, side="before") + 1e-9


@pytest.mark.parametrize("seed", range(8))
def test_random_beads_on_hinged_hoops_leave_and_land_and_lose_energy(seed):
    rng = np.random.default_rng(seed)
    scene = rb.Scene(gravity=[0, 0, -g])
    arm = scene.add(
        rb.RigidBody(rng.uniform(1, 3), [0.3, 0.3, 0.3], com=[0, 0, -0.3]),
        rb.Revolute([0, 1, 0]),
        angle=rng.normal() * 0.5,
        rate=rng.normal(),
    )
    hoop = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0], center=[0, 0, -0.5])
    friction = rb.Coulomb(0.2, 0.1) if seed % 2 else None
    rail = rb.Rail(hoop, side="+", up=[0, 0, 1], friction=friction)
    bead = scene.add(rb.Particle(0.3), rail, parent=arm, parameter=0.0, speed=rng.uniform(3.5, 6))
    run = rb.simulate(scene, until=4.0, error=1e-9)
    ends = [0.0, *(e.time for e in run.events), 4.0]
    for a, b in zip(ends[:-1], ends[1:], strict=True):
        if b - a < 1e-6:
            continue
        t = np.linspace(a, b, 9)[1:-1]
        assert np.all(np.diff(run.energy(t)) < 1e-9)
        for s in t:
            turn = run[arm].rotation_matrix(s).T
            inside = turn @ run[bead].position(s) - [0, 0, -0.5]
            out = np.linalg.norm(inside)
            flies = np.all(run[bead].reaction(s) == 0.0)
            assert out < 0.5 + 1e-12 if flies else abs(out - 0.5) < 1e-12
            if not flies:
                assert (turn @ run[bead].reaction(s)) @ inside < 1e-9
    for e in run.events:
        if e.kind == "land":
            assert run.energy(e.time) <= run.energy(e.time, side="before") + 1e-10 and e.impulse > 0


@pytest.mark.parametrize("is_still", [True, False])
def test_what_leaves_does_not_touch_again_at_once(is_still):
    """Where the reaction vanishes the height begins with the third power of time, and rounding comes first."""
    scene = rb.Scene(gravity=[0, 0, -g])
    post = scene.add(rb.RigidBody(1.0, [0.1, 0.1, 0.1]), rb.Fixed() if is_still else rb.Prismatic([0, 1, 0]))
    bead = scene.add(rb.Particle(0.5), rb.Rail(dome, side="+", up=[0, 0, 1]), parent=post, parameter=0.0, speed=1e-6)
    run = rb.simulate(scene, until=7.0, error=1e-9)
    assert [e.kind for e in run.events] == ["detach"]
    assert abs(run[bead].parameter(run.events[0].time) - math.acos(2 / 3)) < 1e-12
    # lifted off a floor of a cart, by a force that grows through its weight
    for k in (7.0, 10.0, 13.0):
        scene, _, bead = cart_with(rb.Rail(floor, side="+", up=[0, 0, 1]), parameter=0.0, speed=1.0)
        scene.apply(rb.Force(lambda t, r, v, k=k: [0, 0, k * t]), bead)
        run = rb.simulate(scene, until=2.0, error=1e-9)
        assert [e.kind for e in run.events] == ["detach"]
        assert abs(run.events[0].time - 0.5 * g / k) < 1e-14
        d = 2.0 - run.events[0].time
        assert abs(run[bead].position(2.0)[2] - k * d**3 / 6 / 0.5) < 1e-11


def test_a_flight_over_a_cart_is_what_dop853_makes_of_it():
    """A rough floor of a cart that is shaken up and down by a motion: the bead is thrown off, flies and lands again."""
    scene = rb.Scene(gravity=[0, 0, -g])
    lift = scene.add(
        rb.RigidBody(1.0, [0.1, 0.1, 0.1]), rb.Prismatic([0, 0, 1], motion=lambda t: 0.05 * np.sin(20 * t))
    )
    cart = scene.add(rb.RigidBody(2.0, [0.1, 0.1, 0.1]), rb.Prismatic([1, 0, 0]), parent=lift, rate=0.3)
    rail = rb.Rail(floor, side="+", up=[0, 0, 1], friction=rb.Coulomb(0.3, 0.2))
    bead = scene.add(rb.Particle(0.5), rail, parent=cart, parameter=0.0, speed=2.0)
    run = rb.simulate(scene, until=0.6, error=1e-11)
    y, events = [0.0, 0.0, 0.3, 2.0], []  # of the cart and, along it, of the bead: places and velocities
    t, mu = 0.0, 0.2
    # 20^2 0.05 sin(20 t) = g where it leaves
    while True:

        def rates(t, y):
            n = 0.5 * (g - 20 * math.sin(20 * t))
            f = -math.copysign(mu * n, y[3])
            return [y[2], y[3], -f / 2.0, f / 0.5 + f / 2.0]

        def leaves(t, y):
            return g - 20 * math.sin(20 * t)

        leaves.terminal, leaves.direction = True, -1
        found = solve_ivp(rates, (t, 0.6), y, method="DOP853", rtol=1e-13, atol=1e-14, max_step=0.01, events=leaves)
        t, y = found.t[-1], found.y[:, -1]
        if t >= 0.6:
            break
        events.append(("detach", t))
        height, speed, begin = 0.05 * math.sin(20 * t), math.cos(20 * t), t

        def above(s, h=height, v=speed, b=begin):
            return h + v * (s - b) - 0.5 * g * (s - b) ** 2 - 0.05 * math.sin(20 * s)

        late = begin + 1e-3
        while late < 0.6 and above(late) > 0:
            late += 1e-3
        if late >= 0.6:
            y = [y[0] + y[2] * (0.6 - t), y[1] + y[3] * (0.6 - t), y[2], y[3]]
            break
        low, high = late - 1e-3, late
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if above(middle) > 0 else (low, middle)
        y = [y[0] + y[2] * (low - t), y[1] + y[3] * (low - t), y[2], y[3]]
        t = low
        events.append(("land", t))
        # the impulse across the floor, and Coulomb's along it: no more than what stops the slip
        normal = 0.5 * abs(speed - g * (t - begin) - math.cos(20 * t))
        along = -math.copysign(min(mu * normal, abs(y[3]) / (1 / 0.5 + 1 / 2.0)), y[3])
        y = [y[0], y[1], y[2] - along / 2.0, y[3] + along / 0.5 + along / 2.0]
    assert [e.kind for e in run.events] == [kind for kind, _ in events] and len(events) > 3
    assert max(abs(e.time - t) for e, (_, t) in zip(run.events, events, strict=True)) < 1e-11
    assert abs(run[cart].displacement(0.6) - y[0]) < 1e-11
    assert abs(run[bead].position(0.6)[0] - y[0] - y[1]) < 1e-11


def test_what_is_not_there_is_refused_by_name():
    rail = rb.Rail(dome, side="+", up=[0, 0, 1])
    scene, cart, _ = cart_with(rail, parameter=0.1)
    scene.contact(cart.sphere(0.1), rb.Plane([0, 0, 1], point=[0, 0, -5]))
    with pytest.raises(rb.InvalidInput, match="bead: a rail that it may leave, beside contacts"):
        rb.simulate(scene, until=1.0)
    scene, cart, _ = cart_with(rail, parameter=0.1)
    scene.constrain(rb.PointOnPlane(rb.Plane([0, 0, 1])), cart)
    with pytest.raises(rb.InvalidInput, match="bead: a rail that it may leave, beside constraints"):
        rb.simulate(scene, until=1.0)
    scene, _, _ = cart_with(rb.Rail(hills, side="+", up=[0, 0, 1]), parameter=0.1)
    with pytest.raises(rb.InvalidInput, match="lines, circles and parabolas"):
        rb.simulate(scene, until=1.0)
    scene, cart, _ = cart_with(rail, parameter=0.1)
    scene.constrain(rb.PointOnPlane(rb.Plane([0, 0, 1])), cart)
    with pytest.raises(rb.InvalidInput, match="beside constraints, of which states of rest are not"):
        rb.equilibria(scene)


@pytest.mark.parametrize("side", ["+", "-"])
def test_a_bead_rests_where_its_rail_on_a_body_pushes_it(side):
    """A cart held by a spring carries a bowl z = a x^2; a steady force pulls the bead aside: 2 a x = F/(m g), and the
    spring gives way by F/k. A rail that could only push downwards would have to pull."""
    a, m, k, pull = 0.7, 0.4, 30.0, 1.5
    scene = rb.Scene(gravity=[0, 0, -g])
    cart = scene.add(rb.shapes.sphere(2.0, 0.1), rb.Prismatic([1, 0, 0]), displacement=0.2)
    rail = rb.Rail(rb.Parabola(a, [1, 0, 0], [0, 0, 1]), side=side, up=[0, 0, 1])
    bead = scene.add(rb.Particle(m), rail, parent=cart, parameter=0.1)
    scene.connect(rb.Spring(k), cart, [0, 0, 0])
    scene.apply(rb.Force([pull, 0, 0]), bead)
    found = rb.equilibria(scene)
    if side == "-":
        assert found == []
        return
    (rest,) = found
    assert rest.stable
    assert np.allclose(rest.coordinates, [pull / k, pull / (2 * a * m * g)], rtol=0, atol=1e-15)
    modes = rb.normal_modes(scene, rest)
    # small motion in (d, u): the bead goes along (1, 0, s), s = 2 a u; curvature 2 a of the bowl under its weight
    s = pull / (m * g)
    mass = np.array([[2.0 + m, m], [m, m * (1 + s * s)]])
    stiffness = np.array([[k, 0.0], [0.0, 2 * a * m * g]])
    assert np.allclose(modes.squares, np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real), rtol=1e-12)


def test_a_bead_beside_joined_bodies_rests_as_it_does_alone():
    """On a dome, an unstable top; thrown by a field, a place aside: the same with and without a tree beside it."""
    for side, field in (("+", 0.0), ("-", 0.0), ("+", 3.0)):
        rests = []
        for joined in (False, True):
            scene = rb.Scene(gravity=[0, 0, -g])
            bead = scene.add(rb.Particle(0.5), rb.Rail(dome, side=side, up=[0, 0, 1]), parameter=0.2)
            scene.apply(rb.Force([field, 0, 0]), bead)
            if joined:
                rod = scene.add(rb.shapes.rod(1.0, 1.0, [0, 0, 1]), rb.Revolute([0, 1, 0], at=[5, 0, 0]), angle=0.1)
                scene.add(rb.shapes.rod(1.0, 1.0, [0, 0, 1]), rb.Revolute([0, 1, 0]), parent=rod, angle=0.2)
            rests.append(rb.equilibria(scene, near=[0.2, 0.1, 0.2] if joined else None))
        alone, beside = rests
        # inside the dome there is the bottom alone
        angles = [math.remainder(e.coordinates[0] - 0.2, 2 * math.pi) for e in alone]
        assert len(beside) == 1 and (min(angles, key=abs) > 1.5) == (side == "-")
        away = math.remainder(beside[0].coordinates[0] - 0.2 - min(angles, key=abs), 2 * math.pi)
        assert abs(away) < 1e-14
