"""A box that stands still stands still as well when the end of a rod that leans on it leaves it.

Rods are thrown so that one end slides on the top of a box on two or three feet until it leaves. As long as the box does
not move none of its feet slips, and what they bear is the weight that statics asks for.
"""

import numpy as np
import pytest
import rbdyn as rb

GRAVITY = 9.7
SEEDS = (1, 27, 32, 35, 65, 87, 110, 141, 159, 199, 213, 214, 248, 296)
X, _, Z = np.eye(3)


def thrown(seed):
    rng = np.random.default_rng(seed)
    mass, width, height = rng.uniform(0.5, 3), rng.uniform(0.3, 1), rng.uniform(0.1, 0.6)
    scene = rb.Scene(gravity=-GRAVITY * Z)
    box = scene.add(rb.RigidBody(mass, [mass * width**2 / 6] * 3), rb.Planar(X, Z), position=[0, height / 2])
    places = [-width / 2, width / 2, rng.uniform(-0.3, 0.3) * width][: rng.integers(2, 4)]
    feet = []
    for at in places:
        mu = rng.uniform(0.1, 1.2)
        friction = rb.Coulomb(mu, mu * rng.choice([1.0, rng.uniform(0.5, 1)]))
        feet.append(scene.contact(box.point(at * X - height / 2 * Z), rb.Plane(Z), friction=friction))
    length, angle, side = rng.uniform(0.3, 1.5), rng.uniform(0.2, 1.3), rng.choice([-1, 1])
    arm = -length / 2 * np.array([side * np.cos(angle), np.sin(angle)])
    rate, speed = rng.uniform(-6, 6), rng.uniform(-1.5, 1.5)
    light = rng.uniform(0.05, 1)
    rod = scene.add(
        rb.RigidBody(light, [light * length**2 / 12] * 3),
        rb.Planar(X, Z),
        position=np.array([rng.uniform(-0.4, 0.4) * width, height]) - arm,
        velocity=np.array([speed, 0]) - rate * np.array([-arm[1], arm[0]]),
        rate=rate,
    )
    end = scene.contact(
        rod.point([arm[0], 0, arm[1]]), box.plane(Z, height / 2 * Z), friction=rb.Coulomb(rng.uniform(0, 0.6))
    )
    return scene, box, feet, end, mass * GRAVITY


@pytest.mark.parametrize("seed", SEEDS)
def test_it_stands_still(seed):
    scene, box, feet, end, weight = thrown(seed)
    run = rb.simulate(scene, 1.0, rtol=1e-11)
    for event in run.events:
        if event.kind == "slip" and event.subject in feet:
            after = np.linspace(event.time, min(event.time + 0.01, run.end), 20)
            assert np.abs(run[box].velocity(after)).max() > 1e-9
    # from its first leave to what comes next
    leaves = next(e.time for e in run.events if e.kind == "detach" and e.subject == end)
    after = [e.time for e in run.events if e.time > leaves]
    time = (leaves + (after[0] if after else run.end)) / 2
    assert np.abs(run[box].position(time) - run[box].position(0.0)).max() < 1e-13
    forces = np.array([run[foot].force(time) for foot in feet])
    assert forces.sum(axis=0) == pytest.approx([0, 0, weight], abs=1e-11 * weight)
    assert abs(forces[:, 1]).max() == 0
