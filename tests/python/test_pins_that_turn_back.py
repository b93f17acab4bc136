"""Two bars on rough pins whose tip is held on a plane have one freedom: where the angle between them is extreme the
second pin turns back while the first turns on. No torque could hold it there, and its friction changes its sign, or the
contact opens. Against all equations of both bars, written down apart (linkage_by_hand.py)."""

import math

import numpy as np
import pytest
import rbdyn as rb
from linkage_by_hand import Linkage, g, start


def linkage(masses, pins, height, mu, at, stays=False):
    angles, rates = at
    scene = rb.Scene(gravity=[0, 0, -g])
    bodies = []
    for k in range(2):
        bar = rb.RigidBody(masses[k], [0.05, Linkage.inertia, 0.1], com=[0.5, 0, 0])
        static, dynamic, radius = pins[k]
        place = {"at": [1, 0, 0]} if bodies else {}
        pin = rb.Revolute([0, 1, 0], friction=rb.Coulomb(static, dynamic), pin_radius=radius, **place)
        of = {"parent": bodies[0]} if bodies else {}
        body = scene.add(bar, pin, angle=np.diff(angles, prepend=0.0)[k], rate=np.diff(rates, prepend=0.0)[k], **of)
        bodies.append(body)
    floor, tip = rb.Plane([0, 0, 1], [0, 0, -height]), bodies[1].point([1, 0, 0])
    if stays:
        scene.constrain(rb.PointOnPlane(floor), tip)
    else:
        scene.contact(tip, floor, **({"friction": rb.Coulomb(mu)} if mu else {}))
    return scene, bodies


def compare(given, end, stays=False):
    """Runs both until what is not compared begins; what happened by hand, and the greatest difference."""
    masses, pins, height, mu, at = given
    by_hand = Linkage(masses, pins, height, mu, stays)
    t, y, told = by_hand.run(np.concatenate(at), end)
    scene, bodies = linkage(*given, stays)
    run = rb.simulate(scene, until=t, rtol=1e-12)
    assert run.end == t
    found = np.cumsum([[run[body].angle(t), run[body].rate(t)] for body in bodies], axis=0)
    difference = max(np.abs(found[:, 0] - y[:2]).max(), np.abs(found[:, 1] - y[2:]).max())
    # what happens as the run ends is one side of it
    happened = [(f.kind, f.time) for f in run.events if f.time < t - 1e-9]
    expected = [(kind, time) for kind, time in told if time < t - 1e-9]
    assert [kind for kind, _ in happened] == [kind for kind, _ in expected]
    assert max((abs(a[1] - b[1]) for a, b in zip(happened, expected, strict=True)), default=0.0) < 1e-11
    return told, difference


def drawn(seed, mu):
    """The tip slides towards the place below the first pin, where the second one turns back."""
    rng = np.random.default_rng([29, seed])
    masses, height = rng.uniform(0.5, 2, 2), rng.uniform(1.2, 1.9)
    pins = [(k * rng.uniform(1, 1.4), k, rng.uniform(0.02, 0.1)) for k in rng.uniform(0.05, 0.5, 2)]
    side, knee = rng.choice([-1, 1], 2)
    x = side * rng.uniform(0.1, 0.9 * min(0.6, math.sqrt(4 - height**2)))
    return masses, pins, height, mu, start(height, x, -side * rng.uniform(1, 4), knee)


@pytest.mark.parametrize("mu", [0.0, 0.2])
@pytest.mark.parametrize("seed", range(12))
def test_a_pin_turns_back_while_the_tip_slides_on_a_floor(seed, mu):
    """It was said to stick while the first pin turned on at 2.7 rad/s and the gap, said to be closed, grew to 8 cm."""
    told, difference = compare(drawn(seed, mu), 1.0)
    assert difference < 1e-11


@pytest.mark.parametrize("seed", range(6))
def test_a_pin_turns_back_in_a_loop(seed):
    """The same of a constraint in place of the contact, where nothing opens."""
    told, difference = compare(drawn(seed, 0.0), 0.5, stays=True)
    assert difference < 1e-11


def test_a_pin_that_friction_holds_there_lets_the_tip_rise():
    """Where the force of the contact would have to pull for the pin to turn back, and friction can hold the pin, both
    bars turn on as one about the first pin, and the tip, below it, rises."""
    masses, height = (0.84, 1.14), 1.9
    pins = [(2.2, 1.67, 0.09), (4.8, 3.95, 0.087)]
    given = masses, pins, height, 0.0, start(height, -0.43, 2.45, 1)
    by_hand = Linkage(*given[:4])
    t, y, told = by_hand.run(np.concatenate(given[4]), 1.0)
    assert [kind for kind, _ in told] == ["stick", "detach"]
    scene, (first, second) = linkage(*given)
    run = rb.simulate(scene, until=t + 0.01, rtol=1e-12)
    assert [f.kind for f in run.events] == ["stick", "detach"]
    assert max(abs(f.time - t) for f in run.events) < 1e-11
    assert run[second].rate(t + 0.01) == 0 and run[second].angle(t + 0.01) == run[second].angle(t + 1e-9)
    assert abs(run[first].angle(t) - y[0]) < 1e-11 and abs(run[first].rate(t) - y[2]) < 1e-11
    angles = run[first].angle(t + 0.01) + np.array([0.0, run[second].angle(t + 0.01)])
    held = by_hand.solve(y, (int(np.sign(y[2])), 0), False, 0.0)
    assert height - np.sin(angles).sum() == pytest.approx(by_hand.lifts(y, held) * 0.5e-4, rel=0.02)


