"""Lengths, masses and times in other powers of two: every engine gives the same motion, bit for bit, contacts too."""

import numpy as np
import pytest
import rbdyn as rb

ENGINES = [engine for engine in rb.engines() if engine != "closed form"]


def stiff_springs(length, mass, time, engine):
    """Three masses on springs and dampers, one of them stiff, in units of which there are so many in a m, kg and s."""
    newton, stiffness, damping = mass * length / time**2, mass / time**2, mass / time
    scene = rb.Scene(gravity=[0, 0, -9.8125 * newton / mass])
    places = [[1.0, 0, 0], [2.0, 0.25, 0], [2.0, 0, 1.5]]
    bodies = [
        scene.add(rb.Particle(m * mass), position=np.array(r) * length)
        for m, r in zip((1.0, 3.0, 0.375), places, strict=True)
    ]
    ends = [[0, 0, 0], *bodies]
    for k, (strong, slow) in enumerate([(1e4, 200.0), (1e3, 10.0), (50.0, 0.5)]):
        spring = rb.Spring(strong * stiffness, rest_length=0.875 * length, damping=slow * damping)
        scene.connect(spring, ends[k + 1], ends[k])
    run = rb.simulate(scene, 2.0 * time, rtol=1e-7, engine=engine)
    return [np.array(run[body].position(k * time / 4)) / length for body in bodies for k in range(9)]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("units", [(2.0**10, 1, 1), (1, 2.0**-20, 1), (1, 1, 2.0**13), (2.0**-7, 2.0**11, 2.0**-9)])
def test_they_change_no_bit(units, engine):
    plain, other = stiff_springs(1, 1, 1, engine), stiff_springs(*units, engine)
    assert all(np.array_equal(a, b) for a, b in zip(plain, other, strict=True))


def ball_and_bars(length, mass, time):
    """A ball thrown on a floor that it touches, and two bars whose tip strikes a wall."""
    scene = rb.Scene(gravity=[0, -9.8125 * length / time**2, 0])

    def body(m, moment, com=0.0):
        moment *= mass * length**2
        return rb.RigidBody(m * mass, [moment, moment, moment], com=[0, com * length, 0])

    ball = scene.add(
        body(2.0, 0.25),
        rb.Planar([1, 0, 0], [0, 1, 0]),
        position=[0, 0.5 * length],
        velocity=[1.5 * length / time, 2.0 * length / time],
        rate=3.0 / time,
    )
    scene.contact(ball.sphere(0.5 * length), rb.Plane([0, 1, 0]), restitution=0.5, friction=rb.Coulomb(0.25))
    upper = scene.add(body(1.0, 0.125, -0.5), rb.Revolute([0, 0, 1], at=[5 * length, 4 * length, 0]), rate=1.0 / time)
    at = [0, -length, 0]
    lower = scene.add(body(1.0, 0.125, -0.5), rb.Revolute([0, 0, 1], at=at), rate=-2.0 / time, parent=upper)
    wall = rb.Plane([1, 0, 0], [4.875 * length, 0, 0])
    scene.contact(lower.point([0, -length, 0]), wall, restitution=0.75)
    run = rb.simulate(scene, 1.5 * time, error=1e-10)
    events = [(e.kind, e.name, e.time / time) for e in run.events]
    places = [run[b].position(k * time / 4) / length for b in (ball, upper, lower) for k in range(7)]
    return events, np.array(places)


@pytest.mark.parametrize(
    "units", [(2.0**-60, 1, 1), (2.0**90, 2.0**-90, 2.0**40), (1, 2.0**100, 1), (2.0**-100, 2.0**-50, 2.0**-100)]
)
def test_they_change_no_bit_of_contacts(units):
    """A moment of inertia is as small as its unit makes it, beside any mass."""
    (events, places), (others, there) = ball_and_bars(1, 1, 1), ball_and_bars(*units)
    assert len(events) > 5 and {kind for kind, *_ in events} >= {"impact"}
    assert events == others and np.array_equal(places, there)


