"""Two engines that share nothing but the equations tell the same motion of random scenes."""

import numpy as np
import pytest
import rbdyn as rb


def random_scene(seed):
    rng = np.random.default_rng(seed)
    scene = rb.Scene(gravity=[2 * rng.normal(), 2 * rng.normal(), -9.81])
    curves = [
        lambda: rb.Circle(radius=rng.uniform(0.2, 2), start=rng.normal(size=3), toward=rng.normal(size=3)),
        lambda: rb.Helix(
            radius=rng.uniform(0.2, 2), pitch=rng.normal(), start=rng.normal(size=3), toward=rng.normal(size=3)
        ),
        lambda: rb.Line(direction=rng.normal(size=3)),
        lambda: rb.Polynomial([[0, 0, 0], [1, 0, 0], list(0.4 * rng.normal(size=3))]),
    ]
    curve = curves[rng.integers(4)]()
    mu = rng.uniform(0, 1)
    friction = rb.Coulomb(mu, mu * rng.uniform(0.3, 0.95)) if rng.random() < 0.85 else None
    speed, rate = rng.normal(), rng.uniform(0.5, 4)
    drive = [0.0, speed, lambda t: speed * np.sin(rate * t)][rng.integers(3)]
    start = rng.choice([0.0, 3 * rng.normal()])
    rail = rb.Rail(curve, friction=friction, drive=drive)
    bead = scene.add(rb.Particle(rng.uniform(0.1, 3)), rail, parameter=rng.normal(), speed=start)
    if rng.random() < 0.5:
        spring = rb.Spring(rng.uniform(1, 40), rest_length=rng.choice([0, 0.3]), damping=rng.choice([0, 0.2]))
        scene.connect(spring, bead, rng.normal(size=3))
    if rng.random() < 0.4:
        scene.apply(rb.Drag(linear=rng.uniform(0, 0.3), quadratic=rng.uniform(0, 0.3)), bead)
    if rng.random() < 0.3:
        scene.apply(rb.Force(lambda t, r, v: [0.5 * np.sin(2 * t), -0.1 * r[0], 0.05 * v[1]]), bead)
    return scene, bead, rng.uniform(0.5, 8)


def events_but_grazes(run):
    """Kinds and times, without holds that are too short for either engine to tell from none."""
    events = [(event.kind, event.time) for event in run.events]
    i = 0
    while i + 1 < len(events):
        if events[i][0] == "stick" and events[i + 1][0] == "slip" and events[i + 1][1] - events[i][1] < 1e-6:
            del events[i : i + 2]
        else:
            i += 1
    return events


@pytest.mark.parametrize("first", range(0, 200, 25))
def test_taylor_and_adams_tell_the_same_events_and_places(first):
    for seed in range(first, first + 25):
        scene, bead, until = random_scene(seed)
        taylor = rb.simulate(scene, until, error=1e-10)
        adams = rb.simulate(scene, until, rtol=1e-12, engine="cvode-adams")
        ours, theirs = events_but_grazes(taylor), events_but_grazes(adams)
        assert [kind for kind, _ in ours] == [kind for kind, _ in theirs], seed
        assert np.allclose([t for _, t in ours], [t for _, t in theirs], rtol=0, atol=1e-7), seed
        t = np.linspace(0, min(taylor.end, adams.end), 40)
        places = taylor[bead].position(t)
        # CVODE's global error is up to 1e5 times its local tolerance
        extent = max(np.ptp(places, axis=0).max(), 1e-3)
        assert np.abs(places - adams[bead].position(t)).max() <= 1e-7 * extent, seed


def test_a_bead_that_sticks_never_asks_for_more_than_the_static_limit():
    held = 0
    for seed in range(60):
        scene, bead, until = random_scene(seed)
        run = rb.simulate(scene, until, error=1e-10)
        sticks = [e.time for e in run.events if e.kind == "stick"]
        for begin in sticks:
            ends = [e.time for e in run.events if e.time > begin]
            t = np.linspace(begin, ends[0] if ends else run.end, 200)[:-1]
            reaction = run[bead].reaction_frenet(t)
            # the limit is what it was where the hold ends by asking for more
            ratio = np.abs(reaction[:, 0]) / np.hypot(reaction[:, 1], reaction[:, 2])
            if ends and run.events[[e.time for e in run.events].index(ends[0])].kind == "slip":
                after = run[bead].reaction_frenet(ends[0], side="before")
                limit = abs(after[0]) / np.hypot(after[1], after[2])
                assert ratio.max() <= limit * (1 + 1e-8), seed
                held += 1
    assert held > 5
