"""Equilibria and potentials along rails, from Python."""

import math

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

CIRCLE = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0])
ROD = rb.shapes.rod(1.0, 1.0, along=[0, 0, 1])


def hoop(**rail):
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    bead = scene.add(rb.Particle(mass=0.7), rb.Rail(CIRCLE, **rail))
    return scene, bead


def test_a_pendulum_has_two_equilibria():
    scene, _ = hoop()
    below, above = rb.equilibria(scene)
    assert below.coordinates.tolist() == [0.0]
    assert below.stable and not above.stable
    assert below.interval is None
    assert below.periods == pytest.approx([2 * math.pi * math.sqrt(0.5 / 9.8125)], rel=1e-15)
    assert above.coordinates[0] == math.pi
    assert len(above.periods) == 0
    assert repr(above) == "Equilibrium(coordinates=(3.141592653589793,), stable=False, interval=None, periods=())"
    assert str(above) == "Equilibrium at 3.141592653589793, not stable"
    assert below == rb.equilibria(scene, near=1.0)[0] and below != above
    assert len({below, above}) == 2


def test_friction_makes_them_intervals():
    scene, _ = hoop(friction=rb.Coulomb(mu_static=0.4))
    below, above = rb.equilibria(scene)
    assert below.interval == pytest.approx((-math.atan(0.4), math.atan(0.4)), abs=1e-15)
    assert above.stable


def test_several_freedoms_are_searched_from_near():
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    a = scene.add(rb.Particle(mass=2.0), rb.Free(), position=[0.3, 0.1, -1.0])
    scene.connect(rb.Spring(stiffness=50.0, rest_length=1.0), a, [0, 0, 0])
    sag = 2.0 * 9.8125 / 50.0
    (below,) = rb.equilibria(scene)
    assert below.coordinates == pytest.approx([0, 0, -1 - sag], abs=1e-15)
    (above,) = rb.equilibria(scene, near=[0.01, 0.02, 0.7])
    assert above.coordinates == pytest.approx([0, 0, 1 - sag], abs=1e-15)
    assert not above.stable
    with pytest.raises(rb.InvalidInput, match="number of coordinates in near is 2"):
        rb.equilibria(scene, near=[1, 2])
    with pytest.raises(rb.InvalidInput, match="near has shape"):
        rb.equilibria(scene, near=[[1, 2]])


def test_the_potential_of_a_pendulum():
    scene, bead = hoop()
    u = np.linspace(-3.0, 3.0, 7)
    potential = rb.rail_potential(scene, bead)
    assert potential.value(u) == pytest.approx(-0.7 * 9.8125 * 0.5 * (1 - np.cos(u)), abs=1e-15)
    assert potential.tangential_force(u) == pytest.approx(-0.7 * 9.8125 * np.sin(u), abs=1e-15)
    assert isinstance(potential.value(0.3), float)
    assert potential.energy(u, 2.0) == pytest.approx(0.35 * 4.0 - potential.value(u))
    assert potential.energy(0.0, [1.0, 2.0]) == pytest.approx([0.35, 1.4])
    energy = potential.energy(1.0)
    below, above = potential.turning_points(energy, start=0.2)
    assert (below, above) == pytest.approx((-1.0, 1.0), rel=1e-15)
    assert potential.time(energy, below, above) == pytest.approx(0.5 * potential.period(energy, 0.2), rel=1e-15)
    assert potential.speed(1.0, energy) == 0.0
    assert repr(potential) == "<RailPotential: potential of bead 1 along its circle of radius 0.5>"
    round_ = potential.turning_points(potential.energy(0.0, 7.0), 0.0)
    assert round_.below is None and round_.above is None
    assert repr(round_) == "TurningPoints(below=None, above=None)"


@pytest.mark.skipif(np.finfo(np.longdouble).eps > 1e-18, reason="long double is double here")
def test_turning_points_are_known_to_two_units_in_the_last_place():
    """cos u = 1 - 2 E / (m g R), beside what the rounding of E makes of it, E cot u / 2 in units of u."""
    real, random = np.longdouble, np.random.default_rng(1)
    scene, bead = hoop()
    potential = rb.rail_potential(scene, bead)
    for start in random.uniform(0.05, 3.1, 60):
        energy = potential.energy(start)
        known = np.arccos(1 - real(energy) / (real(0.7) * real(9.8125) * real(0.5)))
        found = potential.turning_points(energy, start=0.0)
        for angle in (-found.below, found.above):
            assert abs((angle - known) / known) < 4.4e-16 * (1 + abs(1 / np.tan(known)))