def bars_at_a_wall(length, mass, time, **wanted):
    """Two bars whose tip slides on a rough wall through their hinge, which lets go of it where they hang straight."""
    scene = rb.Scene(gravity=[0, -9.8125 * length / time**2, 0])
    bars, place = [], [0, 0, 0]
    for k, (size, rate) in enumerate([(0.734375, 1.5), (0.9375, 1.765625)]):
        moment = size**2 / 12 * mass * length**2
        body = rb.RigidBody(mass, [moment / 2, moment / 2, moment], com=[0, -size / 2 * length, 0])
        more = {"parent": bars[-1]} if bars else {}
        bars.append(scene.add(body, rb.Revolute([0, 0, 1], at=place), angle=0.0, rate=rate / time, **more))
        place = [0, -size * length, 0]
        scene.watch(f"down {k}", lambda now, bar=bars[k]: now[bar].angle)
    scene.contact(bars[-1].point(place), rb.Plane([1, 0, 0]), friction=rb.Coulomb(0.375))
    run = rb.simulate(scene, 2 * time, **wanted)
    return [(e.kind, e.name, e.direction, e.time / time) for e in run.events]


@pytest.mark.parametrize("units", [(1, 2.0, 1), (1, 2.0**-33, 1), (2.0**62, 2.0**-3, 2.0**-97)])
def test_impacts_with_friction_change_no_bit_in_odd_powers(units):
    """Roots of masses are taken of what is near 1, in a unit that is a power of two."""
    events = bars_at_a_wall(1, 1, 1, error=1e-9)
    assert {kind for kind, *_ in events} >= {"impact", "reverse", "detach"} and bars_at_a_wall(
        *units, error=1e-9
    ) == events


@pytest.mark.parametrize("rtol", [1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13])
def test_what_passes_zero_where_two_modes_end_passes_it_once(rtol):
    """Where the bars hang straight their tip stops, turns back and leaves its wall at one instant."""
    events = bars_at_a_wall(1, 1, 1, rtol=rtol)
    leaves = [t for kind, _, _, t in events if kind == "detach"][-1]
    for name in ("down 0", "down 1"):
        passes = [(direction, t) for _, other, direction, t in events if other == name]
        assert sum(t == leaves for _, t in passes) == 1
        assert all(a != b for (a, _), (b, _) in zip(passes, passes[1:], strict=False))


def four_bars(length, mass, time, engine):
    """Two cranks joined by a coupler, that swing under gravity."""
    scene = rb.Scene(gravity=[0, -9.8125 * length / time**2, 0])

    def bar(size):
        moment = size**2 / 12 * mass * length**2
        return rb.RigidBody(size * mass, [moment / 2, moment / 2, moment], com=[size / 2 * length, 0, 0])

    z = [0, 0, 1]
    left = scene.add(bar(1.0), rb.Revolute(z), angle=1.25)
    far = scene.add(bar(1.5), rb.Revolute(z, at=[2 * length, 0, 0]), angle=1.125)
    apart = np.array([2 + 1.5 * np.cos(1.125), 1.5 * np.sin(1.125)]) - [np.cos(1.25), np.sin(1.25)]
    size, leans = float(np.hypot(*apart)), float(np.arctan2(apart[1], apart[0]))
    coupler = scene.add(bar(size), rb.Revolute(z, at=[length, 0, 0]), angle=leans - 1.25, parent=left)
    scene.constrain(rb.Ball(), coupler.point([size * length, 0, 0]), far.point([1.5 * length, 0, 0]))
    run = rb.simulate(scene, 2.0 * time, rtol=1e-7, engine=engine)
    return [np.array(run[body].position(k * time / 4)) / length for body in (left, far, coupler) for k in range(9)]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("units", [(2.0**60, 1, 1), (2.0**-60, 1, 1), (2.0**20, 2.0**-31, 2.0**11)])
def test_they_change_no_bit_of_linkages(units, engine):
    """Whether a gap is closed once or twice more is told by the arms that turn, not by a length."""
    plain, other = four_bars(1, 1, 1, engine), four_bars(*units, engine)
    assert all(np.array_equal(a, b) for a, b in zip(plain, other, strict=True))
