"""States of rest whose second derivatives vanish in some direction, against what the potential itself says of them."""

import math
from decimal import Decimal, getcontext
from fractions import Fraction

import numpy as np
import pytest
import rbdyn as rb

INERTIA = [0.1, 0.1, 0.1]


def free_particle(potential, x, y):
    scene = rb.Scene()
    point = scene.add(rb.Particle(1.0), position=[x, y, 0.0])
    scene.apply(rb.Potential(lambda r: -(potential(r[0], r[1]) + 0.5 * r[2] ** 2)), point)
    return scene


def slide_on_slide(potential, x, y):
    scene = rb.Scene()
    one = scene.add(rb.RigidBody(1.0, INERTIA), rb.Prismatic([1, 0, 0]), displacement=x)
    two = scene.add(rb.RigidBody(1.0, INERTIA), rb.Prismatic([0, 1, 0]), parent=one, displacement=y)
    scene.apply(rb.Potential(lambda r: -potential(r[0], r[1])), two)
    return scene


def bead_on_cart(potential, x, y):
    scene = rb.Scene()
    cart = scene.add(rb.RigidBody(1.0, INERTIA), rb.Prismatic([1, 0, 0]), displacement=x)
    bead = scene.add(rb.Particle(1.0), rb.Rail(rb.Line([0, 1, 0])), parent=cart, parameter=y)
    scene.apply(rb.Potential(lambda r: -potential(r[0], r[1])), bead)
    return scene


def planar_body(potential, x, y):
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, INERTIA), rb.Planar([1, 0, 0], [0, 1, 0]), position=[x, y], angle=0.1)
    scene.apply(rb.Potential(lambda r: -potential(r[0], r[1])), body)
    scene.apply(rb.JointTorque(lambda t, angle, rate: -angle), body)
    return scene


KINDS = [free_particle, slide_on_slide, bead_on_cart, planar_body]

# whether the origin is a strict minimum; with one flat direction the square is completed by hand:
# x^2 + x y^2 + c y^4 = (x + y^2/2)^2 + (c - 1/4) y^4, cos x + x^2/2 - 1 - x^4/24 = -x^6/720 + ...
ONE_FLAT = {
    "x2+y3": (lambda x, y: x**2 + y**3, False),
    "x2+y4": (lambda x, y: x**2 + y**4, True),
    "x2-y6": (lambda x, y: x**2 - y**6, False),
    "x2+y8": (lambda x, y: x**2 + y**8, True),
    "banana": (lambda x, y: (y - x**2) ** 2 + x**8, True),
    "saddle": (lambda x, y: (y - x**2) ** 2 - x**6, False),
    "Peano": (lambda x, y: (y - x**2) * (y - 3 * x**2), False),
    "0.251": (lambda x, y: x**2 + x * y**2 + 0.251 * y**4, True),
    "0.249": (lambda x, y: x**2 + x * y**2 + 0.249 * y**4, False),
    "cosine": (lambda x, y: np.cos(x) + x**2 / 2 + y**2 - 1 - x**4 / 24, False),
    "weak": (lambda x, y: y**2 - 1e-18 * x**2, False),
}
# more than one flat direction, or no power: what is not proven has to say so
OTHERS = {
    "x4+y4": (lambda x, y: x**4 + y**4, True),
    "x4+y4-3x2y2": (lambda x, y: x**4 + y**4 - 3 * x**2 * y**2, False),
    "monkey": (lambda x, y: x**3 - 3 * x * y**2, False),
    "2.5": (lambda x, y: y**2 + abs(x) ** 2.5, True),
    "-2.5": (lambda x, y: y**2 - abs(x) ** 2.5, False),
    "one side": (lambda x, y: y**2 + np.where(x > 0, x**2, -(x**4)), False),
    "half flat": (lambda x, y: y**2 + np.where(x > 0, x**4, 0 * x), False),
    "infinitely flat": (lambda x, y: y**2 + np.where(abs(x) > 0, np.exp(-1 / (x * x + 1e-300)), 0 * x), True),
}


