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
