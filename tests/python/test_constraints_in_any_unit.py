"""Mechanisms with constraints told in other units of length, mass and time: the same starts, motion and forces.

Powers of two change no bit; other units change rounding. What forces that the motion does not determine have to be is
found by numpy, from equilibrium written down by hand.
"""

import numpy as np
import pytest
import rbdyn as rb

LENGTHS = (1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9)
# a base that is no 1, by which a product is left out
BASE = (2.0**3, 2.0**5, 2.0**-4)
OTHERS = (
    (2.0**-27, 2.0**5, 2.0**-4),
    (2.0**30, 2.0**5, 2.0**-4),
    (2.0**3, 2.0**-25, 2.0**-4),
    (2.0**3, 2.0**5, 2.0**18),
)


class Units:
    """How many of the units there are in a m, kg and s, and scenes told in them."""

    def __init__(self, length=1.0, mass=1.0, time=1.0):
        self.length, self.mass, self.time = length, mass, time
        self.newton = mass * length / time**2

    def scene(self, gravity):
        return rb.Scene(gravity=np.array(gravity) * self.length / self.time**2)

    def body(self, mass, moments, com=(0, 0, 0)):
        return rb.RigidBody(mass * self.mass, np.array(moments) * self.mass * self.length**2, com=self.at(*com))

    def at(self, *place):
        return np.array(place) * self.length


def pose(units, scene, body):
    run = rb.simulate(scene, until=1e-4 * units.time, error=1e-6)
    return run[body].position(0.0) / units.length, run[body].rotation_matrix(0.0)


def joined(units, kinds):
    """Two bodies joined by several constraints at once, and one of them by a rod to the world."""
    scene = units.scene([0, 0, -9.8125])
    angles = rb.EulerAngles(1.09, 2.25, 2.46), rb.EulerAngles(1.2, 1.98, -2.01)
    a = scene.add(
        units.body(0.6875, [0.505, 0.594, 0.656], [0, 0, -0.5]),
        position=units.at(-0.08, 0.28, -0.15),
        attitude=angles[0],
    )
    b = scene.add(
        units.body(2.8, [0.1316, 0.2049, 0.2198], [0, 0, 0.5]),
        position=units.at(0.67, -0.79, -0.92),
        attitude=angles[1],
    )
    (at_a, turn_a), (at_b, turn_b) = pose(units, scene, a), pose(units, scene, b)
    held = []
    for kind, point in zip(kinds, ([0.5, 0.25, 0.1], [0.1, -0.4, 0.3], [-0.3, 0.2, 0.6]), strict=False):
        place = at_a + turn_a @ point
        there = turn_b.T @ (place - at_b)
        if kind == "rod":
            there = np.array([0.2, 0.7, -0.1])
            law = rb.Rod(units.length * float(np.linalg.norm(place - at_b - turn_b @ there)))
        else:
            axis = turn_b.T @ turn_a @ [0.3, 0.4, 0.87]
            law = {"ball": rb.Ball, "weld": rb.Weld, "hinge": lambda axis=axis: rb.Hinge(axis)}[kind]()
        held.append(scene.constrain(law, a.point(units.at(*point)), b.point(units.at(*there))))
    anchor, point = np.array([1.0, 0.5, 0.3]), np.array([-0.5, -0.7, -0.5])
    length = float(np.linalg.norm(at_b + turn_b @ point - anchor))
    held.append(scene.constrain(rb.Rod(units.length * length), b.point(units.at(*point)), units.at(*anchor)))
    return scene, [a, b], held, 0.3


def door(units):
    """On two hinges, which turn about a line across no axis."""
    scene = units.scene([0, 0, -9.8125])
    leaf = scene.add(
        units.body(3.0, [0.4, 0.5, 0.6], [0.4, 0, 0.1]),
        position=units.at(0.3, 0.2, 0),
        attitude=rb.EulerAngles(0.3, 0.7, 0.2),
    )
    at, turn = pose(units, scene, leaf)
    own = np.array([0.6, 0, 0.8])
    held = [
        scene.constrain(rb.Hinge(turn @ own), leaf.point(units.at(*(z * own))), units.at(*(at + z * turn @ own)))
        for z in (-0.5, 0.9)
    ]
    return scene, [leaf], held, 0.5


def four_bar(units):
    """Of bodies that are free but for four hinges, three rows too many for each, from a rough start."""
    scene = units.scene([0, -9.8125, 0])
    bodies = [
        scene.add(
            units.body(mass, [moment / 2, moment / 2, moment], [com, 0, 0]),
            position=units.at(*place),
            attitude=rb.EulerAngles(0, angle, 0),
        )
        for mass, com, moment, place, angle in (
            (1.0, 0.4, 0.05, (0, 0, 0), 0.5),
            (2.0, 1.0, 0.7, (0.65, 0.35, 0), 0.6),
            (1.5, 0.75, 0.3, (2.0, 0, 0), 1.4),
        )
    ]
    crank, coupler, rocker = bodies
    ends = (
        (crank.point([0, 0, 0]), np.zeros(3)),
        (coupler.point([0, 0, 0]), crank.point(units.at(0.75, 0, 0))),
        (rocker.point([0, 0, 0]), units.at(2, 0, 0)),
        (coupler.point(units.at(2, 0, 0)), rocker.point(units.at(1.5, 0, 0))),
    )
    held = [scene.constrain(rb.Hinge([0, 0, 1]), *both) for both in ends]
    scene.assemble(keep=[crank])
    return scene, bodies, held, 1.0