def rests(kind, potential):
    """From the origin itself, from beside it, and from there with `near`."""
    scene = kind(potential, 0.2, 0.1)
    count = len(rb.equilibria(kind(potential, 0.0, 0.0))[0].coordinates)
    yield rb.equilibria(kind(potential, 0.0, 0.0))
    yield rb.equilibria(scene)
    yield rb.equilibria(scene, near=[0.0] * count)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ONE_FLAT)
def test_along_one_flat_direction_the_first_power_decides(kind, name):
    potential, stable = ONE_FLAT[name]
    first, beside, near = rests(kind, potential)
    for (state,) in first, near:
        assert np.abs(state.coordinates).max() < 1e-12
        assert state.decided and state.stable == stable
    for state in beside:  # downhill leads elsewhere, or nowhere, where the origin is no minimum
        if np.abs(state.coordinates[:2]).max() < 1e-3:
            assert not state.decided or state.stable == stable
            assert len(rb.normal_modes(kind(potential, 0.0, 0.0), at=state).squares) == len(first[0].coordinates)
    if stable:
        assert len(beside) == 1 and np.abs(beside[0].coordinates).max() < 1e-3  # x^8 is rounding there


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", OTHERS)
def test_what_is_not_proven_is_not_decided(kind, name):
    potential, stable = OTHERS[name]
    for states in rests(kind, potential):
        for state in states:
            if np.abs(state.coordinates[:2]).max() < 1e-3:
                assert not state.decided or state.stable == stable


def test_what_goes_down_on_one_way_is_not_stable_however_many_are_flat():
    for name in "x4+y4-3x2y2", "monkey":
        (state,) = rb.equilibria(free_particle(OTHERS[name][0], 0.0, 0.0))
        assert state.decided and not state.stable


def test_beads_under_a_square_and_a_cube_rest_at_a_place_that_is_not_stable():
    scene = rb.Scene()
    one = scene.add(rb.Particle(1.0), rb.Rail(rb.Line([1, 0, 0])), parameter=0.2)
    two = scene.add(rb.Particle(1.0), rb.Rail(rb.Line([0, 1, 0])), parameter=0.1)
    scene.apply(rb.Potential(lambda r: -(r[0] ** 2)), one)
    scene.apply(rb.Potential(lambda r: -(r[1] ** 3)), two)
    (state,) = rb.equilibria(scene)
    assert state.decided and not state.stable
    assert state.coordinates.tolist() == [0.0, 0.0]


@pytest.mark.parametrize("start", [0.0, 0.1])
def test_columns_at_their_critical_load_rest_upright(start):
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    rod = rb.shapes.rod(1.0, 1.0, along=[0, 0, 1]).shifted([0, 0, 0.5])
    for k in range(2):
        hinge = scene.add(rod, rb.Revolute([0, 1, 0], at=[3.0 * k, 0, 0]), angle=start)
        scene.apply(rb.TorsionSpring(9.8125 / 2), hinge)
    (state,) = rb.equilibria(scene)
    assert not state.decided
    assert np.abs(state.coordinates).max() < 1e-12


def test_a_column_at_its_critical_load_beside_another_body_is_stable():
    # k psi - (m g l/2) sin psi = k psi^3/6 - ...
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    rod = rb.shapes.rod(1.0, 1.0, along=[0, 0, 1]).shifted([0, 0, 0.5])
    hinge = scene.add(rod, rb.Revolute([0, 1, 0]), angle=0.1)
    scene.apply(rb.TorsionSpring(9.8125 / 2), hinge)
    scene.add(rod, rb.Revolute([0, 1, 0], at=[3, 0, 0]), angle=3.0)
    (state,) = rb.equilibria(scene)
    assert state.decided and state.stable
    assert state.coordinates == pytest.approx([0.0, math.pi], abs=1e-12)


@pytest.mark.parametrize("start", [0.0, 0.1])
def test_a_particle_between_slack_springs_is_at_its_rest(start):
    scene = rb.Scene()
    point = scene.add(rb.Particle(1.0), position=[start, start, 0.0])
    for x in (-1.0, 1.0):
        scene.connect(rb.Spring(5.0, rest_length=1.0), point, [x, 0, 0])
    (state,) = rb.equilibria(scene)
    assert np.abs(state.coordinates).max() < 1e-10
    assert not state.decided or state.stable


