"""A corner of a box that tumbles bounces ever shorter: flights follow one another by the coefficient of restitution.

In flights so short nothing changes but the rate of the gap, so that each lasts e times as long as the one before; their
limit is that of the geometric series.
"""

import numpy as np
import pytest
import rbdyn as rb


def tumbling(seed, restitution):
    random = np.random.default_rng(seed)
    attitude = random.normal(size=4)
    scene = rb.Scene(gravity=[0, 0, -9.81])
    box = scene.add(
        rb.shapes.box(1.0, [0.4, 0.6, 0.2]),
        position=[0, 0, 0.8],
        velocity=random.uniform(-1, 1, 3),
        attitude=attitude / np.linalg.norm(attitude),
        angular_velocity=random.uniform(-4, 4, 3),
    )
    scene.contact(box.point([-0.2, -0.3, -0.1]), rb.Plane([0, 0, 1]), restitution=restitution)
    return scene


@pytest.mark.parametrize("how", [{"rtol": 1e-5}, {"rtol": 1e-7}, {"error": 1e-6}, {"error": 1e-9}], ids=str)
@pytest.mark.parametrize("restitution", [0.3, 0.7])
def test_flights_get_shorter_by_the_coefficient_of_restitution(restitution, how):
    limits = 0
    for seed in range(12):
        run = rb.simulate(tumbling(seed, restitution), until=3.0, max_steps=5000, **how)
        assert run.status == "reached end"
        ends = [i for i, e in enumerate(run.events) if e.kind == "accumulation"]
        for i in ends:
            times = [e.time for e in run.events[:i] if e.kind == "impact"]
            flights = np.diff(times[-8:])
            assert len(flights) > 5
            # to rounding of the times
            rounding = 4 * np.spacing(times[-1]) / flights[1:]
            assert np.all(np.abs(flights[1:] / flights[:-1] - restitution) < 1e-3 + rounding)
            left = flights[-1] * restitution / (1 - restitution)
            assert run.events[i].time - times[-1] == pytest.approx(left, abs=2e-2 * left + 4 * np.spacing(times[-1]))
            limits += 1
    assert limits > 8


LONG = pytest.mark.xfail(reason="two of the flights of 1e-8 s come out 7 % too long", strict=True)


@pytest.mark.parametrize(
    "how", [pytest.param({"rtol": 1e-9}, marks=LONG), {"rtol": 1e-10}, {"rtol": 1e-13}, {"error": 1e-9}], ids=str
)
def test_flights_of_many_pieces_get_shorter_by_it_too(how):
    """Quadratic drag is not analytic at rest, and what friction has stopped nearly rests at the top of each flight."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    particle = scene.add(rb.Particle(1.0), position=[0, 0, 1.0], velocity=[0.5, 0, 0])
    scene.apply(rb.Drag(quadratic=0.2), particle)
    scene.contact(particle, rb.Plane([0.2, 0, 1]), restitution=0.5, friction=rb.Coulomb(0.3))
    run = rb.simulate(scene, until=3.0, max_steps=20000, **how)
    assert run.status == "reached end" and run.events[-1].kind == "accumulation"
    times = np.array([e.time for e in run.events if e.kind == "impact"])
    flights = np.diff(times)
    small = flights[:-1] < 1e-3
    assert small.sum() > 20
    # drag is a millionth of gravity there, and less
    assert np.all(
        np.abs(flights[1:] / flights[:-1] - 0.5)[small] < 1e-5 + 4 * np.spacing(times[-1]) / flights[1:][small]
    )