def test_a_force_of_position_conserves_energy_along_its_rail():
    scene = rb.Scene()
    bead = scene.add(rb.Particle(mass=0.5), rb.Rail(CIRCLE), parameter=0.4, speed=0.3)
    scene.apply(rb.Force(lambda t, r, v: [-0.75 * r[2] ** 2, 0.0, 0.75 * r[0] * r[2]]), bead)
    assert rb.plan(scene).integrals == ["energy"]
    run = rb.simulate(scene, until=20.0, error=1e-12)
    assert run.drift["energy"] < 1e-13
    potential = rb.rail_potential(scene, bead)
    u = np.array([-3.0, 0.4, 2.0])
    assert potential.work_of_forces(u) == pytest.approx(-0.75 * 0.125 * np.sin(u), abs=1e-15)
    assert run.energy(3.0) == pytest.approx(potential.energy(0.4, 0.3), abs=1e-14)


def test_what_has_no_potential_says_why():
    scene, bead = hoop()
    scene.apply(rb.Drag(linear=0.1), bead)
    with pytest.raises(rb.InvalidInput, match="drag acts on bead 1"):
        rb.rail_potential(scene, bead)
    other, _ = hoop()
    with pytest.raises(rb.InvalidInput, match="another scene"):
        rb.rail_potential(other, bead)
    timed, bead = hoop()
    timed.apply(rb.Force(lambda t, r, v: [np.sin(t), 0, 0]), bead)
    with pytest.raises(rb.InvalidInput, match="depends on time"):
        rb.equilibria(timed)


BOB = rb.RigidBody(2.0, [0.7, 0.9, 0.4], com=[0, 0, -0.5], inertia_about="origin")
MOMENT = 2.0 * 9.8125 * 0.5  # m g d


def body_on(joint, body=BOB, **start):
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    return scene, scene.add(body, joint, **start)


def test_a_compound_pendulum_swings_with_the_period_of_its_equilibrium():
    scene, bob = body_on(rb.Revolute([0, 1, 0]), angle=1e-4)
    below, above = rb.equilibria(scene)
    assert (below.coordinates[0], above.coordinates[0]) == (0.0, math.pi)
    assert below.stable and not above.stable and below.axes.shape == (0, 3)
    assert below.periods == pytest.approx([2 * math.pi * math.sqrt(0.9 / MOMENT)], rel=1e-15)
    run = rb.simulate(scene, until=below.periods[0], error=1e-12)
    assert run[bob].angle(run.end) == pytest.approx(1e-4, abs=1e-12)


@pytest.mark.parametrize("tilt", [0.05, 0.7])
def test_a_door_on_a_tilted_axis_rests_where_it_hangs_lowest(tilt):
    door = rb.shapes.box(20.0, [0.8, 0.04, 2.0]).shifted([0.4, 0, 0])
    axis = np.array([0, math.sin(tilt), math.cos(tilt)])
    scene, _ = body_on(rb.Revolute(axis), door)
    above, below = sorted(rb.equilibria(scene), key=lambda e: e.stable)
    assert below.stable and not above.stable
    # the lowest way across an axis that leans towards y is y itself
    assert below.coordinates[0] == pytest.approx(math.pi / 2, abs=1e-14)
    assert above.coordinates[0] == pytest.approx(-math.pi / 2, abs=1e-14)
    stiffness = 20.0 * 9.8125 * 0.4 * math.sin(tilt)
    about = axis @ door.inertia("origin") @ axis
    assert below.periods[0] == pytest.approx(2 * math.pi * math.sqrt(about / stiffness), rel=1e-13)


def test_of_a_pendulum_on_a_soft_torsion_spring_every_equilibrium_is_found():
    for share in (0.3, 0.02):
        scene, bob = body_on(rb.Revolute([0, 1, 0]))
        scene.apply(rb.TorsionSpring(stiffness=share * MOMENT, rest_angle=0.5), bob)
        found = rb.equilibria(scene)
        psi = np.linspace(0.5 - 1.1 / share, 0.5 + 1.1 / share, 200001)
        torque = -share * (psi - 0.5) - np.sin(psi)
        assert len(found) == np.count_nonzero(np.diff(np.sign(torque)))
        places = np.array([e.coordinates[0] for e in found])
        assert np.abs(share * (places - 0.5) + np.sin(places)).max() < 1e-14 / share
        assert [e.stable for e in found] == [k % 2 == 0 for k in range(len(found))]