def test_pins_that_jam_at_the_start_are_refused():
    """No forces satisfy the laws of pins this rough, by hand neither. It ended the process."""
    masses, height = (1.7114, 1.4964), 1.8832
    pins = [(3.9932, 3.1153, 0.08376), (7.3251, 5.818, 0.07934)]
    given = masses, pins, height, 0.0, start(height, 0.18267, -0.5341, -1)
    with pytest.raises(ArithmeticError):
        Linkage(*given[:4]).run(np.concatenate(given[4]), 0.1)
    with pytest.raises(rb.IntegrationError, match="no forces"):
        rb.simulate(linkage(*given)[0], until=0.1)


def at_dead_point(seed):
    """At rest with the tip exactly below the first pin, the bars to one side."""
    rng = np.random.default_rng([77, seed])
    masses, height = rng.uniform(0.5, 2, 2), rng.uniform(1.2, 1.9)
    pins = [(k * rng.uniform(1, 1.4), k, rng.uniform(0.02, 0.1)) for k in rng.uniform(0.05, 0.5, 2)]
    return masses, pins, height, 0.2 * (seed % 2), start(height, 0.0, 0.0, rng.choice([-1, 1]))


@pytest.mark.parametrize("seed", range(4, 12))
def test_from_rest_at_the_dead_point_the_second_pin_begins_as_the_third_power_of_time(seed):
    """The angle between the bars is extreme there, so the second pin begins without an acceleration. It was said to
    stay at rest while both bars turned on about the first one, and the contact to push at a gap of 4 cm. By hand from
    0.3 um/s beside rest."""
    given = at_dead_point(seed)
    scene, bodies = linkage(*given)
    run = rb.simulate(scene, until=0.3, error=1e-9)
    way = np.sign(run[bodies[0]].rate(1e-3))
    by_hand = Linkage(*given[:4])
    t, y, told = by_hand.run(np.concatenate([given[4][0], [way * 3e-7] * 2]), 0.3)
    assert t == 0.3 and told == [] and list(run.events) == []
    angles, rates = np.cumsum([[run[body].angle(t), run[body].rate(t)] for body in bodies], axis=0).T
    assert np.abs(angles - y[:2]).max() < 3e-7 and np.abs(rates - y[2:]).max() < 2e-6
    assert abs(given[2] - np.sin(angles).sum()) < 1e-13
    # as t^3: eight times in twice the time
    first, second = (run[bodies[1]].rate(time) for time in (1e-3, 2e-3))
    assert second / first == pytest.approx(8, rel=1e-3)


def test_a_pin_that_friction_holds_at_the_dead_point_lets_the_tip_rise_from_rest():
    """Where static friction of the second pin carries the second bar, the tip rises as the fourth power of time."""
    masses, pins = (1.27268839, 1.54617619), [(2.7664913, 2.637, 0.0745), (3.12936, 2.3527, 0.0949)]
    scene, (first, second) = linkage(masses, pins, 1.8, 0.0, start(1.8, 0.0, 0.0, 1))
    run = rb.simulate(scene, until=0.3, error=1e-9)
    times = np.array([0.1, 0.2])
    assert np.all(run[second].rate(times) == 0)
    angles = np.array([run[first].angle(times), run[first].angle(times) + run[second].angle(times)])
    gaps = 1.8 - np.sin(angles).sum(axis=0)
    assert gaps[1] / gaps[0] == pytest.approx(16, rel=0.2) and list(run.events) == []


@pytest.mark.parametrize("beside", [-3, -1, 0, 1, 2])
def test_rounding_of_the_dead_point_brings_the_tip_nowhere(beside):
    """Beside it by units in the last place the tip would pass the lowest place of its circle first, 1e-32 m lower: the
    contact that had opened was struck again without end."""
    masses, pins = (
        (1.76878516, 1.49822687),
        [(1.625844562908, 1.2148289018, 0.0507712289), (3.3513527934, 2.4423, 0.0776)],
    )
    angles, rates = start(1.8837999131, 0.0, 0.0, 1)
    given = masses, pins, 1.8837999131, 0.0, (angles + beside * 2.0**-52, rates)
    scene, (first, second) = linkage(*given)
    run = rb.simulate(scene, until=0.3, error=1e-9)
    assert run.end == 0.3 and [e.kind for e in run.events] == []
    both = run[first].angle(0.2), run[first].angle(0.2) + run[second].angle(0.2)
    assert run[second].rate(0.2) == 0 and 1.8837999131 - np.sin(both).sum() > 1e-5
