"""Bennett's linkage, all but equilateral and driven: as its crank passes a half turn the next hinge goes round at K
times its rate. It comes near to losing rank there and does not: tan(a/2) tan(b/2) = K all the way (G. T. Bennett,
Engineering 76, 1903)."""

import numpy as np
import pytest
import rbdyn as rb
from scipy.spatial.transform import Rotation

LINK, RATE = 1.3, 2.0


def bar(mass, along):
    return rb.RigidBody(mass, [0.2 * mass] * 3, com=along / 2)


def linkage(twist, other):
    """Hinges one after the other in the frames of Denavit and Hartenberg, from crank angle 1 on."""
    ratio = np.sin((twist + other) / 2) / np.sin((other - twist) / 2)
    second = 2 * np.arctan(ratio / np.tan(0.5))
    lengths = (LINK, LINK * np.sin(other) / np.sin(twist)) * 2
    place, turned = np.zeros(3), Rotation.random(random_state=9)
    points, axes = [], []
    for angle, length, bend in zip((1.0, second, -1.0, -second), lengths, (twist, other) * 2, strict=True):
        points.append(place)
        axes.append(turned.apply([0, 0, 1]))
        turned = turned * Rotation.from_rotvec([0, 0, angle])
        place = place + turned.apply([length, 0, 0])
        turned = turned * Rotation.from_rotvec([bend, 0, 0])
    assert np.abs(place).max() < 1e-14
    second_rate = -RATE * ratio / np.sin(0.5) ** 2 / (1 + (ratio / np.tan(0.5)) ** 2)
    first, coupler, last = points[1] - points[0], points[2] - points[1], points[2] - points[3]
    scene = rb.Scene()
    crank = scene.add(bar(0.6, first), rb.Revolute(axes[0], at=points[0], motion=lambda t: RATE * t))
    hinge = rb.Revolute(axes[1], at=first)
    middle = scene.add(bar(0.1, coupler), hinge, parent=crank, angle=0.0, rate=second_rate)
    rocker = scene.add(bar(0.7, last), rb.Revolute(axes[3], at=points[3]), angle=0.0, rate=second_rate)
    scene.constrain(rb.Hinge(axes[2]), middle.point(coupler), rocker.point(last))
    return scene, middle, ratio, second


@pytest.mark.parametrize(("twist", "other"), [(1.0, 1.002), (1.0629, 1.0611), (1.0, 1.001), (0.5, 0.501)])
def test_it_goes_round_where_it_comes_near_to_losing_rank(twist, other):
    scene, middle, ratio, second = linkage(twist, other)
    run = rb.simulate(scene, until=5.0, error=1e-6)
    assert run.status == "reached end"
    assert len(run.events.times("singular")) == 0
    times = np.linspace(0, 5, 301)
    crank = 1 + RATE * times
    exact = 2 * np.arctan2(ratio * np.cos(crank / 2), np.sin(crank / 2)) - second
    off = (run[middle].angle(times) - exact + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(off).max() < 1e-7
