"""A search for rests that begins exactly where one formula of a force goes over to another tells what others tell."""

import numpy as np
import pytest
import rbdyn as rb


def rests(force, start, unit=1.0, near=None):
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, [0.1] * 3), rb.Prismatic([1, 0, 0]), displacement=start * unit)
    scene.apply(rb.JointForce(lambda t, q, rate: force(q / unit)), body)
    found = rb.equilibria(scene) if near is None else rb.equilibria(scene, near=[near * unit])
    return [(float(e.coordinates[0]) / unit, e.stable) for e in found]


# the force, the place, and whether it comes back from both sides
BORDERS = {
    "x^3 | -x": (lambda x: np.where(x < 0, x**3, -x), 0.0, False),
    "-x |x|": (lambda x: -x * abs(x), 0.0, True),
    "-x | x^3": (lambda x: np.where(x < 0, -x, x**3), 0.0, False),
    "|x|": (lambda x: abs(x), 0.0, False),
    "-x^3 | -x": (lambda x: np.where(x < 0, -(x**3), -x), 0.0, True),
    "x | -x^3": (lambda x: np.where(x < 0, x, -(x**3)), 0.0, False),
    "-sign(x - 0.3)": (lambda x: np.where(x < 0.3, 1.0 + 0 * x, -1.0 + 0 * x), 0.3, True),
    "sign(x - 1)": (lambda x: np.where(x < 1, -1.0 + 0 * x, 1.0 + 0 * x), 1.0, False),
    "-sign(x - 1)": (lambda x: np.where(x < 1, 1.0 + 0 * x, -1.0 + 0 * x), 1.0, True),
}


@pytest.mark.parametrize("unit", [1.0, 1e-6, 1e6])
@pytest.mark.parametrize("name", BORDERS)
def test_from_the_border_they_are_what_they_are_from_elsewhere(name, unit):
    force, place, stable = BORDERS[name]
    for start, near in ((place, None), (0.5, place), (0.7, None), (-2.3, None)):
        found = rests(force, start, unit, near)
        assert len(found) == 1, (start, near, found)
        assert found[0][0] == pytest.approx(place, abs=1e-9) and found[0][1] == stable, (start, near, found)


def test_a_jump_beside_a_smooth_rest_keeps_both():
    """sign(x) (x - 1) pushes to 0 from both sides, and away from 1."""
    for start in (0.0, 1e-9, 0.7, -2.3, 1.0):
        found = rests(lambda x: np.where(x < 0, 1 - x, x - 1), start)
        assert np.allclose([x for x, _ in found], [0, 1], atol=1e-9) and [s for _, s in found] == [True, False]