def table(units):
    """Four points of a body on a plane, one too many, pulled by a spring."""
    scene = units.scene([0, 0, -9.8125])
    top = scene.add(units.body(3.0, [0.4, 0.5, 0.6], [0.1, 0, 0.1]), position=units.at(0.3, 0.2, 0))
    floor = rb.Plane([0, 0, 1], units.at(0, 0, -0.5))
    held = [
        scene.constrain(rb.PointOnPlane(floor), top.point(units.at(x, y, -0.5)))
        for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))
    ]
    spring = rb.Spring(7.0 * units.mass / units.time**2, rest_length=0.3 * units.length)
    scene.connect(spring, top.point(units.at(0.5, 0, 0)), units.at(1, 2, 0.5))
    return scene, [top], held, 0.4


def swing(units):
    """A plate in a plane on three equal, parallel rods, one too many."""
    scene = units.scene([0, -9.8125, 0])
    plate = scene.add(units.body(3.0, [0.4, 0.5, 0.6], [0.1, 0.05, 0]), rb.Planar([1, 0, 0], [0, 1, 0]))
    held = [
        scene.constrain(rb.Rod(0.5 * units.length), plate.point(units.at(x, y, 0)), units.at(x + 0.3, y + 0.4, 0))
        for x, y in ((1, 0.2), (-0.7, 0), (0.1, 0.7))
    ]
    return scene, [plate], held, 0.7


def trammel(units):
    """The ends of a bar on two lines, and in the plane of both, twice."""
    scene = units.scene([0, 0, 0])
    bar = scene.add(
        units.body(1.5, [0.01, 0.5, 0.5]),
        position=units.at(1, 0, 0),
        velocity=units.at(0, 2, 0) / units.time,
        angular_velocity=np.array([0, 0, -2]) / units.time,
    )
    laws = (
        rb.PointOnCurve(rb.Line([1, 0, 0])),
        rb.PointOnCurve(rb.Line([0, 1, 0])),
        rb.PointOnPlane(rb.Plane([0, 0, 1])),
    )
    held = [scene.constrain(law, bar.point(units.at(x, 0, 0))) for law, x in zip(laws, (1.0, -1.0, 0.3), strict=True)]
    return scene, [bar], held, 1.0


def shaft(units):
    """Two bodies on a universal joint, a hinge and a rod."""
    scene = units.scene([0, 0, -9.8125])
    a, b = (
        scene.add(units.body(mass, [0.4, 0.5, 0.6], [0.1, 0.05, 0.1]), position=units.at(x, 0, 0))
        for mass, x in ((3.0, 0.0), (2.0, 1.0))
    )
    joint = rb.Universal([0, 1, 0], [0, 0, 1])
    held = [
        scene.constrain(joint, a.point(units.at(0.5, 0, 0)), b.point(units.at(-0.5, 0, 0))),
        scene.constrain(rb.Rod(0.5 * units.length), a.point([0, 0, 0]), units.at(0, 0.3, 0.4)),
        scene.constrain(rb.Hinge([0, 1, 0]), b.point(units.at(0.6, 0, 0)), units.at(1.6, 0, 0)),
    ]
    return scene, [a, b], held, 0.3


def rough(units):
    """Guesses far from where a rod and a hinge hold two bodies."""
    scene = units.scene([0, 0, -9.8125])
    a = scene.add(
        units.body(3.0, [0.4, 0.5, 0.6], [0.1, 0.05, 0.1]),
        position=units.at(0.1, 0.2, -0.9),
        velocity=units.at(1, 0, 0) / units.time,
        attitude=rb.EulerAngles(0.3, 0.7, 0.2),
    )
    b = scene.add(units.body(2.0, [0.4, 0.5, 0.6], [0.1, 0.05, 0.1]), position=units.at(1, 0.1, -1.8))
    held = [
        scene.constrain(rb.Rod(units.length), a.point(units.at(0.2, 0, 0)), [0, 0, 0]),
        scene.constrain(rb.Hinge([0, 0, 1]), b.point(units.at(0, 0, 0.5)), a.point(units.at(0, 0.1, -0.5))),
    ]
    scene.assemble()
    return scene, [a, b], held, 0.5


MECHANISMS = {
    "weld of three": lambda units: joined(units, ["ball", "ball", "ball"]),
    "two balls": lambda units: joined(units, ["ball", "ball"]),
    "hinge and ball": lambda units: joined(units, ["hinge", "ball"]),
    "weld and ball": lambda units: joined(units, ["weld", "ball"]),
    "two welds": lambda units: joined(units, ["weld", "weld"]),
    "weld and rod": lambda units: joined(units, ["weld", "rod"]),
    "hinge and rod": lambda units: joined(units, ["hinge", "rod"]),
    "weld, hinge and rod": lambda units: joined(units, ["weld", "hinge", "rod"]),
    "door": door,
    "four-bar": four_bar,
    "table": table,
    "swing": swing,
    "trammel": trammel,
    "shaft": shaft,
    "rough": rough,
}