def zeros(moment, low, high):
    """All zeros of a function whose changes of sign are no nearer to each other than 1e-5."""
    x = np.linspace(low, high, round((high - low) / 1e-5)) + 1e-7
    sides = np.sign(moment(x))
    return [brentq(moment, x[k], x[k + 1], xtol=1e-15) for k in np.nonzero(np.diff(sides))[0]]


RIPPLES = [(k, a, p) for k in (1, 8, 13, 20, 27, 33, 40, 60) for a, p in ((0.4, 0.2), (1.1, 3.08), (2.6, 5.0))]


@pytest.mark.parametrize(("wave", "size", "phase"), RIPPLES)
@pytest.mark.parametrize("carries", [False, True])
def test_every_rest_among_the_ripples_of_a_torque_is_found(wave, size, phase, carries):
    scene, hinge = body_on(rb.Revolute([0, 1, 0], point=[0, 0, 0.5]), body=ROD)
    scene.apply(rb.JointTorque(lambda t, q, rate: size * np.sin(wave * q + phase)), hinge)
    weight, inertia = 0.5 * 9.8125, 1.0 / 3
    if carries:
        # a ball at its foot
        ball = rb.RigidBody(0.5, [0.25, 0.25, 0.25])
        scene.add(ball, rb.Fixed(at=[0, 0, -0.5]), parent=hinge)
        weight, inertia = weight + 0.5 * 9.8125, inertia + 0.25 + 0.5

    def moment(q):
        return -weight * np.sin(q) + size * np.sin(wave * q + phase)

    states = rb.equilibria(scene)
    found = np.array([state.coordinates[0] for state in states])
    assert ((-math.pi < found) & (found <= math.pi + 1e-15)).all()
    assert found == pytest.approx(zeros(moment, -math.pi, math.pi), abs=1e-12)
    for state, q in zip(states, found, strict=True):
        slope = -weight * math.cos(q) + size * wave * math.cos(wave * q + phase)
        assert state.decided and state.stable == (slope < 0)
        if state.stable:
            assert state.periods == pytest.approx([2 * math.pi * math.sqrt(-inertia / slope)], rel=1e-11)


def test_a_torque_that_counts_turns_is_searched_on_both_sides():
    scene, hinge = body_on(rb.Revolute([0, 1, 0], point=[0, 0, 0.5]), body=ROD)
    scene.apply(rb.JointTorque(lambda t, q, rate: -0.3 * q), hinge)
    wound = rb.Scene(gravity=[0, 0, -9.8125])
    wound.apply(rb.TorsionSpring(0.3), wound.add(ROD, rb.Revolute([0, 1, 0], point=[0, 0, 0.5])))
    known = [state.coordinates[0] for state in rb.equilibria(wound)]
    assert len(known) > 5
    assert [state.coordinates[0] for state in rb.equilibria(scene)] == pytest.approx(known, abs=1e-13)
    # half turns at a time: the same after two
    slow, hinge = body_on(rb.Revolute([0, 1, 0], point=[0, 0, 0.5]), body=ROD)
    slow.apply(rb.JointTorque(lambda t, q, rate: 2.0 * np.sin(0.5 * q + 0.1)), hinge)
    found = np.array([state.coordinates[0] for state in rb.equilibria(slow)])
    known = zeros(lambda q: -0.5 * 9.8125 * np.sin(q) + 2.0 * np.sin(0.5 * q + 0.1), -4 * math.pi, 4 * math.pi)
    assert found[abs(found) < 4 * math.pi] == pytest.approx(known, abs=1e-12)


def test_a_slide_beside_what_is_fixed_finds_all_its_rests():
    scene = rb.Scene()
    post = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Fixed(at=[1, 0, 0]))
    car = scene.add(rb.RigidBody(2.0, [1, 1, 1]), rb.Prismatic([1, 0, 0]), parent=post)
    scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Fixed(), parent=car)
    scene.apply(rb.JointForce(lambda t, q, rate: np.sin(25 * q) - 2.0 * q), car)
    states = rb.equilibria(scene)
    known = zeros(lambda q: np.sin(25 * q) - 2.0 * q, -0.6, 0.6)
    assert [state.coordinates[0] for state in states] == pytest.approx(known, abs=1e-13)
    for state in states:
        slope = 25 * math.cos(25 * state.coordinates[0]) - 2.0
        assert state.stable == (slope < 0)
        if state.stable:
            assert state.periods == pytest.approx([2 * math.pi * math.sqrt(-3.0 / slope)], rel=1e-12)


