"""Chains of hinges with friction that reverse and stick: the same in every unit of length. With powers of two all
numbers are the same but for their exponents."""

import numpy as np
import pytest
import rbdyn as rb


def events(hinges, power, seed):
    unit, rng = 2.0**power, np.random.default_rng(seed)
    scene, parent = rb.Scene(gravity=[0, 0, -9.81 * unit]), {}
    for _ in range(hinges):
        mass = rng.uniform(0.5, 2)
        inertia = rng.uniform(0.2, 0.3, 3) * mass * unit**2
        body = rb.RigidBody(mass, inertia, com=rng.uniform(-0.5, 0.5, 3) * unit)
        hinge = rb.Revolute(
            rng.normal(size=3),
            at=rng.uniform(-1, 1, 3) * unit,
            friction=rb.Coulomb(0.2, 0.15),
            pin_radius=0.05 * unit,
        )
        parent = {"parent": scene.add(body, hinge, angle=rng.uniform(-1, 1), rate=rng.normal() * 2, **parent)}
    run = rb.simulate(scene, until=1.0, error=1e-8)
    return [(e.kind, str(e.subject), e.time) for e in run.events]


@pytest.mark.parametrize(("hinges", "seeds"), [(2, (15, 22, 25)), (3, (1, 2, 3))])
def test_rough_hinges_do_the_same_in_units_of_a_micrometre_and_of_a_thousand_kilometres(hinges, seeds):
    """The condition of what is held was an acceleration beside the torque of what slides: in one matrix, of which the
    smaller one counted as zero, so that runs went on switching."""
    for seed in seeds:
        expected = events(hinges, 0, seed)
        for power in (-30, -20, -10, 10, 20, 30):
            found = events(hinges, power, seed)
            assert [one[:2] for one in found] == [one[:2] for one in expected]
            assert all(abs(a[2] - b[2]) < 1e-7 for a, b in zip(found, expected, strict=True))