def motion(build, units):
    """Places, attitudes and forces in m, rad, N and N m; the error told; which forces are not unique."""
    scene, bodies, held, end = build(units)
    run = rb.simulate(scene, until=end * units.time, error=1e-9)
    places, forces = [], []
    for t in (0.0, 0.37 * end * units.time, end * units.time):
        for body in bodies:
            places += [*(run[body].position(t) / units.length), *run[body].rotation_matrix(t).ravel()]
        for one in held:
            forces += [*(run[one].force(t) / units.newton), *(run[one].torque(t) / units.newton / units.length)]
    return np.array(places), np.array(forces), run.error, run.plan.not_unique


@pytest.mark.parametrize("name", MECHANISMS)
def test_powers_of_two_change_no_bit(name):
    places, forces, error, not_unique = motion(MECHANISMS[name], Units(*BASE))
    for units in OTHERS:
        there, others, told, same = motion(MECHANISMS[name], Units(*units))
        assert np.array_equal(places, there) and np.array_equal(forces, others), units
        assert told == error and same == not_unique, units


@pytest.mark.parametrize("name", MECHANISMS)
def test_other_units_change_rounding_alone(name):
    """They were refused; or rows of angles or rods were taken for none: motion half its size off, told 2e-13."""
    places, forces, error, not_unique = motion(MECHANISMS[name], Units())
    for units in [*((length, 1, 1) for length in LENGTHS), (1, 1e9, 1), (1, 1, 1e-6), (1e9, 1e-9, 1e6)]:
        there, others, told, same = motion(MECHANISMS[name], Units(*units))
        assert abs(there - places).max() < 1e-11, units
        # of steps of another length after rounding
        assert abs(others - forces).max() < 1e-10 * abs(forces).max(), units
        assert told < 1e-10 + 10 * error and same == not_unique, units


@pytest.mark.parametrize("length", [1e-9, 1e-3, 1.0, 1e4, 1e9])
def test_forces_that_share_a_load_are_those_of_least_norm_of_equilibrium(length):
    """A weld, a ball and a rod hold a body at rest; torques count over the longest arm, of the centre here."""
    units = Units(length)
    scene = units.scene([1.0, -2.0, -9.0])
    com, ball, rod = np.array([0.9, 0.5, 0.7]), np.array([0.5, 0.25, 0.1]), np.array([-0.3, 0.2, 0.6])
    body = scene.add(units.body(2.0, [0.3, 0.4, 0.5], com))
    end = np.array([0.2, 0.9, 0.4])
    held = [
        scene.constrain(rb.Weld(), body.point([0, 0, 0])),
        scene.constrain(rb.Ball(), body.point(units.at(*ball)), units.at(*ball)),
        scene.constrain(rb.Rod(length * float(np.linalg.norm(end - rod))), body.point(units.at(*rod)), units.at(*end)),
    ]
    run = rb.simulate(scene, until=1.0)
    # what each unknown does: force, and torque about the origin
    along = (rod - end) / np.linalg.norm(rod - end)
    columns = [np.r_[e, 0, 0, 0] for e in np.eye(3)]
    arm = np.linalg.norm(com)
    columns += [np.r_[0, 0, 0, e] * arm for e in np.eye(3)]  # over the arm they count as forces
    columns += [np.r_[e, np.cross(ball, e)] for e in np.eye(3)] + [np.r_[along, np.cross(rod, along)]]
    weight = 2.0 * np.array([1.0, -2.0, -9.0])
    least = np.linalg.lstsq(np.array(columns).T, -np.r_[weight, np.cross(com, weight)], rcond=None)[0]
    expected = [least[:3], least[6:9], least[9] * along]
    for one, force in zip(held, expected, strict=True):
        assert abs(run[one].force(1.0) / length - force).max() < 1e-12
    assert abs(run[held[0]].torque(1.0) / length**2 - least[3:6] * arm).max() < 1e-12


@pytest.mark.parametrize("length", [1e-9, 1.0, 1e9])
def test_a_start_off_by_a_turn_is_refused_in_any_unit(length):
    """Axes are 1e-3 rad off a right angle, 1e-6 of the size is allowed: in large units that was taken for closed."""
    units = Units(length)
    scene = units.scene([0, 0, -9.8125])
    leaf = scene.add(units.body(3.0, [0.4, 0.5, 0.6], [0.4, 0, 0.1]), attitude=rb.EulerAngles(1e-3, 0, 0))
    scene.constrain(rb.Universal([0, 1, 0], [0, 0, 1]), leaf.point([0, 0, 0]), [0, 0, 0])
    with pytest.raises(rb.InvalidInput, match="gap is"):
        rb.simulate(scene, until=1.0)
    scene.assemble()
    rb.simulate(scene, until=units.time)