def test_a_wheel_in_balance_is_indifferent():
    scene, _ = body_on(rb.Revolute([0, 0, 1]), angle=0.25)
    (state,) = rb.equilibria(scene)
    assert not state.stable and state.coordinates.tolist() == [0.25]
    assert state.interval == (0.25 - math.pi, 0.25 + math.pi)


def test_a_slide_sinks_into_its_spring():
    scene, body = body_on(rb.Prismatic([0, 0, 1]))
    scene.connect(rb.Spring(stiffness=50.0), body, [0, 0, 0])
    (state,) = rb.equilibria(scene)
    assert state.coordinates[0] == pytest.approx(0.5 - 2.0 * 9.8125 / 50.0, abs=1e-15)
    assert state.periods == pytest.approx([2 * math.pi * math.sqrt(2.0 / 50.0)], rel=1e-14)


def test_a_heavy_body_on_a_ball_joint_hangs_or_stands_and_a_start_there_stays():
    scene, _ = body_on(rb.Spherical(), attitude=rb.EulerAngles(2.0, 0.5, 1.0))
    below, above = rb.equilibria(scene)
    assert below.stable and not above.stable
    assert below.periods == pytest.approx(2 * math.pi * np.sqrt(np.array([0.9, 0.7]) / MOMENT), rel=1e-14)
    for state, height in (below, -0.5), (above, 0.5):
        assert state.axes == pytest.approx(np.array([[0, 0, 1]]), abs=1e-14)
        there, bob = body_on(rb.Spherical(), attitude=state.coordinates)
        run = rb.simulate(there, until=0.5)
        assert run[bob].center_of_mass(0.5)[2] == pytest.approx(height, abs=1e-14)
    assert ", axes=([" in repr(below) and ", free to turn about (" in str(below)
    (stone,) = rb.equilibria(body_on(rb.Spherical(point=[0, 0, -0.5]), attitude=[0, 1, 0, 0])[0])
    assert not stone.stable and stone.coordinates.tolist() == [0, 1, 0, 0]


def test_a_damped_run_of_bodies_and_beads_comes_to_rest_in_their_equilibrium():
    def joined(damping):
        scene = rb.Scene(gravity=[0, 0, -9.8125])
        bead = scene.add(rb.Particle(0.5), rb.Rail(CIRCLE), parameter=0.3)
        bob = scene.add(BOB, rb.Revolute([0, 1, 0], at=[1.5, 0, 0]), angle=-0.1)
        ball = scene.add(BOB, rb.Spherical(at=[3, 0, 0]), attitude=rb.EulerAngles(0.3, 0.2, 0.1))
        spring = rb.Spring(stiffness=30.0, rest_length=0.5, damping=damping)
        scene.connect(spring, bead, bob.point([0, 0, -0.7]))
        scene.connect(spring, bob.point([0, 0.1, -0.8]), ball.point([0.1, 0, -0.6]))
        if damping:
            for body in bead, bob:
                scene.apply(rb.Drag(linear=damping), body)
            scene.apply(rb.Torque(lambda t, rotation_matrix, angular_velocity: -damping * angular_velocity), ball)
        return scene, bead, bob, ball

    scene, bead, bob, ball = joined(2.0)
    (state,) = rb.equilibria(joined(0.0)[0])
    assert state.stable and len(state.coordinates) == 6 and len(state.periods) == 5
    run = rb.simulate(scene, until=60.0, error=1e-10)
    turn = run[ball].quaternion(60.0)
    last = [run[bead].parameter(60.0), run[bob].angle(60.0), *(turn * np.sign(turn[0]))]
    assert state.coordinates == pytest.approx(np.array(last), abs=1e-8)
    (again,) = rb.equilibria(scene, near=state.coordinates)
    assert again.coordinates == pytest.approx(state.coordinates, abs=1e-14)


