"""Spheres in a line without friction: those that do not part (e = 0) go on together and strike the next one, others by
turns. Against momentum alone, and against impacts of two taken one after the other."""

import math

import numpy as np
import pytest
import rbdyn as rb

R = 0.05
ALONG_X, ASKEW = np.array([1.0, 0, 0]), np.array([2.0, -1.0, 2.0]) / 3


def chain(masses, gaps, e, along, unit=1.0):
    scene = rb.Scene()
    radius, place, spheres = R * unit, 0.0, []
    for k, mass in enumerate(masses):
        velocity = along * unit if k == 0 else np.zeros(3)
        spheres.append(scene.add(rb.shapes.sphere(mass, radius), position=place * along, velocity=velocity))
        place += 2 * radius + (gaps[k] * unit if k < len(gaps) else 0.0)
    for a, b in zip(spheres, spheres[1:], strict=False):
        scene.contact(a.sphere(radius), b.sphere(radius), restitution=e)
    return scene, spheres


MASSES = [
    [1, 1, 1],
    [1, 0.7, 0.3],
    [0.3, 0.7, 0.9],
    [1.4554425309821815, 0.9046800706458055, 0.5614602859042921],
    [1e-3, 1e3, 1.0],
    [2.0, 0.5, 1.5, 0.1, 3.0],
]


@pytest.mark.parametrize("along", [ALONG_X, ASKEW], ids=["x", "askew"])
@pytest.mark.parametrize("gap", [1e-3, 0.1, 1.0])
@pytest.mark.parametrize("masses", MASSES, ids=str)
def test_what_does_not_part_goes_on_together_as_momentum_says(masses, gap, along):
    """A force of 4e-47 N was told apart from none, a turn of 6e-16 rad/s judged by itself: both were uncertain."""
    gaps = gap * np.linspace(1.0, 1.5, len(masses) - 1)
    speeds = masses[0] / np.cumsum(masses)
    times = np.cumsum(gaps / speeds[:-1])
    scene, spheres = chain(masses, gaps, 0.0, along)
    run = rb.simulate(scene, 1.5 * times[-1], error=1e-10)
    assert [e.time for e in run.events if e.kind == "land"] == pytest.approx(times, rel=1e-12)
    for after, speed in zip(times * (1 + 1e-6), speeds[1:], strict=True):
        moving = [run[s].velocity(after) @ along for s in spheres]
        count = np.searchsorted(times, after) + 1
        assert moving[:count] == pytest.approx([speed] * count, rel=1e-12)
        assert moving[count:] == [0.0] * (len(masses) - count)


def by_turns(masses, gaps, e, until):
    """Velocities at last and the times of all impacts, of pairs that strike one after the other."""
    n, t, times = len(masses), 0.0, []
    x = np.concatenate([[0.0], np.cumsum(gaps)])
    v = np.eye(1, n)[0]
    while True:
        approach = v[:-1] - v[1:]
        gap = np.diff(x)
        wait = np.array([g / a if a > 1e-14 and g >= 0 else math.inf for g, a in zip(gap, approach, strict=True)])
        k = int(wait.argmin())
        if not t + wait[k] < until:
            return v, times
        t += wait[k]
        x = x + v * wait[k]
        x[k] = x[k + 1] = 0.5 * (x[k] + x[k + 1])
        impulse = (1 + e) * approach[k] / (1 / masses[k] + 1 / masses[k + 1])
        v[k] -= impulse / masses[k]
        v[k + 1] += impulse / masses[k + 1]
        x[k + 1] += 1e-300
        times.append(t)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e4])
@pytest.mark.parametrize("e", [0.4, 0.9, 1.0])
def test_a_cradle_with_gaps_strikes_pair_by_pair(e, unit):
    masses, gaps = [1.0, 0.8, 1.3, 0.6], [0.01, 0.02, 0.015]
    after, times = by_turns(masses, gaps, e, 0.5)
    scene, spheres = chain(masses, gaps, e, ALONG_X, unit)
    run = rb.simulate(scene, 0.5, error=1e-10)
    assert [x.time for x in run.events] == pytest.approx(times, rel=1e-10)
    assert [run[s].velocity(0.5)[0] / unit for s in spheres] == pytest.approx(after, abs=1e-10)