def sine_and_cosine(x):
    sine, cosine, term = Decimal(0), Decimal(0), Decimal(1)
    for k in range(60):
        if k % 2:
            sine += term if k % 4 == 1 else -term
        else:
            cosine += term if k % 4 == 0 else -term
        term = term * x / (k + 1)
    return sine, cosine


def slow_square(stiffness):
    """Of a pendulum that carries a slide on a spring, pulled by 1 N, in 60 digits: U of (psi, x) by hand."""
    getcontext().prec = 60
    g, k, psi = Decimal(9.81), Decimal(stiffness), Decimal("-0.0678535390968")
    x = Decimal("-9.8552") / k
    for _ in range(8):
        s, c = sine_and_cosine(psi)
        slope = [g * s / 2 - g * (x - 1) * s - (x - 1) * c, g * c - s + k * x]
        a, b = g * c / 2 - g * (x - 1) * c + (x - 1) * s, -g * s - c
        det = a * k - b * b
        psi, x = psi - (k * slope[0] - b * slope[1]) / det, x - (a * slope[1] - b * slope[0]) / det
    inertia = Decimal(0.1) + Decimal("0.25") + Decimal(0.1) + (1 - x) ** 2
    trace, product = a / inertia + k, det / inertia
    return product / ((trace + (trace * trace - 4 * product).sqrt()) / 2)


@pytest.mark.parametrize("stiffness", [1e4, 1e8, 1e12, 1e14, 1e15, 1e17])
def test_a_slow_mode_beside_a_stiff_one_is_known(stiffness):
    scene = rb.Scene(gravity=[0, 0, -9.81])
    bob = scene.add(rb.RigidBody(1.0, INERTIA, com=[0, 0, -0.5]), rb.Revolute([0, 1, 0]), angle=0.2)
    slide = scene.add(rb.RigidBody(1.0, INERTIA), rb.Prismatic([0, 0, 1], at=[0, 0, -1]), parent=bob)
    scene.connect(rb.Spring(stiffness), slide, bob.point([0, 0, -1.0]))
    scene.apply(rb.Force([1.0, 0, 0]), slide)
    (state,) = rb.equilibria(scene)
    if stiffness > 1e15:  # less than rounding of the place of the spring's ends makes of its force
        assert not state.decided
        return
    truth = slow_square(stiffness)
    assert state.stable and state.decided
    assert rb.normal_modes(scene, at=state).squares[0] == pytest.approx(float(truth), rel=1e-15)
    assert state.periods[0] == pytest.approx(2 * math.pi / math.sqrt(float(truth)), rel=1e-15)


@pytest.mark.parametrize("ratio", [1e2, 1e4, 1e8, 1e14, 1e18])
def test_periods_of_beads_keep_their_digits_beside_stiff_springs(ratio):
    scene = rb.Scene()
    rail = rb.Rail(rb.Line([1, 0, 0]))
    one, two = (scene.add(rb.Particle(1.0), rail) for _ in range(2))
    scene.connect(rb.Spring(1.0), one, [0, 0, 0])
    scene.connect(rb.Spring(ratio), one, two)
    getcontext().prec = 60
    k = Decimal(ratio)
    square = 2 * k / (1 + 2 * k + (1 + 4 * k * k).sqrt())
    (state,) = rb.equilibria(scene)
    assert state.stable and state.decided
    assert state.periods[0] == pytest.approx(
        2 * math.pi / math.sqrt(float(square)), rel=1e-15 if ratio < 1e16 else 1e-13
    )


