"""What moves by functions of time is where they put it at `start`, when a scene is looked at as it starts, too.

The angles of a four-bar linkage follow from that of its crank by the law of cosines, the rates by their derivatives.
"""

import math
import pickle

import numpy as np
import pytest
import rbdyn as rb


def four_bar(motion, angle, rate, start):
    """Crank 1, coupler 3, rocker 2.5, ground 3 [m]; the crank driven, and where and how fast it is at `start`."""
    bar = lambda length: rb.RigidBody(1.0, [0.1] * 3, com=[length / 2, 0, 0])  # noqa: E731
    coupler, rocker, rates = follow(angle, rate)
    scene = rb.Scene()
    crank = scene.add(bar(1.0), rb.Revolute([0, 0, 1], motion=motion))
    middle = scene.add(
        bar(3.0),
        rb.Revolute([0, 0, 1], at=[1, 0, 0]),
        parent=crank,
        angle=coupler - angle,
        rate=rates[0] - rate,
    )
    last = scene.add(bar(2.5), rb.Revolute([0, 0, 1], at=[3, 0, 0]), angle=rocker, rate=rates[1], name="rocker")
    scene.constrain(rb.Ball(), middle.point([3, 0, 0]), last.point([2.5, 0, 0]))
    return scene, crank, middle, last


def follow(angle, rate):
    pin = np.array([math.cos(angle), math.sin(angle)])
    across = np.array([3, 0]) - pin
    far = math.hypot(*across)
    coupler = math.atan2(across[1], across[0]) + math.acos((9 + far**2 - 6.25) / (6 * far))
    end = pin + 3 * np.array([math.cos(coupler), math.sin(coupler)])
    rocker = math.atan2(end[1], end[0] - 3)
    slopes = np.array(
        [[-3 * math.sin(coupler), 2.5 * math.sin(rocker)], [3 * math.cos(coupler), -2.5 * math.cos(rocker)]]
    )
    return coupler, rocker, np.linalg.solve(slopes, -rate * np.array([-math.sin(angle), math.cos(angle)]))


@pytest.mark.parametrize("start", [0.3, -20.0, 1e3])
def test_a_driven_linkage_begins_where_its_drive_is_then(start):
    for seed in range(5):
        random = np.random.default_rng(seed)
        angle, rate = random.uniform(-3, 3), random.uniform(0.3, 2)
        scene, crank, middle, last = four_bar(lambda t: angle + rate * (t - start), angle, rate, start)  # noqa: B023
        run = rb.simulate(scene, start=start, until=start + 0.5, error=1e-9)
        coupler, rocker, rates = follow(angle + 0.5 * rate, rate)
        # 2^-52 of the time are known of it
        known = 2e-9 + 2.0 * np.spacing(start) * rate
        assert math.remainder(run[last].angle(start + 0.5) - rocker, math.tau) == pytest.approx(0, abs=known)
        assert run[last].rate(start + 0.5) == pytest.approx(rates[1], abs=10 * known)
        assert run[crank].angle(start) == pytest.approx(angle, abs=known)


def test_a_start_has_the_rates_of_its_own_time():
    """At t = 1 the drive is where it is at t = 0, and moves the other way."""
    drive = lambda t: 0.7 + 0.3 * np.sin(np.pi * t)  # noqa: E731
    rate = -0.3 * math.pi
    scene, *_, last = four_bar(drive, 0.7, rate, 1.0)
    run = rb.simulate(scene, start=1.0, until=1.5, error=1e-9)
    _, rocker, _ = follow(0.4, 0.0)
    assert run[last].angle(1.5) == pytest.approx(rocker, abs=1e-9)
    with pytest.raises(rb.InvalidInput, match="rate of its gap"):
        rb.simulate(scene, until=0.5)
    # the plan that is kept for one start is not taken for another
    again = rb.simulate(scene, start=1.0, until=1.5, error=1e-9)
    assert again[last].angle(1.5) == run[last].angle(1.5)


def test_a_rough_start_is_assembled_for_its_time():
    drive = lambda t: 0.4 * t  # noqa: E731
    scene, *_, last = four_bar(drive, 2.0, 0.4, 5.0)
    for start, angle in ((5.0, 2.0), (2.0, 0.8)):
        scene.assemble(start=start)
        run = rb.simulate(scene, start=start, until=start + 1.0)
        _, rocker, rates = follow(angle, 0.4)
        assert run[last].angle(start) == pytest.approx(rocker, abs=1e-12)
        assert run[last].rate(start) == pytest.approx(rates[1], abs=1e-12)
    with pytest.raises(rb.InvalidInput, match="start"):
        scene.assemble(start=math.inf)


def test_a_saved_run_and_what_goes_on_know_it():
    scene, *_, last = four_bar(lambda t: 0.7 + 1.5 * (t - 3.0), 0.7, 1.5, 3.0)
    run = rb.simulate(scene, start=3.0, until=4.0, error=1e-9)
    back = pickle.loads(pickle.dumps(run))
    assert back["rocker"].angle(4.0) == run[last].angle(4.0)
    on = rb.simulate(run, until=5.0)
    _, rocker, _ = follow(0.7 + 3.0, 1.5)
    assert math.remainder(on[last].angle(5.0) - rocker, math.tau) == pytest.approx(0, abs=1e-8)


def test_a_drive_may_have_no_value_where_the_run_is_not():
    """1/t at t = 0."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    slide = scene.add(rb.RigidBody(2.0, [1, 1, 1]), rb.Prismatic([0, 0, 1], motion=lambda t: 1 / t))
    scene.add(rb.Particle(1.0), rb.Rail(rb.Line([1, 0, 0])), parent=slide)
    run = rb.simulate(scene, start=1.0, until=2.0)
    assert run[slide].displacement(2.0) == pytest.approx(0.5, abs=1e-14)
    assert run[slide].force(2.0) is not None
    with pytest.raises(rb.Error):
        rb.simulate(scene, until=2.0)


def test_many_begin_then_too():
    torque = rb.parameter(0.0, "torque")
    scene, *_, last = four_bar(lambda t: 0.7 + 0.5 * (t - 7.25), 0.7, 0.5, 7.25)
    scene.apply(rb.Torque(lambda t, attitude, omega: [0 * t, 0 * t, torque]), last)
    many = rb.simulate_many(scene, {torque: np.array([0.2, 0.7, 1.1])}, start=7.25, until=8.25)
    assert all(error is None for error in many.errors)
    _, rocker, _ = follow(1.2, 0.5)
    for member in many:
        assert member[last].angle(8.25) == pytest.approx(rocker, abs=1e-9)


def test_what_it_costs_is_told_for_its_start():
    scene, *_ = four_bar(lambda t: 0.7 + 0.5 * (t - 7.25), 0.7, 0.5, 7.25)
    price = rb.cost(scene, until=7.5, start=7.25, errors=[1e-6], engines=["taylor"], budget=1.0)
    assert "taylor" in str(price)