def test_a_torque_that_changes_with_time_has_no_equilibria():
    scene, bob = body_on(rb.Revolute([0, 1, 0]))
    scene.apply(rb.Torque(lambda t, rotation_matrix, angular_velocity: [0, np.sin(t), 0]), bob)
    with pytest.raises(rb.InvalidInput, match="torque .* on body 1 depends on time"):
        rb.equilibria(scene)


@pytest.mark.parametrize("wave", [1.0, 1.7, 2.9, 4.0])
@pytest.mark.parametrize("off", [-1e-2, -1e-4, 1e-5, 1e-3, 1e-1])
def test_the_search_goes_where_a_slow_damped_motion_does(wave, off):
    """-sin(w q) - 0.01 q pulls back to 0 from anywhere below pi/w, and has no stiffness at about pi/(2 w), from where
    a step of Newton's would turn the body as far as it likes, into one of the states of rest beyond."""
    start = math.pi / 2 / wave * (1 + off)
    scene = rb.Scene()
    hinge = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Revolute([0, 0, 1]), angle=start)
    scene.apply(rb.JointTorque(lambda t, q, rate: -np.sin(wave * q) - 0.01 * q), hinge)
    # of one hinge alone all states of rest are found
    wheel = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Revolute([0, 0, 1]))
    scene.apply(rb.TorsionSpring(1.0), wheel)
    slow = solve_ivp(lambda t, q: -np.sin(wave * q) - 0.01 * q, (0, 100), [start], rtol=1e-9, atol=1e-12)
    (found,) = rb.equilibria(scene)
    assert abs(found.coordinates[0] - slow.y[0, -1]) < 1e-9


@pytest.mark.parametrize("on_cart", [False, True])
@pytest.mark.parametrize(
    ("off", "pushes"),
    [(lambda z: -(z**2), False), (lambda z: -(z**3), False), (lambda z: -(z**4), False), (lambda z: 0.5 * z, True)],
)
def test_a_rail_that_pushes_with_nothing_leaves_open_what_is_off_it(off, pushes, on_cart):
    # U = x^2 + off(z) [V], z > 0 is where the bead may go: no minimum of V for the first three, along the rail one
    for place in (0.0, 0.3):
        scene, more = rb.Scene(), {}
        if on_cart:
            cart = scene.add(rb.RigidBody(1.0, [0.1] * 3), rb.Prismatic([0, 1, 0]))
            scene.connect(rb.Spring(1.0), cart, [0, 0, 0])
            more = {"parent": cart}
        rail = rb.Rail(rb.Line([1, 0, 0]), side="+", up=[0, 0, 1])
        bead = scene.add(rb.Particle(1.0), rail, parameter=place + 0.1, **more)
        scene.apply(rb.Potential(lambda r, u=place: -((r[0] - u) ** 2) - (r[0] - u) * r[2] - off(r[2])), bead)
        (rest,) = rb.equilibria(scene)
        assert rest.coordinates[-1] == pytest.approx(place, abs=1e-15)
        assert (rest.stable, rest.decided) == (pushes, pushes)


def test_a_catenary_of_links_hangs_as_its_forces_say():
    # a closed chain: the horizontal force H is the same all along, a link's slope is what hangs below it over H
    count, span = 20, 0.6
    length, first = 1.0 / count, math.acos(span)
    scene, links = rb.Scene(gravity=[0, 0, -9.8125]), []
    link = rb.RigidBody(length, [1e-9, length**3 / 12, length**3 / 12], com=[length / 2, 0, 0])
    for k in range(count):
        angle = first if k == 0 else -2 * first if k == count // 2 else 0.0
        more = {"parent": links[-1]} if links else {}
        joint = rb.Revolute([0, 1, 0], at=[length if links else 0, 0, 0])
        links.append(scene.add(link, joint, angle=angle, **more))
    scene.constrain(rb.Ball(), links[-1].point([length, 0, 0]), [span, 0, 0])
    scene.assemble()
    (rest,) = rb.equilibria(scene)
    low, high = 1e-3, 1e3
    weights = count / 2 - 0.5 - np.arange(count)
    while (middle := 0.5 * (low + high)) not in (low, high):
        wide = np.cos(np.arctan2(weights, middle)).sum() * length > span
        low, high = (low, middle) if wide else (middle, high)
    assert rest.stable
    assert np.allclose(np.cumsum(rest.coordinates), np.arctan2(weights, middle), rtol=0, atol=1e-12)
    # modes are M^-1 K of any coordinates: by finite differences of the angles of the links to the horizontal
    squares = rb.normal_modes(scene, at=rest).squares
    assert len(squares) == count - 2
    assert np.allclose(squares, catenary_modes(weights, middle, length, 9.8125), rtol=1e-6)