@pytest.mark.parametrize("fibre", [1e-6, 1e-7, 1e-8])
def test_a_torsion_balance_in_a_stiff_holder_is_found(fibre):
    scene = rb.Scene(gravity=[0, 0, -9.81])
    holder = scene.add(rb.RigidBody(0.05, [1e-4] * 3), rb.Prismatic([0, 0, 1]))
    scene.connect(rb.Spring(1e9), holder, [0, 0, 0.0])
    arm = scene.add(rb.RigidBody(0.05, [5e-4, 1e-3, 1e-3]), rb.Revolute([0, 0, 1]), parent=holder, angle=0.3)
    scene.apply(rb.TorsionSpring(fibre, rest_angle=0.2), arm)
    (state,) = rb.equilibria(scene)
    assert state.stable and state.decided
    assert state.coordinates == pytest.approx([-0.1 * 9.81 / 1e9, 0.2], rel=1e-14)


def turned_valley(floor, power, seed, unit=1.0):
    """(x - 1.5 y^2)^2 + floor y^power in axes turned and moved, in units of a length, and where its rest is."""
    random = np.random.default_rng(seed)
    angle, place = random.normal(), random.normal(size=2) * unit
    cosine, sine = math.cos(angle), math.sin(angle)

    def potential(r):
        x, y = (r[0] - place[0]) / unit, (r[1] - place[1]) / unit
        x, y = cosine * x + sine * y, cosine * y - sine * x
        return (x - 1.5 * y**2) ** 2 + floor * y**power + 0.5 * (r[2] / unit) ** 2

    scene = rb.Scene()
    scene.apply(rb.Potential(lambda r: -potential(r)), scene.add(rb.Particle(1.0)))
    return scene, place


@pytest.mark.parametrize("beside", [0.0, 1e-9, 1e-6, 1e-3, 1e-2])
@pytest.mark.parametrize("floor", [-1.0, -0.05, 0.05])
def test_what_a_valley_does_does_not_depend_on_where_its_rest_is_searched_from(floor, beside):
    for seed in range(4):
        scene, place = turned_valley(floor, 4, seed)
        (state,) = rb.equilibria(scene, near=[*(place + beside), 0.0])
        assert state.coordinates[:2] == pytest.approx(place, rel=1e-15)
        assert state.decided and state.stable == (floor > 0.0)


@pytest.mark.parametrize("unit", [1e-3, 1e5])
@pytest.mark.parametrize(("floor", "power"), [(1.0, 6), (-1.0, 6), (1.0, 5)])
def test_valleys_of_any_size_are_the_same(floor, power, unit):
    for seed in range(4):
        scene, place = turned_valley(floor, power, seed, unit)
        (state,) = rb.equilibria(scene, near=[*(place + 1e-3 * unit), 0.0])
        assert state.coordinates[:2] == pytest.approx(place, rel=1e-15)
        assert state.decided and state.stable == (floor > 0.0 and power % 2 == 0)


@pytest.mark.parametrize("beside", [0.0, 1e-9, 1e-6, 1e-4, 1e-2])
@pytest.mark.parametrize("fourth", [-4.0, 4.0])
def test_an_arm_on_a_cart_at_its_critical_load_is_at_rest_upright(fourth, beside):
    # m g L (cos q + q^2/2) + a q^4/4 with m g L = 9.8125
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    cart = scene.add(rb.RigidBody(1.0, INERTIA), rb.Prismatic([1, 0, 0]))
    arm = scene.add(rb.RigidBody(1.0, [0.01] * 3, com=[0, 0, 1.0]), rb.Revolute([0, 1, 0]), parent=cart)
    scene.apply(rb.Potential(lambda r: -15.0 * r[0] ** 2), arm, at=[0, 0, 1.0])
    scene.apply(rb.JointTorque(lambda t, q, w: -9.8125 * q - fourth * q**3), arm)
    (state,) = rb.equilibria(scene, near=[beside, 1.1 * beside])
    assert np.abs(state.coordinates).max() < 1e-15
    assert state.decided and state.stable == (fourth > 0.0)


# strict minima, saddles and others of one rest, in axes turned by an angle; the powers of y and x^2 by hand
ONE_REST = {
    "banana of 8": (lambda x, y: (y - x**2) ** 2 + x**8, 0.0, True),
    "banana of 6": (lambda x, y: (y - x**2) ** 2 + x**6, 0.7, True),
    "saddle of 6": (lambda x, y: (y - x**2) ** 2 - x**6, 0.7, False),
    "sixth": (lambda x, y: y**2 + x**6, 0.7, True),
    "fourth": (lambda x, y: y**2 + x**4, 0.7, True),
    "fifth": (lambda x, y: y**2 + x**5, 0.7, False),
}