def catenary_modes(weights, horizontal, length, gravity):
    """Squares of the frequencies of a chain of thin links, in the angles of the links, ends held."""
    count = len(weights)
    angles = np.arctan2(weights, horizontal)
    mass = length
    # forces of the pins, from the weight of half a chain over H = m g middle: L = T - V - F.(end - span)
    pull = mass * gravity * horizontal
    after = np.arange(count)[::-1]
    cosines = np.cos(angles[:, None] - angles[None, :])
    masses = mass * length**2 * (np.minimum(after[:, None], after[None, :]) + 0.5) * cosines
    np.fill_diagonal(masses, mass * length**2 * (after + 1 / 3))
    # second derivatives of the potential with the pull at the end and its vertical part
    stiff = np.diag(length * (pull * np.cos(angles) + mass * gravity * weights * np.sin(angles)))
    rows = np.vstack([-np.sin(angles), np.cos(angles)])
    _, _, right = np.linalg.svd(rows)
    basis = right[2:].T
    inverse = np.linalg.inv(np.linalg.cholesky(basis.T @ masses @ basis))
    return np.linalg.eigvalsh(inverse @ (basis.T @ stiff @ basis) @ inverse.T)


@pytest.mark.parametrize("place", [1.0, 0.3, -0.3, 2.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_pole_of_a_torque_is_no_state_of_rest(sign, place):
    """However it changes its sign there, and whatever else it has."""

    def states(torque):
        scene = rb.Scene()
        hinge = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Revolute([0, 0, 1]))
        scene.apply(rb.JointTorque(lambda t, q, rate: sign * torque(q - place)), hinge)
        return sorted(
            ((s.coordinates[0] - place + math.pi) % math.tau - math.pi, s.stable) for s in rb.equilibria(scene)
        )

    assert states(lambda q: 1 / np.sin(q)) == []
    ((found, stable),) = states(lambda q: 0.5 + np.tan(q / 2))
    assert abs(found + 2 * math.atan(0.5)) < 1e-14 and stable == (sign < 0)
    (low, high) = states(lambda q: 1 / np.tan(q))
    assert abs(low[0] + math.pi / 2) < 1e-14 and abs(high[0] - math.pi / 2) < 1e-14
    assert low[1] == high[1] == (sign > 0)


@pytest.mark.parametrize("unit", [1.0, 10.0, 100.0, 1e3, 1e6])
def test_rests_of_a_slide_in_decimal_units(unit):
    """A zero that two pieces of the search share is beyond the end of both, by rounding."""
    for first, second in [(-1.8, 0.9), (-1.1, 2.4), (0.5, -0.1), (-2.5, -0.3), (1.2, 0.7)]:
        scene = rb.Scene()
        slide = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Prismatic([0, 0, 1]))
        scene.apply(rb.JointForce(lambda t, q, v, a=first, b=second: (q / unit - a) * (q / unit - b)), slide)
        rests = rb.equilibria(scene)
        assert [r.coordinates[0] for r in rests] == pytest.approx(sorted([first * unit, second * unit]), rel=1e-14)
        assert [r.stable for r in rests] == [True, False]


@pytest.mark.parametrize("place", [(0.0, 0.0), (0.125, -1.375), (0.5, 0.1), (1.86, 0.1)], ids=str)
def test_a_rest_of_higher_order_in_a_bent_valley(place):
    """u^3 along a valley that bends: the one place where all slopes vanish, stable to no side of it."""
    scene = rb.Scene()
    point = scene.add(rb.Particle(1.0), position=[0.3, 0.2, 0.1])

    def energy(x):
        u, w = x[0] - place[0], x[1] - place[1]
        return -(0.618 * u**3 + 3.97 * (w - 0.2 * u * u) ** 2 + 3 * x[2] ** 2)

    scene.apply(rb.Potential(energy), point)
    (rest,) = rb.equilibria(scene, near=[place[0] + 0.01, place[1] + 0.005, 0.0])
    assert rest.coordinates == pytest.approx([*place, 0.0], abs=1e-7)
    assert not rest.stable