def in_unit(name, unit, start=(0.0, 0.0)):
    """Mass and time in 1, lengths in `unit`: V unit^2 of (x, y)/unit."""
    potential, angle, _ = ONE_REST[name]
    c, s = math.cos(angle), math.sin(angle)

    def field(r):
        x, y = r[0] / unit, r[1] / unit
        return -(unit**2) * (potential(c * x + s * y, c * y - s * x) + 0.5 * (r[2] / unit) ** 2)

    scene = rb.Scene()
    point = scene.add(rb.Particle(1.0), position=[start[0] * unit, start[1] * unit, 0.0])
    scene.apply(rb.Potential(field), point)
    return scene


@pytest.mark.parametrize("unit", [1e-20, 1e-12, 1e-6, 1e-3, 1.0, 1e3, 1e4, 1e6, 1e9, 1e14, 1e20])
@pytest.mark.parametrize("name", ONE_REST)
def test_what_is_stable_is_so_in_any_unit_of_length(name, unit):
    (state,) = rb.equilibria(in_unit(name, unit), near=[0, 0, 0])
    assert np.abs(state.coordinates).max() < 1e-12 * unit
    assert state.decided and state.stable == ONE_REST[name][2]
    for near in (0.1, 0.1), (-0.2, 0.3), (1e-3, 1e-3), (1e-7, -1e-8):
        for state in rb.equilibria(in_unit(name, unit), near=[near[0] * unit, near[1] * unit, 0.0]):
            assert np.abs(state.coordinates).max() < 1e-2 * unit
            assert not state.decided or state.stable == ONE_REST[name][2]


@pytest.mark.parametrize("unit", [1e-9, 1e9])
@pytest.mark.parametrize("turned", [0.0, 0.7])
def test_what_runs_away_in_a_valley_rests_nowhere_else(turned, unit):
    # (y - x^2)^2 - x^6 has one rest; the forces there, in exact fractions of what doubles are
    c, s = math.cos(turned), math.sin(turned)
    random = np.random.default_rng(3)
    starts = [(0.1, 0.1), (-0.2, 0.3), (0.05, 0.05), *random.normal(size=(5, 2))]
    for start in starts:
        scene = rb.Scene()
        point = scene.add(rb.Particle(1.0), position=[start[0] * unit, start[1] * unit, 0.0])

        def field(r):
            x, y = (c * r[0] + s * r[1]) / unit, (c * r[1] - s * r[0]) / unit
            return -((y - x**2) ** 2 - x**6 + 0.5 * (r[2] / unit) ** 2)

        scene.apply(rb.Potential(field), point)
        for near in None, [start[0] * unit, start[1] * unit, 0.0]:
            for state in rb.equilibria(scene, near=near) if near else rb.equilibria(scene):
                p, q = (Fraction(float(z)) / Fraction(unit) for z in state.coordinates[:2])
                x, y = Fraction(c) * p + Fraction(s) * q, Fraction(c) * q - Fraction(s) * p
                along, across = 4 * x * (y - x**2) + 6 * x**5, 2 * (y - x**2)
                assert abs(along) < 1e-12 and abs(across) < 1e-12
                assert not state.stable


@pytest.mark.parametrize("place", [0.0, 1.0, 1e3])
def test_rests_that_are_flat_all_around_are_kept_where_they_are_met(place):
    scene = rb.Scene()
    point = scene.add(rb.Particle(1.0), position=[place + 0.3, place - 0.2, 0.0])
    scene.apply(rb.Potential(lambda r: -((r[0] - place) ** 4 + (r[1] - place) ** 4 + r[2] ** 4)), point)
    for near in None, [place, place, 0.0]:
        (state,) = rb.equilibria(scene, near=near) if near else rb.equilibria(scene)
        assert state.coordinates[:2] == pytest.approx([place, place], abs=1e-4)
        assert not state.decided or state.stable
